//! Inward recursion: composite inertias, and the mass matrix from them.

use appell_spec::mechanism::BodyId;

use super::super::algebra::{Algebra, named3};
use super::super::expressions::Setting;
use super::super::finding::{Item, Outcome};
use super::links::{Link, Links, Place, Step};
use crate::symbolic::vector::{self, Mat3, Vec3};
use crate::symbolic::{Expr, Graph};

/// Mass, first moment and inertia about the origin of a link, in its axes.
#[derive(Debug, Clone)]
pub(super) struct Inertia {
    /// Mass.
    pub(super) mass: Expr,
    /// First moment `m c`.
    pub(super) moment: Vec3,
    /// Inertia about the origin.
    pub(super) tensor: Mat3,
}

/// A force at the origin of a link with a moment about it, in its axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wrench {
    /// Moment.
    pub(super) n: Vec3,
    /// Force.
    pub(super) f: Vec3,
}

impl Inertia {
    pub(super) const NONE: Self = Self {
        mass: Graph::ZERO,
        moment: vector::ZERO,
        tensor: [vector::ZERO; 3],
    };

    pub(super) fn plus(&self, graph: &mut Graph, other: &Self) -> Self {
        let tensor = plus(graph, &self.tensor, &other.tensor);
        Self {
            mass: graph.add(self.mass, other.mass),
            moment: graph.add3(self.moment, other.moment),
            tensor,
        }
    }

    /// Moves the reference point; the present one is at `d` from the new one.
    pub(super) fn shifted(&self, graph: &mut Graph, d: Vec3) -> Self {
        let added = graph.scale3(self.mass, d);
        let moment = graph.add3(self.moment, added);
        // I' = I + Σ m ((c + d)² − c²) 1 − …: with h' the new first moment, products d h' + h d.
        let product = |graph: &mut Graph, i: usize, j: usize| {
            let (new, old) = (graph.mul(d[i], moment[j]), graph.mul(self.moment[i], d[j]));
            graph.add(new, old)
        };
        let tensor = with_products(graph, &self.tensor, product);
        Self {
            mass: self.mass,
            moment,
            tensor,
        }
    }

    /// Force and moment for accelerations `a` of the origin and `alpha` of the axes from rest.
    pub(super) fn resists(&self, graph: &mut Graph, alpha: Vec3, a: Vec3) -> Wrench {
        let (inertial, turning) = (graph.scale3(self.mass, a), graph.cross(alpha, self.moment));
        let (moment, turned) = (
            graph.cross(self.moment, a),
            graph.mat_vec(&self.tensor, alpha),
        );
        Wrench {
            n: graph.add3(moment, turned),
            f: graph.add3(inertial, turning),
        }
    }

    fn named(&self, algebra: &mut Algebra, link: &str) -> Self {
        let mass = algebra.graph.name(&format!("mass_{link}"), self.mass);
        let tensor = named_tensor(algebra, &format!("I_{link}"), &self.tensor);
        Self {
            mass,
            moment: named3(algebra, &format!("h_{link}"), self.moment),
            tensor,
        }
    }
}

/// `A + B`
pub(super) fn plus(graph: &mut Graph, a: &Mat3, b: &Mat3) -> Mat3 {
    [0, 1, 2].map(|i| graph.add3(a[i], b[i]))
}

/// A symmetric tensor with names for its components.
pub(super) fn named_tensor(algebra: &mut Algebra, name: &str, tensor: &Mat3) -> Mat3 {
    let mut named = *tensor;
    for (i, j) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)] {
        let axes = ['x', 'y', 'z'];
        let name = format!("{name}_{}{}", axes[i], axes[j]);
        named[i][j] = algebra.graph.name(&name, tensor[i][j]);
        named[j][i] = named[i][j];
    }
    named
}

/// An inertia, or its rate, with second moments added: `T + tr(P) 1 − P` for a symmetric P.
pub(super) fn with_products(
    graph: &mut Graph,
    tensor: &Mat3,
    mut product: impl FnMut(&mut Graph, usize, usize) -> Expr,
) -> Mat3 {
    let squares = [0, 1, 2].map(|i| product(graph, i, i));
    let mut sum = *tensor;
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        for square in [squares[j], squares[k]] {
            sum[i][i] = graph.add(sum[i][i], square);
        }
        let ij = product(graph, i, j);
        sum[i][j] = graph.sub(sum[i][j], ij);
        sum[j][i] = sum[i][j];
    }
    sum
}

/// Inertia of a body about its centre of mass.
pub(super) fn central_inertia(
    graph: &mut Graph,
    setting: Setting<'_>,
    id: BodyId,
) -> Outcome<Inertia> {
    let tensor = setting.inertia(graph, id)?;
    let mass = &setting.mechanism.bodies[id].mass;
    Ok(Inertia {
        mass: setting.lower_in(graph, Item::Body(id), mass)?,
        moment: vector::ZERO,
        tensor,
    })
}

