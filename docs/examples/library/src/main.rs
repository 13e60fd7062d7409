//! From a spec to a motion, steady motions, gains and a diagnosis, without the command line.

mod rig;

use appell::control::Request;
use appell::steady::{Answer, Question};
use appell::{Model, Motion};

const SPEC: &str = include_str!("../../../../generated/mechanisms/pendulum.toml");

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = Model::from_spec(SPEC)?;

    let swing = Motion::new(2.0).set("l", "40cm").initial("theta", "30deg");
    let end = model.simulate(&swing)?.trajectory.last_state().to_vec();
    println!("swing: omega, theta = {end:?} after 2 s");

    if let Answer::Motions(motions) = model.steady(&Question::default().fix("theta", "180deg"))? {
        println!("upright: {:?}", motions[0].1.verdict);
    }

    let design = model.control(&Request::default().at("theta", "180deg").poles("-4"))?;
    let law = model.law(&design)?;
    let balanced = Motion::new(3.0).feedback(&law).initial("theta", "170deg");
    let end = model.simulate(&balanced)?.trajectory.last_state().to_vec();
    println!("balanced: omega, theta = {end:?} after 3 s");

    let recordings = model.recordings(&rig::record(&model)?)?;
    let report = appell::diagnose(&recordings, &appell::DiagnosisOptions::default(), |_| {})?;
    println!("the rig lacks: {:?}", report.which[0].effects);
    Ok(())
}
