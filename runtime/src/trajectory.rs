//! Trajectories: recorded motions.

use crate::condition::Conditions;
use crate::contact::ContactForces;
use crate::integrate::{Ending, EventHit, Statistics};
use crate::model::{At, Contact, Model, ModelInfo, Named, Quantity, Reaction, Row, Text};
use crate::simulate::Breach;
use std::io::{self, Write};

/// Columns recorded in addition to states and inputs.
// Independent switches.
#[allow(clippy::struct_excessive_bools)]
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Extras {
    /// The outputs of the spec.
    pub outputs: bool,
    /// `kinetic_energy`, `potential_energy` in J and the `power` of the other loads in W.
    pub energies: bool,
    /// `reaction_<name>_x`, `_y`, `_z` in the ground frame: the force on a point in N; of a constraint without a
    /// point its multiplier, in W per unit of the constraint, as `_x`.
    pub reactions: bool,
    /// `normal_force_<name>` of each contact, and where it could slip `tangential_force_<name>` and
    /// `friction_demand_<name>`, the ratio of tangential to normal force.
    pub contacts: bool,
    /// `condition_<name>` for each of [`Conditions::names`].
    pub conditions: bool,
    /// `residual_<name>` of each velocity constraint.
    pub residuals: bool,
}

impl Extras {
    /// All columns.
    pub const ALL: Self = Self {
        outputs: true,
        energies: true,
        reactions: true,
        contacts: true,
        conditions: true,
        residuals: true,
    };
}

/// A column with infinite or NaN values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct NotFinite {
    /// The column.
    pub column: usize,
    /// The first such row.
    pub first: usize,
    /// Number of rows with such a value.
    pub rows: usize,
}

/// Columns of [`Extras::energies`].
const ENERGIES: usize = 3;

/// Rows over time; each row contains the state, the inputs, and the selected extras. All in SI.
///
/// Column names are unique: a name that the spec does not define, such as the rate of a signal or an energy, gets a
/// numeric suffix if the spec uses it for another quantity.
#[derive(Debug, Clone, PartialEq)]
pub struct Trajectory {
    info: ModelInfo,
    parameters: Vec<f64>,
    times: Vec<f64>,
    extras: Extras,
    /// Names of the condition numbers.
    conditions: Vec<String>,
    columns: Vec<Quantity>,
    rows: Vec<f64>,
    /// Why the motion ended; `None` if it failed.
    pub ending: Option<Ending>,
    /// Events located.
    pub events: Vec<EventHit>,
    /// Violations of limits of the model, in the order of time. The last one ended a motion whose ending is
    /// [`Ending::Stopped`].
    pub breaches: Vec<Breach>,
    /// Statistics of the integration.
    pub statistics: Statistics,
}

