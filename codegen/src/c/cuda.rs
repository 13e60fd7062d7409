//! Equations in CUDA C++, one source: the functions of C for processor and graphics card, and kernels that evaluate them at
//! many places, one thread a place. As C99 the same source evaluates the places one after another.
//!
//! Arrays of n places are lists of quantities, each with its n values one after another, so that neighbouring threads read
//! neighbouring numbers.

use std::fmt::Write as _;

use appell_spec::foreign::sentence;

use super::types::{GROUPS, Types};
use super::{Options, definition, heading, helpers, is_empty};
use crate::program::{Array, Function, FunctionKind, Layout, Own, Program, Space};
use crate::schedule::schedule;
use crate::text::shape;

/// The frame of the source; `NAME` is the prefix of all names.
pub(super) const FRAME: &str = "\
#ifndef __CUDACC_RTC__
#include <math.h>
#include <string.h>
#else
#ifndef NAN
#define NAN (0.0 / 0.0)
#endif
#ifndef INFINITY
#define INFINITY (1.0 / 0.0)
#endif
#endif

#ifdef __CUDACC__
#define NAME_FUNCTION static __host__ __device__ inline
#define NAME_KERNEL extern \"C\" __global__
#define NAME_EACH(i, n) \\
    int i = (int)(blockIdx.x * blockDim.x + threadIdx.x); i < (n); i += (int)(gridDim.x * blockDim.x)
#else
#define NAME_FUNCTION static inline
#define NAME_KERNEL
#define NAME_EACH(i, n) int i = 0; i < (n); i++
#endif

";

/// Emits the functions of a program, each with its kernel.
pub fn cuda(program: &Program, options: &Options) -> String {
    let types = Types::new(program, options.real);
    let functions: Vec<&Function> = super::emitted(program, options).collect();
    let bodies = functions.iter().map(|function| {
        let body = definition(&types, function, &schedule(program, function));
        format!("{}_FUNCTION {body}", types.prefix)
    });
    let bodies: String = bodies.collect();
    let mut text = format!(
        "/* {}\n *\n{} */\n\n",
        heading(program),
        about(&types, &functions, options)
    );
    text += &FRAME.replace("NAME", &types.prefix);
    text += &types.structures();
    let on_device = format!("{}_FUNCTION ", types.prefix);
    text += &helpers(options.real, &bodies).replace("static ", &on_device);
    text += &bodies;
    if options.integrator {
        text += &on_device;
        text += types.integrator().trim_start();
        text.push('\n');
    }
    for function in functions {
        text += &kernel(&types, function);
    }
    if options.integrator {
        text += &motions(&types);
    }
    text.trim_end().to_owned() + "\n"
}

/// A kernel of the source: its arguments are n, t, p, each, x, u, the additional one if there is one, and the results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Kernel {
    /// The function.
    pub function: FunctionKind,
    /// The name in the source.
    pub name: String,
    /// How many quantities the additional argument has, if there is one.
    pub own: Option<usize>,
    /// Names and shapes of the results that have entries.
    pub results: Vec<(String, Vec<usize>)>,
}

/// The kernels of the functions of a program.
pub fn kernels(program: &Program, options: &Options) -> Vec<Kernel> {
    let types = Types::new(program, options.real);
    let kernels = super::emitted(program, options).map(|function| {
        let results = function.results.iter();
        let results = results.filter(|array| !is_empty(program, array));
        let own = function.kind.takes();
        let own = own.map(|own| types.fields(space_of(own)).len());
        Kernel {
            function: function.kind,
            name: format!("{}_{}_places", types.prefix, function.kind.name()),
            own,
            results: results
                .map(|array| (array.name.clone(), shape(program, array.layout)))
                .collect(),
        }
    });
    kernels.collect()
}

/// The vector whose entries an additional argument has.
fn space_of(own: Own) -> Space {
    match own {
        Own::Accelerations => Space::Accelerations,
        Own::Weights => Space::State,
        Own::OutputWeights => Space::Outputs,
    }
}

/// The arrays of the kernels.
fn about(types: &Types<'_>, functions: &[&Function], options: &Options) -> String {
    let info = &types.program.info;
    let names = |quantities: &[appell_runtime::model::Quantity]| {
        let names = quantities.iter().map(|one| sentence(&one.name));
        names.collect::<Vec<_>>().join(", ")
    };
    let mut text = format!(
        " * Kernels NAME_FUNCTION_places(n, t, p, each, x, u, results), one thread a place. Quantity k of place i is at\n \
         * [k * n + i] of an array, entry (j, k) of a matrix with c columns at [(j * c + k) * n + i]. If each is 0, all\n \
         * places have the parameters p[k]. As C99 and without contraction the bits are those\n \
         * of the C source; elementary functions of a card may differ in the last place. All quantities are in SI.\n \
         *\n * x: {}\n * u: {}\n * p: {}\n",
        names(&info.states),
        names(&info.inputs),
        names(&info.parameters)
    )
    .replace("NAME", &types.prefix);
    for function in functions {
        let about = sentence(&function.kind.about().replace(['[', ']', '`'], ""));
        let _ = writeln!(text, " * {}: {about}", function.kind.name());
    }
    if options.integrator {
        let _ = writeln!(
            text,
            " * {}_motions(n, steps, t, dt, p, each, x, u): steps of the classical Runge-Kutta method, in place",
            types.prefix
        );
    }
    text
}

