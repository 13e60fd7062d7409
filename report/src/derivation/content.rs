//! Content of a page, independent of its format.

use super::display::Equation;
use appell_codegen::symbolic::print::Math;

/// Extent of a page. Each stage includes the previous ones; only [`Stage::Equations`], the handout,
/// omits M and b if the equations are solved without them.
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

/// A page with its sections.
#[derive(Debug, Clone, PartialEq)]
pub struct Page {
    /// Its title.
    pub title: String,
    /// Source of the model.
    pub source: Option<String>,
    /// Its sections, in reading order.
    pub sections: Vec<Section>,
}

impl Page {
    /// Its displayed equations.
    pub(super) fn equations(&self) -> impl Iterator<Item = &Equation> {
        let blocks = self.sections.iter().flat_map(|section| &section.blocks);
        let equations = blocks.filter_map(|block| match block {
            Block::Equations(equations) => Some(equations),
            _ => None,
        });
        equations.flatten()
    }

    /// Characters of its displayed formulas.
    pub(super) fn length(&self) -> usize {
        let width = |e: &Equation| e.left.width() + e.right.width();
        self.equations().map(width).sum()
    }
}

/// A section.
#[derive(Debug, Clone, PartialEq)]
pub struct Section {
    /// Its heading.
    pub heading: Vec<Span>,
    /// Its blocks.
    pub blocks: Vec<Block>,
}

/// A part of a section.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A short text.
    Sentence(Vec<Span>),
    /// Quantities with their meaning.
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
    /// Its caption; empty if the text before contains it.
    pub title: String,
    /// Rows, in order.
    pub rows: Vec<Row>,
}

/// A row of a table.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Its cells.
    pub cells: Vec<Vec<Span>>,
    /// The line of its definition in the spec, from 1.
    pub line: usize,
}

/// A chain of frames.
#[derive(Debug, Clone, PartialEq)]
pub struct Chain {
    /// The initial frame.
    pub start: String,
    /// Rotations, and the resulting frames.
    pub links: Vec<(Vec<Span>, String)>,
}
