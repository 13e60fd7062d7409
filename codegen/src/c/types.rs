//! The structs of a model in C, and the signatures of its functions.

use std::fmt::Write as _;

use appell_runtime::model::Quantity;
use appell_spec::foreign::sentence;

use super::{Real, is_empty};
use crate::program::{Array, Function, Layout, Own, Program, Space};
use crate::schedule::names::{ArgumentNames, identifier};
use crate::tape::{Argument, Tape};
use crate::text::{self, Notation, Vectors, shape, type_name};

/// Names of types, fields and arguments.
pub(super) struct Types<'a> {
    pub(super) program: &'a Program,
    pub(super) real: Real,
    vectors: Vectors,
    /// Prefix of all names in the header.
    pub(super) prefix: String,
    /// Prefix of types.
    type_prefix: String,
}

/// The vectors among the arguments of all functions: names of their structs, and of arrays that have them.
pub(super) const GROUPS: [(Space, &str, &str); 3] = [
    (Space::Parameters, "parameters", "p"),
    (Space::State, "state", "x"),
    (Space::Inputs, "inputs", "u"),
];

impl<'a> Types<'a> {
    pub(super) fn new(program: &'a Program, real: Real) -> Self {
        let prefix = identifier(&program.info.name).to_ascii_lowercase();
        let words = prefix.split('_').filter(|word| !word.is_empty());
        let type_prefix = words
            .map(|word| word[..1].to_ascii_uppercase() + &word[1..])
            .collect();
        Self {
            program,
            real,
            vectors: Vectors::of(program),
            prefix,
            type_prefix,
        }
    }

    pub(super) fn names(&self) -> &ArgumentNames {
        &self.vectors.names
    }

    /// The local of an argument, with the name of its field.
    pub(super) fn local(&self, argument: Argument) -> String {
        Notation::name(&self.real, self.names().get(argument))
    }

    /// Arguments of functions, in the order of [`GROUPS`], with names different from all quantities.
    pub(super) fn groups(&self) -> [String; 3] {
        GROUPS.map(|(_, name, _)| self.names().free(name))
    }

    /// Name of an additional argument of a function.
    pub(super) fn own(&self, own: Own) -> String {
        self.names().free(own.name())
    }

    pub(super) fn type_name(&self, space: Space) -> String {
        format!("{}{}", self.type_prefix, type_name(space))
    }

    /// Fields of a vector.
    pub(super) fn fields(&self, space: Space) -> Vec<String> {
        let fields = self.vectors.entries(space).iter();
        fields
            .map(|field| Notation::name(&self.real, field))
            .collect()
    }

    fn structure(&self, space: Space, about: &str) -> String {
        let name = self.type_name(space);
        let quantities = space.quantities(&self.program.info);
        let mut text = format!("/* {about} */\ntypedef struct {{\n");
        let fields = self.fields(space);
        if fields.is_empty() {
            text.push_str("    char none; /* a struct needs a member */\n");
        }
        for (index, field) in fields.iter().enumerate() {
            let told = quantities.get(index).map(|quantity| told(quantity, space));
            let _ = writeln!(
                text,
                "    {} {field};{}",
                self.real.name(),
                told.unwrap_or_default()
            );
        }
        let _ = write!(text, "}} {name};\n\n");
        text
    }

    /// The signature of a function.
    pub(super) fn signature(&self, function: &Function) -> String {
        let real = self.real.name();
        let mut arguments = vec![format!("{real} {}", self.local(Argument::Time))];
        for ((space, ..), name) in GROUPS.into_iter().zip(self.groups()) {
            arguments.push(format!("const {} *{name}", self.type_name(space)));
        }
        if let Some(own) = function.kind.takes() {
            let type_name = match own {
                Own::Weights | Own::OutputWeights => real.to_owned(),
                Own::Accelerations => self.type_name(Space::Accelerations),
            };
            arguments.push(format!("const {type_name} *{}", self.own(own)));
        }
        for array in &function.results {
            if is_empty(self.program, array) {
                continue;
            }
            let to = self.result(function, array);
            let shape = shape(self.program, array.layout);
            arguments.push(match (array.layout, shape.as_slice()) {
                (Layout::Vector(space), _) => format!("{} *{to}", self.type_name(space)),
                (_, [_, columns]) => format!("{real} {to}[][{columns}]"),
                (_, [count]) => format!("{real} {to}[{count}]"),
                _ => format!("{real} *{to}"),
            });
        }
        format!(
            "void {}_{}(\n    {}\n)",
            self.prefix,
            function.kind.name(),
            arguments.join(",\n    ")
        )
    }

    /// The parameter for an array of results.
    pub(super) fn result(&self, function: &Function, array: &Array) -> String {
        let mut name = format!("to_{}", identifier(&array.name));
        let others = function
            .results
            .iter()
            .filter(|other| other.name != array.name);
        let others: Vec<String> = others
            .map(|other| format!("to_{}", identifier(&other.name)))
            .collect();
        while self.names().iter().any(|other| *other == name) || others.contains(&name) {
            name.push('_');
        }
        name
    }

    /// Arguments that a function does not use.
    pub(super) fn unused(&self, tape: &Tape) -> Vec<String> {
        let used = tape.arguments();
        let groups = text::GROUPS.into_iter().map(|(_, like)| like);
        let all = std::iter::once((Argument::Time, self.local(Argument::Time)))
            .chain(groups.zip(self.groups()));
        let unused = all.filter(|(like, _)| !used.iter().any(|argument| argument.is_like(*like)));
        unused.map(|(_, name)| name).collect()
    }

