//! The recurrences of a motion's Taylor coefficients as Rust.

use proc_macro2::{Literal, TokenStream, TokenTree};
use quote::quote;
use syn::Stmt;

use super::layout::blank_tokens;
use super::statements::{ARRAY, Places, Statements};
use super::syntax::{self as s, known};
use crate::program::{FunctionKind, Program};
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
    let argument = |argument: Argument| {
        let (slice, index) = match argument {
            Argument::Time => {
                let field = known(time);
                return syn::parse_quote!(from.#field);
            }
            Argument::State(index) => (0, index),
            Argument::Input(index) => (1, index),
            Argument::Parameter(index) => (2, index),
            Argument::Weight(index)
            | Argument::OutputWeight(index)
            | Argument::Acceleration(index) => (3, index),
        };
        let field = known(slices[slice]);
        s::entry(syn::parse_quote!(from.#field), &[index as usize])
    };
    let places = Places::Array {
        argument: &argument,
    };
    let mut statements = Statements::new(places, schedule);
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
    let (array, count) = (
        known(ARRAY),
        Literal::usize_unsuffixed(schedule.names.len()),
    );
    let values = (!schedule.names.is_empty()).then(|| quote!(let mut #array = [0.0; #count];));
    let all = quote!(#values #(#all)* #writes);
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
