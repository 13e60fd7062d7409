//! Laws about motions that advance.

use appell::Model;
use appell::control::{Request, attraction};

#[test]
fn a_law_about_an_advancing_motion_settles() {
    let model = Model::shipped("carriage").unwrap();
    let request = Request::default().at("v", "1m/s").poles("-3,-4");
    let design = model.control(&request).unwrap();
    let position = model.info().state_index("x").unwrap();
    assert!(design.outputs.contains(&position));
    assert!((design.running(position) - 1.0).abs() < 1e-12);

    let setup = model.setup().unwrap();
    let grid = "x=-1..1/2";
    let explored =
        attraction::explore(model.equations(), &setup, &design, grid, 5.0, &|_, _| {}).unwrap();
    let fates = &explored.json()["fates"];
    assert_eq!(fates, &serde_json::json!(["settled", "settled", "settled"]));
}
