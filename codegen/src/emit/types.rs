//! The structs of a model: one per vector, one field per entry.

use appell_runtime::model::Quantity;
use proc_macro2::TokenStream;
use quote::quote;

use super::body::Group;
use super::layout::{blank_tokens, docs, escaped};
use super::syntax::{ident, number};
use crate::program::{Array, Function, FunctionKind, Layout, Program};
use crate::schedule::Argument;
use crate::schedule::names::{ArgumentNames, identifier};

/// Names of types and fields.
pub(super) struct Types<'a> {
    pub(super) program: &'a Program,
    pub(super) names: ArgumentNames,
    outputs: Vec<String>,
    arguments: [String; 4],
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
        let argument = |short: &str, long: &str| {
            let mut name = short;
            let mut longer = long.to_owned();
            if names.iter().any(|other| other == short) {
                while names.iter().any(|other| *other == longer) {
                    longer.push('_');
                }
                name = &longer;
            }
            name.to_owned()
        };
        let arguments = [
            names.time.clone(),
            argument("p", "parameters"),
            argument("x", "state"),
            argument("u", "inputs"),
        ];
        Self {
            program,
            names,
            outputs,
            arguments,
        }
    }

    /// Names of the arguments of every function: time, parameters, state, inputs.
    pub(super) fn argument_names(&self) -> &[String; 4] {
        &self.arguments
    }

    /// Whether a local of this name would hide an argument.
    pub(super) fn is_argument(&self, name: &str) -> bool {
        self.names.iter().any(|other| other == name)
    }

    /// The structs that hold the arguments.
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
                let name = ident(self.labelled(layout).0);
                quote!(#name<T>)
            }
        }
    }

    /// The structs of arguments and labelled results.
    pub(super) fn argument_structs(&self) -> Vec<TokenStream> {
        let info = &self.program.info;
        let states = &info.states;
        let about = |text: &str| vec![text.to_owned()];
        let mut items = vec![vector(
            "Parameters",
            &about("Parameters, in SI."),
            &self.names.parameters,
            &info.parameters,
        )];
        if !self.names.parameters.is_empty() {
            items.push(defaults(
                "Parameters",
                &self.names.parameters,
                &info.parameters,
            ));
        }
        for (layout, text) in [
            (Layout::Speeds, "One number per pseudo-velocity."),
            (Layout::Coordinates, "One number per coordinate."),
            (
                Layout::State,
                "The state, or its rates: pseudo-velocities, then coordinates. In SI.",
            ),
        ] {
            let (name, labels) = self.labelled(layout);
            let of = match layout {
                Layout::Speeds => &states[..self.speeds()],
                Layout::Coordinates => &states[self.speeds()..],
                _ => states,
            };
            items.push(vector(name, &about(text), labels, of));
        }
        items.push(vector(
            "Inputs",
            &about("Inputs, in SI."),
            &self.names.inputs,
            &info.inputs,
        ));
        if !self.outputs.is_empty() {
            items.push(vector(
                "Outputs",
                &about("Outputs, in SI."),
                &self.outputs,
                &info.outputs,
            ));
        }
        items
    }

    /// The struct of a function with several results.
    pub(super) fn results_struct(&self, function: &Function) -> Option<TokenStream> {
        let name = ident(result_struct(function)?);
        let blank = blank_tokens();
        let about = docs(&[format!(
            "Result of [`{}`].",
            super::function::function_name(function.kind)
        )]);
        let fields = function.results.iter().map(|array| {
            let text = docs(&[about_result(function.kind, array)]);
            let field = ident(&array.name);
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
    (function.results.len() != 1).then_some(match function.kind {
        FunctionKind::Kinematics => "Kinematics",
        FunctionKind::AccelerationEnergy => "AccelerationEnergy",
        FunctionKind::MassMatrix => "MassMatrix",
        FunctionKind::Bias => "Bias",
        FunctionKind::GeneralizedForces => "GeneralizedForces",
        FunctionKind::Rates => "Rates",
        FunctionKind::Jacobians => "Jacobians",
        FunctionKind::AllJacobians => "AllJacobians",
        FunctionKind::Energies => "Energies",
        FunctionKind::ConstraintResidual => "ConstraintResidual",
        FunctionKind::ConstraintForces => "ConstraintForces",
        FunctionKind::Outputs => "OutputArrays",
        FunctionKind::Switches => "Switches",
    })
}

fn about_result(kind: FunctionKind, array: &Array) -> String {
    match (kind, array.name.as_str()) {
        (_, "rates") => "ẋ, the rates of the state.".to_owned(),
        (_, "a") => "A = ∂ẋ/∂x. Rows and columns follow [`State`].".to_owned(),
        (_, "b") => "B = ∂ẋ/∂u. Rows follow [`State`], columns [`Inputs`].".to_owned(),
        (_, "p") => "P = ∂ẋ/∂p. Rows follow [`State`], columns [`Parameters`].".to_owned(),
        (FunctionKind::Energies, "kinetic") => "Kinetic energy in J.".to_owned(),
        (FunctionKind::Energies, "potential") => "Potential energy in J.".to_owned(),
        (FunctionKind::Energies, "power") => {
            "Power of the loads without a potential, in W.".to_owned()
        }
        (FunctionKind::AccelerationEnergy, "total") => "Sum over the bodies, in W/s.".to_owned(),
        (FunctionKind::AccelerationEnergy, body) => {
            format!("Of `{}`, in W/s.", super::layout::one_line(body))
        }
        (_, name) => super::layout::one_line(name),
    }
}

/// `impl Default` with the values of the spec.
fn defaults(name: &str, labels: &[String], quantities: &[Quantity]) -> TokenStream {
    let type_name = ident(name);
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

/// A struct of scalars and its conversions from and to an array.
fn vector(name: &str, about: &[String], labels: &[String], quantities: &[Quantity]) -> TokenStream {
    let type_name = ident(name);
    let blank = blank_tokens();
    let about = docs(about);
    if labels.is_empty() {
        return quote! {
            #blank
            #about
            #[derive(Debug, Clone, Copy, PartialEq, Default)]
            pub struct #type_name<T>(pub core::marker::PhantomData<T>);

            #blank
            impl<T> From<[T; 0]> for #type_name<T> {
                fn from(_: [T; 0]) -> Self {
                    Self(core::marker::PhantomData)
                }
            }

            #blank
            impl<T> From<#type_name<T>> for [T; 0] {
                fn from(_: #type_name<T>) -> Self {
                    []
                }
            }
        };
    }
    let fields: Vec<_> = labels.iter().map(|label| ident(label)).collect();
    let texts = quantities.iter().map(|quantity| {
        let mut text = escaped(&quantity.about);
        if !quantity.unit.is_empty() {
            if !text.is_empty() {
                text.push(' ');
            }
            text.extend(["Unit: ", &escaped(&quantity.unit), "."]);
        }
        docs(&[text])
    });
    let count = proc_macro2::Literal::usize_unsuffixed(labels.len());
    quote! {
        #blank
        #about
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct #type_name<T> { #(#texts pub #fields: T),* }

        #blank
        impl<T> From<[T; #count]> for #type_name<T> {
            fn from([#(#fields),*]: [T; #count]) -> Self {
                Self { #(#fields),* }
            }
        }

        #blank
        impl<T> From<#type_name<T>> for [T; #count] {
            fn from(#type_name { #(#fields),* }: #type_name<T>) -> Self {
                [#(#fields),*]
            }
        }
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
