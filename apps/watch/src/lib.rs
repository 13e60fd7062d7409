//! A page on the loopback address that follows a spec while it is being written.
//!
//! ```text
//! file --> text --worker--> findings, equations, drawing, model --board--> page
//! model --motions--> motion with the values of the sliders --> page
//! ```
//!
//! | file | contents |
//! |---|---|
//! | `file.rs` | watches the file and reads its text |
//! | `worker.rs`, `places.rs`, `knobs.rs` | parts of the page from a text; positions in it; sliders |
//! | `board.rs` | the newest version of each part, and the last valid model |
//! | `motions.rs` | simulations with the values of the sliders, within limits |
//! | `server.rs`, `guard.rs` | the HTTP server and its access control |
//! | `connections.rs` | connections, limited in number |

mod board;
mod connections;
mod file;
mod guard;
mod knobs;
mod motions;
mod places;
mod server;
mod worker;

use std::net::{Ipv4Addr, SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use board::Board;
use guard::Guard;
use motions::Motions;
use server::Shared;
use tokio::sync::Semaphore;

/// Why a page cannot be served.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The file cannot be read.
    #[error("cannot read {}: {cause}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        #[source]
        cause: std::io::Error,
    },
    /// The port is taken, or no thread can be started.
    #[error("the page cannot be served: {0}")]
    Server(#[from] std::io::Error),
    /// The operating system gives no random numbers.
    #[error("no secret for the address: {0}")]
    Secret(getrandom::Error),
}

/// A server that is ready for a browser.
pub struct Watch {
    listener: TcpListener,
    shared: Shared,
}

impl Watch {
    /// Follows a spec and listens on a port of the loopback address; 0 is any free one.
    pub fn start(spec: &Path, port: u16) -> Result<Self, Error> {
        // Opening another kind of file, such as a pipe, may block.
        let is_file = std::fs::metadata(spec).and_then(|about| {
            let no_file = || std::io::Error::other("this is no file");
            about.is_file().then_some(()).ok_or_else(no_file)
        });
        is_file.map_err(|cause| Error::File {
            path: spec.to_owned(),
            cause,
        })?;
        let spec = &std::path::absolute(spec)?;
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let guard = Guard::new(listener.local_addr()?.port()).map_err(Error::Secret)?;
        let board = Arc::new(Board::default());
        let shared = Shared {
            guard,
            motions: Motions::start(&board)?,
            inbox: worker::start(spec, &board)?,
            board,
            windows: Arc::new(Semaphore::new(server::MOST_WINDOWS)),
        };
        file::follow(spec, shared.inbox.clone())?;
        Ok(Self { listener, shared })
    }

    /// Where the server listens.
    pub fn address(&self) -> SocketAddr {
        (Ipv4Addr::LOCALHOST, self.shared.guard.port).into()
    }

    /// The address of the page, with the secret that grants access.
    pub fn url(&self) -> String {
        format!("http://{}/{}/", self.address(), self.shared.guard.token)
    }

    /// Serves the page until the process ends.
    pub fn serve(self) -> Result<(), Error> {
        Ok(server::serve(self.listener, self.shared)?)
    }
}
