//! The structs of a model: one per vector, one field per entry.

use appell_runtime::model::Quantity;
use proc_macro2::TokenStream;
use quote::quote;

use super::body::Group;
use super::layout::{blank_tokens, docs, escaped, one_line};
use super::syntax::{ident, known, number};
use crate::program::{Function, FunctionKind, Layout, Program};
use crate::schedule::Argument;
use crate::schedule::names::{ArgumentNames, Names, identifier};

/// Names of types and fields.
pub(super) struct Types<'a> {
    pub(super) program: &'a Program,
    pub(super) names: ArgumentNames,
    outputs: Vec<String>,
    arguments: [String; 5],
}

impl<'a> Types<'a> {
    pub(super) fn new(program: &'a Program) -> Self {
        let names = ArgumentNames::of(program);
        let mut outputs: Vec<String> = Vec::new();
        for output in program.info.outputs.iter() {
            let mut name = identifier(&output.name);
            while outputs.contains(&name) {
                name.push('_');
            }
            outputs.push(name);
        }
        let argument = |name: &str| {
            let mut name = name.to_owned();
            while names.iter().any(|other| *other == name) {
                name.push('_');
            }
            name
        };
        let arguments = [
            names.time.clone(),
            argument("parameters"),
            argument("state"),
            argument("inputs"),
            argument("weights"),
        ];
        Self {
            program,
            names,
            outputs,
            arguments,
        }
    }

    /// Names of the arguments of functions: time, parameters, state, inputs; for adjoints weights.
    pub(super) fn argument_names(&self) -> &[String; 5] {
        &self.arguments
    }

    /// Whether a local of this name would hide an argument.
    pub(super) fn is_argument(&self, name: &str) -> bool {
        self.names.iter().any(|other| other == name)
    }

