//! Small programs written by hand, so that scheduling and emission are tested on their own.
#![allow(
    clippy::unwrap_used,
    clippy::too_many_lines,
    reason = "tests may panic"
)]

use std::sync::Arc;

use appell_codegen::emit::Options;
use appell_codegen::program::{Arguments, Array, Function, FunctionKind, Layout, Program, Space};
use appell_codegen::symbolic::{
    Derivatives, Expr, Function as SymbolicFunction, Graph, Rational, Relation, SymbolId,
};
use appell_runtime::model::{ModelInfo, Quantity};
use appell_test_kit::Random;

/// A text that is hard to quote.
pub(crate) const SPEC: &str = "# A spec with \"quotes\" and \"#.\nname = 'unicycle'\n";

/// The options of the golden files.
pub(crate) fn golden_options(model_impl: bool) -> Options {
    Options {
        model_impl,
        spec: model_impl.then(|| SPEC.to_owned()),
        ..Options::default()
    }
}

/// A shipped mechanism with everything that can be emitted.
pub(crate) fn with_adjoints() -> Program {
    let spec = include_str!("../../../generated/mechanisms/pendulum.toml");
    appell_codegen::compile("pendulum.toml", spec, &FunctionKind::ALL).unwrap()
}

/// A mechanism whose friction follows a reaction, with outputs that need the solved equations.
pub(crate) fn block() -> Program {
    let spec = include_str!("block.toml");
    appell_codegen::compile("block.toml", spec, &FunctionKind::ALL).unwrap()
}

/// A quantity with a unit.
pub(crate) fn quantity(name: &str, about: &str, unit: &str, value: f64) -> Quantity {
    Quantity {
        name: name.to_owned().into(),
        about: about.to_owned().into(),
        unit: unit.to_owned().into(),
        scale: 1.0,
        value,
        range: [f64::NEG_INFINITY, f64::INFINITY],
    }
}

/// A program whose functions are still to be written.
pub(crate) struct Sketch {
    pub(crate) program: Program,
    graph: Graph,
    symbols: Vec<(String, Expr)>,
}

impl Sketch {
    /// Quantities in the order of the vectors.
    pub(crate) fn new(
        name: &str,
        speeds: usize,
        states: Vec<Quantity>,
        inputs: Vec<Quantity>,
        parameters: Vec<Quantity>,
    ) -> Self {
        let mut graph = Graph::new();
        let mut all = Vec::new();
        let mut symbols = |quantities: &[Quantity]| -> Vec<SymbolId> {
            quantities
                .iter()
                .map(|quantity| {
                    let expr = graph.symbol(&quantity.name);
                    all.push((quantity.name.to_string(), expr));
                    graph.as_symbol(expr).unwrap()
                })
                .collect()
        };
        let arguments = Arguments {
            states: symbols(&states),
            inputs: symbols(&inputs),
            parameters: symbols(&parameters),
            time: symbols(&[quantity("t", "Time.", "s", 0.0)])[0],
            pi: None,
        };
        let info = ModelInfo {
            name: name.to_owned().into(),
            title: format!("The mechanism {name}.").into(),
            source: "".into(),
            states: states.into(),
            speeds,
            declared_inputs: inputs.len(),
            inputs: inputs.into(),
            signals: vec![].into(),
            signal_inputs: vec![].into(),
            parameters: parameters.into(),
            outputs: vec![].into(),
            constraint_rows: vec![].into(),
            reactions: vec![].into(),
            contacts: vec![].into(),
            explicit_time: false,
        };
        let file = format!("mechanisms/{name}.toml");
        let program = Program {
            info,
            file,
            arguments,
            dependent: Vec::new(),
            systems: Vec::new(),
            hints: Arc::default(),
            functions: Vec::new(),
        };
        Self {
            program,
            graph,
            symbols: all,
        }
    }

    pub(crate) fn graph(&mut self) -> &mut Graph {
        &mut self.graph
    }

