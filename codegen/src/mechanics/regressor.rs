//! The regressor: inverse dynamics as a linear function of the inertial parameters, M ω̇ + b − Π = Y π + r.
//!
//! The motion of a body depends on its mass m, first moments m c and inertia J about a body-fixed point P. The
//! inertial forces are linear in these ten numbers (W. Khalil, E. Dombre, 2002, section 9.2). So the equations
//! are derived with a symbol for each of m, c and J, and the columns of Y are derivatives: with respect to m
//! and J at c = 0, and ∂²/∂m ∂c there for the first moments. Columns for load parameters that enter linearly in
//! addition, such as coefficients of friction, follow; r is the remainder.

use std::sync::Arc;

use appell_spec::expr::{Expr as SpecExpr, ExprKind, Quantity};
use appell_spec::mechanism::{
    Body, BodyId, Label, Mechanism, Parameter, ParameterId, Point, PointId,
};
use appell_spec::units::{Dimension, Unit};

use super::arguments::function_arguments;
use super::assemble::by_speed;
use super::expressions::Setting;
use super::finding::{Item, Outcome};
use super::info::{info, tabulated_inputs};
use super::symbols::ids;
use super::{Derivation, derive};
use crate::program::{Array, Function, FunctionKind, Layout, Program};
use crate::symbolic::{Expr, Graph, Substitution, vector};

/// The pairs of axes of the six moments and products of inertia.
const PAIRS: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];
const AXES: [&str; 3] = ["x", "y", "z"];

/// The regressor of a mechanism.
#[derive(Debug, Clone)]
pub struct Regressor {
    /// A program with one function, [`FunctionKind::Regressor`].
    pub program: Program,
    /// The parameters π, one per column of Y.
    pub parameters: Vec<Linear>,
    /// Inertial parameters without effect on any motion.
    pub without_effect: Vec<String>,
}

/// A parameter on which inverse dynamics depends linearly.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Linear {
    /// `m`, `mx`, `Ixx` and so on with the name of the body, or the parameter of the spec.
    pub name: String,
    /// SI unit.
    pub unit: String,
}

/// Derives the regressor.
pub fn regressor(mechanism: &Mechanism) -> Outcome<Regressor> {
    let (general, bodies) = with_general_bodies(mechanism);
    let mut derivation = derive(&general)?;
    let columns = derivation.columns(mechanism, &bodies)?;
    let info = info(&derivation, mechanism, &tabulated_inputs(mechanism));
    let speeds = &info.states[..info.speeds];
    let names: Vec<String> = columns.parameters.iter().map(|p| p.name.clone()).collect();
    let layout = Layout::Matrix(speeds.len(), names.len());
    let entries = (0..speeds.len()).flat_map(|row| columns.entries.iter().map(move |c| c[row]));
    let labels = speeds.iter().flat_map(|speed| {
        let names = names.iter();
        names.map(move |name| format!("Y_{}_{name}", speed.name))
    });
    let rows = speeds.iter().map(|speed| speed.name.to_string()).collect();
    let count = Layout::List(names.len());
    let results = vec![
        Array::new("regressor", "Y.", layout, entries.collect())
            .labelled(labels)
            .with_names(rows, names.clone()),
        by_speed("rest", "rest", "r.", speeds, columns.rest),
        Array::new("parameters", "π.", count, columns.values)
            .labelled(names.iter().map(|name| format!("pi_{name}")))
            .with_names(names.clone(), Vec::new()),
    ];
    let function = Function::new(FunctionKind::Regressor, results);
    let bodies = derivation.bodies.clone();
    let function = derivation.explained(mechanism, function, &bodies);
    let own = derivation.own_symbols(FunctionKind::Regressor);
    let mut arguments = function_arguments(&derivation, &info);
    arguments.parameters.truncate(info.parameter_len());
    let program = Program {
        info,
        systems: Vec::new(),
        file: mechanism.file.clone(),
        arguments,
        dependent: derivation.positions.dependent,
        hints: Arc::default(),
        functions: vec![function.over(Arc::new(derivation.algebra.graph), own)],
    };
    Ok(Regressor {
        program,
        parameters: columns.parameters,
        without_effect: columns.without_effect,
    })
}

/// The inertial parameters of a body as parameters of a mechanism.
struct GeneralBody {
    body: BodyId,
    /// Their reference point.
    about: PointId,
    mass: ParameterId,
    /// Centre of mass from that point; `None` for bodies that only rotate or have no inertia.
    centre: Option<[ParameterId; 3]>,
    /// By [`PAIRS`].
    inertia: Option<[ParameterId; 6]>,
}

