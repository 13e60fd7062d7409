//! Compiles the text of a spec to its program; all errors are reported at their positions in the text.

use appell_spec::mechanism::Mechanism;
use appell_spec::{Code, Diagnostic, Report, Severity};

use crate::audit::{Audit, audit, counts_velocities, reasons};
use crate::mechanics::assemble::Functions;
use crate::mechanics::finding::{Finding, Item};
use crate::mechanics::{self, Derivation, Regressor, derive};
use crate::program::{FunctionKind, Program};

/// A mechanism whose equations of motion have been derived.
#[derive(Clone)]
pub struct Derived {
    /// The mechanism.
    pub mechanism: Mechanism,
    /// The derivation, stage by stage.
    pub derivation: Derivation,
    /// Constructs in the spec that are probably unintended.
    pub warnings: Vec<Diagnostic>,
}

/// Reads a spec and derives its equations of motion; `file` is its name in messages and in
/// emitted code.
pub fn derived(file: &str, text: &str) -> Result<Derived, Report> {
    let checked = appell_spec::load(file, text)?;
    match derive(&checked.mechanism) {
        Ok(derivation) => {
            let mut warnings = checked.warnings;
            let found = derivation.warnings.iter();
            warnings.extend(
                found.map(|finding| {
                    diagnostic(&checked.mechanism, text, finding, Severity::Warning)
                }),
            );
            Ok(Derived {
                mechanism: checked.mechanism,
                derivation,
                warnings,
            })
        }
        Err(findings) => Err(refused(&checked.mechanism, text, &findings)),
    }
}

/// [`derived`], with the results of an [audit](crate::audit) of the equations as further warnings, notes
/// included.
pub fn audited(file: &str, text: &str) -> Result<Derived, Report> {
    let mut derived = derived(file, text)?;
    derived.audit(text);
    Ok(derived)
}

impl Derived {
    /// The program with the functions `kinds`; `text` is that of the spec.
    pub fn program(self, text: &str, kinds: &[FunctionKind]) -> Result<Program, Report> {
        let functions = self.functions();
        let program = functions.program(kinds);
        program.map_err(|findings| report(functions.mechanism(), text, &findings))
    }

    /// The functions of the model, to be derived on request.
    pub fn functions(self) -> Functions {
        Functions::new(self.derivation, self.mechanism)
    }

    /// Adds the results of an [audit](crate::audit) of the equations to the warnings; `text` is that of the
    /// spec.
    pub fn audit(&mut self, text: &str) {
        let Audit { warnings, notes } = audit(&self.mechanism, &self.derivation);
        let findings = warnings.iter().map(|finding| (finding, Severity::Warning));
        for (finding, severity) in findings.chain(notes.iter().map(|note| (note, Severity::Note))) {
            let diagnostic = diagnostic(&self.mechanism, text, finding, severity);
            // An unused item has no effect either.
            let place = |d: &Diagnostic| d.labels.first().map(|(span, _)| span.clone());
            let is_told = |known: &Diagnostic| {
                known.code == Code::UnusedName && place(known) == place(&diagnostic)
            };
            if !self.warnings.iter().any(is_told) {
                self.warnings.push(diagnostic);
            }
        }
    }
}

/// Reads a spec and derives the program with the functions `kinds`.
pub fn compile(file: &str, text: &str, kinds: &[FunctionKind]) -> Result<Program, Report> {
    derived(file, text)?.program(text, kinds)
}

/// Reads a spec and derives its [regressor](crate::mechanics::regressor).
pub fn regressor(file: &str, text: &str) -> Result<Regressor, Report> {
    let checked = appell_spec::load(file, text)?;
    mechanics::regressor(&checked.mechanism)
        .map_err(|findings| refused(&checked.mechanism, text, &findings))
}

/// Report on a rejected mechanism: the errors, and possible causes as warnings.
fn refused(mechanism: &Mechanism, text: &str, findings: &[Finding]) -> Report {
    let reasons = reasons(mechanism, findings);
    let mut findings = findings.to_vec();
    if let Some(Item::Constraint(first)) = reasons.first().map(|reason| reason.item) {
        let name = &mechanism.constraints[first].name;
        for finding in findings.iter_mut().filter(|f| counts_velocities(f.code)) {
            finding.help = format!("correct `{name}` first: it may be the cause");
        }
    }
    let errors = findings.iter().map(|finding| (finding, Severity::Error));
    let reasons = reasons.iter().map(|reason| (reason, Severity::Warning));
    report_of(mechanism, text, errors.chain(reasons))
}

/// Errors of the derivation, at their positions in the text of the spec.
pub fn report(mechanism: &Mechanism, text: &str, findings: &[Finding]) -> Report {
    let errors = findings.iter().map(|finding| (finding, Severity::Error));
    report_of(mechanism, text, errors)
}

fn report_of<'f>(
    mechanism: &Mechanism,
    text: &str,
    findings: impl Iterator<Item = (&'f Finding, Severity)>,
) -> Report {
    let diagnostics =
        findings.map(|(finding, severity)| diagnostic(mechanism, text, finding, severity));
    Report::new(mechanism.file.as_str(), text, diagnostics.collect())
}

fn diagnostic(
    mechanism: &Mechanism,
    text: &str,
    finding: &Finding,
    severity: Severity,
) -> Diagnostic {
    let item = match finding.item {
        Item::Mechanism => None,
        Item::Parameter(i) => Some(&mechanism.parameters[i].label.span),
        Item::Coordinate(i) => Some(&mechanism.coordinates[i].label.span),
        Item::Input(i) => Some(&mechanism.inputs[i].label.span),
        Item::Frame(i) => Some(&mechanism.frames[i].span),
        Item::Point(i) => Some(&mechanism.points[i].span),
        Item::Body(i) => Some(&mechanism.bodies[i].span),
        Item::Constraint(i) => Some(&mechanism.constraints[i].span),
        Item::PseudoVelocity(i) => Some(&mechanism.pseudo_velocities[i].label.span),
        Item::Load(i) => Some(&mechanism.loads[i].span),
        Item::Output(i) => Some(&mechanism.outputs[i].label.span),
    };
    let span = item.cloned().filter(|span| !span.is_empty()).or_else(|| {
        // Findings about the whole mechanism are shown at its pseudo-velocities.
        let (ast, _) = appell_spec::parse::parse(text);
        let section = |name: &str| {
            ast.sections
                .iter()
                .find(|s| s.section.name == name)
                .map(|s| s.span.clone())
        };
        let sections = ["pseudo_velocities", "joints", "mechanism"];
        sections.into_iter().find_map(section)
    });
    let diagnostic =
        Diagnostic::error(finding.code, finding.message.as_str()).help(finding.help.as_str());
    Diagnostic {
        severity,
        ..diagnostic.at(span.unwrap_or_default(), "")
    }
}
