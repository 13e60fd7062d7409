//! A model: a spec with its equations of motion, and one call for each request.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use appell_codegen::Derived;
use appell_codegen::compile::report;
use appell_codegen::program::FunctionKind;
use appell_codegen::tape::Tape;
use appell_gap::{diagnose as gap, identify};
use appell_recordings::DataSet;
use appell_runtime::integrate::{Direction, Event};
use appell_runtime::model::{Model as Equations, ModelInfo};
use appell_runtime::simulate::SimulationError;
use appell_runtime::{Simulation, Trajectory};

use crate::control::{Design, Request, Schedule, law_file};
use crate::engine::{self, Engine, Made};
use crate::motion::{Motion, Simulated};
use crate::places::Vectors;
use crate::setup::{Assignment, Setup};
use crate::source::Source;
use crate::steady::{Answer, Question, Resolved};
use crate::{Error, Field, diagnosis, recording};

/// A mechanism with its equations of motion.
///
/// ```
/// use appell::{Model, Motion};
///
/// let model = Model::shipped("pendulum")?;
/// let motion = model.simulate(&Motion::new(2.0).initial("theta", "30deg"))?;
/// assert!(motion.trajectory.column("theta").is_some());
/// # Ok::<(), appell::Error>(())
/// ```
pub struct Model {
    source: Source,
    equations: engine::Equations,
    /// The equations derived in this process, if others are at hand.
    made: OnceLock<Made>,
    /// Functions of eight places.
    pub(crate) vectors: Vectors,
}

impl Model {
    /// The model of a spec: its equations are derived and compiled in this process.
    ///
    /// ```
    /// let spec = include_str!("../../generated/mechanisms/pendulum.toml");
    /// let model = appell::Model::from_spec(spec)?;
    /// assert_eq!(model.info().name, "pendulum");
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn from_spec(text: &str) -> Result<Self, Error> {
        Self::of(Source::of("spec.toml", text), None)
    }

    /// The model of a spec file.
    pub fn from_file(path: &Path) -> Result<Self, Error> {
        Self::of(Source::read(path)?, None)
    }

    /// A shipped model, compiled ahead of time.
    pub fn shipped(name: &str) -> Result<Self, Error> {
        Self::of(Source::shipped(name)?, None)
    }

    /// A shipped name or the path of a spec file.
    pub fn find(model: &str) -> Result<Self, Error> {
        Self::of(Source::find(model)?, None)
    }

    /// The model of a spec with a chosen engine; by default the emitted code of shipped mechanisms, and
    /// machine code for others.
    pub fn of(source: Source, engine: Option<Engine>) -> Result<Self, Error> {
        let equations = match engine {
            None => engine::Equations::at_hand(&source)?,
            Some(engine) => engine::Equations::new(&source, engine)?,
        };
        Ok(Self::with(source, equations))
    }

    fn with(source: Source, equations: engine::Equations) -> Self {
        Self {
            source,
            equations,
            made: OnceLock::new(),
            vectors: Vectors::default(),
        }
    }

    /// The model of a derivation that is there already, as machine code; `derived` is that of the source.
    pub fn of_derivation(source: Source, derived: Derived) -> Result<Self, Error> {
        let made = Made::of(&source, derived.functions().into(), Engine::Jit)?;
        Ok(Self::with(source, engine::Equations::Made(made)))
    }

    /// The equations derived in this process, which have adjoints; those of a shipped mechanism at the first call.
    pub(crate) fn made(&self) -> Result<&Made, Error> {
        if let engine::Equations::Made(made) = &self.equations {
            return Ok(made);
        }
        if let Some(made) = self.made.get() {
            return Ok(made);
        }
        let made = Made::new(&self.source, Engine::Jit)?;
        Ok(self.made.get_or_init(|| made))
    }

    /// The equations with all functions, of which emitted code lacks adjoints and derivatives of outputs.
    pub fn all_equations(&self) -> Result<&dyn Equations, Error> {
        Ok(self.made()?.model())
    }

