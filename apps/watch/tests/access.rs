//! Who is answered, and with what.

use std::net::{Ipv4Addr, TcpStream};

use crate::client::{Served, shipped};

const ADDRESSES: [&str; 6] = ["", "style.css", "page.js", "motion.html", "state", "events"];

#[test]
fn without_the_secret_there_is_nothing() {
    let served = Served::new(&shipped("pendulum"));
    let host = served.address.to_string();
    let wrong = "0".repeat(served.token.len());
    for name in ADDRESSES {
        for path in [format!("/{name}"), format!("/{wrong}/{name}")] {
            assert_eq!(
                served.request("GET", &path, &host, "").status,
                404,
                "{path}"
            );
        }
    }
    assert_eq!(served.request("GET", "/", &host, "").status, 404);
    assert_eq!(served.request("POST", "/motion", &host, "{}").status, 404);
    assert_eq!(served.get("").status, 200);
}

#[test]
fn other_hosts_and_origins_are_refused() {
    let served = Served::new(&shipped("pendulum"));
    let port = served.address.port();
    let path = served.path("state");
    for host in [
        "a.test".to_owned(),
        format!("a.test:{port}"),
        "127.0.0.1".to_owned(),
    ] {
        assert_eq!(
            served.request("GET", &path, &host, "").status,
            421,
            "{host}"
        );
    }
    let local = format!("localhost:{port}");
    assert_eq!(served.request("GET", &path, &local, "").status, 200);
    let foreign = format!("{local}\r\nOrigin: http://a.test");
    assert_eq!(served.request("GET", &path, &foreign, "").status, 403);
}

#[test]
fn only_the_loopback_address_listens() {
    let served = Served::new(&shipped("pendulum"));
    assert!(served.address.ip().is_loopback());
    // Another address of the loopback network is another address.
    let other = (Ipv4Addr::new(127, 0, 0, 2), served.address.port());
    assert!(TcpStream::connect(other).is_err());
}

#[test]
fn every_answer_is_strict_about_its_content() {
    let served = Served::new(&shipped("pendulum"));
    for name in ["", "style.css", "page.js", "motion.html", "state"] {
        let head = served.get(name).head.to_lowercase();
        assert!(
            head.contains("content-security-policy: default-src 'none'"),
            "{head}"
        );
        assert!(head.contains("cache-control: no-store"), "{head}");
        assert!(head.contains("referrer-policy: no-referrer"), "{head}");
        assert!(head.contains("x-content-type-options: nosniff"), "{head}");
    }
    assert!(served.get("").head.contains("frame-ancestors 'none'"));
    assert!(
        served
            .get("motion.html")
            .head
            .contains("sandbox allow-scripts")
    );
}

#[test]
fn nothing_is_written_and_no_other_file_is_read() {
    let served = Served::new(&shipped("pendulum"));
    served.state(|state| !state["model"].is_null());
    let host = served.address.to_string();
    for method in ["PUT", "DELETE", "PATCH", "POST"] {
        let path = served.path("state");
        assert_eq!(
            served.request(method, &path, &host, "x").status,
            405,
            "{method}"
        );
    }
    for name in ["spec.toml", "../spec.toml", "%2e%2e/spec.toml", "a/b"] {
        assert_eq!(served.get(name).status, 404, "{name}");
    }
    assert_eq!(served.files(), ["spec.toml"]);
}

#[test]
fn large_requests_are_refused() {
    let served = Served::new(&shipped("pendulum"));
    let host = served.address.to_string();
    let path = served.path("motion");
    let large = "x".repeat(1 << 20);
    assert_eq!(served.request("POST", &path, &host, &large).status, 413);
    assert_eq!(served.request("POST", &path, &host, "{").status, 400);
}
