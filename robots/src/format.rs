//! The formats of robot files, recognised by their first element.

/// The format of a robot file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// Unified Robot Description Format, of ROS.
    Urdf,
    /// The format of `MuJoCo`.
    Mjcf,
}

impl Format {
    /// That of a text, which may be no robot file.
    pub fn of(text: &str) -> Option<Self> {
        Self::named(first_element(text)?)
    }

    /// That of a file whose first element has a name.
    pub(crate) fn named(root: &str) -> Option<Self> {
        match root {
            "robot" => Some(Self::Urdf),
            "mujoco" => Some(Self::Mjcf),
            _ => None,
        }
    }

    /// `URDF` or `MJCF`.
    pub fn word(self) -> &'static str {
        match self {
            Self::Urdf => "URDF",
            Self::Mjcf => "MJCF",
        }
    }
}

/// Name of the first element of an XML file, after declarations and comments.
pub(crate) fn first_element(text: &str) -> Option<&str> {
    let mut rest = text.trim_start_matches('\u{feff}').trim_start();
    loop {
        let skipped = [("<?", "?>"), ("<!--", "-->"), ("<!", ">")];
        let Some((_, end)) = skipped.iter().find(|(begin, _)| rest.starts_with(begin)) else {
            break;
        };
        rest = rest.split_once(end)?.1.trim_start();
    }
    let named = rest
        .strip_prefix('<')
        .filter(|rest| rest.starts_with(char::is_alphabetic))?;
    let end = named.find(|c: char| c.is_whitespace() || matches!(c, '>' | '/'))?;
    Some(&named[..end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_element_tells_the_format() {
        for (text, format) in [
            ("<robot name=\"a\">", Some(Format::Urdf)),
            ("<robot>", Some(Format::Urdf)),
            (
                "\u{feff}<?xml version=\"1.0\"?>\n<!-- <robot> -->\n<mujoco\n model=\"a\">",
                Some(Format::Mjcf),
            ),
            ("<!DOCTYPE robot>\n<mujoco/>", Some(Format::Mjcf)),
            ("<mujocoinclude><body/></mujocoinclude>", None),
            ("<!-- never closed <robot>", None),
            ("<robot", None),
            ("solid", None),
            ("", None),
        ] {
            assert_eq!(Format::of(text), format, "{text}");
        }
    }
}
