//! The equations of motion of trees of bodies by recursion over their links: the acceleration energy, its
//! derivatives ∂S/∂ω̇ and their derivatives with respect to the state are sums over bodies, and every sum is
//! accumulated link by link, in the axes of the link, instead of body by body.
//!
//! Angular velocities and accelerations propagate outwards, forces and composite inertias inwards (J. Y. S.
//! Luh, M. W. Walker, R. P. C. Paul, 1980; M. W. Walker, D. E. Orin, 1982). Named quantities are not expanded,
//! so the cost grows linearly with the number of links and not with its third power.

mod articulated;
mod balance;
mod glossary;
mod inertia;
mod links;
mod movement;
mod partials;

use appell_spec::expr::{Expr as SpecExpr, Quantity};
use appell_spec::mechanism::{Load, LoadKind, Mechanism};

use super::algebra::{Algebra, named3};
use super::expressions::Setting;
use super::finding::{Item, Outcome};
use super::frames::FrameVector;
use super::gibbs_appell::{BodyMotion, GibbsForm, Rotation, Translation};
use super::kinematics::{Effort, Kinematics};
use super::loads::{AppliedLoad, generalized_forces};
use super::motion;
use super::motion::{Motion, Way};
use crate::symbolic::vector::{self, Vec3};
use crate::symbolic::{Expr, Graph, Rational};

use inertia::{Inertia, Wrench, central_inertia};
use links::Links;
use movement::LinkMotion;
pub use partials::Differentiable;

/// Mechanisms with fewer speeds have shorter equations in expanded form.
const FEWEST_SPEEDS: usize = 5;

/// A mechanism as a tree of links.
#[derive(Debug, Clone)]
pub struct Recursion {
    links: Links,
    /// Inertia of each link.
    own: Vec<Inertia>,
    /// Composite inertia of each link and its descendants.
    composites: Vec<Inertia>,
    /// The fictitious acceleration of the ground that replaces gravity.
    rise: Vec3,
    /// Π of the loads other than steady gravity.
    forces: Vec<Expr>,
    /// ω̇ from the factorised mass matrix, which its derivatives also use.
    pub factorized: Vec<Expr>,
}

impl Recursion {
    /// The recursion of a mechanism whose bodies form a tree of links and whose speeds are all independent;
    /// `None` for others, and for small ones.
    pub fn new(algebra: &mut Algebra, setting: Setting<'_>) -> Outcome<Option<(Kinematics, Self)>> {
        let mechanism = setting.mechanism;
        if mechanism.pseudo_velocities.len() < FEWEST_SPEEDS {
            return Ok(None);
        }
        algebra.recursive = true;
        let kinematics = Kinematics::new(algebra, setting, &[], Effort::Recursive)?;
        let Some(links) = Links::new(algebra, setting, &kinematics) else {
            algebra.recursive = false;
            return Ok(None);
        };
        let own = links.own_inertias(algebra, setting)?;
        let composites = links.composites(algebra, &own);
        let mut rise = vector::ZERO;
        for load in &mechanism.loads {
            if let Some((down, g)) = steady_weight(load) {
                let g = setting.lower_in(&mut algebra.graph, Item::Mechanism, g)?;
                let up = down.map(|c| algebra.graph.integer((-c).into()));
                let part = algebra.graph.scale3(g, up);
                rise = algebra.graph.add3(rise, part);
            }
        }
        Ok(Some((
            kinematics,
            Self {
                links,
                own,
                composites,
                rise,
                forces: Vec::new(),
                factorized: Vec::new(),
            },
        )))
    }

    /// M and b.
    pub fn gibbs_form(&self, algebra: &mut Algebra) -> GibbsForm {
        let motions = self.unaccelerated(algebra);
        let wrenches = self.links.wrenches(algebra, &self.own, &motions, "0");
        GibbsForm {
            mass_matrix: self.links.mass_matrix(algebra, &self.composites),
            bias: self.links.felt(&mut algebra.graph, &wrenches),
        }
    }

    /// The motions of the links at ω̇ = 0.
    fn unaccelerated(&self, algebra: &mut Algebra) -> Vec<LinkMotion> {
        self.links.motions(algebra, vector::ZERO, &[], "0")
    }

