//! Gains, biases, lags, delays and limits of actuators.

use appell_spec::{Code, did_you_mean};

use crate::options::Options;
use crate::xml::{Element, Findings, children, elements, tag};

use super::super::schema::ACTUATORS;
use super::bytes::{number, numbers, same};
use super::change::{Amount, Refused, refused};
use super::law::Law;
use super::sheet::Sheet;

/// Attributes of shortcuts that `general` does not have.
const OF_SHORTCUTS: [&str; 9] = [
    "kp",
    "kv",
    "dampratio",
    "timeconst",
    "inheritrange",
    "area",
    "diameter",
    "bias",
    "input",
];
/// Numbers of an affine bias: constant, factor of the length, factor of the rate.
const AFFINE: usize = 3;
/// How far a delay may be rounded to whole steps, relative to it.
const ROUNDED: f64 = 0.02;

impl<'x> Sheet<'x, '_> {
    /// The element of an actuator.
    fn actuator(&self, name: &str) -> Result<Element<'x>, Refused> {
        let all = || children(self.root, "actuator").flat_map(elements);
        let found = all().find(|one| called(*one) == name);
        found.ok_or_else(|| {
            let known: Vec<String> = all().map(called).collect();
            let known = known.iter().map(String::as_str);
            refused(
                Code::UnknownReference,
                tag(self.root),
                format!("there is no actuator `{}`", appell_spec::shown(name)),
                did_you_mean(name, known, || "name an actuator of the file".to_owned()),
            )
        })
    }

    /// The law of an actuator, and that of its class alone.
    fn law(&self, actuator: Element<'x>) -> Result<(Law, Law), Refused> {
        let own = |key: &str| self.own(actuator, key);
        self.law_with(actuator, self.kind(actuator), &own)
    }

    fn law_with(
        &self,
        actuator: Element<'x>,
        kind: &str,
        own: &dyn Fn(&str) -> Option<String>,
    ) -> Result<(Law, Law), Refused> {
        let mut law = Law::default();
        for default in self.defaults.chain(ACTUATORS, Self::class(actuator)) {
            let own = |key: &str| default.attribute(key).map(str::to_owned);
            law.add(default, default.tag_name().name(), &own)?;
        }
        let class = law.clone();
        law.add(actuator, kind, own)?;
        Ok((law, class))
    }

    /// An actuator, its law, and the law of its class; refuses those with another law than gain and affine bias.
    fn affine(&self, name: &str) -> Result<(Element<'x>, Law, Law), Refused> {
        let actuator = self.actuator(name)?;
        let (mut law, class) = self.law(actuator)?;
        if law.has_damping_ratio() {
            law.bias[2] = -self.damping(actuator, name)?;
        }
        if law.is_affine() {
            return Ok((actuator, law, class));
        }
        let kind = self.kind(actuator);
        let message = format!("`{kind}` `{name}` has no constant gain");
        let help = "only actuators with a fixed gain and an affine bias are changed";
        Err(refused(Code::NotAllowedHere, tag(actuator), message, help))
    }

    #[allow(
        clippy::unnecessary_box_returns,
        reason = "all refusals are boxed, as errors of results"
    )]
    fn no_such_gain(&self, actuator: Element<'x>, name: &str, gain: &str) -> Refused {
        let kind = self.kind(actuator);
        let message = format!("`{kind}` `{name}` has no `{gain}`");
        let help = "it is a number of `position`, `velocity`, and `general` with an affine bias";
        refused(Code::NotAllowedHere, tag(actuator), message, help)
    }

    /// The damping of a servo that `MuJoCo` computes from its damping ratio and the inertias of the file.
    fn damping(&self, actuator: Element<'x>, name: &str) -> Result<f64, Refused> {
        let options = Options {
            actuators: true,
            ..Options::default()
        };
        let findings = Findings::default();
        let robot = super::super::read(self.root, &findings, self.whole, &options);
        let drives = robot.drives.unwrap_or_default();
        let found = drives.iter().find(|drive| drive.name == name);
        let found = found.filter(|drive| drive.bias[2] <= 0.0);
        found.map(|drive| -drive.bias[2]).ok_or_else(|| {
            let message = format!("the damping of `{name}` is not known");
            let help = "write the `kv` that MuJoCo computes from `dampratio`";
            refused(Code::NotAllowedHere, tag(actuator), message, help)
        })
    }

    /// Writes the factor of the rate of a position servo where it changes, in the place of a damping ratio.
    fn write_damping(&mut self, actuator: Element<'x>, law: &Law) -> Result<(), Refused> {
        let (before, _) = self.law(actuator)?;
        if same(before.bias[2], law.bias[2]) {
            return Ok(());
        }
        self.remove(actuator, "dampratio")?;
        self.set(actuator, "kv", number(-law.bias[2]))
    }

    /// Writes out the damping of servos that have a damping ratio.
    pub(super) fn write_damping_ratios(&mut self) -> Result<(), Refused> {
        let all = children(self.root, "actuator").flat_map(elements);
        for actuator in all.collect::<Vec<Element<'x>>>() {
            if !self.law(actuator)?.0.has_damping_ratio() {
                continue;
            }
            let (_, law, class) = self.affine(&called(actuator))?;
            match self.kind(actuator) {
                "general" => self.write_law(actuator, &law, &class)?,
                _ => self.write_damping(actuator, &law)?,
            }
        }
        Ok(())
    }

    pub(super) fn kp(&mut self, name: &str, amount: Amount) -> Result<(), Refused> {
        let (actuator, mut law, class) = self.affine(name)?;
        let before = law.gain[0];
        let after = amount.of(before);
        if same(after, before) {
            return Ok(());
        }
        match self.kind(actuator) {
            "position" | "intvelocity" => {
                self.set(actuator, "kp", number(after))?;
                self.write_damping(actuator, &law)
            }
            "general" if law.acting_bias()[1] != 0.0 => {
                law.bias[1] = if same(law.bias[1], -before) {
                    -after
                } else {
                    law.bias[1] * after / before
                };
                law.gain[0] = after;
                self.write_law(actuator, &law, &class)
            }
            _ => Err(self.no_such_gain(actuator, name, "kp")),
        }
    }

    pub(super) fn kv(&mut self, name: &str, amount: Amount) -> Result<(), Refused> {
        let (actuator, mut law, class) = self.affine(name)?;
        let kind = self.kind(actuator);
        let is_rate = law.bias[1] == 0.0 && same(law.bias[2], -law.gain[0]);
        let before = match kind {
            "position" | "intvelocity" | "velocity" | "general" => -law.acting_bias()[2],
            "damper" => -law.gain[2],
            _ => return Err(self.no_such_gain(actuator, name, "kv")),
        };
        let after = self.at_least_zero(name, "kv", amount.of(before));
        if same(after, before) {
            return Ok(());
        }
        if kind != "general" {
            self.remove(actuator, "dampratio")?;
            return self.set(actuator, "kv", number(after));
        }
        if law.biastype == "none" {
            law.bias = law.acting_bias();
            "affine".clone_into(&mut law.biastype);
        }
        law.bias[2] = -after;
        if is_rate {
            law.gain[0] = after;
        }
        self.write_law(actuator, &law, &class)
    }

    pub(super) fn gear(&mut self, name: &str, amount: Amount) -> Result<(), Refused> {
        let actuator = self.actuator(name)?;
        let given = self.numbers(actuator, ACTUATORS, "gear")?;
        let mut gear = given.unwrap_or_default();
        gear.resize(gear.len().max(1), 1.0);
        let after = amount.of(gear[0]);
        if same(after, gear[0]) {
            return Ok(());
        }
        gear[0] = after;
        self.set(actuator, "gear", numbers(&gear))
    }

    pub(super) fn gain(&mut self, name: &str, factor: f64) -> Result<(), Refused> {
        if same(factor, 1.0) {
            return Ok(());
        }
        let (actuator, mut law, class) = self.affine(name)?;
        let times = |all: Vec<f64>, factor: f64| -> Vec<f64> {
            all.into_iter().map(|one| one * factor).collect()
        };
        let kind = self.kind(actuator);
        if kind == "motor" {
            let gear = self.numbers(actuator, ACTUATORS, "gear")?;
            let gear = times(gear.unwrap_or_else(|| vec![1.0]), factor);
            self.set(actuator, "gear", numbers(&gear))?;
            // Inertia and damping of the drive act with the square of the gear.
            for key in ["armature", "damping"] {
                if let Some(all) = self.numbers(actuator, ACTUATORS, key)? {
                    let all = times(all, 1.0 / (factor * factor));
                    self.set(actuator, key, numbers(&all))?;
                }
            }
            return Ok(());
        }
        if let Some(range) = self.numbers(actuator, ACTUATORS, "forcerange")? {
            self.set(actuator, "forcerange", numbers(&times(range, factor)))?;
        }
        let constant = law.acting_bias()[0] != 0.0;
        match kind {
            "position" | "intvelocity" if !constant => {
                law.bias[2] *= factor;
                self.set(actuator, "kp", number(law.gain[0] * factor))?;
                self.write_damping(actuator, &law)
            }
            "velocity" => self.set(actuator, "kv", number(law.gain[0] * factor)),
            "damper" => self.set(actuator, "kv", number(-law.gain[2] * factor)),
            _ => {
                law.gain = law.gain.map(|one| one * factor);
                law.bias = law.bias.map(|one| one * factor);
                self.write_law(actuator, &law, &class)
            }
        }
    }

    pub(super) fn bias(&mut self, name: &str, add: f64) -> Result<(), Refused> {
        if add == 0.0 {
            return Ok(());
        }
        let (actuator, mut law, class) = self.affine(name)?;
        law.bias = law.acting_bias();
        law.bias[0] += add;
        "affine".clone_into(&mut law.biastype);
        self.write_law(actuator, &law, &class)
    }

    pub(super) fn lag(&mut self, name: &str, seconds: f64) -> Result<(), Refused> {
        let (actuator, mut law, class) = self.affine(name)?;
        let seconds = self.at_least_zero(name, "time constant", seconds);
        let before = match law.dyntype.as_str() {
            "none" => 0.0,
            "filter" | "filterexact" => law.dynamics[0],
            other => {
                let message = format!("actuator `{name}` has the dynamics `{other}`");
                let help = "a lag is written where an actuator has no dynamics or a filter";
                return Err(refused(Code::NotAllowedHere, tag(actuator), message, help));
            }
        };
        if same(seconds, before) {
            return Ok(());
        }
        match self.kind(actuator) {
            "position" => return self.set(actuator, "timeconst", number(seconds)),
            "cylinder" if seconds > 0.0 => {
                return self.set(actuator, "timeconst", number(seconds));
            }
            _ => {}
        }
        if seconds == 0.0 {
            "none".clone_into(&mut law.dyntype);
        } else {
            if law.dyntype == "none" {
                "filterexact".clone_into(&mut law.dyntype);
            }
            law.dynamics[0] = seconds;
        }
        self.write_law(actuator, &law, &class)
    }

    pub(super) fn delay(&mut self, name: &str, seconds: f64) -> Result<(), Refused> {
        let actuator = self.actuator(name)?;
        let seconds = self.at_least_zero(name, "delay", seconds);
        let before = self.numbers(actuator, ACTUATORS, "delay")?;
        let before = before.and_then(|all| all.first().copied()).unwrap_or(0.0);
        if same(seconds, before) {
            return Ok(());
        }
        if seconds == 0.0 {
            self.remove(actuator, "delay")?;
            if self.inherited(actuator, ACTUATORS, "delay").is_some() {
                self.set(actuator, "delay", "0")?;
            }
            return Ok(());
        }
        let step = self.timestep()?;
        let whole = (seconds / step).round().max(1.0);
        let is_near = (whole * step - seconds).abs() <= ROUNDED * seconds;
        let (delay, samples) = if is_near {
            (whole * step, whole)
        } else {
            (seconds, (seconds / step).ceil())
        };
        self.set(actuator, "delay", number(delay))?;
        let given = self.numbers(actuator, ACTUATORS, "nsample")?;
        let enough = given.is_some_and(|all| all.first().is_some_and(|one| *one >= samples));
        if !enough {
            self.set(actuator, "nsample", number(samples))?;
        }
        if !is_near && self.given(actuator, ACTUATORS, "interp").is_none() {
            self.set(actuator, "interp", "linear")?;
        }
        Ok(())
    }

    pub(super) fn force_limit(&mut self, name: &str, limit: f64) -> Result<(), Refused> {
        let (actuator, ..) = self.affine(name)?;
        let limit = self.at_least_zero(name, "limit", limit);
        let range = [-limit, limit];
        let before = self.numbers(actuator, ACTUATORS, "forcerange")?;
        let limited = self.given(actuator, ACTUATORS, "forcelimited");
        let is_on = match limited.as_deref() {
            Some("true") => true,
            Some("false") => false,
            _ => self.compiler.autolimits,
        };
        if before.as_deref() != Some(&range) {
            self.set(actuator, "forcerange", numbers(&range))?;
        }
        if is_on {
            return Ok(());
        }
        self.set(actuator, "forcelimited", "true")
    }

    /// The actuators with their activations: before the changes, and after them.
    pub(super) fn activations(&self) -> Result<Vec<[bool; 2]>, Refused> {
        let all = children(self.root, "actuator").flat_map(elements);
        let both = all.map(|actuator| {
            let own = |key: &str| actuator.attribute(key).map(str::to_owned);
            let (before, _) = self.law_with(actuator, actuator.tag_name().name(), &own)?;
            let (after, _) = self.law(actuator)?;
            Ok([before, after].map(|law| law.dyntype != "none"))
        });
        both.collect()
    }

    /// What actuators of a joint add to its inertia, and to the damping of its rate.
    pub(super) fn drives_of(&self, joint: &str) -> Result<[f64; 2], Refused> {
        let mut sums = [0.0; 2];
        for actuator in children(self.root, "actuator").flat_map(elements) {
            let named = ["joint", "jointinparent"].map(|key| actuator.attribute(key));
            if !named.contains(&Some(joint)) {
                continue;
            }
            let number = |key: &str, other: f64| -> Result<f64, Refused> {
                let all = self.numbers(actuator, ACTUATORS, key)?;
                Ok(all.and_then(|all| all.first().copied()).unwrap_or(other))
            };
            let square = number("gear", 1.0)?.powi(2);
            let feedback = self.law(actuator)?.0.acting_bias()[2];
            sums[0] += square * number("armature", 0.0)?;
            sums[1] += square * (number("damping", 0.0)? - feedback.min(0.0));
        }
        Ok(sums)
    }

    /// Writes the law of an actuator, as a `general` one with all its numbers.
    fn write_law(&mut self, actuator: Element<'x>, law: &Law, class: &Law) -> Result<(), Refused> {
        let (before, _) = self.law(actuator)?;
        let converted = self.kind(actuator) != "general";
        if converted {
            self.write_inherited_range(actuator)?;
            for key in OF_SHORTCUTS {
                self.remove(actuator, key)?;
            }
            self.rename(actuator, "general")?;
        }
        for (key, word, of_class, was, neutral) in [
            (
                "dyntype",
                &law.dyntype,
                &class.dyntype,
                &before.dyntype,
                "none",
            ),
            (
                "gaintype",
                &law.gaintype,
                &class.gaintype,
                &before.gaintype,
                "fixed",
            ),
            (
                "biastype",
                &law.biastype,
                &class.biastype,
                &before.biastype,
                "none",
            ),
        ] {
            let changes = converted || word != was;
            if changes && (word != neutral || of_class != neutral) {
                self.set(actuator, key, word.clone())?;
            }
        }
        let affine = law.biastype != "none";
        let filtered = law.dyntype != "none";
        for (key, list, of_class, was, acts) in [
            (
                "dynprm",
                &law.dynamics,
                &class.dynamics,
                &before.dynamics,
                filtered,
            ),
            ("gainprm", &law.gain, &class.gain, &before.gain, true),
            ("biasprm", &law.bias, &class.bias, &before.bias, affine),
        ] {
            if acts && (converted || numbers(list) != numbers(was)) {
                // Numbers that are not written are those of the class.
                let differs = |k: &usize| !same(list[*k], of_class[*k]) || list[*k] != 0.0;
                let written = self.own(actuator, key);
                let written = written.map_or(0, |own| own.split_ascii_whitespace().count());
                let count = (0..list.len()).rfind(differs).map_or(1, |k| k + 1);
                let least = if key == "biasprm" { AFFINE } else { 1 };
                let count = count.max(written).clamp(least, list.len());
                self.set(actuator, key, numbers(&list[..count]))?;
            }
        }
        Ok(())
    }

    /// Writes out the range of the command that a position servo has from its joint.
    fn write_inherited_range(&mut self, actuator: Element<'x>) -> Result<(), Refused> {
        let given = self.numbers(actuator, ACTUATORS, "inheritrange")?;
        let Some(share) = given.and_then(|all| all.first().copied()) else {
            return Ok(());
        };
        let joint = actuator.attribute("joint").unwrap_or_default();
        let (joint, _) = self.joint_with_axis(joint)?;
        let Some([from, to]) = joint.range.filter(|_| share > 0.0) else {
            return Ok(());
        };
        let (middle, half) = (0.5 * (from + to), 0.5 * share * (to - from));
        self.set(
            actuator,
            "ctrlrange",
            numbers(&[middle - half, middle + half]),
        )
    }
}

/// The name of an actuator, or its kind and transmission.
fn called(actuator: Element<'_>) -> String {
    let kind = actuator.tag_name().name();
    let drives = ["joint", "jointinparent", "tendon"];
    let drives = drives.iter().find_map(|key| actuator.attribute(*key));
    let unnamed = || format!("{kind}_{}", drives.unwrap_or_default());
    actuator
        .attribute("name")
        .map_or_else(unnamed, str::to_owned)
}