impl Trajectory {
    /// Evaluates the columns of a motion given by its states, `times.len()` rows of n numbers.
    ///
    /// `fill_inputs(t, x, u)` writes all inputs of the model. The lengths of `states` and
    /// `parameters` are those of the model, or the model panics.
    pub fn evaluate(
        model: &dyn Model,
        parameters: &[f64],
        times: Vec<f64>,
        states: &[f64],
        fill_inputs: impl Fn(f64, &[f64], &mut [f64]),
        extras: Extras,
    ) -> Self {
        let info = model.info().clone();
        let conditions: Vec<String> = Conditions::names(model).collect();
        let columns = columns(&info, &conditions, extras);
        let mut forces = ContactForces::new();
        let n = info.state_len();
        let mut rows = Vec::with_capacity(times.len() * columns.len());
        let mut inputs = vec![0.0; info.input_len()];
        let mut outputs = vec![0.0; info.output_len()];
        let mut reactions = vec![0.0; 3 * info.reactions.len()];
        let mut residuals = vec![0.0; info.constraint_rows.len()];
        for (row, &t) in times.iter().enumerate() {
            let x = &states[row * n..][..n];
            fill_inputs(t, x, &mut inputs);
            let at = At {
                t,
                x,
                u: &inputs,
                p: parameters,
            };
            rows.extend_from_slice(x);
            rows.extend_from_slice(&inputs);
            if extras.outputs {
                model.outputs(at, &mut outputs);
                rows.extend_from_slice(&outputs);
            }
            if extras.energies {
                let energies = model.energies(at);
                rows.extend([energies.kinetic, energies.potential, energies.power]);
            }
            if extras.reactions || (extras.contacts && !info.contacts.is_empty()) {
                model.constraint_forces(at, &mut reactions);
            }
            if extras.reactions {
                rows.extend_from_slice(&reactions);
            }
            if extras.contacts {
                let forces = forces
                    .of(model, at, &reactions)
                    .iter()
                    .zip(info.contacts.iter());
                for (force, contact) in forces {
                    rows.push(force.normal);
                    if contact.grips {
                        rows.extend([force.tangential, force.demand()]);
                    }
                }
            }
            if extras.conditions {
                rows.extend(Conditions::of(model, at).iter());
            }
            if extras.residuals {
                model.constraint_residual(at, &mut residuals);
                rows.extend_from_slice(&residuals);
            }
        }
        Self {
            info,
            parameters: parameters.to_vec(),
            times,
            extras,
            conditions,
            columns,
            rows,
            ending: None,
            events: Vec::new(),
            breaches: Vec::new(),
            statistics: Statistics::default(),
        }
    }

    /// The inputs, outputs and energies with infinite or NaN values, as of an inverse cosine of 1.01: each with its
    /// column, the first such row and their number.
    pub fn not_finite(&self) -> Vec<NotFinite> {
        let info = &self.info;
        let outputs = usize::from(self.extras.outputs) * info.output_len();
        let energies = usize::from(self.extras.energies) * ENERGIES;
        let checked = info.state_len() + info.input_len() + outputs + energies;
        let of_column = |column: usize| {
            let bad = |row: &usize| !self.row(*row)[column].is_finite();
            let mut rows = (0..self.len()).filter(bad);
            let first = rows.next()?;
            let rows = 1 + rows.count();
            Some(NotFinite {
                column,
                first,
                rows,
            })
        };
        (0..checked).filter_map(of_column).collect()
    }

    /// The model.
    pub fn info(&self) -> &ModelInfo {
        &self.info
    }

    /// Columns recorded in addition to states and inputs.
    pub fn extras(&self) -> Extras {
        self.extras
    }

    /// The parameters, in SI.
    pub fn parameters(&self) -> &[f64] {
        &self.parameters
    }