    /// The motions of the bodies as sums over speeds.
    pub fn bodies(
        &self,
        algebra: &mut Algebra,
        setting: Setting<'_>,
        kinematics: &Kinematics,
    ) -> Outcome<Vec<BodyMotion>> {
        let (mechanism, symbols) = (setting.mechanism, setting.symbols);
        let motions = self.unaccelerated(algebra);
        let mut bodies = Vec::with_capacity(mechanism.bodies.len());
        for ((id, body), place) in mechanism.bodies.entries().zip(&self.links.bodies) {
            let at_rest = LinkMotion::at_rest(vector::ZERO);
            let motion = place.link.map_or(&at_rest, |link| &motions[link]);
            let central = central_inertia(&mut algebra.graph, setting, id)?;
            // In the axes of the link, like its acceleration.
            let mut velocity = kinematics.velocity(body.centre);
            if let Some(frame) = body.frame.filter(|&frame| frame != velocity.frame) {
                let v = kinematics.velocity_in(&mut algebra.graph, body.centre, frame);
                velocity = FrameVector::new(frame, v);
            }
            let turned = algebra.graph.mat_vec(&motion.turning, place.arm);
            let bias = algebra.graph.add3(motion.a, turned);
            let point = &mechanism.points[body.centre].name;
            let centre = Translation {
                point: point.clone(),
                velocity,
                partial: partials(algebra, velocity.v, &symbols.speeds),
                bias: named3(algebra, &format!("a0_{point}"), bias),
            };
            let rotation = body.inertia.as_ref().map(|inertia| {
                let velocity = kinematics.frames.angular_velocity(inertia.frame);
                let rate = central.turns(&mut algebra.graph, motion);
                Rotation {
                    velocity,
                    partial: partials(algebra, velocity.v, &symbols.speeds),
                    inertia: central.tensor,
                    bias: motion.alpha,
                    momentum_rate: named3(algebra, &format!("h0_{}", body.name), rate),
                }
            });
            bodies.push(BodyMotion {
                name: body.name.clone(),
                mass: central.mass,
                centre,
                rotation,
            });
        }
        Ok(bodies)
    }

    /// Π of all loads; stores that of the loads other than steady gravity.
    pub fn forces(
        &mut self,
        algebra: &mut Algebra,
        mechanism: &Mechanism,
        loads: &[AppliedLoad],
        speeds: &[Expr],
    ) -> Vec<Expr> {
        let kinds = mechanism.loads.iter().zip(loads);
        let others = kinds.filter(|(load, _)| steady_weight(load).is_none());
        let others: Vec<AppliedLoad> = others.map(|(_, applied)| applied.clone()).collect();
        let others = generalized_forces(algebra, &others, speeds);
        let weights = self.weights(algebra);
        let both = others.iter().zip(weights);
        let all = both.map(|(&other, weight)| algebra.graph.add(other, weight));
        let all = all.collect();
        self.forces = others;
        all
    }

    /// Solves Appell's equations from the tips inwards, so that branches stay decoupled.
    pub fn solve(
        &mut self,
        algebra: &mut Algebra,
        mechanism: &Mechanism,
        gibbs: &GibbsForm,
    ) -> Outcome<Motion> {
        let falling = GibbsForm {
            mass_matrix: gibbs.mass_matrix.clone(),
            bias: self.bias_less_weights(algebra),
        };
        let order = self.inwards(self.forces.len());
        let way = Way::InOrder(&order);
        let mut motion = motion::solve(algebra, mechanism, &falling, &self.forces, &[], way)?;
        self.factorized.clone_from(&motion.accelerations);
        let motions = self.falling(algebra);
        let articulated = (self.links).articulated(algebra, &self.own, &motions, &self.forces);
        let graph = &algebra.graph;
        let is_shorter =
            |other: &Vec<Expr>| graph.operations(other) < graph.operations(&motion.accelerations);
        if let Some(accelerations) = articulated.filter(is_shorter) {
            motion.accelerations = accelerations;
        }
        Ok(motion)
    }

    /// The motions of the links at ω̇ = 0 with the fictitious acceleration of the ground.
    fn falling(&self, algebra: &mut Algebra) -> Vec<LinkMotion> {
        self.links.motions(algebra, self.rise, &[], "g")
    }

    /// The links in the actual motion.
    pub fn differentiable(&self, algebra: &mut Algebra, accelerations: &[Expr]) -> Differentiable {
        let motions = self.links.motions(algebra, self.rise, accelerations, "");
        let (own, composites) = (&self.own, &self.composites);
        Differentiable::new(algebra, &self.links, own, composites, self.rise, motions)
    }