/// The mechanism with a parameter for each inertial parameter.
fn with_general_bodies(mechanism: &Mechanism) -> (Mechanism, Vec<GeneralBody>) {
    let mut general = mechanism.clone();
    let mut bodies = Vec::with_capacity(mechanism.bodies.len());
    for (id, body) in mechanism.bodies.entries() {
        let mut parameter = |symbol: &str| {
            // Names in a spec have no parentheses.
            let name = format!("{symbol}({})", body.name);
            general.parameters.push(unknown(name))
        };
        let mass = parameter("m");
        let inertia = body.inertia.as_ref();
        let inertia =
            inertia.map(|_| PAIRS.map(|(i, j)| parameter(&format!("I{}{}", AXES[i], AXES[j]))));
        let has_centre = inertia.is_some() && body.has_place();
        let centre = has_centre.then(|| AXES.map(|axis| parameter(&format!("c{axis}"))));
        let about = point_in(mechanism, body);
        let made = &mut general.bodies[id];
        made.mass = quantity(mass);
        if let (Some(inertia), Some(all)) = (&mut made.inertia, inertia) {
            // With general inertia a spinning body is not symmetric about its axis.
            inertia.frame = body.frame.unwrap_or(inertia.frame);
            for (&parameter, (i, j)) in all.iter().zip(PAIRS) {
                inertia.matrix[i][j] = quantity(parameter);
                inertia.matrix[j][i] = quantity(parameter);
            }
            if let Some(centre) = centre {
                let frame = inertia.frame;
                made.centre = general.points.push(Point {
                    name: format!("c({})", body.name),
                    about: String::new(),
                    from: Some(about),
                    frame,
                    at: centre.map(quantity),
                    line: body.line,
                    span: body.span.clone(),
                });
            }
        }
        bodies.push(GeneralBody {
            body: id,
            about,
            mass,
            centre,
            inertia,
        });
    }
    (general, bodies)
}

/// The reference point of a body's inertial parameters: the one from which its centre is placed, if both are
/// body-fixed, such as the joint of a link; otherwise its centre.
fn point_in(mechanism: &Mechanism, body: &Body) -> PointId {
    let centre = &mechanism.points[body.centre];
    let is_fixed = || {
        let mut fixed = body.frame == Some(centre.frame);
        for expr in &centre.at {
            expr.visit(&mut |quantity| {
                fixed &= matches!(quantity, Quantity::Parameter(_) | Quantity::Pi);
            });
        }
        fixed
    };
    match centre.from {
        Some(from) if body.inertia.is_some() && is_fixed() => from,
        _ => body.centre,
    }
}

fn quantity(parameter: ParameterId) -> SpecExpr {
    SpecExpr {
        kind: ExprKind::Quantity(Quantity::Parameter(parameter)),
        span: 0..0,
    }
}

/// A parameter of unknown value and sign.
fn unknown(name: String) -> Parameter {
    Parameter {
        label: Label {
            name,
            about: String::new(),
            unit: Unit::si(Dimension::NONE),
            line: 0,
            span: 0..0,
        },
        value: 1.0,
        at_least: None,
        at_most: None,
        std: None,
    }
}

impl Linear {
    fn new(name: &str, dimension: Dimension) -> Self {
        Self {
            name: name.to_owned(),
            unit: Unit::si(dimension).text,
        }
    }
}

/// Columns of Y, with their parameters.
#[derive(Default)]
struct Columns {
    parameters: Vec<Linear>,
    without_effect: Vec<String>,
    entries: Vec<Vec<Expr>>,
    /// Values of π in terms of the parameters of the spec.
    values: Vec<Expr>,
    /// r.
    rest: Vec<Expr>,
}

impl Columns {
    /// Adds a column unless it is zero; returns whether it did.
    fn push(
        &mut self,
        derivation: &mut Derivation,
        parameter: Linear,
        entries: Vec<Expr>,
        value: Expr,
    ) -> bool {
        let algebra = &mut derivation.algebra;
        let entries: Vec<Expr> = entries
            .into_iter()
            .map(|e| algebra.unless_zero(e))
            .collect();
        if entries.iter().any(|&entry| entry != Graph::ZERO) {
            self.parameters.push(parameter);
            self.entries.push(entries);
            self.values.push(value);
            return true;
        }
        self.without_effect.push(parameter.name);
        false
    }
}

