//! Functions of a model at many places on a graphics card.

use appell_card::{Argument, Card, CardError, Kernel};
use appell_codegen::c::{self, Options};
use appell_codegen::program::FunctionKind;

pub use appell_card::Memory;

use crate::source::Source;
use crate::{Error, Field};

/// The functions of a model, compiled for the first graphics card of this machine.
///
/// Arrays of n places lie in the memory of the card: quantity k of place i at k n + i, entry (j, k) of a matrix with c
/// columns at (j c + k) n + i. All quantities are in SI.
pub struct OnCard {
    card: Card,
    functions: Vec<(c::Kernel, Kernel)>,
    /// Numbers of states and of parameters.
    widths: [usize; 2],
}

/// Most entries of an array.
const MOST: usize = 1 << 30;

/// The places of a call, by the addresses of their arrays in the memory of the card.
#[derive(Debug, Clone, Copy)]
pub struct Places {
    /// How many there are.
    pub count: usize,
    /// The time in s.
    pub t: f64,
    /// The parameters: those of each place, or those of all.
    pub parameters: u64,
    /// Whether each place has its own.
    pub each: bool,
    /// The states.
    pub states: u64,
    /// The inputs.
    pub inputs: u64,
    /// The additional argument of functions that have one: pseudo-accelerations, weights.
    pub own: Option<u64>,
}

/// The error of a card that cannot be used.
#[expect(clippy::needless_pass_by_value, reason = "the form of `map_err`")]
pub(crate) fn refused(error: CardError) -> Error {
    Error::request(Field::Device, error.to_string())
}

impl OnCard {
    /// Compiles functions of a spec; those that it lacks are skipped.
    pub fn new(source: &Source, functions: &[FunctionKind]) -> Result<Self, Error> {
        let options = Options {
            functions: functions.to_vec(),
            ..Options::default()
        };
        let (text, kernels, widths) = source.kernels(&options)?;
        let card = Card::first().map_err(refused)?;
        let names: Vec<&str> = kernels.iter().map(|kernel| kernel.name.as_str()).collect();
        let compiled = card.compile(&text, &names).map_err(refused)?;
        Ok(Self {
            card,
            functions: kernels.into_iter().zip(compiled).collect(),
            widths,
        })
    }

    /// Its functions.
    pub fn functions(&self) -> impl Iterator<Item = &c::Kernel> {
        self.functions.iter().map(|(kernel, _)| kernel)
    }

    /// A copy of numbers in the memory of the card.
    pub fn copy(&self, numbers: &[f64]) -> Result<Memory, Error> {
        self.card.copy(numbers).map_err(Error::computation)
    }

    /// The results of a function at places, in its order.
    pub fn call(&self, function: FunctionKind, places: &Places) -> Result<Vec<Memory>, Error> {
        let found = self
            .functions
            .iter()
            .find(|(own, _)| own.function == function);
        let Some((about, kernel)) = found else {
            let message = format!(
                "the model has no function `{}` on the card",
                function.name()
            );
            return Err(Error::request(Field::Model, message));
        };
        // Kernels count in 32 bits.
        let entries = about
            .results
            .iter()
            .map(|(_, shape)| shape.iter().product());
        let widest = entries.chain(self.widths).max().unwrap_or(1);
        if widest.saturating_mul(places.count) > MOST {
            let message = format!("at most {} places are possible in one call", MOST / widest);
            return Err(Error::request(Field::Device, message));
        }
        let results = about.results.iter().map(|(_, shape)| {
            let count = shape.iter().product::<usize>() * places.count;
            self.card.zeros(count)
        });
        let results = results.collect::<Result<Vec<_>, _>>();
        let results = results.map_err(Error::computation)?;
        let mut arguments = vec![
            Argument::Number(places.t),
            Argument::At(places.parameters),
            Argument::Integer(i32::from(places.each)),
            Argument::At(places.states),
            Argument::At(places.inputs),
        ];
        arguments.extend(about.own.and(places.own).map(Argument::At));
        arguments.extend(results.iter().map(|result| Argument::At(result.address())));
        kernel
            .call(places.count, &mut arguments)
            .map_err(Error::computation)?;
        Ok(results)
    }
}
