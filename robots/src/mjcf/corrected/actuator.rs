//! Gains, biases, lags, delays and limits of actuators.

use appell_spec::Code;

use crate::model::Drive;
use crate::xml::{Element, Findings, children, elements, no_such, tag};

use super::super::law::Law;
use super::super::schema::ACTUATORS;
use super::bytes::{number, numbers, same};
use super::change::{Amount, Refused, refused};
use super::sheet::{Sheet, read};

/// Attributes of shortcuts that `general` does not have.
const OF_SHORTCUTS: &str = "kp kv dampratio timeconst inheritrange area diameter bias input";
/// Numbers of an affine bias: constant, factor of the length, factor of the rate.
const AFFINE: usize = 3;
/// How far a delay may be rounded to whole steps, relative to it.
const ROUNDED: f64 = 0.02;

impl<'x> Sheet<'x, '_> {
    /// The element of an actuator.
    fn actuator(&self, name: &str) -> Result<Element<'x>, Refused> {
        let all = || children(self.root, "actuator").flat_map(elements);
        let read = |one: &Element<'x>| self.drive(*one).is_some_and(|drive| drive.name == name);
        let found = all()
            .find(read)
            .or_else(|| all().find(|one| called(*one) == name));
        found.ok_or_else(|| {
            let known: Vec<String> = all().map(called).collect();
            let known = known.iter().map(String::as_str);
            let help = "name an actuator of the file";
            no_such("actuator", name, tag(self.root), known, help)
        })
    }

    /// The law of the class of an actuator, and its own, as the file has them.
    fn laws_in_file(&self, actuator: Element<'x>) -> [Law; 2] {
        let class = Self::class(actuator);
        Law::of(actuator, class, &self.defaults, &Findings::default())
    }

    /// The law of an actuator, as it is to be written.
    fn law(&self, actuator: Element<'x>) -> Law {
        let changed = self.laws.iter().find(|(own, _)| *own == actuator);
        if let Some((_, law)) = changed {
            return law.clone();
        }
        let [_, law] = self.laws_in_file(actuator);
        law
    }

    /// Changes the law of an actuator.
    fn keep(&mut self, actuator: Element<'x>, law: Law) {
        match self.laws.iter_mut().find(|(own, _)| *own == actuator) {
            Some((_, own)) => *own = law,
            None => self.laws.push((actuator, law)),
        }
    }

    /// An actuator and its law; refuses those with another law than gain and affine bias.
    fn affine(&self, name: &str) -> Result<(Element<'x>, Law), Refused> {
        let actuator = self.actuator(name)?;
        let mut law = self.law(actuator);
        if law.has_damping_ratio() {
            law.bias[2] = -self.damping(actuator, name)?;
        }
        if law.is_affine() {
            return Ok((actuator, law));
        }
        let kind = actuator.tag_name().name();
        let message = format!("`{kind}` `{name}` has no constant gain");
        let help = "only actuators with a fixed gain and an affine bias are changed";
        Err(refused(Code::NotAllowedHere, tag(actuator), message, help))
    }

    fn no_such_gain(actuator: Element<'x>, name: &str, gain: &str) -> Refused {
        let kind = actuator.tag_name().name();
        let message = format!("`{kind}` `{name}` has no `{gain}`");
        let help = "it is a number of `position`, `velocity`, and `general` with an affine bias";
        refused(Code::NotAllowedHere, tag(actuator), message, help)
    }

    /// An actuator as it is read.
    fn drive(&self, actuator: Element<'x>) -> Option<&Drive> {
        let mut drives = self.robot.drives.iter().flatten();
        drives.find(|drive| drive.place == tag(actuator))
    }

    /// The damping of a servo that `MuJoCo` computes from its damping ratio and the inertias of the file.
    fn damping(&self, actuator: Element<'x>, name: &str) -> Result<f64, Refused> {
        let drive = self.drive(actuator).filter(|drive| drive.bias[2] <= 0.0);
        drive.map(|drive| -drive.bias[2]).ok_or_else(|| {
            let message = format!("the damping of `{name}` is not known");
            let help = "write the `kv` that MuJoCo computes from `dampratio`";
            refused(Code::NotAllowedHere, tag(actuator), message, help)
        })
    }

    /// Writes out the damping of servos that have a damping ratio.
    pub(super) fn write_damping_ratios(&mut self) -> Result<(), Refused> {
        let all = children(self.root, "actuator").flat_map(elements);
        for actuator in all.collect::<Vec<Element<'x>>>() {
            if self.law(actuator).has_damping_ratio() {
                let (_, law) = self.affine(&called(actuator))?;
                self.keep(actuator, law);
            }
        }
        Ok(())
    }

    pub(super) fn kp(&mut self, name: &str, amount: Amount) -> Result<(), Refused> {
        let (actuator, mut law) = self.affine(name)?;
        let before = law.gain[0];
        let after = amount.of(before);
        if same(after, before) {
            return Ok(());
        }
        match actuator.tag_name().name() {
            "position" | "intvelocity" => {}
            "general" if law.acting_bias()[1] != 0.0 => {}
            _ => return Err(Self::no_such_gain(actuator, name, "kp")),
        }
        law.bias[1] = if same(law.bias[1], -before) {
            -after
        } else {
            law.bias[1] * after / before
        };
        law.gain[0] = after;
        self.keep(actuator, law);
        Ok(())
    }

    pub(super) fn kv(&mut self, name: &str, amount: Amount) -> Result<(), Refused> {
        let (actuator, mut law) = self.affine(name)?;
        let kind = actuator.tag_name().name();
        let before = match kind {
            "position" | "intvelocity" | "velocity" | "general" => -law.acting_bias()[2],
            "damper" => -law.gain[2],
            _ => return Err(Self::no_such_gain(actuator, name, "kv")),
        };
        let after = self.at_least_zero(name, "kv", amount.of(before));
        if same(after, before) {
            return Ok(());
        }
        if kind == "damper" {
            law.gain[2] = -after;
        } else {
            law.bias = law.acting_bias();
            "affine".clone_into(&mut law.bias_type);
            let is_servo = law.bias[1] == 0.0 && law.bias[2] != 0.0;
            if is_servo && same(law.bias[2], -law.gain[0]) {
                law.gain[0] = after;
            }
            law.bias[2] = -after;
        }
        self.keep(actuator, law);
        Ok(())
    }

    pub(super) fn gear(&mut self, name: &str, amount: Amount) -> Result<(), Refused> {
        let actuator = self.actuator(name)?;
        let before = self.first(actuator, ACTUATORS, "gear")?.unwrap_or(1.0);
        let after = amount.of(before);
        if same(after, before) {
            return Ok(());
        }
        if before == 0.0 {
            return self.set(actuator, "gear", number(after));
        }
        self.gear_times(actuator, after / before)
    }

    /// Multiplies the gear of an actuator; its inertia and damping, which act with the square of the gear, stay.
    fn gear_times(&mut self, actuator: Element<'x>, factor: f64) -> Result<(), Refused> {
        let gear = self.numbers(actuator, ACTUATORS, "gear")?;
        let gear = gear.unwrap_or_else(|| vec![1.0]);
        self.set(actuator, "gear", numbers(&scaled(gear, factor)))?;
        for key in ["armature", "damping"] {
            if let Some(all) = self.numbers(actuator, ACTUATORS, key)? {
                let all = scaled(all, 1.0 / (factor * factor));
                self.set(actuator, key, numbers(&all))?;
            }
        }
        Ok(())
    }

    pub(super) fn gain(&mut self, name: &str, factor: f64) -> Result<(), Refused> {
        if same(factor, 1.0) {
            return Ok(());
        }
        let (actuator, mut law) = self.affine(name)?;
        if actuator.has_tag_name("motor") {
            return self.gear_times(actuator, factor);
        }
        if let Some(range) = self.numbers(actuator, ACTUATORS, "forcerange")? {
            self.set(actuator, "forcerange", numbers(&scaled(range, factor)))?;
        }
        law.gain = law.gain.map(|one| one * factor);
        law.bias = law.bias.map(|one| one * factor);
        self.keep(actuator, law);
        Ok(())
    }

    pub(super) fn bias(&mut self, name: &str, add: f64) -> Result<(), Refused> {
        if add == 0.0 {
            return Ok(());
        }
        let (actuator, mut law) = self.affine(name)?;
        law.bias = law.acting_bias();
        law.bias[0] += add;
        "affine".clone_into(&mut law.bias_type);
        self.keep(actuator, law);
        Ok(())
    }

    pub(super) fn lag(&mut self, name: &str, amount: Amount) -> Result<(), Refused> {
        let (actuator, mut law) = self.affine(name)?;
        let seconds = self.at_least_zero(name, "time constant", amount.of(law.lag()));
        let filter = law.filter_type.as_str();
        if !["none", "filter", "filterexact"].contains(&filter) {
            let message = format!("actuator `{name}` has the dynamics `{filter}`");
            let help = "a lag is written where an actuator has no dynamics or a filter";
            return Err(refused(Code::NotAllowedHere, tag(actuator), message, help));
        }
        if same(seconds, law.lag()) {
            return Ok(());
        }
        let filter = match filter {
            _ if seconds == 0.0 => "none",
            "filter" => "filter",
            _ => "filterexact",
        }
        .to_owned();
        law.filter_type = filter;
        law.time = seconds;
        self.keep(actuator, law);
        Ok(())
    }

    pub(super) fn delay(&mut self, name: &str, amount: Amount) -> Result<(), Refused> {
        let actuator = self.actuator(name)?;
        let before = self.first(actuator, ACTUATORS, "delay")?.unwrap_or(0.0);
        let seconds = self.at_least_zero(name, "delay", amount.of(before));
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
        let given = self.first(actuator, ACTUATORS, "nsample")?;
        let enough = given.is_some_and(|given| given >= samples);
        if !enough {
            self.set(actuator, "nsample", number(samples))?;
        }
        if !is_near && self.given(actuator, ACTUATORS, "interp").is_none() {
            self.set(actuator, "interp", "linear")?;
        }
        Ok(())
    }

    /// Bounds of the force of an actuator, before its gear, where they hold.
    fn force_range(&self, actuator: Element<'x>) -> Result<Option<[f64; 2]>, Refused> {
        let given = self.numbers(actuator, ACTUATORS, "forcerange")?;
        let range = given.and_then(|all| <[f64; 2]>::try_from(all).ok());
        let limited = self.given(actuator, ACTUATORS, "forcelimited");
        Ok(range.filter(|[from, to]| match limited.as_deref() {
            Some("true") => true,
            Some("false") => false,
            _ => self.compiler.autolimits && from < to,
        }))
    }

    fn set_force_range(&mut self, name: &str, range: [f64; 2]) -> Result<(), Refused> {
        let (actuator, _) = self.affine(name)?;
        self.set(actuator, "forcerange", numbers(&range))?;
        let is_on = match self.given(actuator, ACTUATORS, "forcelimited").as_deref() {
            Some(word) if word != "auto" => word == "true",
            _ => self.compiler.autolimits,
        };
        if is_on {
            return Ok(());
        }
        self.set(actuator, "forcelimited", "true")
    }

    /// Changes the bounds of a force; those of another size on either side by a common factor.
    pub(super) fn force_range_by(&mut self, name: &str, amount: Amount) -> Result<(), Refused> {
        let actuator = self.actuator(name)?;
        let before = self.force_range(actuator)?;
        let [from, to] = before.unwrap_or_default();
        let after = if let Amount::Times(factor) = amount {
            [from * factor, to * factor]
        } else {
            let limit = self.at_least_zero(name, "limit", amount.of(to));
            [-limit, limit]
        };
        match before {
            Some(before) if numbers(&before) == numbers(&after) => Ok(()),
            _ => self.set_force_range(name, after),
        }
    }

    pub(super) fn force_limit(
        &mut self,
        name: &str,
        [least, most]: [f64; 2],
    ) -> Result<(), Refused> {
        let actuator = self.actuator(name)?;
        let Some(before) = self.force_range(actuator)? else {
            return self.set_force_range(name, [least, most]);
        };
        let after = before.map(|end| end.clamp(least, most.max(least)));
        if numbers(&before) == numbers(&after) {
            return Ok(());
        }
        self.set_force_range(name, after)
    }

    /// The actuators with their activations: before the changes, and after them.
    pub(super) fn activations(&self) -> Vec<[bool; 2]> {
        let all = children(self.root, "actuator").flat_map(elements);
        let both = all.map(|actuator| {
            let [_, before] = self.laws_in_file(actuator);
            [before, self.law(actuator)].map(|law| law.filter_type != "none")
        });
        both.collect()
    }

    /// The actuators of a joint, each with its gear.
    fn drives_of(&self, joint: &str) -> Result<Vec<(Element<'x>, f64)>, Refused> {
        let all = children(self.root, "actuator").flat_map(elements);
        let own = all.filter(|actuator| {
            let named = ["joint", "jointinparent"].map(|key| actuator.attribute(key));
            named.contains(&Some(joint))
        });
        own.map(|actuator| {
            Ok((
                actuator,
                self.first(actuator, ACTUATORS, "gear")?.unwrap_or(1.0),
            ))
        })
        .collect()
    }

    /// What actuators of a joint add to its armature or damping by attributes of this name.
    pub(super) fn carried(&self, joint: &str, key: &str) -> Result<f64, Refused> {
        let mut sum = 0.0;
        for (actuator, gear) in self.drives_of(joint)? {
            sum += gear * gear * self.first(actuator, ACTUATORS, key)?.unwrap_or_default();
        }
        Ok(sum)
    }

    /// Multiplies what actuators of a joint add to its armature or damping.
    pub(super) fn scale_carried(
        &mut self,
        joint: &str,
        key: &'static str,
        factor: f64,
    ) -> Result<(), Refused> {
        for (actuator, _) in self.drives_of(joint)? {
            if let Some(all) = self.numbers(actuator, ACTUATORS, key)? {
                self.set(actuator, key, numbers(&scaled(all, factor)))?;
            }
        }
        Ok(())
    }

    /// The damping of a joint by the laws of its actuators.
    pub(super) fn feedback(&self, joint: &str) -> Result<f64, Refused> {
        let all = self.drives_of(joint)?.into_iter();
        let damping =
            all.map(|(actuator, gear)| -gear * gear * self.law(actuator).acting_bias()[2].min(0.0));
        Ok(damping.sum())
    }

    /// Writes the laws of actuators: in the words of their elements, or as a `general` one.
    pub(super) fn write_laws(&mut self) -> Result<(), Refused> {
        for (actuator, law) in self.laws.clone() {
            let [class, before] = self.laws_in_file(actuator);
            let is_unfiltered = law.filter_type == "none";
            match actuator.tag_name().name() {
                "position" | "intvelocity"
                    if same(law.bias[1], -law.gain[0])
                        && law.bias[0] == 0.0
                        && law.filter_type != "filter" =>
                {
                    if !same(law.gain[0], before.gain[0]) {
                        self.set(actuator, "kp", number(law.gain[0]))?;
                    }
                    if !same(law.bias[2], before.bias[2]) {
                        self.remove(actuator, "dampratio")?;
                        self.set(actuator, "kv", number(-law.bias[2]))?;
                    }
                    if !same(law.lag(), before.lag()) {
                        self.set(actuator, "timeconst", number(law.lag()))?;
                    }
                }
                "velocity"
                    if is_unfiltered
                        && numbers(&law.bias) == numbers(&[0.0, 0.0, -law.gain[0]]) =>
                {
                    self.set(actuator, "kv", number(law.gain[0]))?;
                }
                "damper" if is_unfiltered && numbers(&law.acting_bias()) == numbers(&[0.0; 3]) => {
                    self.set(actuator, "kv", number(-law.gain[2]))?;
                }
                "cylinder"
                    if !is_unfiltered
                        && numbers(&law.gain) == numbers(&before.gain)
                        && numbers(&law.bias) == numbers(&before.bias) =>
                {
                    self.set(actuator, "timeconst", number(law.time))?;
                }
                _ => self.write_general(actuator, &law, &class, &before)?,
            }
        }
        Ok(())
    }

    /// Writes the law of an actuator as a `general` one with all its numbers.
    fn write_general(
        &mut self,
        actuator: Element<'x>,
        law: &Law,
        class: &Law,
        before: &Law,
    ) -> Result<(), Refused> {
        let converted = !actuator.has_tag_name("general");
        if converted {
            self.write_inherited_range(actuator)?;
            for key in OF_SHORTCUTS.split_ascii_whitespace() {
                self.remove(actuator, key)?;
            }
            self.rename(actuator, "general")?;
        }
        let types = [
            ("dyntype", "none"),
            ("gaintype", "fixed"),
            ("biastype", "none"),
        ];
        for (key, neutral) in types {
            let [word, of_class, was] = [law, class, before].map(|law| match key {
                "dyntype" => &law.filter_type,
                "gaintype" => &law.gain_type,
                _ => &law.bias_type,
            });
            let changes = converted || word != was;
            if changes && (word != neutral || of_class != neutral) {
                self.set(actuator, key, word.as_str())?;
            }
        }
        let [filtered, affine] = [&law.filter_type, &law.bias_type].map(|word| word != "none");
        let lists = [
            ("dynprm", 1, filtered),
            ("gainprm", 1, true),
            ("biasprm", AFFINE, affine),
        ];
        for (key, least, acts) in lists {
            let [list, of_class, was] = [law, class, before].map(|law| match key {
                "dynprm" => vec![law.time],
                "gainprm" => law.gain.to_vec(),
                _ => law.bias.to_vec(),
            });
            if !acts || !converted && numbers(&list) == numbers(&was) {
                continue;
            }
            // Numbers that are not written are those of the class.
            let differs = |k: &usize| !same(list[*k], of_class[*k]) || list[*k] != 0.0;
            let given = self.own(actuator, key);
            let given = given.map(|given| read(&given, actuator, key)).transpose()?;
            let given = given.unwrap_or_default();
            let count = (0..list.len()).rfind(differs).map_or(1, |k| k + 1);
            let count = count.max(given.len()).clamp(least, list.len());
            let written: Vec<f64> = list[..count]
                .iter()
                .chain(given.iter().skip(count))
                .copied()
                .collect();
            self.set(actuator, key, numbers(&written))?;
        }
        Ok(())
    }

    /// Writes out the ranges of commands that servos have from a joint.
    pub(super) fn write_inherited_ranges(&mut self, joint: &str) -> Result<(), Refused> {
        for (actuator, _) in self.drives_of(joint)? {
            if self.own(actuator, "inheritrange").is_some() {
                self.write_inherited_range(actuator)?;
                self.remove(actuator, "inheritrange")?;
            }
        }
        Ok(())
    }

    /// Writes out the range of the command that a servo has from its joint or tendon.
    fn write_inherited_range(&mut self, actuator: Element<'x>) -> Result<(), Refused> {
        let given = self.numbers(actuator, ACTUATORS, "inheritrange")?;
        let inherits = given.is_some_and(|all| all.iter().any(|share| *share > 0.0));
        let range = self.drive(actuator).and_then(|drive| drive.ctrl_range);
        match range.filter(|_| inherits) {
            Some(range) => self.set(actuator, "ctrlrange", numbers(&range)),
            None => Ok(()),
        }
    }
}

/// Numbers times a factor.
fn scaled(all: Vec<f64>, factor: f64) -> Vec<f64> {
    all.into_iter().map(|one| one * factor).collect()
}

/// The name of an actuator, or its kind and transmission.
fn called(actuator: Element<'_>) -> String {
    let kind = actuator.tag_name().name();
    let drives = ["joint", "jointinparent", "tendon"];
    let drives = drives.iter().find_map(|key| actuator.attribute(*key));
    let unnamed = || format!("{kind}_{}", drives.unwrap_or_default());
    let name = actuator.attribute("name");
    name.map_or_else(unnamed, str::to_owned)
}
