//! Steady motions under conditions.

pub(crate) mod cyclic;
pub(crate) mod differences;
pub(crate) mod equations;
mod error;
pub(crate) mod newton;
pub(crate) mod path;
pub(crate) mod starts;
pub(crate) mod turning;

use nalgebra::{DMatrix, DVector};

use crate::point::Point;
use crate::stability::essential_matrix;
use crate::term::Term;
use appell_runtime::linearise::Undetermined;
use appell_runtime::model::{Model, ModelInfo, Quantity};
use appell_spectra::singular::Singular;
use cyclic::Structure;
use equations::SteadyEquations;
pub use error::SteadyError;
use newton::{Missed, Zero};
use starts::{Spread, value_at};

/// A quantity with a prescribed value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Condition {
    /// The quantity.
    pub term: Term,
    /// In SI.
    pub value: f64,
}

/// A motion whose essential states are constant, or turn as quaternions do without an effect on the others.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadyMotion {
    /// State, inputs and parameters. Ignorable states keep the values at which the search began.
    pub point: Point,
    /// Dimension of the family of steady motions that satisfy the same conditions; 0 for an
    /// isolated one.
    pub family: usize,
    /// Largest rate of an essential state, in SI.
    pub residual: f64,
}

/// Conditions on steady motions, and the quantities that are free.
#[derive(Clone)]
pub struct SteadyProblem<'a> {
    model: &'a dyn Model,
    structure: Structure,
    base: Point,
    free: Vec<Term>,
    conditions: Vec<Condition>,
    ignores_ranges: bool,
}

/// Solutions whose unknowns differ by less, in units of their scales, are the same: at a fold they
/// are known only to the square root of rounding.
const SAME_MOTION: f64 = 1e-7;

impl<'a> SteadyProblem<'a> {
    /// All steady motions with the inputs and parameters of a point; searches begin at its state.
    pub fn new(model: &'a dyn Model, base: Point) -> Result<Self, SteadyError> {
        Ok(Self {
            structure: Structure::of(model, &base)?,
            model,
            base,
            free: Vec::new(),
            conditions: Vec::new(),
            ignores_ranges: false,
        })
    }

    /// Admits motions outside of the declared ranges of states.
    pub fn ignore_ranges(&mut self) {
        self.ignores_ranges = true;
    }

