//! An open file: its newest text, syntax tree and equations.

use appell_spec::Reading;
use appell_spec::language::SECTIONS;
use appell_spec::occurrences::{Namespace, Occurrence, occurrences};
use appell_spec::outline::Outline;
use lsp_types::{Position, Uri};

use crate::equations::Contributions;
use crate::text::Text;

/// An open file.
pub(crate) struct Document {
    pub(crate) uri: Uri,
    /// Version number assigned by the editor.
    pub(crate) version: i32,
    /// Revision number assigned by the server.
    pub(crate) revision: u64,
    pub(crate) text: Text,
    pub(crate) outline: Outline,
    pub(crate) reading: Reading,
    pub(crate) occurrences: Vec<Occurrence>,
    /// The equations of the newest valid text, once they have been derived.
    pub(crate) contributions: Option<Contributions>,
}

impl Document {
    pub(crate) fn new(uri: Uri, version: i32, revision: u64, text: Text) -> Self {
        let outline = Outline::new(text.as_str());
        let reading = Reading::new(uri.as_str(), text.as_str());
        Self {
            occurrences: occurrences(text.as_str(), &reading.ast, &outline),
            uri,
            version,
            revision,
            text,
            outline,
            reading,
            contributions: None,
        }
    }

    /// Whether the text is meant as a spec: it names its mechanism, or its sections are those of a spec, some
    /// possibly misspelt.
    pub(crate) fn is_spec(&self) -> bool {
        let mut keys = self.outline.keys.iter().map(|key| key.path.as_slice());
        let names = || SECTIONS.iter().map(|section| section.name);
        let is_section = |path: &&[String]| names().any(|name| path[0] == name);
        let is_alike = |path: &[String]| {
            is_section(&path) || appell_spec::closest(&path[0], names()).is_some()
        };
        keys.clone().any(|path| path == ["mechanism", "name"])
            || keys.clone().any(|path| is_section(&path)) && keys.all(is_alike)
    }

    /// The name at a position, its end included.
    pub(crate) fn name_at(&self, position: Position) -> Option<&Occurrence> {
        let at = self.text.offset(position);
        let mut all = self.occurrences.iter();
        all.find(|name| name.span.start <= at && at <= name.span.end)
    }

    /// All occurrences of a name, in the order of the text.
    pub(crate) fn places<'a>(
        &'a self,
        namespace: Namespace,
        name: &'a str,
    ) -> impl Iterator<Item = &'a Occurrence> {
        let all = self.occurrences.iter();
        all.filter(move |place| place.namespace == namespace && place.name == name)
    }
}
