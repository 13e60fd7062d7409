//! The settings of the page: parameters, initial state and inputs, in the units of the spec.

use appell::{ModelInfo, Quantity};
use serde_json::{Value, json};

/// Upper end of the slider of a quantity without limits, as a multiple of its value.
const WIDE: f64 = 2.0;

/// The sliders of a model.
pub(crate) fn knobs(info: &ModelInfo) -> Value {
    let declared = &info.inputs[..info.declared_inputs];
    json!({
        // The derivation assumes the sign of a parameter unless its limits admit both.
        "parameters": all(&info.parameters, true),
        "initial": all(&info.states, false),
        "inputs": all(declared, false),
    })
}

fn all(quantities: &[Quantity], keeps_sign: bool) -> Vec<Value> {
    quantities.iter().map(|q| knob(q, keeps_sign)).collect()
}

fn knob(quantity: &Quantity, keeps_sign: bool) -> Value {
    let unit = |si: f64| si / quantity.scale;
    let value = unit(quantity.value);
    let [least, most] = quantity.range.map(unit);
    let [low, high] = reach(value, [least, most], &quantity.unit, keeps_sign);
    let limit = |limit: f64| limit.is_finite().then_some(limit);
    json!({
        "name": quantity.name,
        "about": quantity.about,
        "unit": quantity.unit,
        "value": value,
        "low": low,
        "high": high,
        "least": limit(least),
        "most": limit(most),
    })
}

/// Range of a slider: the limits where they are finite.
fn reach(value: f64, [least, most]: [f64; 2], unit: &str, keeps_sign: bool) -> [f64; 2] {
    let width = match unit {
        "rad" => std::f64::consts::PI,
        "deg" => 180.0,
        _ if value == 0.0 => 10.0,
        _ => WIDE * value.abs(),
    };
    let width = width.max(value.abs());
    let end = |limit: f64, side: f64, is_other_sign: bool| match limit {
        limit if limit.is_finite() => limit,
        _ if keeps_sign && is_other_sign => side * 0.0,
        _ => side * width,
    };
    let low = end(least, -1.0, value > 0.0);
    let high = end(most, 1.0, value < 0.0);
    // A limit may lie outside the range about the value.
    [low.min(value), high.max(value).max(low)]
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "products of two are exact")]
mod tests {
    use super::*;

    #[test]
    fn a_slider_goes_to_the_limits_or_around_its_value() {
        let everywhere = [f64::NEG_INFINITY, f64::INFINITY];
        let any = |value, limits, unit| reach(value, limits, unit, false);
        assert_eq!(any(3.0, [0.0, f64::INFINITY], "kg"), [0.0, 6.0]);
        assert_eq!(any(0.2, [-1.5, 1.5], "rad"), [-1.5, 1.5]);
        assert_eq!(any(0.0, everywhere, "m/s"), [-10.0, 10.0]);
        assert_eq!(any(-200.0, everywhere, "deg"), [-200.0, 200.0]);
        assert_eq!(any(50.0, [f64::NEG_INFINITY, 20.0], "m"), [-100.0, 50.0]);
        let kept = |value| reach(value, everywhere, "m", true);
        assert_eq!(kept(2.0), [0.0, 4.0]);
        assert_eq!(kept(-2.0), [-4.0, 0.0]);
        assert_eq!(kept(0.0), [-10.0, 10.0]);
    }
}
