//! Motion capture of a vehicle and its rider, as recordings of a planar model (L. Mihályi, X. A. Ji, G.
//! Orosz and D. Takács, *Experimental Model Identification of the Longitudinal Dynamics of an Electric
//! Unicycle with a Human Rider*, 2024).
//!
//! ```text
//! skeleton.toml --skeleton--> bodies, points, segments, frame, channels
//! capture.csv   --capture---> rigid bodies over time
//!               --ride------> points, centre of mass, moving frame, coordinates of the model
//!               --smooth----> velocities and accelerations in the frame
//!               --written---> a data set for every command that reads recordings
//! ```
//!
//! | file | idea |
//! |---|---|
//! | `skeleton.rs` | the skeleton file, with positions |
//! | `anthropometry.rs` | published tables of segment masses |
//! | `capture.rs`, `pose.rs` | rigid bodies over time; positions and axes |
//! | `ride.rs` | the points of a skeleton, and the coordinates of a model |
//! | `smooth.rs` | velocities and accelerations in the moving frame |
//! | `written.rs` | the data set |

pub mod anthropometry;
mod capture;
mod pose;
mod ride;
mod skeleton;
mod smooth;
mod written;

pub use capture::{Capture, Track};
pub use pose::{Axes, Vector};
pub use ride::Ride;
pub use skeleton::{
    Channel, ChannelKind, Column, Columns, Frame, Place, Point, Rider, Segment, Skeleton,
};
pub use smooth::{Signal, Smoothed, filter};
pub use written::{manifest, table};
