//! The HTTP server of the page.

use std::convert::Infallible;
use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;

use appell_report::derivation::EQUATIONS;
use appell_report::film::live_page;
use appell_report::page_shell::PageShell;
use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, REFERRER_POLICY, X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderName, HeaderValue, StatusCode};
use axum::middleware::{self, Next};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Extension, Router};
use futures_util::stream::{self, Stream};
use maud::{PreEscaped, html};
use tokio::sync::Semaphore;

use crate::board::Board;
use crate::connections::{self, Admitted};
use crate::guard::Guard;
use crate::motions::{Motions, Refusal};
use crate::worker::Inbox;

/// Limit on the size of a request, in bytes.
const LARGEST: usize = 64 << 10;
/// Timeout for receiving and for answering a request.
const PATIENCE: Duration = Duration::from_secs(30);
/// Limit on windows that follow the spec.
pub(crate) const MOST_WINDOWS: usize = 32;

const STYLE: &str = include_str!("page/style.css");
const BODY: &str = include_str!("page/body.html");
const SCRIPTS: [&str; 5] = [
    include_str!("page/spec.js"),
    include_str!("page/equations.js"),
    include_str!("page/sliders.js"),
    include_str!("page/motion.js"),
    include_str!("page/page.js"),
];

/// The page connects to this server only and runs its own scripts only.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; \
                      img-src data:; frame-src 'self'; base-uri 'none'; form-action 'none'; \
                      frame-ancestors 'none'";
/// The frame of the animation has no network access; the sandbox gives it an opaque origin.
const FRAME_POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; \
                            base-uri 'none'; form-action 'none'; frame-ancestors 'self'; \
                            sandbox allow-scripts";

/// What every request may need.
#[derive(Clone)]
pub(crate) struct Shared {
    pub(crate) guard: Guard,
    pub(crate) board: Arc<Board>,
    pub(crate) motions: Arc<Motions>,
    pub(crate) inbox: Inbox,
    /// Permits of windows that follow the spec.
    pub(crate) windows: Arc<Semaphore>,
}

/// Serves until the process ends.
pub(crate) fn serve(listener: TcpListener, shared: Shared) -> std::io::Result<()> {
    let routes = Router::new()
        .route("/{token}/", get(page))
        .route("/{token}/style.css", get(style))
        .route("/{token}/page.js", get(script))
        .route("/{token}/motion.html", get(frame))
        .route("/{token}/state", get(state))
        .route("/{token}/events", get(events))
        .route("/{token}/motion", post(motion))
        .route("/{token}/derivation", post(derivation))
        .layer(DefaultBodyLimit::max(LARGEST))
        .layer(middleware::from_fn_with_state(shared.clone(), guarded))
        .with_state(shared);
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()?;
    runtime.block_on(async {
        let listener = tokio::net::TcpListener::from_std(listener)?;
        connections::accept(&listener, &routes).await;
        Ok(())
    })
}

/// Checks a request and answers it within the timeout.
async fn guarded(
    State(shared): State<Shared>,
    Extension(admitted): Extension<Admitted>,
    request: Request,
    next: Next,
) -> Response {
    let checked = shared.guard.check(request.uri().path(), request.headers());
    if checked.is_ok() {
        admitted.store(true, Ordering::Relaxed);
    }
    let mut response = match checked {
        Err(status) => status.into_response(),
        Ok(()) => tokio::time::timeout(PATIENCE, next.run(request))
            .await
            .unwrap_or_else(|_| StatusCode::REQUEST_TIMEOUT.into_response()),
    };
    let headers = response.headers_mut();
    headers
        .entry(CONTENT_SECURITY_POLICY)
        .or_insert(HeaderValue::from_static(POLICY));
    for (name, value) in [
        (CACHE_CONTROL, "no-store"),
        (REFERRER_POLICY, "no-referrer"),
        (X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (
            HeaderName::from_static("cross-origin-resource-policy"),
            "same-origin",
        ),
        (
            HeaderName::from_static("cross-origin-opener-policy"),
            "same-origin",
        ),
    ] {
        headers.insert(name, HeaderValue::from_static(value));
    }
    response
}

fn typed(kind: &'static str, text: String) -> Response {
    ([(CONTENT_TYPE, kind)], text).into_response()
}

async fn page() -> Response {
    let head = html! {
        (PreEscaped(BODY))
        script src="page.js" {}
    };
    let shell = PageShell {
        sheet: Some("style.css"),
        ..PageShell::new("appell", "")
    };
    typed("text/html; charset=utf-8", shell.around(&head))
}

async fn style() -> Response {
    typed("text/css; charset=utf-8", [EQUATIONS, STYLE].concat())
}

async fn script() -> Response {
    let scripts = format!("\"use strict\";\n{}", SCRIPTS.join("\n"));
    typed("text/javascript; charset=utf-8", scripts)
}

async fn frame() -> Response {
    let mut response = typed("text/html; charset=utf-8", live_page());
    let policy = HeaderValue::from_static(FRAME_POLICY);
    response
        .headers_mut()
        .insert(CONTENT_SECURITY_POLICY, policy);
    response
}

/// All parts of the page, by name.
async fn state(State(shared): State<Shared>) -> Response {
    let parts = shared.board.since(0).into_iter();
    let parts: Vec<String> = parts
        .map(|entry| format!("\"{}\":{}", entry.part.name(), entry.json))
        .collect();
    json(format!("{{{}}}", parts.join(",")))
}

fn json(text: String) -> Response {
    typed("application/json", text)
}

/// A stream of events: all parts at first, then each part when it changes.
async fn events(State(shared): State<Shared>) -> Response {
    let Ok(permit) = Arc::clone(&shared.windows).try_acquire_owned() else {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    };
    let news = changes(&shared.board);
    // Released when the window is closed.
    let news = stream::unfold((Box::pin(news), permit), |(mut news, permit)| async move {
        use futures_util::StreamExt as _;
        Some((news.next().await?, (news, permit)))
    });
    Sse::new(news)
        .keep_alive(KeepAlive::default())
        .into_response()
}

fn changes(board: &Arc<Board>) -> impl Stream<Item = Result<Event, Infallible>> + use<> {
    let start = (Arc::clone(board), board.subscribe(), 0);
    stream::unfold(start, |(board, mut news, seen)| async move {
        loop {
            news.borrow_and_update();
            if let Some(entry) = board.since(seen).into_iter().next() {
                let event = Event::default().event(entry.part.name()).data(&*entry.json);
                return Some((Ok(event), (board, news, entry.stamp)));
            }
            news.changed().await.ok()?;
        }
    })
}

/// Requests the derivation; it arrives as an event.
async fn derivation(State(shared): State<Shared>) -> StatusCode {
    shared.inbox.want_derivation();
    StatusCode::ACCEPTED
}

async fn motion(State(shared): State<Shared>, body: Bytes) -> Response {
    let request = match serde_json::from_slice(&body) {
        Ok(request) => request,
        Err(error) => return (StatusCode::BAD_REQUEST, error.to_string()).into_response(),
    };
    let answered = match shared.motions.ask(request) {
        Ok(answered) => answered.await,
        Err(refusal) => Ok(Err(refusal)),
    };
    match answered {
        Ok(Ok(motion)) => json(motion.to_string()),
        Ok(Err(Refusal::Wrong(message))) => {
            (StatusCode::UNPROCESSABLE_ENTITY, message).into_response()
        }
        Ok(Err(Refusal::Busy)) => StatusCode::SERVICE_UNAVAILABLE.into_response(),
        // Superseded by a newer request.
        Err(_) => StatusCode::CONFLICT.into_response(),
    }
}
