//! The functions of a model as tapes, each derived and scheduled when it is first asked for.

#[cfg(feature = "cache")]
mod kept;

use std::num::NonZero;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use appell_runtime::model::ModelInfo;
use appell_runtime::switching::Counts;
use appell_spec::Report;

use crate::compile::{derived, report};
use crate::mechanics::assemble::Functions;
use crate::mechanics::finding::Outcome;
use crate::program::{FunctionKind, Program};
use crate::schedule::schedule;
use crate::tape::{ResultArray, Tape};

#[cfg(feature = "cache")]
use kept::Kept;
#[cfg(feature = "cache")]
pub use kept::{Store, keep_in};

/// The functions of a model. Each is the same whichever others were asked for, and in any order.
pub struct Tapes {
    head: Head,
    source: Source,
    #[cfg(feature = "cache")]
    kept: Option<Kept>,
    /// By [`FunctionKind`]; nothing where the model has no such function.
    made: [OnceLock<Outcome<Option<Tape>>>; FunctionKind::COUNT],
}

/// What is known of a model without its functions.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "cache", derive(serde::Serialize, serde::Deserialize))]
struct Head {
    info: ModelInfo,
    /// Dependent coordinates, one per position constraint.
    dependent: Vec<usize>,
    /// Sizes of the linear systems that are solved with pivoting to compute the rates.
    systems: Vec<usize>,
}

/// Its place among kept functions.
#[cfg(feature = "cache")]
const HEAD: &str = "";

/// Where functions come from.
enum Source {
    /// Those of a program.
    Program(Box<Program>),
    /// All that can be derived.
    Derivation(Box<Functions>),
    /// The same, once a function is needed that is not kept.
    #[cfg(feature = "cache")]
    Spec {
        file: String,
        text: String,
        functions: OnceLock<Option<Box<Functions>>>,
    },
}

impl From<Program> for Tapes {
    fn from(program: Program) -> Self {
        let head = Head {
            info: program.info.clone(),
            dependent: program.dependent.clone(),
            systems: program.systems.clone(),
        };
        Self::of(head, Source::Program(Box::new(program)))
    }
}

impl From<&Program> for Tapes {
    fn from(program: &Program) -> Self {
        program.clone().into()
    }
}

impl From<Functions> for Tapes {
    fn from(functions: Functions) -> Self {
        let head = Head {
            info: functions.info().clone(),
            dependent: functions.dependent().to_vec(),
            systems: functions.systems().to_vec(),
        };
        Self::of(head, Source::Derivation(Box::new(functions)))
    }
}

impl Tapes {
    /// The functions of a spec, those kept from earlier runs among them; `file` is its name in messages.
    pub fn of_spec(file: &str, text: &str) -> Result<Self, Report> {
        #[cfg(feature = "cache")]
        if let Some(kept) = Kept::of(text) {
            return Self::keeping(file, text, kept);
        }
        Ok(derived(file, text)?.functions().into())
    }

    #[cfg(feature = "cache")]
    fn keeping(file: &str, text: &str, kept: Kept) -> Result<Self, Report> {
        if let Some(head) = kept.get(HEAD) {
            let source = Source::Spec {
                file: file.to_owned(),
                text: text.to_owned(),
                functions: OnceLock::new(),
            };
            let mut tapes = Self::of(head, source);
            tapes.kept = Some(kept);
            return Ok(tapes);
        }
        let functions = derived(file, text)?.functions();
        // A small mechanism is derived faster than it is read.
        let is_worth_keeping = functions.expressions() > 2000;
        let mut tapes = Self::from(functions);
        if is_worth_keeping {
            kept.put(HEAD, &tapes.head);
            tapes.kept = Some(kept);
        }
        Ok(tapes)
    }

    fn of(head: Head, source: Source) -> Self {
        Self {
            head,
            source,
            #[cfg(feature = "cache")]
            kept: None,
            made: [const { OnceLock::new() }; FunctionKind::COUNT],
        }
    }

    /// Names, units and sizes of the model.
    pub fn info(&self) -> &ModelInfo {
        &self.head.info
    }

