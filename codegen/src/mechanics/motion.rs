//! Appell's equations `M ω̇ = Π - b`, solved for the pseudo-accelerations block by block.
//!
//! M is positive definite, so every order of elimination is stable and the simplest pivot is used.

use appell_spec::Code;
use appell_spec::mechanism::{Mechanism, SpeedId};

use super::algebra::Algebra;
use super::factorized::FactorizedBlock;
use super::finding::{Finding, Item, Outcome, unless_any};
use super::gibbs_appell::GibbsForm;
use super::letters;
use super::symbols::speed_name;
use crate::symbolic::{Expr, Graph, Node, Rational};

/// Blocks up to this size are eliminated symbolically, each in its shortest form; larger ones, and those with
/// numerically solved entries, by an unrolled factorisation with named entries.
const LARGEST_EXPLICIT_BLOCK: usize = 2;

/// Solution method of Appell's equations.
#[derive(Debug, Clone, Copy)]
pub enum Way<'a> {
    /// Small blocks symbolically, large ones by a factorisation.
    Shortest,
    /// By a factorisation: the entries contain numerical solutions already.
    Factorized,
    /// By a factorisation in this order of speeds.
    InOrder(&'a [usize]),
}

/// The solved equations of motion.
#[derive(Debug, Clone)]
pub struct Motion {
    /// Blocks of speeds that the mass matrix does not couple, with their solutions.
    pub blocks: Vec<Block>,
    /// ω̇, named.
    pub accelerations: Vec<Expr>,
}

/// A block of the mass matrix.
#[derive(Debug, Clone)]
pub enum Block {
    /// Eliminated equations; each depends only on accelerations of earlier ones.
    Eliminated(Vec<Eliminated>),
    /// An unrolled factorisation.
    Factorized(FactorizedBlock),
}

/// One eliminated equation: `pivot · (ω̇_speed - whole + Σ coupling · ω̇_other) = right`.
#[derive(Debug, Clone)]
pub struct Eliminated {
    /// The speed it determines.
    pub speed: usize,
    /// Its pivot; 1 where the right-hand side is already divided by it.
    pub pivot: Expr,
    /// The undivided pivot: zero if the mass matrix is singular.
    pub inertia: Expr,
    /// Quotient of the part divisible by the pivot.
    pub whole: Expr,
    /// Its right-hand side.
    pub right: Expr,
    /// `right / pivot`, named if there is a whole part.
    pub quotient: Expr,
    /// Couplings to accelerations that are known already, with their coefficients.
    pub couplings: Vec<(usize, Expr)>,
}

/// Solves the equations of motion. The named `parts` may be expanded if that lets a mass or a length cancel.
pub fn solve(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    gibbs: &GibbsForm,
    forces: &[Expr],
    parts: &[(Expr, Expr)],
    way: Way<'_>,
) -> Outcome<Motion> {
    let forward = letters::forward(mechanism);
    let name_dot = |graph: &mut Graph, speed: usize, value: Expr| {
        graph.name(&format!("{}_dot", speed_name(mechanism, speed)), value)
    };
    let right: Vec<Expr> = forces
        .iter()
        .zip(&gibbs.bias)
        .map(|(&force, &bias)| algebra.graph.sub(force, bias))
        .collect();
    let mut accelerations = vec![Graph::ZERO; right.len()];
    massless(algebra, mechanism, &gibbs.mass_matrix)?;
    let mut blocks = Vec::new();
    for speeds in independent_blocks(&gibbs.mass_matrix) {
        let block = if matches!(way, Way::Shortest) && speeds.len() <= LARGEST_EXPLICIT_BLOCK {
            let eliminated = eliminate(algebra, mechanism, &gibbs.mass_matrix, &right, &speeds)?;
            let values = substitute_back(algebra, &eliminated, &accelerations);
            let written_out = quotients(
                algebra,
                mechanism,
                &gibbs.mass_matrix,
                &right,
                &speeds,
                parts,
            );
            let other = substitute_back(algebra, &written_out, &accelerations);
            let shorter = !written_out.is_empty()
                && algebra.graph.operations(&other) <= algebra.graph.operations(&values);
            Block::Eliminated(if shorter { written_out } else { eliminated })
        } else {
            let block = FactorizedBlock::new(algebra, mechanism, &gibbs.mass_matrix, &speeds, way)?;
            Block::Factorized(block)
        };
        match &block {
            Block::Eliminated(equations) => {
                for equation in equations {
                    let (speed, value) = (equation.speed, equation.solved(algebra, &accelerations));
                    accelerations[speed] = name_dot(&mut algebra.graph, speed, value);
                }
            }
            Block::Factorized(block) => {
                let right = right.iter().enumerate();
                let right: Vec<Expr> = right
                    .map(|(speed, &right)| named(algebra, mechanism, "rhs", speed, right))
                    .collect();
                block.solve(algebra, &right, &mut accelerations, |graph, speed, z| {
                    graph.name(&format!("{forward}_{}", speed_name(mechanism, speed)), z)
                });
                for speed in speeds {
                    accelerations[speed] =
                        name_dot(&mut algebra.graph, speed, accelerations[speed]);
                }
            }
        }
        blocks.push(block);
    }
    let motion = Motion {
        blocks,
        accelerations,
    };
    // The pivots of a factorisation along the tree have not been tested yet.
    let singular = motion
        .pivots()
        .into_iter()
        .find(|&(_, pivot)| algebra.graph.named_value(pivot).unwrap_or(pivot) == Graph::ZERO);
    match singular {
        Some((speed, _)) => Err(vec![without_own_mass(mechanism, speed)]),
        None => Ok(motion),
    }
}