impl Wrench {
    pub(super) fn plus(self, graph: &mut Graph, other: Self) -> Self {
        Self {
            n: graph.add3(self.n, other.n),
            f: graph.add3(self.f, other.f),
        }
    }

    /// With named components; `kind` distinguishes motions in the names.
    pub(super) fn named(self, algebra: &mut Algebra, kind: &str, of: &str) -> Self {
        Self {
            n: named3(algebra, &format!("n{kind}_{of}"), self.n),
            f: named3(algebra, &format!("f{kind}_{of}"), self.f),
        }
    }
}

impl Link {
    /// The same force and moment at the carrier, in its axes.
    pub(super) fn on_carrier(&self, graph: &mut Graph, own: Wrench) -> Wrench {
        let mut n = self.step.outward(graph, own.n);
        let f = self.step.outward(graph, own.f);
        if let Step::Shift { d, .. } = self.step {
            let moment = graph.cross(d, f);
            n = graph.add3(n, moment);
        }
        Wrench { n, f }
    }

    /// The work of a force and a moment along a column of the step.
    pub(super) fn work(&self, graph: &mut Graph, column: Vec3, of: Wrench) -> Expr {
        match self.step {
            Step::Rotation { .. } => graph.dot(column, of.n),
            Step::Shift { .. } => graph.dot(column, of.f),
        }
    }

    fn inertia_in_carrier(&self, graph: &mut Graph, own: &Inertia) -> Inertia {
        if let Step::Shift { d, .. } = self.step {
            return own.shifted(graph, d);
        }
        let mut inertia = own.clone();
        for turn in self.step.turns().iter().rev() {
            inertia.moment = turn.in_parent(graph, inertia.moment);
            inertia.tensor = turn.tensor_in_parent(graph, &inertia.tensor);
        }
        inertia
    }
}

impl Links {
    /// The inertia of each link without its descendants.
    pub(super) fn own_inertias(
        &self,
        algebra: &mut Algebra,
        setting: Setting<'_>,
    ) -> Outcome<Vec<Inertia>> {
        let mut inertias = vec![Inertia::NONE; self.all.len()];
        for (id, &Place { link, arm }) in setting.mechanism.bodies.ids().zip(&self.bodies) {
            let Some(link) = link else {
                continue;
            };
            let graph = &mut algebra.graph;
            let central = central_inertia(graph, setting, id)?;
            let placed = central.shifted(graph, arm);
            inertias[link] = inertias[link].plus(graph, &placed);
        }
        for (inertia, link) in inertias.iter_mut().zip(&self.all) {
            *inertia = inertia.named(algebra, &format!("own_{}", link.name));
        }
        Ok(inertias)
    }

    /// The composite inertia of each link and its descendants.
    pub(super) fn composites(&self, algebra: &mut Algebra, own: &[Inertia]) -> Vec<Inertia> {
        let mut composites = own.to_vec();
        for (place, link) in self.all.iter().enumerate().rev() {
            composites[place] = composites[place].named(algebra, &link.name);
            if let Some(parent) = link.parent {
                let graph = &mut algebra.graph;
                let carried = link.inertia_in_carrier(graph, &composites[place]);
                composites[parent] = composites[parent].plus(graph, &carried);
            }
        }
        composites
    }

    /// M: the forces due to each speed's unit acceleration, projected on the speeds of its link and inwards.
    pub(super) fn mass_matrix(
        &self,
        algebra: &mut Algebra,
        composites: &[Inertia],
    ) -> Vec<Vec<Expr>> {
        let speeds = self.speeds.len();
        let mut parts = vec![vec![Vec::new(); speeds]; speeds];
        for (place, link) in self.all.iter().enumerate() {
            for &(speed, column) in &link.columns {
                let name = &self.speeds[speed];
                let (alpha, a) = link.step.directed(column);
                let mut wrench = composites[place].resists(&mut algebra.graph, alpha, a);
                let mut at = Some(place);
                while let Some(here) = at {
                    let link_here = &self.all[here];
                    wrench = wrench.named(algebra, "", &format!("{}_{name}", link_here.name));
                    for &(other, along) in &link_here.columns {
                        let work = link_here.work(&mut algebra.graph, along, wrench);
                        parts[speed][other].push(work);
                        // Within one step both orders are visited anyway.
                        if here != place {
                            parts[other][speed].push(work);
                        }
                    }
                    wrench = link_here.on_carrier(&mut algebra.graph, wrench);
                    at = link_here.parent;
                }
            }
        }
        let mut matrix = vec![vec![Graph::ZERO; speeds]; speeds];
        for (i, row) in parts.iter().enumerate() {
            for (j, parts) in row[..=i].iter().enumerate() {
                matrix[i][j] = algebra.graph.sum(parts);
                matrix[j][i] = matrix[i][j];
            }
        }
        matrix
    }
}