    /// Values of the spec.
    pub(super) fn values(&self) -> String {
        let info = &self.program.info;
        let lists = [
            (
                Space::Parameters,
                "default_parameters",
                info.default_parameters(),
            ),
            (Space::State, "initial_state", info.initial_state()),
        ];
        let mut text = String::new();
        for (space, name, values) in lists {
            let _ = writeln!(
                text,
                "const {} {}_{name} = {{",
                self.type_name(space),
                self.prefix
            );
            for (field, value) in self.fields(space).iter().zip(values) {
                let _ = writeln!(text, "    {}, /* {field} */", self.real.literal(value));
            }
            if self.fields(space).is_empty() {
                text.push_str("    0,\n");
            }
            text.push_str("};\n\n");
        }
        text
    }

    /// The header around the prototypes.
    pub(super) fn header(&self, heading: &str, prototypes: &str, integrator: bool) -> String {
        let guard = format!("{}_H", self.prefix.to_ascii_uppercase());
        let mut text = format!(
            "/* {heading}\n *\n * All quantities are in SI; units in brackets are those of the spec.\n */\n\
             #ifndef {guard}\n#define {guard}\n\n#ifdef __cplusplus\nextern \"C\" {{\n#endif\n\n"
        );
        text += &self.structures();
        let _ = write!(
            text,
            "/* The values of the spec. */\nextern const {} {p}_default_parameters;\n\
             extern const {} {p}_initial_state;\n\n",
            self.type_name(Space::Parameters),
            self.type_name(Space::State),
            p = self.prefix
        );
        text.push_str(prototypes);
        if integrator {
            let _ = write!(
                text,
                "/* A step of length dt of the classical Runge-Kutta method, with constant inputs. */\n{};\n\n",
                self.step()
            );
        }
        text + "#ifdef __cplusplus\n}\n#endif\n\n#endif\n"
    }

    /// The structs of arguments and results.
    pub(super) fn structures(&self) -> String {
        let mut text = String::new();
        for (space, about) in [
            (Space::Parameters, "Parameters p."),
            (
                Space::State,
                "State x: pseudo-velocities, then coordinates.",
            ),
            (Space::Inputs, "Inputs u."),
            (
                Space::Rates,
                "Rates of the state: pseudo-accelerations, then generalised velocities.",
            ),
            (Space::Accelerations, "Pseudo-accelerations."),
            (Space::CoordinateRates, "Generalised velocities."),
            (
                Space::GeneralizedForces,
                "Pseudo-forces: power per pseudo-velocity.",
            ),
            (
                Space::ConstraintRows,
                "What the constraint rows are off by.",
            ),
            (Space::Outputs, "Outputs y."),
        ] {
            text.push_str(&self.structure(space, about));
        }
        text
    }

    fn step(&self) -> String {
        format!(
            "void {}_step(\n    {real} t,\n    {real} dt,\n    const {} *p,\n    {} *x,\n    const {} *u\n)",
            self.prefix,
            self.type_name(Space::Parameters),
            self.type_name(Space::State),
            self.type_name(Space::Inputs),
            real = self.real.name()
        )
    }

    /// The Runge-Kutta step.
    pub(super) fn integrator(&self) -> String {
        STEP.replace("SIGNATURE", &self.step())
            .replace("COUNT", &self.names().states.len().to_string())
            .replace("PREFIX", &self.prefix)
            .replace("STATE", &self.type_name(Space::State))
            .replace("RATES", &self.type_name(Space::Rates))
            .replace("REAL", self.real.name())
    }
}

/// States and rates are structs with the same number of members.
const STEP: &str = "\
SIGNATURE {
    const REAL part[4] = {0, (REAL)0.5, (REAL)0.5, 1};
    const REAL weight[4] = {1, 2, 2, 1};
    REAL start[COUNT], at[COUNT], k[COUNT], sum[COUNT];
    STATE state;
    RATES rates;
    int stage, i;
    memcpy(start, x, sizeof start);
    memset(sum, 0, sizeof sum);
    memset(k, 0, sizeof k);
    for (stage = 0; stage < 4; stage++) {
        for (i = 0; i < COUNT; i++) {
            at[i] = start[i] + part[stage] * dt * k[i];
        }
        memcpy(&state, at, sizeof state);
        PREFIX_rates(t + part[stage] * dt, p, &state, u, &rates);
        memcpy(k, &rates, sizeof k);
        for (i = 0; i < COUNT; i++) {
            sum[i] += weight[stage] * k[i];
        }
    }
    for (i = 0; i < COUNT; i++) {
        at[i] = start[i] + dt / 6 * sum[i];
    }
    memcpy(x, at, sizeof at);
}
";

/// Description of a field, with the unit of the spec.
fn told(quantity: &Quantity, space: Space) -> String {
    let about = match space {
        Space::Rates | Space::Accelerations | Space::CoordinateRates => {
            format!("rate of {}", quantity.name)
        }
        Space::GeneralizedForces => format!("for {}", quantity.name),
        _ => format!("{} [{}]", quantity.about, quantity.unit),
    };
    format!(" /* {} */", sentence(&about))
}
