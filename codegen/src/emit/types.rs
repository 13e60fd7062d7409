//! The structs of a model: one per vector, one field per entry.

use std::collections::BTreeSet;

use appell_runtime::model::Quantity;
use proc_macro2::TokenStream;
use quote::quote;

use super::body::Group;
use super::layout::{blank_tokens, code, docs, escaped};
use super::syntax::{ident, known, number};
use crate::program::{Function, FunctionKind, Layout, Own, Program, Space};
use crate::schedule::names::{ArgumentNames, Names};
use crate::tape::Argument;

/// Names of types and fields.
pub(super) struct Types<'a> {
    pub(super) program: &'a Program,
    pub(super) names: ArgumentNames,
    /// `x_dot` for every state.
    rates: Vec<String>,
    outputs: Vec<String>,
    constraint_rows: Vec<String>,
    reactions: Vec<String>,
    arguments: [String; 4],
}

impl<'a> Types<'a> {
    pub(super) fn new(program: &'a Program) -> Self {
        let names = ArgumentNames::of(program);
        let info = &program.info;
        let argument = |name: &str| unlike(&names, name);
        let arguments = [
            names.time.clone(),
            argument("parameters"),
            argument("state"),
            argument("inputs"),
        ];
        Self {
            program,
            rates: names.states.iter().map(|x| format!("{x}_dot")).collect(),
            outputs: distinct(info.outputs.iter().map(|output| &*output.name)),
            constraint_rows: distinct(info.constraint_rows.iter().map(|row| &**row)),
            reactions: distinct(info.reactions.iter().map(|reaction| &*reaction.name)),
            names,
            arguments,
        }
    }

    /// Names of the arguments of all functions: time, parameters, state, inputs.
    pub(super) fn argument_names(&self) -> &[String; 4] {
        &self.arguments
    }

    /// Whether a local of this name would shadow an argument.
    pub(super) fn is_argument(&self, name: &str) -> bool {
        self.names.iter().any(|other| other == name)
    }

    /// Whether a struct of this name would shadow a field in destructuring patterns.
    pub(super) fn is_field(&self, name: &str) -> bool {
        let own = [
            &self.rates,
            &self.outputs,
            &self.constraint_rows,
            &self.reactions,
        ];
        self.is_argument(name) || own.into_iter().flatten().any(|field| field == name)
    }

    /// The structs of the arguments.
    pub(super) fn groups(&self) -> [Group; 3] {
        let [_, parameters, state, inputs] = &self.arguments;
        let group = |type_name, argument: &String, len, like| Group {
            type_name,
            argument: argument.clone(),
            len,
            like,
        };
        let names = &self.names;
        [
            group(
                "Parameters",
                parameters,
                names.parameters.len(),
                Argument::Parameter(0),
            ),
            group("State", state, names.states.len(), Argument::State(0)),
            group("Inputs", inputs, names.inputs.len(), Argument::Input(0)),
        ]
    }

