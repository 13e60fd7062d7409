//! The text that is compiled for the mechanisms of the papers.
//!
//! `cargo insta review` shows and accepts changes.

#![allow(clippy::unwrap_used, reason = "what is missing fails the test")]

use appell_models::Shipped;
use appell_tests::shipped;

const MECHANISMS: [&str; 3] = ["unicycle", "euc_3dof", "euc_2dof"];

#[test]
fn emitted_code_is_the_reviewed_one() {
    for name in MECHANISMS {
        let code = Shipped::find(name).unwrap().code;
        insta::assert_snapshot!(format!("emitted_{name}"), code);
    }
}

#[test]
fn emitted_code_names_its_spec_and_no_place_of_the_machine() {
    for model in appell_models::ALL {
        assert!(
            model
                .code
                .contains(&format!("mechanisms/{}.toml", model.name)),
            "{}",
            model.name
        );
        let root = shipped::workspace();
        assert!(
            !model.code.contains(&*root.to_string_lossy()),
            "{}",
            model.name
        );
        assert_eq!(model.spec, shipped::text(model.name));
    }
}