    /// Names of the condition numbers, in the order of [`Conditions::names`].
    pub fn conditions(&self) -> &[String] {
        &self.conditions
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.times.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// Times in s, increasing.
    pub fn times(&self) -> &[f64] {
        &self.times
    }

    /// The columns without the time.
    pub fn columns(&self) -> &[Quantity] {
        &self.columns
    }

    /// All columns of a row.
    ///
    /// # Panics
    ///
    /// Like the other accessors of rows, if the row does not exist.
    pub fn row(&self, row: usize) -> &[f64] {
        &self.rows[row * self.columns.len()..][..self.columns.len()]
    }

    /// The state of a row.
    pub fn state(&self, row: usize) -> &[f64] {
        &self.row(row)[..self.info.state_len()]
    }

    /// The inputs of a row, including signals.
    pub fn inputs(&self, row: usize) -> &[f64] {
        &self.row(row)[self.info.state_len()..][..self.info.input_len()]
    }

    /// The constraint forces of a row, three components per reaction in the ground frame, if recorded.
    pub fn reactions(&self, row: usize) -> Option<&[f64]> {
        let Extras {
            outputs, energies, ..
        } = self.extras;
        let before = self.info.state_len()
            + self.info.input_len()
            + usize::from(outputs) * self.info.output_len()
            + usize::from(energies) * ENERGIES;
        let forces = || &self.row(row)[before..][..3 * self.info.reactions.len()];
        self.extras.reactions.then(forces)
    }

    /// The rows with the named entries of their model; `None` if the trajectory is that of another model.
    pub fn named<'a, M: Named>(
        &'a self,
        model: &'a M,
    ) -> Option<impl ExactSizeIterator<Item = Row<M>> + 'a> {
        let row = |row: usize| At {
            t: self.times[row],
            x: self.state(row),
            u: self.inputs(row),
            p: &self.parameters,
        };
        (*model.info() == self.info)
            .then(|| (0..self.len()).map(move |place| model.named(row(place))))
    }

    /// The state of the last row; empty without rows.
    pub fn last_state(&self) -> &[f64] {
        self.len().checked_sub(1).map_or(&[], |row| self.state(row))
    }

    /// Columns renamed because the spec uses the name: default name and actual name.
    pub fn renamed(&self) -> Vec<[Text; 2]> {
        let wanted = wanted_columns(&self.info, &self.conditions, self.extras);
        let pairs = wanted.iter().zip(&self.columns);
        pairs
            .map(|(wanted, column)| [wanted.name.clone(), column.name.clone()])
            .filter(|[wanted, name]| wanted != name)
            .collect()
    }

    /// Index of a column.
    pub fn column_index(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|column| column.name == name)
    }

    /// A column over time in SI.
    pub fn column(&self, name: &str) -> Option<Vec<f64>> {
        let index = self.column_index(name)?;
        Some((0..self.len()).map(|row| self.row(row)[index]).collect())
    }

    /// A column over time in its display unit.
    pub fn column_in_unit(&self, name: &str) -> Option<Vec<f64>> {
        let quantity = &self.columns[self.column_index(name)?];
        Some(
            self.column(name)?
                .into_iter()
                .map(|value| quantity.to_unit(value))
                .collect(),
        )
    }

    /// Writes a header row `t,<names>` and one row per time.
    ///
    /// Values are in the units of the spec, `t` in s. Numbers have the shortest form that parses to the same number;
    /// values that are not finite are written as `nan`. With [`CsvOptions::comments`] lines that begin with `#` and
    /// contain the mechanism, the parameters and the units precede the header.
    pub fn write_csv(&self, mut to: impl Write, options: CsvOptions) -> io::Result<()> {
        if options.comments {
            self.write_comments(&mut to)?;
        }
        write!(to, "t")?;
        for column in &self.columns {
            write!(to, ",{}", column.name)?;
        }
        writeln!(to)?;
        for (row, &t) in self.times.iter().enumerate() {
            write_number(&mut to, t)?;
            for (column, &value) in self.columns.iter().zip(self.row(row)) {
                write!(to, ",")?;
                write_number(&mut to, column.to_unit(value))?;
            }
            writeln!(to)?;
        }
        Ok(())
    }

    fn write_comments(&self, to: &mut impl Write) -> io::Result<()> {
        writeln!(to, "# mechanism: {}", self.info.name)?;
        write!(to, "# parameters:")?;
        for (i, (parameter, &value)) in self
            .info
            .parameters
            .iter()
            .zip(&self.parameters)
            .enumerate()
        {
            let separator = if i == 0 { "" } else { "," };
            write!(to, "{separator} {} = ", parameter.name)?;
            write_number(to, parameter.to_unit(value))?;
            if !parameter.unit.is_empty() {
                write!(to, " {}", parameter.unit)?;
            }
        }
        writeln!(to)?;
        write!(to, "# units: s")?;
        for column in &self.columns {
            write!(
                to,
                ", {}",
                if column.unit.is_empty() {
                    "1"
                } else {
                    &column.unit
                }
            )?;
        }
        writeln!(to)
    }
}

/// Options of the CSV format.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CsvOptions {
    /// Whether comment lines precede the header.
    pub comments: bool,
}

impl Default for CsvOptions {
    /// With comments, so that the file contains the units.
    fn default() -> Self {
        Self { comments: true }
    }
}

