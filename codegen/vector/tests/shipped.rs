//! Shipped mechanisms at eight points at once: each lane is bit-identical to scalar code.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::compile;
use appell_codegen::jit::{Elementary, NativeFunction, Sizes};
use appell_codegen::program::{FunctionKind, Program};
use appell_codegen::schedule::schedule;
use appell_codegen::tape::{ResultArray, Tape};
use appell_runtime::lanes::{AtLanes, LANES};
use appell_runtime::model::{At, ModelInfo, Quantity};
use appell_test_kit::{Random, shipped};
use appell_vector::{Instructions, Target, VectorFunction};

use crate::emulator::emulated;
use crate::jit_support::{lane, same};

/// Blocks of random points per function.
const BLOCKS: usize = 4;
/// An angle that needs more digits of π than straight code has.
const FAR_TURNED: f64 = 1e12;
/// Own functions and those of the platform differ by rounding; equations enlarge that.
const ROUNDING: f64 = 1e-9;

/// The functions most used in simulation and analysis.
const KINDS: [FunctionKind; 4] = [
    FunctionKind::Rates,
    FunctionKind::Jacobians,
    FunctionKind::Outputs,
    FunctionKind::Energies,
];

/// A point.
struct Place {
    t: f64,
    x: Vec<f64>,
    u: Vec<f64>,
    p: Vec<f64>,
}

impl Place {
    /// A random point inside the declared ranges and near the initial state.
    fn random(info: &ModelInfo, random: &mut Random) -> Self {
        let mut near = |quantities: &[Quantity], width: f64| -> Vec<f64> {
            let draw = |quantity: &Quantity| {
                let width = width * quantity.value.abs().max(1.0);
                let [low, high] = quantity.range;
                let (low, high) = (
                    low.max(quantity.value - width),
                    high.min(quantity.value + width),
                );
                random.between(low, high)
            };
            quantities.iter().map(draw).collect()
        };
        let (x, u, p) = (
            near(&info.states, 0.7),
            near(&info.inputs, 5.0),
            near(&info.parameters, 0.2),
        );
        let t = random.between(0.0, 2.0);
        Self { t, x, u, p }
    }

    fn at(&self) -> At<'_> {
        At {
            t: self.t,
            x: &self.x,
            u: &self.u,
            p: &self.p,
        }
    }
}

/// Eight points, component by component.
struct Block {
    places: [Place; LANES],
    t: [f64; LANES],
    x: Vec<[f64; LANES]>,
    u: Vec<[f64; LANES]>,
    p: Vec<[f64; LANES]>,
}

impl Block {
    fn random(program: &Program, random: &mut Random) -> Self {
        Self::of(std::array::from_fn(|_| {
            Place::random(&program.info, random)
        }))
    }

    /// The same with a place that leaves the straight way and one without numbers.
    fn astray(program: &Program, random: &mut Random) -> Self {
        let Self { mut places, .. } = Self::random(program, random);
        places[5].x.fill(FAR_TURNED);
        places[2].x.fill(f64::NAN);
        Self::of(places)
    }

    fn of(places: [Place; LANES]) -> Self {
        let blocks = |numbers: fn(&Place) -> &Vec<f64>| -> Vec<[f64; LANES]> {
            let entries = 0..numbers(&places[0]).len();
            entries
                .map(|i| places.each_ref().map(|place| numbers(place)[i]))
                .collect()
        };
        Self {
            t: places.each_ref().map(|place| place.t),
            x: blocks(|place| &place.x),
            u: blocks(|place| &place.u),
            p: blocks(|place| &place.p),
            places,
        }
    }

    fn at(&self) -> AtLanes<'_> {
        AtLanes {
            t: &self.t,
            x: &self.x,
            u: &self.u,
            p: &self.p,
        }
    }
}

/// Code for every kind of vector instructions that this processor has, with both kinds of elementary
/// functions.
fn targets() -> impl Iterator<Item = Target> {
    let all = [Instructions::Avx512, Instructions::Avx2];
    let exist = all.into_iter().filter(|instructions| instructions.exist());
    exist.flat_map(|instructions| {
        [Elementary::Standard, Elementary::Own].map(|elementary| Target {
            instructions,
            elementary,
        })
    })
}

