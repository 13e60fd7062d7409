//! The language server for specs: the findings of `check` while a spec is edited, and the meaning of its
//! names.
//!
//! ```text
//! protocol --server--> Document (text, syntax tree, mechanism, names) --> diagnostics, hover, names, completion
//!                          \--worker--> derivation --> warnings of the audit, equations of each item
//! ```
//!
//! Requests are answered from the text alone. The slower derivation runs on a thread of its own.

mod completion;
mod diagnostics;
mod document;
mod equations;
mod hover;
mod markdown;
mod names;
mod server;
mod stream;
mod text;
mod worker;

use std::io::{self, BufRead, BufReader, Write};

pub use server::serve;

/// Serves an editor over standard input and output until it leaves.
pub fn serve_stdio() -> io::Result<()> {
    serve_streams(BufReader::new(io::stdin()), io::stdout())
}

/// Serves an editor over two streams until it leaves.
pub fn serve_streams(
    from: impl BufRead + Send + 'static,
    to: impl Write + Send + 'static,
) -> io::Result<()> {
    let (connection, writer) = stream::connect(from, to)?;
    serve(&connection)?;
    // The writer ends when all senders are dropped.
    drop(connection);
    let written = writer.join();
    written.unwrap_or_else(|_| Err(io::Error::other("the writer has ended early")))
}
