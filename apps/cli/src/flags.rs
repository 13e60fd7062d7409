//! The flags by which parts of a request are given.

use appell::Field;

/// The flag of a part of a request, if it has one.
pub(crate) fn flag(field: Field) -> Option<&'static str> {
    Some(match field {
        Field::Engine => "--engine",
        Field::Set => "--set",
        Field::Initial => "--initial",
        Field::Input => "--input",
        Field::Recorded | Field::Inputs => "--inputs",
        Field::Interpolation => "--interpolation",
        Field::Feedback => "--feedback",
        Field::End => "--t-end-s",
        Field::Interval => "--dt-s",
        Field::Fix => "--fix",
        Field::Free => "--free",
        Field::Along => "--along",
        Field::Require => "--require",
        Field::Chart => "--chart",
        Field::Grid => "--grid",
        Field::Equation => "--equation",
        Field::About => "--about",
        Field::At => "--at",
        Field::Outputs => "--outputs",
        Field::Poles => "--poles",
        Field::Weights => "--lqr",
        Field::Sampling => "--sampled-ms, --delay-ms",
        Field::Schedule => "--schedule",
        Field::Attraction => "--attraction",
        Field::Duration => "--for-s",
        Field::Plot => "--plot",
        Field::Also => "--also",
        Field::Drifting => "--drifting",
        Field::Effects => "--without",
        Field::Hypothesis => "--hypothesis",
        Field::Bias => "--bias",
        Field::Letters => "--parameters",
        Field::Lock => "--lock",
        Field::Sources => "--sources-only",
        Field::Chunk => "--chunk",
        Field::Jobs => "--jobs",
        Field::Device => "--device",
        _ => return None,
    })
}