/// A function whose results are one list.
fn joined(program: &Program, kind: FunctionKind) -> Option<Tape> {
    let function = program.functions.iter().find(|f| f.kind == kind)?;
    let mut schedule = schedule(program, function);
    let results = std::mem::take(&mut schedule.results).into_iter();
    schedule.results.push(ResultArray {
        name: "all".to_owned(),
        entries: results.flat_map(|array| array.entries).collect(),
    });
    Some(schedule)
}

#[track_caller]
fn assert_same(what: &str, found: &[f64], expected: &[f64]) {
    assert!(same(found, expected), "{what}\n{found:?}\n{expected:?}");
}

#[test]
fn every_mechanism_has_the_bits_of_scalar_code_in_every_lane() {
    for (name, text) in shipped() {
        let program = compile(&name, &text, &KINDS).unwrap();
        let sizes = Sizes::from(&program.info);
        let mut random = Random::of(&format!("lanes {name}"));
        for kind in KINDS {
            let Some(schedule) = joined(&program, kind) else {
                continue;
            };
            let len = schedule.results[0].entries.len();
            let natives = [Elementary::Standard, Elementary::Own]
                .map(|kind| NativeFunction::compile_with(&schedule, sizes, kind).unwrap());
            let vector = |target| {
                let function = VectorFunction::compile_for(&schedule, sizes, target).unwrap();
                assert!(function.is_vector(), "{name}, {kind:?}, {target:?}");
                (target, function)
            };
            let functions: Vec<_> = targets().map(vector).collect();
            for round in 0..BLOCKS {
                let block = match round {
                    0 => Block::astray(&program, &mut random),
                    _ => Block::random(&program, &mut random),
                };
                let mut results: Vec<(Target, Vec<[f64; LANES]>)> = Vec::new();
                for (target, function) in &functions {
                    let mut found = vec![[f64::NAN; LANES]; len];
                    function.call(block.at(), [&mut found]);
                    results.push((*target, found));
                }
                // Also where the processor lacks it.
                let wide = Target {
                    instructions: Instructions::Avx512,
                    ..Target::default()
                };
                let arguments: [&[_]; 5] = [&[block.t], &block.x, &block.u, &block.p, &[]];
                results.push((wide, emulated(&schedule, sizes, wide, arguments)));
                for (target, found) in results {
                    let native = &natives[target.elementary as usize];
                    for (l, place) in block.places.iter().enumerate() {
                        let mut expected = vec![f64::NAN; len];
                        native.call(place.at(), [&mut expected]);
                        let what = format!("{name}, {kind:?}, {target:?}, lane {l}");
                        assert_same(&what, &lane(&found, l), &expected);
                    }
                }
            }
        }
    }
}

#[test]
fn own_functions_change_a_mechanism_by_rounding() {
    for (name, text) in shipped() {
        let program = compile(&name, &text, &KINDS).unwrap();
        let sizes = Sizes::from(&program.info);
        let mut random = Random::of(&format!("own functions {name}"));
        let place = Place::random(&program.info, &mut random);
        for function in &program.functions {
            let whole = schedule(&program, function);
            for result in &whole.results {
                let schedule = Tape {
                    results: vec![result.clone()],
                    ..whole.clone()
                };
                let [standard, own] = [Elementary::Standard, Elementary::Own].map(|kind| {
                    let native = NativeFunction::compile_with(&schedule, sizes, kind).unwrap();
                    let mut numbers = vec![f64::NAN; result.entries.len()];
                    native.call(place.at(), [&mut numbers]);
                    numbers
                });
                let largest = standard.iter().fold(1.0, |most: f64, x| x.abs().max(most));
                for (own, standard) in own.iter().zip(&standard) {
                    let off = (own - standard).abs();
                    assert!(off <= ROUNDING * largest, "{name}: {own:?} {standard:?}");
                }
            }
        }
    }
}
