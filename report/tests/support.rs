//! Pages of the shipped mechanisms, and a reader that takes them at their word.
#![expect(clippy::unwrap_used, reason = "a test may stop here")]

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::LazyLock;

use appell_codegen::mechanics::derive;
use appell_report::derivation::{self, Block, Equation, Letter, Math, Page, Span, Stage};
use appell_spec::Mechanism;
use appell_test_kit::Random;

/// What two sides of an equation may differ by: they are sums of tens of terms of order 10³.
const TOLERANCE: f64 = 1e-8;

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../generated/mechanisms")
}

/// Names of the shipped mechanisms.
fn shipped() -> Vec<String> {
    let mut names: Vec<String> = std::fs::read_dir(folder())
        .unwrap()
        .filter_map(|entry| Some(entry.unwrap().path().file_stem()?.to_str()?.to_owned()))
        .collect();
    names.sort();
    names
}

/// Text of a shipped spec.
pub(crate) fn spec(name: &str) -> String {
    std::fs::read_to_string(folder().join(format!("{name}.toml"))).unwrap()
}

/// Page of a shipped mechanism.
pub(crate) fn page_of(name: &str, stage: Stage) -> Page {
    page_of_spec(&spec(name), stage)
}

/// Page of the mechanism of a spec.
pub(crate) fn page_of_spec(text: &str, stage: Stage) -> Page {
    written(&mechanism(text), stage)
}

/// Names of all shipped mechanisms with their whole pages.
pub(crate) static WHOLE: LazyLock<Vec<(String, Page)>> = LazyLock::new(|| pages(Stage::All));
/// The same with the pages of their equations.
pub(crate) static EQUATIONS: LazyLock<Vec<(String, Page)>> =
    LazyLock::new(|| pages(Stage::Equations));

fn pages(stage: Stage) -> Vec<(String, Page)> {
    let names = shipped();
    let page = |name: &String| (name.clone(), page_of(name, stage));
    let (first, second) = names.split_at(names.len() / 2);
    let written = |names: &[String]| names.iter().map(page).collect::<Vec<_>>();
    std::thread::scope(|scope| {
        let second = scope.spawn(|| written(second));
        let mut pages = written(first);
        pages.extend(second.join().unwrap());
        pages
    })
}

/// The whole page of a spec after changes that no spec can hold.
pub(crate) fn page_after(text: &str, change: impl FnOnce(&mut Mechanism)) -> Page {
    let mut mechanism = mechanism(text);
    change(&mut mechanism);
    written(&mechanism, Stage::All)
}

fn mechanism(text: &str) -> Mechanism {
    appell_spec::load("spec.toml", text)
        .unwrap_or_else(|report| panic!("{report:?}"))
        .mechanism
}

fn written(mechanism: &Mechanism, stage: Stage) -> Page {
    let mut derivation = derive(mechanism).unwrap_or_else(|findings| panic!("{findings:?}"));
    derivation::page(mechanism, &mut derivation, stage).unwrap()
}

/// Every element closes, in order.
pub(crate) fn assert_well_formed(html: &str) {
    let mut open: Vec<&str> = Vec::new();
    for part in html.split('<').skip(1) {
        let Some((tag, _)) = part.split_once('>') else {
            panic!("`<{part}` does not close")
        };
        let name = tag.split_whitespace().next().unwrap();
        if let Some(name) = name.strip_prefix('/') {
            assert_eq!(open.pop(), Some(name), "</{name}> closes another element");
        } else if !tag.ends_with('/') && !matches!(name, "!DOCTYPE" | "meta") {
            open.push(name);
        }
    }
    assert_eq!(open, Vec::<&str>::new());
}

type Values = HashMap<String, f64>;

