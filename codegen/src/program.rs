//! The interface between derivation and scheduling or emission: arguments, functions, expressions.

mod functions;
mod layout;

use std::sync::Arc;

use appell_runtime::model::{ModelInfo, Quantity};
use appell_runtime::switching::Counts;

pub use self::functions::{FunctionKind, Own};
pub use self::layout::{Layout, Space};
use crate::symbolic::{Expr, Graph, SymbolId};

/// The functions of one mechanism.
#[derive(Debug, Clone)]
pub struct Program {
    /// Names, units, defaults; identical in the emitted and the in-process model.
    pub info: ModelInfo,
    /// Name of the spec file, for comments.
    pub file: String,
    /// The symbols that the expressions of all functions may contain, in the order of `info`.
    pub arguments: Arguments,
    /// Dependent coordinates, one per position constraint, in the order of the constraints.
    pub dependent: Vec<usize>,
    /// Sizes of the linear systems of several unknowns that are solved with pivoting to compute the rates.
    pub systems: Vec<usize>,
    /// Values with established names, for intermediate values without a name; expressions in the graph of every
    /// function.
    pub hints: Arc<[Hint]>,
    /// Functions, in the order of display.
    pub functions: Vec<Function>,
}

impl Program {
    /// One of its functions, if it has it.
    pub fn function(&self, kind: FunctionKind) -> Option<&Function> {
        self.functions.iter().find(|function| function.kind == kind)
    }

    /// The number of switching values that depend on time alone.
    pub fn switch_len(&self) -> usize {
        self.result_len(FunctionKind::Switches, "switches")
    }

    /// The number of switching functions.
    pub fn switch_counts(&self) -> Counts {
        Counts {
            answers: self.switch_len(),
            shapes: self.result_len(FunctionKind::TimeFunctions, "shapes"),
            crossings: self.result_len(FunctionKind::Crossings, "crossings"),
            pulses: self.result_len(FunctionKind::Crossings, "pulses"),
        }
    }

    fn result_len(&self, kind: FunctionKind, result: &str) -> usize {
        let mut results = self.function(kind).into_iter().flat_map(|f| &f.results);
        let array = results.find(|array| array.name == result);
        array.map_or(0, |array| array.entries.len())
    }
}

/// A value with an established name, whether or not the derivation names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hint {
    /// The value.
    pub value: Expr,
    /// Its name.
    pub name: String,
    /// The name of minus the value, if it has one.
    pub opposite: Option<String>,
}

/// Symbols of the arguments that all functions have.
#[derive(Debug, Clone)]
pub struct Arguments {
    /// Time.
    pub time: SymbolId,
    /// States: pseudo-velocities, then coordinates.
    pub states: Vec<SymbolId>,
    /// Inputs, then signals and their rates.
    pub inputs: Vec<SymbolId>,
    /// Parameters.
    pub parameters: Vec<SymbolId>,
    /// The number π, if expressions may contain it.
    pub pi: Option<SymbolId>,
}

/// A function to emit or compile.
#[derive(Debug, Clone)]
pub struct Function {
    /// Which one.
    pub kind: FunctionKind,
    /// Owner of its expressions. Each function is derived from the equations of motion alone, so that its operations
    /// do not depend on which other functions there are.
    pub graph: Arc<Graph>,
    /// Symbols of the argument that only some functions have; see [`FunctionKind::takes`].
    pub own: Vec<SymbolId>,
    /// Intermediate quantities that are displayed first. Later computations use their values and treat them as
    /// opaque.
    pub stages: Vec<Stage>,
    /// Results, at least one array.
    pub results: Vec<Array>,
    /// Meanings of intermediate names.
    pub glossary: Vec<Term>,
    /// Groups of intermediate values under a heading, computed before their first use.
    pub groups: Vec<Group>,
    /// Left and right sides of equations for display, in the form in which they are solved.
    pub equations: Vec<[Expr; 2]>,
    /// Further remarks for callers, a sentence each.
    pub remarks: Vec<String>,
}

/// The meaning of some names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Term {
    /// Common prefix of the names.
    pub symbol: String,
    /// Permitted suffixes.
    pub names: Names,
    /// One sentence.
    pub meaning: String,
}

/// Values computed under one heading.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Group {
    /// One line.
    pub title: String,
    /// Prefixes and permitted suffixes of their names.
    pub names: Vec<(String, Names)>,
}

impl Group {
    /// Whether a name belongs to the group.
    pub fn holds(&self, name: &str) -> bool {
        let mut names = self.names.iter();
        names.any(|(symbol, names)| names.fit(symbol, name))
    }
}

/// Suffixes of names after their symbol.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Names {
    /// None.
    Alone,
    /// `_x`, `_y` or `_z`.
    Axes,
    /// None, or an underscore with any text.
    Any,
}

impl Names {
    /// Whether a name consists of a symbol and such a suffix.
    fn fit(self, symbol: &str, name: &str) -> bool {
        let rest = name.strip_prefix(symbol);
        rest.is_some_and(|rest| match self {
            Self::Alone => rest.is_empty(),
            Self::Axes => matches!(rest, "_x" | "_y" | "_z"),
            Self::Any => rest.is_empty() || rest.starts_with('_'),
        })
    }
}

impl Term {
    /// Whether the term explains a name.
    pub fn explains(&self, name: &str) -> bool {
        self.names.fit(&self.symbol, name)
    }
}

/// Named intermediate quantities.
#[derive(Debug, Clone)]
pub struct Stage {
    /// Heading, one line.
    pub title: String,
    /// The quantities; those without a name are skipped.
    pub values: Vec<Expr>,
}

