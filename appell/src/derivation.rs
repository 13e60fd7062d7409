//! The derivation of a spec as a page, as emitted code and as a drawing.

use appell_codegen::compile::report;
use appell_codegen::derived;
use appell_codegen::emit::{Options, emit, emit_functions};
use appell_codegen::linearisation::{Linearisation, SteadyMotion};
use appell_codegen::mechanics::finding::Finding;
use appell_codegen::mechanics::{Derivation, assemble};
use appell_codegen::program::Program;
use appell_codegen::python;
use appell_report::derivation::{self, Page};
use appell_report::drawing::{Moment, drawing, drawing_at};
use appell_spec::mechanism::Mechanism;

pub use appell_codegen::c;
pub use appell_codegen::program::FunctionKind;
pub use appell_report::derivation::Stage;

use crate::conditions::conditions;
use crate::setup::{Assignment, Setup};
use crate::source::Source;
use crate::{Error, Field};

/// The format of a page.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Unicode, for a terminal.
    Text,
    /// A document for LaTeX.
    Latex,
    /// A page for a browser.
    Html,
    /// The equations alone, in LaTeX.
    Formulas,
}

impl Format {
    fn set(self, page: &Page) -> String {
        match self {
            Self::Text => derivation::text(page),
            Self::Latex => derivation::latex(page),
            Self::Html => derivation::html(page),
            Self::Formulas => derivation::formulas(page),
        }
    }
}

impl Source {
    /// The spec with its joints expanded into items of other sections.
    ///
    /// ```
    /// let pendulum = appell::Source::shipped("pendulum")?;
    /// assert_eq!(pendulum.expanded()?, pendulum.text);
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn expanded(&self) -> Result<String, Error> {
        Ok(appell_spec::expanded(&self.file, &self.text)?)
    }

    /// The mechanism that the spec describes.
    pub fn mechanism(&self) -> Result<Mechanism, Error> {
        Ok(appell_spec::load(&self.file, &self.text)?.mechanism)
    }

    /// The mechanism with its derivation.
    pub(crate) fn derived(&self) -> Result<(Mechanism, Derivation), Error> {
        let derived = derived(&self.file, &self.text)?;
        Ok((derived.mechanism, derived.derivation))
    }

    /// The derivation, from frames up to a stage.
    ///
    /// ```
    /// use appell::Source;
    /// use appell::derivation::{Format, Stage};
    ///
    /// let page = Source::shipped("pendulum")?.derivation(Stage::Energy, Format::Text)?;
    /// assert!(page.contains("Acceleration energy"));
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn derivation(&self, stage: Stage, format: Format) -> Result<String, Error> {
        let (mechanism, mut derivation) = self.derived()?;
        let page = derivation::page(&mechanism, &mut derivation, stage)
            .map_err(|findings| report(&mechanism, &self.text, &findings))?;
        Ok(format.set(&page))
    }

    /// The equations of motion alone, without their derivation.
    ///
    /// ```
    /// use appell::Source;
    /// use appell::derivation::Format;
    ///
    /// let equations = Source::shipped("pendulum")?.equations_of_motion(Format::Formulas)?;
    /// assert!(equations.starts_with("\\begin{align*}"));
    /// # Ok::<(), appell::Error>(())
    /// ```
    pub fn equations_of_motion(&self, format: Format) -> Result<String, Error> {
        let (mechanism, mut derivation) = self.derived()?;
        let page = derivation::equations_of_motion(&mechanism, &mut derivation);
        Ok(format.set(&page))
    }

