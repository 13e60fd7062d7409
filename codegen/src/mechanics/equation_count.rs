//! Checks that constraints and pseudo-velocities are as many as the coordinates.

use appell_spec::Code;
use appell_spec::mechanism::Mechanism;

use super::constraints::Constraints;
use super::finding::{Finding, Item, Outcome};
use super::row::Row;

/// One equation per coordinate.
pub(super) fn check_count(
    mechanism: &Mechanism,
    constraints: &Constraints,
    equations: usize,
) -> Outcome<()> {
    let coordinates = mechanism.coordinates.len();
    if equations == coordinates {
        return Ok(());
    }
    let named = |kept: &dyn Fn(&Row) -> bool| -> Vec<String> {
        let rows = constraints.rows.iter().filter(|row| kept(row));
        rows.map(|row| format!("`{}`", row.name)).collect()
    };
    let (counted, left_out) = (named(&Row::is_active), named(&|row| row.redundant));
    let (rows, speeds) = (counted.len(), mechanism.pseudo_velocities.len());
    let needed = coordinates.saturating_sub(rows);
    let kept = match counted.join(", ") {
        none if none.is_empty() => none,
        names => format!("counted are {names}; "),
    };
    let dropped = match &left_out[..] {
        [] => String::new(),
        [one] => format!("{one} is not counted, because it follows from the others; "),
        more => format!(
            "{} are not counted, because they follow from the others; ",
            more.join(", ")
        ),
    };
    let remark = kept + &dropped;
    let velocities = |n| count(n, "pseudo-velocity", "pseudo-velocities");
    let missing = speeds.saturating_sub(needed);
    Err(vec![Finding {
        code: Code::MissingPseudoVelocities,
        message: format!(
            "{} under {} need {}, found {speeds}",
            count(coordinates, "coordinate", "coordinates"),
            count(rows, "constraint row", "constraint rows"),
            velocities(needed),
        ),
        item: Item::Mechanism,
        help: if rows > coordinates {
            "remove constraints: there are more of them than coordinates".to_owned()
        } else if needed == 0 {
            format!("{remark}remove constraints: they leave no degree of freedom")
        } else if missing > 0 {
            let constraints = match missing {
                1 => "the missing constraint".to_owned(),
                more => format!("the {more} missing constraints"),
            };
            let needed = velocities(needed);
            format!("{remark}define exactly {needed}, or add {constraints}")
        } else {
            format!("{remark}define exactly {}", velocities(needed))
        },
    }])
}

fn count(number: usize, one: &str, more: &str) -> String {
    format!("{number} {}", if number == 1 { one } else { more })
}
