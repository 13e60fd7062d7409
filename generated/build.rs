//! Compiles every spec in `mechanisms/` and writes the list of them.

use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use appell_codegen::build::{Build, Generated, write};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=mechanisms");
    let mut specs = Vec::new();
    for entry in std::fs::read_dir("mechanisms")? {
        let path = entry?.path();
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            specs.push(path);
        }
    }
    specs.sort();
    let generated = Build::new().specs(specs).run();
    let out_dir = PathBuf::from(std::env::var("OUT_DIR")?);
    write(&out_dir.join("registry.rs"), &registry(&generated)?)?;
    Ok(())
}

/// A module per mechanism, and the list of all.
fn registry(generated: &[Generated]) -> Result<String, Box<dyn Error>> {
    let mut text = String::new();
    let mut list = String::new();
    for one in generated {
        let name = &one.program.info.name;
        if Path::new(&one.spec)
            .file_stem()
            .is_none_or(|stem| stem != name.as_ref())
        {
            return Err(format!(
                "{}: the file should be named {name}.toml",
                one.spec.display()
            )
            .into());
        }
        write!(
            text,
            r#"
#[allow(missing_docs, non_snake_case, non_upper_case_globals, unused_imports, unused_variables, clippy::all, clippy::pedantic)]
pub mod {name} {{
    #![doc = include_str!(concat!(env!("OUT_DIR"), "/{name}.md"))]

    include!(concat!(env!("OUT_DIR"), "/{name}.rs"));

    /// The text of this module, as it was compiled.
    pub const SOURCE: &str = include_str!(concat!(env!("OUT_DIR"), "/{name}.rs"));
}}
"#
        )?;
        let mut costs = String::new();
        for (kind, count) in &one.emitted.costs {
            write!(costs, "(\"{kind:?}\", \"{count}\"), ")?;
        }
        writeln!(
            list,
            "    Shipped {{ name: \"{name}\", file: {file:?}, spec: {name}::SPEC, code: {name}::SOURCE, \
             model: &{name}::{model}, costs: &[{costs}] }},",
            file = one.spec.to_string_lossy().replace('\\', "/"),
            model = one.emitted.model,
        )?;
    }
    write!(
        text,
        "\n/// Every shipped mechanism, by name.\npub static ALL: &[Shipped] = &[\n{list}];\n"
    )?;
    Ok(text)
}