impl Motion {
    /// The solved equations for display: those of a small block after elimination, in the order of the
    /// solution, and the rows `M ω̇ = Π - b` of a large one. `unknowns` are the symbols of ω̇.
    pub fn equations(
        &self,
        graph: &mut Graph,
        mass_matrix: &[Vec<Expr>],
        right: &[Expr],
        unknowns: &[Expr],
    ) -> Vec<[Expr; 2]> {
        let opened = |graph: &Graph, e: Expr| graph.named_value(e).unwrap_or(e);
        let mut equations = Vec::new();
        for block in &self.blocks {
            match block {
                Block::Eliminated(solved) => {
                    for equation in solved {
                        let mut terms = vec![unknowns[equation.speed], graph.neg(equation.whole)];
                        for &(other, coupling) in &equation.couplings {
                            terms.push(graph.mul(coupling, unknowns[other]));
                        }
                        let sum = graph.sum(&terms);
                        let pivot = opened(graph, equation.pivot);
                        let left = graph.mul(pivot, sum);
                        equations.push([left, opened(graph, equation.right)]);
                    }
                }
                Block::Factorized(block) => {
                    let mut speeds = block.speeds.clone();
                    speeds.sort_unstable();
                    for &row in &speeds {
                        let terms: Vec<Expr> = speeds
                            .iter()
                            .map(|&column| {
                                let entry = opened(graph, mass_matrix[row][column]);
                                graph.mul(entry, unknowns[column])
                            })
                            .collect();
                        equations.push([graph.sum(&terms), right[row]]);
                    }
                }
            }
        }
        equations
    }

    /// The symbolically eliminated equations.
    pub fn eliminated(&self) -> impl Iterator<Item = &Eliminated> {
        self.blocks.iter().flat_map(|block| match block {
            Block::Eliminated(equations) => equations.as_slice(),
            Block::Factorized(_) => &[],
        })
    }

    /// Every speed with the pivot of its equation.
    pub fn pivots(&self) -> Vec<(usize, Expr)> {
        let mut pivots = Vec::new();
        for block in &self.blocks {
            match block {
                Block::Eliminated(equations) => {
                    pivots.extend(equations.iter().map(|e| (e.speed, e.inertia)));
                }
                Block::Factorized(block) => pivots.extend(block.pivots()),
            }
        }
        pivots
    }
}

impl Eliminated {
    /// `right / pivot + whole - Σ coupling · ω̇_other`
    pub fn solved(&self, algebra: &mut Algebra, accelerations: &[Expr]) -> Expr {
        let own = algebra.graph.add(self.quotient, self.whole);
        self.less_couplings(algebra, own, accelerations)
    }

    /// `own - Σ coupling · x_other`
    pub fn less_couplings(&self, algebra: &mut Algebra, own: Expr, x: &[Expr]) -> Expr {
        let mut terms = vec![own];
        for &(other, coupling) in &self.couplings {
            let term = algebra.graph.mul(coupling, x[other]);
            terms.push(algebra.graph.neg(term));
        }
        algebra.graph.sum(&terms)
    }
}

/// Accelerations of a block, without names.
fn substitute_back(algebra: &mut Algebra, equations: &[Eliminated], known: &[Expr]) -> Vec<Expr> {
    let mut x = known.to_vec();
    equations
        .iter()
        .map(|equation| {
            x[equation.speed] = equation.solved(algebra, &x);
            x[equation.speed]
        })
        .collect()
}

