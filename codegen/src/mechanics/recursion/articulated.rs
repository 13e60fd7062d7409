//! The articulated-body algorithm: forward dynamics link by link without a mass matrix, by articulated-body
//! inertias (R. Featherstone, 1983). Its cost grows with the number of links; that of a factorised mass matrix
//! with its third power on a chain.

use super::super::algebra::{Algebra, named3};
use super::inertia::{Inertia, Wrench, plus};
use super::links::{Link, Links, Step};
use super::movement::LinkMotion;
use crate::symbolic::vector::{self, Mat3, Vec3};
use crate::symbolic::{Expr, Graph};

/// Articulated-body inertia: `n = J α + K a` and `f = Kᵀ α + M a`.
#[derive(Debug, Clone)]
struct Articulated {
    /// J.
    moment: Mat3,
    /// K.
    coupling: Mat3,
    /// M.
    mass: Mat3,
}

/// One speed of a link, eliminated.
struct Pivot {
    speed: usize,
    column: Vec3,
    /// Force and moment per unit acceleration along the column.
    wrench: Wrench,
    /// Articulated inertia along the speed, D.
    inertia: Expr,
    /// Generalised force minus bias along the speed.
    right: Expr,
}

/// An acceleration of a link relative to that at ω̇ = 0.
#[derive(Clone, Copy)]
struct Beyond {
    alpha: Vec3,
    a: Vec3,
}

impl Links {
    /// ω̇, from the motions at ω̇ = 0 and the forces along the speeds. `None` if a speed moves several links.
    pub(super) fn articulated(
        &self,
        algebra: &mut Algebra,
        own: &[Inertia],
        motions: &[LinkMotion],
        forces: &[Expr],
    ) -> Option<Vec<Expr>> {
        let columns = self.all.iter().flat_map(|link| &link.columns);
        let mut speeds: Vec<usize> = columns.map(|&(speed, _)| speed).collect();
        speeds.sort_unstable();
        if !speeds.iter().copied().eq(0..forces.len()) {
            return None;
        }
        let mut resisting: Vec<Articulated> = own
            .iter()
            .map(|inertia| Articulated::of_rigid(&mut algebra.graph, inertia))
            .collect();
        let mut wrenches: Vec<Wrench> = (own.iter().zip(motions))
            .map(|(inertia, motion)| inertia.takes(&mut algebra.graph, motion))
            .collect();
        let mut pivots: Vec<Vec<Pivot>> = Vec::with_capacity(self.all.len());
        for (place, link) in self.all.iter().enumerate().rev() {
            let mut articulated = resisting[place].named(algebra, &link.name);
            let mut wrench = wrenches[place].named(algebra, "p", &link.name);
            let mut own_pivots = Vec::with_capacity(link.columns.len());
            for &(speed, column) in &link.columns {
                let name = &self.speeds[speed];
                let (alpha, a) = link.step.directed(column);
                let taken = articulated.takes(&mut algebra.graph, alpha, a);
                let taken = taken.named(algebra, "", &format!("{}_{name}", link.name));
                let graph = &mut algebra.graph;
                let inertia = link.work(graph, column, taken);
                let inertia = graph.name(&format!("D_{name}"), inertia);
                let felt = link.work(graph, column, wrench);
                let right = graph.sub(forces[speed], felt);
                let right = graph.name(&format!("rest_{name}"), right);
                let drive = graph.div(right, inertia);
                let drive = graph.name(&format!("drive_{name}"), drive);
                articulated = articulated.without(graph, taken, inertia);
                let added = Wrench {
                    n: graph.scale3(drive, taken.n),
                    f: graph.scale3(drive, taken.f),
                };
                wrench = wrench.plus(graph, added);
                own_pivots.push(Pivot {
                    speed,
                    column,
                    wrench: taken,
                    inertia,
                    right,
                });
            }
            pivots.push(own_pivots);
            if let Some(parent) = link.parent {
                let name = format!("{}_free", link.name);
                let articulated = articulated.named(algebra, &name);
                let wrench = wrench.named(algebra, "t", &link.name);
                let graph = &mut algebra.graph;
                let carried = link.articulated_in_carrier(graph, &articulated);
                resisting[parent] = resisting[parent].plus(graph, &carried);
                let felt = link.on_carrier(graph, wrench);
                wrenches[parent] = wrenches[parent].plus(graph, felt);
            }
        }
        pivots.reverse();
        Some(self.outwards(algebra, &pivots))
    }

    /// ω̇, propagated from the ground outwards.
    fn outwards(&self, algebra: &mut Algebra, pivots: &[Vec<Pivot>]) -> Vec<Expr> {
        let at_rest = Beyond {
            alpha: vector::ZERO,
            a: vector::ZERO,
        };
        let mut beyond: Vec<Beyond> = Vec::with_capacity(self.all.len());
        let mut accelerations = vec![Graph::ZERO; self.speeds.len()];
        for (link, pivots) in self.all.iter().zip(pivots) {
            let carrier = link.parent.map_or(at_rest, |parent| beyond[parent]);
            let graph = &mut algebra.graph;
            let mut motion = link.carried(graph, carrier);
            // Columns were eliminated first to last, so they are solved in reverse.
            for pivot in pivots.iter().rev() {
                let graph = &mut algebra.graph;
                let resisted = [
                    graph.dot(pivot.wrench.n, motion.alpha),
                    graph.dot(pivot.wrench.f, motion.a),
                ];
                let resisted = graph.sum(&resisted);
                let rest = graph.sub(pivot.right, resisted);
                let value = graph.div(rest, pivot.inertia);
                let value = graph.name(&format!("{}_dot", self.speeds[pivot.speed]), value);
                accelerations[pivot.speed] = value;
                let (alpha, a) = link.step.directed(pivot.column);
                let (alpha, a) = (graph.scale3(value, alpha), graph.scale3(value, a));
                motion = Beyond {
                    alpha: graph.add3(motion.alpha, alpha),
                    a: graph.add3(motion.a, a),
                };
            }
            beyond.push(Beyond {
                alpha: named3(algebra, &format!("d_alpha_{}", link.name), motion.alpha),
                a: named3(algebra, &format!("d_a_{}", link.name), motion.a),
            });
        }
        accelerations
    }
}

