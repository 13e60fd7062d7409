//! The law of an actuator: its numbers as classes, shortcuts and its own attributes define them.

use crate::xml::Element;

use super::change::Refused;
use super::sheet::read;

/// Numbers of each list.
const NUMBERS: usize = 10;

/// Force = gain · activation + bias, as an actuator of type `general` has it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Law {
    pub(super) gaintype: String,
    pub(super) biastype: String,
    pub(super) dyntype: String,
    pub(super) gain: [f64; NUMBERS],
    pub(super) bias: [f64; NUMBERS],
    pub(super) dynamics: [f64; NUMBERS],
}

impl Default for Law {
    fn default() -> Self {
        let mut one = [0.0; NUMBERS];
        one[0] = 1.0;
        Self {
            gaintype: "fixed".to_owned(),
            biastype: "none".to_owned(),
            dyntype: "none".to_owned(),
            gain: one,
            bias: [0.0; NUMBERS],
            dynamics: one,
        }
    }
}

/// Replaces the first numbers of a list.
fn overwrite(list: &mut [f64; NUMBERS], by: &[f64]) {
    for (own, new) in list.iter_mut().zip(by) {
        *own = *new;
    }
}

impl Law {
    /// Adds the attributes of an element, which `own` reads.
    pub(super) fn add(
        &mut self,
        element: Element<'_>,
        kind: &str,
        own: &dyn Fn(&str) -> Option<String>,
    ) -> Result<(), Refused> {
        let numbers = |key: &str| -> Result<Option<Vec<f64>>, Refused> {
            own(key).map(|given| read(&given, element, key)).transpose()
        };
        let first = |key: &str| -> Result<Option<f64>, Refused> {
            Ok(numbers(key)?.and_then(|all| all.first().copied()))
        };
        match kind {
            "general" => {
                for (key, list) in [
                    ("gainprm", &mut self.gain),
                    ("biasprm", &mut self.bias),
                    ("dynprm", &mut self.dynamics),
                ] {
                    overwrite(list, &numbers(key)?.unwrap_or_default());
                }
                for (key, word) in [
                    ("gaintype", &mut self.gaintype),
                    ("biastype", &mut self.biastype),
                    ("dyntype", &mut self.dyntype),
                ] {
                    if let Some(given) = own(key) {
                        *word = given;
                    }
                }
            }
            "motor" => {
                self.gain[0] = 1.0;
                self.types("none", "fixed", "none");
            }
            "position" | "intvelocity" => {
                let kp = first("kp")?.unwrap_or(self.gain[0]);
                (self.gain[0], self.bias[1]) = (kp, -kp);
                if let Some(kv) = first("kv")? {
                    self.bias[2] = -kv;
                }
                if let Some(ratio) = first("dampratio")? {
                    self.bias[2] = ratio;
                }
                let time = first("timeconst")?;
                self.dynamics[0] = time.unwrap_or(self.dynamics[0]);
                let dynamics = match time {
                    _ if kind == "intvelocity" => "integrator".to_owned(),
                    None => self.dyntype.clone(),
                    Some(0.0) => "none".to_owned(),
                    Some(_) => "filterexact".to_owned(),
                };
                self.types(&dynamics, "fixed", "affine");
            }
            "velocity" => {
                let kv = first("kv")?.unwrap_or(self.gain[0]);
                self.bias = [0.0; NUMBERS];
                (self.gain[0], self.bias[2]) = (kv, -kv);
                self.types("none", "fixed", "affine");
            }
            "damper" => {
                let inherited = if self.gaintype == "affine" {
                    -self.gain[2]
                } else {
                    0.0
                };
                let kv = first("kv")?.unwrap_or(inherited);
                self.gain = [0.0; NUMBERS];
                self.gain[2] = -kv;
                self.types("none", "affine", "none");
            }
            "cylinder" => {
                overwrite(&mut self.bias, &numbers("bias")?.unwrap_or_default());
                self.dynamics[0] = first("timeconst")?.unwrap_or(self.dynamics[0]);
                self.gain[0] = first("area")?.unwrap_or(self.gain[0]);
                if let Some(width) = first("diameter")?.filter(|width| *width >= 0.0) {
                    self.gain[0] = std::f64::consts::PI / 4.0 * width * width;
                }
                self.types("filter", "fixed", "affine");
            }
            other => self.types(other, other, other),
        }
        Ok(())
    }

    fn types(&mut self, dynamics: &str, gain: &str, bias: &str) {
        dynamics.clone_into(&mut self.dyntype);
        gain.clone_into(&mut self.gaintype);
        bias.clone_into(&mut self.biastype);
    }

    /// Whether it is a constant gain with a constant or affine bias.
    pub(super) fn is_affine(&self) -> bool {
        let gains = ["fixed", "affine"].contains(&self.gaintype.as_str());
        gains && ["none", "affine"].contains(&self.biastype.as_str())
    }

    /// Whether a positive factor of the rate stands for a damping ratio.
    pub(super) fn has_damping_ratio(&self) -> bool {
        let is_servo = self.biastype == "affine" && super::bytes::same(self.gain[0], -self.bias[1]);
        self.gaintype == "fixed" && is_servo && self.bias[2] > 0.0
    }

    /// The bias that acts.
    pub(super) fn acting_bias(&self) -> [f64; NUMBERS] {
        if self.biastype == "none" {
            [0.0; NUMBERS]
        } else {
            self.bias
        }
    }
}
