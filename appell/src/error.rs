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
    /// A failure at one value of a schedule.
    #[error("at {}: {source}", visible(place))]
    At {
        /// The quantity with its value.
        place: String,
        /// The failure.
        source: Box<Error>,
    },
    /// A computation failed, or a lower crate refuses the request or the data.
    #[error("{}", visible(&cause.to_string()))]
    Failed {
        /// Whose fault it is.
        class: Class,
        /// The invalid part of the request, where known.
        field: Option<Field>,
        /// The part of the request that may remedy the failure.
        remedy: Option<Field>,
        /// Why; see [`Error::cause`].
        #[source]
        cause: Cause,
    },
    /// Several failures.
    #[error("{}", plain(.0))]
    Several(Vec<Error>),
}

type Cause = Box<dyn std::error::Error + Send + Sync>;

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
    pub fn computation(cause: impl Into<Cause>) -> Self {
        Self::failed(Class::Computation, None, cause)
    }

    fn failed(class: Class, field: Option<Field>, cause: impl Into<Cause>) -> Self {
        Self::Failed {
            class,
            field,
            remedy: None,
            cause: cause.into(),
        }
    }

    /// The error of a lower crate that caused it, if it is one of this type.
    pub fn cause<E: std::error::Error + 'static>(&self) -> Option<&E> {
        match self {
            Self::Failed { cause, .. } => cause.downcast_ref(),
            _ => None,
        }
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
            Self::Report(_) | Self::Data { .. } | Self::File { .. } => Class::Data,
            Self::Request { .. } | Self::Expression(_) => Class::Request,
            Self::Failed { class, .. } => *class,
            Self::At { source, .. } => source.class(),
            Self::Several(all) => all.iter().map(Self::class).max().unwrap_or(Class::Request),
        }
    }

    /// The invalid part of the request, where known.
    pub fn field(&self) -> Option<Field> {
        match self {
            Self::Request { field, .. } => Some(*field),
            Self::Expression(error) => Some(error.field),
            Self::Failed { field, .. } => *field,
            Self::At { source, .. } => source.field(),
            _ => None,
        }
    }

    /// The part of the request that may remedy the failure.
    pub fn remedy(&self) -> Option<Field> {
        match self {
            Self::Failed { remedy, .. } => *remedy,
            Self::At { source, .. } => source.remedy(),
            _ => None,
        }
    }

    fn with_remedy(mut self, of: Option<Field>) -> Self {
        if let Self::Failed { remedy, .. } = &mut self {
            *remedy = of;
        }
        self
    }
}

/// Hint for an estimation without an optimum.
const ADVICE: &str = "; neither the parameters of the rig nor multiple shooting led to an optimum: state parameters nearer \
    to the truth, or estimate fewer";

fn plain(failures: &[Error]) -> String {
    let texts = failures.iter().map(ToString::to_string);
    texts.collect::<Vec<_>>().join("\n")
}

impl From<Report> for Error {
    fn from(report: Report) -> Self {
        Self::Report(Box::new(report))
    }
}

/// Errors of lower crates, each with its class and, where known, the invalid part of the request.
macro_rules! failures {
    ($($cause:ty, |$error:ident| $judged:expr;)*) => {$(
        impl From<$cause> for Error {
            fn from($error: $cause) -> Self {
                let (class, field) = $judged;
                Self::failed(class, field, $error)
            }
        }
    )*};
}

failures! {
    SignalError, |error| (Class::Data, None);
    SimulationError, |error| match error {
        SimulationError::Signal(_) => (Class::Data, None),
        SimulationError::Undetermined { .. } => (Class::Computation, None),
        _ => (Class::Request, None),
    };
    SteadyError, |error| match error {
        SteadyError::None { .. } | SteadyError::OutOfRange { .. } | SteadyError::Structure(_) => {
            (Class::Computation, None)
        }
        _ => (Class::Request, None),
    };
    StabilityError, |error| (Class::Computation, None);
    BranchError, |error| match error {
        BranchError::Steady(error) => return error.into(),
        BranchError::Stability(error) => return error.into(),
        BranchError::Isolated { .. } | BranchError::Range { .. } => {
            (Class::Request, Some(Field::Along))
        }
    };
    ChartError, |error| match error {
        ChartError::Branch(error) => return error.into(),
        ChartError::Grid(..) => (Class::Request, Some(Field::Grid)),
        _ => (Class::Computation, None),
    };
    RelationError, |error| match error {
        RelationError::Inverse(_) => (Class::Computation, None),
        RelationError::UnknownParameter { .. } => (Class::Request, Some(Field::Free)),
        RelationError::UnknownColumn { .. } => (Class::Request, Some(Field::Bias)),
    };
    BaseError, |error| match error {
        BaseError::NoInput { .. } | BaseError::Differs { .. } => (Class::Data, None),
        _ => (Class::Computation, None),
    };
    FileError, |error| match error {
        FileError::System { path, cause } => return Self::reading(&path)(cause),
        _ => (Class::Data, None),
    };
    DataError, |error| match error {
        DataError::Report(report) => return Self::Report(report),
        DataError::File(error) => return error.into(),
        DataError::Several(all) => return Self::Several(all.into_iter().map(Self::from).collect()),
        _ => (Class::Data, None),
    };
    DiagnoseError, |error| match error {
        DiagnoseError::Model(
            ModelError::Spec(report) | ModelError::Effect(EffectError(report)),
        ) => return Self::Report(report),
        DiagnoseError::Data(error) => return error.into(),
        DiagnoseError::NothingMeasured
        | DiagnoseError::LacksChannel { .. }
        | DiagnoseError::NothingToFit
        | DiagnoseError::Model(ModelError::Edit(_)) => (Class::Data, None),
        _ => (Class::Computation, None),
    };
}

impl From<IdentifyError> for Error {
    fn from(error: IdentifyError) -> Self {
        let (class, field) = match &error {
            IdentifyError::UnknownParameter { .. } => (Class::Request, Some(Field::Free)),
            IdentifyError::UnknownAddition { .. } => (Class::Request, Some(Field::Also)),
            IdentifyError::Rate { .. } => (Class::Request, Some(Field::Drifting)),
            IdentifyError::Estimate(
                EstimateError::Diverged { .. } | EstimateError::Stuck { .. },
            ) => return Self::computation(format!("{error}{ADVICE}")),
            IdentifyError::Estimate(_) => (Class::Computation, None),
            _ => (Class::Data, None),
        };
        let is_idle = matches!(error, IdentifyError::NothingFree);
        Self::failed(class, field, error).with_remedy(is_idle.then_some(Field::Free))
    }
}

impl From<FmuError> for Error {
    fn from(error: FmuError) -> Self {
        // Sources alone are possible all the same.
        let needs_code = !matches!(error, FmuError::Package(_));
        Self::computation(error).with_remedy(needs_code.then_some(Field::Sources))
    }
}

impl From<serde_json::Error> for Error {
    fn from(error: serde_json::Error) -> Self {
        Self::computation(format!("the result is not JSON: {error}"))
    }
}

impl From<EffectError> for Error {
    fn from(EffectError(report): EffectError) -> Self {
        Self::Report(report)
    }
}