    /// The operations of the rates, which closed loops are made from.
    pub(crate) fn rates(&self) -> Result<&Tape, Error> {
        let missing = || Error::request(Field::Model, "its rates cannot be derived");
        self.tape(FunctionKind::Rates)?.ok_or_else(missing)
    }

    /// The operations of a function, if the model has it.
    pub(crate) fn tape(&self, function: FunctionKind) -> Result<Option<&Tape>, Error> {
        Ok(self.made()?.tapes().get(function))
    }

    /// Derives functions now, in parallel, which a first use derives otherwise; returns why one of them is impossible.
    pub fn require(&self, functions: &[FunctionKind]) -> Result<(), Error> {
        self.equations.require(&self.source, functions)
    }

    /// The equations of motion: rates, Jacobians, Appell's equations, energies, outputs.
    pub fn equations(&self) -> &dyn Equations {
        self.equations.model()
    }

    /// Names, units and sizes.
    pub fn info(&self) -> &ModelInfo {
        self.equations().info()
    }

    /// The spec.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// Shipped name, or path of the spec.
    pub(crate) fn name(&self) -> &str {
        self.source
            .shipped
            .map_or(&self.source.file, |shipped| shipped.name)
    }

    /// Why the equations are interpreted although machine code was requested.
    pub fn note(&self) -> Option<&str> {
        self.equations.note()
    }

