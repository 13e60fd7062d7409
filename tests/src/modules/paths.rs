//! The paths that the code of a crate writes.

use proc_macro2::{Delimiter, TokenStream, TokenTree};
use quote::ToTokens;
use syn::Item;

use super::names::{self, ModuleId, Tree};

/// A path, segment by segment.
pub(super) type Path = Vec<String>;

/// Every path of every module, with the file that it stands in.
pub(super) fn all(tree: &Tree) -> Vec<(ModuleId, String, Path)> {
    let mut all = Vec::new();
    for (id, module) in tree.modules.iter().enumerate() {
        let mut found = Vec::new();
        for item in &module.items {
            match item {
                Item::Use(item) if names::is_reexport(&item.vis) => {}
                Item::Use(item) => {
                    let imports = names::imports(&item.tree).into_iter();
                    found.extend(imports.map(|import| import.path));
                }
                item => scan(item.to_token_stream(), &[], &mut found),
            }
        }
        all.extend(
            found
                .into_iter()
                .map(|path| (id, module.file.clone(), path)),
        );
    }
    all
}

/// Finds the paths among tokens, those of macro arguments too, which no grammar describes. `prefix`
/// is what stands before the braces of a `use`.
fn scan(tokens: TokenStream, prefix: &[String], found: &mut Vec<Path>) {
    let mut path: Path = prefix.to_vec();
    // What stands between the last name and the next.
    let mut between = if prefix.is_empty() {
        String::new()
    } else {
        "::".to_owned()
    };
    let mut is_method = false;
    for token in tokens {
        match token {
            TokenTree::Ident(name) => {
                if between != "::" {
                    note(std::mem::take(&mut path), is_method, false, found);
                    is_method = between == ".";
                    path = prefix.to_vec();
                }
                path.push(name.to_string());
                between.clear();
            }
            TokenTree::Punct(sign) => between.push(sign.as_char()),
            TokenTree::Group(group) => {
                let within = group.delimiter() == Delimiter::Brace && between == "::";
                let inner: &[String] = if within { &path } else { &[] };
                scan(group.stream(), inner, found);
                let called = group.delimiter() == Delimiter::Parenthesis && between.is_empty();
                let called = called || between == "!";
                note(std::mem::take(&mut path), is_method, called, found);
                path = prefix.to_vec();
                ",".clone_into(&mut between);
            }
            TokenTree::Literal(_) => between.push('0'),
        }
    }
    note(path, is_method, false, found);
}

/// Keeps what may name an item: a name alone in small letters is one only where it is called.
fn note(path: Path, is_method: bool, called: bool, found: &mut Vec<Path>) {
    let is_small = |name: &String| name.starts_with(|c: char| c.is_lowercase() || c == '_');
    match path.as_slice() {
        [] => {}
        [name] if is_method || is_small(name) && !called => {}
        _ => found.push(path),
    }
}