    /// Dependent coordinates, one per position constraint.
    pub fn dependent(&self) -> &[usize] {
        &self.head.dependent
    }

    /// Sizes of the linear systems that are solved with pivoting to compute the rates.
    pub fn systems(&self) -> &[usize] {
        &self.head.systems
    }

    /// A function with the results that the trait of models has; nothing if the model lacks it or cannot have it.
    #[inline]
    pub fn get(&self, kind: FunctionKind) -> Option<&Tape> {
        self.made(kind).as_ref().ok()?.as_ref()
    }

    /// Makes functions now, in parallel, or returns why one of them is impossible; `text` is that of the spec.
    pub fn require(&self, kinds: &[FunctionKind], text: &str) -> Result<(), Report> {
        // The long ones, which come last, first: threads that share the work end together.
        let missing = kinds
            .iter()
            .rev()
            .filter(|&&kind| self.made[kind as usize].get().is_none());
        let missing: Vec<FunctionKind> = missing.copied().collect();
        let next = AtomicUsize::new(0);
        let work = || {
            while let Some(&kind) = missing.get(next.fetch_add(1, Ordering::Relaxed)) {
                self.get(kind);
            }
        };
        let threads = thread::available_parallelism().map_or(1, NonZero::get);
        thread::scope(|scope| {
            for _ in 1..threads.min(missing.len()) {
                scope.spawn(work);
            }
            work();
        });
        let failed = |&kind: &FunctionKind| self.made(kind).as_ref().err();
        let Some(findings) = kinds.iter().find_map(failed) else {
            return Ok(());
        };
        // Only a derivation fails.
        let mechanism = self.functions().map(Functions::mechanism);
        mechanism.map_or(Ok(()), |mechanism| Err(report(mechanism, text, findings)))
    }

    /// The numbers of switching functions.
    pub fn switch_counts(&self) -> Counts {
        let count = |kind: FunctionKind, place: usize| {
            let results = self.get(kind).map(|tape| &tape.results[place]);
            results.map_or(0, |array| array.entries.len())
        };
        Counts {
            answers: count(FunctionKind::Switches, 0),
            shapes: count(FunctionKind::TimeFunctions, 1),
            crossings: count(FunctionKind::Crossings, 0),
            pulses: count(FunctionKind::Crossings, 1),
        }
    }

    fn made(&self, kind: FunctionKind) -> &Outcome<Option<Tape>> {
        self.made[kind as usize].get_or_init(|| {
            #[cfg(feature = "cache")]
            if let Some(tape) = self.kept.as_ref().and_then(|kept| kept.get(kind.name())) {
                return Ok(tape);
            }
            let tape = match (&self.source, self.functions()) {
                (Source::Program(program), _) => tape_of(program, kind),
                (_, Some(functions)) => tape_of(&functions.program(&[kind])?, kind),
                (_, None) => None,
            };
            #[cfg(feature = "cache")]
            if let Some(kept) = &self.kept {
                kept.put(kind.name(), &tape);
            }
            Ok(tape)
        })
    }

    /// The derivation, if there is one.
    fn functions(&self) -> Option<&Functions> {
        match &self.source {
            Source::Program(_) => None,
            Source::Derivation(functions) => Some(functions),
            #[cfg(feature = "cache")]
            Source::Spec {
                file,
                text,
                functions,
            } => {
                // Only specs that can be derived are kept.
                let again = || Some(Box::new(derived(file, text).ok()?.functions()));
                functions.get_or_init(again).as_deref()
            }
        }
    }
}

/// The tape of a function with the results that the trait of models has, if the program has it. The operations are
/// those of the whole function, so that results do not depend on the selection.
fn tape_of(program: &Program, kind: FunctionKind) -> Option<Tape> {
    let mut tape = schedule(program, program.function(kind)?);
    let all = std::mem::take(&mut tape.results);
    let wanted = kind.model_results().iter().map(|&name| {
        let found = all.iter().find(|result| result.name == name);
        found.cloned().unwrap_or_else(|| ResultArray {
            name: name.to_owned(),
            entries: Vec::new(),
        })
    });
    tape.results = wanted.collect();
    Some(tape.live())
}
