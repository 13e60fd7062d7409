//! The paths that the code of a crate writes.

use proc_macro2::{TokenStream, TokenTree};
use syn::visit::{self, Visit};

use super::names::{self, ModuleId, Tree};

/// Every path of every module, with the file that it stands in.
pub(super) fn all(tree: &Tree) -> Vec<(ModuleId, String, Vec<String>)> {
    let mut all = Vec::new();
    for (id, module) in tree.modules.iter().enumerate() {
        let mut paths = Paths::default();
        for item in &module.items {
            paths.visit_item(item);
        }
        let found = paths.found.into_iter().filter(|path| !path.is_empty());
        all.extend(found.map(|path| (id, module.file.clone(), path)));
    }
    all
}

#[derive(Default)]
struct Paths {
    found: Vec<Vec<String>>,
}

impl<'ast> Visit<'ast> for Paths {
    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if !names::is_reexport(&item.vis) {
            let imports = names::imports(&item.tree).into_iter();
            self.found.extend(imports.map(|import| import.path));
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let segments = path.segments.iter();
        self.found
            .push(segments.map(|segment| segment.ident.to_string()).collect());
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast syn::Macro) {
        if let Some(name) = call.path.get_ident() {
            self.found.push(vec![format!("{name}!")]);
        }
        self.tokens(call.tokens.clone());
        visit::visit_macro(self, call);
    }
}

impl Paths {
    /// The paths among the arguments of a macro, which no grammar describes.
    fn tokens(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Ident(name) => {
                    if colons != 2 {
                        self.found.push(std::mem::take(&mut path));
                    }
                    path.push(name.to_string());
                    colons = 0;
                }
                TokenTree::Punct(sign) if sign.as_char() == ':' => colons += 1,
                other => {
                    self.found.push(std::mem::take(&mut path));
                    colons = 0;
                    if let TokenTree::Group(group) = other {
                        self.tokens(group.stream());
                    }
                }
            }
        }
        self.found.push(path);
    }
}
