//! Sentences of a spec that try to leave comments, strings and documents of emitted code.

use std::path::Path;
use std::process::Command;

use appell_codegen::c::{self, Real};
use appell_codegen::program::{FunctionKind, Program};
use appell_codegen::{compile, emit, fmu, python};
use proc_macro2::{TokenStream, TokenTree};

use crate::c_code::{compilers, folder};

/// Texts that terminate comments or strings in some language, alone and combined.
const HOSTILE: &[&str] = &[
    r"x *\ int pwned = 1; /\*",
    r"x *\\ int pwned = 1; /\\*",
    r"*\*\*\ int pwned = 1; /\/\/\*",
    "x */ int pwned = 1; /*",
    "x **// int pwned = 1; //**",
    "x *\u{200b}/ int pwned = 1; /\u{200b}*",
    "x *??/ int pwned = 1; /??/*",
    "what ??/\nint pwned = 1;",
    "what ????/ what \\",
    "\\\r\nint pwned = 1;\n",
    "// int pwned = 1; \\",
    "\u{2028}int pwned = 1;\u{2029}\u{85}int pwned = 1;\u{b}\u{c}",
    "\u{202e}\u{2066}\u{61c}hidden\u{2069}\u{202c}",
    "#include <pwned>\n#error pwned",
    "\"\"\"\nimport pwned\n\"\"\"",
    "'''\nimport pwned\n'''",
    "\\\"\\\"\\\" + __import__('pwned') + \\",
    "\\N{pwned} \\x \\u \\777 %s {0}",
    "\", __import__(\"pwned\"), \"",
    "\"; pub fn pwned() {} //",
    "\"### ; pub fn pwned() {} //",
    "*/ pub fn pwned() {} /*",
    "#![feature(pwned)] #[pwned]",
    "    pwned();",
    "```\npwned();\n```",
    "~~~rust",
    "<script>pwned()</script> &lt; ]]> --> <!--",
    "\0\u{1b}[31m\u{7f}",
];

/// A spec with a sentence in all places that have one.
fn spec(sentence: &str) -> String {
    let sentence: String = sentence
        .chars()
        .flat_map(|c| match c {
            ' '..='!' | '#'..='[' | ']'..='~' => vec![c],
            c => format!("\\U{:08X}", u32::from(c)).chars().collect(),
        })
        .collect();
    r#"
[mechanism]
name   = "evil"
title  = "SENTENCE"
source = "SENTENCE"
[parameters]
m = { value = 1, unit = "kg", about = "SENTENCE" }
I = { value = 1, unit = "kg*m^2", about = "SENTENCE" }
r = { value = 0.2, unit = "m", about = "SENTENCE" }
[definitions]
d = { value = "2*r", unit = "m", about = "SENTENCE" }
[coordinates]
x = { unit = "m", about = "SENTENCE" }
phi = { unit = "rad", about = "SENTENCE" }
[inputs]
F = { unit = "N", about = "SENTENCE" }
[frames]
wheel = { parent = "ground", about_axis = "y", by = "phi", about = "SENTENCE" }
[points]
C = { from = "O", in = "ground", at = ["x", 0, "r"], about = "SENTENCE" }
P = { from = "C", in = "ground", at = [0, 0, "-r"], about = "SENTENCE" }
[bodies]
wheel = { frame = "wheel", centre = "C", mass = "m", inertia = { in = "wheel", diagonal = ["I", "I", "I"] }, about = "SENTENCE" }
[constraints]
rolling = { kind = "rolling", body = "wheel", contact = "P", about = "SENTENCE" }
[pseudo_velocities]
v = { value = "dot(x)", unit = "m/s", about = "SENTENCE" }
[loads]
push = { kind = "force", on = "C", in = "ground", vector = ["F", 0, 0], about = "SENTENCE" }
[outputs]
o = { value = "d + x", unit = "m", about = "SENTENCE" }
"#
    .replace("SENTENCE", &sentence)
}

/// Programs of hostile sentences, each with its sentence, from files of hostile names; sentences that a spec
/// rejects occur in the name only.
fn programs() -> Vec<(&'static str, Program)> {
    let made = |&sentence: &&'static str| {
        let of = |text: &str| compile(sentence, &spec(text), &FunctionKind::STANDARD);
        let program = of(sentence).or_else(|_| of("a sentence"));
        (sentence, program.expect("a valid spec"))
    };
    HOSTILE.iter().map(made).collect()
}

fn harmless() -> Program {
    compile("evil.toml", &spec("a sentence"), &FunctionKind::STANDARD).expect("a valid spec")
}