impl Function {
    /// A function without intermediate stages; the graph of its expressions is [added](Self::over) to it.
    pub fn new(kind: FunctionKind, results: Vec<Array>) -> Self {
        Self {
            kind,
            graph: Arc::default(),
            own: Vec::new(),
            stages: Vec::new(),
            results,
            glossary: Vec::new(),
            groups: Vec::new(),
            equations: Vec::new(),
            remarks: Vec::new(),
        }
    }

    /// The function with the graph of its expressions, and the symbols of its own argument.
    #[must_use]
    pub fn over(mut self, graph: Arc<Graph>, own: Vec<SymbolId>) -> Self {
        self.graph = graph;
        self.own = own;
        self
    }

    /// Adds remarks for callers.
    #[must_use]
    pub fn remarking(mut self, remarks: impl Iterator<Item = String>) -> Self {
        self.remarks.extend(remarks);
        self
    }

    /// Adds meanings of names.
    #[must_use]
    pub fn explaining(mut self, terms: Vec<Term>) -> Self {
        self.glossary.extend(terms);
        self
    }

    /// Adds groups with headings.
    #[must_use]
    pub fn grouping(mut self, groups: Vec<Group>) -> Self {
        self.groups.extend(groups);
        self
    }

    /// Adds a stage of named intermediate quantities.
    #[must_use]
    pub fn by_way_of(mut self, title: &str, values: Vec<Expr>) -> Self {
        self.stages.push(Stage {
            title: title.to_owned(),
            values,
        });
        self
    }
}

/// An array of expressions.
#[derive(Debug, Clone)]
pub struct Array {
    /// Its name.
    pub name: String,
    /// Its contents, one sentence.
    pub about: String,
    /// Its shape, and the labels of its entries.
    pub layout: Layout,
    /// Entries, row by row.
    pub entries: Vec<Expr>,
    /// Names of the entries in the computation.
    pub labels: Vec<String>,
    /// Labels of the rows and columns of a plain list or matrix.
    pub names: [Vec<String>; 2],
    /// Headings for the computation of the entries; entries without a heading are computed last.
    pub paragraphs: Vec<Paragraph>,
}

/// A heading for the computation of some entries.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Paragraph {
    /// One line.
    pub title: String,
    /// The entries.
    pub entries: Vec<usize>,
}

impl Array {
    /// An array whose entries are named by its name and their index.
    pub fn new(name: &str, about: &str, layout: Layout, entries: Vec<Expr>) -> Self {
        let labels = match entries.len() {
            1 => vec![name.to_owned()],
            count => (0..count).map(|i| format!("{name}_{i}")).collect(),
        };
        Self {
            name: name.to_owned(),
            about: about.to_owned(),
            layout,
            entries,
            labels,
            names: [Vec::new(), Vec::new()],
            paragraphs: Vec::new(),
        }
    }

    /// One number.
    pub fn scalar(name: &str, about: &str, entry: Expr) -> Self {
        Self::new(name, about, Layout::Scalar, vec![entry])
    }

    /// ẋ, with q̇ computed before the pseudo-accelerations.
    pub fn rates(info: &ModelInfo, entries: Vec<Expr>) -> Self {
        let (all, speeds) = (entries.len(), info.speeds.min(entries.len()));
        Self::new(
            "rates",
            "ẋ, the rates of the state.",
            Layout::Vector(Space::Rates),
            entries,
        )
        .labelled(
            info.states
                .iter()
                .map(|state| format!("{}_dot", state.name)),
        )
        .under("Generalised velocities.", speeds..all)
        .under("Appell's equations, solved.", 0..speeds)
    }

    /// A Jacobian of ẋ with respect to a vector, one paragraph per row; for the parameters one per
    /// column, because each column is the solution of one linear system.
    pub fn jacobian(
        name: &str,
        about: &str,
        info: &ModelInfo,
        by: Space,
        entries: Vec<Expr>,
    ) -> Self {
        let columns = by.quantities(info);
        let symbol = &name.to_uppercase();
        let labels = info.states.iter().flat_map(|row| {
            let label = move |column: &Quantity| format!("d_{}_dot_d_{}", row.name, column.name);
            columns.iter().map(label)
        });
        let layout = Layout::Jacobian(Space::Rates, by);
        let mut array = Self::new(name, about, layout, entries).labelled(labels);
        let (rows, width) = (info.states.len(), columns.len());
        if by == Space::Parameters {
            for (i, column) in columns.iter().enumerate() {
                let title = format!("Column `{}` of {symbol}.", column.name);
                array = array.under(&title, (0..rows).map(|row| row * width + i));
            }
            return array;
        }
        for (i, state) in info.states.iter().enumerate() {
            let title = format!("Row `{}_dot` of {symbol}.", state.name);
            array = array.under(&title, i * width..(i + 1) * width);
        }
        array
    }

    /// Renames the entries.
    #[must_use]
    pub fn labelled(mut self, labels: impl Iterator<Item = String>) -> Self {
        self.labels = labels.collect();
        self
    }

    /// Adds names of rows and columns.
    #[must_use]
    pub fn with_names(mut self, rows: Vec<String>, columns: Vec<String>) -> Self {
        self.names = [rows, columns];
        self
    }

    /// Adds a heading for some entries.
    #[must_use]
    pub fn under(mut self, title: &str, entries: impl IntoIterator<Item = usize>) -> Self {
        self.paragraphs.push(Paragraph {
            title: title.to_owned(),
            entries: entries.into_iter().collect(),
        });
        self
    }
}
