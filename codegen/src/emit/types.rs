//! The structs of a model: one per vector, one field per entry.

use std::collections::BTreeSet;

use appell_runtime::model::Quantity;
use proc_macro2::TokenStream;
use quote::quote;

use super::layout::{blank_tokens, code, docs, escaped};
use super::syntax::{ident, known, number};
use crate::program::{Function, FunctionKind, Layout, Own, Program, Space};
use crate::schedule::names::Names;
use crate::text::{Vectors, type_name};

/// Names of types and fields.
pub(super) struct Types<'a> {
    pub(super) program: &'a Program,
    pub(super) vectors: Vectors,
    arguments: [String; 4],
}

impl<'a> Types<'a> {
    pub(super) fn new(program: &'a Program) -> Self {
        let vectors = Vectors::of(program);
        let names = &vectors.names;
        let [parameters, state, inputs] =
            ["parameters", "state", "inputs"].map(|name| names.free(name));
        Self {
            program,
            arguments: [names.time.clone(), parameters, state, inputs],
            vectors,
        }
    }

    /// Names of the arguments of all functions: time, parameters, state, inputs.
    pub(super) fn argument_names(&self) -> &[String; 4] {
        &self.arguments
    }

    /// Whether a struct of this name would shadow a field in destructuring patterns.
    pub(super) fn is_field(&self, name: &str) -> bool {
        let vectors = &self.vectors;
        vectors
            .names
            .iter()
            .chain(vectors.results())
            .any(|field| field == name)
    }