/// The output of a program; fails with its standard error.
fn output(program: &str, folder: &Path, arguments: &[&str]) -> String {
    let output = (Command::new(program)
        .current_dir(folder)
        .args(arguments)
        .output())
    .expect("the program starts");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{program} {arguments:?}\n{told}");
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// Sources without comments, by each compiler, with trigraphs; one that ends a comment has more.
fn tokens(folder: &Path, files: &[(String, String)]) -> Vec<String> {
    let mut all = Vec::new();
    for (name, text) in files {
        std::fs::write(folder.join(name), text).expect("a file");
    }
    let arguments = [
        "-std=c99",
        "-trigraphs",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-Wcomment",
        "-fpreprocessed",
        "-E",
        "-P",
    ];
    for compiler in compilers() {
        for (name, _) in files.iter().filter(|(_, text)| !text.is_empty()) {
            let mut arguments = arguments.to_vec();
            arguments.push(name);
            all.push(output(compiler, folder, &arguments));
        }
    }
    all
}

#[test]
fn no_sentence_leaves_a_comment_of_c() {
    let options = c::Options {
        functions: FunctionKind::STANDARD.to_vec(),
        real: Real::Double,
        integrator: true,
    };
    let folder = folder("hostile", "c");
    let emitted = |program: &Program| {
        let emitted = c::emit(program, &options);
        let files = [("evil.h", emitted.header), ("evil.c", emitted.source)];
        tokens(&folder, &files.map(|(name, text)| (name.to_owned(), text)))
    };
    let expected = emitted(&harmless());
    for (sentence, program) in programs() {
        assert_eq!(emitted(&program), expected, "{sentence:?}");
    }
}

#[test]
fn no_sentence_leaves_a_text_of_an_fmu() {
    let folder = folder("hostile", "fmu");
    let own = |program: &Program| {
        let emitted = fmu::emit(program, fmu::InputsOfStep::Held);
        let own = emitted
            .sources
            .into_iter()
            .filter(|(name, _)| name.starts_with("evil"));
        let description = emitted.model_description;
        let elements = description.matches('<').count() + description.matches('>').count();
        (tokens(&folder, &own.collect::<Vec<_>>()), elements)
    };
    let expected = own(&harmless());
    for (sentence, program) in programs() {
        assert_eq!(own(&program), expected, "{sentence:?}");
    }
}

/// The syntax tree of a module without its documentation.
const TREE: &str = "
import ast, sys
tree = ast.parse(open(sys.argv[1], 'rb').read())
for node in ast.walk(tree):
    if isinstance(node, (ast.Module, ast.FunctionDef, ast.ClassDef)) and ast.get_docstring(node) is not None:
        del node.body[0]
print(ast.dump(tree))
";

#[test]
fn no_sentence_leaves_a_comment_of_python() {
    let folder = folder("hostile", "python");
    let tree = |program: &Program| {
        let module = python::module(program, &FunctionKind::STANDARD);
        std::fs::write(folder.join("evil.py"), module).expect("a file");
        output("python3", &folder, &["-W", "error", "-c", TREE, "evil.py"])
    };
    let expected = tree(&harmless());
    for (sentence, program) in programs() {
        assert_eq!(tree(&program), expected, "{sentence:?}");
    }
}

/// Tokens without documentation and with empty strings.
fn code(tokens: TokenStream) -> Vec<String> {
    let mut code = Vec::new();
    let mut tokens = tokens.into_iter().peekable();
    while let Some(token) = tokens.next() {
        match token {
            TokenTree::Punct(mark) if mark.as_char() == '#' => {
                let is_doc = |next: &TokenTree| next.to_string().starts_with("[doc =");
                if tokens.next_if(is_doc).is_none() {
                    code.push("#".to_owned());
                }
            }
            TokenTree::Group(group) => {
                code.push(format!("{:?}", group.delimiter()));
                code.extend(self::code(group.stream()));
            }
            TokenTree::Literal(literal) if literal.to_string().contains('"') => {
                code.push("\"\"".to_owned());
            }
            token => code.push(token.to_string()),
        }
    }
    // The printer ends lists over several lines with a comma.
    if code.last().is_some_and(|last| last == ",") {
        code.pop();
    }
    code
}

fn rust(program: &Program, spec: &str) -> emit::Emitted {
    let options = emit::Options {
        spec: Some(spec.to_owned()),
        ..emit::Options::default()
    };
    emit::emit(program, &options).expect("Rust")
}

/// The constant with the spec, as it is read.
fn spec_of(source: &str) -> String {
    let file = syn::parse_file(source).expect("Rust");
    let spec = file.items.iter().find_map(|item| match item {
        syn::Item::Const(item) if item.ident == "SPEC" => Some(&item.expr),
        _ => None,
    });
    let spec: syn::LitStr = syn::parse_quote!(#spec);
    spec.value()
}

#[test]
fn no_sentence_leaves_a_text_of_rust() {
    let code_of = |source: &str| code(source.parse().expect("tokens of Rust"));
    let expected = code_of(&rust(&harmless(), "").source);
    for (sentence, program) in programs() {
        let emitted = rust(&program, sentence);
        assert!(
            code_of(&emitted.source) == expected,
            "{sentence:?}\n{}",
            emitted.source
        );
        assert_eq!(spec_of(&emitted.source), sentence);
        // No block of code begins, which would be tried as an example.
        for document in [&emitted.source, &emitted.docs] {
            let lines = document.lines().map(|line| line.trim_start_matches("///"));
            let mut starts = lines
                .filter(|line| line.starts_with("     ") || line.trim_start().starts_with("~~~"));
            assert!(!starts.any(|line| line.contains("pwned")), "{sentence:?}");
        }
        let outside_code: String = emitted.docs.split('`').step_by(2).collect();
        assert!(!outside_code.replace("\\<", "").contains("<script>"));
    }
}

/// `rustc` allows 255 marks around a raw string.
#[test]
fn a_spec_with_many_marks_is_a_string_of_rust() {
    let program = harmless();
    for count in [253, 254, 255, 256, 400] {
        let spec = format!("a = \"{}\\", "#".repeat(count));
        let source = rust(&program, &spec).source;
        assert!(
            !source.contains(&"#".repeat(256)) || !source.contains("= r#"),
            "{count}"
        );
        assert_eq!(spec_of(&source), spec);
    }
}
