//! Connections that say nothing, and many of them.

use std::io::{Read as _, Write as _};

use serde_json::Value;

use crate::client::{Served, shipped};

/// More than the server keeps open.
const CROWD: usize = 200;

#[test]
fn a_crowd_of_strangers_is_let_go_and_the_page_stays() {
    let served = Served::new(&shipped("pendulum"));
    let mut events = served.events();
    events.next("model", Value::is_object);
    let mut crowd: Vec<_> = (0..CROWD).map(|_| served.connect()).collect();
    assert_eq!(served.get("state").status, 200);
    // The oldest have given way.
    assert_eq!(crowd[0].read(&mut [0; 1]).ok(), Some(0));
    let good = shipped("pendulum").replace("value = 1,", "value = 1.5,");
    served.save(&good);
    events.next("text", |text| text["text"] == good);
}

#[test]
fn whoever_does_not_end_a_request_is_let_go() {
    let served = Served::new(&shipped("pendulum"));
    let mut stream = served.connect();
    let head = format!("GET {} HTTP/1.1\r\nX-Slow: ", served.path("state"));
    stream.write_all(head.as_bytes()).expect("a server");
    assert_eq!(stream.read(&mut [0; 1]).ok(), Some(0));
}
