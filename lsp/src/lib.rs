//! The language server for specs: what `check` reports, while a spec is being written, and what its
//! names mean.
//!
//! ```text
//! protocol --server--> Document (text, syntax tree, mechanism, names) --> diagnostics, hover, names, completion
//!                          \--worker--> derivation --> warnings of the audit, equations of each item
//! ```
//!
//! Answers come from the text alone. The derivation takes longer and runs beside the protocol.

mod completion;
mod diagnostics;
mod document;
mod equations;
mod hover;
mod names;
mod server;
mod text;
mod worker;

use lsp_server::{Connection, ProtocolError};

pub use server::serve;

/// Why the server ends.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The editor does not keep to the protocol.
    #[error("the language server: {0}")]
    Protocol(#[from] ProtocolError),
    /// A stream fails.
    #[error("the language server: {0}")]
    Stream(#[from] std::io::Error),
}

/// Serves an editor over standard input and output until it leaves.
pub fn serve_streams() -> Result<(), Error> {
    let (connection, threads) = Connection::stdio();
    serve(&connection)?;
    // The writer ends when nobody can send any more.
    drop(connection);
    Ok(threads.join()?)
}
