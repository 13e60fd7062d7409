//! Gravity, and options of the solver.

use appell_spec::Code;

use crate::rotation::Vector;
use crate::xml::{Element, children, tag};

use super::bytes::numbers;
use super::change::{Refused, refused};
use super::sheet::Sheet;

use super::super::GRAVITY;
use super::super::schema::disabled;

/// Default step of `MuJoCo`, in s.
const TIMESTEP: f64 = 0.002;

impl<'x> Sheet<'x, '_> {
    /// The last `<option>` with an attribute, or the last one at all.
    fn option(&self, key: &str) -> Option<Element<'x>> {
        let all = || children(self.root, "option");
        let with = all().filter(|option| option.has_attribute(key)).last();
        with.or_else(|| all().last())
    }

    /// The step of the simulation.
    pub(super) fn timestep(&self) -> Result<f64, Refused> {
        let step = self.option("timestep");
        let step = step.map(|option| self.first(option, "", "timestep"));
        let step = step.transpose()?.flatten();
        Ok(step.filter(|step| *step > 0.0).unwrap_or(TIMESTEP))
    }

    pub(super) fn gravity(&mut self, gravity: Vector) -> Result<(), Refused> {
        if disabled(self.root, "gravity") {
            let message = "gravity is disabled by a `flag`";
            let help = "remove `gravity=\"disable\"`";
            return Err(refused(Code::NotAllowedHere, tag(self.root), message, help));
        }
        let option = self.option("gravity");
        let given = option.map(|option| self.numbers(option, "", "gravity"));
        let before = given.transpose()?.flatten();
        let before = before.unwrap_or_else(|| GRAVITY.to_vec());
        if before == gravity {
            return Ok(());
        }
        let words = numbers(&gravity);
        if let Some(option) = option.filter(|option| self.is_in_file(*option)) {
            return self.set(option, "gravity", words);
        }
        self.said.push(format!("option: gravity {words}"));
        let text = format!("<option gravity=\"{words}\"/>");
        if option.is_some() {
            // Later elements add to those of an included file.
            return self.insert_into(self.root, &text, false);
        }
        let compiler = children(self.root, "compiler").next();
        match compiler.filter(|compiler| self.is_in_file(*compiler)) {
            Some(compiler) => self.insert_after(compiler, &text),
            None => self.insert_into(self.root, &text, true),
        }
    }
}
