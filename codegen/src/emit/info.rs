//! Emits `INFO`: names, units, defaults and tables of a model.

use appell_runtime::model::{Contact, Interpolation, ModelInfo, Quantity, Reaction, SignalTable};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

use super::layout::{blank_tokens, docs};
use super::syntax::{known, number};

/// `INFO` and its statics.
pub(super) fn info(info: &ModelInfo) -> TokenStream {
    let texts = info.constraint_rows.iter().map(|text| borrowed(text));
    let orders = info.signal_inputs.iter().map(|&(signal, order)| {
        let signal = Literal::usize_unsuffixed(signal);
        let order = Literal::u8_unsuffixed(order);
        quote!((#signal, #order))
    });
    let quantities = [
        ("STATES", "Pseudo-velocities and coordinates.", &info.states),
        ("INPUTS", "Inputs and signals.", &info.inputs),
        ("PARAMETERS", "Parameters.", &info.parameters),
        ("OUTPUTS", "Outputs.", &info.outputs),
    ];
    let quantities = quantities.map(|(name, about, all)| {
        let entries = all.iter().map(quantity);
        list(name, about, &quote!(model::Quantity), entries)
    });
    let statics = [
        list(
            "SIGNALS",
            "Tabulated functions of time.",
            &quote!(model::SignalTable),
            info.signals.iter().map(signal),
        ),
        list(
            "SIGNAL_INPUTS",
            "Signal and order of derivative behind the inputs that are signals.",
            &quote!((usize, u8)),
            orders,
        ),
        list(
            "CONSTRAINT_ROWS",
            "Constraint rows.",
            &quote!(model::Text),
            texts,
        ),
        list(
            "REACTIONS",
            "Reactions in the ground.",
            &quote!(model::Reaction),
            info.reactions.iter().map(reaction),
        ),
        list(
            "CONTACTS",
            "Contacts, which can only push.",
            &quote!(model::Contact),
            info.contacts.iter().map(contact),
        ),
    ];
    let [name, title, source] = [&info.name, &info.title, &info.source].map(|text| borrowed(text));
    let [speeds, declared_inputs] =
        [info.speeds, info.declared_inputs].map(Literal::usize_unsuffixed);
    let explicit_time = info.explicit_time;
    let blank = blank_tokens();
    quote! {
        #(#quantities)*
        #(#statics)*
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

/// A static array.
fn list(
    name: &'static str,
    about: &str,
    entry: &TokenStream,
    entries: impl ExactSizeIterator<Item = TokenStream>,
) -> TokenStream {
    let name = known(name);
    let (blank, about) = (blank_tokens(), docs(&[about.to_owned()]));
    let count = Literal::usize_unsuffixed(entries.len());
    quote! {
        #blank
        #about
        static #name: [#entry; #count] = [#(#entries),*];
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

fn signal(signal: &SignalTable) -> TokenStream {
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
}