    /// `∂(Π − b − M ω̇)/∂z` at fixed ω̇; z is a coordinate, a speed, an input or a signal.
    pub fn partial(
        &self,
        algebra: &mut Algebra,
        at: &Differentiable,
        accelerations: &[Expr],
        z: Expr,
    ) -> Vec<Expr> {
        let taken = at.column(algebra, &self.links, accelerations, z);
        let forces = self.forces.iter().zip(taken);
        let partials = forces.map(|(&force, taken)| {
            let given = algebra.derivative(force, z);
            algebra.graph.sub(given, taken)
        });
        let partials: Vec<Expr> = partials.collect();
        // Rounding must not make zeros nonzero: the sum of a zero row is zero with any weights.
        let weighted = (3..).step_by(2).zip(&partials);
        let weighted: Vec<(Rational, Expr)> = weighted.map(|(w, &e)| (w.into(), e)).collect();
        let sum = algebra.graph.linear_combination(&weighted);
        if algebra.test.is_zero(&algebra.graph, sum) {
            return vec![Graph::ZERO; partials.len()];
        }
        partials
    }

    /// `Π − b − M ω̇` with these accelerations.
    pub fn residual(&self, algebra: &mut Algebra, accelerations: &[Expr]) -> Vec<Expr> {
        let taken = self.taken(algebra, accelerations, "s");
        let forces = self.forces.iter().zip(taken);
        forces
            .map(|(&force, taken)| algebra.graph.sub(force, taken))
            .collect()
    }

    /// `M ω̇ + b − Π` with these accelerations.
    pub fn demand(&self, algebra: &mut Algebra, accelerations: &[Expr]) -> Vec<Expr> {
        let taken = self.taken(algebra, accelerations, "");
        let forces = self.forces.iter().zip(taken);
        forces
            .map(|(&force, taken)| algebra.graph.sub(taken, force))
            .collect()
    }

    /// The inertial and gravity forces along the speeds for these accelerations.
    fn taken(
        &self,
        algebra: &mut Algebra,
        accelerations: &[Expr],
        kind: &'static str,
    ) -> Vec<Expr> {
        let motions = self.links.motions(algebra, self.rise, accelerations, kind);
        let wrenches = self.links.wrenches(algebra, &self.own, &motions, kind);
        self.links.felt(&mut algebra.graph, &wrenches)
    }

    /// Speeds from the tips inwards: in this order of elimination, branches stay decoupled.
    pub fn inwards(&self, speeds: usize) -> Vec<usize> {
        let columns = self
            .links
            .all
            .iter()
            .rev()
            .flat_map(|link| link.columns.iter().rev());
        let mut order = Vec::with_capacity(speeds);
        for &(speed, _) in columns {
            if !order.contains(&speed) {
                order.push(speed);
            }
        }
        let rest: Vec<usize> = (0..speeds).filter(|k| !order.contains(k)).collect();
        order.extend(rest);
        order
    }

    /// b minus the generalised gravity forces, by the fictitious acceleration of the ground.
    pub fn bias_less_weights(&self, algebra: &mut Algebra) -> Vec<Expr> {
        let motions = self.falling(algebra);
        let wrenches = self.links.wrenches(algebra, &self.own, &motions, "g");
        self.links.felt(&mut algebra.graph, &wrenches)
    }

    /// The generalised gravity forces.
    pub fn weights(&self, algebra: &mut Algebra) -> Vec<Expr> {
        let still = self.links.still(algebra, self.rise);
        let wrenches: Vec<Wrench> = (self.composites.iter().zip(&still))
            .map(|(composite, &a)| {
                let up = composite.resists(&mut algebra.graph, vector::ZERO, a);
                Wrench {
                    n: algebra.graph.neg3(up.n),
                    f: algebra.graph.neg3(up.f),
                }
            })
            .collect();
        self.links.felt(&mut algebra.graph, &wrenches)
    }
}

fn partials(algebra: &mut Algebra, v: Vec3, speeds: &[Expr]) -> Vec<Vec3> {
    let by = speeds.iter();
    by.map(|&speed| algebra.derivative3(v, speed)).collect()
}

/// Gravity on all bodies with constant acceleration.
fn steady_weight(load: &Load) -> Option<([i8; 3], &SpecExpr)> {
    match &load.kind {
        LoadKind::Gravity { down, acceleration } if is_constant(acceleration) => {
            Some((*down, acceleration))
        }
        _ => None,
    }
}

fn is_constant(expr: &SpecExpr) -> bool {
    let mut constant = true;
    expr.visit(&mut |quantity| constant &= matches!(quantity, Quantity::Parameter(_)));
    constant
}
