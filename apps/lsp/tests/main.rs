//! The language server, driven by the messages of an editor.

mod editor;

mod completion;
mod damaged;
mod findings;
mod joints;
mod names;
mod streams;
mod told;
