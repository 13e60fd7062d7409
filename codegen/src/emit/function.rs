//! One function of a model: signature, rustdoc, body.

use quote::quote;
use syn::ItemFn;

use super::Error;
use super::body::body;
use super::layout::{blank_tokens, docs, one_line};
use super::syntax::ident;
use super::types::{Types, result_struct};
use crate::program::{Function, FunctionKind};
use crate::schedule::{Argument, OperationCount, Schedule};

/// Name of a function.
pub(super) fn function_name(kind: FunctionKind) -> &'static str {
    match kind {
        FunctionKind::Kinematics => "kinematics",
        FunctionKind::AccelerationEnergy => "acceleration_energy",
        FunctionKind::MassMatrix => "mass_matrix",
        FunctionKind::Bias => "bias",
        FunctionKind::GeneralizedForces => "generalized_forces",
        FunctionKind::Rates => "rates",
        FunctionKind::Jacobians => "jacobians",
        FunctionKind::AllJacobians => "all_jacobians",
        FunctionKind::Energies => "energies",
        FunctionKind::ConstraintResidual => "constraint_residual",
        FunctionKind::ConstraintForces => "constraint_forces",
        FunctionKind::Outputs => "outputs",
        FunctionKind::Switches => "switches",
    }
}

/// What a function returns, one sentence.
pub(super) fn about(kind: FunctionKind) -> &'static str {
    match kind {
        FunctionKind::Kinematics => {
            "Generalised velocities q̇ of pseudo-velocities and coordinates."
        }
        FunctionKind::AccelerationEnergy => {
            "Acceleration energy S (Gibbs function) at the actual motion."
        }
        FunctionKind::MassMatrix => {
            "Mass matrix M = ∂²S/∂ω̇², symmetric. Rows and columns follow [`Speeds`]."
        }
        FunctionKind::Bias => {
            "Bias b: what is left of ∂S/∂ω̇ where the pseudo-accelerations vanish."
        }
        FunctionKind::GeneralizedForces => {
            "Generalised forces Π: virtual power of the loads per pseudo-velocity."
        }
        FunctionKind::Rates => {
            "Rates ẋ of the state by Appell's equations M ω̇ + b = Π and kinematics."
        }
        FunctionKind::Jacobians => "Rates ẋ with their derivatives by state and inputs.",
        FunctionKind::AllJacobians => {
            "Rates ẋ with their derivatives by state, inputs and parameters."
        }
        FunctionKind::Energies => "Energies and power.",
        FunctionKind::ConstraintResidual => {
            "Constraint rows at the generalised velocities of the state: zero up to rounding."
        }
        FunctionKind::ConstraintForces => "Reactions in the ground, in N; one row per reaction.",
        FunctionKind::Outputs => "Outputs of the spec.",
        FunctionKind::Switches => {
            "What time alone switches: 1 where a relation holds, 0 elsewhere, and signs."
        }
    }
}

/// The function as an item.
pub(super) fn function(
    types: &Types<'_>,
    function: &Function,
    schedule: &Schedule,
    cost: &OperationCount,
) -> Result<ItemFn, Error> {
    for array in &function.results {
        let expected = types.len(array.layout);
        if expected != array.entries.len() {
            return Err(Error::Shape {
                kind: function.kind,
                array: array.name.clone(),
                expected,
                found: array.entries.len(),
            });
        }
    }
    let name = ident(function_name(function.kind));
    let mut lines = vec![about(function.kind).to_owned(), String::new()];
    lines.extend(super::picture::picture(types, function));
    lines.push(format!(
        "From `{}`.",
        one_line(&types.program.file).replace('`', "'")
    ));
    lines.push(format!("Operations: {cost}."));
    let about = docs(&lines);
    let blank = blank_tokens();
    let uses = |like: Argument| {
        let same =
            |&other: &Argument| std::mem::discriminant(&other) == std::mem::discriminant(&like);
        schedule.arguments.iter().any(same)
    };
    let argument = |name: &str, used: bool| {
        if used {
            ident(name)
        } else {
            quote::format_ident!("_{}", ident(name))
        }
    };
    let [time, parameters, state, inputs] = types.argument_names();
    let time = types.program.info.explicit_time.then(|| {
        let time = argument(time, uses(Argument::Time));
        quote!(#time: T,)
    });
    let parameters = argument(parameters, uses(Argument::Parameter(0)));
    let state = argument(state, uses(Argument::State(0)));
    let inputs = argument(inputs, uses(Argument::Input(0)));
    let result = match result_struct(function) {
        Some(name) => {
            let name = ident(name);
            quote!(#name<T>)
        }
        None => types.array_type(function.results[0].layout),
    };
    let tokens = quote! {
        #blank
        #about
        #[must_use]
        #[inline]
        pub fn #name<T: Real>(
            #time
            #parameters: &Parameters<T>,
            #state: &State<T>,
            #inputs: &Inputs<T>,
        ) -> #result {}
    };
    let mut item: ItemFn = syn::parse2(tokens).map_err(|error| Error::Syntax(error.to_string()))?;
    item.block.stmts = body(types, function, schedule);
    Ok(item)
}