    /// The model.
    pub fn model(&self) -> &'a dyn Model {
        self.model
    }

    /// Essential and ignorable states.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// A of a motion in its independent essential states, with their indices in the model.
    pub(super) fn essential_matrix(
        &self,
        point: &Point,
    ) -> Result<(Vec<usize>, DMatrix<f64>), Undetermined> {
        essential_matrix(self.model, &self.structure, point)
    }

    /// Where searches begin; inputs and parameters that are not free have these values.
    pub fn base(&self) -> &Point {
        &self.base
    }

    /// Inputs and parameters that are left free.
    pub fn free_terms(&self) -> &[Term] {
        &self.free
    }

    /// Prescribes the value of a quantity in SI, or replaces a prescribed one.
    pub fn fix(&mut self, term: Term, value: f64) -> Result<(), SteadyError> {
        self.check(term)?;
        if !self.is_unknown(term)
            && let Some(place) = term.place(&mut self.base)
        {
            *place = value;
            return Ok(());
        }
        self.conditions.retain(|condition| condition.term != term);
        self.conditions.push(Condition { term, value });
        if let Term::State(state) = term {
            // The starting point satisfies the condition.
            self.base.x[state] = value;
        }
        Ok(())
    }

    /// Leaves an input or parameter free: its value follows.
    pub fn free(&mut self, term: Term) -> Result<(), SteadyError> {
        let info = self.model.info();
        self.check(term)?;
        let reason = match term {
            Term::Input(_) | Term::Parameter(_) => {
                if !self.free.contains(&term) {
                    self.free.push(term);
                }
                return Ok(());
            }
            Term::State(_) => "a state is free as long as no condition fixes it",
            Term::Rate(_) | Term::Output(_) => "it follows from states, inputs and parameters",
        };
        let name = term.name(info);
        Err(SteadyError::NotFree { name, reason })
    }

    /// Removes the condition on a quantity; an input or parameter becomes free.
    pub fn release(&mut self, term: Term) -> Result<(), SteadyError> {
        self.check(term)?;
        self.conditions.retain(|condition| condition.term != term);
        match term {
            Term::Input(_) | Term::Parameter(_) => self.free(term),
            _ => Ok(()),
        }
    }

    fn is_unknown(&self, term: Term) -> bool {
        let fixed = matches!(term, Term::Input(_) | Term::Parameter(_));
        !fixed || self.free.contains(&term)
    }

    /// Whether a term exists and is constant in a steady motion.
    pub(super) fn check(&self, term: Term) -> Result<(), SteadyError> {
        let info = self.model.info();
        let (index, len) = match term {
            Term::State(i) | Term::Rate(i) => (i, info.state_len()),
            Term::Input(i) => (i, info.input_len()),
            Term::Parameter(i) => (i, info.parameter_len()),
            Term::Output(i) => (i, info.output_len()),
        };
        if index >= len {
            return Err(SteadyError::Unknown(term));
        }
        let name = term.name(info);
        match term {
            Term::State(state) | Term::Rate(state) if self.structure.turns(state) => {
                let instead = self.others(|_| true);
                Err(SteadyError::Turns { name, instead })
            }
            Term::State(state) if !self.structure.is_essential(state) => {
                Err(SteadyError::Ignorable(name))
            }
            Term::Rate(state) if self.structure.is_essential(state) => Err(SteadyError::Zero(name)),
            Term::Rate(_) | Term::Output(_) if !self.is_constant(term) => {
                let instead = self.others(|term| !matches!(term, Term::State(_)));
                Err(SteadyError::NotConstant { name, instead })
            }
            _ => Ok(()),
        }
    }

    /// Constant quantities, for people.
    fn others(&self, asked: impl Fn(&Term) -> bool) -> String {
        let names = self.constants().into_iter().filter(asked);
        let names: Vec<String> = names.map(|term| term.name(self.model.info())).collect();
        format!("one of {}", names.join(", "))
    }

    /// Whether a rate or output is constant along a steady motion.
    fn is_constant(&self, term: Term) -> bool {
        /// Offsets of the ignorable states in SI: several, as the effects of one may cancel by accident.
        const MOVED: [f64; 3] = [0.37, -1.1, 2.3];
        match term {
            Term::Rate(state) => self.structure.uniform.contains(&state),
            Term::Output(_) => {
                let value = term.value(self.model, &self.base);
                MOVED.iter().all(|by| {
                    let mut moved = self.base.clone();
                    for (i, &state) in self.structure.ignorable.iter().enumerate() {
                        moved.x[state] += by / (1.0 + i as f64);
                    }
                    let turning = &self.structure.turning;
                    turning::normalise(&turning.quaternions, &mut moved.x);
                    turning.rotate(*by, &mut moved.x);
                    let change = (term.value(self.model, &moved) - value).abs();
                    change <= 1e-12 * value.abs().max(1.0)
                })
            }
            _ => true,
        }
    }

    /// Quantities that are constant in a steady motion: essential states, rates of ignorable
    /// coordinates, outputs.
    pub fn constants(&self) -> Vec<Term> {
        let states = self.structure.essential.iter();
        let states = states.filter(|&&s| !self.structure.turns(s));
        let states = states.map(|&s| Term::State(s));
        let rates = self.structure.uniform.iter().map(|&s| Term::Rate(s));
        let outputs = (0..self.model.info().output_len()).map(Term::Output);
        let constant = outputs.filter(|&output| self.is_constant(output));
        states.chain(rates).chain(constant).collect()
    }

    /// The steady motion reached from a point, isolated or one of a family.
    pub fn solve_from(&self, start: &Point) -> Result<SteadyMotion, SteadyError> {
        let equations = self.equations();
        let zero = newton::solve(&equations, &equations.unknowns_of(start))
            .map_err(|missed| self.none(&equations, 1, &missed))?;
        Ok(self.motion(&equations, &zero))
    }

    /// The steady motion reached from the point where searches begin.
    pub fn solve(&self) -> Result<SteadyMotion, SteadyError> {
        self.solve_from(&self.base)
    }

    /// All steady motions that are found from the base and from further points, spread over the
    /// declared ranges, in the order of their distance from the base. Those outside the ranges are
    /// left out.
    pub fn solve_all(&self, starts: usize) -> Result<Vec<SteadyMotion>, SteadyError> {
        let equations = self.equations();
        let (found, nearest) = self.zeros(&equations, starts);
        let motions = found.iter().map(|zero| self.motion(&equations, zero));
        let (inside, outside): (Vec<SteadyMotion>, Vec<SteadyMotion>) =
            motions.partition(|motion| self.in_range(&motion.point));
        if !inside.is_empty() {
            return Ok(inside);
        }
        if outside.is_empty() {
            return Err(self.none(&equations, starts.max(1), &nearest));
        }
        let outside = outside.iter().map(|motion| self.passed(&motion.point));
        let mut outside: Vec<String> = outside.collect();
        outside.dedup();
        Err(SteadyError::OutOfRange { outside })
    }

    /// What keeps steady motions out of [`Self::solve_all`]: which states are outside of their ranges, for each.
    pub fn outside(&self, starts: usize) -> Vec<String> {
        let equations = self.equations();
        let (found, _) = self.zeros(&equations, starts);
        let points = found.iter().map(|zero| equations.point(&zero.z));
        let outside = points.filter(|point| !self.in_range(point));
        let mut outside: Vec<String> = outside.map(|point| self.passed(&point)).collect();
        outside.dedup();
        outside
    }

    /// The zeros reached from the base and from further points, the nearest first, and the point with the smallest
    /// residual.
    fn zeros(&self, equations: &SteadyEquations<'_>, starts: usize) -> (Vec<Zero>, Missed) {
        let base = equations.unknowns_of(&self.base);
        let mut spread = Spread::new(base.len());
        let mut found: Vec<Zero> = Vec::new();
        let mut nearest = Missed {
            z: base.clone(),
            residual: f64::INFINITY,
        };
        // Speeds that satisfy the conditions lead to fast motions, where others lead to none.
        for solves_for_speeds in [false, true] {
            if !found.is_empty() {
                break;
            }
            for number in 0..starts.max(1) {
                let mut start = base.clone();
                if number > 0 {
                    start = self.start(equations, &spread.next());
                }
                if solves_for_speeds {
                    start = self.with_speeds(equations, start);
                }
                match newton::solve(equations, &start) {
                    Ok(zero) => self.add(equations, zero, &mut found),
                    Err(missed) if missed.residual < nearest.residual => nearest = missed,
                    Err(_) => {}
                }
            }
        }
        found.sort_by(|a, b| (&a.z - &base).norm().total_cmp(&(&b.z - &base).norm()));
        (found, nearest)
    }

    /// Adds a zero near the given angles, unless it is there.
    fn add(&self, equations: &SteadyEquations<'_>, mut zero: Zero, found: &mut Vec<Zero>) {
        let mut point = equations.point(&zero.z);
        let turning = &self.structure.turning;
        turning.bring_near(&self.base.x, &mut point.x);
        self.fold(&mut point);
        zero.z = equations.unknowns_of(&point);
        let same = |other: &Zero| {
            (&other.z - &zero.z).norm() <= SAME_MOTION * (1.0 + zero.z.norm())
                || self.are_one_family(equations, [other, &zero])
        };
        if !found.iter().any(same) {
            found.push(zero);
        }
    }

    /// Whether two motions belong to families, of which one motion is enough, on the same side of the ranges.
    fn are_one_family(&self, equations: &SteadyEquations<'_>, zeros: [&Zero; 2]) -> bool {
        let [first, second] = zeros.map(|zero| self.in_range(&equations.point(&zero.z)));
        zeros.iter().all(|zero| zero.family() > 0) && first == second
    }

    /// Chooses the speeds of a starting point so that the conditions hold and the essential coordinates are constant.
    /// The equations are linear in the speeds if the conditions are on rates and on outputs linear in them; the
    /// solution nearest to the given speeds is taken.
    fn with_speeds(&self, equations: &SteadyEquations<'_>, start: DVector<f64>) -> DVector<f64> {
        /// Newton steps, for outputs that are not linear.
        const STEPS: usize = 4;
        /// Singular values that count as zero, relative to the largest.
        const RANK: f64 = 1e-9;
        use newton::Equations as _;
        let speeds = self.model.info().speeds;
        let is_speed = |term: &Term| matches!(term, Term::State(state) if *state < speeds);
        let columns = equations.unknowns.iter().enumerate();
        let columns: Vec<usize> = columns
            .filter(|(_, t)| is_speed(t))
            .map(|(i, _)| i)
            .collect();
        let dependent = |c: &Condition| matches!(c.term, Term::Rate(_) | Term::Output(_));
        if columns.is_empty() || !self.conditions.iter().any(dependent) {
            return start;
        }
        let mut z = start.clone();
        for _ in 0..STEPS {
            let (values, jacobian) = equations.evaluate(&z);
            let essential = self.structure.essential.iter().enumerate();
            let rates = essential.filter(|&(_, &s)| s >= speeds).map(|(row, _)| row);
            let conditions = values.len() - self.conditions.len()..values.len();
            let rows: Vec<usize> = rates.chain(conditions).collect();
            let part = jacobian.select_rows(&rows).select_columns(&columns);
            let weights = newton::weights(&part);
            let target = -values.select_rows(&rows).component_mul(&weights);
            if !target
                .iter()
                .chain(part.iter())
                .all(|value| value.is_finite())
            {
                return start;
            }
            let singular = Singular::of(&newton::weighted(&part, &weights));
            let step = singular.solve(&target, singular.rank(RANK));
            for (&column, step) in columns.iter().zip(step.iter()) {
                z[column] += step;
            }
        }
        if z.iter().all(|value| value.is_finite()) {
            z
        } else {
            start
        }
    }

    /// Reduces essential angles to one turn where the equations are periodic in them.
    fn fold(&self, point: &mut Point) {
        /// Rates that differ by less, relative to the largest, are the same.
        const SAME_RATES: f64 = 1e-9;
        use std::f64::consts::TAU;
        let info = self.model.info();
        for &state in &self.structure.essential {
            let turns = (point.x[state] / TAU).round();
            let fixed = |c: &Condition| c.term == Term::State(state);
            let is_angle = matches!(info.states[state].unit.as_ref(), "rad" | "deg");
            if turns == 0.0 || !is_angle || self.conditions.iter().any(fixed) {
                continue;
            }
            let mut folded = point.clone();
            folded.x[state] -= TAU * turns;
            let [before, after] = [&*point, &folded].map(|at| at.rates(self.model));
            let largest = before
                .iter()
                .fold(1.0, |most, rate| f64::max(most, rate.abs()));
            let mut rates = before.iter().zip(&after);
            let is_same = rates.all(|(a, b)| (a - b).abs() <= SAME_RATES * largest);
            if is_same && self.model.dependent_coordinates().is_empty() {
                *point = folded;
            }
        }
    }

    /// The same, all of which must be isolated.
    pub fn solve_isolated(&self, starts: usize) -> Result<Vec<SteadyMotion>, SteadyError> {
        let all = self.solve_all(starts)?;
        if all.iter().any(|motion| motion.family == 0) {
            return Ok(all
                .into_iter()
                .filter(|motion| motion.family == 0)
                .collect());
        }
        let (dimension, open) = self.generic_family(&all[0], starts);
        let info = self.model.info();
        let open = open.iter().map(|term| term.name(info)).collect();
        Err(SteadyError::Family { dimension, open })
    }

    /// Generic dimension of the family of a motion, and the quantities that vary within it. At singular motions such
    /// as rest several families intersect, and the tangent space contains the tangents of all of them.
    fn generic_family(&self, motion: &SteadyMotion, starts: usize) -> (usize, Vec<Term>) {
        let equations = self.equations();
        let mut spread = Spread::new(equations.unknowns.len());
        let others = (1..starts).filter_map(|_| {
            let zero = newton::solve(&equations, &self.start(&equations, &spread.next())).ok()?;
            let other = self.motion(&equations, &zero);
            self.in_range(&other.point).then_some(other)
        });
        let least = std::iter::once(motion.clone()).chain(others);
        let least = least.min_by_key(|motion| motion.family);
        let least = least.unwrap_or_else(|| motion.clone());
        (least.family, self.open(&least))
    }

    /// Quantities that vary within the family of a steady motion and may be prescribed in addition.
    pub fn open(&self, motion: &SteadyMotion) -> Vec<Term> {
        /// Variation, relative to its scale, below which a quantity counts as constant.
        const VARIES: f64 = 1e-6;
        let equations = self.equations();
        let z = equations.unknowns_of(&motion.point);
        let Ok(zero) = newton::solve(&equations, &z) else {
            return Vec::new();
        };
        let kernel = zero.kernel();
        let varies = |term: &Term| {
            let (_, gradient) = equations.term(*term, &zero.z);
            (kernel.tr_mul(&gradient)).norm() > VARIES * gradient.norm().max(VARIES)
        };
        let terms = self
            .constants()
            .into_iter()
            .chain(self.free.iter().copied());
        terms.filter(varies).collect()
    }

    pub(super) fn equations(&self) -> SteadyEquations<'_> {
        SteadyEquations::new(
            self.model,
            &self.structure,
            self.base.clone(),
            &self.free,
            self.conditions.clone(),
        )
    }

    /// A starting point; conditions on states hold there.
    fn start(&self, equations: &SteadyEquations<'_>, parts: &[f64]) -> DVector<f64> {
        let info = self.model.info();
        let mut point = self.base.clone();
        for (term, &part) in equations.unknowns.iter().zip(parts) {
            let quantity = term.quantity(info);
            if let Some(place) = term.place(&mut point) {
                *place = value_at(&quantity, *place, part);
            }
        }
        turning::normalise(&self.structure.turning.quaternions, &mut point.x);
        for condition in &self.conditions {
            if let Some(place) = condition.term.place(&mut point) {
                *place = condition.value;
            }
        }
        equations.unknowns_of(&point)
    }

    pub(super) fn in_range(&self, point: &Point) -> bool {
        self.ignores_ranges || self.beyond(point).next().is_none()
    }

    /// The essential states that are outside of their ranges.
    fn beyond<'p>(&'p self, point: &'p Point) -> impl Iterator<Item = (&'p Quantity, f64)> {
        let states = &self.model.info().states;
        let essential = self.structure.essential.iter();
        let with_values = essential.map(|&state| (&states[state], point.x[state]));
        with_values.filter(|(state, value)| {
            let [low, high] = state.range;
            !(low..=high).contains(value)
        })
    }

    /// The same for people.
    fn passed(&self, point: &Point) -> String {
        let one = |(state, value): (&Quantity, f64)| {
            let [low, high] = state.range.map(|limit| state.to_unit(limit));
            let value = state.to_unit(value);
            format!(
                "{} = {value:.6} {} (range {low} to {high})",
                state.name, state.unit
            )
        };
        self.beyond(point)
            .map(one)
            .collect::<Vec<_>>()
            .join(" and ")
    }

    fn motion(&self, equations: &SteadyEquations<'_>, zero: &Zero) -> SteadyMotion {
        let point = equations.point(&zero.z);
        let rates = point.rates(self.model);
        let rates = self.structure.turning.still(&point.x, &rates);
        let essential = self.structure.essential.iter();
        let residual = essential.map(|&s| rates[s].abs()).fold(0.0, f64::max);
        SteadyMotion {
            point,
            family: zero.family(),
            residual,
        }
    }

    fn none(&self, equations: &SteadyEquations<'_>, starts: usize, missed: &Missed) -> SteadyError {
        use newton::Equations as _;
        let (values, jacobian) = equations.evaluate(&missed.z);
        let weighted = values.component_mul(&newton::weights(&jacobian));
        let largest = weighted.amax();
        let names = self.row_names();
        let rows = names.into_iter().zip(values.iter()).zip(weighted.iter());
        let left = rows
            .filter(|(_, weighted)| weighted.is_nan() || weighted.abs() >= 0.1 * largest)
            .map(|((name, value), _)| (name, *value))
            .collect();
        SteadyError::None {
            starts,
            left,
            conditions: !self.conditions.is_empty(),
            turning: !self.structure.turning.quaternions.is_empty(),
        }
    }

    /// Descriptions of the equations, in the order of the rows.
    fn row_names(&self) -> Vec<String> {
        let info: &ModelInfo = self.model.info();
        let rate = |&s: &usize| format!("rate of {}", info.states[s].name);
        let constraint = |&q: &usize| {
            let name = &info.states[info.speeds + q].name;
            format!("position constraint of {name}")
        };
        let condition = |c: &Condition| format!("deviation of {}", c.term.name(info));
        let rates = self.structure.essential.iter().map(rate);
        let constraints = self.model.dependent_coordinates().iter().map(constraint);
        let conditions = self.conditions.iter().map(condition);
        let turned = vec!["turning".to_owned(); self.structure.turning.len()];
        let constraints = constraints.chain(turned);
        rates.chain(constraints).chain(conditions).collect()
    }
}