    /// The linear equations about a steady motion: A, B and the characteristic polynomial. States, rates
    /// and inputs without a condition such as `theta=0` or `dot(psi)=0` stay symbolic.
    pub fn linear_equations(&self, about: &[String], format: Format) -> Result<String, Error> {
        let (mechanism, mut derivation) = self.derived()?;
        let conditions = conditions(&self.text, &mechanism, &mut derivation, about)?;
        let steady = SteadyMotion::new(&mechanism, &mut derivation, &conditions);
        let linear = steady.and_then(|steady| Linearisation::about(&mut derivation, steady));
        let linear = linear.map_err(|error| Error::request(Field::About, error.to_string()))?;
        let page = derivation::linear(&mechanism, &mut derivation, &linear);
        Ok(format.set(&page))
    }

    /// The functions that are emitted by default: derivatives by parameters only up to 64 of these.
    pub fn functions(&self) -> Result<Vec<FunctionKind>, Error> {
        Ok(FunctionKind::standard(self.mechanism()?.parameters.len()))
    }

    /// The module that a build script includes, with the selected functions; a regressor excludes others.
    pub fn rust(&self, functions: &[FunctionKind]) -> Result<String, Error> {
        let program = self.program(functions)?;
        let emitted = if functions == [FunctionKind::Regressor] {
            emit_functions(&program, functions)
        } else {
            let options = Options {
                spec: Some(self.text.clone()),
                ..Options::default()
            };
            emit(&program, &options)
        };
        Ok(emitted.map_err(Error::computation)?.source)
    }

    /// C99: a header and a source without allocation.
    pub fn c(&self, options: &c::Options) -> Result<c::Emitted, Error> {
        Ok(c::emit(&self.program(&options.functions)?, options))
    }

    /// CUDA C++ in one source: the functions, and kernels that evaluate them at many places, one thread each.
    pub fn cuda(&self, options: &c::Options) -> Result<String, Error> {
        Ok(c::cuda(&self.program(&options.functions)?, options))
    }

    /// The same, with the kernels in it, and the numbers of states and parameters.
    #[cfg(feature = "cuda")]
    pub(crate) fn kernels(
        &self,
        options: &c::Options,
    ) -> Result<(String, Vec<c::Kernel>, [usize; 2]), Error> {
        let program = self.program(&options.functions)?;
        let widths = [program.info.state_len(), program.info.parameter_len()];
        let kernels = c::kernels(&program, options);
        Ok((c::cuda(&program, options), kernels, widths))
    }

    /// A module of Python functions over an array namespace: `numpy`, `jax.numpy`, `casadi` or `sympy`.
    pub fn python(&self, functions: &[FunctionKind]) -> Result<String, Error> {
        Ok(python::module(&self.program(functions)?, functions))
    }

    fn program(&self, functions: &[FunctionKind]) -> Result<Program, Error> {
        Ok(match functions {
            [FunctionKind::Regressor] => self.regressor()?.program,
            functions => appell_codegen::compile(&self.file, &self.text, functions)?,
        })
    }

    /// The mechanism at its initial state, as SVG.
    pub fn drawing(&self) -> Result<String, Error> {
        self.drawing_at(&[], &[])
    }

    /// The mechanism at its initial state, with other values of some parameters and states.
    pub fn drawing_at(&self, set: &[Assignment], initial: &[Assignment]) -> Result<String, Error> {
        let (mechanism, derivation) = self.derived()?;
        let refused = |findings: Vec<Finding>| report(&mechanism, &self.text, &findings);
        if set.is_empty() && initial.is_empty() {
            return drawing(&mechanism, derivation).map_err(|findings| refused(findings).into());
        }
        let names = assemble::program(derivation.clone(), &mechanism, &[]).map_err(refused)?;
        let mut setup = Setup::new(&self.file, &self.text, &names.info)?;
        setup.set(set)?;
        setup.start(initial)?;
        let given = set.iter().chain(initial);
        let given = given.map(|Assignment { name, value }| format!("{name} = {value}"));
        let moment = Moment {
            given: given.collect::<Vec<_>>().join(", "),
            parameters: setup.parameters,
            states: setup.initial,
        };
        drawing_at(&mechanism, derivation, &moment).map_err(|findings| refused(findings).into())
    }
}
