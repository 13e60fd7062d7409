//! The law of an actuator, as its element and the defaults of its class define it.

use crate::model::is;
use crate::xml::{Element, Findings, number, numbers};

use super::defaults::Defaults;
use super::schema::ACTUATORS;

/// What makes a `dcmotor` another one than a gain and a back-EMF, and the words with which it does not.
const NO_MERE_MOTOR: &str = "cogging controller inductance input lugre thermal";

/// Force = gain · command + bias; of either a constant, a factor of the length, and one of its rate.
#[derive(Debug, Clone)]
pub(super) struct Law {
    pub(super) gain_type: String,
    pub(super) gain: [f64; 3],
    pub(super) bias_type: String,
    pub(super) bias: [f64; 3],
    pub(super) filter_type: String,
    /// Time constant of the filter.
    pub(super) time: f64,
    /// Whether commands are bounded whatever `ctrllimited` says.
    pub(super) bounded: bool,
    /// The motor of `dcmotor`.
    pub(super) motor: Motor,
    /// An element whose law is of another kind.
    other: bool,
}

/// A direct-current motor.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Motor {
    resistance: f64,
    /// Constants of torque and of back-EMF.
    constants: [f64; 3],
    /// Voltage, stall torque and speed without load.
    nominal: [f64; 3],
    /// Bounds of torque and of current.
    saturation: [f64; 3],
}

impl Motor {
    /// Its constant and its resistance.
    fn constants(&self) -> (f64, f64) {
        let [torque, back, _] = self.constants;
        let [voltage, stall, speed] = self.nominal;
        let constant = match (torque > 0.0, back > 0.0) {
            (true, true) => (torque * back).sqrt(),
            (false, false) => voltage / speed,
            _ => torque.max(back),
        };
        if self.resistance > 0.0 {
            (constant, self.resistance)
        } else {
            (constant, constant * voltage / stall)
        }
    }

    /// The largest torque, if it is bounded.
    pub(super) fn bound(&self) -> Option<f64> {
        let [torque, current, _] = self.saturation;
        let bound = if torque > 0.0 {
            torque
        } else {
            current * self.constants().0
        };
        (bound > 0.0).then_some(bound)
    }
}

impl Law {
    fn new() -> Self {
        Self {
            gain_type: "fixed".to_owned(),
            gain: [1.0, 0.0, 0.0],
            bias_type: "none".to_owned(),
            bias: [0.0; 3],
            filter_type: "none".to_owned(),
            time: 1.0,
            bounded: false,
            motor: Motor::default(),
            other: false,
        }
    }

