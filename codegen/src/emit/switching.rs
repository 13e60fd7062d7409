//! What switches an emitted model; the trait has an answer for models that nothing switches.

use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::error::Error;
use super::layout::blank_tokens;
use super::model::written;
use super::syntax::known;
use super::types::Types;
use crate::program::{FunctionKind, Space};

/// The implementation of `Switching`, and the method of `Model` that offers it.
pub(super) fn implementation(
    types: &Types<'_>,
    name: &syn::Path,
    runtime: &syn::Path,
) -> Result<[TokenStream; 2], Error> {
    let counts = types.program.switch_counts();
    if counts.is_none() {
        return Ok(Default::default());
    }
    let [of_time, of_state] = [FunctionKind::Switches, FunctionKind::Crossings].map(|kind| {
        let to = known(kind.name());
        match types.program.function(kind) {
            Some(_) => written(types, kind, &[quote!(#to)]),
            None => Ok(quote!(let _ = (at, #to);)),
        }
    });
    let (of_time, of_state) = (of_time?, of_state?);
    let within = within(types);
    let [answers, shapes, crossings] =
        [counts.answers, counts.shapes, counts.crossings].map(Literal::usize_unsuffixed);
    let blank = blank_tokens();
    let items = quote! {
        #blank
        impl model::Switching for #name {
            fn counts(&self) -> Counts {
                Counts {
                    answers: #answers,
                    shapes: #shapes,
                    crossings: #crossings,
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
        use #runtime::switching::Counts;
        #items
    };
    Ok([items, method])
}

/// The functions of time between two times. They are functions of time and parameters alone.
fn within(types: &Types<'_>) -> TokenStream {
    let kind = FunctionKind::TimeFunctions;
    if types.program.function(kind).is_none() {
        return quote!(let _ = (time, p, functions););
    }
    let [parameters, state, inputs] =
        [Space::Parameters, Space::State, Space::Inputs].map(|space| {
            let name = known(Types::type_name(space));
            match (types.fields(space), space) {
                ([], _) => quote!(#name {}),
                (_, Space::Parameters) => {
                    quote!(#name::from(first(p).map(Enclosure::constant)))
                }
                _ => quote!(#name::from(core::array::from_fn(|_| Enclosure::UNKNOWN))),
            }
        });
    let function = known(kind.name());
    let time = types.program.info.explicit_time.then(|| quote!(time,));
    quote! {
        let all = self::#function(#time &#parameters, &#state, &#inputs);
        for (to, from) in functions.iter_mut().zip(all.functions.into_iter().chain(all.shapes)) {
            *to = from;
        }
    }
}
