//! Recordings reach the estimation core with the indices and values of their channels.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use std::fmt::Write as _;

use appell_estimate::Measured;
use appell_models::Shipped;
use appell_recordings::{Part, Spec, read_bare};

#[test]
fn columns_of_a_recording_become_those_of_the_model() {
    let shipped = Shipped::find("cart_pole").unwrap();
    let info = shipped.model.info();
    let mut text = "x_G,theta,t,omega,F\n".to_owned();
    for row in 0..40 {
        let theta = if row == 3 { "" } else { "0.5" };
        writeln!(text, "{row},{theta},{},-2,7", f64::from(row) * 0.1).unwrap();
    }
    let path = std::path::Path::new(env!("CARGO_TARGET_TMPDIR")).join("columns_of_a_recording.csv");
    std::fs::write(&path, text).unwrap();
    let spec = Spec {
        file: shipped.file.to_owned(),
        text: shipped.spec.to_owned(),
    };
    let set = read_bare(spec, &[path.clone(), path]).unwrap();
    let shown: Vec<Measured> = set.measured(info).into_iter().map(|(_, m)| m).collect();
    let state = |name| Measured::State(info.state_index(name).unwrap());
    let output = Measured::Output(info.output_index("x_G").unwrap());
    assert_eq!(shown, [output, state("theta"), state("omega")]);
    let recordings = set.recordings(Part::Fit, info).unwrap();
    assert_eq!(recordings.len(), 1);
    assert_eq!(recordings[0].inputs(5), [7.0]);
    assert_eq!(recordings[0].measured(5), [5.0, 0.5, -2.0]);
    assert!(recordings[0].measured(3)[1].is_nan());
}
