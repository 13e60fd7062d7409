//! The text of a spec with expanded joints.

use toml_edit::{DocumentMut, InlineTable, Item, Table, Value};

use crate::edit::EditError;

use super::made::Made;

/// Writes the items at the end of their sections. Comments of a joint are moved to its frame.
pub(super) fn replaced(
    text: &str,
    section: &str,
    made: &[(String, Vec<Made>)],
) -> Result<String, EditError> {
    let syntax = |error: toml_edit::TomlError| EditError::Syntax {
        message: error.message().to_owned(),
    };
    let mut document: DocumentMut = text.parse().map_err(syntax)?;
    let Some((heading, joints)) = document.remove_entry(section) else {
        return Ok(text.to_owned());
    };
    let place = joints.as_table().and_then(Table::position);
    let mut above = comments_of_key(&heading);
    if let Some(table) = joints.as_table() {
        above.extend(comments_in(table.decor()));
    }
    for (joint, items) in made {
        let mut comments = std::mem::take(&mut above);
        if let Some((key, item)) = joints
            .as_table_like()
            .and_then(|all| all.get_key_value(joint))
        {
            comments.extend(comments_of_key(key));
            collect(item, &mut comments);
        }
        for made in items {
            let Ok(Value::InlineTable(table)) = made.table.text.parse::<Value>() else {
                return Err(EditError::Syntax {
                    message: format!("the joint `{joint}` cannot be written out"),
                });
            };
            let is_frame = made.section == "frames" && made.name == *joint;
            let own: &[String] = if is_frame { &comments } else { &[] };
            insert(&mut document, place, made, table, own)?;
        }
    }
    Ok(document.to_string())
}

fn insert(
    document: &mut DocumentMut,
    place: Option<isize>,
    made: &Made,
    table: InlineTable,
    comments: &[String],
) -> Result<(), EditError> {
    let new = || {
        let mut section = Table::new();
        section.set_position(place);
        section.decor_mut().set_prefix("\n");
        Item::Table(section)
    };
    let section = document.entry(made.section).or_insert_with(new);
    let mut comments = comments.join("\n");
    if !comments.is_empty() {
        comments.push('\n');
    }
    if let Some(section) = section.as_table_mut()
        && !section.is_dotted()
        && section
            .iter()
            .any(|(_, item)| item.as_table().is_some_and(|table| !table.is_dotted()))
    {
        // After subtables with headers no keys of the section can follow.
        let mut own = table.into_table();
        own.decor_mut().set_prefix(format!("\n{comments}"));
        section.insert(&made.name, Item::Table(own));
        return Ok(());
    }
    let Some(section) = section.as_table_like_mut() else {
        return Err(EditError::Syntax {
            message: format!("`{}` is not a section", made.section),
        });
    };
    section.insert(&made.name, Item::Value(Value::InlineTable(table)));
    if !comments.is_empty()
        && let Some(mut key) = section.key_mut(&made.name)
    {
        key.leaf_decor_mut().set_prefix(comments);
    }
    Ok(())
}

/// The comments around a value and in it, in their order.
fn collect(item: &Item, found: &mut Vec<String>) {
    match item {
        Item::Table(table) => {
            found.extend(comments_in(table.decor()));
            keys(table.iter().map(|(name, _)| name), table, found);
        }
        Item::Value(value) => of_value(value, found),
        Item::None | Item::ArrayOfTables(_) => {}
    }
}

fn keys<'t>(
    names: impl Iterator<Item = &'t str>,
    table: &dyn toml_edit::TableLike,
    found: &mut Vec<String>,
) {
    for name in names {
        if let Some((key, item)) = table.get_key_value(name) {
            found.extend(comments_of_key(key));
            collect(item, found);
        }
    }
}

fn of_value(value: &Value, found: &mut Vec<String>) {
    let mut own = comments_in(value.decor());
    let after = own.split_off(comments(value.decor().prefix()).len());
    found.append(&mut own);
    match value {
        Value::Array(array) => {
            array.iter().for_each(|one| of_value(one, found));
            found.extend(comments(Some(array.trailing())));
        }
        Value::InlineTable(table) => keys(table.iter().map(|(name, _)| name), table, found),
        _ => {}
    }
    found.extend(after);
}

fn comments_of_key(key: &toml_edit::Key) -> Vec<String> {
    comments_in(key.leaf_decor())
}

fn comments_in(decor: &toml_edit::Decor) -> Vec<String> {
    let mut all = comments(decor.prefix());
    all.extend(comments(decor.suffix()));
    all
}

fn comments(text: Option<&toml_edit::RawString>) -> Vec<String> {
    let lines = text
        .and_then(toml_edit::RawString::as_str)
        .unwrap_or_default();
    let lines = lines.lines().map(str::trim);
    let lines = lines.filter(|line| line.starts_with('#'));
    lines.map(str::to_owned).collect()
}
