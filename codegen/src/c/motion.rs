//! Motions in CUDA C++, with laws, events and kept quantities: one thread a motion. As C99 the same source computes them
//! one after another.

use std::fmt::Write as _;

use appell_runtime::integrate::{Coefficients, Options, Range, Row};
use appell_spec::foreign::sentence;

use super::{Real, computed, cuda, helpers};
use crate::schedule::names::ArgumentNames;
use crate::tape::{Argument, Tape};
use crate::text::Text;

/// The integrator, which the functions and constants before it determine.
const INTEGRATOR: &str = include_str!("motion.cu");

/// Of functions that stay calls, so that sources compile in a second, and of lists.
const QUALIFIERS: &str = "\
#ifdef __CUDACC__
#define motion_CALLED static __noinline__ __host__ __device__
#define motion_CONSTANT __constant__ const
#else
#define motion_CALLED static inline
#define motion_CONSTANT static const
#endif

";

/// How a quantity is followed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Followed {
    /// Its maximum, and the time of it.
    Largest,
    /// Its minimum, and the time of it.
    Smallest,
    /// Its mean.
    Mean,
}

/// A motion from time 0. Tapes have one result, a list; their inputs are `inputs` numbers, zero but for the last ones,
/// the noises.
#[derive(Debug, Clone)]
pub struct Motion<'a> {
    /// The title of the source.
    pub title: &'a str,
    /// Number of states, inputs and parameters.
    pub sizes: [usize; 3],
    /// Columns of a row.
    pub columns: usize,
    /// Rates of the state.
    pub rates: &'a Tape,
    /// Switching functions of the state.
    pub crossings: &'a Tape,
    /// Event functions: an event is their rise through zero.
    pub events: &'a Tape,
    /// Column of each event in a row, its time being the next one, and whether it ends the motion.
    pub event_columns: Vec<(usize, bool)>,
    /// Quantities that are followed.
    pub followed: &'a Tape,
    /// How each is followed, and its column.
    pub followed_columns: Vec<(Followed, usize)>,
    /// Position constraints: what they are off by, then their derivatives in the coordinates, row by row.
    pub constraints: &'a Tape,
    /// How many there are, and how many coordinates, the last states.
    pub constrained: [usize; 2],
    /// Quantities that are recorded at given times or at the end.
    pub recorded: &'a Tape,
    /// Those of the end: index among the recorded ones, and column.
    pub end_columns: Vec<(usize, usize)>,
    /// The embedded pair.
    pub method: Coefficients,
    /// Tolerances, and the limit of steps.
    pub options: Options,
    /// End of the motion in s.
    pub end: f64,
    /// The longest interval in s on which a quantity is approximated by one polynomial.
    pub interval: f64,
    /// States that end the motion.
    pub ranges: Vec<Range>,
    /// Noises: the interval in s for which a number is held, and how many there are.
    pub noises: Vec<(f64, usize)>,
}

/// The source of a kernel `motion_cases`.
pub fn motion(motion: &Motion<'_>) -> String {
    let functions = [
        ("rates", motion.rates),
        ("crossings", motion.crossings),
        ("events", motion.events),
        ("followed", motion.followed),
        ("recorded", motion.recorded),
        ("constraints", motion.constraints),
    ];
    let bodies: String = functions
        .iter()
        .map(|(name, tape)| over_arrays(&format!("motion_{name}"), tape, motion.sizes))
        .collect();
    let on_device = "motion_FUNCTION ";
    let mut text = format!(
        "/* {}: motions, a thread each. */\n\n",
        sentence(motion.title)
    );
    text += &cuda::FRAME.replace("NAME", "motion");
    text += QUALIFIERS;
    text += &constants(motion);
    text += &helpers(Real::Double, &bodies).replace("static ", on_device);
    text += &bodies;
    let [first, second, third] = parts();
    text += first;
    text += &interior(&motion.method);
    text += second;
    text += &attempt(&motion.method);
    text + third
}

/// The integrator before the stages of its interpolant, before the stages of a step, and after them.
fn parts() -> [&'static str; 3] {
    let cut = |text: &'static str, at: &str| text.split_at(text.find(at).unwrap_or(0));
    let (first, rest) = cut(INTEGRATOR, "motion_CALLED void dense_output(");
    let (second, third) = cut(rest, "/* The case of a thread. */");
    [first, second, third]
}

