//! Emits readable Rust from a program. All knowledge of Rust syntax in this crate is here.
//!
//! The files: [`types`] emits the structs, [`function`] signatures and rustdoc, [`body`] the statements of functions,
//! [`model`] implements the run-time trait, [`equations`] displays the equations of a function, [`picture`] draws small
//! matrices, [`layout`] inserts comments and blank lines, [`markdown`] writes the page about the model, and [`syntax`]
//! has identifiers and numbers.

mod body;
mod equations;
mod error;
mod function;
mod info;
mod layout;
mod markdown;
mod model;
mod picture;
mod switching;
mod syntax;
mod types;

use quote::quote;

use crate::program::{FunctionKind, Program};
use crate::schedule::schedule;
use crate::tape::OperationCount;
use types::Types;

pub use error::Error;

/// Options of the emission.
#[derive(Debug, Clone)]
pub struct Options {
    /// The functions; empty for all that the program has.
    pub functions: Vec<FunctionKind>,
    /// Path of the run-time crate in the emitted text.
    pub runtime: String,
    /// Whether to emit `INFO` and the implementation of `Model`, which need the standard library
    /// and all functions.
    pub model_impl: bool,
    /// Text of the spec, emitted as the constant `SPEC`.
    pub spec: Option<String>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            functions: Vec::new(),
            runtime: "::appell_runtime".to_owned(),
            model_impl: true,
            spec: None,
        }
    }
}

/// Emitted text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Emitted {
    /// Rust, to be included in a module that allows `non_snake_case`.
    pub source: String,
    /// The page about the model, in Markdown.
    pub docs: String,
    /// Name of the type that implements `Model`.
    pub model: String,
    /// Operation counts of every function.
    pub costs: Vec<(FunctionKind, OperationCount)>,
}

/// Emits the functions `kinds` and the structs they need, without the implementation of `Model`.
pub fn emit_functions(program: &Program, kinds: &[FunctionKind]) -> Result<Emitted, Error> {
    let options = Options {
        functions: kinds.to_vec(),
        model_impl: false,
        ..Options::default()
    };
    emit(program, &options)
}

/// Emits a model.
pub fn emit(program: &Program, options: &Options) -> Result<Emitted, Error> {
    let runtime: syn::Path = syn::parse_str(&options.runtime)
        .map_err(|_| Error::RuntimePath(options.runtime.clone()))?;
    let types = Types::new(program);
    let mut functions: Vec<_> = program
        .functions
        .iter()
        .filter(|function| {
            options.functions.is_empty() || options.functions.contains(&function.kind)
        })
        .collect();
    functions.sort_by_key(|function| function.kind);

    let mut costs = Vec::new();
    let mut items = Vec::new();
    for &function in &functions {
        let tape = schedule(program, function);
        let cost = OperationCount::of(&tape);
        items.push(function::function(&types, function, &tape, &cost)?);
        costs.push((function.kind, cost));
    }
    let results = functions.iter().filter_map(|one| types.results_struct(one));
    let solves = costs.iter().any(|(_, cost)| cost.solves > 0);
    let lu = solves.then(|| quote!(use #runtime::dense::{lu_factor, lu_solve};));
    let model = options.model_impl.then(|| quote!(use #runtime::model;));
    let structs = types.structs(&functions, options.model_impl);
    let implementation = options
        .model_impl
        .then(|| model::implementation(&types, &runtime))
        .transpose()?;
    let info = options.model_impl.then(|| info::info(&program.info));
    let conversions = types.conversions(&functions, options.model_impl, &runtime);
    let file = quote! {
        use #runtime::Real;
        #lu
        #model
        #(#structs)*
        #(#results)*
        #(#items)*
        #implementation
        #info
        #(#conversions)*
    };
    let file = syn::parse2(file).map_err(|error| Error::Syntax(error.to_string()))?;
    let mut source = options
        .spec
        .as_deref()
        .map(markdown::spec_constant)
        .unwrap_or_default();
    source.push_str(&layout::with_blank_lines(&prettyplease::unparse(&file)));
    let docs = markdown::page(&types, &costs);
    let model = model::model_name(&types);
    Ok(Emitted {
        source,
        docs,
        model,
        costs,
    })
}
