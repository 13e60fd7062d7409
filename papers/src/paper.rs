//! The derived equations of the papers' mechanisms, under the names of the papers.

use std::collections::BTreeMap;
use std::sync::{LazyLock, Mutex, MutexGuard, PoisonError};

use appell_codegen::linearisation::{Characteristic, Linearisation, SteadyMotion};
use appell_codegen::mechanics::frames::FrameVector;
use appell_codegen::mechanics::gibbs_appell::{acceleration_energy, along, kinetic_energy};
use appell_codegen::mechanics::{self, Derivation};
use appell_codegen::symbolic::{Expr, Graph, Substitution, SymbolId, evaluate};
use appell_models::Shipped;
use appell_spec::Mechanism;
use appell_spec::mechanism::{FrameId, GROUND};
use serde::Deserialize;

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

/// A mechanism of the papers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Subject {
    /// The rolling wheel: steering paper, section II and appendix A.
    Wheel,
    /// The unicycle: steering paper, section III and appendices B and C.
    Unicycle,
    /// The EUC with three degrees of freedom: EUC paper, equations (6) to (10).
    Euc3,
    /// The EUC with two: EUC paper, equations (11) to (13).
    Euc2,
}

impl Subject {
    /// The shipped mechanism.
    pub const fn mechanism(self) -> &'static str {
        match self {
            Self::Wheel => "rolling_wheel",
            Self::Unicycle => "unicycle",
            Self::Euc3 => "euc_3dof",
            Self::Euc2 => "euc_2dof",
        }
    }

    /// Its derivation, derived once.
    pub fn paper(self) -> MutexGuard<'static, Paper> {
        static SHARED: [LazyLock<Mutex<Paper>>; 4] = [
            LazyLock::new(|| Mutex::new(Paper::steering(Subject::Wheel.spec()))),
            LazyLock::new(|| Mutex::new(Paper::steering(Subject::Unicycle.spec()))),
            LazyLock::new(|| Mutex::new(Paper::euc(Subject::Euc3.spec()))),
            LazyLock::new(|| Mutex::new(Paper::euc(Subject::Euc2.spec()))),
        ];
        // A test that failed while holding the lock has not changed the derivation.
        let shared = SHARED[self as usize].lock();
        shared.unwrap_or_else(PoisonError::into_inner)
    }

    fn spec(self) -> Mechanism {
        let shipped = Shipped::find(self.mechanism()).unwrap();
        let checked = appell_spec::load(shipped.file, shipped.spec).unwrap();
        checked.mechanism
    }
}

/// Replacements of symbols by formulas, made one after another.
pub type Replacements = [(String, String)];

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
/// States of the linearisations in the steering paper; the wheel has no `s` and `r`.
const STATES: [&str; 10] = ["w1", "w2", "w3", "th", "s", "r", "psi", "phi", "xG", "yG"];

/// The name in the paper of a name in the spec.
fn name_in<'a>(names: &[(&'a str, &str)], spec: &'a str) -> &'a str {
    let known = names.iter().find(|(_, other)| *other == spec);
    known.map_or(spec, |(name, _)| name)
}

