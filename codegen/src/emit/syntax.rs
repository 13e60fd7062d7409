//! Identifiers and numbers.

use proc_macro2::{Ident, Literal, Span, TokenStream};
use quote::quote;

use crate::schedule::names::identifier;

/// Words that cannot name a value in Rust, in any edition; and statics, functions and types of the emitted text, which a
/// local must not shadow.
const RESERVED: &str = "Self abstract as async await become box break const continue crate do dyn else enum extern \
    false final fn for gen if impl in let loop macro match mod move mut override priv pub ref \
    return self static struct super trait true try type typeof unsafe unsized use virtual \
    where while yield lu_factor lu_solve None Some Ok Err INFO SPEC STATES INPUTS PARAMETERS \
    OUTPUTS SIGNALS SIGNAL_INPUTS CONSTRAINT_ROWS REACTIONS CONTACTS";

/// An identifier, whatever the text is. Keywords and names used by the emitted text get an underscore at the
/// end, and so do names that would then collide with these: different names stay different.
pub(super) fn ident(name: &str) -> Ident {
    let mut name = identifier(name);
    let stem = name.trim_end_matches('_');
    if RESERVED.split(' ').any(|word| word == stem) {
        name.push('_');
    }
    Ident::new(&name, Span::call_site())
}

/// An identifier of this crate.
pub(super) fn known(name: &'static str) -> Ident {
    Ident::new(name, Span::call_site())
}

/// A double as an exact literal, or a constant for non-finite values.
pub(super) fn number(value: f64) -> TokenStream {
    if value.is_nan() {
        return quote!(f64::NAN);
    }
    let magnitude = if value.is_infinite() {
        quote!(f64::INFINITY)
    } else {
        let literal = Literal::f64_unsuffixed(value.abs());
        quote!(#literal)
    };
    if value.is_sign_negative() {
        quote!(-#magnitude)
    } else {
        magnitude
    }
}
