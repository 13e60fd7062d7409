//! `INFO` and the implementation of `Model`, which need the standard library.

use appell_runtime::model::{Interpolation, ModelInfo, Quantity};
use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::Error;
use super::layout::{blank_tokens, docs, escaped};
use super::syntax::{ident, path};
use super::types::{Types, double};
use crate::program::{FunctionKind, Layout, Program};
use crate::schedule::names::identifier;

/// Types of the emitted text, which the model's own type must not collide with.
const TYPES: &[&str] = &[
    "Parameters", "Speeds", "Coordinates", "State", "Inputs", "Outputs", "Jacobians",
    "AllJacobians", "Energies", "AccelerationEnergy", "Kinematics", "MassMatrix", "Bias",
    "GeneralizedForces", "Rates", "ConstraintResidual", "ConstraintForces", "OutputArrays", "Real",
    "T", "Default", "From", "Option", "Result", "Some", "None", "Ok", "Err", "Vec", "Box", "Copy",
    "Clone", "Debug", "PartialEq", "Model", "ModelInfo", "String", "Send", "Sync", "Fn", "Drop",
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
    while TYPES.contains(&name.as_str()) || types.is_argument(&name) || name.len() < 2 {
        name.push_str("Model");
    }
    name
}

/// The statics that `INFO` is made of, and `INFO`.
pub(super) fn info(info: &ModelInfo, runtime: &syn::Path) -> TokenStream {
    let quantities = |name: &str, about: &str, list: &[Quantity]| {
        let name = ident_of_static(name);
        let about = docs(&[about.to_owned()]);
        let blank = blank_tokens();
        let count = Literal::usize_unsuffixed(list.len());
        let entries = list.iter().map(|q| {
            let Quantity { name, about, unit, scale, value, range } = q;
            let [scale, value, low, high] = [*scale, *value, range[0], range[1]].map(double);
            let texts = [name, about, unit].map(|text| borrowed(runtime, text));
            let [name, about, unit] = texts;
            quote! {
                #runtime::model::Quantity {
                    name: #name,
                    about: #about,
                    unit: #unit,
                    scale: #scale,
                    value: #value,
                    range: [#low, #high],
                }
            }
        });
        quote! {
            #blank
            #about
            static #name: [#runtime::model::Quantity; #count] = [#(#entries),*];
        }
    };
    let states = quantities("STATES", "Pseudo-velocities and coordinates.", &info.states);
    let inputs = quantities("INPUTS", "Inputs and signals.", &info.inputs);
    let parameters = quantities("PARAMETERS", "Parameters.", &info.parameters);
    let outputs = quantities("OUTPUTS", "Outputs.", &info.outputs);
    let signals = signals(info, runtime);
    let [name, title, source] = [&info.name, &info.title, &info.source].map(|text| borrowed(runtime, text));
    let [speeds, declared_inputs] = [info.speeds, info.declared_inputs].map(Literal::usize_unsuffixed);
    let texts = |list: &[std::borrow::Cow<'static, str>]| {
        let texts = list.iter().map(|text| borrowed(runtime, text));
        quote!([#(#texts),*])
    };
    let rows = texts(&info.constraint_rows);
    let reactions = texts(&info.reactions);
    let [row_count, reaction_count] =
        [info.constraint_rows.len(), info.reactions.len()].map(Literal::usize_unsuffixed);
    let orders = info.signal_inputs.iter().map(|&(signal, order)| {
        let (signal, order) = (Literal::usize_unsuffixed(signal), Literal::u8_unsuffixed(order));
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
        static CONSTRAINT_ROWS: [#runtime::model::Text; #row_count] = #rows;
        #blank
        /// Reactions in the ground.
        static REACTIONS: [#runtime::model::Text; #reaction_count] = #reactions;
        #blank
        /// Names, units and sizes of the model.
        pub static INFO: #runtime::model::ModelInfo = #runtime::model::ModelInfo {
            name: #name,
            title: #title,
            source: #source,
            states: #runtime::model::List::Borrowed(&STATES),
            speeds: #speeds,
            inputs: #runtime::model::List::Borrowed(&INPUTS),
            declared_inputs: #declared_inputs,
            signals: #runtime::model::List::Borrowed(&SIGNALS),
            signal_inputs: #runtime::model::List::Borrowed(&SIGNAL_INPUTS),
            parameters: #runtime::model::List::Borrowed(&PARAMETERS),
            outputs: #runtime::model::List::Borrowed(&OUTPUTS),
            constraint_rows: #runtime::model::List::Borrowed(&CONSTRAINT_ROWS),
            reactions: #runtime::model::List::Borrowed(&REACTIONS),
            explicit_time: #explicit_time,
        };
    }
}

fn ident_of_static(name: &str) -> Ident {
    Ident::new(name, proc_macro2::Span::call_site())
}

fn borrowed(runtime: &syn::Path, text: &str) -> TokenStream {
    quote!(#runtime::model::Text::Borrowed(#text))
}

fn signals(info: &ModelInfo, runtime: &syn::Path) -> TokenStream {
    let count = Literal::usize_unsuffixed(info.signals.len());
    let blank = blank_tokens();
    let tables = info.signals.iter().map(|signal| {
        let name = borrowed(runtime, &signal.name);
        let times = signal.times.iter().map(|&time| double(time));
        let values = signal.values.iter().map(|&value| double(value));
        let interpolation = ident(match signal.interpolation {
            Interpolation::Hold => "Hold",
            Interpolation::Linear => "Linear",
            Interpolation::Cubic => "Cubic",
        });
        quote! {
            #runtime::model::SignalTable {
                name: #name,
                times: #runtime::model::List::Borrowed(&[#(#times),*]),
                values: #runtime::model::List::Borrowed(&[#(#values),*]),
                interpolation: #runtime::model::Interpolation::#interpolation,
            }
        }
    });
    quote! {
        #blank
        /// Tabulated functions of time.
        static SIGNALS: [#runtime::model::SignalTable; #count] = [#(#tables),*];
    }
}

/// The unit struct and its `impl Model`.
pub(super) fn implementation(types: &Types<'_>, runtime: &syn::Path) -> Result<TokenStream, Error> {
    let program = types.program;
    let name = path(&type_name(types));
    let title = docs(&[escaped(&program.info.title)]);
    let blank = blank_tokens();
    let rates = {
        required(program, FunctionKind::Rates)?;
        let call = call(types, "rates");
        quote!(write(rates, &<[f64; N]>::from(#call));)
    };
    let with_jacobians = {
        required(program, FunctionKind::Jacobians)?;
        let call = call(types, "jacobians");
        quote! {
            let all = #call;
            write(rates, &<[f64; N]>::from(all.rates));
            write(a, all.a.as_flattened());
            write(b, all.b.as_flattened());
        }
    };
    let parameter_jacobian = {
        required(program, FunctionKind::AllJacobians)?;
        let call = call(types, "all_jacobians");
        quote!(write(p, #call.p.as_flattened());)
    };
    let appell = {
        for kind in [FunctionKind::MassMatrix, FunctionKind::Bias, FunctionKind::GeneralizedForces] {
            required(program, kind)?;
        }
        let [m, b, f] = ["mass_matrix", "bias", "generalized_forces"].map(|name| call(types, name));
        quote! {
            write(mass, #m.as_flattened());
            write(bias, &<[f64; S]>::from(self::#b));
            write(forces, &<[f64; S]>::from(#f));
        }
    };
    let energies = {
        required(program, FunctionKind::Energies)?;
        let acceleration = required(program, FunctionKind::AccelerationEnergy)?;
        let several = acceleration.results.len() != 1;
        let [energies, s] = ["energies", "acceleration_energy"].map(|name| call(types, name));
        let total = several.then(|| quote!(.total));
        quote! {
            let all = #energies;
            #runtime::model::Energies {
                kinetic: all.kinetic,
                potential: all.potential,
                power: all.power,
                acceleration: #s #total,
            }
        }
    };
    let residual = optional(types, FunctionKind::ConstraintResidual, "residual")?;
    let reactions = optional(types, FunctionKind::ConstraintForces, "forces")?;
    let outputs = optional(types, FunctionKind::Outputs, "outputs")?;
    let [n, s, m, k] = [
        program.info.states.len(),
        program.info.speeds,
        program.info.inputs.len(),
        program.info.parameters.len(),
    ]
    .map(Literal::usize_unsuffixed);
    let at = |body: &TokenStream| if body.is_empty() { quote!(_at) } else { quote!(at) };
    let slot = |body: &TokenStream, name: &str| {
        let name = ident(name);
        if body.is_empty() { quote::format_ident!("_{name}") } else { name }
    };
    let (residual_at, residual_slot) = (at(&residual), slot(&residual, "residual"));
    let (reactions_at, reactions_slot) = (at(&reactions), slot(&reactions, "forces"));
    let (outputs_at, outputs_slot) = (at(&outputs), slot(&outputs, "outputs"));
    Ok(quote! {
        #blank
        #title
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
        pub struct #name;

        #blank
        const _: () = {
            use #runtime::model::At;

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

            #blank
            impl #runtime::model::Model for #name {
                fn info(&self) -> &#runtime::model::ModelInfo {
                    &INFO
                }

                #blank
                fn rates(&self, at: At<'_>, rates: &mut [f64]) {
                    #rates
                }

                #blank
                fn jacobians(&self, at: At<'_>, rates: &mut [f64], a: &mut [f64], b: &mut [f64]) {
                    #with_jacobians
                }

                #blank
                fn parameter_jacobian(&self, at: At<'_>, p: &mut [f64]) {
                    #parameter_jacobian
                }

                #blank
                fn appell(&self, at: At<'_>, mass: &mut [f64], bias: &mut [f64], forces: &mut [f64]) {
                    #appell
                }

                #blank
                fn energies(&self, at: At<'_>) -> #runtime::model::Energies {
                    #energies
                }

                #blank
                fn constraint_residual(&self, #residual_at: At<'_>, #residual_slot: &mut [f64]) {
                    #residual
                }

                #blank
                fn constraint_forces(&self, #reactions_at: At<'_>, #reactions_slot: &mut [f64]) {
                    #reactions
                }

                #blank
                fn outputs(&self, #outputs_at: At<'_>, #outputs_slot: &mut [f64]) {
                    #outputs
                }
            }
        };
    })
}

/// A function that `impl Model` cannot do without.
fn required(program: &Program, kind: FunctionKind) -> Result<&crate::program::Function, Error> {
    let found = program.functions.iter().find(|function| function.kind == kind);
    found.ok_or(Error::MissingFunction(kind))
}

/// `function(t, &parameters(&at), &state(&at), &inputs(&at))`
fn call(types: &Types<'_>, function: &str) -> TokenStream {
    let function = ident(function);
    let time = types.program.info.explicit_time.then(|| quote!(at.t,));
    quote!(#function(#time &parameters(&at), &state(&at), &inputs(&at)))
}

/// The body of a method whose result may be empty, and whose function may then be missing.
fn optional(types: &Types<'_>, kind: FunctionKind, slot: &str) -> Result<TokenStream, Error> {
    let info = &types.program.info;
    let expected = match kind {
        FunctionKind::ConstraintResidual => info.constraint_rows.len(),
        FunctionKind::ConstraintForces => info.reactions.len(),
        _ => info.outputs.len(),
    };
    if expected == 0 {
        return Ok(TokenStream::new());
    }
    let function = required(types.program, kind)?;
    let call = call(types, super::function::function_name(kind));
    let slot = ident(slot);
    let layout = function.results.first().map_or(Layout::Scalar, |array| array.layout);
    let count = Literal::usize_unsuffixed(types.len(layout));
    Ok(match layout {
        Layout::Matrix(..) => quote!(write(#slot, #call.as_flattened());),
        Layout::Vector(_) => quote!(write(#slot, &#call);),
        Layout::Scalar => quote!(write(#slot, &[#call]);),
        _ => quote!(write(#slot, &<[f64; #count]>::from(#call));),
    })
}
