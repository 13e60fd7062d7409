//! Laws about motions that advance.

use appell::control::Request;
use appell::setup::Assignment;
use appell::{Class, Model};

#[test]
fn a_law_about_an_advancing_motion_settles() {
    let model = Model::shipped("carriage").unwrap();
    let request = Request::default().at("v", "1m/s").poles("-3,-4");
    let design = model.control(&request).unwrap();
    let position = model.info().state_index("x").unwrap();
    assert!(design.outputs.contains(&position));
    assert!((design.running(position) - 1.0).abs() < 1e-12);

    let explored = model.attraction(&design, "x=-1..1/2", 5.0, &|_, _| {});
    let explored = explored.unwrap();
    let fates = &explored.to_json()["fates"];
    assert_eq!(fates, &serde_json::json!(["settled", "settled", "settled"]));
}

#[test]
fn each_design_of_a_schedule_is_about_its_own_steady_motion() {
    let model = Model::shipped("unicycle").unwrap();
    let request = Request::default().at("omega_2", "2[m/s]/R").poles("-3");
    let over = Assignment::new("R", "0.2..0.4/4");
    let schedule = model.schedule(&request, &over).unwrap();
    let spin = model.info().state_index("omega_2").unwrap();
    for (radius, design) in &schedule.designs {
        assert!(
            (design.x[spin] * radius - 2.0).abs() < 1e-12,
            "R = {radius}"
        );
    }
    assert!(
        model
            .scheduled_law(&schedule)
            .unwrap()
            .contains("over = \"R\"")
    );
}

#[test]
fn there_is_no_law_without_gains() {
    let model = Model::shipped("cart_pole").unwrap();
    let design = model.control(&Request::default()).unwrap();
    assert_eq!(model.law(&design).unwrap_err().class(), Class::Request);
    let over = Assignment::new("l", "0.3..0.6/3");
    let schedule = model.schedule(&Request::default(), &over).unwrap();
    assert!(model.scheduled_law(&schedule).is_err());
}
