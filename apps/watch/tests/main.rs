//! The server of a live page, over plain sockets.

mod client;

mod access;
mod crowd;
mod hostile;
mod motions;
mod saving;