impl Paper {
    /// The wheel or the unicycle of the steering paper.
    pub fn steering(mechanism: Mechanism) -> Self {
        let mut paper = Self::new(mechanism, STEERING_NAMES);
        paper.rename_accelerations(&["w1", "w2", "w3", "s"], |speed| format!("{speed}d"));
        for (index, coordinate) in paper.mechanism.coordinates.clone().iter().enumerate() {
            let name = format!("{}d", name_in(STEERING_NAMES, &coordinate.label.name));
            let rate = paper.derivation.coordinate_rates[index];
            paper.scope.define(&name, rate);
            paper.derive_as(&name, rate);
        }
        paper.appell("b", "Pi");
        paper.energies();
        let tilted = paper.mechanism.frames.find(|f| f.name == "tilted").unwrap();
        for name in ["G", "A"] {
            if let Some(point) = paper.mechanism.points.find(|p| p.name == name) {
                let kinematics = &paper.derivation.kinematics;
                let graph = &mut paper.derivation.algebra.graph;
                let position = kinematics.position(graph, point);
                let velocity = kinematics.velocity(point);
                paper.derive_as(&format!("z{name}"), position[2]);
                paper.vector(&format!("v{name}"), velocity, tilted);
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
        paper.rename_accelerations(&["dx", "dga", "dph"], |speed| format!("d{speed}"));
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
            scope.define(name_in(names, &spec), symbol);
        }
        Self {
            mechanism,
            derivation,
            scope,
            derived: BTreeMap::new(),
        }
    }

    /// Pseudo-accelerations as unknowns of formulas, and the derived expressions for them; of the
    /// speeds that the mechanism has.
    fn rename_accelerations(&mut self, speeds: &[&str], rename: impl Fn(&str) -> String) {
        let speeds = speeds
            .iter()
            .filter_map(|name| Some((*name, self.scope.get(name)?)));
        let speeds: Vec<(&str, Expr)> = speeds.collect();
        let symbols = self.derivation.symbols.clone();
        assert_eq!(speeds.len(), symbols.speeds.len());
        for (index, (name, speed)) in speeds.into_iter().enumerate() {
            assert_eq!(speed, symbols.speeds[index], "{name}");
            let acceleration = rename(name);
            self.scope
                .define(&acceleration, symbols.accelerations[index]);
            self.derive_as(&acceleration, self.derivation.motion.accelerations[index]);
            self.derive_as(name, speed);
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
            let right = self.derivation.forces[i];
            let residual = self.derivation.algebra.graph.sub(left, right);
            self.derive_as(&format!("row{}", i + 1), residual);
            self.derive_as(&format!("{bias}{}", i + 1), gibbs.bias[i]);
            self.derive_as(&format!("{force}{}", i + 1), right);
        }
    }

    /// S with symbols for the accelerations, T, V, the power of loads without a potential, d(T +
    /// V)/dt.
    fn energies(&mut self) {
        let d = &mut self.derivation;
        let accelerations = d.symbols.accelerations.clone();
        let sum = |d: &mut Derivation, parts: Vec<Expr>| d.algebra.graph.sum(&parts);
        let bodies = d.bodies.clone();
        let energy = |body| acceleration_energy(&mut d.algebra, body, &accelerations);
        let parts = bodies.iter().map(energy).collect();
        let s = sum(d, parts);
        let energy = |body| kinetic_energy(&mut d.algebra, body);
        let parts = bodies.iter().map(energy).collect();
        let kinetic = sum(d, parts);
        let parts = d.loads.iter().filter_map(|load| load.potential).collect();
        let potential = sum(d, parts);
        let loads = d.loads.iter().filter(|load| load.potential.is_none());
        let graph = &mut d.algebra.graph;
        let parts = loads.map(|load| load.power(graph)).collect();
        let power = sum(d, parts);
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
            let name = if body.name == "wheel" { "aG" } else { "aA" };
            let centre = &body.centre;
            let mut parts = vec![(name, centre.velocity, centre.bias, &centre.partial)];
            if let Some(rotation) = &body.rotation {
                self.vector("omega", rotation.velocity, frame);
                parts.push(("alpha", rotation.velocity, rotation.bias, &rotation.partial));
            }
            for (name, velocity, bias, partial) in parts {
                let graph = &mut self.derivation.algebra.graph;
                let v = along(graph, bias, partial, &accelerations);
                self.vector(name, FrameVector { v, ..velocity }, frame);
            }
        }
    }

    fn vector(&mut self, name: &str, vector: FrameVector, frame: FrameId) {
        let graph = &mut self.derivation.algebra.graph;
        let frames = &self.derivation.kinematics.frames;
        let v = frames.express(graph, vector, frame);
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
        let place = |name: &&str| {
            let state = self.scope.get(name)?;
            linear.states.iter().position(|&x| x == state)
        };
        let places: Vec<usize> = STATES.iter().filter_map(place).collect();
        let steady = [("steady_w1d", place(&"w1")), ("steady_sd", place(&"s"))];
        for (row, &i) in places.iter().enumerate() {
            for (column, &j) in places.iter().enumerate() {
                self.derive_as(&format!("A{}{}", row + 1, column + 1), linear.a[i][j]);
            }
            for &entry in &linear.b[i] {
                self.derive_as(&format!("B{}", row + 1), entry);
            }
        }
        for (name, place) in steady {
            if let Some(place) = place {
                self.derive_as(name, linear.rates[place]);
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
    pub fn substitution(&mut self, scope: &Scope, replacements: &[(&str, &str)]) -> Substitution {
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

    /// The expression of a formula.
    pub fn formula(&mut self, text: &str) -> Expr {
        formula(&mut self.derivation.algebra.graph, &self.scope, text)
    }

    /// Whether two expressions are the same function, by the identity test.
    pub fn same(&mut self, a: Expr, b: Expr) -> bool {
        let algebra = &mut self.derivation.algebra;
        algebra.test.are_equal(&algebra.graph, a, b)
    }

    /// Differences between lines `formula = formula` and the derivation after replacements of
    /// symbols; empty if every line holds. On the left, names are those of derived quantities; on
    /// the right, first those of symbols. A line `let name = formula` is an abbreviation for the
    /// lines after it.
    ///
    /// # Panics
    ///
    /// If a line is not an equation, or nothing is compared.
    pub fn differences(&mut self, lines: &str, at: &Replacements) -> Vec<String> {
        let (mut scope, mut left_scope) = (self.scope.clone(), self.scope.clone());
        for (name, value) in &self.derived {
            left_scope.define(name, *value);
            if scope.get(name).is_none() {
                scope.define(name, *value);
            }
        }
        let replacement =
            |(name, text): &(String, String)| self.substitution(&scope, &[(name, text)]);
        let mut at: Vec<Substitution> = at.iter().map(replacement).collect();
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
            let [derived, typed] = [derived, typed].map(|side| {
                at.iter_mut()
                    .fold(side, |side, next| next.apply(graph, side).unwrap())
            });
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
    pub fn matrix_differences(&mut self, lines: &str, at: &Replacements) -> Vec<String> {
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
        for name in self.derived.keys() {
            if entry(name) && !listed.contains(&name.as_str()) {
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
