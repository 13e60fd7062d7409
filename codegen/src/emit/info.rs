//! Emits `INFO`: names, units, defaults and tables of a model.

use appell_runtime::model::{Contact, Interpolation, ModelInfo, Quantity, Reaction};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::layout::{blank_tokens, docs};
use super::syntax::{known, number};

/// `INFO` and its statics.
pub(super) fn info(info: &ModelInfo) -> TokenStream {
    let quantities = |name: &'static str, about: &str, list: &[Quantity]| {
        let name = known(name);
        let about = docs(&[about.to_owned()]);
        let blank = blank_tokens();
        let count = Literal::usize_unsuffixed(list.len());
        let entries = list.iter().map(quantity);
        quote! {
            #blank
            #about
            static #name: [model::Quantity; #count] = [#(#entries),*];
        }
    };
    let states = quantities("STATES", "Pseudo-velocities and coordinates.", &info.states);
    let inputs = quantities("INPUTS", "Inputs and signals.", &info.inputs);
    let parameters = quantities("PARAMETERS", "Parameters.", &info.parameters);
    let outputs = quantities("OUTPUTS", "Outputs.", &info.outputs);
    let signals = signals(info);
    let [name, title, source] = [&info.name, &info.title, &info.source].map(|text| borrowed(text));
    let [speeds, declared_inputs] =
        [info.speeds, info.declared_inputs].map(Literal::usize_unsuffixed);
    let texts = |list: &[std::borrow::Cow<'static, str>]| {
        let texts = list.iter().map(|text| borrowed(text));
        quote!([#(#texts),*])
    };
    let rows = texts(&info.constraint_rows);
    let reactions = info.reactions.iter().map(reaction);
    let [row_count, reaction_count] =
        [info.constraint_rows.len(), info.reactions.len()].map(Literal::usize_unsuffixed);
    let contacts = info.contacts.iter().map(contact);
    let contact_count = Literal::usize_unsuffixed(info.contacts.len());
    let orders = info.signal_inputs.iter().map(|&(signal, order)| {
        let (signal, order) = (
            Literal::usize_unsuffixed(signal),
            Literal::u8_unsuffixed(order),
        );
        quote!((#signal, #order))
    });
    let order_count = Literal::usize_unsuffixed(info.signal_inputs.len());
    let explicit_time = info.explicit_time;
    let blank = blank_tokens();
    quote! {
        #states
        #inputs
        #parameters
        #outputs
        #signals
        #blank
        /// Signal and order of derivative behind the inputs that are signals.
        static SIGNAL_INPUTS: [(usize, u8); #order_count] = [#(#orders),*];
        #blank
        /// Constraint rows.
        static CONSTRAINT_ROWS: [model::Text; #row_count] = #rows;
        #blank
        /// Reactions in the ground.
        static REACTIONS: [model::Reaction; #reaction_count] = [#(#reactions),*];
        #blank
        /// Contacts, which can only push.
        static CONTACTS: [model::Contact; #contact_count] = [#(#contacts),*];
        #blank
        /// Names, units and sizes of the model.
        pub static INFO: model::ModelInfo = model::ModelInfo {
            name: #name,
            title: #title,
            source: #source,
            states: model::List::Borrowed(&STATES),
            speeds: #speeds,
            inputs: model::List::Borrowed(&INPUTS),
            declared_inputs: #declared_inputs,
            signals: model::List::Borrowed(&SIGNALS),
            signal_inputs: model::List::Borrowed(&SIGNAL_INPUTS),
            parameters: model::List::Borrowed(&PARAMETERS),
            outputs: model::List::Borrowed(&OUTPUTS),
            constraint_rows: model::List::Borrowed(&CONSTRAINT_ROWS),
            reactions: model::List::Borrowed(&REACTIONS),
            contacts: model::List::Borrowed(&CONTACTS),
            explicit_time: #explicit_time,
        };
    }
}

/// A reaction.
fn reaction(reaction: &Reaction) -> TokenStream {
    let [name, unit] = [&reaction.name, &reaction.unit].map(|text| borrowed(text));
    if reaction.on_point {
        quote!(model::Reaction::on_point(#name))
    } else {
        quote!(model::Reaction::multiplier(#name, #unit))
    }
}

/// A contact.
fn contact(contact: &Contact) -> TokenStream {
    let (name, grips) = (borrowed(&contact.name), contact.grips);
    let reaction = Literal::usize_unsuffixed(contact.reaction);
    let normal = contact.normal.map(number);
    let friction = contact.friction.map(number);
    let friction = friction.map_or_else(|| quote!(None), |friction| quote!(Some(#friction)));
    quote! {
        model::Contact {
            name: #name,
            reaction: #reaction,
            normal: [#(#normal),*],
            grips: #grips,
            friction: #friction,
        }
    }
}

/// A quantity, in short form where defaults apply.
fn quantity(quantity: &Quantity) -> TokenStream {
    let Quantity {
        name,
        about,
        unit,
        scale,
        value,
        range: [low, high],
    } = quantity;
    let [name, about, unit]: [&str; 3] = [name, about, unit];
    let scaled = (scale.to_bits() != 1.0_f64.to_bits()).then(|| {
        let scale = number(*scale);
        quote!(.scaled(#scale))
    });
    let valued = (value.to_bits() != 0).then(|| {
        let value = number(*value);
        quote!(.valued(#value))
    });
    let within = (low.is_finite() || high.is_finite()).then(|| {
        let [low, high] = [*low, *high].map(number);
        quote!(.within(#low, #high))
    });
    quote!(model::Quantity::new(#name, #about, #unit) #scaled #valued #within)
}

fn borrowed(text: &str) -> TokenStream {
    quote!(model::Text::Borrowed(#text))
}

fn signals(info: &ModelInfo) -> TokenStream {
    let count = Literal::usize_unsuffixed(info.signals.len());
    let blank = blank_tokens();
    let tables = info.signals.iter().map(|signal| {
        let name = borrowed(&signal.name);
        let times = signal.times.iter().map(|&time| number(time));
        let values = signal.values.iter().map(|&value| number(value));
        let interpolation = known(match signal.interpolation {
            Interpolation::Hold => "Hold",
            Interpolation::Linear => "Linear",
            Interpolation::Cubic => "Cubic",
        });
        quote! {
            model::SignalTable {
                name: #name,
                times: model::List::Borrowed(&[#(#times),*]),
                values: model::List::Borrowed(&[#(#values),*]),
                interpolation: model::Interpolation::#interpolation,
            }
        }
    });
    quote! {
        #blank
        /// Tabulated functions of time.
        static SIGNALS: [model::SignalTable; #count] = [#(#tables),*];
    }
}
