//! Compiled functions of eight points at once.

// Machine code has the lengths that are checked here.
#![allow(unsafe_code)]

use appell_codegen::jit::{JitError, NativeFunction, Sizes, check};
use appell_codegen::tape::Tape;
use appell_runtime::lanes::{AtLanes, LANES};
use appell_runtime::model::At;

use super::VectorError;
use super::machine::{Machine, Target};

/// One tape in machine code for blocks of eight points. The code lives as long as this value; several
/// threads may call it at the same time.
///
/// Each lane is bit-identical to a [`NativeFunction`] with the same elementary functions. It is fastest if
/// arguments and results are aligned to 64 bytes.
#[derive(Debug)]
pub struct VectorFunction {
    how: How,
    sizes: Sizes,
    /// The number of weights used.
    weights: usize,
    /// Lengths of the results.
    results: Vec<usize>,
}

#[derive(Debug)]
enum How {
    Vector(Machine),
    PlaceByPlace(NativeFunction),
}

impl VectorFunction {
    /// Compiles a tape of a model with arguments of these sizes, for this processor.
    pub fn compile(tape: &Tape, sizes: Sizes) -> Result<Self, VectorError> {
        Self::compile_for(tape, sizes, Target::default())
    }

    /// [`Self::compile`] with the given instructions and elementary functions. If the processor lacks the
    /// instructions, or the code would be too long, points are evaluated individually.
    pub fn compile_for(tape: &Tape, sizes: Sizes, target: Target) -> Result<Self, VectorError> {
        let checked = check(tape, sizes)?;
        let how = match Machine::compile(&checked, target)? {
            Some(machine) => How::Vector(machine),
            None => How::PlaceByPlace(NativeFunction::compile_with(
                tape,
                sizes,
                target.elementary,
            )?),
        };
        Ok(Self {
            how,
            sizes,
            weights: checked.weights(),
            results: tape.lengths(),
        })
    }

    /// [`Self::compile_for`] with the interpreter as fallback, with the functions of the standard library.
    ///
    /// # Errors
    ///
    /// If the tape uses undefined values.
    pub fn compile_or_interpret(
        tape: &Tape,
        sizes: Sizes,
        target: Target,
    ) -> Result<Self, VectorError> {
        Self::compile_for(tape, sizes, target).or_else(|error| match error {
            VectorError::Tape(
                JitError::TooManyOperations { .. } | JitError::TooManyRows { .. },
            ) => Ok(Self {
                how: How::PlaceByPlace(NativeFunction::interpreted(tape, sizes)),
                sizes,
                weights: 0,
                results: tape.lengths(),
            }),
            other => Err(other),
        })
    }

    /// Whether all lanes are computed at once.
    pub fn is_vector(&self) -> bool {
        matches!(self.how, How::Vector(_))
    }

    /// Evaluates the function: one slice for each result of the tape, in its order.
    ///
    /// # Panics
    ///
    /// If the length of a slice differs from the tape's results or from the sizes it was compiled for; no
    /// code is executed then.
    #[inline]
    pub fn call<const N: usize>(&self, at: AtLanes<'_>, results: [&mut [[f64; LANES]]; N]) {
        self.call_weighted(at, &[], results);
    }

    /// [`Self::call`] for a function of weights.
    ///
    /// # Panics
    ///
    /// As [`Self::call`], and if there are fewer weights than the tape uses.
    #[inline]
    pub fn call_weighted<const N: usize>(
        &self,
        at: AtLanes<'_>,
        weights: &[[f64; LANES]],
        results: [&mut [[f64; LANES]]; N],
    ) {
        self.check_lengths(at, weights.len(), &results);
        match &self.how {
            // SAFETY: the lengths were compared.
            How::Vector(machine) => unsafe { machine.call(at, weights, results) },
            How::PlaceByPlace(native) => place_by_place(native, at, weights, results),
        }
    }

    /// Panics if slices have other lengths than the function requires.
    #[inline]
    fn check_lengths(&self, at: AtLanes<'_>, weights: usize, results: &[&mut [[f64; LANES]]]) {
        let found = Sizes {
            states: at.x.len(),
            inputs: at.u.len(),
            parameters: at.p.len(),
        };
        let expected = self.sizes;
        assert!(
            found == expected,
            "arguments: {found:?} given, {expected:?} expected"
        );
        let expected = &self.results[..];
        let mut lengths = results.iter().zip(expected);
        assert!(
            results.len() == expected.len() && lengths.all(|(result, len)| result.len() == *len),
            "results: lengths {expected:?} expected"
        );
        let used = self.weights;
        assert!(weights >= used, "weights: {weights} given, {used} used");
    }
}

/// Calls a function for every place of a block.
fn place_by_place<const N: usize>(
    native: &NativeFunction,
    at: AtLanes<'_>,
    weights: &[[f64; LANES]],
    mut results: [&mut [[f64; LANES]]; N],
) {
    let of_lane = |numbers: &[[f64; LANES]], lane: usize| -> Vec<f64> {
        numbers.iter().map(|number| number[lane]).collect()
    };
    let mut found = results.each_ref().map(|result| vec![0.0; result.len()]);
    for lane in 0..LANES {
        let [x, u, p, weights] = [at.x, at.u, at.p, weights].map(|of| of_lane(of, lane));
        let place = At {
            t: at.t[lane],
            x: &x,
            u: &u,
            p: &p,
        };
        native.call_weighted(place, &weights, found.each_mut().map(Vec::as_mut_slice));
        for (result, found) in results.iter_mut().zip(&found) {
            for (number, found) in result.iter_mut().zip(found) {
                number[lane] = *found;
            }
        }
    }
}
