//! Equations in blocks of eight places and one by one, and motions, for specs of any mechanism.
//!
//! `cargo bench -p appell-tests --bench lanes -- [SPEC…]` prints nanoseconds a place and microseconds a motion, the
//! fastest of many rounds in which all rows take turns: compare rows of one run. Without specs, those of the shipped
//! mechanisms below. `--json` is for programs, such as `benches/lanes/run.py`, which has the peers beside it.

use std::hint::black_box;
use std::path::PathBuf;
use std::time::Instant;

use appell_codegen::compile;
use appell_codegen::jit::{Elementary, JitModel, NativeFunction, Sizes};
use appell_codegen::program::{FunctionKind, Program};
use appell_codegen::schedule::schedule;
use appell_runtime::Simulation;
use appell_runtime::integrate::{NoObserver, Options};
use appell_runtime::lanes::{AtLanes, LANES};
use appell_runtime::model::{At, Model};
use appell_test_kit::Random;
use appell_vector::{Instructions, Target, VectorFunction};
use serde_json::{Value, json};

/// The shipped mechanisms that are measured by default.
const SHIPPED: [&str; 3] = ["unicycle", "euc_3dof", "bicycle"];
/// Blocks in the first cache, in the second, and far beyond all of them: a million places.
const SIZES: [(&str, usize); 3] = [("L1", 16), ("L2", 128), ("memory", 125_000)];
/// Blocks that a round works through at least: short enough to fall into a quiet moment of the machine.
const BLOCKS: usize = 512;
const ROUNDS: usize = 400;
/// Tolerances of the motions.
const TOLERANCES: [f64; 3] = [1e-8, 1e-10, 1e-13];
const MOTIONS: usize = 40;
/// Duration of the motions in s, unless `--seconds` tells another.
const SECONDS: f64 = 1.0;
/// Angles and rates about the initial state, in SI, so that no two places are alike.
const SPREAD: f64 = 0.05;

type Blocks = Vec<[f64; LANES]>;

/// Equations of a mechanism in vector code, with the functions of the runtime.
struct Equations {
    rates: VectorFunction,
    jacobians: VectorFunction,
}

impl Equations {
    fn of(program: &Program) -> Self {
        let target = Target {
            elementary: Elementary::Own,
            ..Target::default()
        };
        let sizes = Sizes::from(&program.info);
        let [rates, jacobians] = [FunctionKind::Rates, FunctionKind::Jacobians].map(|kind| {
            let function = program.function(kind).expect("a function of every model");
            let schedule = schedule(program, function);
            VectorFunction::compile_for(&schedule, sizes, target)
                .expect("a processor with a compiler")
        });
        Self { rates, jacobians }
    }
}

/// Places with room for what is computed there. A block has all its numbers side by side.
struct Places {
    sizes: [usize; 3],
    x: Blocks,
    u: Blocks,
    p: Blocks,
    rates: Blocks,
    a: Blocks,
    b: Blocks,
}

impl Places {
    fn new(model: &dyn Model, blocks: usize, matrices: bool) -> Self {
        let info = model.info();
        let sizes = [info.state_len(), info.input_len(), info.parameter_len()];
        let [n, m, _] = sizes;
        let mut random = Random::of("lanes");
        let start = info.initial_state();
        let mut near = |i: usize| start[i % n] + random.between(-SPREAD, SPREAD);
        let x = (0..blocks * n).map(|i| std::array::from_fn(|_| near(i)));
        let room = if matrices { blocks } else { 1 };
        let parameters = info.default_parameters();
        Self {
            sizes,
            x: x.collect(),
            u: vec![[0.5; LANES]; blocks * m],
            p: parameters.iter().map(|&p| [p; LANES]).collect(),
            rates: vec![[0.0; LANES]; blocks * n],
            a: vec![[0.0; LANES]; room * n * n],
            b: vec![[0.0; LANES]; room * n * m],
        }
    }

    /// The numbers of one place, and what is computed there.
    fn place(&self, block: usize, lane: usize) -> [Vec<f64>; 3] {
        let [n, m, _] = self.sizes;
        let of = |all: &[[f64; LANES]]| all.iter().map(|number| number[lane]).collect();
        [
            of(&self.x[block * n..][..n]),
            of(&self.u[block * m..][..m]),
            of(&self.p),
        ]
    }
}