impl Derivation {
    /// Y, π and r of a mechanism with general bodies.
    fn columns(&mut self, mechanism: &Mechanism, bodies: &[GeneralBody]) -> Outcome<Columns> {
        let demand = self.demand();
        let symbol = |derivation: &Self, id: ParameterId| derivation.symbols.parameters[id.index()];
        let centres: Vec<Expr> = (bodies.iter())
            .flat_map(|body| body.centre.into_iter().flatten())
            .map(|id| symbol(self, id))
            .collect();
        let mut central = Substitution::by_zero(&self.algebra.graph, &centres);
        let about_points = self.algebra.apply(&mut central, &demand)?;
        let mut columns = Columns::default();
        for body in bodies {
            let name = &mechanism.bodies[body.body].name;
            let [mass, moments, inertia] = self.inertial_values(mechanism, body)?;
            let m = symbol(self, body.mass);
            let entries = self.slopes(&about_points, &[m]);
            let linear = Linear::new(&format!("m_{name}"), Dimension::MASS);
            columns.push(self, linear, entries, mass[0]);
            for (axis, id) in body.centre.into_iter().flatten().enumerate() {
                let by_centre = self.slopes(&demand, &[symbol(self, id)]);
                let by_centre = self.algebra.apply(&mut central, &by_centre)?;
                let entries = self.slopes(&by_centre, &[m]);
                let name = format!("m{}_{name}", AXES[axis]);
                let linear = Linear::new(&name, Dimension::integers([1, 1, 0, 0, 0, 0, 0]));
                columns.push(self, linear, entries, moments[axis]);
            }
            for (place, id) in body.inertia.into_iter().flatten().enumerate() {
                let (i, j) = PAIRS[place];
                let entries = self.slopes(&about_points, &[symbol(self, id)]);
                let name = format!("I{}{}_{name}", AXES[i], AXES[j]);
                let linear = Linear::new(&name, Dimension::INERTIA);
                columns.push(self, linear, entries, inertia[place]);
            }
        }
        let inertial: Vec<Expr> = self.symbols.parameters[mechanism.parameters.len()..].to_vec();
        let mut massless = Substitution::by_zero(&self.algebra.graph, &inertial);
        let loads = self.algebra.apply(&mut massless, &about_points)?;
        let linear = self.linear_parameters(mechanism, &about_points, &inertial, &mut columns);
        let mut without = Substitution::by_zero(&self.algebra.graph, &linear);
        columns.rest = self.algebra.apply(&mut without, &loads)?;
        Ok(columns)
    }

    /// Adds the load parameters that enter linearly in addition to inertial and earlier load parameters;
    /// returns these.
    fn linear_parameters(
        &mut self,
        mechanism: &Mechanism,
        demand: &[Expr],
        inertial: &[Expr],
        columns: &mut Columns,
    ) -> Vec<Expr> {
        let mut linear: Vec<Expr> = Vec::new();
        let mut slopes_of_linear: Vec<Expr> = Vec::new();
        for (place, parameter) in mechanism.parameters.iter().enumerate() {
            let theta = self.symbols.parameters[place];
            let entries = self.slopes(demand, &[theta]);
            let graph = &self.algebra.graph;
            let others = [inertial, &linear, &[theta]].concat();
            let mentioned = |exprs: &[Expr], symbols: &[Expr]| {
                let symbols = ids(graph, symbols);
                exprs.iter().any(|&entry| graph.mentions(entry, &symbols))
            };
            if mentioned(&entries, &others) || mentioned(&slopes_of_linear, &[theta]) {
                continue;
            }
            let Label { name, unit, .. } = &parameter.label;
            let own = Linear::new(name, unit.dimension);
            // A parameter without effect on these forces may have one elsewhere.
            let is_felt = entries.iter().any(|&entry| entry != Graph::ZERO);
            if is_felt && columns.push(self, own, entries.clone(), theta) {
                linear.push(theta);
                slopes_of_linear.extend(entries);
            }
        }
        linear
    }

    /// Mass, first moments, moments and products of inertia of a body in terms of the parameters of the spec.
    fn inertial_values(
        &mut self,
        mechanism: &Mechanism,
        body: &GeneralBody,
    ) -> Outcome<[Vec<Expr>; 3]> {
        let (item, known) = (Item::Body(body.body), &mechanism.bodies[body.body]);
        let setting = Setting::free(mechanism, &self.symbols);
        let graph = &mut self.algebra.graph;
        let mass = setting.lower_in(graph, item, &known.mass)?;
        let c = if body.about == known.centre {
            vector::ZERO
        } else {
            let at = &mechanism.points[known.centre].at;
            setting.lower_all_in(graph, item, at)?
        };
        let moments = graph.scale3(mass, c);
        let mut inertia = Vec::new();
        if let Some(central) = &known.inertia {
            let square = graph.dot(c, moments);
            for (i, j) in PAIRS {
                let own = setting.lower_in(graph, item, &central.matrix[i][j])?;
                let product = graph.mul(c[i], moments[j]);
                let spread = if i == j { square } else { Graph::ZERO };
                let steiner = graph.sub(spread, product);
                inertia.push(graph.add(own, steiner));
            }
        }
        Ok([vec![mass], moments.to_vec(), inertia])
    }
}