fn write_number(to: &mut impl Write, value: f64) -> io::Result<()> {
    if value.is_finite() {
        // `Debug` gives the shortest form that parses to the same number, with an exponent where that is shorter.
        write!(to, "{value:?}")
    } else {
        write!(to, "nan")
    }
}

/// The columns of a trajectory of a model, with unique names.
pub fn recorded(model: &dyn Model, extras: Extras) -> Vec<Quantity> {
    let conditions: Vec<String> = Conditions::names(model).collect();
    columns(model.info(), &conditions, extras)
}

/// The columns with unique names.
fn columns(info: &ModelInfo, conditions: &[String], extras: Extras) -> Vec<Quantity> {
    let mut columns = wanted_columns(info, conditions, extras);
    let spec = info.state_len() + info.declared_inputs;
    let signals = info.signal_inputs.iter().map(|(_, order)| *order == 0);
    let outputs = if extras.outputs { info.output_len() } else { 0 };
    let mut own = vec![true; spec];
    own.extend(signals);
    own.resize(own.len() + outputs, true);
    own.resize(columns.len(), false);
    for index in 0..columns.len() {
        let taken = |name: &str| {
            let others = columns.iter().enumerate();
            let mut rivals = others.filter(|&(other, _)| own[other] || other < index);
            rivals.any(|(_, rival)| rival.name == name)
        };
        let wanted = &columns[index].name;
        if !own[index] && taken(wanted) {
            let numbered = (2..).map(|number: u32| format!("{wanted}_{number}"));
            if let Some(free) = numbered.into_iter().find(|name| !taken(name)) {
                columns[index].name = free.into();
            }
        }
    }
    columns
}

/// The columns with default names, which may not be unique.
fn wanted_columns(info: &ModelInfo, conditions: &[String], extras: Extras) -> Vec<Quantity> {
    let mut columns = info.states.to_vec();
    columns.extend_from_slice(&info.inputs);
    if extras.outputs {
        columns.extend_from_slice(&info.outputs);
    }
    if extras.energies {
        columns.extend([
            si("kinetic_energy", "kinetic energy", "J"),
            si("potential_energy", "potential energy", "J"),
            si("power", "power of the loads without potential", "W"),
        ]);
    }
    if extras.reactions {
        for Reaction { name, unit, .. } in info.reactions.iter() {
            columns.extend(["x", "y", "z"].map(|axis| {
                let name = format!("reaction_{name}_{axis}");
                si(name, "reaction in the ground", unit.clone())
            }));
        }
    }
    if extras.contacts {
        for contact in info.contacts.iter() {
            columns.extend(contact_columns(info, contact));
        }
    }
    if extras.conditions {
        let name = |name| si(format!("condition_{name}"), "condition number", "");
        columns.extend(conditions.iter().map(name));
    }
    if extras.residuals {
        let name = |row| si(format!("residual_{row}"), "residual of the constraint", "");
        columns.extend(info.constraint_rows.iter().map(name));
    }
    columns
}

/// Columns of a contact, in the unit of its reaction.
fn contact_columns(info: &ModelInfo, contact: &Contact) -> impl Iterator<Item = Quantity> {
    let name = &contact.name;
    let reaction = info.reactions.get(contact.reaction);
    let unit = reaction.map_or(Text::default(), |reaction| reaction.unit.clone());
    let normal = si(
        format!("normal_force_{name}"),
        "push of the surface",
        unit.clone(),
    );
    let along = contact.grips.then(|| {
        [
            si(
                format!("tangential_force_{name}"),
                "size of the force along the surface",
                unit,
            ),
            si(
                format!("friction_demand_{name}"),
                "tangential force over normal force",
                "",
            ),
        ]
    });
    [normal].into_iter().chain(along.into_iter().flatten())
}

fn si(name: impl Into<Text>, about: &'static str, unit: impl Into<Text>) -> Quantity {
    Quantity {
        name: name.into(),
        about: about.into(),
        unit: unit.into(),
        scale: 1.0,
        value: 0.0,
        range: [f64::NEG_INFINITY, f64::INFINITY],
    }
}
