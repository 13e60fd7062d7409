//! Identifiers of arguments, constants and values without a name from the derivation.

use rustc_hash::FxHashSet;

use crate::program::{FunctionKind, Program};
use crate::symbolic::Rational;
use crate::tape::Argument;

/// Longest generated name.
pub(super) const LONGEST: usize = 31;

/// `text` if it consists of ASCII letters, digits and underscores; other characters are
/// transliterated.
pub(crate) fn identifier(text: &str) -> String {
    let mut name: String = text
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    if !name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_') {
        name.insert(0, '_');
    }
    // Names of underscores only are rejected.
    if name.chars().all(|c| c == '_') {
        name.push_str("unnamed");
    }
    name
}

/// Names in use in one function.
#[derive(Debug, Clone, Default)]
pub(crate) struct Names {
    taken: FxHashSet<String>,
}

impl Names {
    /// `wanted`, made unique by a suffix if necessary.
    pub(crate) fn fresh(&mut self, wanted: &str) -> String {
        let wanted = identifier(wanted);
        let mut name = wanted.clone();
        let mut number = 2;
        while !self.taken.insert(name.clone()) {
            name = format!("{wanted}_{number}");
            number += 1;
        }
        name
    }

    /// Whether a name is taken.
    pub(super) fn has(&self, name: &str) -> bool {
        self.taken.contains(name)
    }

    /// Reserves a name.
    pub(super) fn reserve(&mut self, name: &str) {
        self.taken.insert(name.to_owned());
    }
}

/// Unique identifiers of the arguments of a program, used for the fields of the argument structs
/// and the locals of every function.
#[derive(Debug, Clone)]
pub(crate) struct ArgumentNames {
    /// Time.
    pub(crate) time: String,
    /// States.
    pub(crate) states: Vec<String>,
    /// Inputs.
    pub(crate) inputs: Vec<String>,
    /// Parameters.
    pub(crate) parameters: Vec<String>,
    /// Weights of the adjoint of the rates.
    pub(crate) weights: Vec<String>,
    /// Weights of the adjoint of the outputs.
    pub(crate) output_weights: Vec<String>,
    /// Given pseudo-accelerations, in functions that have them as arguments.
    pub(crate) accelerations: Vec<String>,
}

impl ArgumentNames {
    /// The identifiers for a program.
    pub(crate) fn of(program: &Program) -> Self {
        let mut names = Names::default();
        let info = &program.info;
        let mut all = |quantities: &[appell_runtime::model::Quantity]| -> Vec<String> {
            quantities
                .iter()
                .map(|quantity| names.fresh(&quantity.name))
                .collect()
        };
        let (states, inputs) = (all(&info.states), all(&info.inputs));
        let parameters = all(&info.parameters);
        let time = names.fresh("t");
        let adjoints = [FunctionKind::Adjoint, FunctionKind::OutputAdjoint];
        let [weights, output_weights] = adjoints.map(|kind| {
            let functions = program.function(kind).into_iter();
            let weights = functions.flat_map(|f| f.own.iter().map(|&w| f.graph.symbol_name(w)));
            weights.map(|weight| names.fresh(weight)).collect()
        });
        let speeds = states.iter().take(info.speeds);
        let accelerations = speeds
            .map(|speed| names.fresh(&format!("{speed}_dot")))
            .collect();
        Self {
            time,
            states,
            inputs,
            parameters,
            weights,
            output_weights,
            accelerations,
        }
    }

    /// Name of an argument.
    pub(crate) fn get(&self, argument: Argument) -> &str {
        match argument {
            Argument::Time => &self.time,
            Argument::State(i) => &self.states[i as usize],
            Argument::Input(i) => &self.inputs[i as usize],
            Argument::Parameter(i) => &self.parameters[i as usize],
            Argument::Weight(i) => &self.weights[i as usize],
            Argument::OutputWeight(i) => &self.output_weights[i as usize],
            Argument::Acceleration(i) => &self.accelerations[i as usize],
        }
    }

    /// All names except those of accelerations, which are computed in most functions.
    pub(crate) fn iter(&self) -> impl Iterator<Item = &String> {
        let lists = self
            .states
            .iter()
            .chain(&self.inputs)
            .chain(&self.parameters)
            .chain(&self.weights)
            .chain(&self.output_weights);
        std::iter::once(&self.time).chain(lists)
    }

    /// A name different from all of them.
    pub(crate) fn free(&self, wanted: &str) -> String {
        let mut name = wanted.to_owned();
        while self.iter().any(|other| *other == name) {
            name.push('_');
        }
        name
    }

    /// Name of a numeric local: `half`, `three_quarters`, `c_17_over_35`. Equal names denote equal
    /// numbers, and no argument has such a name.
    pub(crate) fn constant(&self, value: &Rational) -> String {
        let mut name = number_in_words(value);
        while self.iter().any(|argument| *argument == name) {
            name.insert_str(0, "number_");
        }
        name
    }
}

/// `two`, `half`, `minus_three_quarters`, `c_17_over_35`.
fn number_in_words(value: &Rational) -> String {
    const WHOLE: &str = "zero one two three four five six seven eight nine ten eleven twelve thirteen \
        fourteen fifteen sixteen seventeen eighteen nineteen";
    const TENS: [&str; 10] = [
        "", "", "twenty", "thirty", "forty", "fifty", "sixty", "seventy", "eighty", "ninety",
    ];
    const PART: [&str; 9] = [
        "", "", "half", "third", "quarter", "fifth", "sixth", "seventh", "eighth",
    ];
    if value.is_negative() {
        return format!("minus_{}", number_in_words(&value.abs()));
    }
    let small = |n: i64| usize::try_from(n).ok();
    if let Some((numerator, denominator)) = value.as_small()
        && let (Some(n), Some(d)) = (small(numerator), small(denominator))
    {
        let whole = |n: usize| WHOLE.split(' ').nth(n);
        match (whole(n), PART.get(d)) {
            (Some(whole), _) if d == 1 => return whole.to_owned(),
            (None, _) if d == 1 && n < 100 => {
                let (ten, one) = (TENS[n / 10], whole(n % 10).filter(|_| n % 10 > 0));
                return one.map_or_else(|| ten.to_owned(), |one| format!("{ten}_{one}"));
            }
            (Some(_), Some(part)) if d > 1 && n == 1 => return (*part).to_owned(),
            (Some(whole), Some(part)) if d > 2 => return format!("{whole}_{part}s"),
            (Some(whole), Some(_)) if d == 2 => return format!("{whole}_halves"),
            _ => {}
        }
    }
    match super::pi::parts_of_pi(value) {
        Some((1, 1)) => "pi".to_owned(),
        Some((1, denominator)) => format!("pi_over_{denominator}"),
        Some((numerator, 1)) => format!("c_{numerator}_pi"),
        Some((numerator, denominator)) => format!("c_{numerator}_pi_over_{denominator}"),
        None => format!("c_{}", value.to_string().replace('/', "_over_")),
    }
}

/// `a` and `b` joined in one name, unless it becomes too long.
pub(super) fn joined(parts: &[&str]) -> Option<String> {
    joined_up_to(LONGEST, parts)
}

/// The same for names of up to `longest` characters.
pub(super) fn joined_up_to(longest: usize, parts: &[&str]) -> Option<String> {
    let name = parts.join("_");
    (name.len() <= longest && !name.contains("_part_")).then_some(name)
}
