//! A model as an FMU of FMI 3.0, for model exchange and co-simulation: its source texts. Compilation and
//! packing are done elsewhere.
//!
//! - `variables.rs`: names, value references, units;
//! - `inputs.rs`: inputs within a step of co-simulation;
//! - `structure.rs`: dependencies between variables;
//! - `description.rs`: `modelDescription.xml` and `buildDescription.xml`;
//! - `tables.rs`: the numbers of a model in C;
//! - `xml.rs`: elements, with all texts escaped;
//! - `c/`: code common to all models, in C99.

mod description;
mod inputs;
mod structure;
mod tables;
mod units;
mod variables;
mod xml;

use crate::c::{self, Real, adapted};
use crate::program::{FunctionKind, Program};
pub use inputs::InputsOfStep;
use variables::Variables;

/// The source file to compile in addition to the equations.
const FUNCTIONS: &str = "fmi-functions.c";
/// C code common to all models. No mechanism has such a name.
const TEMPLATES: [(&str, &str); 5] = [
    ("fmi-absent.h", include_str!("fmu/c/fmi-absent.h")),
    ("fmi-derivatives.h", include_str!("fmu/c/fmi-derivatives.h")),
    (FUNCTIONS, include_str!("fmu/c/fmi-functions.c")),
    ("fmi-motion.h", include_str!("fmu/c/fmi-motion.h")),
    ("fmi-types.h", include_str!("fmu/c/fmi-types.h")),
];

/// The texts of an FMU.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Emitted {
    /// The model identifier, a name in C.
    pub name: String,
    /// `modelDescription.xml`.
    pub model_description: String,
    /// `sources/buildDescription.xml`.
    pub build_description: String,
    /// Names and texts of the other files of `sources`.
    pub sources: Vec<(String, String)>,
    /// Those to be compiled.
    pub compiled: [String; 2],
}

/// The functions that a program needs for an FMU.
pub fn functions() -> [FunctionKind; 7] {
    adapted()
}

/// The texts of an FMU. Equal programs have equal texts.
pub fn emit(program: &Program, inputs: InputsOfStep) -> Emitted {
    let equations = c::emit(
        program,
        &c::Options {
            functions: functions().to_vec(),
            real: Real::Double,
            integrator: false,
        },
    );
    let name = equations.name;
    let variables = Variables::of(program);
    let tables = tables::tables(program, &variables, &name, inputs);
    let mut sources: Vec<(String, String)> = TEMPLATES
        .iter()
        .map(|(name, text)| ((*name).to_owned(), (*text).to_owned()))
        .collect();
    sources.push((format!("{name}.h"), equations.header));
    sources.push((format!("{name}.c"), equations.source));
    let describe = |token: &str| description::model(program, &variables, &name, token);
    let texts = sources.iter().map(|(_, text)| text.as_str());
    let token = token(texts.chain([tables.as_str(), &describe("")]));
    sources.push((
        "fmi-equations.h".to_owned(),
        tables.replace(tables::TOKEN, &token),
    ));
    sources.sort();
    let compiled = [FUNCTIONS.to_owned(), format!("{name}.c")];
    Emitted {
        model_description: describe(&token),
        build_description: description::build(&name, &compiled),
        name,
        sources,
        compiled,
    }
}

/// An identifier of these texts: FNV-1a of 128 bits.
fn token<'t>(texts: impl Iterator<Item = &'t str>) -> String {
    const START: u128 = 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d;
    const PRIME: u128 = 0x0000_0000_0100_0000_0000_0000_0000_013b;
    let step = |hash: u128, byte: u8| (hash ^ u128::from(byte)).wrapping_mul(PRIME);
    // A zero terminates each text.
    let bytes = texts.flat_map(|text| text.bytes().chain([0]));
    format!("{{{:032x}}}", bytes.fold(START, step))
}