impl Link {
    /// The acceleration of the carrier expressed at the link.
    fn carried(&self, graph: &mut Graph, carrier: Beyond) -> Beyond {
        let alpha = self.step.inward(graph, carrier.alpha);
        let mut a = self.step.inward(graph, carrier.a);
        if let Step::Shift { d, .. } = self.step {
            let turning = graph.cross(alpha, d);
            a = graph.add3(a, turning);
        }
        Beyond { alpha, a }
    }

    fn articulated_in_carrier(&self, graph: &mut Graph, own: &Articulated) -> Articulated {
        if let Step::Shift { d, .. } = self.step {
            return own.shifted(graph, d);
        }
        Articulated {
            moment: self.step.tensor_outward(graph, &own.moment),
            coupling: self.step.tensor_outward(graph, &own.coupling),
            mass: self.step.tensor_outward(graph, &own.mass),
        }
    }
}

impl Articulated {
    fn of_rigid(graph: &mut Graph, inertia: &Inertia) -> Self {
        let mut mass = [vector::ZERO; 3];
        for (i, row) in mass.iter_mut().enumerate() {
            row[i] = inertia.mass;
        }
        Self {
            moment: inertia.tensor,
            coupling: crossing(graph, inertia.moment),
            mass,
        }
    }

    fn plus(&self, graph: &mut Graph, other: &Self) -> Self {
        Self {
            moment: plus(graph, &self.moment, &other.moment),
            coupling: plus(graph, &self.coupling, &other.coupling),
            mass: plus(graph, &self.mass, &other.mass),
        }
    }

    fn takes(&self, graph: &mut Graph, alpha: Vec3, a: Vec3) -> Wrench {
        let (own, coupled) = (
            graph.mat_vec(&self.moment, alpha),
            graph.mat_vec(&self.coupling, a),
        );
        let n = graph.add3(own, coupled);
        let (own, coupled) = (
            graph.mat_vec(&self.mass, a),
            graph.transposed_mat_vec(&self.coupling, alpha),
        );
        Wrench {
            n,
            f: graph.add3(own, coupled),
        }
    }

    /// The articulated inertia with one speed free: minus `U Uᵀ / D`.
    fn without(&self, graph: &mut Graph, taken: Wrench, inertia: Expr) -> Self {
        let mut less = |t: &Mat3, left: Vec3, right: Vec3, symmetric: bool| {
            let mut rest = *t;
            for i in 0..3 {
                let share = graph.div(left[i], inertia);
                for j in 0..3 {
                    if symmetric && j < i {
                        rest[i][j] = rest[j][i];
                        continue;
                    }
                    let part = graph.mul(share, right[j]);
                    rest[i][j] = graph.sub(t[i][j], part);
                }
            }
            rest
        };
        Self {
            moment: less(&self.moment, taken.n, taken.n, true),
            coupling: less(&self.coupling, taken.n, taken.f, false),
            mass: less(&self.mass, taken.f, taken.f, true),
        }
    }

    /// Moves the reference point; the present one is at `d` from the new one: `K + d× M` and
    /// `J − K d× + d× (K + d× M)ᵀ`.
    fn shifted(&self, graph: &mut Graph, d: Vec3) -> Self {
        let mut coupling = self.coupling;
        for column in 0..3 {
            let mass = self.mass.map(|row| row[column]);
            let more = graph.cross(d, mass);
            for (row, more) in coupling.iter_mut().zip(more) {
                row[column] = graph.add(row[column], more);
            }
        }
        let mut moment = self.moment;
        for i in 0..3 {
            // Row i of −K d× is d × (row i of K); column i of d× (K + d× M)ᵀ is d × (row i of K + d× M).
            let first = graph.cross(d, self.coupling[i]);
            for j in 0..=i {
                let second = graph.cross(d, coupling[j])[i];
                let more = graph.add(first[j], second);
                moment[i][j] = graph.add(moment[i][j], more);
                moment[j][i] = moment[i][j];
            }
        }
        Self {
            moment,
            coupling,
            mass: self.mass,
        }
    }

    fn named(&self, algebra: &mut Algebra, link: &str) -> Self {
        let mut name = |letter: &str, t: &Mat3, symmetric: bool| {
            let axes = ['x', 'y', 'z'];
            let mut named = *t;
            for i in 0..3 {
                for j in 0..3 {
                    if symmetric && j < i {
                        named[i][j] = named[j][i];
                        continue;
                    }
                    let name = format!("{letter}_{link}_{}{}", axes[i], axes[j]);
                    named[i][j] = algebra.graph.name(&name, t[i][j]);
                }
            }
            named
        };
        Self {
            moment: name("AJ", &self.moment, true),
            coupling: name("AK", &self.coupling, false),
            mass: name("AM", &self.mass, true),
        }
    }
}

/// `v×`
fn crossing(graph: &mut Graph, [x, y, z]: Vec3) -> Mat3 {
    let [minus_x, minus_y, minus_z] = graph.neg3([x, y, z]);
    [
        [Graph::ZERO, minus_z, y],
        [z, Graph::ZERO, minus_x],
        [minus_y, x, Graph::ZERO],
    ]
}
