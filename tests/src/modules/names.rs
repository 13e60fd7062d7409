//! The modules of a crate and what their names stand for.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use syn::{Attribute, Item, UseTree, Visibility};

/// Longer chains of re-exports are circles.
const MOST_STEPS: usize = 32;

/// A module by its number.
pub(super) type ModuleId = usize;

/// The modules of a crate, the root first.
#[derive(Default)]
pub(super) struct Tree {
    pub(super) modules: Vec<Module>,
    /// `macro_rules!` by name, each with its file.
    macros: BTreeMap<String, String>,
}

/// A module, in a file of its own or inside another.
pub(super) struct Module {
    /// Path below `src`.
    pub(super) file: String,
    parent: Option<ModuleId>,
    children: BTreeMap<String, ModuleId>,
    defined: BTreeSet<String>,
    /// Names that `use` brings in, each with what it stands for.
    imported: BTreeMap<String, Vec<String>>,
    globs: Vec<Vec<String>>,
    /// Its code.
    pub(super) items: Vec<Item>,
}

/// What a name stands for.
#[derive(Clone)]
enum Meaning {
    Module(ModuleId),
    Item(ModuleId, String),
}

/// A path of a `use` item.
pub(super) struct Import {
    pub(super) path: Vec<String>,
    /// Its name here; none for a glob.
    name: Option<String>,
}

impl Tree {
    pub(super) fn read(root: &Path) -> Self {
        let mut tree = Self::default();
        let source = root.parent().unwrap();
        tree.file(source, root, source, None);
        tree
    }

    /// Reads the module of one file; those that it declares lie in `folder`.
    fn file(
        &mut self,
        source: &Path,
        path: &Path,
        folder: &Path,
        parent: Option<ModuleId>,
    ) -> ModuleId {
        let text = std::fs::read_to_string(path)
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let parsed =
            syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        let file = path.strip_prefix(source).unwrap();
        let file = file.to_string_lossy().replace('\\', "/");
        self.module(source, &file, folder, parsed.items, parent)
    }

    fn module(
        &mut self,
        source: &Path,
        file: &str,
        folder: &Path,
        items: Vec<Item>,
        parent: Option<ModuleId>,
    ) -> ModuleId {
        let id = self.modules.len();
        self.modules.push(Module {
            file: file.to_owned(),
            parent,
            children: BTreeMap::new(),
            defined: BTreeSet::new(),
            imported: BTreeMap::new(),
            globs: Vec::new(),
            items: Vec::new(),
        });
        for item in items {
            if is_test(attributes(&item)) {
                continue;
            }
            match item {
                Item::Mod(inner) => {
                    let name = inner.ident.to_string();
                    let below = folder.join(&name);
                    let child = if let Some((_, items)) = inner.content {
                        self.module(source, file, &below, items, Some(id))
                    } else {
                        let beside = folder.join(format!("{name}.rs"));
                        let path = if beside.exists() {
                            beside
                        } else {
                            below.join("mod.rs")
                        };
                        self.file(source, &path, &below, Some(id))
                    };
                    self.modules[id].children.insert(name, child);
                }
                item => {
                    self.declare(id, &item);
                    self.modules[id].items.push(item);
                }
            }
        }
        id
    }

    /// Notes the names that an item gives its module.
    fn declare(&mut self, id: ModuleId, item: &Item) {
        let module = &mut self.modules[id];
        if let Item::Use(item) = item {
            for import in imports(&item.tree) {
                match import.name {
                    Some(name) => {
                        module.imported.insert(name, import.path);
                    }
                    None => module.globs.push(import.path),
                }
            }
        } else if let Item::Macro(item) = item {
            if let Some(name) = &item.ident {
                let file = module.file.clone();
                self.macros.insert(name.to_string(), file);
            }
        } else if let Some(name) = name_of(item) {
            module.defined.insert(name);
        }
    }