    /// The values of the spec, to be changed by texts with units.
    pub fn setup(&self) -> Result<Setup<'_>, Error> {
        let Source {
            file, text, robot, ..
        } = &self.source;
        Ok(Setup {
            robot: robot.as_deref(),
            ..Setup::new(file, text, self.info())?
        })
    }

    /// Integrates the equations of motion.
    pub fn simulate(&self, motion: &Motion) -> Result<Simulated, Error> {
        self.simulate_watched(motion, |_| {})
    }

    /// Integrates the equations of motion; `progress` is called with the time in s.
    pub fn simulate_watched(
        &self,
        motion: &Motion,
        progress: impl Fn(f64),
    ) -> Result<Simulated, Error> {
        let run = |simulation: Simulation<'_>| {
            Simulation {
                progress: Some(Box::new(progress)),
                ..simulation
            }
            .run()
        };
        self.simulate_with(motion, run)
    }

    fn simulate_with(
        &self,
        motion: &Motion,
        run: impl FnOnce(Simulation<'_>) -> Result<Trajectory, SimulationError>,
    ) -> Result<Simulated, Error> {
        let ready = motion.ready(self.equations(), self.setup()?, self.name())?;
        motion.simulate(self.equations(), &ready, run)
    }

    /// Integrates the equations of motion as long as `go_on`, which is called several times in each step.
    ///
    /// ```
    /// use appell::{Model, Motion};
    ///
    /// let model = Model::shipped("pendulum")?;
    /// let motion = Motion::new(1e3).initial("theta", "30deg");
    /// let interrupted = model.simulate_while(&motion, || false)?;
    /// assert!(interrupted.failure.is_some());
    /// assert!(interrupted.trajectory.times().last() < Some(&1e3));
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn simulate_while(
        &self,
        motion: &Motion,
        go_on: impl Fn() -> bool,
    ) -> Result<Simulated, Error> {
        let run = |simulation: Simulation<'_>| {
            // A sign that changes is found; one that is negative from the start is not.
            let mut started = false;
            let sign = move |_: f64, _: &[f64]| {
                let goes_on = go_on() || !started;
                started = true;
                if goes_on { 1.0 } else { -1.0 }
            };
            Simulation {
                events: vec![Event::terminal(Direction::Falling, sign)],
                ..simulation
            }
            .run()
        };
        self.simulate_with(motion, run)
    }

    /// A page that animates a motion; `ending` is the reason of an early end.
    pub fn page(&self, motion: &Trajectory, ending: Option<&str>) -> Result<String, Error> {
        let mechanism = &self.setup()?.mechanism;
        appell_report::film::page(mechanism, self.equations(), motion, ending)
            .map_err(|findings| report(mechanism, &self.source.text, &findings).into())
    }

    /// Steady motions with their stability, isolated or along a quantity.
    ///
    /// ```
    /// use appell::{Model, steady::{Answer, Question}};
    ///
    /// let model = Model::shipped("rolling_wheel")?;
    /// let upright = Question::default().fix("theta", 0).fix("omega_2", "20rad/s");
    /// let Answer::Motions(motions) = model.steady(&upright)? else {
    ///     panic!("there is no continuation parameter")
    /// };
    /// assert!(!motions.is_empty());
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn steady(&self, question: &Question) -> Result<Answer, Error> {
        self.resolve(question)?.answer()
    }

    /// A request for steady motions with its names resolved, also for charts over two quantities.
    pub fn resolve(&self, question: &Question) -> Result<Resolved<'_>, Error> {
        self.require(&[FunctionKind::Jacobians])?;
        let mut setup = self.setup()?;
        setup.set(&question.parameters)?;
        question.resolve(self.equations(), &setup)
    }

    /// Controllability about a steady motion, and gains of a feedback law.
    ///
    /// ```
    /// use appell::{Model, Motion, control::Request};
    ///
    /// let model = Model::shipped("cart_pole")?;
    /// let design = model.control(&Request::default().poles("-3"))?;
    /// let law = model.law(&design)?;
    /// let motion = model.simulate(&Motion::new(5.0).feedback(&law))?;
    /// assert!(motion.failure.is_none());
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn control(&self, request: &Request) -> Result<Design, Error> {
        self.require(&[FunctionKind::Jacobians])?;
        request.design(self.equations(), self.setup()?)
    }

    /// A design at each value of a state, input or parameter, such as `v=1..20/10` (ten intervals). All laws
    /// feed back the same states.
    ///
    /// ```
    /// use appell::{Model, Motion, control::Request, setup::Assignment};
    ///
    /// let model = Model::shipped("cart_pole")?;
    /// let request = Request::default().poles("-3");
    /// let schedule = model.schedule(&request, &Assignment::new("l", "0.3..0.6/3"))?;
    /// assert_eq!(schedule.designs.len(), 4);
    /// let law = model.scheduled_law(&schedule)?;
    /// assert!(model.simulate(&Motion::new(5.0).feedback(&law))?.failure.is_none());
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn schedule(&self, request: &Request, range: &Assignment) -> Result<Schedule, Error> {
        self.require(&[FunctionKind::Jacobians])?;
        Schedule::new(self.equations(), self.setup()?, request, range)
    }

    /// A schedule as the text of a feedback file.
    pub fn scheduled_law(&self, schedule: &Schedule) -> Result<String, Error> {
        schedule.law(&self.setup()?, self.name())
    }

    /// A design as the text of a feedback file, for [`Motion::feedback`].
    pub fn law(&self, design: &Design) -> Result<String, Error> {
        if design.law.is_none() {
            let message = "without poles or weights there is no law";
            return Err(Error::request(Field::Poles, message));
        }
        Ok(law_file::text(design, &self.setup()?, self.name()))
    }

    /// Recordings of the mechanism: a folder with a `recording.toml`, or CSV files.
    pub fn recordings(&self, paths: &[PathBuf]) -> Result<DataSet, Error> {
        recording::read_with(paths, Some(&self.source))
    }

    /// Estimates parameters by maximum likelihood; `stage` is called with the name of each step.
    pub fn identify(
        &self,
        set: &DataSet,
        options: &identify::Options,
        stage: impl FnMut(&'static str),
    ) -> Result<identify::Answer, Error> {
        recording::check(set)?;
        let equations = self.all_equations()?;
        Ok(identify::identify(set, equations, options, stage)?)
    }
}

/// Diagnoses the gap between a data set and its model: location, missing effect, and the part closed on
/// held-out runs; `stage` is called with the name of each step.
pub fn diagnose(
    set: &DataSet,
    options: &gap::Options,
    stage: impl FnMut(&'static str),
) -> Result<gap::Report, Error> {
    diagnosis::Library::shipped()?.diagnose(None, set, options, stage)
}
