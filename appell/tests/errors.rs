//! Errors: typed, in the names of the request, with a class.

use std::path::Path;

use appell::control::Request;
use appell::steady::{Question, SteadyError};
use appell::{Class, Error, Field, Model, Motion, Source};

fn pendulum() -> Model {
    Model::shipped("pendulum").unwrap()
}

fn refused(motion: &Motion) -> Error {
    pendulum().simulate(motion).unwrap_err()
}

fn undesigned(request: &Request) -> Error {
    pendulum().control(request).unwrap_err()
}

#[test]
fn each_class_has_its_errors() {
    let unknown = Model::find("pendulumm").err().unwrap();
    assert_eq!(unknown.class(), Class::Request);
    assert_eq!(unknown.field(), Some(Field::Model));

    let missing = Model::from_file(Path::new("missing.toml")).err().unwrap();
    assert!(matches!(missing, Error::File { .. }));
    assert_eq!(missing.class(), Class::Data);

    let falling = Question::default().fix("theta", "30deg");
    let none = pendulum().steady(&falling).err().unwrap();
    assert!(matches!(none.cause(), Some(SteadyError::None { .. })));
    assert_eq!(none.class(), Class::Computation);

    let several = Error::Several(vec![unknown, none, missing]);
    assert_eq!(several.class(), Class::Computation);
}

#[test]
fn an_expression_is_shown_with_its_place() {
    let error = refused(&Motion::new(1.0).set("l", "1kg"));
    assert_eq!(error.field(), Some(Field::Set));
    assert!(error.to_string().contains("set l:1:1"), "{error}");
}

#[test]
fn no_error_names_a_flag() {
    let steady = |question: &Question| pendulum().steady(question).err().unwrap();
    let spec = Source::shipped("pendulum").unwrap().text;
    let errors = [
        refused(&Motion::new(-1.0)),
        refused(&Motion::new(1e9).set("g", "1").set("g", "2")),
        refused(&Motion::new(1.0).set("L", "1")),
        refused(&Motion::new(1.0).initial("theta", "1[kg]")),
        refused(&Motion::new(1.0).input("torque", "1/0")),
        undesigned(&Request::default().poles("-8+")),
        undesigned(&Request::default().poles("-1+i,-1")),
        undesigned(&Request::default().weights("Q=1")),
        undesigned(&Request::default().weights("Q=1,R=0")),
        undesigned(
            &Request::default()
                .at("theta", "30deg")
                .at("tau", "0")
                .poles("-1"),
        ),
        undesigned(&Request::default().outputs(&["theta"]).poles("-1")),
        steady(&Question::default().fix("thta", "0")),
        steady(&Question::default().along("theta", "0", "1kg")),
        Model::from_spec(&spec.replace("[parameters]", "[parameter]"))
            .err()
            .unwrap(),
    ];
    for error in errors {
        let text = error.to_string();
        let mut flags = text.split("--").skip(1);
        let is_flag = |rest: &str| rest.starts_with(|c: char| c.is_ascii_lowercase());
        assert!(!flags.any(is_flag), "{text}");
    }
}

#[test]
fn foreign_texts_in_errors_command_no_terminal() {
    let evil = "a\u{202e}\u{1b}[2J.toml";
    let errors = [
        Model::from_file(Path::new(evil)).err().unwrap(),
        Model::find(evil).err().unwrap(),
        Error::data(evil, evil),
        Error::request(Field::Study, evil),
        Error::computation(evil),
        Model::from_spec(evil).err().unwrap(),
    ];
    for error in errors {
        let told = error.to_string();
        assert!(!told.contains(['\u{202e}', '\u{1b}']), "{told:?}");
        assert!(told.contains("\\u{202e}"), "{told}");
    }
}
