//! Switching functions of an emitted model; the trait has a default for models without any.

use proc_macro2::{Ident, Literal, TokenStream};
use quote::quote;

use super::error::Error;
use super::layout::blank_tokens;
use super::model::written;
use super::syntax::known;
use super::types::Types;
use crate::program::{FunctionKind, Space};
use crate::text::type_name;

/// The implementation of `Switching`, and the method of `Model` that returns it.
pub(super) fn implementation(
    types: &Types<'_>,
    name: &Ident,
    runtime: &syn::Path,
) -> Result<[TokenStream; 2], Error> {
    let counts = types.program.switch_counts();
    if counts.is_none() {
        return Ok(Default::default());
    }
    let has = |kind| types.program.function(kind).is_some();
    let of_time = if has(FunctionKind::Switches) {
        written(types, FunctionKind::Switches, &[quote!(switches)])?
    } else {
        quote!(let _ = (at, switches);)
    };
    let [answers, shapes, crossings, pulses] = [
        counts.answers,
        counts.shapes,
        counts.crossings,
        counts.pulses,
    ]
    .map(Literal::usize_unsuffixed);
    let of_state = if has(FunctionKind::Crossings) {
        let slices = [quote!(crossings), quote!(pulses)];
        let written = written(types, FunctionKind::Crossings, &slices)?;
        quote! {
            let (crossings, pulses) = crossings.split_at_mut(#crossings);
            #written
        }
    } else {
        quote!(let _ = (at, crossings);)
    };
    let [within, along] = [bounds_in_time(types), bounds_along(types)];
    let blank = blank_tokens();
    let items = quote! {
        #blank
        impl model::Switching for #name {
            fn counts(&self) -> Counts {
                Counts {
                    answers: #answers,
                    shapes: #shapes,
                    crossings: #crossings,
                    pulses: #pulses,
                }
            }

            #blank
            fn answers(&self, at: At<'_>, switches: &mut [f64]) {
                #of_time
            }

            #blank
            fn within(&self, time: Enclosure, p: &[f64], functions: &mut [Enclosure]) {
                #within
            }

            #blank
            fn crossings(&self, at: At<'_>, crossings: &mut [f64]) {
                #of_state
            }

            #blank
            fn crossings_within(&self, along: &Along<'_>, crossings: &mut [Enclosure]) {
                #along
            }
        }
    };
    let method = quote! {
        #blank
        fn switching(&self) -> Option<&dyn model::Switching> {
            Some(self)
        }
    };
    let items = quote! {
        use #runtime::Enclosure;
        use #runtime::model::Along;
        use #runtime::switching::Counts;
        #items
    };
    Ok([items, method])
}

/// Bounds on the functions of time and parameters between two times.
fn bounds_in_time(types: &Types<'_>) -> TokenStream {
    let kind = FunctionKind::TimeFunctions;
    if types.program.function(kind).is_none() {
        return quote!(let _ = (time, p, functions););
    }
    let unknown = quote!(core::array::from_fn(|_| Enclosure::UNKNOWN));
    let call = call(types, kind, &quote!(p), [&unknown, &unknown]);
    stored(&call, ["functions", "functions", "shapes"])
}

/// Writes both results of a call into a slice, one after the other.
fn stored(call: &TokenStream, [slice, first, second]: [&'static str; 3]) -> TokenStream {
    let [slice, first, second] = [slice, first, second].map(known);
    quote! {
        let all = #call;
        for (to, from) in #slice.iter_mut().zip(all.#first.into_iter().chain(all.#second)) {
            *to = from;
        }
    }
}

/// Bounds on the functions of the state along a trajectory segment.
fn bounds_along(types: &Types<'_>) -> TokenStream {
    let kind = FunctionKind::Crossings;
    if types.program.function(kind).is_none() {
        return quote!(let _ = (along, crossings););
    }
    let call = call(
        types,
        kind,
        &quote!(along.p),
        [
            &quote!(core::array::from_fn(|i| along.x[i])),
            &quote!(core::array::from_fn(|i| along.u[i])),
        ],
    );
    let time = types.program.info.explicit_time;
    let time = time.then(|| quote!(let time = along.t;));
    let stored = stored(&call, ["crossings", "crossings", "pulses"]);
    quote!(#time #stored)
}

/// Calls a function on bounds; those of the states and the inputs are given.
fn call(
    types: &Types<'_>,
    kind: FunctionKind,
    p: &TokenStream,
    [states, inputs]: [&TokenStream; 2],
) -> TokenStream {
    let arguments = [Space::Parameters, Space::State, Space::Inputs].map(|space| {
        let name = known(type_name(space));
        match (types.fields(space), space) {
            ([], _) => quote!(#name {}),
            (_, Space::Parameters) => quote!(#name::from(first(#p).map(Enclosure::constant))),
            (_, Space::State) => quote!(#name::from(#states)),
            _ => quote!(#name::from(#inputs)),
        }
    });
    let [parameters, state, inputs] = arguments;
    let function = known(kind.name());
    let time = types.program.info.explicit_time.then(|| quote!(time,));
    quote!(self::#function(#time &#parameters, &#state, &#inputs))
}