/// The list of parameters of a kernel, and the lines that load a place.
fn place(types: &Types<'_>) -> (String, String) {
    let real = types.real.name();
    let arguments = format!("const {real} *p, int each, {{}}{real} *x, const {real} *u");
    let mut load = String::new();
    for (space, name, array) in GROUPS {
        let _ = writeln!(load, "        {} {name};", types.type_name(space));
        for (k, field) in types.fields(space).iter().enumerate() {
            let index = match space {
                Space::Parameters => format!("each ? {k} * n + i : {k}"),
                _ => format!("{k} * n + i"),
            };
            let _ = writeln!(load, "        {name}.{field} = {array}[{index}];");
        }
    }
    (arguments, load)
}

/// Arguments that a kernel does not use.
fn unused(types: &Types<'_>) -> String {
    let mut text = String::new();
    for (space, _, array) in GROUPS {
        if types.fields(space).is_empty() {
            let _ = writeln!(text, "    (void){array};");
        }
        if space == Space::Parameters && types.fields(space).is_empty() {
            text.push_str("    (void)each;\n");
        }
    }
    text
}

fn kernel(types: &Types<'_>, function: &Function) -> String {
    let real = types.real.name();
    let (mut arguments, mut load) = place(types);
    arguments = arguments.replace("{}", "const ");
    let mut call = "&parameters, &state, &inputs".to_owned();
    if let Some(own) = function.kind.takes() {
        let name = own.name();
        let _ = write!(arguments, ", const {real} *{name}");
        load += &own_of_place(types, own);
        let reference = if own == Own::Accelerations { "&" } else { "" };
        let _ = write!(call, ", {reference}own");
    }
    let mut store = String::new();
    for array in &function.results {
        if !is_empty(types.program, array) {
            let name = format!("to_{}", crate::schedule::names::identifier(&array.name));
            let _ = write!(arguments, ", {real} *{name}");
            result(types, array, &name, [&mut load, &mut call, &mut store]);
        }
    }
    let (prefix, name) = (&types.prefix, function.kind.name());
    format!(
        "{prefix}_KERNEL void {prefix}_{name}_places(\n    int n, {real} t, {arguments}\n) {{\n{}    \
         for ({prefix}_EACH(i, n)) {{\n{load}        {prefix}_{name}(t, {call});\n{store}    }}\n}}\n\n",
        unused(types)
    )
}

/// The local of an additional argument.
fn own_of_place(types: &Types<'_>, own: Own) -> String {
    let (real, name) = (types.real.name(), own.name());
    let fields = types.fields(space_of(own));
    if own == Own::Accelerations {
        let mut text = format!("        {} own;\n", types.type_name(Space::Accelerations));
        for (k, field) in fields.iter().enumerate() {
            let _ = writeln!(text, "        own.{field} = {name}[{k} * n + i];");
        }
        return text;
    }
    let count = fields.len();
    format!(
        "        {real} own[{count}];\n        for (int k = 0; k < {count}; k++) {{\n            \
         own[k] = {name}[k * n + i];\n        }}\n"
    )
}

/// The local of a result, its argument, and the lines that store it.
fn result(types: &Types<'_>, array: &Array, to: &str, [locals, call, store]: [&mut String; 3]) {
    let real = types.real.name();
    let local = format!("own_{}", to.trim_start_matches("to_"));
    let (declared, reference, stored) = match (array.layout, &*shape(types.program, array.layout)) {
        (Layout::Vector(space), _) => {
            let fields = types.fields(space).into_iter().enumerate();
            let stored =
                fields.map(|(k, field)| format!("        {to}[{k} * n + i] = {local}.{field};\n"));
            let declared = format!("{} {local}", types.type_name(space));
            (declared, "&", stored.collect())
        }
        (_, [rows, columns]) => (
            format!("{real} {local}[{rows}][{columns}]"),
            "",
            format!(
                "        for (int j = 0; j < {rows}; j++) {{\n            for (int k = 0; k < {columns}; k++) {{\n                \
                 {to}[(j * {columns} + k) * n + i] = {local}[j][k];\n            }}\n        }}\n"
            ),
        ),
        (_, [count]) => (
            format!("{real} {local}[{count}]"),
            "",
            format!(
                "        for (int k = 0; k < {count}; k++) {{\n            {to}[k * n + i] = {local}[k];\n        }}\n"
            ),
        ),
        _ => (
            format!("{real} {local}"),
            "&",
            format!("        {to}[i] = {local};\n"),
        ),
    };
    // Writing to a string cannot fail.
    let _ = writeln!(locals, "        {declared};");
    let _ = write!(call, ", {reference}{local}");
    *store += &stored;
}

/// Many steps of many motions.
fn motions(types: &Types<'_>) -> String {
    let (real, prefix) = (types.real.name(), &types.prefix);
    let (arguments, load) = place(types);
    let arguments = arguments.replace("{}", "");
    let mut store = String::new();
    for (k, field) in types.fields(Space::State).iter().enumerate() {
        let _ = writeln!(store, "        x[{k} * n + i] = state.{field};");
    }
    format!(
        "{prefix}_KERNEL void {prefix}_motions(\n    int n, int steps, {real} t, {real} dt, {arguments}\n) {{\n{}    \
         for ({prefix}_EACH(i, n)) {{\n{load}        for (int step = 0; step < steps; step++) {{\n            \
         {prefix}_step(t + step * dt, dt, &parameters, &state, &inputs);\n        }}\n{store}    }}\n}}\n",
        unused(types)
    )
}
