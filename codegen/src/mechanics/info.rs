//! Metadata of a model: its quantities with their units, its constraints and contacts.

use appell_runtime::model::{Contact, Interpolation, List, ModelInfo, Quantity, SignalTable};
use appell_spec::mechanism::{self, Label, Mechanism, Signal, SignalId};

use super::Derivation;
use super::initial::InitialState;

/// Signals with their derivatives that may occur in equations.
pub(super) fn tabulated_inputs(mechanism: &Mechanism) -> Vec<(usize, u8)> {
    let orders = |signal: &Signal| 0..=signal.interpolation.derivatives();
    let signals = mechanism.signals.iter().enumerate();
    signals
        .flat_map(|(index, signal)| orders(signal).map(move |order| (index, order)))
        .collect()
}

/// Names, units and sizes of the model, including the inputs for signals.
pub(super) fn info(
    derivation: &Derivation,
    mechanism: &Mechanism,
    signals: &[(usize, u8)],
) -> ModelInfo {
    let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
    let speeds = mechanism
        .pseudo_velocities
        .iter()
        .map(|w| quantity(&w.label, w.initial, everywhere));
    let coordinates = mechanism
        .coordinates
        .iter()
        .map(|q| quantity(&q.label, q.initial, q.range.unwrap_or(everywhere)));
    let declared = mechanism
        .inputs
        .iter()
        .map(|u| quantity(&u.label, 0.0, everywhere));
    let tabulated = signals.iter().map(|&(signal, order)| {
        let mut input = quantity(
            &mechanism.signals[SignalId::new(signal)].label,
            0.0,
            everywhere,
        );
        if order > 0 {
            input.name = mechanism::Interpolation::derivative_name(&input.name, order).into();
            input.unit = format!("({})/s^{order}", input.unit).into();
        }
        input
    });
    let parameters = mechanism.parameters.iter().map(|p| {
        let range = [
            p.at_least.unwrap_or(f64::NEG_INFINITY),
            p.at_most.unwrap_or(f64::INFINITY),
        ];
        quantity(&p.label, p.value, range)
    });
    let rows = derivation
        .constraints
        .rows
        .iter()
        .filter(|r| !r.is_embedded());
    ModelInfo {
        name: mechanism.name.clone().into(),
        title: mechanism.title.clone().into(),
        source: mechanism.source.clone().unwrap_or_default().into(),
        states: speeds.chain(coordinates).collect(),
        speeds: mechanism.pseudo_velocities.len(),
        inputs: declared.chain(tabulated).collect(),
        declared_inputs: mechanism.inputs.len(),
        signals: mechanism.signals.iter().map(signal_table).collect(),
        signal_inputs: signals.to_vec().into(),
        parameters: parameters.collect(),
        outputs: mechanism
            .outputs
            .iter()
            .map(|y| quantity(&y.label, 0.0, everywhere))
            .collect(),
        constraint_rows: rows.map(|r| r.name.clone().into()).collect(),
        reactions: derivation.constraints.reactions.clone().into(),
        contacts: contacts(derivation, mechanism),
        explicit_time: false,
    }
}

/// The contacts at the initial state.
fn contacts(derivation: &Derivation, mechanism: &Mechanism) -> List<Contact> {
    let graph = &derivation.algebra.graph;
    let state = InitialState::new(graph, mechanism, &derivation.symbols);
    let contact = |contact: &super::contacts::Contact| {
        let normal = state.of(graph, &contact.normal);
        Contact {
            name: derivation.constraints.reactions[contact.place].name.clone(),
            reaction: contact.place,
            normal: [normal[0], normal[1], normal[2]],
            grips: contact.grips,
            friction: contact
                .friction
                .map(|friction| state.of(graph, &[friction])[0]),
        }
    };
    derivation.contacts.iter().map(contact).collect()
}

fn quantity(label: &Label, value: f64, range: [f64; 2]) -> Quantity {
    Quantity {
        name: label.name.clone().into(),
        about: label.about.clone().into(),
        unit: label.unit.text.clone().into(),
        scale: label.unit.scale,
        value,
        range,
    }
}

fn signal_table(signal: &Signal) -> SignalTable {
    SignalTable {
        name: signal.label.name.clone().into(),
        times: signal.times.clone().into(),
        values: signal.values.clone().into(),
        interpolation: match signal.interpolation {
            mechanism::Interpolation::Hold => Interpolation::Hold,
            mechanism::Interpolation::Linear => Interpolation::Linear,
            mechanism::Interpolation::Cubic => Interpolation::Cubic,
        },
    }
}
