//! Parts and unknowns, numbered in the order in which a page defines them.

use super::{Block, Equation, Letter, Section, Span};

/// Numbers the letters with one of these `bases` in the order of their definitions; letters used without a
/// definition follow.
pub(super) fn by_definition(sections: &mut [Section], bases: [&str; 2]) {
    for base in bases {
        let mut order: Vec<String> = Vec::new();
        for definitions_only in [true, false] {
            each_letter(sections, definitions_only, &mut |letter| {
                if let Some(number) = number_of(letter, base)
                    && !order.contains(number)
                {
                    order.push(number.clone());
                }
            });
        }
        each_letter(sections, false, &mut |letter| {
            if let Some(number) = number_of(letter, base)
                && let Some(place) = order.iter().position(|known| known == number)
            {
                letter.below[0] = (place + 1).to_string();
            }
        });
    }
}

fn number_of<'a>(letter: &'a Letter, base: &str) -> Option<&'a String> {
    let first = letter.below.first()?;
    let is_number = first.bytes().all(|byte| byte.is_ascii_digit());
    (letter.base == base && is_number).then_some(first)
}

/// All letters of the sections, or only those that equations define: on the left, or anywhere in an implicit
/// equation.
fn each_letter(
    sections: &mut [Section],
    definitions_only: bool,
    change: &mut dyn FnMut(&mut Letter),
) {
    for block in sections.iter_mut().flat_map(|s| &mut s.blocks) {
        match block {
            Block::Equations(equations) => {
                for Equation { left, right, .. } in equations {
                    let is_implicit = left.is_integer("0");
                    left.for_each_letter(change);
                    if is_implicit || !definitions_only {
                        right.for_each_letter(change);
                    }
                }
            }
            Block::Sentence(spans) if !definitions_only => each_in_text(spans, change),
            Block::Table(table) if !definitions_only => {
                for row in &mut table.rows {
                    row.cells
                        .iter_mut()
                        .for_each(|cell| each_in_text(cell, change));
                }
            }
            _ => {}
        }
    }
}

fn each_in_text(spans: &mut [Span], change: &mut dyn FnMut(&mut Letter)) {
    for span in spans {
        if let Span::Math(math) = span {
            math.for_each_letter(change);
        }
    }
}
