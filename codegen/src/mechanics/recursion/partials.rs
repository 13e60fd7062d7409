//! Derivatives of the forces of a motion with respect to the state, at fixed ω̇.
//!
//! A coordinate or a speed changes the motion of the link that it drives, and that of its descendants, as one
//! rigid body. Their forces respond to changes δω, δα and δa of the link's motion together. With β = δα + ω ×
//! δω, the composite mass m, first moment h and inertia I, their rates ḣ and İ and the angular momentum ℓ about
//! the origin,
//!
//! ```text
//! δf = m δa + β × h + 2 δω × ḣ        δn = h × δa + I β + İ δω − ℓ × δω
//! ```
//!
//! in any axes that do not rotate relative to the link. β is transmitted unchanged to descendants, and δa
//! becomes δa + β × d + 2 δω × u for an origin at d with the relative velocity u.

use super::super::algebra::{Algebra, name_of, named3};
use super::super::rotation::Rotation;
use super::inertia::{Inertia, Wrench, named_tensor, plus, with_products};
use super::links::{Link, Links, Step};
use super::movement::LinkMotion;
use crate::symbolic::vector::{self, Mat3, Vec3, transpose};
use crate::symbolic::{Expr, Graph};

/// Momentum and inertia rates of a link with its descendants, about its origin, in its axes.
#[derive(Debug, Clone)]
struct Flow {
    /// Rate of the first moment, ḣ.
    moment: Vec3,
    /// Rate of the inertia, İ.
    tensor: Mat3,
    /// Angular momentum, ℓ.
    momentum: Vec3,
}

/// A change of the motion of a link.
#[derive(Debug, Clone, Copy)]
struct Change {
    /// δω.
    w: Vec3,
    /// β = δα + ω × δω.
    beta: Vec3,
    /// δa of the origin.
    a: Vec3,
}

/// Derivatives of the force along a column with respect to the motion of a link.
#[derive(Debug, Clone, Copy)]
struct Answer {
    /// With respect to β and δa.
    wrench: Wrench,
    /// With respect to δω.
    w: Vec3,
}

/// The tree of links in a motion, prepared for differentiation.
#[derive(Debug, Clone)]
pub struct Differentiable {
    /// Acceleration of the ground.
    ground: Vec3,
    motions: Vec<LinkMotion>,
    wrenches: Vec<Wrench>,
    composites: Vec<Inertia>,
    flows: Vec<Flow>,
    /// By link: the derivatives for the columns of itself and its descendants, by speed.
    answers: Vec<Vec<(usize, Answer)>>,
}

impl Flow {
    const NONE: Self = Self {
        moment: vector::ZERO,
        tensor: [vector::ZERO; 3],
        momentum: vector::ZERO,
    };

    /// For a rigid body fixed in the axes: `ω × h`, `ω× I − I ω×`, `I ω`.
    fn of_rigid(graph: &mut Graph, inertia: &Inertia, w: Vec3) -> Self {
        // Column i of ω× I; the tensor is symmetric.
        let half = inertia.tensor.map(|column| graph.cross(w, column));
        let tensor = plus(graph, &half, &transpose(&half));
        Self {
            moment: graph.cross(w, inertia.moment),
            tensor,
            momentum: graph.mat_vec(&inertia.tensor, w),
        }
    }

    fn plus(&self, graph: &mut Graph, other: &Self) -> Self {
        let tensor = plus(graph, &self.tensor, &other.tensor);
        Self {
            moment: graph.add3(self.moment, other.moment),
            tensor,
            momentum: graph.add3(self.momentum, other.momentum),
        }
    }