    /// The structs that hold the arguments.
    pub(super) fn groups(&self) -> [Group; 3] {
        let [_, parameters, state, inputs, _] = &self.arguments;
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

    /// How many weights a function takes.
    pub(super) fn weights(&self, kind: FunctionKind) -> usize {
        match kind {
            FunctionKind::Adjoint => self.names.weights.len(),
            FunctionKind::OutputAdjoint => self.names.output_weights.len(),
            _ => 0,
        }
    }

    fn speeds(&self) -> usize {
        self.program.info.speeds.min(self.names.states.len())
    }

    /// Struct and field names of a labelled layout.
    pub(super) fn labelled(&self, layout: Layout) -> (&'static str, &[String]) {
        let states = self.names.states.as_slice();
        match layout {
            Layout::Speeds => ("Speeds", &states[..self.speeds()]),
            Layout::Coordinates => ("Coordinates", &states[self.speeds()..]),
            Layout::Outputs => ("Outputs", &self.outputs),
            _ => ("State", states),
        }
    }

    /// How many entries a layout has.
    pub(super) fn len(&self, layout: Layout) -> usize {
        match layout {
            Layout::Scalar => 1,
            Layout::Vector(n) => n,
            Layout::Matrix(rows, columns) => rows * columns,
            _ => self.labelled(layout).1.len(),
        }
    }

    /// The type of an array.
    pub(super) fn array_type(&self, layout: Layout) -> TokenStream {
        match layout {
            Layout::Scalar => quote!(T),
            Layout::Vector(n) => {
                let n = proc_macro2::Literal::usize_unsuffixed(n);
                quote!([T; #n])
            }
            Layout::Matrix(rows, columns) => {
                let [rows, columns] = [rows, columns].map(proc_macro2::Literal::usize_unsuffixed);
                quote!([[T; #columns]; #rows])
            }
            _ => {
                let name = known(self.labelled(layout).0);
                quote!(#name<T>)
            }
        }
    }

    /// The structs of arguments and labelled results.
    fn vectors(&self) -> Vec<Vector<'_>> {
        let info = &self.program.info;
        let (speeds, coordinates) = info.states.split_at(self.speeds());
        let names = &self.names;
        let (speed_names, coordinate_names) = names.states.split_at(self.speeds());
        let all = [
            (
                "Parameters",
                "Parameters, in SI.",
                &*names.parameters,
                &*info.parameters,
            ),
            (
                "Speeds",
                "One number per pseudo-velocity, in SI. Where it is a force: in W over the unit.",
                speed_names,
                speeds,
            ),
            (
                "Coordinates",
                "One number per coordinate, in SI. Where it is a rate: in the unit per second.",
                coordinate_names,
                coordinates,
            ),
            (
                "State",
                "The state, or its rates: pseudo-velocities, then coordinates. In SI.",
                &names.states,
                &info.states,
            ),
            ("Inputs", "Inputs, in SI.", &names.inputs, &info.inputs),
            ("Outputs", "Outputs, in SI.", &self.outputs, &info.outputs),
        ];
        let wanted = |vector: &Vector<'_>| vector.name != "Outputs" || !vector.labels.is_empty();
        all.into_iter()
            .map(|(name, about, labels, quantities)| Vector {
                name,
                about,
                labels,
                quantities,
            })
            .filter(wanted)
            .collect()
    }

    /// The structs, and the values of the spec as the default of the parameters.
    pub(super) fn argument_structs(&self) -> Vec<TokenStream> {
        let mut items: Vec<TokenStream> = self.vectors().iter().map(Vector::structure).collect();
        let parameters = &self.program.info.parameters;
        if !parameters.is_empty() {
            items.insert(
                1,
                defaults("Parameters", &self.names.parameters, parameters),
            );
        }
        items
    }

    /// Conversions of the structs from and to arrays.
    pub(super) fn conversions(&self) -> Vec<TokenStream> {
        self.vectors().iter().map(Vector::conversions).collect()
    }

    /// Field names of the results of a function, no two equal.
    pub(super) fn fields(function: &Function) -> Vec<String> {
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
            .zip(Self::fields(function))
            .map(|(array, field)| {
                let text = docs(&[one_line(&array.about)]);
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

/// `impl Default` with the values of the spec.
fn defaults(name: &'static str, labels: &[String], quantities: &[Quantity]) -> TokenStream {
    let type_name = known(name);
    let fields = labels.iter().map(|label| ident(label));
    let values = quantities.iter().map(|quantity| double(quantity.value));
    let blank = blank_tokens();
    quote! {
        #blank
        impl Default for #type_name<f64> {
            /// The values of the spec.
            fn default() -> Self {
                Self { #(#fields: #values),* }
            }
        }
    }
}

/// A struct of scalars.
struct Vector<'a> {
    name: &'static str,
    about: &'static str,
    labels: &'a [String],
    quantities: &'a [Quantity],
}

impl Vector<'_> {
    /// The struct. Without fields it holds nothing but the type of the scalar.
    fn structure(&self) -> TokenStream {
        let type_name = known(self.name);
        let blank = blank_tokens();
        let about = docs(&[self.about.to_owned()]);
        if self.labels.is_empty() {
            return quote! {
                #blank
                #about
                #[derive(Debug, Clone, Copy, PartialEq, Default)]
                pub struct #type_name<T>(pub core::marker::PhantomData<T>);
            };
        }
        let fields = self.labels.iter().map(|label| ident(label));
        let texts = self
            .quantities
            .iter()
            .map(|quantity| docs(&[sentence(quantity)]));
        quote! {
            #blank
            #about
            #[derive(Debug, Clone, Copy, PartialEq)]
            pub struct #type_name<T> { #(#texts pub #fields: T),* }
        }
    }

    /// From and to an array.
    fn conversions(&self) -> TokenStream {
        let type_name = known(self.name);
        let blank = blank_tokens();
        let fields: Vec<_> = self.labels.iter().map(|label| ident(label)).collect();
        let count = proc_macro2::Literal::usize_unsuffixed(fields.len());
        let [pattern, value] = if fields.is_empty() {
            [quote!((_)), quote!((core::marker::PhantomData))]
        } else {
            [quote!({ #(#fields),* }), quote!({ #(#fields),* })]
        };
        quote! {
            #blank
            impl<T> From<[T; #count]> for #type_name<T> {
                fn from([#(#fields),*]: [T; #count]) -> Self {
                    Self #value
                }
            }

            #blank
            impl<T> From<#type_name<T>> for [T; #count] {
                fn from(#type_name #pattern: #type_name<T>) -> Self {
                    [#(#fields),*]
                }
            }
        }
    }
}

/// What a quantity is, and its unit.
fn sentence(quantity: &Quantity) -> String {
    let about = capitalised(&escaped(&quantity.about));
    let about = about.trim_end_matches('.');
    let unit = one_line(&quantity.unit).replace('`', "'");
    match (about.is_empty(), unit.is_empty()) {
        (true, true) => "No unit.".to_owned(),
        (true, false) => format!("In `{unit}`."),
        (false, true) => format!("{about}."),
        (false, false) => format!("{about}, in `{unit}`."),
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

/// A double as an expression, infinities too.
pub(super) fn double(value: f64) -> TokenStream {
    if value.is_nan() {
        quote!(f64::NAN)
    } else if value.is_infinite() {
        let sign = (value < 0.0).then(|| quote!(-));
        quote!(#sign f64::INFINITY)
    } else {
        let number = number(value);
        quote!(#number)
    }
}
