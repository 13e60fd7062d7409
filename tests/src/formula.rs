//! Formulas in the letters of the papers.

use appell_codegen::symbolic::{Expr, Graph};
pub use appell_papers::formula::{Scope, formula};

/// Reads lines `name = formula`. Each name can be used in later lines.
pub fn definitions(graph: &mut Graph, scope: &mut Scope, text: &str) -> Vec<(String, Expr)> {
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    lines
        .map(|line| {
            let (name, right) = line
                .split_once('=')
                .unwrap_or_else(|| panic!("no `=` in `{line}`"));
            let value = formula(graph, scope, right);
            scope.define(name.trim(), value);
            (name.trim().to_owned(), value)
        })
        .collect()
}
