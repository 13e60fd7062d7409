//! Connections: idle ones time out, and their number is limited without locking out the page.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use axum::{Extension, Router};
use hyper::server::conn::http1;
use hyper_util::rt::{TokioIo, TokioTimer};
use hyper_util::service::TowerToHyperService;
use tokio::net::{TcpListener, TcpStream};
use tokio::task::AbortHandle;

/// Timeout for the head of a request.
const HEAD: Duration = Duration::from_secs(5);
/// Limit on open connections.
const MOST: usize = 128;
/// Pause after an error of the operating system, such as too many open files.
const PAUSE: Duration = Duration::from_millis(100);

/// Whether a request on a connection has shown the secret.
pub(crate) type Admitted = Arc<AtomicBool>;

struct Connection {
    task: AbortHandle,
    admitted: Admitted,
}

/// Serves connections until the process ends; at the limit, closes the oldest without the secret.
pub(crate) async fn accept(listener: &TcpListener, routes: &Router) {
    let mut open = VecDeque::new();
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(PAUSE).await;
            continue;
        };
        open.retain(|one: &Connection| !one.task.is_finished());
        if open.len() >= MOST {
            let strangers = open
                .iter()
                .position(|one| !one.admitted.load(Ordering::Relaxed));
            match strangers.and_then(|at| open.remove(at)) {
                Some(oldest) => oldest.task.abort(),
                None => continue,
            }
        }
        let admitted = Admitted::default();
        let routes = routes.clone().layer(Extension(Arc::clone(&admitted)));
        let task = tokio::spawn(serve(stream, routes)).abort_handle();
        open.push_back(Connection { task, admitted });
    }
}

async fn serve(stream: TcpStream, routes: Router) {
    let mut http = http1::Builder::new();
    http.timer(TokioTimer::new()).header_read_timeout(HEAD);
    // An error on one connection does not affect the others.
    let _ = http
        .serve_connection(TokioIo::new(stream), TowerToHyperService::new(routes))
        .await;
}
