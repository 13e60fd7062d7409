//! `modelDescription.xml` and `buildDescription.xml`.

use appell_runtime::model::Quantity;

use super::structure::structure;
use super::tables::DEFAULT_TOLERANCE;
use super::units::Units;
use super::variables::Variables;
use super::xml::Element;
use crate::program::Program;

const VERSION: &str = "3.0";

/// `modelDescription.xml`.
pub(super) fn model(program: &Program, variables: &Variables, name: &str, token: &str) -> String {
    let info = &program.info;
    let mut units = Units::default();
    let described = described(program, variables, &mut units);
    let kind = |element: &'static str| {
        Element::new(element)
            .with("modelIdentifier", name)
            .with("canGetAndSetFMUState", true)
            .with("canSerializeFMUState", true)
            .with("providesDirectionalDerivatives", true)
            .with("providesAdjointDerivatives", true)
    };
    let category = |name: &str, about: &str| {
        let category = Element::new("Category");
        category.with("name", name).with("description", about)
    };
    let has_switches = variables.end > variables.switches;
    let mut log = vec![category("logStatusError", "Why a call has failed")];
    if has_switches {
        let about = "Where the integration of co-simulation can be wrong";
        log.push(category("logStatusWarning", about));
    }
    Element::new("fmiModelDescription")
        .with("fmiVersion", VERSION)
        .with("modelName", &info.name)
        .with("instantiationToken", token)
        .with("description", &info.title)
        .with(
            "generationTool",
            concat!("appell ", env!("CARGO_PKG_VERSION")),
        )
        .with("variableNamingConvention", "structured")
        .holding([
            kind("ModelExchange")
                .maybe("needsCompletedIntegratorStep", has_switches.then_some(true)),
            kind("CoSimulation").with("canHandleVariableCommunicationStepSize", true),
            units.element(),
            Element::new("LogCategories").holding(log),
            Element::new("DefaultExperiment")
                .with("startTime", 0)
                .with("stopTime", 10)
                .with("tolerance", number(DEFAULT_TOLERANCE)),
            Element::new("ModelVariables").holding(described),
            structure(program, variables),
        ])
        .document()
}

/// `buildDescription.xml`.
pub(super) fn build(name: &str, compiled: &[String]) -> String {
    let files = (compiled.iter()).map(|file| Element::new("SourceFile").with("name", file));
    let set = Element::new("SourceFileSet").with("language", "C99");
    let library = Element::new("Library")
        .with("name", "m")
        .with("external", true)
        .with("description", "The mathematical functions of C");
    let configuration = Element::new("BuildConfiguration")
        .with("modelIdentifier", name)
        .holding([set.holding(files), library]);
    Element::new("fmiBuildDescription")
        .with("fmiVersion", VERSION)
        .holding([configuration])
        .document()
}

/// A number in XML notation.
fn number(value: f64) -> String {
    format!("{value:?}")
}

/// All variables in the order of their value references.
fn described(program: &Program, variables: &Variables, units: &mut Units) -> Vec<Element> {
    let info = &program.info;
    let mut all = vec![
        variable(variables.time, Variables::TIME)
            .with("description", "time")
            .varying("independent")
            .with("unit", units.of_time()),
    ];
    for ((k, parameter), fixed) in info.parameters.iter().enumerate().zip(&variables.fixed) {
        let variability = if *fixed { "fixed" } else { "tunable" };
        all.push(
            quantity(parameter, variables.parameters + k, units)
                .with("causality", "parameter")
                .with("variability", variability)
                .with("start", number(parameter.value)),
        );
    }
    let inputs = &info.inputs[..info.declared_inputs];
    all.extend(inputs.iter().enumerate().map(|(k, input)| {
        quantity(input, variables.inputs + k, units)
            .varying("input")
            .with("start", number(0.0))
    }));
    all.extend(info.states.iter().enumerate().map(|(k, state)| {
        let dependent =
            (k.checked_sub(info.speeds)).is_some_and(|q| program.dependent.contains(&q));
        quantity(state, variables.states + k, units)
            .varying("output")
            .with("initial", if dependent { "approx" } else { "exact" })
            .with("start", number(state.value))
    }));
    all.extend(info.states.iter().enumerate().map(|(k, state)| {
        variable(&format!("der({})", state.name), variables.rates + k)
            .with("description", format!("rate of {}", state.name))
            .varying("local")
            .with("initial", "calculated")
            .maybe("unit", units.of_rate(state))
            .with("derivative", variables.states + k)
    }));
    all.extend(info.outputs.iter().enumerate().map(|(k, output)| {
        quantity(output, variables.outputs + k, units)
            .varying("output")
            .with("initial", "calculated")
    }));
    all.extend((variables.switches..variables.end).map(|reference| {
        let name = format!("switch[{}]", reference - variables.switches + 1);
        let about =
            "event indicator: negative where time has switched the equations since the last event";
        variable(&name, reference)
            .with("description", about)
            .varying("local")
            .with("initial", "calculated")
    }));
    all
}

fn variable(name: &str, reference: usize) -> Element {
    Element::new("Float64")
        .with("name", name)
        .with("valueReference", reference)
}

impl Element {
    /// Adds the causality of a variable that varies continuously.
    fn varying(self, causality: &'static str) -> Self {
        self.with("causality", causality)
            .with("variability", "continuous")
    }
}

/// A quantity of the spec, with its range.
fn quantity(quantity: &Quantity, reference: usize, units: &mut Units) -> Element {
    let [least, most] = quantity
        .range
        .map(|end| end.is_finite().then(|| number(end)));
    let (unit, shown) = units.of(quantity).unzip();
    let about = (!quantity.about.is_empty()).then_some(&quantity.about);
    variable(&quantity.name, reference)
        .maybe("description", about)
        .maybe("unit", unit)
        .maybe("displayUnit", shown.flatten())
        .maybe("min", least)
        .maybe("max", most)
}