/// What is measured, at a block.
type Task = fn(&Equations, &mut Places, usize);

const ZERO: [f64; LANES] = [0.0; LANES];

fn rates_in_lanes(equations: &Equations, places: &mut Places, i: usize) {
    let [n, m, _] = places.sizes;
    let at = AtLanes {
        t: &ZERO,
        x: &places.x[i * n..][..n],
        u: &places.u[i * m..][..m],
        p: &places.p,
    };
    equations.rates.call(at, [&mut places.rates[i * n..][..n]]);
}

fn jacobians_in_lanes(equations: &Equations, places: &mut Places, i: usize) {
    let [n, m, _] = places.sizes;
    let at = AtLanes {
        t: &ZERO,
        x: &places.x[i * n..][..n],
        u: &places.u[i * m..][..m],
        p: &places.p,
    };
    let (a, b) = (
        &mut places.a[i * n * n..][..n * n],
        &mut places.b[i * n * m..][..n * m],
    );
    let rates = &mut places.rates[i * n..][..n];
    equations.jacobians.call(at, [rates, a, b]);
}

/// The same bytes without a computation: what memory allows.
fn copy(_: &Equations, places: &mut Places, i: usize) {
    let n = places.sizes[0];
    places.rates[i * n..][..n].copy_from_slice(&places.x[i * n..][..n]);
}

/// What is computed at the places of a block, for comparison with more digits.
fn samples(model: &dyn Model, equations: &Equations) -> Vec<Value> {
    let mut places = Places::new(model, 1, true);
    jacobians_in_lanes(equations, &mut places, 0);
    let (a, b, rates) = (places.a.clone(), places.b.clone(), places.rates.clone());
    let of = |all: &[[f64; LANES]], lane: usize| -> Vec<f64> {
        all.iter().map(|number| number[lane]).collect()
    };
    let sample = |lane: usize| {
        let [x, u, p] = places.place(0, lane);
        json!({
            "x": x, "u": u, "p": p,
            "rates": of(&rates, lane), "a": of(&a, lane), "b": of(&b, lane),
        })
    };
    (0..LANES).map(sample).collect()
}

/// Nanoseconds a place, in caches and from memory.
fn places(model: &dyn Model, equations: &Equations, told: &mut Vec<Value>) {
    for (place, blocks) in SIZES {
        let in_cache = blocks < BLOCKS;
        let mut rows: Vec<(&str, Task)> = vec![("rates", rates_in_lanes), ("copy", copy)];
        if in_cache {
            rows.push(("rates, A, B", jacobians_in_lanes));
        }
        let mut places = Places::new(model, blocks, in_cache);
        let repetitions = BLOCKS.div_ceil(blocks);
        let mut fastest = vec![f64::INFINITY; rows.len()];
        let rounds = if in_cache { ROUNDS } else { ROUNDS / 20 };
        for _ in 0..rounds {
            for ((_, task), fastest) in rows.iter().zip(&mut fastest) {
                let start = Instant::now();
                for _ in 0..repetitions {
                    for i in 0..blocks {
                        task(equations, &mut places, i);
                    }
                    black_box(&mut places.rates);
                }
                let count = (repetitions * blocks * LANES) as f64;
                *fastest = fastest.min(start.elapsed().as_secs_f64() * 1e9 / count);
            }
        }
        for ((name, _), ns) in rows.iter().zip(&fastest) {
            told.push(json!({ "row": format!("{name} in lanes"), "where": place, "ns": ns }));
        }
    }
}

/// Nanoseconds for one place, independent places one after the other.
fn one_place(model: &dyn Model, program: &Program, told: &mut Vec<Value>) {
    let places = Places::new(model, 16, false);
    let function = program.function(FunctionKind::Rates).expect("rates");
    let schedule = schedule(program, function);
    let natives = [Elementary::Standard, Elementary::Own].map(|elementary| {
        NativeFunction::compile_with(&schedule, Sizes::from(&program.info), elementary)
            .expect("a processor with a compiler")
    });
    let all: Vec<[Vec<f64>; 3]> = (0..16 * LANES)
        .map(|i| places.place(i / LANES, i % LANES))
        .collect();
    let mut rates = vec![0.0; places.sizes[0]];
    let mut fastest = [f64::INFINITY; 2];
    for _ in 0..ROUNDS {
        for (native, fastest) in natives.iter().zip(&mut fastest) {
            let start = Instant::now();
            for [x, u, p] in &all {
                native.call(At { t: 0.0, x, u, p }, [&mut rates]);
                black_box(&mut rates);
            }
            let count = all.len() as f64;
            *fastest = fastest.min(start.elapsed().as_secs_f64() * 1e9 / count);
        }
    }
    for (row, ns) in ["standard functions", "own functions"].iter().zip(fastest) {
        told.push(json!({ "row": format!("rates, one place, {row}"), "where": "L1", "ns": ns }));
    }
}

