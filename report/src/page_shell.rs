//! The document around all pages. Files are self-contained; pages of a server may link to style sheets.

use maud::{DOCTYPE, Markup, PreEscaped, html};

/// A page without its body.
#[derive(Debug, Clone, Copy)]
pub struct PageShell<'a> {
    /// Title of the window.
    pub title: &'a str,
    /// Style sheet.
    pub style: &'a str,
    /// Address of a style sheet, for pages that are not self-contained.
    pub sheet: Option<&'a str>,
    /// Content security policy, if any.
    pub policy: Option<&'a str>,
    /// Name space of the elements, for XML parsers.
    pub namespace: Option<&'a str>,
}

/// In HTML and in XML.
const HEAD: PreEscaped<&str> = PreEscaped(
    "<meta charset=\"utf-8\"/>\n\
     <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n",
);
const LINE: PreEscaped<&str> = PreEscaped("\n");

impl<'a> PageShell<'a> {
    /// With a title and a style sheet.
    pub const fn new(title: &'a str, style: &'a str) -> Self {
        Self {
            title,
            style,
            sheet: None,
            policy: None,
            namespace: None,
        }
    }

    /// The page.
    pub fn around(&self, body: &Markup) -> String {
        let page = html! {
            (DOCTYPE) (LINE)
            html lang="en" xmlns=[self.namespace] {
                (LINE)
                head {
                    (LINE) (HEAD)
                    @if let Some(policy) = self.policy {
                        meta http-equiv="Content-Security-Policy" content=(policy);
                        (LINE)
                    }
                    title { (self.title) } (LINE)
                    @match self.sheet {
                        Some(sheet) => { link rel="stylesheet" href=(sheet); (LINE) }
                        None => { style { (LINE) (PreEscaped(self.style)) } (LINE) }
                    }
                }
                (LINE)
                body { (LINE) (body) (LINE) }
                (LINE)
            }
            (LINE)
        };
        page.into_string()
    }
}