    /// The symbol of a state, input or parameter.
    pub(crate) fn symbol(&self, name: &str) -> Expr {
        self.symbols
            .iter()
            .find(|symbol| symbol.0 == name)
            .unwrap()
            .1
    }

    /// Results whose entries are called by their numbers, under headings of their own.
    pub(crate) fn function(&mut self, kind: FunctionKind, results: Vec<(&str, Layout, Vec<Expr>)>) {
        let results = results.into_iter().map(|(name, layout, entries)| {
            let all = 0..entries.len();
            Array::new(name, &format!("The {name}."), layout, entries).under(name, all)
        });
        self.add(kind, results.collect());
    }

    fn add(&mut self, kind: FunctionKind, results: Vec<Array>) {
        let graph = Arc::new(self.graph.clone());
        let function = Function::new(kind, results).over(graph, Vec::new());
        self.program.functions.push(function);
        self.program.functions.sort_by_key(|function| function.kind);
    }

    /// Rates, and their Jacobians by differentiation.
    pub(crate) fn rates(&mut self, rates: Vec<Expr>) {
        let of = self.program.arguments.clone();
        let mut columns = |symbols: &[SymbolId]| {
            let mut matrix = vec![Graph::ZERO; rates.len() * symbols.len()];
            for (j, &symbol) in symbols.iter().enumerate() {
                let mut by = Derivatives::with_respect_to(symbol);
                for (i, &rate) in rates.iter().enumerate() {
                    matrix[i * symbols.len() + j] = by.of(&mut self.graph, rate);
                }
            }
            matrix
        };
        let (a, b, p) = (
            columns(&of.states),
            columns(&of.inputs),
            columns(&of.parameters),
        );
        let info = &self.program.info;
        let jacobian = |name: &str, by: Space, entries| {
            Array::jacobian(name, "Derivatives.", info, by, entries)
        };
        let rates = Array::rates(info, rates);
        let a = jacobian("a", Space::State, a);
        let b = jacobian("b", Space::Inputs, b);
        let p = jacobian("p", Space::Parameters, p);
        self.add(FunctionKind::Rates, vec![rates.clone()]);
        self.add(FunctionKind::Jacobians, vec![rates, a, b]);
        self.add(FunctionKind::ParameterJacobian, vec![p]);
    }
}

/// Terms `coefficient · a · b · …`, one sum.
pub(crate) fn polynomial(graph: &mut Graph, terms: &[(i64, i64, &[Expr])]) -> Expr {
    let parts: Vec<(Rational, Expr)> = terms
        .iter()
        .map(|(numerator, denominator, factors)| {
            (
                Rational::new(*numerator, *denominator),
                graph.product(factors),
            )
        })
        .collect();
    graph.linear_combination(&parts)
}

