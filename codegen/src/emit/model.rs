//! Emits the implementation of `Model`, which needs the standard library.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::error::Error;
use super::layout::{blank_tokens, docs, escaped};
use super::switching;
use super::syntax::{ident, known};
use super::types::Types;
use crate::program::{FunctionKind, Layout, Own, Program, Space};
use crate::text::{shape, type_name};

/// Names in the emitted text, in addition to the result types of functions, that the type of the model must not
/// collide with.
const TYPES: &str = "Parameters State Inputs Outputs Rates Accelerations CoordinateRates GeneralizedForces \
    ConstraintResidual ConstraintForces Real T Default From Option Result Some None Ok Err Vec \
    Box Copy Clone Debug PartialEq Model ModelInfo At String Send Sync Fn Drop";

/// Name of the model's type: the mechanism's name in camel case.
pub(super) fn model_name(types: &Types<'_>) -> String {
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
    let mut name = ident(&camel).to_string();
    let results = FunctionKind::ALL.map(FunctionKind::result_struct);
    let taken = |name: &str| TYPES.split(' ').any(|word| word == name) || results.contains(&name);
    while taken(&name) || types.is_field(&name) || name.len() < 2 {
        name.push_str("Model");
    }
    name
}

/// The unit struct and its `impl Model`.
pub(super) fn implementation(types: &Types<'_>, runtime: &syn::Path) -> Result<TokenStream, Error> {
    let name = ident(&model_name(types));
    let title = escaped(&types.program.info.title);
    let stop = if title.ends_with(['.', '!', '?']) {
        ""
    } else {
        "."
    };
    let title = docs(&[format!("{title}{stop}")]);
    let helpers = helpers(types);
    let [switching, switching_method] = switching::implementation(types, &name, runtime)?;
    let bodies = [
        method(types, FunctionKind::Rates, &["rates"])?,
        method(types, FunctionKind::Jacobians, &["rates", "a", "b"])?,
        provided(types, FunctionKind::ParameterJacobian, &["p"])?,
        appell_method(types)?,
        energies_method(types)?,
        method_or_nothing(types, FunctionKind::ConstraintResidual, "residual")?,
        method_or_nothing(types, FunctionKind::ConstraintForces, "forces")?,
        method_or_nothing(types, FunctionKind::Outputs, "outputs")?,
        switching_method,
        position_methods(types)?,
        provided(types, FunctionKind::Contacts, &["normals", "friction"])?,
        system_methods(types)?,
        provided(types, FunctionKind::InverseDynamics, &["demand"])?,
        provided(
            types,
            FunctionKind::InverseDynamicsJacobians,
            &["demand", "by_state", "by_inputs", "mass"],
        )?,
        adjoint_methods(types)?,
        provided(types, FunctionKind::OutputJacobians, &["outputs", "c", "d"])?,
        provided(types, FunctionKind::OutputAdjoint, &[])?,
    ];
    let named = named(types, &name);
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
            #switching
            #named
        };
    })
}

/// Conversions between slices and structs.
fn helpers(types: &Types<'_>) -> TokenStream {
    let blank = blank_tokens();
    let [parameters, state, inputs] = [Space::Parameters, Space::State, Space::Inputs]
        .map(|space| types.vector(space, &quote!(f64)));
    quote! {
        use model::At;

        #blank
        /// The first numbers of a slice that holds at least as many.
        fn first<const LEN: usize>(numbers: &[f64]) -> [f64; LEN] {
            core::array::from_fn(|i| numbers[i])
        }

        #blank
        fn parameters(at: &At<'_>) -> #parameters {
            first(at.p).into()
        }

        #blank
        fn state(at: &At<'_>) -> #state {
            first(at.x).into()
        }

        #blank
        fn inputs(at: &At<'_>) -> #inputs {
            first(at.u).into()
        }

        #blank
        fn write(to: &mut [f64], from: &[f64]) {
            to.copy_from_slice(from);
        }
    }
}

