//! Data sets and their files, from the outside.

mod clocks;
mod common;

mod data_sets;
mod drafting;
mod formats;
mod logs;
mod motion_capture;
mod npz;
