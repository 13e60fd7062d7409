//! Access control: a request needs the secret of the address and must come from the page itself.

use axum::http::header::{HOST, ORIGIN};
use axum::http::{HeaderMap, StatusCode};

/// Bytes of the secret.
const SECRET: usize = 24;

/// The secret and the port that a request is checked against.
#[derive(Clone)]
pub(crate) struct Guard {
    pub(crate) token: String,
    pub(crate) port: u16,
}

impl Guard {
    /// A new secret for a port.
    pub(crate) fn new(port: u16) -> Result<Self, getrandom::Error> {
        let mut bytes = [0; SECRET];
        getrandom::fill(&mut bytes)?;
        let digits = bytes.iter().flat_map(|byte| [byte >> 4, byte & 15]);
        let token = digits.filter_map(|digit| char::from_digit(digit.into(), 16));
        let token = token.collect();
        Ok(Self { token, port })
    }

    /// Rejects requests without the secret, and cross-site requests: their host or origin is a foreign name.
    pub(crate) fn check(&self, path: &str, headers: &HeaderMap) -> Result<(), StatusCode> {
        let own = [
            format!("127.0.0.1:{}", self.port),
            format!("localhost:{}", self.port),
        ];
        let hosts = headers.get_all(HOST);
        let mut hosts = hosts.iter().map(|host| host.to_str().unwrap_or_default());
        let is_own = hosts
            .next()
            .is_some_and(|host| own.iter().any(|o| o == host));
        if !is_own || hosts.next().is_some() {
            return Err(StatusCode::MISDIRECTED_REQUEST);
        }
        let mut origins = headers.get_all(ORIGIN).iter();
        let is_own = origins.all(|origin| {
            let origin = origin.to_str().unwrap_or_default();
            own.iter()
                .any(|own| origin.strip_prefix("http://") == Some(own))
        });
        if !is_own {
            return Err(StatusCode::FORBIDDEN);
        }
        let shown = path.split('/').nth(1).unwrap_or_default();
        if is_same(shown.as_bytes(), self.token.as_bytes()) {
            Ok(())
        } else {
            Err(StatusCode::NOT_FOUND)
        }
    }
}

/// Compares in constant time, for secrets of one length.
fn is_same(a: &[u8], b: &[u8]) -> bool {
    let differences = a.iter().zip(b).fold(0, |all, (a, b)| all | (a ^ b));
    a.len() == b.len() && std::hint::black_box(differences) == 0
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test fails by panicking")]
mod tests {
    use super::*;

    fn headers(pairs: &[(&'static str, &str)]) -> HeaderMap {
        let pairs = pairs.iter();
        pairs
            .map(|(name, value)| (name.parse().unwrap(), value.parse().unwrap()))
            .collect()
    }

    #[test]
    fn secrets_differ_and_are_long() {
        let [a, b] = [Guard::new(1).unwrap(), Guard::new(1).unwrap()];
        assert_ne!(a.token, b.token);
        assert_eq!(a.token.len(), 2 * SECRET);
    }

    #[test]
    fn only_the_page_itself_is_admitted() {
        let guard = Guard::new(80).unwrap();
        let path = format!("/{}/state", guard.token);
        let own = ("host", "127.0.0.1:80");
        let check = |path: &str, pairs: &[(&'static str, &str)]| {
            guard.check(path, &headers(pairs)).map_err(|s| s.as_u16())
        };
        assert_eq!(check(&path, &[own]), Ok(()));
        assert_eq!(
            check(&path, &[own, ("origin", "http://127.0.0.1:80")]),
            Ok(())
        );
        assert_eq!(check(&path, &[own, ("origin", "http://a.test")]), Err(403));
        assert_eq!(check(&path, &[own, ("origin", "null")]), Err(403));
        assert_eq!(check(&path, &[]), Err(421));
        assert_eq!(check(&path, &[("host", "a.test:80")]), Err(421));
        assert_eq!(check(&path, &[("host", "127.0.0.1:81")]), Err(421));
        assert_eq!(check("/state", &[own]), Err(404));
        assert_eq!(check(&path[..path.len() - 7], &[own]), Err(404));
        assert_eq!(check("", &[own]), Err(404));
    }
}
