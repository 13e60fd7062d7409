//! Loads: vector, frame, point of application, reaction, virtual power; the pseudo-forces of all of them.

use appell_codegen::mechanics::expressions::Setting;
use appell_codegen::mechanics::loads::{AppliedLoad, generalized_forces};
use appell_codegen::symbolic::{Expr, Graph};
use appell_spec::expr::{Expr as Spec, ExprKind, Quantity};
use appell_spec::mechanism::{
    BodyId, Connection, CoordinateId, FrameId, GROUND, Load, LoadKind, PointId, Spring,
};

use super::super::arrange::signed;
use super::super::{About, Block, Equation, Letter, Math, Section, Span, Writer};
use super::energy::numbered;
use super::phrases::{
    equality, formula, headed, introduced, listed, math, sentence, with, with_formulas, words,
};
use super::placement::{from_to, lowered};

/// `F_drive = [0, u, 0] tilted at A, −F_drive at G; δP_drive = F_drive · (δv_A − δv_G)`
pub(super) fn statement(w: &mut Writer<'_>, load: &Load) -> Vec<Span> {
    let (mut what, power) = match &load.kind {
        LoadKind::Gravity { down, acceleration } => gravity(w, load, *down, acceleration),
        LoadKind::Force {
            on,
            body,
            reaction_on,
            frame,
            vector,
        } => force(w, load, *on, *body, *reaction_on, *frame, vector),
        LoadKind::Torque {
            on,
            reaction_on,
            frame,
            vector,
        } => torque(w, load, *on, *reaction_on, *frame, vector),
        LoadKind::SpringDamper {
            between,
            spring,
            damping,
        } => spring_damper(w, load, between, spring.as_ref(), damping.as_ref()),
        LoadKind::Generalized { velocity, force } => {
            let force = factor(w, force);
            match velocity.kind {
                ExprKind::Quantity(Quantity::Rate(q)) => along(w, load, q, force),
                _ => along_velocity(w, load, velocity, force),
            }
        }
    };
    what.push(words("; "));
    what.push(equality(virtual_power(load), power));
    what
}

/// `δP_drive`
pub(super) fn virtual_power(load: &Load) -> Math {
    Math::Letter(Letter::plain("P").before('δ').below(&load.name))
}

/// Statement of a load, and its virtual power.
type Said = (Vec<Span>, Math);

/// The weight of every body.
fn gravity(w: &mut Writer<'_>, load: &Load, down: [i8; 3], acceleration: &Spec) -> Said {
    let mechanism = w.mechanism;
    let (mut weights, mut power) = (Vec::new(), Vec::new());
    for body in &mechanism.bodies {
        let (mass, g) = (lowered(w, &body.mass), lowered(w, acceleration));
        let weight = w.graph().mul(mass, g);
        let vector = down.map(|c| w.graph().scale(&i64::from(c).into(), weight));
        let letter = match mechanism.bodies.len() {
            1 => Letter::bold("F").below(&load.name),
            _ => Letter::bold("F").below(&load.name).below(&body.name),
        };
        let centre = w.point(body.centre);
        weights.push(vec![
            equality(Math::Letter(letter.clone()), vector_in(w, vector, GROUND)),
            words(&format!(" at {centre}")),
        ]);
        power.push((false, dot(Math::Letter(letter), velocity(&centre))));
    }
    (listed(weights), Math::Sum(power))
}

fn force(
    w: &mut Writer<'_>,
    load: &Load,
    on: PointId,
    body: Option<BodyId>,
    reaction_on: Option<PointId>,
    frame: FrameId,
    vector: &[Spec; 3],
) -> Said {
    let letter = Math::Letter(Letter::bold("F").below(&load.name));
    let point = w.point(on);
    let mut what = vec![
        stated(w, &letter, vector, frame),
        words(&format!(" at {point}")),
    ];
    let mut v = velocity(&point);
    if let Some(body) = body {
        let body = &w.mechanism.bodies[body];
        what.push(words(&format!(", fixed in {}", body.name)));
        // The material point at the centre of mass moves with it.
        if body.centre != on {
            let lever = between(w, [body.centre, on]);
            let turning = Math::Row(vec![rotation(&body.name), Math::Sign("×"), lever]);
            v = Math::Sum(vec![
                (false, velocity(&w.point(body.centre))),
                (false, turning),
            ]);
        }
    }
    let mut motion = vec![(false, v)];
    if let Some(other) = reaction_on {
        let other = w.point(other);
        what.extend(reaction(&letter, &format!(" at {other}")));
        motion.push((true, velocity(&other)));
    }
    (what, dot(letter, Math::sum(motion)))
}

