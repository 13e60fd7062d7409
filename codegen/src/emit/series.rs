//! The recurrences of a motion's Taylor coefficients as Rust.

use proc_macro2::{Literal, TokenStream};
use quote::quote;
use syn::{Expr, Stmt};

use super::layout::blank_tokens;
use super::statements::Statements;
use super::syntax::{self as s, known};
use crate::program::{FunctionKind, Program};
use crate::schedule::names::ArgumentNames;
use crate::schedule::{Argument, Schedule, Tuning, schedule_tuned};
use crate::taylor::{Lengths, SeriesProgram, expand};

/// Names of the slices of arguments: time, states, inputs, parameters or what order zero kept, sums.
const SLICES: [&str; 5] = ["t", "x", "u", "p", "sums"];

/// What is emitted for the series.
pub(super) struct Emitted {
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
    let (start, sweep) = (
        function("series_start", &start),
        function("series_sweep", &sweep),
    );
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
    let items = quote! {
        use #runtime::series;

        #blank
        #start
        #blank
        #sweep

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
                series_start(from.t, [from.x, from.u, from.p, &[]], [to.next, to.kept, to.guards, &mut []]);
            }

            #blank
            fn sweep(&self, from: series::Sweep<'_>, to: series::Swept<'_>) {
                series_sweep(
                    from.k,
                    [from.x, from.u, from.kept, from.sums],
                    [to.next, to.left, to.right, to.guards],
                );
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
        items,
        method,
        solves,
    })
}

/// A schedule as a function of slices.
fn function(name: &'static str, schedule: &Schedule) -> TokenStream {
    let names = names(schedule);
    let mut statements = Statements::new(&names, schedule);
    for &argument in &schedule.arguments {
        let (slice, index) = match argument {
            Argument::Time => continue,
            Argument::State(index) => (SLICES[1], index),
            Argument::Input(index) => (SLICES[2], index),
            Argument::Parameter(index) => (SLICES[3], index),
            Argument::Weight(index) | Argument::OutputWeight(index) => (SLICES[4], index),
        };
        let value = s::entry(s::name(slice), &[index as usize]);
        statements.push(s::binding(names.get(argument)), value);
    }
    statements.constants();
    statements.steps();
    let results: Vec<Vec<Expr>> = (schedule.results.iter())
        .map(|array| statements.trees(&array.entries))
        .collect();
    let writes = results.iter().zip(["first", "second", "third", "fourth"]);
    let writes = writes
        .filter(|(entries, _)| !entries.is_empty())
        .map(|(entries, to)| {
            let to = known(to);
            quote!(#to.copy_from_slice(&[#(#entries),*]);)
        });
    let all: &[Stmt] = &statements.all;
    let (name, time) = (known(name), s::path(&names.time));
    let (slices, types) = (
        [SLICES[1], SLICES[2], SLICES[3], SLICES[4]].map(known),
        quote!(&[T]),
    );
    quote! {
        fn #name<T: Real>(
            #time: T,
            [#(#slices),*]: [#types; 4],
            [first, second, third, fourth]: [&mut [T]; 4],
        ) {
            #(#all)*
            #(#writes)*
        }
    }
}

/// Names of all arguments that a schedule uses.
fn names(schedule: &Schedule) -> ArgumentNames {
    let used = |place: fn(Argument) -> Option<u32>, letter: &str| -> Vec<String> {
        let last = schedule.arguments.iter().filter_map(|&a| place(a)).max();
        let count = last.map_or(0, |last| last + 1);
        (0..count)
            .map(|index| format!("{letter}_{index}"))
            .collect()
    };
    ArgumentNames {
        time: SLICES[0].to_owned(),
        states: used(
            |a| match a {
                Argument::State(index) => Some(index),
                _ => None,
            },
            SLICES[1],
        ),
        inputs: used(
            |a| match a {
                Argument::Input(index) => Some(index),
                _ => None,
            },
            SLICES[2],
        ),
        parameters: used(
            |a| match a {
                Argument::Parameter(index) => Some(index),
                _ => None,
            },
            SLICES[3],
        ),
        weights: used(
            |a| match a {
                Argument::Weight(index) => Some(index),
                _ => None,
            },
            "sum",
        ),
        output_weights: Vec::new(),
    }
}