/// The steered unicycle: a rolling disc with a mass that moves along a spoke of its frame.
/// Appell's equations, entry by entry; two 2×2 systems solved symbolically.
pub(crate) fn unicycle() -> Program {
    let speed = |name: &str, about: &str| quantity(name, about, "rad/s", 0.0);
    let mut sketch = Sketch::new(
        "unicycle",
        4,
        vec![
            speed("omega_1", "Tilt rate of the wheel."),
            speed("omega_2", "Spin of the wheel about its axle."),
            speed("omega_3", "Turn rate about the wheel's vertical."),
            quantity("sigma", "Speed of the mass along its guide.", "m/s", 0.0),
            quantity("theta", "Tilt.", "rad", 0.0),
            quantity("r", "Position of the mass on its guide.", "m", 0.0),
            quantity("psi", "Yaw.", "rad", 0.0),
            quantity("phi", "Rotation of the wheel.", "rad", 0.0),
            quantity("x_G", "Position of the wheel's centre.", "m", 0.0),
            quantity("y_G", "Position of the wheel's centre.", "m", 0.0),
        ],
        vec![quantity("u", "Force on the moving mass.", "N", 0.0)],
        vec![
            quantity("m", "Mass of the wheel.", "kg", 10.0),
            quantity("m0", "Moving mass.", "kg", 5.0),
            quantity("R", "Radius of the wheel.", "m", 0.3),
            quantity("g", "Gravity.", "m/s²", 9.81),
        ],
    );
    let names = [
        "omega_1", "omega_2", "omega_3", "sigma", "theta", "r", "psi", "u", "m", "m0", "R", "g",
    ];
    let [w1, w2, w3, s, theta, r, psi, u, m, m0, big_r, gravity] =
        names.map(|name| sketch.symbol(name));
    let g = sketch.graph();
    let (sin, cos, tan) = (g.sin(theta), g.cos(theta), g.tan(theta));
    let (sin_psi, cos_psi) = (g.sin(psi), g.cos(psi));

    // Mass matrix.
    let m11 = polynomial(
        g,
        &[
            (5, 4, &[m, big_r, big_r]),
            (1, 1, &[m0, big_r, big_r]),
            (1, 1, &[m0, r, r]),
        ],
    );
    let m22 = polynomial(
        g,
        &[(3, 2, &[m, big_r, big_r]), (1, 1, &[m0, big_r, big_r])],
    );
    let m33 = polynomial(g, &[(1, 4, &[m, big_r, big_r]), (1, 1, &[m0, r, r])]);
    let m14 = polynomial(g, &[(-1, 1, &[m0, big_r])]);
    let m23 = polynomial(g, &[(-1, 1, &[m0, big_r, r])]);
    let mass_matrix = vec![
        m11,
        Graph::ZERO,
        Graph::ZERO,
        m14,
        Graph::ZERO,
        m22,
        m23,
        Graph::ZERO,
        Graph::ZERO,
        m23,
        m33,
        Graph::ZERO,
        m14,
        Graph::ZERO,
        Graph::ZERO,
        m0,
    ];
    let m11 = g.name("M_11", m11);
    let m22 = g.name("M_22", m22);
    let m33 = g.name("M_33", m33);

    // Bias.
    let w3_tan = g.mul(w3, tan);
    let b1 = polynomial(
        g,
        &[
            (2, 1, &[w1, s, m0, r]),
            (1, 1, &[w3, w3, m0, r, r, tan]),
            (1, 1, &[w3, w3, m0, big_r, r]),
            (1, 4, &[w3, w3, m, big_r, big_r, tan]),
            (-3, 2, &[w2, w3, m, big_r, big_r]),
            (-1, 1, &[w2, w3, m0, big_r, big_r]),
            (-1, 1, &[w2, w3, m0, big_r, r, tan]),
        ],
    );
    let b2 = polynomial(
        g,
        &[
            (1, 1, &[w1, w3, m, big_r, big_r]),
            (1, 1, &[w1, w3, m0, big_r, big_r]),
            (1, 1, &[w1, w3, m0, big_r, r, tan]),
            (-2, 1, &[w3, s, m0, big_r]),
        ],
    );
    let b3 = polynomial(
        g,
        &[
            (1, 2, &[w1, w2, m, big_r, big_r]),
            (-1, 4, &[w1, w3_tan, m, big_r, big_r]),
            (-1, 1, &[w1, w3_tan, m0, r, r]),
            (-1, 1, &[w1, w3, m0, big_r, r]),
            (2, 1, &[w3, s, m0, r]),
        ],
    );
    let b4 = polynomial(
        g,
        &[
            (-1, 1, &[m0, w1, w1, r]),
            (1, 1, &[m0, w2, w3, big_r]),
            (-1, 1, &[m0, w3, w3, r]),
        ],
    );
    let bias = vec![b1, b2, b3, b4];

    // Pseudo-forces.
    let p1 = polynomial(
        g,
        &[
            (1, 1, &[m, gravity, big_r, sin]),
            (1, 1, &[m0, gravity, big_r, sin]),
            (-1, 1, &[m0, gravity, r, cos]),
        ],
    );
    let p4 = polynomial(g, &[(1, 1, &[u]), (-1, 1, &[m0, gravity, sin])]);
    let forces = vec![p1, Graph::ZERO, Graph::ZERO, p4];

    // M ω̇ = Π - b, the small mass and the spin eliminated first.
    let mut right = |force: Expr, bias: Expr, name: &str| {
        let difference = g.sub(force, bias);
        g.name(name, difference)
    };
    let f1 = right(p1, b1, "f_1");
    let f2 = right(Graph::ZERO, b2, "f_2");
    let f3 = right(Graph::ZERO, b3, "f_3");
    let f4 = right(p4, b4, "f_4");
    let m0_r_squared = g.product(&[m0, big_r, big_r]);
    let d1 = g.sub(m11, m0_r_squared);
    let r_f4 = g.mul(big_r, f4);
    let n1 = g.add(f1, r_f4);
    let w1_dot = g.div(n1, d1);
    let w1_dot = g.name("omega_1_dot", w1_dot);
    let coupling = g.div(m14, m0);
    let back = g.mul(coupling, w1_dot);
    let own = g.div(f4, m0);
    let s_dot = g.sub(own, back);
    let s_dot = g.name("sigma_dot", s_dot);
    let (m22_m33, m23_m23) = (g.mul(m22, m33), g.square(m23));
    let d2 = g.sub(m22_m33, m23_m23);
    let d2 = g.name("D_2", d2);
    let mut cramer = |a: Expr, x: Expr, b: Expr, y: Expr, name: &str| {
        let (ax, by) = (g.mul(a, x), g.mul(b, y));
        let numerator = g.sub(ax, by);
        let quotient = g.div(numerator, d2);
        g.name(name, quotient)
    };
    let w2_dot = cramer(m33, f2, m23, f3, "omega_2_dot");
    let w3_dot = cramer(m22, f3, m23, f2, "omega_3_dot");

    // Kinematics.
    let psi_dot = g.div(w3, cos);
    let phi_dot = g.sub(w2, w3_tan);
    let x_dot = polynomial(
        g,
        &[
            (1, 1, &[w1, big_r, sin_psi, cos]),
            (1, 1, &[w2, big_r, cos_psi]),
        ],
    );
    let y_dot = polynomial(
        g,
        &[
            (-1, 1, &[w1, big_r, cos_psi, cos]),
            (1, 1, &[w2, big_r, sin_psi]),
        ],
    );

    let kinematics = vec![w1, s, psi_dot, phi_dot, x_dot, y_dot];
    let rates = vec![
        w1_dot, w2_dot, w3_dot, s_dot, w1, s, psi_dot, phi_dot, x_dot, y_dot,
    ];
    sketch.function(
        FunctionKind::Kinematics,
        vec![(
            "coordinate_rates",
            Layout::Vector(Space::CoordinateRates),
            kinematics,
        )],
    );
    let mass_matrix = ("mass_matrix", Layout::Matrix(4, 4), mass_matrix);
    let pseudo_forces = Layout::Vector(Space::GeneralizedForces);
    let bias = ("bias", pseudo_forces, bias);
    sketch.function(FunctionKind::MassMatrix, vec![mass_matrix.clone()]);
    sketch.function(FunctionKind::Bias, vec![bias.clone()]);
    sketch.function(FunctionKind::MassMatrixAndBias, vec![mass_matrix, bias]);
    sketch.function(
        FunctionKind::GeneralizedForces,
        vec![("generalized_forces", pseudo_forces, forces)],
    );
    sketch.rates(rates);

    // Energies of the rolling disc alone: enough for the signatures.
    let g = sketch.graph();
    let kinetic = polynomial(g, &[(3, 4, &[m, big_r, big_r, w2, w2])]);
    let potential = polynomial(g, &[(1, 1, &[m, gravity, big_r, cos])]);
    let power = g.mul(u, s);
    let s_wheel = polynomial(g, &[(5, 8, &[m, big_r, big_r, w1_dot, w1_dot])]);
    let s_wheel = g.name("s_wheel", s_wheel);
    let scalars = |names: [(&'static str, Expr); 3]| {
        names
            .map(|(name, value)| (name, Layout::Scalar, vec![value]))
            .to_vec()
    };
    let energies = scalars([
        ("kinetic", kinetic),
        ("potential", potential),
        ("power", power),
    ]);
    sketch.function(FunctionKind::Energies, energies);
    let acceleration = scalars([
        ("total", s_wheel),
        ("wheel", s_wheel),
        ("mass", Graph::ZERO),
    ]);
    sketch.function(FunctionKind::AccelerationEnergy, acceleration);
    sketch.program
}

/// One of each non-polynomial operation: functions, choices, numeric solutions, large powers, time, no inputs,
/// names that are keywords of Rust.
pub(crate) fn mixture() -> Program {
    let mut sketch = Sketch::new(
        "type",
        1,
        vec![
            quantity("type", "A keyword.", "m/s", 0.0),
            quantity("p", "The name of an argument.", "m", 0.25),
            quantity("half", "The name of a number.", "m", 0.5),
        ],
        vec![],
        vec![
            quantity("INFO", "The name of a static.", "", 2.0),
            quantity("K", "Stiffness.", "N/m", 3.0),
        ],
    );
    sketch.program.info.explicit_time = true;
    sketch.program.info.outputs = vec![
        quantity("switch", "A choice.", "m", 0.0),
        quantity("self", "A power.", "", 0.0),
        quantity("angle", "An angle.", "rad", 0.0),
    ]
    .into();
    let names = ["type", "p", "half", "INFO", "K", "t"];
    let [speed, a, b, c, k, t] = names.map(|name| sketch.symbol(name));
    let g = sketch.graph();
    let half = g.fraction(1, 2);
    let seventeenths = g.fraction(17, 35);
    let functions = [
        SymbolicFunction::Sin,
        SymbolicFunction::Asin,
        SymbolicFunction::Acos,
        SymbolicFunction::Atan,
        SymbolicFunction::Sinh,
        SymbolicFunction::Cosh,
        SymbolicFunction::Tanh,
        SymbolicFunction::Exp,
        SymbolicFunction::Sqrt,
        SymbolicFunction::Abs,
        SymbolicFunction::Sign,
        SymbolicFunction::Ln,
    ];
    let parts: Vec<Expr> = functions
        .iter()
        .map(|&function| g.function(function, b))
        .collect();
    let everything = g.sum(&parts);
    let everything = g.name("crate", everything);
    let matrix: Vec<Expr> = [[k, a, b], [a, c, half], [seventeenths, b, k]].concat();
    let solved = g.solve_numerically(matrix.clone(), vec![speed, t, a]);
    let again = g.solve_numerically(matrix, vec![a, everything, b]);
    let difference = g.sub(a, b);
    let choice = g.choice(Relation::Less, [a, difference], [solved[0], everything]);
    let other = g.choice(Relation::LessOrEqual, [t, k], [a, speed]);
    let large = g.pow(k, 19);
    let negative = g.pow(difference, -3);
    let power = g.power(k, a);
    let bent = g.atan2(difference, power);
    let parts = [choice, large, negative, other];
    let accelerations = g.sum(&parts);
    let b_dot = g.sub(again[2], bent);
    let outputs = vec![other, power, bent];
    sketch.rates(vec![accelerations, speed, b_dot]);
    sketch.function(
        FunctionKind::Outputs,
        vec![("outputs", Layout::Vector(Space::Outputs), outputs)],
    );
    sketch.program
}

/// Reproducible numbers in (0.1, 0.9), where every function of the mixture is defined.
pub(crate) struct Numbers(Random);

impl Numbers {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Random::new(seed))
    }

    pub(crate) fn next(&mut self) -> f64 {
        self.0.between(0.1, 0.9)
    }

    pub(crate) fn list(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| self.next()).collect()
    }
}