    /// Moves the reference point; the present one is at `d` from the new one and has the relative velocity `u`.
    fn shifted(&self, graph: &mut Graph, inertia: &Inertia, d: Vec3, u: Vec3) -> Self {
        let (added, arriving) = (graph.scale3(inertia.mass, d), graph.scale3(inertia.mass, u));
        let h = graph.add3(inertia.moment, added);
        let moment = graph.add3(self.moment, arriving);
        // The rate of d h' + h d.
        let product = |graph: &mut Graph, i: usize, j: usize| {
            let terms = [
                graph.mul(u[i], h[j]),
                graph.mul(d[i], moment[j]),
                graph.mul(self.moment[i], d[j]),
                graph.mul(inertia.moment[i], u[j]),
            ];
            graph.sum(&terms)
        };
        let tensor = with_products(graph, &self.tensor, product);
        let (first, second) = (graph.cross(d, moment), graph.cross(inertia.moment, u));
        let more = graph.add3(first, second);
        Self {
            moment,
            tensor,
            momentum: graph.add3(self.momentum, more),
        }
    }

    fn named(&self, algebra: &mut Algebra, link: &str) -> Self {
        let tensor = named_tensor(algebra, &format!("I_dot_{link}"), &self.tensor);
        Self {
            moment: named3(algebra, &format!("h_dot_{link}"), self.moment),
            tensor,
            momentum: named3(algebra, &format!("l_{link}"), self.momentum),
        }
    }
}

impl Change {
    /// The resulting change of the forces.
    fn takes(&self, graph: &mut Graph, inertia: &Inertia, flow: &Flow) -> Wrench {
        let rigid = inertia.resists(graph, self.beta, self.a);
        let coriolis = graph.cross(self.w, flow.moment);
        let coriolis = graph.add3(coriolis, coriolis);
        let growing = graph.mat_vec(&flow.tensor, self.w);
        let gyroscopic = graph.cross(self.w, flow.momentum);
        let n = graph.add3(growing, gyroscopic);
        rigid.plus(graph, Wrench { n, f: coriolis })
    }
}

impl Answer {
    /// The derivatives for a column of a link with its inertia.
    fn of_column(
        graph: &mut Graph,
        step: &Step,
        column: Vec3,
        wrench: Wrench,
        flow: &Flow,
    ) -> Self {
        let w = match step {
            // column · (İ δω − ℓ × δω)
            Step::Rotation { .. } => {
                let growing = graph.mat_vec(&flow.tensor, column);
                let gyroscopic = graph.cross(flow.momentum, column);
                graph.add3(growing, gyroscopic)
            }
            // column · (2 δω × ḣ)
            Step::Shift { .. } => {
                let coriolis = graph.cross(flow.moment, column);
                graph.add3(coriolis, coriolis)
            }
        };
        Self { wrench, w }
    }

    fn to(&self, graph: &mut Graph, change: &Change) -> Expr {
        let parts = [
            graph.dot(self.wrench.n, change.beta),
            graph.dot(self.wrench.f, change.a),
            graph.dot(self.w, change.w),
        ];
        graph.sum(&parts)
    }
}

impl Differentiable {
    /// The links in a motion, with gravity as acceleration of the ground.
    pub(super) fn new(
        algebra: &mut Algebra,
        links: &Links,
        own: &[Inertia],
        composites: &[Inertia],
        ground: Vec3,
        motions: Vec<LinkMotion>,
    ) -> Self {
        let wrenches = links.wrenches(algebra, own, &motions, "");
        let flows = links.flows(algebra, own, composites, &motions);
        let answers = links.answers(algebra, composites, &flows, &motions);
        Self {
            ground,
            motions,
            wrenches,
            composites: composites.to_vec(),
            flows,
            answers,
        }
    }