/// `function(t, &parameters(&at), &state(&at), &inputs(&at), &weights)`
fn call(types: &Types<'_>, kind: FunctionKind) -> TokenStream {
    let function = known(kind.name());
    let time = types.program.info.explicit_time.then(|| quote!(at.t,));
    let own = kind.takes().map(|own| {
        let name = known(own.name());
        quote!(, &#name)
    });
    quote!(self::#function(#time &parameters(&at), &state(&at), &inputs(&at) #own))
}

/// Writes a result of a layout into a slice.
fn write(types: &Types<'_>, layout: Layout, to: &TokenStream, from: &TokenStream) -> TokenStream {
    if shape(types.program, layout).contains(&0) {
        return quote!(let _ = #to;);
    }
    match layout {
        Layout::Scalar => quote!(write(#to, &[#from]);),
        Layout::List(_) => quote!(write(#to, &#from);),
        Layout::Matrix(..) => quote!(write(#to, #from.as_flattened());),
        Layout::Vector(_) => quote!(write(#to, &#from.to_array());),
        Layout::Rows(..) => quote!(write(#to, #from.to_array().as_flattened());),
        Layout::Jacobian(_, columns) => {
            let columns = known(type_name(columns));
            quote!(write(#to, #from.map(#columns::to_array).to_array().as_flattened());)
        }
    }
}

/// Writes the results of a function into slices, in their order.
pub(super) fn written(
    types: &Types<'_>,
    kind: FunctionKind,
    slices: &[TokenStream],
) -> Result<TokenStream, Error> {
    let function = required(types.program, kind)?;
    if function
        .results
        .iter()
        .all(|array| array.entries.is_empty())
    {
        return Ok(quote!(let _ = (at, #(#slices),*);));
    }
    let call = call(types, kind);
    if let [array] = function.results.as_slice() {
        return Ok(slices
            .iter()
            .map(|to| write(types, array.layout, to, &call))
            .collect());
    }
    let fields = Types::result_fields(function);
    let parts = function.results.iter().zip(fields).zip(slices);
    let parts = parts.map(|((array, field), to)| {
        let field = ident(&field);
        write(types, array.layout, to, &quote!(all.#field))
    });
    Ok(quote!(let all = #call; #(#parts)*))
}

/// A method that writes the results of the function of its name into its arguments, those of gradients into the parts of
/// one.
fn method(types: &Types<'_>, kind: FunctionKind, arguments: &[&str]) -> Result<TokenStream, Error> {
    let name = known(kind.name());
    let mut slices: Vec<TokenStream> = (arguments.iter().map(|name| ident(name)))
        .map(|name| quote!(#name))
        .collect();
    let results = quote!(#(#slices: &mut [f64]),*);
    let (arguments, own) = match kind.takes() {
        None => (results, None),
        Some(Own::Accelerations) => {
            let given = known(type_name(Space::Accelerations));
            let own = quote!(let accelerations = #given::from(first(accelerations)););
            (quote!(accelerations: &[f64], #results), Some(own))
        }
        Some(Own::Weights | Own::OutputWeights) => {
            slices = vec![quote!(by.x), quote!(by.u), quote!(by.p)];
            let arguments = quote!(weights: &[f64], by: model::Gradient<'_>);
            (arguments, Some(quote!(let weights = first(weights);)))
        }
    };
    let body = written(types, kind, &slices)?;
    let blank = blank_tokens();
    Ok(quote! {
        #blank
        fn #name(&self, at: At<'_>, #arguments) {
            #own
            #body
        }
    })
}

/// [`method`] if the program has the function; the trait has a default implementation for the others.
fn provided(
    types: &Types<'_>,
    kind: FunctionKind,
    arguments: &[&str],
) -> Result<TokenStream, Error> {
    match types.program.function(kind) {
        Some(_) => method(types, kind, arguments),
        None => Ok(TokenStream::new()),
    }
}

/// A method whose result may be empty; its function may then be missing.
fn method_or_nothing(
    types: &Types<'_>,
    kind: FunctionKind,
    argument: &str,
) -> Result<TokenStream, Error> {
    let info = &types.program.info;
    let expected = match kind {
        FunctionKind::ConstraintResidual => info.constraint_rows.len(),
        FunctionKind::ConstraintForces => info.reactions.len(),
        _ => info.outputs.len(),
    };
    if expected > 0 {
        return method(types, kind, &[argument]);
    }
    let name = known(kind.name());
    let blank = blank_tokens();
    Ok(quote! {
        #blank
        fn #name(&self, _at: At<'_>, _none: &mut [f64]) {}
    })
}

/// Mass matrix, bias and pseudo-forces.
fn appell_method(types: &Types<'_>) -> Result<TokenStream, Error> {
    let left = written(
        types,
        FunctionKind::MassMatrixAndBias,
        &[quote!(mass), quote!(bias)],
    )?;
    let right = written(types, FunctionKind::GeneralizedForces, &[quote!(forces)])?;
    let blank = blank_tokens();
    Ok(quote! {
        #blank
        fn appell(&self, at: At<'_>, mass: &mut [f64], bias: &mut [f64], forces: &mut [f64]) {
            #left
            #right
        }
    })
}

/// Energies, including the acceleration energy.
fn energies_method(types: &Types<'_>) -> Result<TokenStream, Error> {
    required(types.program, FunctionKind::Energies)?;
    let acceleration = required(types.program, FunctionKind::AccelerationEnergy)?;
    let [energies, s] =
        [FunctionKind::Energies, FunctionKind::AccelerationEnergy].map(|kind| call(types, kind));
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

/// Position constraints; the trait has a default implementation for models without any.
fn position_methods(types: &Types<'_>) -> Result<TokenStream, Error> {
    let dependent = &types.program.dependent;
    if dependent.is_empty() {
        return Ok(TokenStream::new());
    }
    let arguments = ["residual", "jacobian"];
    let method = method(types, FunctionKind::PositionConstraints, &arguments)?;
    let dependent = list_method("dependent_coordinates", dependent);
    Ok(quote!(#dependent #method))
}

/// Systems solved with pivoting; the trait has a default implementation for models without any.
fn system_methods(types: &Types<'_>) -> Result<TokenStream, Error> {
    let kind = FunctionKind::Systems;
    let sizes = types.program.function(kind);
    let sizes = sizes.map(|_| list_method("system_sizes", &types.program.systems));
    let method = provided(types, kind, &["matrices"])?;
    Ok(quote!(#sizes #method))
}

/// A method that returns a list.
fn list_method(name: &'static str, list: &[usize]) -> TokenStream {
    let name = known(name);
    let list = list.iter().map(|&one| Literal::usize_unsuffixed(one));
    let blank = blank_tokens();
    quote! {
        #blank
        fn #name(&self) -> &[usize] {
            &[#(#list),*]
        }
    }
}

/// The adjoint of the rates; the default implementation of the trait uses differences.
fn adjoint_methods(types: &Types<'_>) -> Result<TokenStream, Error> {
    let kind = FunctionKind::Adjoint;
    let blank = blank_tokens();
    let has_adjoint = types.program.function(kind).map(|_| {
        quote! {
            #blank
            fn has_adjoint(&self) -> bool {
                true
            }
        }
    });
    let method = provided(types, kind, &[])?;
    Ok(quote!(#has_adjoint #method))
}

/// The rows of a trajectory with the named entries of the model.
fn named(types: &Types<'_>, model: &Ident) -> TokenStream {
    let [state, inputs, outputs] = [Space::State, Space::Inputs, Space::Outputs]
        .map(|space| types.vector(space, &quote!(f64)));
    let values = match types.fields(Space::Outputs) {
        [] => quote!(Outputs {}),
        _ => call(types, FunctionKind::Outputs),
    };
    let blank = blank_tokens();
    quote! {
        #blank
        impl model::Named for #model {
            type State = #state;
            type Inputs = #inputs;
            type Outputs = #outputs;

            #blank
            fn named(&self, at: At<'_>) -> model::Row<Self> {
                model::Row {
                    t: at.t,
                    state: state(&at),
                    inputs: inputs(&at),
                    outputs: #values,
                }
            }
        }
    }
}

/// A function that `impl Model` requires.
fn required(program: &Program, kind: FunctionKind) -> Result<&crate::program::Function, Error> {
    program.function(kind).ok_or(Error::MissingFunction(kind))
}
