//! Data sets and their files, from the outside.

mod clocks;
mod common;

mod data_sets;
mod drafting;
mod formats;
mod logs;
mod messages;
mod motion_capture;
mod npz;
