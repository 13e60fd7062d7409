//! Definition, references and renaming.

use appell_spec::occurrences::Occurrence;
use appell_spec::rename::{RenameError, rename};
use lsp_types::{
    DocumentChanges, GotoDefinitionResponse, Location, OneOf,
    OptionalVersionedTextDocumentIdentifier, Position, PrepareRenameResponse, TextDocumentEdit,
    TextEdit, WorkspaceEdit,
};

use crate::document::Document;

fn location(document: &Document, place: &Occurrence) -> Location {
    Location::new(document.uri.clone(), document.text.range(&place.span))
}

/// Where the name at a place is defined.
pub(crate) fn definition(
    document: &Document,
    position: Position,
) -> Option<GotoDefinitionResponse> {
    let name = document.name_at(position)?;
    let mut places = document.places(name.namespace, &name.name);
    let place = places.find(|place| place.defines)?;
    Some(GotoDefinitionResponse::Scalar(location(document, place)))
}

/// All references to the name at a position, optionally with its definition.
pub(crate) fn references(
    document: &Document,
    position: Position,
    with_definition: bool,
) -> Option<Vec<Location>> {
    let name = document.name_at(position)?;
    let places = document.places(name.namespace, &name.name);
    let wanted = places.filter(|place| with_definition || !place.defines);
    Some(wanted.map(|place| location(document, place)).collect())
}

/// The name at a position, if it can be renamed.
pub(crate) fn prepare(document: &Document, position: Position) -> Option<PrepareRenameResponse> {
    let name = document.name_at(position)?;
    let mut places = document.places(name.namespace, &name.name);
    places
        .any(|place| place.defines)
        .then(|| PrepareRenameResponse::RangeWithPlaceholder {
            range: document.text.range(&name.span),
            placeholder: name.name.clone(),
        })
}

/// The edits that rename the name at a position, or the reason why it cannot be renamed.
pub(crate) fn renamed(
    document: &Document,
    position: Position,
    new: &str,
) -> Result<Option<WorkspaceEdit>, RenameError> {
    let Some(name) = document.name_at(position) else {
        return Ok(None);
    };
    let text = document.text.as_str();
    let places = rename(text, name.namespace, &name.name, new)?;
    let edits = places
        .into_iter()
        .map(|(place, word)| OneOf::Left(TextEdit::new(document.text.range(&place), word)));
    let document = TextDocumentEdit {
        text_document: OptionalVersionedTextDocumentIdentifier {
            uri: document.uri.clone(),
            version: Some(document.version),
        },
        edits: edits.collect(),
    };
    Ok(Some(WorkspaceEdit {
        document_changes: Some(DocumentChanges::Edits(vec![document])),
        ..WorkspaceEdit::default()
    }))
}