    /// The file that defines what a path names, and the item as it is called there. Nothing for
    /// modules, locals and what lies outside the crate.
    pub(super) fn definition(
        &self,
        module: ModuleId,
        path: &[String],
    ) -> Option<(&String, String)> {
        match (self.meaning(module, path, 0), path) {
            (Some(Meaning::Item(module, name)), _) => Some((&self.modules[module].file, name)),
            // Macros are known wherever they stand.
            (None, [name]) => self.macros.get(name).map(|file| (file, format!("{name}!"))),
            (Some(Meaning::Module(_)) | None, _) => None,
        }
    }

    fn meaning(&self, module: ModuleId, path: &[String], steps: usize) -> Option<Meaning> {
        let (first, mut rest) = path.split_first()?;
        let mut meaning = match first.as_str() {
            "crate" => Meaning::Module(0),
            "self" => Meaning::Module(module),
            "super" => Meaning::Module(self.modules[module].parent?),
            name => self.named(module, name, steps)?,
        };
        while let (Meaning::Module(inner), Some((name, others))) = (&meaning, rest.split_first()) {
            meaning = match name.as_str() {
                "super" => Meaning::Module(self.modules[*inner].parent?),
                name => self.named(*inner, name, steps)?,
            };
            rest = others;
        }
        Some(meaning)
    }

    /// What a name stands for in a module.
    fn named(&self, id: ModuleId, name: &str, steps: usize) -> Option<Meaning> {
        if steps > MOST_STEPS {
            return None;
        }
        let module = &self.modules[id];
        if let Some(&child) = module.children.get(name) {
            // A function may share the name of the module that it stands in.
            let same = module.imported.get(name).filter(|path| path.len() > 1);
            let same = same.and_then(|path| self.meaning(id, path, steps + 1));
            return Some(same.unwrap_or(Meaning::Module(child)));
        }
        if module.defined.contains(name) {
            return Some(Meaning::Item(id, name.to_owned()));
        }
        if let Some(path) = module.imported.get(name) {
            // `use name::…` of another crate stands for no name of this module.
            return if path[0] == name {
                None
            } else {
                self.meaning(id, path, steps + 1)
            };
        }
        module
            .globs
            .iter()
            .find_map(|path| match self.meaning(id, path, steps + 1)? {
                Meaning::Module(other) if other != id => self.named(other, name, steps + 1),
                Meaning::Module(_) | Meaning::Item(..) => None,
            })
    }
}

/// The paths of a `use` item.
pub(super) fn imports(tree: &UseTree) -> Vec<Import> {
    fn walk(tree: &UseTree, path: &mut Vec<String>, found: &mut Vec<Import>) {
        match tree {
            UseTree::Path(step) => {
                path.push(step.ident.to_string());
                walk(&step.tree, path, found);
                path.pop();
            }
            UseTree::Name(last) => {
                let own = last.ident == "self";
                let name = last.ident.to_string();
                let full = if own {
                    path.clone()
                } else {
                    [path.as_slice(), &[name]].concat()
                };
                let name = full.last().cloned();
                found.push(Import { path: full, name });
            }
            UseTree::Rename(last) => {
                let own = last.ident == "self";
                let name = last.ident.to_string();
                let full = if own {
                    path.clone()
                } else {
                    [path.as_slice(), &[name]].concat()
                };
                let name = Some(last.rename.to_string());
                found.push(Import { path: full, name });
            }
            UseTree::Glob(_) => found.push(Import {
                path: path.clone(),
                name: None,
            }),
            UseTree::Group(group) => {
                for tree in &group.items {
                    walk(tree, path, found);
                }
            }
        }
    }
    let mut found = Vec::new();
    walk(tree, &mut Vec::new(), &mut found);
    found
}

/// Whether a `use` hands on what it names.
pub(super) fn is_reexport(visibility: &Visibility) -> bool {
    !matches!(visibility, Visibility::Inherited)
}

fn name_of(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::TraitAlias(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        _ => return None,
    };
    Some(name.to_string())
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// Whether an item is there in tests only.
fn is_test(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("cfg")
            && attribute
                .parse_args::<syn::Ident>()
                .is_ok_and(|word| word == "test")
    })
}
