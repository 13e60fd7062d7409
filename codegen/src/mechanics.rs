//! Derives the equations of motion of a mechanism by the Gibbs-Appell method.
//!
//! One file per stage, in the order of `equations`; those from `outputs.rs` on run when their result is requested.
//! Constraint rows need velocities with symbols for q̇, so `constraints.rs` calls `frames.rs` and `kinematics.rs`
//! before their turn.
//!
//! | file | from | to |
//! |---|---|---|
//! | `symbols.rs` | names | symbols of coordinates, rates, speeds, accelerations, inputs, signals |
//! | `expressions.rs` | expressions of the spec | expressions of the graph |
//! | `explicit.rs` | position constraints | coordinates that they give explicitly; only contacts use these |
//! | `constraints.rs`, `row.rs`, `ranges.rs` | constraints | scalar rows, linear in q̇; ranges of validity |
//! | `rank.rs`, `redundancy.rs` | rows | rows that follow from others and are omitted |
//! | `auxiliary.rs` | omitted rows | auxiliary motions that violate them; statically indeterminate reactions |
//! | `contacts.rs` | rolling and one-sided constraints | points, normals and friction of contacts |
//! | `positions.rs` | position constraints | f(q, t), ∂f/∂q, dependent coordinates |
//! | `elimination.rs` | rows, definitions of the pseudo-velocities | q̇(q, ω), and a system where no pivot is safe |
//! | `open_system.rs` | that system | its solution with pivoting, or quotients of symbols for display |
//! | `cramer.rs`, `relations.rs` | small systems | solutions by nonvanishing determinants; division-free relations |
//! | `quaternion.rs`, `rotation.rs`, `right_angles.rs` | rotations | R(e), ω, ė = ½ e ω; components in two frames |
//! | `frames.rs` | frames | composed rotations, angular velocities without differentiated matrices |
//! | `kinematics.rs` | points | velocities of points and of material points |
//! | `recursion/` | trees of many links | motions, M, b, Π, ω̇ by recursion over links, not by sums over bodies |
//! | `gibbs_appell.rs` | motions of the bodies | S, M, b |
//! | `loads.rs` | loads | Π from virtual power; potential energy, power |
//! | `dependent.rs`, `contact_rows.rs` | the system without a pivot | dependent speeds; M, b and Π without them |
//! | `given.rs` | prescribed rates of pseudo-velocities | M, b, Π with these rates; forces of the drives |
//! | `motion.rs`, `factorized.rs` | M, b, Π | ω̇ by blocks of M, eliminated or factorised |
//! | `initial.rs` | the equations | singularities at the initial state |
//! | `reactions.rs` | violated constraints | constraint forces by auxiliary pseudo-velocities |
//! | `reacting_loads.rs` | reactions without such loads | Π and ω̇ with loads that depend on reactions |
//! | `creep.rs` | reactions | q̇, M, b, Π of creeping contacts, to first order |
//! | `motions.rs`, `responses.rs` | names in a spec such as `speed(P)`, `force(spring)` | their values |
//! | `outputs.rs` | outputs, A, B | values and derivatives |
//! | `inverse.rs`, `regressor.rs` | M, b, Π, or the recursion | required forces for given ω̇; linear in the parameters |
//! | `linear.rs`, `linear_bound.rs` | M ω̇ = Π − b | A, B, P by implicit differentiation |
//! | `adjoint.rs` | ẋ, A, B, M, outputs | gradients of weighted sums of their entries |
//! | `prescribed.rs` | velocities, loads, ω̇ | power of prescribed motions |
//! | `switches.rs`, `systems.rs` | ẋ | switching functions; the systems that are solved with pivoting |
//! | `assemble.rs` | all of these | a [`Program`](crate::program::Program) |
//!
//! Used by all: `algebra.rs` (graph, identity test, shortest form), `time.rs` (derivatives along a motion), `divisors.rs`
//! (divisors that vanish identically), `finding.rs` (errors and warnings). For readers of emitted code: `glossary.rs`,
//! `hints.rs`, `letters.rs`, `info.rs`, `contributions.rs`.

mod adjoint;
pub mod algebra;
mod arguments;
pub mod assemble;
pub mod auxiliary;
pub mod constraints;
pub mod contact_rows;
pub mod contacts;
pub mod contributions;
pub mod cramer;
pub mod creep;
pub mod dependent;
pub mod divisors;
pub mod elimination;
mod equation_count;
pub(crate) mod explicit;
pub mod expressions;
pub mod factorized;
pub mod finding;
pub mod frames;
pub mod gibbs_appell;
pub mod given;
pub mod glossary;
mod hints;
mod info;
pub mod initial;
mod inverse;
pub mod kinematics;
mod letters;
pub mod linear;
pub mod linear_bound;
pub mod loads;
pub mod motion;
pub mod motions;
mod open_system;
mod outputs;
pub mod positions;
pub mod prescribed;
mod quaternion;
pub mod ranges;
pub mod rank;
mod reacting_loads;
pub mod reactions;
pub mod recursion;
pub mod redundancy;
mod regressor;
pub mod relations;
pub mod responses;
mod right_angles;
mod rotation;
pub mod row;
pub mod switches;
pub mod symbols;
pub mod systems;
pub mod time;