/// Where motions begin: beside the initial state, where nothing stands still.
fn start(model: &dyn Model) -> Vec<f64> {
    let [x, ..] = Places::new(model, 1, false).place(0, 0);
    x
}

/// Microseconds and errors of one motion, by tolerance.
fn motions(model: &dyn Model, seconds: f64, told: &mut Vec<Value>) {
    let start = start(model);
    let end = |tolerance: f64| {
        let simulation = Simulation {
            initial_state: start.clone(),
            span: [0.0, seconds],
            options: Options::with_tolerances(tolerance, tolerance),
            ..Simulation::new(model)
        };
        simulation.observe(|_, _| NoObserver)
    };
    let Ok((exact, _)) = end(1e-14) else {
        return;
    };
    for tolerance in TOLERANCES {
        let Ok((found, _)) = end(tolerance) else {
            continue;
        };
        let off = found.state.iter().zip(&exact.state);
        let error = off.fold(0.0_f64, |worst, (a, b)| worst.max((a - b).abs()));
        let mut fastest = f64::INFINITY;
        for _ in 0..MOTIONS {
            let start = Instant::now();
            let moved = end(tolerance);
            black_box(&moved.is_ok());
            fastest = fastest.min(start.elapsed().as_secs_f64() * 1e6);
        }
        told.push(json!({
            "row": "motion", "seconds": seconds, "tolerance": tolerance, "us": fastest, "error": error,
            "steps": found.statistics.steps,
        }));
    }
}

fn main() {
    let mut specs: Vec<PathBuf> = Vec::new();
    let (mut as_json, mut seconds) = (false, SECONDS);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--json" => as_json = true,
            "--seconds" => {
                seconds = arguments
                    .next()
                    .and_then(|s| s.parse().ok())
                    .unwrap_or(SECONDS);
            }
            // Of cargo.
            "--bench" => {}
            path => specs.push(path.into()),
        }
    }
    let shipped = SHIPPED.map(|name| {
        let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../generated/mechanisms");
        PathBuf::from(root).join(format!("{name}.toml"))
    });
    if specs.is_empty() {
        specs.extend(shipped);
    }
    let mut all = Vec::new();
    for spec in specs {
        let text = std::fs::read_to_string(&spec).expect("a spec");
        let name = spec.to_string_lossy().into_owned();
        let program = compile(&name, &text, &FunctionKind::STANDARD)
            .unwrap_or_else(|report| panic!("{}", report.plain()));
        let model = JitModel::new(&program).expect("a processor with a compiler");
        let equations = Equations::of(&program);
        let mut told = Vec::new();
        places(&model, &equations, &mut told);
        one_place(&model, &program, &mut told);
        motions(&model, seconds, &mut told);
        if !as_json {
            print(&program.info.name, &told);
        }
        all.push(json!({
            "mechanism": program.info.name, "spec": name, "rows": told, "samples": samples(&model, &equations),
            "start": start(&model),
        }));
    }
    if as_json {
        println!(
            "{}",
            json!({ "level": format!("{:?}", Instructions::best()), "mechanisms": all })
        );
    }
}

fn print(name: &str, told: &[Value]) {
    println!(
        "{name}; widest vectors of this processor: {:?}",
        Instructions::best()
    );
    for row in told {
        let what = row["row"].as_str().unwrap_or_default();
        match row["ns"].as_f64() {
            Some(ns) => println!(
                "  {what:40} {:8} {ns:10.2} ns",
                row["where"].as_str().unwrap_or_default()
            ),
            None => println!(
                "  {what:40} {:8.0e} {:10.2} us  error {:.1e}, {} steps",
                row["tolerance"].as_f64().unwrap_or_default(),
                row["us"].as_f64().unwrap_or_default(),
                row["error"].as_f64().unwrap_or_default(),
                row["steps"],
            ),
        }
    }
}
