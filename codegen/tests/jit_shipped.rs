//! Shipped mechanisms at eight points at once: each lane is bit-identical to scalar code.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_codegen::compile;
use appell_codegen::interpreted::InterpretedModel;
use appell_codegen::jit::{
    Elementary, Instructions, JitModel, NativeFunction, Sizes, Target, VectorFunction,
};
use appell_codegen::program::{FunctionKind, Program};
use appell_codegen::schedule::{ResultArray, Schedule, schedule};
use appell_runtime::lanes::{AtLanes, LANES};
use appell_runtime::model::{At, Model, ModelInfo, Quantity};
use appell_test_kit::{Random, shipped};

use crate::jit_support::{lane, same};

/// Blocks of random points per function.
const BLOCKS: usize = 4;

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
        let places: [Place; LANES] = std::array::from_fn(|_| Place::random(&program.info, random));
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
fn joined(program: &Program, kind: FunctionKind) -> Option<Schedule> {
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
            for _ in 0..BLOCKS {
                let block = Block::random(&program, &mut random);
                for (target, function) in &functions {
                    let native = &natives[target.elementary as usize];
                    let mut found = vec![[f64::NAN; LANES]; len];
                    function.call(block.at(), [&mut found]);
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
fn models_evaluate_lanes_as_they_evaluate_places() {
    let mut specs = shipped();
    specs.sort_by_key(|(_, text)| text.len());
    for (name, text) in &specs[..3] {
        let program = compile(name, text, &FunctionKind::STANDARD).unwrap();
        let interpreted = InterpretedModel::new(program.clone());
        let compiled = JitModel::new(&program).unwrap();
        let own = Target {
            elementary: Elementary::Own,
            ..Target::default()
        };
        let with_own = JitModel::new(&program).unwrap().with_lanes_for(own);
        let models: [&dyn Model; 3] = [&compiled, &with_own, &interpreted];
        let (n, m, l) = (
            program.info.state_len(),
            program.info.input_len(),
            program.info.output_len(),
        );
        let mut random = Random::of(&format!("lanes of {name}"));
        let block = Block::random(&program, &mut random);
        for (is_own, model) in [false, true, false].into_iter().zip(models) {
            let [mut rates, mut a, mut b, mut outputs] =
                [n, n * n, n * m, l].map(|len| vec![[f64::NAN; LANES]; len]);
            model.rates_lanes(block.at(), &mut rates);
            let first = rates.clone();
            model.jacobians_lanes(block.at(), &mut rates, &mut a, &mut b);
            model.outputs_lanes(block.at(), &mut outputs);
            for (number, place) in block.places.iter().enumerate() {
                let [mut x, mut xa, mut xb, mut y] =
                    [n, n * n, n * m, l].map(|len| vec![f64::NAN; len]);
                let what = format!("{name}, lane {number}");
                model.rates_own(place.at(), &mut x);
                assert_same(&what, &lane(&first, number), &x);
                model.jacobians_own(place.at(), &mut x, &mut xa, &mut xb);
                model.outputs_own(place.at(), &mut y);
                for (found, expected) in [(&rates, x), (&a, xa), (&b, xb), (&outputs, y)] {
                    assert_same(&what, &lane(found, number), &expected);
                }
                if !is_own {
                    let mut plain = vec![f64::NAN; n];
                    model.rates(place.at(), &mut plain);
                    assert_same(&what, &lane(&first, number), &plain);
                }
            }
        }
    }
}
