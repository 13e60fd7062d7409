//! One function of a model: signature, rustdoc, body.

use appell_spec::foreign::sentence;
use proc_macro2::TokenStream;
use quote::quote;

use super::body::body;
use super::error::Error;
use super::layout::{blank_tokens, code, docs};
use super::syntax::{ident, known};
use super::types::{Types, result_struct};
use crate::program::{Function, Term};
use crate::tape::{Argument, OperationCount, Tape};
use crate::text::{GROUPS, shape};

/// Meanings of the rows and columns of a plain array that has no struct.
fn rows_and_columns(function: &Function) -> Vec<String> {
    let [array] = function.results.as_slice() else {
        return Vec::new();
    };
    let [rows, columns] = &array.names;
    let list = |names: &[String]| {
        let names: Vec<String> = names.iter().map(|name| code(name)).collect();
        names.join(", ")
    };
    match (rows.is_empty(), columns.is_empty()) {
        (true, _) => Vec::new(),
        (false, true) => vec![format!("Rows: {}.", list(rows)), String::new()],
        (false, false) => vec![
            format!("Rows: {}. Columns: {}.", list(rows), list(columns)),
            String::new(),
        ],
    }
}

/// Meanings of the names in the body of a function or in its displayed equations.
fn glossary(function: &Function, tape: &Tape, told: &[String]) -> Vec<String> {
    let occurs = |term: &&Term| {
        let mut names = tape.names.iter().flatten().chain(told);
        names.any(|name| term.explains(name))
    };
    let mut lines: Vec<String> = function
        .glossary
        .iter()
        .filter(occurs)
        .map(|term| format!("- {}: {}", code(&term.symbol), sentence(&term.meaning)))
        .collect();
    if !lines.is_empty() {
        lines.push(String::new());
    }
    lines
}

/// The function as an item.
pub(super) fn function(
    types: &Types<'_>,
    function: &Function,
    tape: &Tape,
    cost: &OperationCount,
) -> Result<TokenStream, Error> {
    for array in &function.results {
        let expected = shape(types.program, array.layout).iter().product();
        if expected != array.entries.len() {
            return Err(Error::Shape {
                kind: function.kind,
                array: array.name.clone(),
                expected,
                found: array.entries.len(),
            });
        }
    }
    let name = known(function.kind.name());
    let mut lines = vec![function.kind.about().to_owned(), String::new()];
    lines.extend(super::picture::picture(types, function));
    let (equations, told) = super::equations::equations(types, function);
    lines.extend(equations);
    lines.extend(rows_and_columns(function));
    for remark in &function.remarks {
        lines.extend([sentence(remark), String::new()]);
    }
    lines.extend(glossary(function, tape, &told));
    lines.push(format!("From {}.", code(&types.program.file)));
    lines.push(format!("Operations: {cost}."));
    let about = docs(&lines);
    let blank = blank_tokens();
    let used = tape.arguments();
    let uses = |like: Argument| used.iter().any(|argument| argument.is_like(like));
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
    let groups = GROUPS.into_iter().zip([parameters, state, inputs]);
    let groups = groups.map(|((space, like), name)| {
        let (name, vector) = (argument(name, uses(like)), types.vector(space, &quote!(T)));
        quote!(#name: &#vector,)
    });
    let own = types.own(function.kind).map(|(name, type_name)| {
        let all = [
            Argument::Weight(0),
            Argument::OutputWeight(0),
            Argument::Acceleration(0),
        ];
        let name = argument(&name, all.into_iter().any(uses));
        quote!(#name: &#type_name,)
    });
    let result = match result_struct(function) {
        Some(name) => {
            let name = known(name);
            quote!(#name<T>)
        }
        None => types.array_type(function.results[0].layout),
    };
    let body: TokenStream = body(types, function, tape)
        .parse()
        .map_err(|error: proc_macro2::LexError| Error::Syntax(error.to_string()))?;
    Ok(quote! {
        #blank
        #about
        #[must_use]
        #[inline]
        pub fn #name<T: Real>(
            #time
            #(#groups)*
            #own
        ) -> #result {
            #body
        }
    })
}
