//! A mass behind a gear with play, without friction, from event to event: while a force is held, all motion
//! between two touches is a parabola, and a touch makes one velocity of two.

/// A motor and the joint that it drives, 1 kg together.
pub(crate) struct Gear {
    /// Part of the mass that the motor has.
    share: f64,
    half_gap: f64,
    /// Position and velocity of the joint.
    joint: [f64; 2],
    /// Those of the motor beyond the joint.
    twist: [f64; 2],
    /// The side on which teeth touch.
    touches: Option<f64>,
}

impl Gear {
    /// At rest, in the middle of the gap.
    pub(crate) fn new(share: f64, half_gap: f64) -> Self {
        Self {
            share,
            half_gap,
            joint: [0.0; 2],
            twist: [0.0; 2],
            touches: None,
        }
    }

    /// The position of the motor.
    pub(crate) fn motor(&self) -> f64 {
        self.joint[0] + self.twist[0]
    }

    /// Goes on under a force on the motor; the position of the joint.
    pub(crate) fn advance(&mut self, force: f64, time: f64) -> f64 {
        // Teeth push and never pull.
        self.touches = self.touches.filter(|side| side * force >= 0.0);
        if self.touches.is_some() {
            self.joint = moved(self.joint, force, time);
            return self.joint[0];
        }
        let free = force / self.share;
        let touch = [1.0, -1.0].map(|side| (reached(self.twist, free, side * self.half_gap), side));
        let [right, left] = touch;
        let (after, side) = if right.0 < left.0 { right } else { left };
        self.joint = moved(self.joint, 0.0, after.min(time));
        self.twist = moved(self.twist, free, after.min(time));
        if after >= time {
            return self.joint[0];
        }
        // Momentum is kept, the rest of the motion is lost.
        self.joint[1] += self.share * self.twist[1];
        self.twist = [side * self.half_gap, 0.0];
        self.touches = Some(side);
        self.advance(force, time - after)
    }
}

/// After a time of constant acceleration.
pub(super) fn moved([x, v]: [f64; 2], acceleration: f64, time: f64) -> [f64; 2] {
    let half = 0.5 * time * acceleration;
    [x + time * (v + half), v + 2.0 * half]
}

/// The time after which a parabola comes to a place; infinite if it never does.
fn reached([x, v]: [f64; 2], acceleration: f64, place: f64) -> f64 {
    /// What lies there already is left, not reached.
    const NOW: f64 = 1e-9;
    let roots = if acceleration == 0.0 {
        [(place - x) / v, f64::NAN]
    } else {
        let root = (v * v + 2.0 * acceleration * (place - x)).sqrt();
        [(-v - root) / acceleration, (-v + root) / acceleration]
    };
    let later = roots.into_iter().filter(|time| *time > NOW);
    later.fold(f64::INFINITY, f64::min)
}