fn torque(
    w: &mut Writer<'_>,
    load: &Load,
    on: BodyId,
    reaction_on: Option<BodyId>,
    frame: FrameId,
    vector: &[Spec; 3],
) -> Said {
    let letter = Math::Letter(Letter::bold("T").below(&load.name));
    let bodies = &w.mechanism.bodies;
    let on = &bodies[on].name;
    let mut what = vec![
        stated(w, &letter, vector, frame),
        words(&format!(" on {on}")),
    ];
    let mut motion = vec![(false, rotation(on))];
    if let Some(other) = reaction_on {
        let other = &bodies[other].name;
        what.extend(reaction(&letter, &format!(" on {other}")));
        motion.push((true, rotation(other)));
    }
    (what, dot(letter, Math::sum(motion)))
}

/// A tension `k (s − relaxed) + c ṡ` against the growth of the displacement s, which is the distance of two points
/// `|r_AB|` with the rate `r_AB/|r_AB| · (v_B − v_A)`, a coordinate, or an angle.
fn spring_damper(
    w: &mut Writer<'_>,
    load: &Load,
    displacement: &Connection,
    spring: Option<&Spring>,
    damping: Option<&Spec>,
) -> Said {
    match displacement {
        &Connection::Points(a, b) => {
            let ends = [a, b];
            let mut tension = Vec::new();
            if let Some(Spring { stiffness, relaxed }) = spring {
                let relaxed = lowered(w, relaxed);
                let mut stretch = vec![(false, Math::Size(Box::new(between(w, ends))))];
                if relaxed != Graph::ZERO {
                    stretch.push((true, w.set(relaxed)));
                }
                tension.push(Math::product(vec![
                    factor(w, stiffness),
                    Math::sum(stretch),
                ]));
            }
            if let Some(damping) = damping {
                let [v_a, v_b] =
                    ends.map(|end| Math::Letter(Letter::bold("v").below(&w.point(end))));
                let relative = Math::Sum(vec![(false, v_b), (true, v_a)]);
                let rate = dot(direction(w, ends), relative);
                tension.push(Math::product(vec![factor(w, damping), rate]));
            }
            let tension = Math::sum(tension.into_iter().map(|part| (false, part)).collect());
            pulling(w, load, ends, tension)
        }
        Connection::Along(own) => {
            let place = lowered(w, own);
            let derivation = &mut *w.derivation;
            let free = Setting::free(w.mechanism, &derivation.symbols);
            let rate = free.rate(&mut derivation.algebra, place);
            let mut force = Vec::new();
            if let Some(Spring { stiffness, relaxed }) = spring {
                let stretch = difference(w, place, relaxed);
                force.push((true, Math::product(vec![factor(w, stiffness), stretch])));
            }
            if let Some(damping) = damping {
                let rate = w.set(rate);
                force.push((true, Math::product(vec![factor(w, damping), rate])));
            }
            let force = Math::Sum(force);
            match own.kind {
                ExprKind::Quantity(Quantity::Coordinate(q)) => along(w, load, q, force),
                _ => along_angle(w, load, place, rate, force),
            }
        }
    }
}

fn pulling(w: &Writer<'_>, load: &Load, ends: [PointId; 2], tension: Math) -> Said {
    let letter = Math::Letter(Letter::plain("F").below(&load.name));
    let [a, b] = ends.map(|end| w.point(end));
    let what = vec![
        words("tension "),
        equality(letter.clone(), tension),
        words(&format!(" between {a} and {b}")),
    ];
    let approach = Math::Sum(vec![(false, velocity(&a)), (true, velocity(&b))]);
    let pull = Math::Row(vec![letter, direction(w, ends)]);
    (what, dot(pull, approach))
}

/// A generalised force on a coordinate.
fn along(w: &mut Writer<'_>, load: &Load, q: CoordinateId, force: Math) -> Said {
    let symbols = &w.derivation.symbols;
    let [coordinate, rate] = [symbols.coordinates[q.index()], symbols.rates[q.index()]];
    let coordinate = Math::Letter(w.letter(coordinate));
    let rate = Math::Letter(w.letter(rate).before('δ'));
    let (letter, what) = acting(load, "F", force, " along ", coordinate);
    (what, Math::Row(vec![letter, rate]))
}

/// A generalised force on a pseudo-velocity, or on a combination of velocities.
fn along_velocity(w: &mut Writer<'_>, load: &Load, velocity: &Spec, force: Math) -> Said {
    let velocity = factor(w, velocity);
    let (letter, what) = acting(load, "F", force, " along ", velocity.clone());
    (what, Math::Row(vec![letter, velocity]))
}

/// A torque along an angle between two frames.
fn along_angle(w: &mut Writer<'_>, load: &Load, angle: Expr, rate: Expr, torque: Math) -> Said {
    let [angle, rate] = [angle, rate].map(|expr| w.set(expr));
    let (letter, what) = acting(load, "T", torque, " along the angle ", angle);
    (what, Math::product(vec![letter, rate]))
}

