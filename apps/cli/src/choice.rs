//! Flags with a fixed set of values, for types of the library.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};

/// A word, its help, and its value.
pub(crate) type Choice<T> = (&'static str, &'static str, T);

/// The parser of a flag with these values.
pub(crate) fn one_of<T>(choices: &'static [Choice<T>]) -> impl TypedValueParser<Value = T>
where
    T: Copy + Send + Sync + 'static,
{
    let possible = choices
        .iter()
        .map(|(word, help, _)| PossibleValue::new(*word).help(*help));
    PossibleValuesParser::new(possible).try_map(|given| {
        let choice = choices.iter().find(|(word, ..)| *word == given);
        choice.map(|(.., value)| *value).ok_or("no such value")
    })
}