    /// Name and type of a function's additional argument.
    pub(super) fn own(&self, kind: FunctionKind) -> Option<(String, TokenStream)> {
        let own = kind.takes()?;
        let list = |names: &[String]| {
            let count = proc_macro2::Literal::usize_unsuffixed(names.len());
            quote!([T; #count])
        };
        let type_name = match own {
            Own::Weights => list(&self.names.weights),
            Own::OutputWeights => list(&self.names.output_weights),
            Own::Accelerations => self.vector(Space::Accelerations, &quote!(T)),
        };
        Some((unlike(&self.names, own.name()), type_name))
    }

    /// Name of the struct of a vector.
    pub(super) fn type_name(space: Space) -> &'static str {
        match space {
            Space::Parameters => "Parameters",
            Space::State => "State",
            Space::Inputs => "Inputs",
            Space::Outputs => "Outputs",
            Space::Rates => "Rates",
            Space::Accelerations => "Accelerations",
            Space::CoordinateRates => "CoordinateRates",
            Space::GeneralizedForces => "GeneralizedForces",
            Space::ConstraintRows => "ConstraintResidual",
            Space::Reactions => "ConstraintForces",
        }
    }

    /// Its fields.
    pub(super) fn fields(&self, space: Space) -> &[String] {
        let names = &self.names;
        let speeds = self.program.info.speeds.min(names.states.len());
        match space {
            Space::Parameters => &names.parameters,
            Space::State => &names.states,
            Space::Inputs => &names.inputs,
            Space::Outputs => &self.outputs,
            Space::Rates => &self.rates,
            Space::Accelerations => &self.rates[..speeds],
            Space::CoordinateRates => &self.rates[speeds..],
            Space::GeneralizedForces => &names.states[..speeds],
            Space::ConstraintRows => &self.constraint_rows,
            Space::Reactions => &self.reactions,
        }
    }

    /// `Name<entry>`; a vector without entries is a `Name`.
    pub(super) fn vector(&self, space: Space, entry: &TokenStream) -> TokenStream {
        let name = known(Self::type_name(space));
        if self.fields(space).is_empty() {
            quote!(#name)
        } else {
            quote!(#name<#entry>)
        }
    }

    /// The number of entries of a layout.
    pub(super) fn len(&self, layout: Layout) -> usize {
        let len = |space| self.fields(space).len();
        match layout {
            Layout::Scalar => 1,
            Layout::List(n) => n,
            Layout::Matrix(rows, columns) => rows * columns,
            Layout::Vector(space) => len(space),
            Layout::Rows(space, columns) => len(space) * columns,
            Layout::Jacobian(rows, columns) => len(rows) * len(columns),
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

    /// A struct, with a sentence for every field.
    fn structure(&self, space: Space) -> Vector<'_> {
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
        let texts = match space {
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
        Vector {
            name: Self::type_name(space),
            about,
            fields: self.fields(space),
            texts,
            default: space != Space::Parameters,
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
            items.push(self.structure(space).tokens());
            match space {
                Space::Parameters => items.push(spec_values(
                    &quote!(Default for Parameters<f64>),
                    &quote!(fn default),
                    "The values of the spec.",
                    &self.names.parameters,
                    &info.parameters,
                )),
                Space::State => items.push(spec_values(
                    &quote!(State<f64>),
                    &quote!(#[must_use] pub fn initial),
                    "The initial state of the spec; the default is zero.",
                    &self.names.states,
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
            let (name, type_name) = (known(name), known(Self::type_name(space)));
            let entries = self.vector(space, &quote!(T));
            let fields: Vec<_> = self.fields(space).iter().map(|f| ident(f)).collect();
            let about = docs(&[about.to_owned()]);
            quote! {
                #blank
                #about
                #[must_use]
                pub fn #name(self) -> #entries {
                    #type_name { #(#fields: self.#fields),* }
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
        spaces
            .iter()
            .map(|&space| {
                let moved = (rates && space == Space::State).then_some("Rates");
                self.structure(space).arithmetic(runtime, moved)
            })
            .collect()
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

/// `wanted`, made different from all arguments.
fn unlike(names: &ArgumentNames, wanted: &str) -> String {
    let mut name = wanted.to_owned();
    while names.iter().any(|other| *other == name) {
        name.push('_');
    }
    name
}

/// Unique identifiers of names.
fn distinct<'a>(names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = Names::default();
    names.map(|name| taken.fresh(name)).collect()
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

/// A struct of scalars.
struct Vector<'a> {
    name: &'static str,
    about: &'static str,
    fields: &'a [String],
    /// A sentence for each field.
    texts: Vec<String>,
    /// Whether its default is zero.
    default: bool,
}

impl Vector<'_> {
    /// The struct. Without fields it has no type parameter.
    fn tokens(&self) -> TokenStream {
        let type_name = known(self.name);
        let blank = blank_tokens();
        let about = docs(&[self.about.to_owned()]);
        if self.fields.is_empty() {
            return quote! {
                #blank
                #about
                #[derive(Debug, Clone, Copy, PartialEq, Default)]
                pub struct #type_name {}
            };
        }
        let default = self.default.then(|| quote!(, Default));
        let fields = self.fields.iter().map(|field| ident(field));
        let texts = self
            .texts
            .iter()
            .map(|text| docs(std::slice::from_ref(text)));
        quote! {
            #blank
            #about
            #[derive(Debug, Clone, Copy, PartialEq #default)]
            pub struct #type_name<T> { #(#texts pub #fields: T),* }
        }
    }

    /// The arithmetic of a vector.
    fn arithmetic(&self, runtime: &syn::Path, moved: Option<&'static str>) -> TokenStream {
        let name = known(self.name);
        let blank = blank_tokens();
        let fields = self.fields.iter().map(|field| ident(field));
        let moved = moved.map(|rates| {
            let rates = known(rates);
            quote!(, #rates)
        });
        quote! {
            #blank
            #runtime::vector!(#name { #(#fields),* } #moved);
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