/// The letter of a load, and `F_drive = u along x`.
fn acting(load: &Load, base: &str, force: Math, how: &str, along: Math) -> (Math, Vec<Span>) {
    let letter = Math::Letter(Letter::plain(base).below(&load.name));
    let what = vec![equality(letter.clone(), force), words(how), math(along)];
    (letter, what)
}

/// `letter = [x, y, z] frame`
fn stated(w: &mut Writer<'_>, letter: &Math, vector: &[Spec; 3], frame: FrameId) -> Span {
    let [x, y, z] = vector;
    let components = [x, y, z].map(|c| lowered(w, c));
    equality(letter.clone(), vector_in(w, components, frame))
}

fn vector_in(w: &mut Writer<'_>, components: [Expr; 3], frame: FrameId) -> Math {
    Math::Vector {
        components: components.map(|c| w.set(c)).into(),
        frame: Some(w.frame(frame)),
        column: false,
    }
}

/// `, −F at G`
fn reaction(letter: &Math, place: &str) -> [Span; 3] {
    let opposite = Math::Sum(vec![(true, letter.clone())]);
    [words(", "), math(opposite), words(place)]
}

fn velocity(point: &str) -> Math {
    Math::Letter(Letter::bold("v").below(point).before('δ'))
}

fn rotation(body: &str) -> Math {
    Math::Letter(Letter::bold("ω").below(body).before('δ'))
}

/// `r_AB`
fn between(w: &Writer<'_>, [a, b]: [PointId; 2]) -> Math {
    Math::Letter(Letter::bold("r").below(&from_to(&w.point(a), &w.point(b))))
}

/// `r_AB/|r_AB|`
fn direction(w: &Writer<'_>, ends: [PointId; 2]) -> Math {
    let r = between(w, ends);
    Math::fraction(r.clone(), Math::Size(Box::new(r)))
}

fn dot(left: Math, right: Math) -> Math {
    let right = match right {
        sum @ Math::Sum(_) => Math::Brackets(Box::new(sum)),
        single => single,
    };
    Math::Row(vec![left, Math::Sign("·"), right])
}

/// An expression of the spec as a formula.
fn factor(w: &mut Writer<'_>, expr: &Spec) -> Math {
    let expr = lowered(w, expr);
    w.set(expr)
}

/// `place − relaxed`
fn difference(w: &mut Writer<'_>, place: Expr, relaxed: &Spec) -> Math {
    let relaxed = lowered(w, relaxed);
    let stretch = w.graph().sub(place, relaxed);
    w.set(stretch)
}

/// The virtual power of every load, and their sum.
pub(super) fn section(w: &mut Writer<'_>) -> Section {
    let mut blocks = load_by_load(w);
    let mut equations = Vec::new();
    for (i, force) in w.derivation.forces.clone().into_iter().enumerate() {
        let right = w.explicit(force);
        equations.push(Equation::new(numbered("Π", i), right).about(About::Force(i)));
    }
    blocks.extend(with(
        w,
        "The pseudo-forces are the coefficients of the virtual velocities:",
        equations,
    ));
    headed("Pseudo-forces Π", blocks)
}

fn load_by_load(w: &mut Writer<'_>) -> Vec<Block> {
    if w.derivation.loads.is_empty() {
        return vec![sentence("No load acts.")];
    }
    let mut blocks = vec![with_formulas(
        "The virtual power of the forces F and torques T is {}. Load by load:",
        [formula("δP = { Σ *F · δ*v } + { Σ *T · δ*ω } = Σ Π_i δω_i")],
    )];
    let applied = w.derivation.loads.clone();
    for (load, (id, item)) in applied.iter().zip(w.mechanism.loads.entries()) {
        let mut what = vec![introduced(&item.name, &item.about, item.line), words(": ")];
        what.extend(statement(w, item));
        what.push(words("."));
        blocks.extend(w.definitions());
        blocks.push(Block::Sentence(what));
        let power = power_of(w, load);
        let equation = Equation::new(virtual_power(item), power).about(About::Load(id));
        blocks.extend(with(w, "", vec![equation]));
    }
    blocks
}

/// `Σ Πᵢ δωᵢ` of one load.
fn power_of(w: &mut Writer<'_>, load: &AppliedLoad) -> Math {
    let speeds = w.derivation.symbols.speeds.clone();
    let load = std::slice::from_ref(load);
    let forces = generalized_forces(&mut w.derivation.algebra, load, &speeds);
    let mut terms = Vec::new();
    for (k, force) in forces.into_iter().enumerate() {
        if force == Graph::ZERO {
            continue;
        }
        let along = Math::Letter(w.speed(k).before('δ'));
        let (minus, force) = signed(w.explicit(force));
        let factors = if force.is_integer("1") {
            vec![along]
        } else {
            vec![force, along]
        };
        terms.push((minus, Math::product(factors)));
    }
    Math::sum(terms)
}
