//! What a page consists of, whatever it is set in.

use super::display::Equation;
use appell_codegen::symbolic::print::Math;

/// How far a page reads. Each stage holds everything before it; only [`Stage::Equations`], the
/// handout, leaves M and b out where the equations are solved without them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Stage {
    /// Frames, constraints, velocities, accelerations.
    Kinematics,
    /// Acceleration energy, mass matrix, bias.
    Energy,
    /// Pseudo-forces, Appell's equations, accelerations, energies: the handout.
    Equations,
    /// Jacobians of the motion.
    Jacobians,
    /// Constraint forces and outputs as well.
    All,
}

/// A page: what it is about, and its sections.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// What it is about.
    pub title: String,
    /// Where the model comes from.
    pub source: Option<String>,
    /// Its sections, in reading order.
    pub sections: Vec<Section>,
}

/// A section.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Its idea, in a few words.
    pub heading: Vec<Span>,
    /// What it says.
    pub blocks: Vec<Block>,
}

/// A part of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A short text.
    Sentence(Vec<Span>),
    /// Quantities with what they mean.
    Table(Table),
    /// Frames, each turned from the one before.
    Chain(Chain),
    /// Displayed equations, aligned.
    Equations(Vec<Equation>),
}

/// Text, or a formula in the text.
#[derive(Debug, Clone, PartialEq)]
pub enum Span {
    /// Text as it is: each format escapes it.
    Text(String),
    /// A formula.
    Math(Math),
}

/// Rows of cells without a head: the columns explain themselves.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// What is listed; empty where the text before says it.
    pub title: String,
    /// Rows, in order.
    pub rows: Vec<Row>,
}

/// A row of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Its cells.
    pub cells: Vec<Vec<Span>>,
    /// The line of the spec that says it, from 1.
    pub line: usize,
}

/// A chain of frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// Where it starts.
    pub start: String,
    /// What is turned, and the frame that this gives.
    pub links: Vec<(Vec<Span>, String)>,
}