    /// The derivatives of the forces along the speeds with respect to a coordinate, a speed or a signal.
    pub(super) fn column(
        &self,
        algebra: &mut Algebra,
        links: &Links,
        accelerations: &[Expr],
        z: Expr,
    ) -> Vec<Expr> {
        let mut parts = vec![Vec::new(); accelerations.len()];
        for (place, link) in links.all.iter().enumerate() {
            let Some(change) = self.change(algebra, links, accelerations, place, z) else {
                continue;
            };
            for (speed, answer) in &self.answers[place] {
                parts[*speed].push(answer.to(&mut algebra.graph, &change));
            }
            let wrench = self.wrenches[place];
            for &(speed, column) in &link.columns {
                let turned = algebra.derivative3(column, z);
                parts[speed].push(link.work(&mut algebra.graph, turned, wrench));
            }
            let (composite, flow) = (&self.composites[place], &self.flows[place]);
            let taken = change.takes(&mut algebra.graph, composite, flow);
            let mut more = link.change_on_carrier(algebra, z, taken, wrench);
            let mut at = link.parent;
            while let Some(here) = at {
                let carrier = &links.all[here];
                let by = name_of(&algebra.graph, z);
                more = more.named(algebra, "", &format!("{}_by_{by}", carrier.name));
                for &(speed, column) in &carrier.columns {
                    parts[speed].push(carrier.work(&mut algebra.graph, column, more));
                }
                more = carrier.on_carrier(&mut algebra.graph, more);
                at = carrier.parent;
            }
        }
        parts.iter().map(|parts| algebra.graph.sum(parts)).collect()
    }

    /// The direct change of a link's motion with a variable through its own step; `None` if zero.
    fn change(
        &self,
        algebra: &mut Algebra,
        links: &Links,
        accelerations: &[Expr],
        place: usize,
        z: Expr,
    ) -> Option<Change> {
        let link = &links.all[place];
        let motion = &self.motions[place];
        // ω̇ is fixed.
        let mut driving = vector::ZERO;
        for &(speed, column) in &link.columns {
            let by = algebra.derivative3(column, z);
            let part = algebra.graph.scale3(accelerations[speed], by);
            driving = algebra.graph.add3(driving, part);
        }
        match &link.step {
            Step::Rotation { turns, w, w_dot } => {
                let by_w = algebra.derivative3(*w, z);
                let by_rate = algebra.derivative3(*w_dot, z);
                let axis = axis(algebra, turns, z);
                let still = [by_w, by_rate, driving].iter().all(|v| *v == vector::ZERO);
                if still && axis == Some(vector::ZERO) {
                    return None;
                }
                let graph = &mut algebra.graph;
                if let (true, Some(x), [Rotation::Turn(_)]) = (still, axis, turns.as_slice()) {
                    // In the axes of the link, the carrier's motion rotates backwards about the axis.
                    return Some(Change {
                        w: graph.cross(motion.w, x),
                        beta: graph.mat_vec(&motion.turning, x),
                        a: graph.cross(motion.a, x),
                    });
                }
                let carried = graph.sub3(motion.w, *w);
                let change = graph.cross(motion.w, *w);
                let mut alpha = graph.sub3(motion.alpha, change);
                let own = link.along(graph, accelerations);
                for part in [*w_dot, own] {
                    alpha = graph.sub3(alpha, part);
                }
                let at_rest = LinkMotion::at_rest(self.ground);
                let carrier = link.parent.map_or(&at_rest, |parent| &self.motions[parent]);
                let turned_back = |algebra: &mut Algebra, before: Vec3, behind: Vec3| match axis {
                    Some(x) => algebra.graph.cross(behind, x),
                    None => change_behind(algebra, turns, before, z),
                };
                let mut by = turned_back(algebra, carrier.w, carried);
                by = algebra.graph.add3(by, by_w);
                let mut by_alpha = turned_back(algebra, carrier.alpha, alpha);
                let by_a = turned_back(algebra, carrier.a, motion.a);
                let graph = &mut algebra.graph;
                let parts = [
                    graph.cross(by, *w),
                    graph.cross(motion.w, by_w),
                    by_rate,
                    driving,
                ];
                let centripetal = graph.cross(motion.w, by);
                for part in parts.into_iter().chain([centripetal]) {
                    by_alpha = graph.add3(by_alpha, part);
                }
                Some(Change {
                    w: by,
                    beta: by_alpha,
                    a: by_a,
                })
            }
            Step::Shift { d, d_dot, d_ddot } => {
                let [by_d, by_rate, by_second] =
                    [*d, *d_dot, *d_ddot].map(|v| algebra.derivative3(v, z));
                let graph = &mut algebra.graph;
                let mut a = graph.mat_vec(&motion.turning, by_d);
                let coriolis = graph.cross(motion.w, by_rate);
                for part in [coriolis, coriolis, by_second, driving] {
                    a = graph.add3(a, part);
                }
                let moves = a != vector::ZERO || by_d != vector::ZERO;
                moves.then_some(Change {
                    w: vector::ZERO,
                    beta: vector::ZERO,
                    a,
                })
            }
        }
    }
}