/// Sets of speeds that the mass matrix does not couple.
pub fn independent_blocks(mass_matrix: &[Vec<Expr>]) -> Vec<Vec<usize>> {
    let mut blocks: Vec<Vec<usize>> = Vec::new();
    let mut placed = vec![false; mass_matrix.len()];
    for start in 0..mass_matrix.len() {
        if placed[start] {
            continue;
        }
        placed[start] = true;
        let mut block = vec![start];
        let mut next = 0;
        while let Some(&i) = block.get(next) {
            for j in 0..mass_matrix.len() {
                if !placed[j] && mass_matrix[i][j] != Graph::ZERO {
                    placed[j] = true;
                    block.push(j);
                }
            }
            next += 1;
        }
        block.sort_unstable();
        blocks.push(block);
    }
    blocks
}

/// Symmetric Gaussian elimination, the simplest pivot first.
fn eliminate(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    mass_matrix: &[Vec<Expr>],
    right: &[Expr],
    speeds: &[usize],
) -> Outcome<Vec<Eliminated>> {
    let mut schur = mass_matrix.to_vec();
    let mut right = right.to_vec();
    let mut open = speeds.to_vec();
    let mut equations = Vec::with_capacity(speeds.len());
    while !open.is_empty() {
        let k = simplest_pivot(algebra, mechanism, &schur, &mut open)?;
        let pivot = named(algebra, mechanism, "pivot", k, schur[k][k]);
        let mut couplings = Vec::with_capacity(open.len());
        for &i in &open {
            // The quotient may cancel; otherwise the pivot's name is shorter.
            let cancelled = algebra.graph.div(schur[i][k], schur[k][k]);
            let cancelled = algebra.shortest(cancelled);
            let whole = algebra.graph.div(schur[i][k], pivot);
            couplings.push((i, algebra.graph.shorter(whole, cancelled)));
        }
        for (a, &(i, ratio)) in couplings.iter().enumerate() {
            for &(j, _) in &couplings[..=a] {
                let change = algebra.graph.mul(ratio, schur[j][k]);
                let entry = algebra.graph.sub(schur[i][j], change);
                let entry = algebra.shortest(entry);
                schur[i][j] = entry;
                schur[j][i] = entry;
            }
            let change = algebra.graph.mul(ratio, right[k]);
            let value = algebra.graph.sub(right[i], change);
            right[i] = algebra.shortest(value);
        }
        couplings.retain(|&(_, coupling)| coupling != Graph::ZERO);
        let (right, inertia) = (right[k], pivot);
        let specific = specific(algebra, mechanism, k, right, pivot);
        let pivot = specific.map_or(pivot, |_| Graph::ONE);
        let right = specific.unwrap_or_else(|| named(algebra, mechanism, "rhs", k, right));
        equations.push(Eliminated {
            speed: k,
            pivot,
            inertia,
            whole: Graph::ZERO,
            right,
            quotient: algebra.graph.div(right, pivot),
            couplings,
        });
    }
    equations.reverse();
    Ok(equations)
}

/// A quantity of the equation of a pseudo-velocity, named `what_speed`.
fn named(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    what: &str,
    speed: usize,
    value: Expr,
) -> Expr {
    let name = format!("{what}_{}", speed_name(mechanism, speed));
    algebra.graph.name(&name, value)
}

/// The right-hand side divided term by term by a pivot that is a symbol, if that is shorter: a mass to which
/// most loads are proportional cancels.
fn specific(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    speed: usize,
    right: Expr,
    pivot: Expr,
) -> Option<Expr> {
    let symbol = algebra.graph.as_symbol(pivot)?;
    let Node::Sum(terms) = algebra.graph.node(right).clone() else {
        return None;
    };
    let specific: Vec<_> = terms
        .iter()
        .map(|term| {
            let over = algebra.graph.div(term.expr, pivot);
            (term.coefficient.clone(), over)
        })
        .collect();
    let specific = algebra.graph.linear_combination(&specific);
    let whole = algebra.graph.div(right, pivot);
    if algebra.graph.operations(&[specific]) >= algebra.graph.operations(&[whole]) {
        return None;
    }
    let speed = speed_name(mechanism, speed);
    let name = format!("rhs_{speed}_over_{}", algebra.graph.symbol_name(symbol));
    Some(algebra.graph.name(&name, specific))
}