/// A tape as a function `NAME(t, x, u, p, values)` over arrays.
fn over_arrays(name: &str, tape: &Tape, sizes: [usize; 3]) -> String {
    let list = |letter: &str, count: usize| -> Vec<String> {
        (0..count).map(|i| format!("{letter}_{i}")).collect()
    };
    let [states, inputs, parameters] = sizes;
    let names = ArgumentNames {
        time: "t".to_owned(),
        states: list("x", states),
        inputs: list("u", inputs),
        parameters: list("p", parameters),
        weights: Vec::new(),
        output_weights: Vec::new(),
        accelerations: Vec::new(),
    };
    let written = Text::new(Real::Double, tape, &names);
    let mut text = format!(
        "motion_FUNCTION void {name}(double t, const double *x, const double *u, const double *p, double *values) {{\n"
    );
    for argument in tape.arguments() {
        let place = match argument {
            Argument::State(i) => format!("x[{i}]"),
            Argument::Input(i) => format!("u[{i}]"),
            Argument::Parameter(i) => format!("p[{i}]"),
            // Time is an argument of the function; no tape of a motion has weights or accelerations.
            _ => continue,
        };
        let _ = writeln!(text, "    const double {} = {place};", names.get(argument));
    }
    computed(&mut text, &written);
    text += "    (void)t;\n    (void)x;\n    (void)u;\n    (void)p;\n    (void)values;\n";
    let entries = tape
        .results
        .first()
        .map_or(&[][..], |result| &result.entries);
    for (index, entry) in entries.iter().enumerate() {
        let _ = writeln!(
            text,
            "    values[{index}] = {};",
            written.value(*entry).text
        );
    }
    text + "}\n\n"
}

/// Numbers and lists of the motion.
fn constants(motion: &Motion<'_>) -> String {
    let mut text = String::new();
    for (name, value) in counts(motion) {
        let _ = writeln!(text, "#define {name} {value}");
    }
    for (name, value) in numbers(motion) {
        let _ = writeln!(text, "#define {name} {}", Real::Double.literal(value));
    }
    let mut list = |kind: &str, name: &str, values: Vec<String>| {
        let values = values.join(", ");
        let values = if values.is_empty() { "0" } else { &values };
        let _ = writeln!(text, "motion_CONSTANT {kind} {name}[] = {{{values}}};");
    };
    let mut integers = |name: &str, values: &[usize]| {
        list("int", name, values.iter().map(usize::to_string).collect());
    };
    let (events, ends) = (&motion.event_columns, &motion.end_columns);
    let (ranges, followed) = (&motion.ranges, &motion.followed_columns);
    integers("range_state", &all(ranges, |range| range.component));
    integers("event_column", &all(events, |event| event.0));
    integers("event_stops", &all(events, |event| usize::from(event.1)));
    integers("followed_kind", &all(followed, |one| one.0 as usize));
    integers("followed_column", &all(followed, |one| one.1));
    integers("end_place", &all(ends, |end| end.0));
    integers("end_column", &all(ends, |end| end.1));
    let firsts = motion.noises.iter().scan(0, |next, (_, count)| {
        let first = *next;
        *next += count;
        Some(first)
    });
    integers("noise_first", &firsts.collect::<Vec<usize>>());
    let mut numbers = |name: &str, values: &[f64]| {
        let written = values.iter().map(|value| Real::Double.literal(*value));
        list("double", name, written.collect());
    };
    numbers("range_low", &all(ranges, |range| range.limits[0]));
    numbers("range_high", &all(ranges, |range| range.limits[1]));
    numbers("noise_every", &all(&motion.noises, |noise| noise.0));
    text.push('\n');
    text
}

fn all<T, N>(items: &[T], of: impl Fn(&T) -> N) -> Vec<N> {
    items.iter().map(of).collect()
}

fn counts(motion: &Motion<'_>) -> [(&'static str, usize); 18] {
    let Motion {
        sizes: [states, inputs, parameters],
        method,
        ..
    } = motion;
    let count = |tape: &Tape| tape.results.first().map_or(0, |one| one.entries.len());
    let [events, followed, recorded] = [motion.events, motion.followed, motion.recorded].map(count);
    let stages = method.nodes.len() + 1;
    [
        ("STATES", *states),
        ("INPUTS", *inputs),
        ("PARAMETERS", *parameters),
        ("COLUMNS", motion.columns),
        ("CONSTRAINTS", motion.constrained[0]),
        ("COORDINATES", motion.constrained[1]),
        ("CROSSINGS", count(motion.crossings)),
        ("EVENTS", events),
        ("FOLLOWED", followed),
        ("MOST_FUNCTIONS", events.max(followed).max(recorded).max(1)),
        ("AT_END", motion.end_columns.len()),
        ("RANGES", motion.ranges.len()),
        ("NOISES", motion.noises.len()),
        ("FIRST_NOISE", inputs - motion.noises.len()),
        ("NEW_RATES", stages),
        ("STAGES", stages + 1 + method.interior_stages.len()),
        ("COEFFICIENTS", 4 + method.interior.len()),
        (
            "ERROR_USES_NEW_RATES",
            usize::from(method.error_uses_new_rates),
        ),
    ]
}