use appell_spec::Code;
use appell_spec::mechanism::{ConstraintKind, Mechanism};

use crate::symbolic::{Expr, Graph};
use algebra::Algebra;
use constraints::Constraints;
use contacts::Contact;
use dependent::DependentSpeeds;
use elimination::{Elimination, GeneralizedVelocities};
use expressions::Setting;
use finding::{Finding, Item, Outcome};
use gibbs_appell::{BodyMotion, GibbsForm};
use given::Given;
use initial::InitialState;
use kinematics::{Effort, Kinematics, RollingContact};
use loads::AppliedLoad;
use motion::Motion;
use positions::Positions;
use recursion::Recursion;
use row::Row;
use symbols::Symbols;

pub use algebra::seed;
pub use ranges::{declared_ranges, parameter_ranges};
pub use regressor::{Linear, Regressor, regressor};

/// The derivation of one mechanism, with all intermediate stages.
#[derive(Clone)]
pub struct Derivation {
    /// Graph and tools.
    pub algebra: Algebra,
    /// Symbols of the mechanism.
    pub symbols: Symbols,
    /// Constraint rows.
    pub constraints: Constraints,
    /// Unilateral contacts.
    pub contacts: Vec<Contact>,
    /// Position constraints.
    pub positions: Positions,
    /// q̇ in terms of the pseudo-velocities.
    pub velocities: GeneralizedVelocities,
    /// Generalised velocities without an explicit formula.
    pub dependent: DependentSpeeds,
    /// The unconstrained motion, before the dependent speeds, which come last, are eliminated.
    pub unbound: Unbound,
    /// Velocities of points and frames.
    pub kinematics: Kinematics,
    /// Motions of the bodies.
    pub bodies: Vec<BodyMotion>,
    /// M and b.
    pub gibbs: GibbsForm,
    /// Applied loads.
    pub loads: Vec<AppliedLoad>,
    /// Reactions that loads depend on: their symbols and values.
    pub reactions_in_loads: Vec<(Expr, Expr)>,
    /// Accelerations and forces that outputs name: their symbols, and values with symbols for ω̇.
    pub responses_in_outputs: Vec<(Expr, Expr)>,
    /// Π.
    pub forces: Vec<Expr>,
    /// Prescribed rates, already substituted in M, b and Π.
    pub given: Given,
    /// Solved equations, with ω̇.
    pub motion: Motion,
    /// q̇, named.
    pub coordinate_rates: Vec<Expr>,
    /// q̇ without creep, named.
    pub rolling_rates: Vec<Expr>,
    /// The tree of links, if the equations were derived by recursion.
    pub recursion: Option<Recursion>,
    /// Warnings and notes.
    pub warnings: Vec<Finding>,
}

/// The motion with the dependent speeds as independent ones, represented by their symbols.
#[derive(Debug, Clone)]
pub struct Unbound {
    /// Π.
    pub forces: Vec<Expr>,
    /// Motions of the bodies.
    pub bodies: Vec<BodyMotion>,
}

impl Derivation {
    /// q̇, M, b, Π and ω̇.
    fn all_equations(&self) -> Vec<Expr> {
        let mut all = self.gibbs.mass_matrix.concat();
        for vector in [&self.gibbs.bias, &self.forces, &self.coordinate_rates] {
            all.extend(vector);
        }
        all.extend(&self.motion.accelerations);
        all
    }
}

/// Derives the equations of motion of a mechanism. Errors include all divisors that vanish identically, besides
/// those of the stage that fails.
pub fn derive(mechanism: &Mechanism) -> Outcome<Derivation> {
    let mut findings = divisors::findings(mechanism);
    match equations(mechanism, false) {
        Ok(derivation) if findings.is_empty() => {
            if !divisors::holds_doubles(&derivation.algebra.graph, &derivation.all_equations()) {
                return Err(vec![divisors::beyond_double("the motion", Item::Mechanism)]);
            }
            Ok(derivation)
        }
        Ok(_) => Err(findings),
        Err(others) => {
            for other in others {
                let told = |f: &Finding| f.code == other.code && f.item == other.item;
                if !findings
                    .iter()
                    .any(|f| *f == other || told(f) && f.code == Code::DivisionByZero)
                {
                    findings.push(other);
                }
            }
            Err(findings)
        }
    }
}