/// Removes and returns the open index whose diagonal entry has the fewest operations.
pub fn simplest_pivot(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    schur: &[Vec<Expr>],
    open: &mut Vec<usize>,
) -> Outcome<usize> {
    let cost = |place: usize| algebra.graph.operations(&[schur[open[place]][open[place]]]);
    let place = (0..open.len())
        .min_by_key(|&place| (cost(place), place))
        .unwrap_or(0);
    let k = open.remove(place);
    if !algebra.test.is_zero(&algebra.graph, schur[k][k]) {
        return Ok(k);
    }
    Err(vec![without_own_mass(mechanism, k)])
}

/// Fails if speeds have no inertia, naming each.
fn massless(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    mass_matrix: &[Vec<Expr>],
) -> Outcome<()> {
    let moved = |k: &usize| algebra.test.is_zero(&algebra.graph, mass_matrix[*k][*k]);
    let findings = (0..mass_matrix.len()).filter(moved);
    unless_any(findings.map(|k| without_mass(mechanism, k)).collect())
}

fn without_mass(mechanism: &Mechanism, speed: usize) -> Finding {
    let name = speed_name(mechanism, speed);
    Finding {
        code: Code::SingularMassMatrix,
        message: format!("`{name}` moves no mass"),
        item: Item::PseudoVelocity(SpeedId::new(speed)),
        help: "give mass or inertia to what it moves, or constrain it".to_owned(),
    }
}

fn without_own_mass(mechanism: &Mechanism, speed: usize) -> Finding {
    let name = speed_name(mechanism, speed);
    Finding {
        message: format!(
            "the mass matrix is singular: `{name}` moves no mass otherwise than the others do"
        ),
        help: "give mass or inertia to what it moves, or leave it out, such as a second turn about the same axis"
            .to_owned(),
        ..without_mass(mechanism, speed)
    }
}

/// Blocks of one or two speeds by Cramer's rule, fully expanded so that common factors of numerator and
/// denominator cancel. Empty for larger blocks.
fn quotients(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    mass_matrix: &[Vec<Expr>],
    right: &[Expr],
    speeds: &[usize],
    parts: &[(Expr, Expr)],
) -> Vec<Eliminated> {
    let pairs: Vec<(Expr, Expr)> = match *speeds {
        [i] => vec![(right[i], mass_matrix[i][i])],
        [i, j] => {
            let minor = |algebra: &mut Algebra, a, b, c, d| {
                let (ad, bc) = (algebra.graph.mul(a, d), algebra.graph.mul(b, c));
                algebra.graph.sub(ad, bc)
            };
            let (m_ii, m_ij, m_jj) = (mass_matrix[i][i], mass_matrix[i][j], mass_matrix[j][j]);
            let determinant = minor(algebra, m_ii, m_ij, m_ij, m_jj);
            let first = minor(algebra, right[i], right[j], m_ij, m_jj);
            let second = minor(algebra, m_ii, m_ij, right[i], right[j]);
            vec![(first, determinant), (second, determinant)]
        }
        _ => return Vec::new(),
    };
    let mut equations: Vec<Eliminated> = Vec::with_capacity(pairs.len());
    // Numeric factors of the right-hand sides are moved into the pivots; equal pivots stay equal.
    let mut scales: Vec<(Expr, Rational)> = Vec::new();
    for (&speed, (numerator, denominator)) in speeds.iter().zip(pairs) {
        let Some([whole, right, pivot]) = algebra.cancelled(numerator, denominator, parts) else {
            return Vec::new();
        };
        let known = scales.iter().find(|scale| scale.0 == pivot);
        let number = match known {
            Some((_, number)) => number.clone(),
            None if right == Graph::ZERO => Rational::ONE,
            None => algebra.graph.split_coefficient(right).0.abs(),
        };
        let right = algebra.graph.scale(&number.recip(), right);
        let scaled = algebra.graph.scale(&number.recip(), pivot);
        scales.push((pivot, number));
        let (right, pivot) = (
            named(algebra, mechanism, "rhs", speed, right),
            named(algebra, mechanism, "pivot", speed, scaled),
        );
        let mut quotient = algebra.graph.div(right, pivot);
        if whole != Graph::ZERO {
            quotient = named(algebra, mechanism, "rhs_over_pivot", speed, quotient);
        }
        equations.push(Eliminated {
            speed,
            pivot,
            inertia: pivot,
            whole,
            right,
            quotient,
            couplings: Vec::new(),
        });
    }
    equations
}
