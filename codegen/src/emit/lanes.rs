//! The functions that a model evaluates in lanes, and one place at a time with the same bits.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::{format_ident, quote};

use super::layout::blank_tokens;
use super::syntax::{ident, known};
use super::types::{Types, result_struct};
use crate::program::{Function, FunctionKind, Layout, Program, Space};
use crate::schedule::OperationCount;

/// The functions.
const KINDS: [FunctionKind; 3] = [
    FunctionKind::Rates,
    FunctionKind::Jacobians,
    FunctionKind::Outputs,
];

/// Whether a function is evaluated in lanes, and has to be inlined into loops over them.
pub(super) fn in_lanes(kind: FunctionKind) -> bool {
    KINDS.contains(&kind)
}

/// Those of the program that have something to compute.
fn functions(program: &Program) -> impl Iterator<Item = &Function> {
    let functions = KINDS.into_iter().filter_map(|kind| program.function(kind));
    functions.filter(|function| {
        let mut results = function.results.iter();
        results.any(|array| !array.entries.is_empty())
    })
}

/// Name of the type that evaluates a function in lanes.
fn type_name(kind: FunctionKind) -> Ident {
    known(match kind {
        FunctionKind::Rates => "RatesInLanes",
        FunctionKind::Jacobians => "JacobiansInLanes",
        _ => "OutputsInLanes",
    })
}

/// The types that evaluate functions in lanes.
pub(super) fn equations(types: &Types<'_>, runtime: &syn::Path) -> TokenStream {
    let all = functions(types.program).map(|function| {
        let (name, call) = (type_name(function.kind), known(function.kind.name()));
        let time = types.program.info.explicit_time.then(|| quote!(at t));
        let [parameters, states, inputs] =
            [Space::Parameters, Space::State, Space::Inputs].map(|space| {
                let (name, fields) = (known(Types::type_name(space)), names(types, space));
                let count = Literal::usize_unsuffixed(types.fields(space).len());
                quote!(#name[#count] { #(#fields),* })
            });
        let results = results(types, function);
        let blank = blank_tokens();
        quote! {
            #blank
            #runtime::in_lanes! {
                #name = #call #time (#parameters, #states, #inputs) => #(#results)*
            }
        }
    });
    all.collect()
}

fn names<'a>(types: &'a Types<'_>, space: Space) -> impl Iterator<Item = Ident> + 'a {
    types.fields(space).iter().map(|field| ident(field))
}

/// Three arrays of results, each with its length and the fields that are written to it.
fn results(types: &Types<'_>, function: &Function) -> [TokenStream; 3] {
    let whole = result_struct(function).is_none();
    let fields = Types::result_fields(function);
    let mut results = [(); 3].map(|()| quote!([0]()));
    for ((array, field), result) in function.results.iter().zip(&fields).zip(&mut results) {
        let count = Literal::usize_unsuffixed(types.len(array.layout));
        let field = if whole { known("whole") } else { ident(field) };
        *result = match array.layout {
            Layout::Vector(space) => {
                let names = names(types, space);
                quote!([#count](#field [#(#names),*]))
            }
            Layout::Jacobian(rows, columns) => {
                let (rows, columns) = (names(types, rows), names(types, columns));
                quote!([#count](#field [#(#rows),*] [#(#columns),*]))
            }
            // No function in lanes has another.
            _ => quote!([0]()),
        };
    }
    results
}

/// The methods of `Model`.
pub(super) fn methods(types: &Types<'_>, costs: &[(FunctionKind, OperationCount)]) -> TokenStream {
    // Linear systems are loops of their own, which a loop over lanes does not make vector code of.
    let solves = |kind| (costs.iter()).any(|(of, cost)| *of == kind && cost.solves > 0);
    let all = functions(types.program).map(|function| {
        let equations = type_name(function.kind);
        let arguments: Vec<Ident> = match function.kind {
            FunctionKind::Jacobians => ["rates", "a", "b"].map(known).to_vec(),
            kind => vec![known(kind.name())],
        };
        let none = (arguments.len()..3).map(|_| quote!(&mut []));
        let results: Vec<TokenStream> = (arguments.iter().map(|name| quote!(#name)))
            .chain(none)
            .collect();
        let block = known(if solves(function.kind) {
            "places"
        } else {
            "block"
        });
        let in_lanes = format_ident!("{}_lanes", function.kind.name());
        let own = format_ident!("{}_own", function.kind.name());
        let blank = blank_tokens();
        quote! {
            #blank
            fn #in_lanes(&self, at: AtLanes<'_>, #(#arguments: &mut [[f64; LANES]]),*) {
                #equations::#block(at, [#(#results),*]);
            }

            #blank
            fn #own(&self, at: At<'_>, #(#arguments: &mut [f64]),*) {
                #equations::place(at, [#(#results),*]);
            }
        }
    });
    all.collect()
}
