//! `INFO` and the implementation of `Model`, which need the standard library.

use appell_runtime::model::{Contact, Interpolation, ModelInfo, Quantity, Reaction};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::error::Error;
use super::layout::{blank_tokens, docs, escaped};
use super::syntax::{ident, known, path};
use super::types::{Types, double};
use crate::program::{FunctionKind, Layout, Program};
use crate::schedule::names::identifier;

/// Types of the emitted text beside the results of functions, which the model's own type must not
/// collide with.
const TYPES: &[&str] = &[
    "Parameters",
    "Speeds",
    "Coordinates",
    "State",
    "Inputs",
    "Outputs",
    "Real",
    "T",
    "Default",
    "From",
    "Option",
    "Result",
    "Some",
    "None",
    "Ok",
    "Err",
    "Vec",
    "Box",
    "Copy",
    "Clone",
    "Debug",
    "PartialEq",
    "Model",
    "ModelInfo",
    "String",
    "Send",
    "Sync",
    "Fn",
    "Drop",
];

/// Name of the model's type: the mechanism's name in camel case.
pub(super) fn type_name(types: &Types<'_>) -> String {
    let camel: String = types
        .program
        .info
        .name
        .split(|c: char| !c.is_ascii_alphanumeric())
        .flat_map(|word| {
            let mut letters = word.chars();
            let first = letters.next().map(|c| c.to_ascii_uppercase());
            first.into_iter().chain(letters)
        })
        .collect();
    let mut name = identifier(&camel);
    let results = FunctionKind::ALL.map(FunctionKind::result_struct);
    let taken = |name: &str| TYPES.contains(&name) || results.contains(&name);
    while taken(&name) || types.is_argument(&name) || name.len() < 2 {
        name.push_str("Model");
    }
    name
}

