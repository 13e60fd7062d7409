//! Common tools of the sections: formulas of expressions, and definitions before use.

use appell_spec::mechanism::{FrameId, Mechanism, PointId};
use rustc_hash::FxHashSet;

use super::lexicon::{AXES, Lexicon};
use super::{Block, Equation, Letter, Math, Span};
use appell_codegen::mechanics::Derivation;
use appell_codegen::symbolic::dissolve::Dissolved;
use appell_codegen::symbolic::print::Setter;
use appell_codegen::symbolic::vector::Vec3;
use appell_codegen::symbolic::{Expr, Graph, Node, System};

/// Width of a component beyond which a vector is written component by component.
const WIDEST_COMPONENT: usize = 82;
/// Width of entries beyond which a linear system is written equation by equation.
const WIDEST_SYSTEM: usize = 76;

/// Writes formulas and records the names that they use.
pub(super) struct Writer<'a> {
    pub(super) mechanism: &'a Mechanism,
    pub(super) derivation: &'a mut Derivation,
    pub(super) setter: Setter<Lexicon>,
    pub(super) dissolved: Dissolved,
    /// Names whose definitions the page has shown.
    defined: FxHashSet<Letter>,
    /// Names that formulas have used since the last definitions.
    wanted: Vec<Expr>,
    /// Pseudo-accelerations, as symbols and as named results.
    pub(super) accelerations: Vec<Expr>,
    /// Generalised velocities and pseudo-velocities.
    pub(super) velocities: Vec<Expr>,
}

impl<'a> Writer<'a> {
    pub(super) fn new(mechanism: &'a Mechanism, derivation: &'a mut Derivation) -> Self {
        let setter = Setter::new(Lexicon::new(mechanism, derivation))
            .with_functions_apart(derivation.algebra.in_letters);
        let mut accelerations = derivation.symbols.accelerations.clone();
        accelerations.extend(&derivation.motion.accelerations);
        let mut velocities = derivation.symbols.rates.clone();
        velocities.extend(&derivation.symbols.speeds);
        Self {
            mechanism,
            derivation,
            setter,
            dissolved: Dissolved::default(),
            defined: FxHashSet::default(),
            wanted: Vec::new(),
            accelerations,
            velocities,
        }
    }

    pub(super) fn graph(&mut self) -> &mut Graph {
        &mut self.derivation.algebra.graph
    }

    /// Letter of a symbol or of a named quantity.
    pub(super) fn letter(&mut self, expr: Expr) -> Letter {
        self.setter.letter(&self.derivation.algebra.graph, expr)
    }

    /// The letter as a formula.
    pub(super) fn symbol(&mut self, expr: Expr) -> Math {
        Math::letter(self.letter(expr))
    }

    /// Letter of a pseudo-velocity.
    pub(super) fn speed(&mut self, index: usize) -> Letter {
        self.letter(self.derivation.symbols.speeds[index])
    }

    /// Name of a frame.
    pub(super) fn frame(&self, frame: FrameId) -> String {
        self.mechanism.frames[frame].name.clone()
    }

    /// Name of a point.
    pub(super) fn point(&self, point: PointId) -> String {
        Letter::of(&self.mechanism.points[point].name).to_string()
    }

    /// The formula of an expression, unexpanded.
    pub(super) fn set(&mut self, expr: Expr) -> Math {
        let set = self.setter.set(&self.derivation.algebra.graph, expr);
        self.wanted.extend(set.wants);
        set.math
    }

    /// The explicit formula, without recording the names that it uses.
    pub(super) fn try_explicit(&mut self, expr: Expr) -> Math {
        let wanted = self.wanted.len();
        let math = self.explicit(expr);
        self.wanted.truncate(wanted);
        math
    }

    /// A vector as one equation, or as one per component where a component fills a line.
    pub(super) fn vector(&mut self, letter: Letter, v: Vec3, frame: FrameId) -> Vec<Equation> {
        let components: Vec<Math> = v.iter().map(|&c| self.explicit(c)).collect();
        let frame = &self.mechanism.frames[frame].name;
        let widest = components.iter().map(Math::width).max().unwrap_or(0);
        if widest + frame.chars().count() <= WIDEST_COMPONENT {
            let right = Math::vector(components, frame);
            return vec![Equation::new(Math::Letter(letter), right)];
        }
        let component = |(component, axis): (Math, &str)| {
            let mut left = letter.clone().below(&format!("{axis} in {frame}"));
            left.bold = false;
            Equation::new(Math::Letter(left), component)
        };
        components.into_iter().zip(AXES).map(component).collect()
    }

    /// Letters of parts and of unknowns.
    pub(super) fn bases(&mut self) -> [&'static str; 2] {
        self.setter.bases(&self.derivation.algebra.graph)
    }