    /// Name and type of a function's additional argument.
    pub(super) fn own(&self, function: FunctionKind) -> Option<(String, TokenStream)> {
        let own = function.takes()?;
        let list = |names: &[String]| {
            let count = proc_macro2::Literal::usize_unsuffixed(names.len());
            quote!([T; #count])
        };
        let kind = match own {
            Own::Weights => list(&self.vectors.names.weights),
            Own::OutputWeights => list(&self.vectors.names.output_weights),
            Own::Accelerations => self.vector(Space::Accelerations, &quote!(T)),
        };
        Some((self.vectors.names.free(own.name()), kind))
    }

    /// The fields of a vector.
    pub(super) fn fields(&self, space: Space) -> &[String] {
        self.vectors.entries(space)
    }

    /// `Name<entry>`; a vector without entries is a `Name`.
    pub(super) fn vector(&self, space: Space, entry: &TokenStream) -> TokenStream {
        let name = known(type_name(space));
        if self.fields(space).is_empty() {
            quote!(#name)
        } else {
            quote!(#name<#entry>)
        }
    }

    /// The type of an array.
    pub(super) fn array_type(&self, layout: Layout) -> TokenStream {
        let count = proc_macro2::Literal::usize_unsuffixed;
        match layout {
            Layout::Scalar => quote!(T),
            Layout::List(n) => {
                let n = count(n);
                quote!([T; #n])
            }
            Layout::Matrix(rows, columns) => {
                let [rows, columns] = [rows, columns].map(count);
                quote!([[T; #columns]; #rows])
            }
            Layout::Vector(space) => self.vector(space, &quote!(T)),
            Layout::Rows(space, columns) => {
                let columns = count(columns);
                self.vector(space, &quote!([T; #columns]))
            }
            Layout::Jacobian(rows, columns) => self.vector(rows, &self.vector(columns, &quote!(T))),
        }
    }

    /// A struct, with a sentence for every field. Without fields it has no type parameter.
    fn structure(&self, space: Space) -> TokenStream {
        let info = &self.program.info;
        let (about, entry): (_, fn(&Quantity) -> String) = match space {
            Space::Parameters => ("Parameters p, in SI.", sentence),
            Space::State => (
                "State x: pseudo-velocities, then coordinates. In SI.",
                sentence,
            ),
            Space::Inputs => ("Inputs u, in SI.", sentence),
            Space::Outputs => ("Outputs y, in SI.", sentence),
            Space::Rates => (
                "Rates ẋ of the [`State`]: pseudo-accelerations, then generalised velocities. In SI.",
                rate,
            ),
            Space::Accelerations => ("Pseudo-accelerations ω̇, in SI.", rate),
            Space::CoordinateRates => ("Generalised velocities q̇, in SI.", rate),
            Space::GeneralizedForces => (
                "Pseudo-forces, such as Π or b: power per pseudo-velocity, in SI.",
                force,
            ),
            Space::ConstraintRows => (
                "What the constraint rows are off by: zero up to rounding. In SI.",
                sentence,
            ),
            Space::Reactions => (
                "Reactions in the ground: forces on points along x, y, z in N; a multiplier of a \
                 constraint stands in the x component.",
                sentence,
            ),
        };
        let texts: Vec<String> = match space {
            Space::ConstraintRows => (info.constraint_rows.iter())
                .map(|row| format!("Row {}.", code(row)))
                .collect(),
            Space::Reactions => (info.reactions.iter())
                .map(|reaction| {
                    let name = code(&reaction.name);
                    if reaction.unit.is_empty() {
                        format!("At {name}.")
                    } else {
                        format!("At {name}, in {}.", code(&reaction.unit))
                    }
                })
                .collect(),
            _ => space.quantities(info).iter().map(entry).collect(),
        };
        let name = known(type_name(space));
        let blank = blank_tokens();
        let about = docs(&[about.to_owned()]);
        if self.fields(space).is_empty() {
            return quote! {
                #blank
                #about
                #[derive(Debug, Clone, Copy, PartialEq, Default)]
                pub struct #name {}
            };
        }
        // The default of the parameters is not zero.
        let default = (space != Space::Parameters).then(|| quote!(, Default));
        let fields = self.fields(space).iter().map(|field| ident(field));
        let texts = texts.iter().map(|text| docs(std::slice::from_ref(text)));
        quote! {
            #blank
            #about
            #[derive(Debug, Clone, Copy, PartialEq #default)]
            pub struct #name<T> { #(#texts pub #fields: T),* }
        }
    }

    /// The vectors in the signatures of functions. `named` adds those that a model needs.
    fn spaces(functions: &[&Function], named: bool) -> BTreeSet<Space> {
        let mut spaces = BTreeSet::from([Space::Parameters, Space::State, Space::Inputs]);
        spaces.extend(named.then_some(Space::Outputs));
        for array in functions.iter().flat_map(|function| &function.results) {
            match array.layout {
                Layout::Vector(space) | Layout::Rows(space, _) => {
                    spaces.insert(space);
                }
                Layout::Jacobian(rows, columns) => spaces.extend([rows, columns]),
                Layout::Scalar | Layout::List(_) | Layout::Matrix(..) => {}
            }
        }
        let mass_matrix = [FunctionKind::MassMatrix, FunctionKind::MassMatrixAndBias];
        let kinds = functions.iter().map(|function| function.kind);
        if kinds
            .into_iter()
            .any(|kind| mass_matrix.contains(&kind) || kind.takes() == Some(Own::Accelerations))
        {
            spaces.insert(Space::Accelerations);
        }
        if spaces.contains(&Space::Rates) {
            spaces.extend([Space::Accelerations, Space::CoordinateRates]);
        }
        spaces
    }

    /// The structs, the values of the spec, and the two parts of the rates.
    pub(super) fn structs(&self, functions: &[&Function], named: bool) -> Vec<TokenStream> {
        let spaces = Self::spaces(functions, named);
        let info = &self.program.info;
        let mut items = Vec::new();
        for &space in &spaces {
            items.push(self.structure(space));
            match space {
                Space::Parameters => items.push(spec_values(
                    &quote!(Default for Parameters<f64>),
                    &quote!(fn default),
                    "The values of the spec.",
                    &self.vectors.names.parameters,
                    &info.parameters,
                )),
                Space::State => items.push(spec_values(
                    &quote!(State<f64>),
                    &quote!(#[must_use] pub fn initial),
                    "The initial state of the spec; the default is zero.",
                    &self.vectors.names.states,
                    &info.states,
                )),
                Space::Rates => items.push(self.parts_of_rates()),
                _ => {}
            }
        }
        items
    }

    /// ω̇ and q̇ as parts of ẋ.
    fn parts_of_rates(&self) -> TokenStream {
        let blank = blank_tokens();
        let method = |name: &'static str, about: &'static str, space| {
            let (name, structure) = (known(name), known(type_name(space)));
            let entries = self.vector(space, &quote!(T));
            let fields: Vec<_> = self.fields(space).iter().map(|f| ident(f)).collect();
            let about = docs(&[about.to_owned()]);
            quote! {
                #blank
                #about
                #[must_use]
                pub fn #name(self) -> #entries {
                    #structure { #(#fields: self.#fields),* }
                }
            }
        };
        let accelerations = method("accelerations", "ω̇, the first part.", Space::Accelerations);
        let coordinate_rates = method(
            "coordinate_rates",
            "q̇, the second part.",
            Space::CoordinateRates,
        );
        if self.fields(Space::Rates).is_empty() {
            return TokenStream::new();
        }
        quote! {
            #blank
            impl<T> Rates<T> {
                #accelerations
                #coordinate_rates
            }
        }
    }

    /// Conversions of the structs from and to arrays, and their arithmetic.
    pub(super) fn conversions(
        &self,
        functions: &[&Function],
        named: bool,
        runtime: &syn::Path,
    ) -> Vec<TokenStream> {
        let spaces = Self::spaces(functions, named);
        let rates = spaces.contains(&Space::Rates);
        let conversion = |&space: &Space| {
            let name = known(type_name(space));
            let blank = blank_tokens();
            let fields = self.fields(space).iter().map(|field| ident(field));
            let moved = (rates && space == Space::State).then(|| quote!(, Rates));
            quote! {
                #blank
                #runtime::vector!(#name { #(#fields),* } #moved);
            }
        };
        spaces.iter().map(conversion).collect()
    }

    /// Unique field names of the results of a function.
    pub(super) fn result_fields(function: &Function) -> Vec<String> {
        let mut names = Names::default();
        function
            .results
            .iter()
            .map(|array| names.fresh(&array.name))
            .collect()
    }

    /// The struct of a function with several results.
    pub(super) fn results_struct(&self, function: &Function) -> Option<TokenStream> {
        let name = known(result_struct(function)?);
        let blank = blank_tokens();
        let about = docs(&[format!("Result of [`{}`].", function.kind.name())]);
        let fields = function
            .results
            .iter()
            .zip(Self::result_fields(function))
            .map(|(array, field)| {
                let text = docs(std::slice::from_ref(&array.about));
                let field = ident(&field);
                let kind = self.array_type(array.layout);
                quote!(#text pub #field: #kind)
            });
        Some(quote! {
            #blank
            #about
            #[derive(Debug, Clone, Copy, PartialEq)]
            pub struct #name<T> { #(#fields),* }
        })
    }
}

/// The struct a function returns, if it returns more than one array.
pub(super) fn result_struct(function: &Function) -> Option<&'static str> {
    (function.results.len() != 1).then(|| function.kind.result_struct())
}

/// A constructor of a struct with the values of the spec.
fn spec_values(
    implementation: &TokenStream,
    signature: &TokenStream,
    about: &str,
    labels: &[String],
    quantities: &[Quantity],
) -> TokenStream {
    if labels.is_empty() {
        return TokenStream::new();
    }
    let fields = labels.iter().map(|label| ident(label));
    let values = quantities.iter().map(|quantity| number(quantity.value));
    let (blank, about) = (blank_tokens(), docs(&[about.to_owned()]));
    quote! {
        #blank
        impl #implementation {
            #about
            #signature() -> Self {
                Self { #(#fields: #values),* }
            }
        }
    }
}

/// Description of the rate of a quantity.
fn rate(quantity: &Quantity) -> String {
    let unit = match &*quantity.unit {
        "" => "1/s".to_owned(),
        unit => match unit.strip_suffix("/s") {
            Some(unit) => format!("{unit}/s^2"),
            None if unit.contains('/') => format!("({unit})/s"),
            None => format!("{unit}/s"),
        },
    };
    format!("Rate of {}, in {}.", code(&quantity.name), code(&unit))
}

/// Description of the pseudo-force of a pseudo-velocity.
fn force(quantity: &Quantity) -> String {
    let unit = match &*quantity.unit {
        "" => "W".to_owned(),
        "m/s" => "N".to_owned(),
        "rad/s" => "N*m".to_owned(),
        unit => format!("W/({unit})"),
    };
    format!("Along {}, in {}.", code(&quantity.name), code(&unit))
}

/// Description of a quantity, with its unit.
fn sentence(quantity: &Quantity) -> String {
    let about = capitalised(&escaped(&quantity.about));
    let about = about.trim_end_matches('.');
    let unit = code(&quantity.unit);
    match (about.is_empty(), quantity.unit.is_empty()) {
        (true, true) => "No unit.".to_owned(),
        (true, false) => format!("In {unit}."),
        (false, true) => format!("{about}."),
        (false, false) => format!("{about}, in {unit}."),
    }
}

/// A sentence with a capital at its start, unless it starts with a symbol.
fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    match (letters.next(), text.chars().nth(1)) {
        (Some(first), Some(second)) if second.is_lowercase() => {
            first.to_uppercase().chain(letters).collect()
        }
        _ => text.to_owned(),
    }
}