impl Links {
    /// Momentum and inertia rates of all links.
    fn flows(
        &self,
        algebra: &mut Algebra,
        own: &[Inertia],
        composites: &[Inertia],
        motions: &[LinkMotion],
    ) -> Vec<Flow> {
        let mut flows: Vec<Flow> = vec![Flow::NONE; self.all.len()];
        for (place, link) in self.all.iter().enumerate().rev() {
            let graph = &mut algebra.graph;
            let rigid = Flow::of_rigid(graph, &own[place], motions[place].w);
            let flow = flows[place].plus(graph, &rigid).named(algebra, &link.name);
            if let Some(parent) = link.parent {
                let carried = link.flow_in_carrier(algebra, &flow, &composites[place], motions);
                flows[parent] = flows[parent].plus(&mut algebra.graph, &carried);
            }
            flows[place] = flow;
        }
        flows
    }

    /// The derivatives for the columns of all links, by carrying link.
    fn answers(
        &self,
        algebra: &mut Algebra,
        composites: &[Inertia],
        flows: &[Flow],
        motions: &[LinkMotion],
    ) -> Vec<Vec<(usize, Answer)>> {
        let mut answers: Vec<Vec<(usize, Answer)>> = vec![Vec::new(); self.all.len()];
        for (place, link) in self.all.iter().enumerate() {
            for &(speed, column) in &link.columns {
                let name = &self.speeds[speed];
                let (graph, flow) = (&mut algebra.graph, &flows[place]);
                let (alpha, a) = link.step.directed(column);
                let wrench = composites[place].resists(graph, alpha, a);
                let mut answer = Answer::of_column(graph, &link.step, column, wrench, flow);
                let mut at = Some(place);
                while let Some(here) = at {
                    let carrier = &self.all[here];
                    let by = format!("{}_{name}", carrier.name);
                    answer = Answer {
                        wrench: answer.wrench.named(algebra, "", &by),
                        w: named3(algebra, &format!("b_{by}"), answer.w),
                    };
                    answers[here].push((speed, answer));
                    answer = carrier.answer_in_carrier(algebra, &answer, motions);
                    at = carrier.parent;
                }
            }
        }
        answers
    }
}

impl Link {
    /// Velocity of the origin relative to the carrier's, in axes that do not rotate, named.
    fn leaving(&self, algebra: &mut Algebra, motions: &[LinkMotion]) -> Vec3 {
        let graph = &mut algebra.graph;
        let u = match (&self.step, self.parent) {
            (Step::Shift { d, d_dot, .. }, Some(parent)) => {
                let turning = graph.cross(motions[parent].w, *d);
                graph.add3(turning, *d_dot)
            }
            (Step::Shift { d_dot, .. }, None) => *d_dot,
            (Step::Rotation { .. }, _) => vector::ZERO,
        };
        named3(algebra, &format!("u_{}", self.name), u)
    }

    fn flow_in_carrier(
        &self,
        algebra: &mut Algebra,
        flow: &Flow,
        composite: &Inertia,
        motions: &[LinkMotion],
    ) -> Flow {
        if let Step::Shift { d, .. } = self.step {
            let u = self.leaving(algebra, motions);
            return flow.shifted(&mut algebra.graph, composite, d, u);
        }
        let graph = &mut algebra.graph;
        let mut flow = flow.clone();
        for turn in self.step.turns().iter().rev() {
            flow = Flow {
                moment: turn.in_parent(graph, flow.moment),
                tensor: turn.tensor_in_parent(graph, &flow.tensor),
                momentum: turn.in_parent(graph, flow.momentum),
            };
        }
        flow
    }

