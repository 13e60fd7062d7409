//! The recurrences of a motion's Taylor coefficients as Rust.

use proc_macro2::{Literal, TokenStream, TokenTree};
use quote::quote;
use syn::Stmt;

use super::layout::blank_tokens;
use super::statements::Statements;
use super::syntax::{self as s, known};
use crate::program::{FunctionKind, Program};
use crate::schedule::names::ArgumentNames;
use crate::schedule::{Argument, Schedule, Tuning, schedule_tuned};
use crate::taylor::{Lengths, SeriesProgram, expand};

/// What is emitted for the series.
pub(super) struct Emitted {
    pub(super) uses: TokenStream,
    /// The type that implements `Series`, its functions and its shape.
    pub(super) items: TokenStream,
    /// The method of `Model`.
    pub(super) method: TokenStream,
    /// Whether linear systems are solved.
    pub(super) solves: bool,
}

/// The series of the rates of a program; nothing where it has none.
pub(super) fn emitted(program: &Program, runtime: &syn::Path, tuning: Tuning) -> Option<Emitted> {
    let rates = program.function(FunctionKind::Rates)?;
    let rates = schedule_tuned(program, rates, tuning);
    let SeriesProgram {
        shape,
        start,
        sweep,
    } = expand(&rates, Lengths::from(&program.info));
    let solves = [&start, &sweep].iter().any(|schedule| {
        let mut steps = schedule.steps.iter();
        steps.any(|step| matches!(step, crate::schedule::Step::Factor { .. }))
    });
    let [start, sweep] = [
        body(["x", "u", "p", ""], "t", &start),
        body(["x", "u", "kept", "sums"], "k", &sweep),
    ];
    let [states, inputs, parameters, kept, products] = [
        shape.states,
        shape.inputs,
        shape.parameters,
        shape.kept,
        shape.products,
    ]
    .map(Literal::usize_unsuffixed);
    let guards = shape.guards.iter().map(|guard| {
        let guard = quote::format_ident!("{guard:?}");
        quote!(series::Guard::#guard)
    });
    let blank = blank_tokens();
    let uses = quote!(use #runtime::series;);
    let items = quote! {
        #blank
        /// The equations with the recurrences of their Taylor coefficients.
        struct TaylorSeries;

        #blank
        static SHAPE: series::Shape = series::Shape {
            states: #states,
            inputs: #inputs,
            parameters: #parameters,
            kept: #kept,
            products: #products,
            guards: model::List::Borrowed(&[#(#guards),*]),
        };

        #blank
        impl series::Series for TaylorSeries {
            fn shape(&self) -> &series::Shape {
                &SHAPE
            }

            #blank
            fn start(&self, from: series::Start<'_>, to: series::Started<'_>) {
                #start
            }

            #blank
            fn sweep(&self, from: series::Sweep<'_>, to: series::Swept<'_>) {
                #sweep
            }
        }
    };
    let method = quote! {
        #blank
        fn series(&self) -> Option<&dyn series::Series> {
            Some(&TaylorSeries)
        }
    };
    Some(Emitted {
        uses,
        items,
        method,
        solves,
    })
}

/// A schedule as the body of a method; `slices` are the fields of what it reads, beside the time.
fn body(slices: [&'static str; 4], time: &'static str, schedule: &Schedule) -> TokenStream {
    let names = names(slices, time, schedule);
    let mut statements = Statements::new(&names, schedule);
    for &argument in &schedule.arguments {
        let value = match place(argument) {
            Some((slice, index)) => {
                let field = known(slices[slice]);
                s::entry(syn::parse_quote!(from.#field), &[index as usize])
            }
            None => {
                let field = known(time);
                syn::parse_quote!(from.#field)
            }
        };
        statements.push(s::binding(names.get(argument)), value);
    }
    statements.constants();
    statements.steps();
    let results = schedule
        .results
        .iter()
        .filter(|array| !array.entries.is_empty());
    let writes = results.map(|array| {
        let (to, entries) = (s::ident(&array.name), statements.trees(&array.entries));
        quote!(to.#to.copy_from_slice(&[#(#entries),*]);)
    });
    let writes: TokenStream = writes.collect();
    let all: &[Stmt] = &statements.all;
    let all = quote!(#(#all)* #writes);
    // Numbers and choices are those of a scalar type.
    let scalar = all.clone().into_iter().any(|token| uses_scalar(&token));
    let scalar = scalar.then(|| {
        quote!(
            type T = f64;
        )
    });
    quote!(#scalar #all)
}

fn uses_scalar(token: &TokenTree) -> bool {
    match token {
        TokenTree::Ident(name) => name == "T",
        TokenTree::Group(group) => group.stream().into_iter().any(|token| uses_scalar(&token)),
        _ => false,
    }
}

/// The slice and the place in it that hold an argument; none of the time.
fn place(argument: Argument) -> Option<(usize, u32)> {
    match argument {
        Argument::Time => None,
        Argument::State(index) => Some((0, index)),
        Argument::Input(index) => Some((1, index)),
        Argument::Parameter(index) => Some((2, index)),
        Argument::Weight(index) | Argument::OutputWeight(index) => Some((3, index)),
    }
}

/// Names of all arguments that a schedule uses.
fn names(slices: [&str; 4], time: &str, schedule: &Schedule) -> ArgumentNames {
    let [states, inputs, parameters, weights] = [0, 1, 2, 3].map(|slice| {
        let used = schedule
            .arguments
            .iter()
            .filter_map(|&argument| place(argument));
        let last = used
            .filter(|(of, _)| *of == slice)
            .map(|(_, index)| index)
            .max();
        let count = last.map_or(0, |last| last + 1);
        (0..count)
            .map(|index| format!("{}_{index}", slices[slice]))
            .collect()
    });
    ArgumentNames {
        time: time.to_owned(),
        states,
        inputs,
        parameters,
        weights,
        output_weights: Vec::new(),
    }
}