/// The same equations for display: generalised velocities with sums as denominators remain symbols, as do their
/// partial derivatives.
pub fn derive_in_letters(mechanism: &Mechanism) -> Outcome<Derivation> {
    equations(mechanism, true)
}

fn equations(mechanism: &Mechanism, in_letters: bool) -> Outcome<Derivation> {
    let (mut derivation, all_loads) = without_reactions(mechanism, in_letters)?;
    derivation.let_all_loads_act(mechanism, all_loads)?;
    creep::let_contacts_creep(&mut derivation, mechanism)?;
    derivation.responses_in_outputs = derivation.named_in_outputs(mechanism)?;
    Ok(derivation)
}

/// The equations without the loads that depend on reactions and without creep; and all loads, with symbols for
/// reactions and for dependent speeds.
fn without_reactions(
    mechanism: &Mechanism,
    in_letters: bool,
) -> Outcome<(Derivation, Vec<AppliedLoad>)> {
    let mut graph = Graph::new();
    let symbols = Symbols::new(&mut graph, mechanism);
    let mut algebra = Algebra::new(graph, mechanism, &symbols);
    algebra.in_letters = in_letters;
    let free = Setting::free(mechanism, &symbols);
    algebra.given = explicit::given_coordinates(&mut algebra, free);
    let Bound {
        constraints,
        contacts,
        not_judged,
        positions,
        elimination,
    } = bound(&mut algebra, free)?;
    let directions = [symbols.speeds.as_slice(), &elimination.open.unknowns].concat();
    let Moving {
        mut kinematics,
        bodies,
        gibbs: unbound_gibbs,
        mut recursion,
    } = moving(&mut algebra, free, &constraints, &elimination)?;
    algebra.check_size()?;
    let setting = Setting::new(mechanism, &symbols, &elimination.rates);
    let mut loads = loads::applied_loads(&mut algebra, setting, &kinematics)?;
    let all_loads = loads.clone();
    loads::settle(&mut loads, &mut algebra.graph, mechanism, &[])?;
    let forces = match &mut recursion {
        Some(tree) => tree.forces(&mut algebra, mechanism, &loads, &directions),
        None => loads::generalized_forces(&mut algebra, &loads, &directions),
    };
    let unbound = Unbound { forces, bodies };
    let (dependent, velocities) = DependentSpeeds::new(
        &mut algebra,
        free,
        &constraints,
        elimination,
        &kinematics,
        &unbound.bodies,
    )?;
    algebra.check_size()?;
    let mut actual = dependent.actual(&algebra.graph);
    kinematics.replace(&mut algebra.graph, &mut actual)?;
    loads::replace(&mut loads, &mut algebra.graph, &mut actual)?;
    let bodies = dependent.reduced_bodies(&mut algebra, unbound.bodies.clone())?;
    let mut gibbs = dependent.reduced(&mut algebra, mechanism, &unbound_gibbs)?;
    let forces = algebra.apply(&mut actual, &unbound.forces)?;
    let mut forces = dependent.along_allowed(&mut algebra.graph, &forces);
    let setting = Setting::new(mechanism, &symbols, &velocities.rates);
    let mut given = Given::of(&mut algebra, setting)?;
    if !dependent.values.is_empty() {
        given.refuse_beside("velocities that a system with pivoting tells")?;
    }
    given.put_into(&mut algebra.graph, &mut gibbs);
    given.put_into_forces(&mut forces);
    recursion = recursion.filter(|_| given.is_empty());
    let motion = solved(
        &mut algebra,
        mechanism,
        recursion.as_mut(),
        &mut gibbs,
        &forces,
        &bodies,
        &dependent,
    )?;
    algebra.check_size()?;
    let rolling_rates = named_rates(&mut algebra.graph, mechanism, &velocities.rates);
    let told = [constraints.warnings.clone(), positions.warnings.clone()];
    let mut warnings = [told.concat(), not_judged].concat();
    let state = InitialState::new(&algebra.graph, mechanism, &symbols);
    let lengths = initial::vanishing_lengths(&mut algebra, mechanism, &kinematics, &state);
    warnings.extend(lengths);
    let (graph, rates) = (&algebra.graph, &velocities.rates);
    let singular = initial::singularities(graph, mechanism, rates, &motion, &state);
    warnings.extend(singular);
    let derivation = Derivation {
        algebra,
        symbols,
        constraints,
        contacts,
        positions,
        velocities,
        dependent,
        unbound,
        kinematics,
        bodies,
        gibbs,
        loads,
        reactions_in_loads: Vec::new(),
        responses_in_outputs: Vec::new(),
        forces,
        given,
        motion,
        coordinate_rates: rolling_rates.clone(),
        rolling_rates,
        recursion,
        warnings,
    };
    Ok((derivation, all_loads))
}