    fn answer_in_carrier(
        &self,
        algebra: &mut Algebra,
        answer: &Answer,
        motions: &[LinkMotion],
    ) -> Answer {
        let wrench = self.on_carrier(&mut algebra.graph, answer.wrench);
        let mut w = self.step.outward(&mut algebra.graph, answer.w);
        if let Step::Shift { .. } = self.step {
            let u = self.leaving(algebra, motions);
            let graph = &mut algebra.graph;
            let coriolis = graph.cross(u, answer.wrench.f);
            let coriolis = graph.add3(coriolis, coriolis);
            w = graph.add3(w, coriolis);
        }
        Answer { wrench, w }
    }

    /// The change of the force transmitted to the carrier: by the change of the link's own force, and of the
    /// transformation.
    fn change_on_carrier(
        &self,
        algebra: &mut Algebra,
        z: Expr,
        change: Wrench,
        own: Wrench,
    ) -> Wrench {
        match &self.step {
            Step::Rotation { turns, .. } => {
                if let Some(x) = axis(algebra, turns, z) {
                    let graph = &mut algebra.graph;
                    let turned = Wrench {
                        n: graph.cross(x, own.n),
                        f: graph.cross(x, own.f),
                    };
                    let both = change.plus(graph, turned);
                    return self.on_carrier(graph, both);
                }
                let turned = Wrench {
                    n: change_before(algebra, turns, own.n, z),
                    f: change_before(algebra, turns, own.f, z),
                };
                let carried = self.on_carrier(&mut algebra.graph, change);
                carried.plus(&mut algebra.graph, turned)
            }
            Step::Shift { d, .. } => {
                let by_d = algebra.derivative3(*d, z);
                let graph = &mut algebra.graph;
                let carried = self.on_carrier(graph, change);
                let n = graph.cross(by_d, own.f);
                carried.plus(graph, Wrench { n, f: vector::ZERO })
            }
        }
    }
}

/// The axis about which a variable rotates the axes after the turns, in components there; `None` if the
/// derivative is not a rotation about an axis.
fn axis(algebra: &mut Algebra, turns: &[Rotation], z: Expr) -> Option<Vec3> {
    let mut x = vector::ZERO;
    for turn in turns {
        x = turn.in_child(&mut algebra.graph, x);
        match turn {
            Rotation::Turn(turn) => {
                let rate = algebra.derivative(turn.angle, z);
                x[turn.axis] = algebra.graph.add(x[turn.axis], rate);
            }
            Rotation::Attitude(attitude) => {
                let mut entries = attitude.matrix.into_iter().flatten();
                if entries.any(|entry| algebra.derivative(entry, z) != Graph::ZERO) {
                    return None;
                }
            }
        }
    }
    Some(x)
}

/// `(∂Rᵀ/∂z) v` of all turns.
fn change_behind(algebra: &mut Algebra, turns: &[Rotation], v: Vec3, z: Expr) -> Vec3 {
    let mut sum = vector::ZERO;
    for (place, turn) in turns.iter().enumerate() {
        let graph = &mut algebra.graph;
        let until = (turns[..place].iter()).fold(v, |v, turn| turn.in_child(graph, v));
        let changed = turn.change_in_child(algebra, until, z);
        let graph = &mut algebra.graph;
        let part = (turns[place + 1..].iter()).fold(changed, |v, turn| turn.in_child(graph, v));
        sum = graph.add3(sum, part);
    }
    sum
}

/// `(∂R/∂z) v` of all turns.
fn change_before(algebra: &mut Algebra, turns: &[Rotation], v: Vec3, z: Expr) -> Vec3 {
    let mut sum = vector::ZERO;
    for (place, turn) in turns.iter().enumerate() {
        let graph = &mut algebra.graph;
        let behind = turns[place + 1..].iter().rev();
        let until = behind.fold(v, |v, turn| turn.in_parent(graph, v));
        let changed = turn.change_in_parent(algebra, until, z);
        let graph = &mut algebra.graph;
        let part = (turns[..place].iter().rev()).fold(changed, |v, turn| turn.in_parent(graph, v));
        sum = graph.add3(sum, part);
    }
    sum
}
