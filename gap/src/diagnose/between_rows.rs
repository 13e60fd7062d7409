//! How inputs run between rows, where recordings do not say.
//!
//! An input that was sampled from a continuous signal and is held from row to row acts half a row late: a delay, or
//! whatever looks like one. A held command that is joined acts half a row early. The likelihood of the nominal model
//! tells which, as nothing that a rig may lack acts before its cause.

use appell_estimate::in_parallel;
use appell_recordings::{DataSet, FindingKind, Part, Role};
use appell_spec::mechanism::Interpolation;

use super::bench::Bench;
use super::{DiagnoseError, Options, by_forces, most_rows};
use crate::effects::EffectModel;

/// Gain in log-likelihood that tells. A command that feedback computes from a reading knows its noise: joined to the
/// row before, it seems to foretell the reading, by a few.
const CLEAR: f64 = 10.0;
/// Rows that are looked at.
const ROWS: usize = 2000;

/// Inputs that run on from row to row.
#[derive(Debug, Clone, PartialEq)]
pub struct Joined {
    /// Their columns.
    pub columns: Vec<String>,
    /// How their rows are joined.
    pub interpolation: Interpolation,
    /// What it gains in log-likelihood over held ones.
    pub gain: f64,
}

impl Joined {
    /// The word for it in a description of recordings.
    pub const fn word(&self) -> &'static str {
        match self.interpolation {
            Interpolation::Hold => "hold",
            Interpolation::Linear => "linear",
            Interpolation::Cubic => "cubic",
        }
    }
}

/// The recordings with smooth inputs joined, where these tell that they are.
pub(super) fn joined(set: &DataSet, options: &Options) -> Option<(DataSet, Joined)> {
    let is_smooth = |column: &String| {
        let mut findings = set.findings.iter();
        findings
            .any(|one| one.kind == FindingKind::SmoothInput && one.channel.as_ref() == Some(column))
    };
    let is_open = |&channel: &usize| {
        let own = &set.channels[channel];
        matches!(own.role, Role::Input(_)) && own.interpolation.is_none() && is_smooth(&own.column)
    };
    let open: Vec<usize> = (0..set.channels.len()).filter(is_open).collect();
    // Forces of motions are means about rows.
    if open.is_empty() || by_forces::applies(set, options) {
        return None;
    }
    let model = EffectModel::new(&set.spec, Vec::new()).ok()?;
    let run = |interpolation: Interpolation| {
        let mut set = set.clone();
        for &channel in &open {
            set.channels[channel].interpolation = Some(interpolation);
        }
        let log = log_likelihood(&set, &model).ok()?;
        Some((set, interpolation, log))
    };
    let ways = [
        Interpolation::Hold,
        Interpolation::Linear,
        Interpolation::Cubic,
    ];
    let mut ways = in_parallel(ways, run).into_iter();
    let (.., held) = ways.next()??;
    // They are smooth, so that lines have to be better by as much.
    let preferred = |interpolation| match interpolation {
        Interpolation::Cubic => CLEAR,
        _ => 0.0,
    };
    let ways = ways.flatten();
    let best = ways.max_by(|a, b| (a.2 + preferred(a.1)).total_cmp(&(b.2 + preferred(b.1))));
    let (set, interpolation, log) = best?;
    let gain = log - held;
    let columns = open
        .iter()
        .map(|&channel| set.channels[channel].column.clone());
    let joined = Joined {
        columns: columns.collect(),
        interpolation,
        gain,
    };
    (gain > CLEAR).then_some((set, joined))
}

/// Recordings before and now, with inputs that run between rows in one way.
pub(super) fn alike(
    [before, now]: [&DataSet; 2],
    options: &Options,
) -> ([DataSet; 2], Option<Joined>) {
    let (mut before, joined) = joined(before, options).map_or_else(
        || (before.clone(), None),
        |(set, joined)| (set, Some(joined)),
    );
    let mut now = now.clone();
    for channel in before.channels.iter_mut().chain(&mut now.channels) {
        let is_input = matches!(channel.role, Role::Input(_));
        if is_input && channel.interpolation.is_none() {
            let is_joined = |one: &Joined| one.columns.contains(&channel.column);
            let own = joined.as_ref().filter(|one| is_joined(one));
            let between = own.map_or(Interpolation::Hold, |one| one.interpolation);
            channel.interpolation = Some(between);
        }
    }
    ([before, now], joined)
}

fn log_likelihood(set: &DataSet, model: &EffectModel) -> Result<f64, DiagnoseError> {
    let fitted = set.only(Part::Fit).stretches(most_rows(set).min(ROWS));
    let bench = Bench::new(&fitted, model, &[])?;
    Ok(bench.nominal()?.fit.log_likelihood)
}