/// The constraints of the motion.
struct Bound {
    constraints: Constraints,
    contacts: Vec<Contact>,
    /// Contacts whose normal is unknown.
    not_judged: Vec<Finding>,
    positions: Positions,
    elimination: Elimination,
}

/// Constraints, and the generalised velocities that satisfy them.
fn bound(algebra: &mut Algebra, free: Setting<'_>) -> Outcome<Bound> {
    let mut intervals = declared_ranges(&algebra.graph, free.mechanism, free.symbols);
    let unknown = Kinematics::new(algebra, free, &[], Effort::Plain)?;
    let constraints = constraints::constraints(algebra, free, &unknown, &mut intervals)?;
    let (contacts, not_judged) = contacts::contacts(algebra, free, &constraints)?;
    let positions = Positions::new(algebra, free, &unknown, &mut intervals)?;
    algebra.check_size()?;
    Ok(Bound {
        elimination: elimination::eliminate(algebra, free, &constraints, &mut intervals)?,
        constraints,
        contacts,
        not_judged,
        positions,
    })
}

/// ω̇ by recursion if there is a tree of links, otherwise from M, b and Π.
fn solved(
    algebra: &mut Algebra,
    mechanism: &Mechanism,
    tree: Option<&mut Recursion>,
    gibbs: &mut GibbsForm,
    forces: &[Expr],
    bodies: &[BodyMotion],
    dependent: &DependentSpeeds,
) -> Outcome<Motion> {
    if let Some(tree) = tree {
        return tree.solve(algebra, mechanism, gibbs);
    }
    let parts = gibbs_appell::named_parts(&mut algebra.graph, bodies);
    gibbs.write_out_what_cancels(algebra, &parts);
    motion::solve(algebra, mechanism, gibbs, forces, &parts, dependent.way())
}

/// Motions of the bodies, and the resulting M and b.
struct Moving {
    kinematics: Kinematics,
    bodies: Vec<BodyMotion>,
    gibbs: GibbsForm,
    recursion: Option<Recursion>,
}

/// By recursion over links where that is shorter, otherwise by summation over bodies.
fn moving(
    algebra: &mut Algebra,
    free: Setting<'_>,
    constraints: &Constraints,
    elimination: &Elimination,
) -> Outcome<Moving> {
    let setting = Setting {
        rates: &elimination.rates,
        ..free
    };
    if elimination.open.unknowns.is_empty()
        && let Some((kinematics, tree)) = Recursion::new(algebra, setting)?
    {
        algebra.check_size()?;
        return Ok(Moving {
            bodies: tree.bodies(algebra, setting, &kinematics)?,
            gibbs: tree.gibbs_form(algebra),
            kinematics,
            recursion: Some(tree),
        });
    }
    let directions = [free.symbols.speeds.as_slice(), &elimination.open.unknowns].concat();
    let rolling = rolling_contacts(free.mechanism, constraints, elimination);
    algebra.relations = relations::relations(algebra, &elimination.open);
    let kinematics = Kinematics::new(algebra, setting, &[], Effort::Shortest(&rolling))?;
    let bodies = gibbs_appell::body_motions(algebra, setting, &kinematics, &directions)?;
    algebra.relations.clear();
    algebra.check_size()?;
    Ok(Moving {
        gibbs: gibbs_appell::gibbs_form(algebra, &bodies, directions.len()),
        kinematics,
        bodies,
        recursion: None,
    })
}

/// The contacts all of whose rows hold identically in the pseudo-velocities, by a formula or by geometry.
fn rolling_contacts(
    mechanism: &Mechanism,
    constraints: &Constraints,
    elimination: &Elimination,
) -> Vec<RollingContact> {
    let solved = |place: usize, row: &Row| {
        row.is_embedded() || row.is_active() && !elimination.open.rows.contains(&Some(place))
    };
    let holds = |id| {
        let mut rows = constraints.rows.iter().enumerate();
        rows.all(|(place, row)| row.constraint != id || solved(place, row))
    };
    let contacts = mechanism.constraints.entries();
    contacts
        .filter_map(|(id, constraint)| match constraint.kind {
            // On a moving surface the contact is not at rest.
            ConstraintKind::Rolling {
                body,
                contact,
                on: None,
                ..
            } => holds(id).then_some(RollingContact {
                body,
                point: contact,
            }),
            _ => None,
        })
        .collect()
}

/// q̇, named after the coordinates.
fn named_rates(graph: &mut Graph, mechanism: &Mechanism, rates: &[Expr]) -> Vec<Expr> {
    let coordinates = mechanism.coordinates.iter().zip(rates);
    coordinates
        .map(|(q, &rate)| graph.name(&format!("{}_dot", q.label.name), rate))
        .collect()
}