    /// The law that the class of an actuator defines, and its own.
    pub(super) fn of<'x>(
        element: Element<'x>,
        class: Option<&str>,
        defaults: &Defaults<'x>,
        findings: &Findings,
    ) -> [Self; 2] {
        let mut of_class = Self::new();
        for one in defaults.chain(ACTUATORS, class) {
            of_class.apply(one, findings);
        }
        let mut own = of_class.clone();
        own.apply(element, findings);
        [of_class, own]
    }

    /// Sets the types of gain, bias and filter.
    fn types(&mut self, gain: &str, bias: &str, filter: &str) {
        gain.clone_into(&mut self.gain_type);
        bias.clone_into(&mut self.bias_type);
        filter.clone_into(&mut self.filter_type);
    }

    /// Applies an element, as the functions `mjs_setTo…` of `MuJoCo` do.
    fn apply(&mut self, element: Element<'_>, findings: &Findings) {
        let number = |key: &str| number(findings, element, key);
        let some = |key: &str, into: &mut [f64; 3]| {
            let given = element.attribute_node(key);
            let read = given.and_then(|given| numbers(findings, &given));
            for (own, read) in into.iter_mut().zip(read.into_iter().flatten()) {
                *own = read;
            }
        };
        self.other = false;
        let kind = element.tag_name().name();
        match kind {
            "general" => {
                some("gainprm", &mut self.gain);
                some("biasprm", &mut self.bias);
                let mut filter = [self.time, 0.0, 0.0];
                some("dynprm", &mut filter);
                self.time = filter[0];
                for (key, own) in [
                    ("gaintype", &mut self.gain_type),
                    ("biastype", &mut self.bias_type),
                    ("dyntype", &mut self.filter_type),
                ] {
                    if let Some(word) = element.attribute(key) {
                        word.clone_into(own);
                    }
                }
            }
            "motor" => {
                self.gain[0] = 1.0;
                self.types("fixed", "none", "none");
            }
            "position" | "intvelocity" => {
                self.gain[0] = number("kp").unwrap_or(self.gain[0]);
                self.bias[..2].copy_from_slice(&[0.0, -self.gain[0]]);
                // A positive factor of the rate is a damping ratio.
                let kv = number("kv").map(|kv| -kv);
                self.bias[2] = number("dampratio").or(kv).unwrap_or(self.bias[2]);
                let time = number("timeconst");
                self.time = time.unwrap_or(self.time);
                let filtered = time.map_or(self.filter_type == "filterexact", |time| time > 0.0);
                let filter = match (kind, filtered) {
                    ("intvelocity", _) => "integrator",
                    (_, true) => "filterexact",
                    _ => "none",
                };
                self.types("fixed", "affine", filter);
            }
            "velocity" => {
                self.gain[0] = number("kv").unwrap_or(self.gain[0]);
                self.bias = [0.0, 0.0, -self.gain[0]];
                self.types("fixed", "affine", "none");
            }
            "damper" => {
                let inherited = match self.gain_type.as_str() {
                    "affine" => -self.gain[2],
                    _ => 0.0,
                };
                self.gain = [0.0, 0.0, -number("kv").unwrap_or(inherited)];
                self.bounded = true;
                self.types("affine", "none", "none");
            }
            "cylinder" => {
                self.time = number("timeconst").unwrap_or(self.time);
                some("bias", &mut self.bias);
                self.gain[0] = number("area").unwrap_or(self.gain[0]);
                if let Some(diameter) = number("diameter").filter(|one| *one >= 0.0) {
                    self.gain[0] = std::f64::consts::FRAC_PI_4 * diameter * diameter;
                }
                self.types("fixed", "affine", "filter");
            }
            "dcmotor" => {
                self.motor.resistance = number("resistance").unwrap_or(self.motor.resistance);
                some("motorconst", &mut self.motor.constants);
                some("nominal", &mut self.motor.nominal);
                some("saturation", &mut self.motor.saturation);
                let acts = |key: &str| {
                    let given = element.attribute(key).unwrap_or_default();
                    let mut words = given.split_ascii_whitespace();
                    words.any(|word| word != "voltage" && word.parse() != Ok(0.0))
                };
                self.other = NO_MERE_MOTOR.split_ascii_whitespace().any(acts);
                self.types("dcmotor", "none", "none");
            }
            _ => {
                self.other = true;
                if kind == "muscle" {
                    self.types(kind, kind, kind);
                }
            }
        }
    }

    /// Gain and bias with the terms that act; `None` for another law.
    pub(super) fn affine(&self) -> Option<([f64; 3], [f64; 3])> {
        let gain = match self.gain_type.as_str() {
            "dcmotor" if !self.other => {
                let (constant, resistance) = self.motor.constants();
                let gain = constant / resistance;
                let law = ([gain, 0.0, 0.0], [0.0, 0.0, -gain * constant]);
                return (gain.is_finite() && gain > 0.0).then_some(law);
            }
            "fixed" => [self.gain[0], 0.0, 0.0],
            _ => self.gain,
        };
        let filtered = ["none", "filter", "filterexact"].contains(&self.filter_type.as_str());
        (filtered && self.is_affine()).then_some((gain, self.acting_bias()))
    }

    /// Whether it is a constant or affine gain with a constant or affine bias.
    pub(super) fn is_affine(&self) -> bool {
        let gains = ["fixed", "affine"].contains(&self.gain_type.as_str());
        gains && ["none", "affine"].contains(&self.bias_type.as_str()) && !self.other
    }

    /// Whether a positive factor of the rate stands for a damping ratio.
    pub(super) fn has_damping_ratio(&self) -> bool {
        let is_servo = self.bias_type == "affine" && is(self.bias[1], -self.gain[0]);
        self.gain_type == "fixed" && is_servo && self.bias[2] > 0.0
    }

    /// The bias that acts.
    pub(super) fn acting_bias(&self) -> [f64; 3] {
        match self.bias_type.as_str() {
            "none" => [0.0; 3],
            _ => self.bias,
        }
    }

    pub(super) fn lag(&self) -> f64 {
        match self.filter_type.as_str() {
            "none" => 0.0,
            _ => self.time,
        }
    }
}