/// Gives every quantity of the page a value, then reads all equations: what defines a letter gives
/// it a value, everything else must hold. Returns how many equations were compared.
pub(crate) fn check(page: &Page, seed: u64) -> usize {
    let mut values = Values::new();
    let mut dice = Random::new(seed);
    let mut random = || dice.between(0.3, 1.1);
    let mut given = |letter: &Letter| {
        values.entry(letter.to_string()).or_insert_with(&mut random);
    };
    for block in page.sections.iter().flat_map(|s| &s.blocks) {
        let Block::Table(table) = block else { continue };
        for cell in table.rows.iter().map(|row| &row.cells[0]) {
            match cell.as_slice() {
                [Span::Math(Math::Letter(letter))] if letter.before.is_none() => given(letter),
                // A pseudo-velocity with its definition.
                [Span::Math(Math::Row(row))] => match row.as_slice() {
                    [Math::Letter(letter), Math::Sign("="), _] if !letter.bold => given(letter),
                    _ => {}
                },
                _ => {}
            }
        }
    }
    values.insert("π".to_owned(), std::f64::consts::PI);
    let equations: Vec<&Equation> = page
        .sections
        .iter()
        .flat_map(|s| &s.blocks)
        .filter_map(|block| match block {
            Block::Equations(all) => Some(all),
            _ => None,
        })
        .flatten()
        .collect();
    loop {
        let before = values.len();
        for equation in &equations {
            define(equation, &mut values);
        }
        if values.len() == before {
            break;
        }
    }
    let mut compared = 0;
    for equation in equations {
        let (Some(left), Some(right)) = (
            value(&equation.left, &values),
            value(&equation.right, &values),
        ) else {
            continue;
        };
        let scale = 1.0 + left.abs().max(right.abs());
        assert!(
            (left - right).abs() <= TOLERANCE * scale,
            "{}: {left} is not {right} in {equation:?}",
            page.title
        );
        compared += usize::from(!matches!(equation.left, Math::Letter(_)));
    }
    compared
}

fn define(equation: &Equation, values: &mut Values) {
    match (&equation.left, &equation.right) {
        (Math::Letter(letter), Math::Matrix(rows)) if letter.base == "M" => {
            for (i, row) in rows.iter().enumerate() {
                for (j, entry) in row.iter().enumerate() {
                    let name = Letter::plain("M")
                        .below(&format!("{}{}", i + 1, j + 1))
                        .to_string();
                    if let Some(value) = value(entry, values) {
                        values.entry(name).or_insert(value);
                    }
                }
            }
        }
        (Math::Letter(letter), right) if !letter.bold && letter.before.is_none() => {
            if let Some(value) = value(right, values) {
                values.entry(letter.to_string()).or_insert(value);
            }
        }
        _ => {}
    }
}

fn value(math: &Math, values: &Values) -> Option<f64> {
    Some(match math {
        Math::Integer(digits) => digits.parse().unwrap(),
        Math::Ratio(n, d) => n.parse::<f64>().unwrap() / d.parse::<f64>().unwrap(),
        Math::Letter(letter) => *values.get(&letter.to_string())?,
        Math::Row(factors) => {
            let mut product = 1.0;
            for factor in factors {
                product *= value(factor, values)?;
            }
            product
        }
        Math::Sum(terms) => {
            let mut sum = 0.0;
            for (minus, term) in terms {
                let term = value(term, values)?;
                sum += if *minus { -term } else { term };
            }
            sum
        }
        Math::Fraction(above, below) => value(above, values)? / value(below, values)?,
        Math::Power(base, exponent) => value(base, values)?.powf(value(exponent, values)?),
        Math::Call(name, exponent, argument) => {
            let x = value(argument, values)?;
            let result = match *name {
                "sin" => x.sin(),
                "cos" => x.cos(),
                "tan" => x.tan(),
                "tanh" => x.tanh(),
                _ => return None,
            };
            result.powi(i32::try_from(*exponent).unwrap())
        }
        Math::Root(inner) => value(inner, values)?.sqrt(),
        Math::Size(inner) => value(inner, values)?.abs(),
        Math::Brackets(inner) => value(inner, values)?,
        Math::Words(_)
        | Math::Sign(_)
        | Math::Vector { .. }
        | Math::Matrix(_)
        | Math::Cases { .. } => {
            return None;
        }
    })
}