    /// Marks a name as defined: a section shows it among its equations.
    pub(super) fn define(&mut self, letter: Letter) {
        self.defined.insert(letter);
    }

    /// Definitions of the names used since the last call, each before its first use.
    pub(super) fn definitions(&mut self) -> Vec<Block> {
        let mut equations = Vec::new();
        let mut stack: Vec<(Expr, Option<Vec<Equation>>)> = self.take_wanted().collect();
        while let Some((expr, written)) = stack.pop() {
            if let Some(written) = written {
                equations.extend(written);
                continue;
            }
            let letter = self.letter(expr);
            if !self.defined.insert(letter) {
                continue;
            }
            self.define_all_unknowns(expr);
            let written = self.definition(expr);
            stack.push((expr, Some(written)));
            stack.extend(self.take_wanted());
        }
        if equations.is_empty() {
            return Vec::new();
        }
        vec![
            Block::Sentence(vec![Span::Text("With".to_owned())]),
            Block::Equations(equations),
        ]
    }

    /// The names used since the last call without their definitions, the first one last.
    fn take_wanted<T>(&mut self) -> impl Iterator<Item = (Expr, Option<T>)> + use<T> {
        let wanted = std::mem::take(&mut self.wanted);
        wanted.into_iter().rev().map(|expr| (expr, None))
    }

    /// One display defines all unknowns of a linear system.
    fn define_all_unknowns(&mut self, expr: Expr) {
        let Node::Solution { system, .. } = *self.graph().node(expr) else {
            return;
        };
        let letter = self.letter(expr);
        let count = self.graph().system(system).right.len();
        self.defined.extend(unknowns(letter, count));
    }

    /// The equations that define a name; for a linear system, all its unknowns.
    fn definition(&mut self, expr: Expr) -> Vec<Equation> {
        let letter = self.letter(expr);
        let right = match *self.graph().node(expr) {
            Node::Named(id) => {
                let value = self.graph().definition(id).value;
                self.explicit(value)
            }
            Node::Solution { system, .. } => return self.system(system, letter),
            _ => self.set_whole(expr),
        };
        vec![Equation::new(Math::letter(letter), right)]
    }

    /// A linear system: as matrix and columns, or one equation below the other where these are wider
    /// than a page.
    fn system(&mut self, system: u32, unknown: Letter) -> Vec<Equation> {
        let System { matrix, right } = self.graph().system(system).clone();
        let wanted = self.wanted.len();
        let rows = matrix.chunks(right.len());
        let rows: Vec<Vec<Math>> = rows
            .map(|row| row.iter().map(|&e| self.set(e)).collect())
            .collect();
        let components: Vec<Math> = right.iter().map(|&r| self.explicit(r)).collect();
        let column = |k: usize| rows.iter().map(|row| row[k].width() + 3).max().unwrap_or(0);
        let widest = components.iter().map(Math::width).max().unwrap_or(0);
        if (0..right.len()).map(column).sum::<usize>() + widest > WIDEST_SYSTEM {
            self.wanted.truncate(wanted);
            return self.equation_by_equation(&matrix, &right);
        }
        let unknowns = unknowns(unknown, right.len()).map(Math::Letter);
        let column = |components| Math::Vector {
            components,
            frame: None,
            column: true,
        };
        let left = Math::Row(vec![Math::Matrix(rows), column(unknowns.collect())]);
        vec![Equation::new(left, column(components))]
    }

    /// `0 = Σ coefficient · unknown - right`
    fn equation_by_equation(&mut self, matrix: &[Expr], right: &[Expr]) -> Vec<Equation> {
        let graph = self.graph();
        let unknowns = graph.solve_numerically(matrix.to_vec(), right.to_vec());
        let mut equations = Vec::with_capacity(right.len());
        for (row, &right) in matrix.chunks(unknowns.len()).zip(right) {
            let graph = self.graph();
            let mut parts = vec![graph.neg(right)];
            for (&coefficient, &unknown) in row.iter().zip(&unknowns) {
                parts.push(graph.mul(coefficient, unknown));
            }
            let sum = graph.sum(&parts);
            equations.push(Equation::new(Math::zero(), self.explicit(sum)));
        }
        equations
    }

    /// A part with a letter, written out.
    fn set_whole(&mut self, expr: Expr) -> Math {
        let set = self.setter.set(&self.derivation.algebra.graph, expr);
        let others = set.wants.into_iter().filter(|&e| e != expr);
        self.wanted.extend(others);
        set.math
    }
}

/// The letters of all unknowns of a linear system, from that of one.
fn unknowns(mut letter: Letter, count: usize) -> impl Iterator<Item = Letter> {
    letter.below.pop();
    (1..=count).map(move |row| letter.clone().below(&row.to_string()))
}