fn numbers(motion: &Motion<'_>) -> [(&'static str, f64); 12] {
    let (options, method) = (&motion.options, &motion.method);
    let control = &method.control;
    [
        ("T_END", motion.end),
        ("LONGEST", motion.interval),
        ("RELATIVE", options.rtol),
        ("ABSOLUTE", options.atol),
        ("MAX_STEPS", options.max_steps as f64),
        ("ORDER", method.order),
        ("EXPONENT", control.exponent),
        ("INTEGRAL_GAIN", control.integral_gain),
        ("INTEGRAL_CORRECTION", control.integral_correction),
        ("SAFETY", control.safety),
        ("SMALLEST_FACTOR", control.smallest_factor),
        ("LARGEST_FACTOR", control.largest_factor),
    ]
}

/// Σ w k of a component.
fn sum(row: Row) -> String {
    row.iter().fold("0.0".to_owned(), |sum, (stage, weight)| {
        format!(
            "fma({}, m->k[{stage}][i], {sum})",
            Real::Double.literal(*weight)
        )
    })
}

/// Rates of a stage at x + h Σ a k.
fn stage(text: &mut String, stage: usize, node: f64, row: Row) {
    let _ = write!(
        text,
        "    for (i = 0; i < STATES; i++) {{\n        y[i] = fma(m->h, {}, m->x[i]);\n    }}\n    \
         derivative(m, at_most(m->t + {} * m->h, m->last), y, m->k[{stage}]);\n",
        sum(row),
        Real::Double.literal(node)
    );
}

/// The function that computes a step; it returns the weighted error.
fn attempt(method: &Coefficients) -> String {
    let mut text = "/* A trial step; its error in units of the tolerances. */\n\
                    motion_CALLED double attempt(Motion *m) {\n    double y[STATES], squares[2] = {0, 0};\n    int i;\n"
        .to_owned();
    for (index, (node, row)) in method.nodes.iter().zip(method.stages).enumerate() {
        stage(&mut text, index + 1, *node, row);
    }
    let _ = write!(
        text,
        "    for (i = 0; i < STATES; i++) {{\n        m->x_new[i] = fma(m->h, {}, m->x[i]);\n    }}\n    \
         if (CONSTRAINTS > 0 && !projected(m, m->t_new, m->x_new)) {{\n        return NAN;\n    }}\n    \
         for (i = 0; i < STATES; i++) {{\n        if (!IS_FINITE(m->x_new[i])) {{\n            return NAN;\n        }}\n    }}\n",
        sum(method.weights)
    );
    if method.error_uses_new_rates {
        text += "    derivative(m, at_most(m->t_new, m->last), m->x_new, m->k[NEW_RATES]);\n";
    }
    text += "    for (i = 0; i < STATES; i++) {\n        \
             double size = scale(at_least(fabs(m->x[i]), fabs(m->x_new[i]))), part;\n";
    for (index, row) in method.errors.iter().enumerate() {
        let _ = write!(
            text,
            "        part = {} / size;\n        squares[{index}] = fma(part, part, squares[{index}]);\n",
            sum(row)
        );
    }
    text += "    }\n    squares[0] /= STATES;\n    squares[1] /= STATES;\n";
    // Hairer, Nørsett and Wanner, equation (II.10.17).
    text += match method.errors.len() {
        1 => "    return m->h * sqrt(squares[0]);\n}\n\n",
        _ => {
            "    squares[1] = squares[0] + 0.01 * squares[1];\n    \
             return squares[1] == 0 ? 0 : m->h * squares[0] / sqrt(squares[1]);\n}\n\n"
        }
    };
    text
}

/// The function that computes the coefficients of the interpolant after those of the Hermite polynomial.
fn interior(method: &Coefficients) -> String {
    let mut text = "/* The last coefficients of the dense output. */\n\
                    motion_CALLED void interior(Motion *m) {\n    int i;\n"
        .to_owned();
    if !method.interior_stages.is_empty() {
        text += "    double y[STATES];\n";
    }
    let first = method.nodes.len() + 2;
    for (index, (node, row)) in method.interior_stages.iter().enumerate() {
        stage(&mut text, first + index, *node, row);
    }
    text += "    for (i = 0; i < STATES; i++) {\n";
    for (index, row) in method.interior.iter().enumerate() {
        let _ = writeln!(
            text,
            "        m->dense[{}][i] = m->h * {};",
            4 + index,
            sum(row)
        );
    }
    text + "    }\n}\n\n"
}
