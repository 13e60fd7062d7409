//! The derived equations of the papers' mechanisms, under the names of the papers.

use std::collections::BTreeMap;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use appell_codegen::linearisation::{Characteristic, Linearisation, SteadyMotion};
use appell_codegen::mechanics::frames::FrameVector;
use appell_codegen::mechanics::gibbs_appell::{acceleration_energy, along, kinetic_energy};
use appell_codegen::mechanics::symbols::ids;
use appell_codegen::mechanics::{self, Derivation};
use appell_codegen::symbolic::vector::Vec3;
use appell_codegen::symbolic::{Expr, Graph, Substitution, SymbolId, evaluate};
use appell_models::Shipped;
use appell_spec::Mechanism;
use appell_spec::mechanism::{FrameId, GROUND};

use crate::formula::{Scope, formula};

/// A derivation with the names of a paper.
pub struct Paper {
    /// The mechanism.
    pub mechanism: Mechanism,
    /// Its derivation.
    pub derivation: Derivation,
    /// Names that may occur in a formula.
    pub scope: Scope,
    /// Derived quantities.
    derived: BTreeMap<String, Expr>,
}

macro_rules! shared {
    ($(#[$doc:meta])* $name:ident, $make:expr) => {
        $(#[$doc])*
        pub fn $name() -> MutexGuard<'static, Paper> {
            static SHARED: LazyLock<Mutex<Paper>> = LazyLock::new(|| Mutex::new($make));
            // A test that failed while holding the lock has not changed the derivation.
            SHARED.lock().unwrap_or_else(PoisonError::into_inner)
        }
    };
}

shared!(
    /// Steering paper, section II and appendix A.
    rolling_wheel,
    Paper::steering(mechanism("rolling_wheel"))
);
shared!(
    /// Steering paper, section III and appendices B and C.
    unicycle,
    Paper::steering(mechanism("unicycle"))
);
shared!(
    /// EUC paper, equations (6) to (10).
    euc_3dof,
    Paper::euc(mechanism("euc_3dof"))
);
shared!(
    /// EUC paper, equations (11) to (13).
    euc_2dof,
    Paper::euc(mechanism("euc_2dof"))
);

/// A shipped mechanism.
fn mechanism(name: &str) -> Mechanism {
    let shipped = Shipped::find(name).unwrap();
    let checked = appell_spec::load(shipped.file, shipped.spec).unwrap();
    checked.mechanism
}

/// Name of a state, coordinate or parameter in the paper, and in the spec where it differs.
const STEERING_NAMES: &[(&str, &str)] = &[
    ("w1", "omega_1"),
    ("w2", "omega_2"),
    ("w3", "omega_3"),
    ("s", "sigma"),
    ("th", "theta"),
    ("xG", "x_G"),
    ("yG", "y_G"),
];
const EUC_NAMES: &[(&str, &str)] = &[
    ("m0", "m_0"),
    ("mw", "m_w"),
    ("J0", "J_0"),
    ("Jw", "J_w"),
    ("h0", "h_0"),
    ("l0", "l_0"),
    ("ga", "gamma"),
    ("ph", "phi"),
    ("dx", "v"),
    ("dga", "gamma_dot"),
    ("dph", "phi_dot"),
    ("Md", "M_d"),
    ("Mh", "M_h"),
];
/// States of the linearisations in the steering paper.
const WHEEL_STATES: &[&str] = &["w1", "w2", "w3", "th", "psi", "phi", "xG", "yG"];
const UNICYCLE_STATES: &[&str] = &["w1", "w2", "w3", "th", "s", "r", "psi", "phi", "xG", "yG"];

impl Paper {
    /// The wheel or the unicycle of the steering paper.
    pub fn steering(mechanism: Mechanism) -> Self {
        let mut paper = Self::new(mechanism, STEERING_NAMES);
        let speeds: &[&str] = if paper.scope.get("s").is_some() {
            &["w1", "w2", "w3", "s"]
        } else {
            &["w1", "w2", "w3"]
        };
        paper.rename_accelerations(speeds, |speed| format!("{speed}d"));
        for (index, coordinate) in paper.mechanism.coordinates.clone().iter().enumerate() {
            let name = STEERING_NAMES
                .iter()
                .find(|(_, spec)| *spec == coordinate.label.name)
                .map_or(coordinate.label.name.as_str(), |(paper, _)| paper);
            let rate = paper.derivation.coordinate_rates[index];
            paper.scope.define(&format!("{name}d"), rate);
            paper.derive_as(&format!("{name}d"), rate);
        }
        paper.appell("b", "Pi");
        paper.energies();
        let tilted = paper.mechanism.frames.find(|f| f.name == "tilted").unwrap();
        for (point, name) in [("G", "vG"), ("A", "vA")] {
            if let Some(point) = paper.mechanism.points.find(|p| p.name == point) {
                let v = paper.derivation.kinematics.velocity(point);
                paper.vector(name, v, tilted);
            }
        }
        for (point, name) in [("G", "zG"), ("A", "zA")] {
            if let Some(point) = paper.mechanism.points.find(|p| p.name == point) {
                let graph = &mut paper.derivation.algebra.graph;
                let position =
                    (paper.derivation.kinematics).position(graph, &paper.mechanism, point);
                paper.derive_as(name, position[2]);
            }
        }
        paper.rotation(tilted);
        paper.accelerations(tilted);
        paper.linearise(&[]);
        paper
    }

    /// One of the two models of the EUC paper.
    pub fn euc(mechanism: Mechanism) -> Self {
        let mut paper = Self::new(mechanism, EUC_NAMES);
        let speeds: &[&str] = if paper.scope.get("ga").is_some() {
            &["dx", "dga", "dph"]
        } else {
            &["dx", "dph"]
        };
        paper.rename_accelerations(speeds, |speed| format!("d{speed}"));
        paper.appell("h", "Q");
        paper.energies();
        paper
    }

    fn new(mechanism: Mechanism, names: &[(&str, &str)]) -> Self {
        let derivation = mechanics::derive(&mechanism)
            .unwrap_or_else(|findings| panic!("{}: {findings:?}", mechanism.file));
        let mut scope = Scope::default();
        let symbols = &derivation.symbols;
        let graph = &derivation.algebra.graph;
        let groups = [
            &symbols.parameters,
            &symbols.coordinates,
            &symbols.speeds,
            &symbols.inputs,
        ];
        for &symbol in groups.into_iter().flatten() {
            let spec = graph
                .symbol_name(graph.as_symbol(symbol).unwrap())
                .to_owned();
            let name = names
                .iter()
                .find(|(_, other)| *other == spec)
                .map_or(spec.as_str(), |(name, _)| name);
            scope.define(name, symbol);
        }
        Self {
            mechanism,
            derivation,
            scope,
            derived: BTreeMap::new(),
        }
    }

    /// Pseudo-accelerations as unknowns of formulas, and the derived expressions for them.
    fn rename_accelerations(&mut self, speeds: &[&str], rename: impl Fn(&str) -> String) {
        assert_eq!(speeds.len(), self.derivation.symbols.speeds.len());
        for (index, speed) in speeds.iter().enumerate() {
            assert_eq!(
                self.scope.get(speed),
                Some(self.derivation.symbols.speeds[index]),
                "{speed}"
            );
            self.scope
                .define(&rename(speed), self.derivation.symbols.accelerations[index]);
            self.derive_as(&rename(speed), self.derivation.motion.accelerations[index]);
            self.derive_as(speed, self.derivation.symbols.speeds[index]);
        }
    }

    /// Mass matrix, bias, forces, and the left-hand sides of Appell's equations.
    fn appell(&mut self, bias: &str, force: &str) {
        let gibbs = self.derivation.gibbs.clone();
        let accelerations = self.derivation.symbols.accelerations.clone();
        let letter = if bias == "b" { "M" } else { "m" };
        for (i, row) in gibbs.mass_matrix.iter().enumerate() {
            let mut parts = vec![gibbs.bias[i]];
            for (j, (&entry, &acceleration)) in row.iter().zip(&accelerations).enumerate() {
                self.derive_as(&format!("{letter}{}{}", i + 1, j + 1), entry);
                parts.push(self.derivation.algebra.graph.mul(entry, acceleration));
            }
            let left = self.derivation.algebra.graph.sum(&parts);
            self.derive_as(&format!("left{}", i + 1), left);
            let residual = self
                .derivation
                .algebra
                .graph
                .sub(left, self.derivation.forces[i]);
            self.derive_as(&format!("row{}", i + 1), residual);
            self.derive_as(&format!("{bias}{}", i + 1), gibbs.bias[i]);
            self.derive_as(&format!("{force}{}", i + 1), self.derivation.forces[i]);
        }
    }

    /// S with symbols for the accelerations, T, V, the power of loads without a potential, d(T +
    /// V)/dt.
    fn energies(&mut self) {
        let d = &mut self.derivation;
        let bodies = d.bodies.clone();
        let accelerations = d.symbols.accelerations.clone();
        let parts: Vec<Expr> = bodies
            .iter()
            .map(|body| acceleration_energy(&mut d.algebra, body, &accelerations))
            .collect();
        let s = d.algebra.graph.sum(&parts);
        let parts: Vec<Expr> = bodies
            .iter()
            .map(|body| kinetic_energy(&mut d.algebra, body))
            .collect();
        let kinetic = d.algebra.graph.sum(&parts);
        let parts: Vec<Expr> = d.loads.iter().filter_map(|load| load.potential).collect();
        let potential = d.algebra.graph.sum(&parts);
        let graph = &mut d.algebra.graph;
        let parts: Vec<Expr> = d
            .loads
            .iter()
            .filter(|load| load.potential.is_none())
            .map(|load| load.power(graph))
            .collect();
        let power = d.algebra.graph.sum(&parts);
        let total = d.algebra.graph.add(kinetic, potential);
        let growth = energy_rate(d, total);
        for (name, value) in [
            ("S", s),
            ("T", kinetic),
            ("V", potential),
            ("power", power),
            ("energy_rate", growth),
        ] {
            self.derive_as(name, value);
        }
        for (i, &acceleration) in accelerations.iter().enumerate() {
            let derivative = self.derivation.algebra.derivative(s, acceleration);
            self.derive_as(&format!("dS{}", i + 1), derivative);
        }
    }

    /// Accelerations of the bodies, with symbols for the pseudo-accelerations.
    fn accelerations(&mut self, frame: FrameId) {
        let accelerations = self.derivation.symbols.accelerations.clone();
        for body in self.derivation.bodies.clone() {
            let centre = &body.centre;
            let graph = &mut self.derivation.algebra.graph;
            let a = along(graph, centre.bias, &centre.partial, &accelerations);
            let name = if body.name == "wheel" { "aG" } else { "aA" };
            self.vector(
                name,
                FrameVector {
                    frame: centre.velocity.frame,
                    v: a,
                },
                frame,
            );
            if let Some(rotation) = &body.rotation {
                let graph = &mut self.derivation.algebra.graph;
                let alpha = along(graph, rotation.bias, &rotation.partial, &accelerations);
                self.vector(
                    "alpha",
                    FrameVector {
                        frame: rotation.velocity.frame,
                        v: alpha,
                    },
                    frame,
                );
                self.vector("omega", rotation.velocity, frame);
            }
        }
    }

    fn vector(&mut self, name: &str, vector: FrameVector, frame: FrameId) {
        let graph = &mut self.derivation.algebra.graph;
        let v: Vec3 = self
            .derivation
            .kinematics
            .frames
            .express(graph, vector, frame);
        for (axis, component) in v.into_iter().enumerate() {
            self.derive_as(&format!("{name}{}", axis + 1), component);
        }
    }

    /// The rotation matrix from a frame to the ground.
    fn rotation(&mut self, frame: FrameId) {
        for column in 0..3 {
            let mut v = [Graph::ZERO; 3];
            v[column] = Graph::ONE;
            let graph = &mut self.derivation.algebra.graph;
            let frames = &self.derivation.kinematics.frames;
            let unit = frames.express(graph, FrameVector { frame, v }, GROUND);
            for (row, entry) in unit.into_iter().enumerate() {
                self.derive_as(&format!("T{}{}", row + 1, column + 1), entry);
            }
        }
    }

    /// A and B about a steady motion without control, in the yaw rate `Pd` and the pitch rate `Fd`,
    /// under further conditions.
    pub fn linearise(&mut self, conditions: &[(&str, &str)]) {
        for (coordinate, name) in [("psi", "Pd"), ("phi", "Fd")] {
            let mut names = self.mechanism.coordinates.iter();
            let place = names.position(|q| q.label.name == coordinate).unwrap();
            let rate = self.derivation.symbols.rates[place];
            self.scope.define(name, rate);
        }
        let mut values: Vec<(Expr, Expr)> = Vec::new();
        values.extend(self.scope.get("u").map(|u| (u, Graph::ZERO)));
        for (name, value) in conditions {
            let symbol = self.scope.get(name).unwrap();
            values.push((symbol, self.formula(value)));
        }
        let d = &mut self.derivation;
        let steady = SteadyMotion::new(&self.mechanism, d, &values).unwrap();
        let linear = Linearisation::about(d, steady).unwrap();
        let states = if self.scope.get("s").is_some() {
            UNICYCLE_STATES
        } else {
            WHEEL_STATES
        };
        let places: Vec<usize> = states
            .iter()
            .map(|s| {
                linear
                    .states
                    .iter()
                    .position(|&x| Some(x) == self.scope.get(s))
            })
            .map(Option::unwrap)
            .collect();
        for (row, &i) in places.iter().enumerate() {
            for (column, &j) in places.iter().enumerate() {
                self.derive_as(&format!("A{}{}", row + 1, column + 1), linear.a[i][j]);
            }
            for &entry in &linear.b[i] {
                self.derive_as(&format!("B{}", row + 1), entry);
            }
        }
        for (name, state) in [("steady_w1d", "w1"), ("steady_sd", "s")] {
            if let Some(place) = states.iter().position(|&s| s == state) {
                self.derive_as(name, linear.rates[places[place]]);
            }
        }
        // det(λ − A) = λⁿ + c1 λⁿ⁻¹ + …
        let rows: Vec<&[Expr]> = linear.a.iter().map(Vec::as_slice).collect();
        let polynomial = Characteristic::of(&mut self.derivation, &rows).unwrap();
        for k in 1..=polynomial.degree {
            let coefficient = polynomial.coefficients.get(k).copied();
            self.derive_as(&format!("c{k}"), coefficient.unwrap_or(Graph::ZERO));
        }
    }

    fn derive_as(&mut self, name: &str, value: Expr) {
        self.derived.insert(name.to_owned(), value);
    }

    /// Replaces symbols, by their names in the paper, by formulas. Names that this mechanism lacks are left
    /// out: papers give the conditions of both of theirs together.
    pub fn substitution(&mut self, replacements: &[(&str, &str)]) -> Substitution {
        let scope = self.scope.clone();
        self.substitution_in(&scope, replacements)
    }

    fn substitution_in(&mut self, scope: &Scope, replacements: &[(&str, &str)]) -> Substitution {
        let graph = &mut self.derivation.algebra.graph;
        let mut pairs: Vec<(SymbolId, Expr)> = Vec::new();
        for (name, text) in replacements {
            if let Some(symbol) = scope.get(name) {
                let symbol = graph.as_symbol(symbol).unwrap();
                pairs.push((symbol, formula(graph, scope, text)));
            }
        }
        Substitution::new(graph, &pairs)
    }

    /// The derived quantity of a name.
    pub fn derived(&self, name: &str) -> Expr {
        self.derived
            .get(name)
            .copied()
            .unwrap_or_else(|| panic!("nothing was derived as `{name}`"))
    }

    /// Names of all derived quantities.
    pub fn derived_names(&self) -> Vec<String> {
        self.derived.keys().cloned().collect()
    }

    /// The expression of a formula.
    pub fn formula(&mut self, text: &str) -> Expr {
        formula(&mut self.derivation.algebra.graph, &self.scope, text)
    }

    /// Whether two expressions are the same function, by the identity test.
    pub fn same(&mut self, a: Expr, b: Expr) -> bool {
        let algebra = &mut self.derivation.algebra;
        algebra.test.are_equal(&algebra.graph, a, b)
    }

    /// Whether the derived quantity of a name equals the formula.
    pub fn agrees(&mut self, name: &str, text: &str) -> bool {
        let (derived, typed) = (self.derived(name), self.formula(text));
        self.same(derived, typed)
    }

    /// Differences between lines `formula = formula` and the derivation after substitution of
    /// symbols; empty if every line holds. On the left, names are those of derived quantities; on
    /// the right, first those of symbols. A line `let name = formula` is an abbreviation for the
    /// lines after it.
    ///
    /// # Panics
    ///
    /// If a line is not an equation, or nothing is compared.
    pub fn differences(&mut self, lines: &str, at: &[(&str, &str)]) -> Vec<String> {
        let (mut scope, mut left_scope) = (self.scope.clone(), self.scope.clone());
        for (name, value) in &self.derived {
            left_scope.define(name, *value);
            if scope.get(name).is_none() {
                scope.define(name, *value);
            }
        }
        let mut at = self.substitution_in(&scope, at);
        let (mut compared, mut differences) = (0, Vec::new());
        for line in lines.lines().map(str::trim).filter(|line| !line.is_empty()) {
            let (left, right) = line
                .split_once('=')
                .unwrap_or_else(|| panic!("no `=` in `{line}`"));
            let typed = formula(&mut self.derivation.algebra.graph, &scope, right);
            if let Some(name) = left.trim().strip_prefix("let ") {
                scope.define(name.trim(), typed);
                left_scope.define(name.trim(), typed);
                continue;
            }
            let graph = &mut self.derivation.algebra.graph;
            let derived = formula(graph, &left_scope, left);
            let [derived, typed] = [derived, typed].map(|e| at.apply(graph, e).unwrap());
            compared += 1;
            if !self.same(derived, typed) {
                differences.push(format!("{line}\n{}", self.difference(derived, typed)));
            }
        }
        assert!(compared > 0, "nothing was compared");
        differences
    }

    /// [`Paper::differences`] of entries of the linearisation; those of the same letter that are not
    /// listed must be zero.
    pub fn matrix_differences(&mut self, lines: &str, at: &[(&str, &str)]) -> Vec<String> {
        let listed: Vec<&str> = lines
            .lines()
            .filter_map(|line| line.split_once('='))
            .map(|(name, _)| name.trim())
            .collect();
        let entry = |name: &str| {
            let (letter, digits) = name.split_at(1);
            let is_entry =
                matches!(letter, "A" | "B") && digits.bytes().all(|b| b.is_ascii_digit());
            is_entry && listed.iter().any(|other| other.starts_with(letter))
        };
        let mut all = lines.to_owned();
        for name in self.derived_names() {
            if entry(&name) && !listed.contains(&name.as_str()) {
                all.extend(["\n", name.as_str(), " = 0"]);
            }
        }
        self.differences(&all, at)
    }

    /// Whether the derived acceleration energy is the formula, up to terms without accelerations.
    pub fn has_acceleration_energy(&mut self, text: &str) -> bool {
        let (derived, typed) = (self.derived("S"), self.formula(text));
        let rest = self.derivation.algebra.graph.sub(derived, typed);
        let accelerations = self.derivation.symbols.accelerations.clone();
        accelerations.into_iter().all(|acceleration| {
            let slope = self.derivation.algebra.derivative(rest, acceleration);
            self.same(slope, Graph::ZERO)
        })
    }

    /// Asserts that lines agree with the derivation, as for [`Paper::differences`].
    pub fn assert(&mut self, lines: &str) {
        let differences = self.differences(lines, &[]);
        assert!(differences.is_empty(), "{}", differences.join("\n"));
    }

    /// Asserts that the derived quantity vanishes after substitution of symbols.
    pub fn assert_solves(&mut self, name: &str, replacements: &[(&str, &str)]) {
        let mut substitution = self.substitution(replacements);
        let derived = self.derived(name);
        let value = substitution
            .apply(&mut self.derivation.algebra.graph, derived)
            .unwrap();
        assert!(
            self.same(value, Graph::ZERO),
            "{name}\n{}",
            self.difference(value, Graph::ZERO)
        );
    }

    /// Values of two expressions at a point, for failure messages.
    fn difference(&self, derived: Expr, typed: Expr) -> String {
        let graph = &self.derivation.algebra.graph;
        let values: Vec<f64> = (0..graph.symbol_count())
            .map(|symbol| 0.3 + 0.9 * (symbol as f64 * 0.618).fract())
            .collect();
        let [derived, typed] = [derived, typed].map(|e| evaluate(graph, &values, &[e])[0]);
        format!("derived and typed at one point: {derived} and {typed}")
    }
}

/// d/dt of a function of states and parameters along the motion.
pub fn energy_rate(d: &mut Derivation, energy: Expr) -> Expr {
    let states = d.symbols.speeds.iter().chain(&d.symbols.coordinates);
    let rates = d.motion.accelerations.iter().chain(&d.coordinate_rates);
    let pairs: Vec<(Expr, Expr)> = states.copied().zip(rates.copied()).collect();
    let mut parts = vec![d.algebra.derivative(energy, d.symbols.time)];
    for (state, rate) in pairs {
        let partial = d.algebra.derivative(energy, state);
        parts.push(d.algebra.graph.mul(partial, rate));
    }
    for [value, first, second] in d.symbols.signals.clone() {
        for (symbol, rate) in [(value, first), (first, second)] {
            let partial = d.algebra.derivative(energy, symbol);
            parts.push(d.algebra.graph.mul(partial, rate));
        }
    }
    d.algebra.graph.sum(&parts)
}

/// Symbols of the states, speeds first.
pub fn states(d: &Derivation) -> Vec<SymbolId> {
    ids(
        &d.algebra.graph,
        &[d.symbols.speeds.as_slice(), &d.symbols.coordinates].concat(),
    )
}
