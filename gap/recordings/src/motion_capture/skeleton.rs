//! The skeleton file: captured bodies, mass distribution, channels of a model.
//!
//! ```toml
//! description = "rider on an electric unicycle"
//! mechanism   = "euc_3dof"              # the model whose channels are written
//!
//! [columns]                             # of the capture; {} is the name of a body
//! position = ["{}.X", "{}.Y", "{}.Z"]   # forward, left, up; a leading - turns a column round
//! angles   = ["{}.yaw", "{}.tilt", "{}.pitch"]
//! length   = "mm"
//! angle    = "deg"
//!
//! [bodies]                              # rigid bodies; a pivot in each of them is followed
//! E = "EUC, top"
//! H = "head, top of the helmet"
//!
//! [points]                              # fixed in a body, from its pivot, in its own axes
//! C = { body = "E", offset = [0, 0, -450], unit = "mm" }
//!
//! [rider]
//! mass  = { value = 65, unit = "kg" }
//! table = "de_leva_men"
//! name  = "G"                           # the centre of mass of all segments
//!
//! [segments]                            # between pivots and points, or the middle between several
//! head = { part = "head", from = "H", to = ["CHR", "CHL"] }
//!
//! [frame]                               # moves with the vehicle: yaw and tilt of a body, at a point
//! body   = "E"
//! origin = "C"
//!
//! [channels]                            # for the model, by the names of its coordinates
//! x     = { path = "C" }                # way of a point along the frame
//! gamma = { pitch_of = "E" }
//! phi   = { lean = ["C", "G"] }         # angle from the frame's upright to the line between two points
//! ```

mod reader;

use self::reader::Reader;
use super::anthropometry::Anthropometry;
use crate::DataError;
use crate::fields::Fields;

/// Bodies and points of a file at most.
const MOST_NAMES: usize = 256;

/// A checked skeleton. Names are resolved to indices, numbers are in SI.
#[derive(Debug, Clone, PartialEq)]
pub struct Skeleton {
    /// Description.
    pub description: String,
    /// The mechanism that the channels belong to.
    pub mechanism: String,
    /// How the columns of a body are called.
    pub columns: Columns,
    /// Names of the rigid bodies.
    pub bodies: Vec<String>,
    /// Points: pivots of all bodies first, then those that are fixed in bodies.
    pub points: Vec<Point>,
    /// The rider.
    pub rider: Rider,
    /// The moving frame: a body for its yaw and tilt, a point for its origin.
    pub frame: Frame,
    /// Channels of the model.
    pub channels: Vec<Channel>,
}

/// Columns of a body in the capture.
#[derive(Debug, Clone, PartialEq)]
pub struct Columns {
    /// Forward, left, up.
    pub position: [Column; 3],
    /// Yaw about z, tilt about x, pitch about y, in this order.
    pub angles: [Column; 3],
}

/// A column with the name of a body left open.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Its name, with `{}` for the body.
    pub pattern: String,
    /// One of its unit in SI, negative where it points the other way.
    pub scale: f64,
}

impl Column {
    /// Its name for a body.
    pub fn of(&self, body: &str) -> String {
        self.pattern.replace("{}", body)
    }
}

/// A point that moves with a rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Its name.
    pub name: String,
    /// The body, by its index.
    pub body: usize,
    /// From the pivot of the body, in the axes of the body, in m.
    pub offset: [f64; 3],
}

/// A body with mass.
#[derive(Debug, Clone, PartialEq)]
pub struct Rider {
    /// Mass in kg.
    pub mass: f64,
    /// Name of the centre of mass.
    pub centre: String,
    /// The table of the segments.
    pub table: &'static Anthropometry,
    /// The segments.
    pub segments: Vec<Segment>,
}

/// A segment between two ends, each the middle between points.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Its name.
    pub name: String,
    /// Mass in kg.
    pub mass: f64,
    /// Position of the centre between the ends, as a fraction of their distance.
    pub centre: f64,
    /// Points of the two ends, by their index.
    pub ends: [Vec<usize>; 2],
}

/// The moving frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Frame {
    /// Body whose yaw and tilt it has.
    pub body: usize,
    /// Its origin, by the index of a point.
    pub origin: usize,
}

/// A coordinate of the model, as computed from the capture.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Name of the coordinate.
    pub name: String,
    /// Its definition.
    pub kind: ChannelKind,
}

/// A position: that of a point, or of the rider's centre of mass.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// A point, by its index.
    Point(usize),
    /// The rider's centre of mass.
    Centre,
}

/// Definition of a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChannelKind {
    /// The path length of a place along the frame's x axis.
    Path(Place),
    /// The pitch of a body.
    Pitch(usize),
    /// The angle of the line between two places in the frame's x-z plane, from z towards x.
    Lean([Place; 2]),
}

const KEYS: &[&str] = &[
    "description",
    "mechanism",
    "columns",
    "bodies",
    "points",
    "rider",
    "segments",
    "frame",
    "channels",
];

impl Skeleton {
    /// Reads a file; `file` is its name in messages.
    pub fn parse(file: &str, text: &str) -> Result<Self, DataError> {
        let (mut fields, table) = Fields::new(file, text);
        if fields.is_wrong() {
            return Err(fields.report().into());
        }
        let skeleton = Reader::new(&mut fields).skeleton(table.get_ref());
        match skeleton {
            Some(skeleton) if !fields.is_wrong() => Ok(skeleton),
            _ => Err(fields.report().into()),
        }
    }

    /// The body of a name.
    pub fn body(&self, name: &str) -> Option<usize> {
        self.bodies.iter().position(|body| body == name)
    }
}