/// The statics that `INFO` is made of, and `INFO`.
pub(super) fn info(info: &ModelInfo) -> TokenStream {
    let quantities = |name: &'static str, about: &str, list: &[Quantity]| {
        let name = known(name);
        let about = docs(&[about.to_owned()]);
        let blank = blank_tokens();
        let count = Literal::usize_unsuffixed(list.len());
        let entries = list.iter().map(quantity);
        quote! {
            #blank
            #about
            static #name: [model::Quantity; #count] = [#(#entries),*];
        }
    };
    let states = quantities("STATES", "Pseudo-velocities and coordinates.", &info.states);
    let inputs = quantities("INPUTS", "Inputs and signals.", &info.inputs);
    let parameters = quantities("PARAMETERS", "Parameters.", &info.parameters);
    let outputs = quantities("OUTPUTS", "Outputs.", &info.outputs);
    let signals = signals(info);
    let [name, title, source] = [&info.name, &info.title, &info.source].map(|text| borrowed(text));
    let [speeds, declared_inputs] =
        [info.speeds, info.declared_inputs].map(Literal::usize_unsuffixed);
    let texts = |list: &[std::borrow::Cow<'static, str>]| {
        let texts = list.iter().map(|text| borrowed(text));
        quote!([#(#texts),*])
    };
    let rows = texts(&info.constraint_rows);
    let reactions = info.reactions.iter().map(reaction);
    let [row_count, reaction_count] =
        [info.constraint_rows.len(), info.reactions.len()].map(Literal::usize_unsuffixed);
    let contacts = info.contacts.iter().map(contact);
    let contact_count = Literal::usize_unsuffixed(info.contacts.len());
    let orders = info.signal_inputs.iter().map(|&(signal, order)| {
        let (signal, order) = (
            Literal::usize_unsuffixed(signal),
            Literal::u8_unsuffixed(order),
        );
        quote!((#signal, #order))
    });
    let order_count = Literal::usize_unsuffixed(info.signal_inputs.len());
    let explicit_time = info.explicit_time;
    let blank = blank_tokens();
    quote! {
        #states
        #inputs
        #parameters
        #outputs
        #signals
        #blank
        /// Signal and order of derivative behind the inputs that are signals.
        static SIGNAL_INPUTS: [(usize, u8); #order_count] = [#(#orders),*];
        #blank
        /// Constraint rows.
        static CONSTRAINT_ROWS: [model::Text; #row_count] = #rows;
        #blank
        /// Reactions in the ground.
        static REACTIONS: [model::Reaction; #reaction_count] = [#(#reactions),*];
        #blank
        /// Contacts, which can only push.
        static CONTACTS: [model::Contact; #contact_count] = [#(#contacts),*];
        #blank
        /// Names, units and sizes of the model.
        pub static INFO: model::ModelInfo = model::ModelInfo {
            name: #name,
            title: #title,
            source: #source,
            states: model::List::Borrowed(&STATES),
            speeds: #speeds,
            inputs: model::List::Borrowed(&INPUTS),
            declared_inputs: #declared_inputs,
            signals: model::List::Borrowed(&SIGNALS),
            signal_inputs: model::List::Borrowed(&SIGNAL_INPUTS),
            parameters: model::List::Borrowed(&PARAMETERS),
            outputs: model::List::Borrowed(&OUTPUTS),
            constraint_rows: model::List::Borrowed(&CONSTRAINT_ROWS),
            reactions: model::List::Borrowed(&REACTIONS),
            contacts: model::List::Borrowed(&CONTACTS),
            explicit_time: #explicit_time,
        };
    }
}

/// A reaction.
fn reaction(reaction: &Reaction) -> TokenStream {
    let [name, unit] = [&reaction.name, &reaction.unit].map(|text| borrowed(text));
    if reaction.on_point {
        quote!(model::Reaction::on_point(#name))
    } else {
        quote!(model::Reaction::multiplier(#name, #unit))
    }
}

/// A contact.
fn contact(contact: &Contact) -> TokenStream {
    let (name, grips) = (borrowed(&contact.name), contact.grips);
    let reaction = Literal::usize_unsuffixed(contact.reaction);
    let normal = contact.normal.map(double);
    let friction = contact.friction.map(double);
    let friction = friction.map_or_else(|| quote!(None), |friction| quote!(Some(#friction)));
    quote! {
        model::Contact {
            name: #name,
            reaction: #reaction,
            normal: [#(#normal),*],
            grips: #grips,
            friction: #friction,
        }
    }
}

/// A quantity, short where it is plain.
fn quantity(quantity: &Quantity) -> TokenStream {
    let Quantity {
        name,
        about,
        unit,
        scale,
        value,
        range: [low, high],
    } = quantity;
    let [name, about, unit]: [&str; 3] = [name, about, unit];
    let scaled = (scale.to_bits() != 1.0_f64.to_bits()).then(|| {
        let scale = double(*scale);
        quote!(.scaled(#scale))
    });
    let valued = (value.to_bits() != 0).then(|| {
        let value = double(*value);
        quote!(.valued(#value))
    });
    let within = (low.is_finite() || high.is_finite()).then(|| {
        let [low, high] = [*low, *high].map(double);
        quote!(.within(#low, #high))
    });
    quote!(model::Quantity::new(#name, #about, #unit) #scaled #valued #within)
}

fn borrowed(text: &str) -> TokenStream {
    quote!(model::Text::Borrowed(#text))
}

fn signals(info: &ModelInfo) -> TokenStream {
    let count = Literal::usize_unsuffixed(info.signals.len());
    let blank = blank_tokens();
    let tables = info.signals.iter().map(|signal| {
        let name = borrowed(&signal.name);
        let times = signal.times.iter().map(|&time| double(time));
        let values = signal.values.iter().map(|&value| double(value));
        let interpolation = known(match signal.interpolation {
            Interpolation::Hold => "Hold",
            Interpolation::Linear => "Linear",
            Interpolation::Cubic => "Cubic",
        });
        quote! {
            model::SignalTable {
                name: #name,
                times: model::List::Borrowed(&[#(#times),*]),
                values: model::List::Borrowed(&[#(#values),*]),
                interpolation: model::Interpolation::#interpolation,
            }
        }
    });
    quote! {
        #blank
        /// Tabulated functions of time.
        static SIGNALS: [model::SignalTable; #count] = [#(#tables),*];
    }
}

/// The unit struct and its `impl Model`.
pub(super) fn implementation(types: &Types<'_>) -> Result<TokenStream, Error> {
    let name = path(&type_name(types));
    let title = docs(&[escaped(&types.program.info.title)]);
    let helpers = helpers(&types.program.info);
    let bodies = [
        motion_methods(types)?,
        appell_method(types)?,
        energies_method(types)?,
        optional_method(
            types,
            FunctionKind::ConstraintResidual,
            "constraint_residual",
            "residual",
        )?,
        optional_method(
            types,
            FunctionKind::ConstraintForces,
            "constraint_forces",
            "forces",
        )?,
        optional_method(types, FunctionKind::Outputs, "outputs", "outputs")?,
        switches_methods(types),
        position_methods(types),
        contact_methods(types),
        system_methods(types),
        adjoint_methods(types),
        output_derivative_methods(types),
    ];
    let blank = blank_tokens();
    Ok(quote! {
        #blank
        #title
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
        pub struct #name;

        #blank
        const _: () = {
            #helpers

            #blank
            impl model::Model for #name {
                fn info(&self) -> &model::ModelInfo {
                    &INFO
                }
                #(#bodies)*
            }
        };
    })
}

/// Sizes, and conversions between slices and structs.
fn helpers(info: &ModelInfo) -> TokenStream {
    let [n, s, m, k] = [
        info.states.len(),
        info.speeds,
        info.inputs.len(),
        info.parameters.len(),
    ]
    .map(Literal::usize_unsuffixed);
    let blank = blank_tokens();
    quote! {
        use model::At;

        #blank
        const N: usize = #n;
        const S: usize = #s;
        const M: usize = #m;
        const K: usize = #k;

        #blank
        /// The first numbers of a slice that holds at least as many.
        fn first<const LEN: usize>(numbers: &[f64]) -> [f64; LEN] {
            core::array::from_fn(|i| numbers[i])
        }

        #blank
        fn parameters(at: &At<'_>) -> Parameters<f64> {
            first::<K>(at.p).into()
        }

        #blank
        fn state(at: &At<'_>) -> State<f64> {
            first::<N>(at.x).into()
        }

        #blank
        fn inputs(at: &At<'_>) -> Inputs<f64> {
            first::<M>(at.u).into()
        }

        #blank
        fn write(to: &mut [f64], from: &[f64]) {
            to.copy_from_slice(from);
        }
    }
}

/// Rates and their derivatives.
fn motion_methods(types: &Types<'_>) -> Result<TokenStream, Error> {
    for kind in [
        FunctionKind::Rates,
        FunctionKind::Jacobians,
        FunctionKind::ParameterJacobian,
    ] {
        required(types.program, kind)?;
    }
    let [rates, jacobians, parameter_jacobian] =
        ["rates", "jacobians", "parameter_jacobian"].map(|name| call(types, name));
    let blank = blank_tokens();
    Ok(quote! {
        #blank
        fn rates(&self, at: At<'_>, rates: &mut [f64]) {
            write(rates, &<[f64; N]>::from(self::#rates));
        }

        #blank
        fn jacobians(&self, at: At<'_>, rates: &mut [f64], a: &mut [f64], b: &mut [f64]) {
            let all = #jacobians;
            write(rates, &<[f64; N]>::from(all.rates));
            write(a, all.a.as_flattened());
            write(b, all.b.as_flattened());
        }

        #blank
        fn parameter_jacobian(&self, at: At<'_>, p: &mut [f64]) {
            write(p, self::#parameter_jacobian.as_flattened());
        }
    })
}

/// Mass matrix, bias and pseudo-forces.
fn appell_method(types: &Types<'_>) -> Result<TokenStream, Error> {
    for kind in [
        FunctionKind::MassMatrixAndBias,
        FunctionKind::GeneralizedForces,
    ] {
        required(types.program, kind)?;
    }
    let [both, forces] =
        ["mass_matrix_and_bias", "generalized_forces"].map(|name| call(types, name));
    let blank = blank_tokens();
    Ok(quote! {
        #blank
        fn appell(&self, at: At<'_>, mass: &mut [f64], bias: &mut [f64], forces: &mut [f64]) {
            let left = #both;
            write(mass, left.mass_matrix.as_flattened());
            write(bias, &<[f64; S]>::from(left.bias));
            write(forces, &<[f64; S]>::from(#forces));
        }
    })
}

/// Energies, the acceleration energy among them.
fn energies_method(types: &Types<'_>) -> Result<TokenStream, Error> {
    required(types.program, FunctionKind::Energies)?;
    let acceleration = required(types.program, FunctionKind::AccelerationEnergy)?;
    let [energies, s] = ["energies", "acceleration_energy"].map(|name| call(types, name));
    let total = (acceleration.results.len() != 1).then(|| quote!(.total));
    let blank = blank_tokens();
    Ok(quote! {
        #blank
        fn energies(&self, at: At<'_>) -> model::Energies {
            let all = #energies;
            model::Energies {
                kinetic: all.kinetic,
                potential: all.potential,
                power: all.power,
                acceleration: #s #total,
            }
        }
    })
}

/// What time alone switches; the trait has an answer for models without switches.
fn switches_methods(types: &Types<'_>) -> TokenStream {
    let mut functions = types.program.functions.iter();
    let Some(function) = functions.find(|function| function.kind == FunctionKind::Switches) else {
        return TokenStream::new();
    };
    let count = Literal::usize_unsuffixed(types.len(function.results[0].layout));
    let call = call(types, "switches");
    let blank = blank_tokens();
    quote! {
        #blank
        fn switch_len(&self) -> usize {
            #count
        }

        #blank
        fn switches(&self, at: At<'_>, switches: &mut [f64]) {
            write(switches, &self::#call);
        }
    }
}

/// Position constraints; the trait has an answer for models without any.
fn position_methods(types: &Types<'_>) -> TokenStream {
    let dependent = &types.program.dependent;
    if dependent.is_empty() {
        return TokenStream::new();
    }
    let dependent = dependent.iter().map(|&q| Literal::usize_unsuffixed(q));
    let call = call(types, FunctionKind::PositionConstraints.name());
    let blank = blank_tokens();
    quote! {
        #blank
        fn dependent_coordinates(&self) -> &[usize] {
            &[#(#dependent),*]
        }

        #blank
        fn position_constraints(&self, at: At<'_>, residual: &mut [f64], jacobian: &mut [f64]) {
            let all = self::#call;
            write(residual, &all.residual);
            write(jacobian, all.jacobian.as_flattened());
        }
    }
}

/// Surfaces that change; the trait has an answer for those that do not.
fn contact_methods(types: &Types<'_>) -> TokenStream {
    if types.program.function(FunctionKind::Contacts).is_none() {
        return TokenStream::new();
    }
    let call = call(types, FunctionKind::Contacts.name());
    let blank = blank_tokens();
    quote! {
        #blank
        fn contacts(&self, at: At<'_>, normals: &mut [f64], friction: &mut [f64]) {
            let all = self::#call;
            write(normals, all.normals.as_flattened());
            write(friction, &all.friction);
        }
    }
}

/// Systems solved with pivoting; the trait has an answer for models without any.
fn system_methods(types: &Types<'_>) -> TokenStream {
    let sizes = &types.program.systems;
    if types.program.function(FunctionKind::Systems).is_none() {
        return TokenStream::new();
    }
    let sizes = sizes.iter().map(|&size| Literal::usize_unsuffixed(size));
    let call = call(types, FunctionKind::Systems.name());
    let blank = blank_tokens();
    quote! {
        #blank
        fn system_sizes(&self) -> &[usize] {
            &[#(#sizes),*]
        }

        #blank
        fn systems(&self, at: At<'_>, matrices: &mut [f64]) {
            write(matrices, &self::#call);
        }
    }
}

/// The adjoint of the rates; the trait differentiates by differences where there is none.
fn adjoint_methods(types: &Types<'_>) -> TokenStream {
    let kind = FunctionKind::Adjoint;
    if types.program.function(kind).is_none() {
        return TokenStream::new();
    }
    let method = gradient_method(types, kind);
    let blank = blank_tokens();
    quote! {
        #blank
        fn has_adjoint(&self) -> bool {
            true
        }
        #method
    }
}

/// Derivatives of the outputs, and their adjoint.
fn output_derivative_methods(types: &Types<'_>) -> TokenStream {
    let kind = FunctionKind::OutputJacobians;
    let count = Literal::usize_unsuffixed(types.program.info.outputs.len());
    let call = call(types, kind.name());
    let blank = blank_tokens();
    let jacobians = types.program.function(kind).map(|_| {
        quote! {
            #blank
            fn output_jacobians(&self, at: At<'_>, outputs: &mut [f64], c: &mut [f64], d: &mut [f64]) {
                let all = self::#call;
                write(outputs, &<[f64; #count]>::from(all.outputs));
                write(c, all.c.as_flattened());
                write(d, all.d.as_flattened());
            }
        }
    });
    let kind = FunctionKind::OutputAdjoint;
    let adjoint = (types.program.function(kind)).map(|_| gradient_method(types, kind));
    quote!(#jacobians #adjoint)
}

/// A method that writes the gradient of a weighted sum.
fn gradient_method(types: &Types<'_>, kind: FunctionKind) -> TokenStream {
    let name = ident(kind.name());
    let time = types.program.info.explicit_time.then(|| quote!(at.t,));
    let count = Literal::usize_unsuffixed(types.weights(kind));
    let blank = blank_tokens();
    quote! {
        #blank
        fn #name(&self, at: At<'_>, weights: &[f64], by: model::Gradient<'_>) {
            let weights = first::<#count>(weights);
            let all = self::#name(#time &parameters(&at), &state(&at), &inputs(&at), &weights);
            write(by.x, &all.x);
            write(by.u, &all.u);
            write(by.p, &all.p);
        }
    }
}

/// A function that `impl Model` cannot do without.
fn required(program: &Program, kind: FunctionKind) -> Result<&crate::program::Function, Error> {
    let found = program
        .functions
        .iter()
        .find(|function| function.kind == kind);
    found.ok_or(Error::MissingFunction(kind))
}

/// `function(t, &parameters(&at), &state(&at), &inputs(&at))`
fn call(types: &Types<'_>, function: &str) -> TokenStream {
    let function = ident(function);
    let time = types.program.info.explicit_time.then(|| quote!(at.t,));
    quote!(#function(#time &parameters(&at), &state(&at), &inputs(&at)))
}

/// A method whose result may be empty; its function may then be missing.
fn optional_method(
    types: &Types<'_>,
    kind: FunctionKind,
    method: &str,
    slot: &str,
) -> Result<TokenStream, Error> {
    let info = &types.program.info;
    let expected = match kind {
        FunctionKind::ConstraintResidual => info.constraint_rows.len(),
        FunctionKind::ConstraintForces => info.reactions.len(),
        _ => info.outputs.len(),
    };
    let (method, slot) = (ident(method), ident(slot));
    let blank = blank_tokens();
    if expected == 0 {
        return Ok(quote! {
            #blank
            fn #method(&self, _at: At<'_>, _none: &mut [f64]) {}
        });
    }
    let function = required(types.program, kind)?;
    let call = call(types, kind.name());
    let layout = function
        .results
        .first()
        .map_or(Layout::Scalar, |array| array.layout);
    let count = Literal::usize_unsuffixed(types.len(layout));
    let from = match layout {
        Layout::Matrix(..) => quote!(self::#call.as_flattened()),
        Layout::Vector(_) => quote!(&self::#call),
        Layout::Scalar => quote!(&[self::#call]),
        _ => quote!(&<[f64; #count]>::from(self::#call)),
    };
    Ok(quote! {
        #blank
        fn #method(&self, at: At<'_>, #slot: &mut [f64]) {
            write(#slot, #from);
        }
    })
}
