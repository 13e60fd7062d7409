//! Why a request has no answer.

use std::path::{Path, PathBuf};

use appell_analysis::{BranchError, ChartError, StabilityError, SteadyError};
use appell_estimate::EstimateError;
use appell_files::FileError;
use appell_gap::base::BaseError;
use appell_gap::diagnose::DiagnoseError;
use appell_gap::effects::{EffectError, ModelError};
use appell_gap::identify::IdentifyError;
use appell_gap::inverse::RelationError;
use appell_recordings::DataError;
use appell_runtime::signal::SignalError;
use appell_runtime::simulate::SimulationError;
use appell_spec::{Diagnostic, Report, visible};

use crate::control::DesignError;
use crate::field::Field;
use crate::fmu::FmuError;

/// Why a request has no answer.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The request names something that does not exist, or is inconsistent.
    #[error("{field}: {}", visible(message))]
    Request {
        /// The part that is wrong.
        field: Field,
        /// The error and its remedy.
        message: String,
    },
    /// An expression of the request is wrong.
    #[error(transparent)]
    Expression(Box<ExpressionError>),
    /// A file is invalid; the report shows the positions.
    #[error("{}", .0.plain())]
    Report(Box<Report>),
    /// A file as a whole is invalid.
    #[error("{}: {}", visible(file), visible(message))]
    Data {
        /// The file.
        file: String,
        /// The error and its remedy.
        message: String,
    },
    /// A file cannot be read or written.
    #[error("cannot {doing} {}: {cause}", visible(&path.to_string_lossy()))]
    File {
        /// `read` or `write`.
        doing: &'static str,
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        #[source]
        cause: std::io::Error,
    },
    /// A file is not one that is read.
    #[error(transparent)]
    Unreadable(FileError),
    /// Recordings cannot be used.
    #[error("{}", visible(&.0.to_string()))]
    Recording(#[source] DataError),
    /// A table of inputs is not a function of time.
    #[error("{}: {source}", visible(file))]
    Table {
        /// The file.
        file: String,
        /// The reason.
        source: SignalError,
    },
    /// A signal of the spec is not a function of time.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// No motion can be computed.
    #[error(transparent)]
    Simulate(#[from] SimulationError),
    /// No steady motion satisfies the conditions, or they are inconsistent.
    #[error(transparent)]
    Steady(#[from] SteadyError),
    /// Steady motions cannot be continued.
    #[error(transparent)]
    Branch(BranchError),
    /// The stability of a motion cannot be determined.
    #[error(transparent)]
    Stability(#[from] StabilityError),
    /// No stability chart can be computed.
    #[error(transparent)]
    Chart(ChartError),
    /// No controller can be designed.
    #[error(transparent)]
    Design(Box<DesignError>),
    /// A failure at one value of a schedule.
    #[error("at {}: {source}", visible(place))]
    At {
        /// The quantity with its value.
        place: String,
        /// The failure.
        source: Box<Error>,
    },
    /// No parameters can be estimated.
    #[error("{}{}", .0, advice(.0))]
    Identify(#[from] IdentifyError),
    /// A gap cannot be diagnosed.
    #[error(transparent)]
    Diagnose(DiagnoseError),
    /// Recorded motions do not determine inputs or parameters.
    #[error(transparent)]
    Inverse(#[from] RelationError),
    /// Base parameters cannot be found.
    #[error(transparent)]
    Base(#[from] BaseError),
    /// No FMU can be made.
    #[error(transparent)]
    Fmu(Box<FmuError>),
    /// A result cannot be written as JSON.
    #[error("the result is not JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// Another computation failed.
    #[error("{}", visible(&.0.to_string()))]
    Computation(#[source] Box<dyn std::error::Error + Send + Sync>),
    /// Several failures.
    #[error("{}", plain(.0))]
    Several(Vec<Error>),
}

/// Class of an error.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Class {
    /// The request is wrong.
    Request,
    /// A file is wrong.
    Data,
    /// The computation failed.
    Computation,
}

/// Errors in an expression of a request.
#[derive(Debug, Clone, thiserror::Error)]
#[error("{}", self.report(&format!("{field} {name}")).plain())]
pub struct ExpressionError {
    /// The part of the request.
    pub field: Field,
    /// The quantity to which the expression is assigned.
    pub name: String,
    /// The expression.
    pub text: String,
    /// The errors, with their positions in the text.
    pub diagnostics: Vec<Diagnostic>,
}

impl ExpressionError {
    /// The report, with a name for the expression.
    pub fn report(&self, place: &str) -> Report {
        Report::new(place, self.text.clone(), self.diagnostics.clone())
    }
}

impl Error {
    /// A part of a request that is wrong.
    pub fn request(field: Field, message: impl Into<String>) -> Self {
        Self::Request {
            field,
            message: message.into(),
        }
    }

    /// A file as a whole is invalid.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "paths are displayed by temporary values"
    )]
    pub fn data(file: impl ToString, message: impl Into<String>) -> Self {
        Self::Data {
            file: file.to_string(),
            message: message.into(),
        }
    }

    /// A computation that failed.
    pub fn computation(source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self::Computation(source.into())
    }

    /// A file that cannot be read.
    pub fn reading(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        Self::about("read", path)
    }

    /// A file that cannot be written.
    pub fn writing(path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        Self::about("write", path)
    }

    fn about(doing: &'static str, path: &Path) -> impl FnOnce(std::io::Error) -> Self {
        move |cause| Self::File {
            doing,
            path: path.to_owned(),
            cause,
        }
    }

    /// Errors in an expression.
    pub(crate) fn expression(
        field: Field,
        name: &str,
        text: &str,
    ) -> impl FnOnce(Vec<Diagnostic>) -> Self {
        move |diagnostics| {
            Self::Expression(Box::new(ExpressionError {
                field,
                name: name.to_owned(),
                text: text.to_owned(),
                diagnostics,
            }))
        }
    }

    /// The class; of several failures, the gravest.
    pub fn class(&self) -> Class {
        match self {
            Self::Report(_)
            | Self::Signal(_)
            | Self::Simulate(SimulationError::Signal(_))
            | Self::Data { .. }
            | Self::File { .. }
            | Self::Unreadable(_)
            | Self::Recording(_)
            | Self::Table { .. } => Class::Data,
            Self::Simulate(SimulationError::Undetermined { .. }) => Class::Computation,
            Self::Request { .. }
            | Self::Expression(_)
            | Self::Simulate(_)
            | Self::Chart(ChartError::Grid(..)) => Class::Request,
            Self::Branch(error) | Self::Chart(ChartError::Branch(error)) => of_branch(error),
            Self::Stability(_)
            | Self::Chart(_)
            | Self::Fmu(_)
            | Self::Json(_)
            | Self::Computation(_) => Class::Computation,
            Self::Steady(error) => of_steady(error),
            Self::Design(error) => error.class(),
            Self::At { source, .. } => source.class(),
            Self::Identify(error) => of_identification(error),
            Self::Diagnose(error) => of_diagnosis(error),
            Self::Inverse(error) => match error {
                RelationError::Inverse(_) => Class::Computation,
                _ => Class::Request,
            },
            Self::Base(error) => match error {
                BaseError::NoInput { .. } | BaseError::Differs { .. } => Class::Data,
                _ => Class::Computation,
            },
            Self::Several(all) => all.iter().map(Self::class).max().unwrap_or(Class::Request),
        }
    }

    /// The invalid part of the request, where known.
    pub fn field(&self) -> Option<Field> {
        match self {
            Self::Request { field, .. } => Some(*field),
            Self::Expression(error) => Some(error.field),
            Self::Design(error) => error.field,
            Self::Chart(ChartError::Grid(..)) => Some(Field::Grid),
            Self::Branch(BranchError::Isolated { .. } | BranchError::Range { .. }) => {
                Some(Field::Along)
            }
            Self::Identify(IdentifyError::UnknownParameter { .. })
            | Self::Inverse(RelationError::UnknownParameter { .. }) => Some(Field::Free),
            Self::Identify(IdentifyError::UnknownAddition { .. }) => Some(Field::Also),
            Self::Identify(IdentifyError::Rate { .. }) => Some(Field::Drifting),
            Self::Inverse(RelationError::UnknownColumn { .. }) => Some(Field::Bias),
            Self::At { source, .. } => source.field(),
            _ => None,
        }
    }

    /// The part of the request that may remedy the failure.
    pub fn remedy(&self) -> Option<Field> {
        match self {
            Self::Identify(IdentifyError::NothingFree) => Some(Field::Free),
            Self::Fmu(error) if error.is_about_machine_code() => Some(Field::Sources),
            Self::At { source, .. } => source.remedy(),
            _ => None,
        }
    }
}

fn of_steady(error: &SteadyError) -> Class {
    match error {
        SteadyError::None { .. } | SteadyError::OutOfRange { .. } | SteadyError::Structure(_) => {
            Class::Computation
        }
        _ => Class::Request,
    }
}

fn of_branch(error: &BranchError) -> Class {
    match error {
        BranchError::Steady(error) => of_steady(error),
        BranchError::Isolated { .. } | BranchError::Range { .. } => Class::Request,
        BranchError::Stability(_) => Class::Computation,
    }
}

fn of_identification(error: &IdentifyError) -> Class {
    match error {
        IdentifyError::UnknownParameter { .. }
        | IdentifyError::UnknownAddition { .. }
        | IdentifyError::Rate { .. } => Class::Request,
        IdentifyError::Estimate(_) => Class::Computation,
        _ => Class::Data,
    }
}

fn of_diagnosis(error: &DiagnoseError) -> Class {
    match error {
        DiagnoseError::NothingMeasured
        | DiagnoseError::LacksChannel { .. }
        | DiagnoseError::NothingToFit
        | DiagnoseError::Model(ModelError::Edit(_)) => Class::Data,
        _ => Class::Computation,
    }
}

/// Hint for a failed estimation.
fn advice(error: &IdentifyError) -> &'static str {
    match error {
        IdentifyError::Estimate(EstimateError::Diverged { .. } | EstimateError::Stuck { .. }) => {
            "; neither the parameters of the rig nor multiple shooting led to an optimum: state parameters nearer to the \
             truth, or estimate fewer"
        }
        _ => "",
    }
}

fn plain(failures: &[Error]) -> String {
    let texts = failures.iter().map(ToString::to_string);
    texts.collect::<Vec<_>>().join("\n")
}

impl From<Report> for Error {
    fn from(report: Report) -> Self {
        Self::Report(Box::new(report))
    }
}

impl From<FileError> for Error {
    fn from(error: FileError) -> Self {
        match error {
            FileError::System { path, cause } => Self::reading(&path)(cause),
            other => Self::Unreadable(other),
        }
    }
}

impl From<DesignError> for Error {
    fn from(error: DesignError) -> Self {
        Self::Design(Box::new(error))
    }
}

impl From<FmuError> for Error {
    fn from(error: FmuError) -> Self {
        Self::Fmu(Box::new(error))
    }
}

impl From<BranchError> for Error {
    fn from(error: BranchError) -> Self {
        match error {
            BranchError::Steady(error) => Self::Steady(error),
            BranchError::Stability(error) => Self::Stability(error),
            other => Self::Branch(other),
        }
    }
}

impl From<ChartError> for Error {
    fn from(error: ChartError) -> Self {
        match error {
            ChartError::Branch(error) => error.into(),
            other => Self::Chart(other),
        }
    }
}

impl From<EffectError> for Error {
    fn from(EffectError(report): EffectError) -> Self {
        Self::Report(report)
    }
}

impl From<DataError> for Error {
    fn from(error: DataError) -> Self {
        match error {
            DataError::Report(report) => Self::Report(report),
            DataError::File(error) => error.into(),
            DataError::Several(errors) => {
                Self::Several(errors.into_iter().map(Self::from).collect())
            }
            whole => Self::Recording(whole),
        }
    }
}

impl From<DiagnoseError> for Error {
    fn from(error: DiagnoseError) -> Self {
        match error {
            DiagnoseError::Model(
                ModelError::Spec(report) | ModelError::Effect(EffectError(report)),
            ) => Self::Report(report),
            DiagnoseError::Data(error) => error.into(),
            other => Self::Diagnose(other),
        }
    }
}
