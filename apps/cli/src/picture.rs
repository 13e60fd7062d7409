//! Figures as SVG, PNG or PDF, by the name of the file.

use std::path::Path;

use crate::destinations::extension;
use crate::failure::Error;
use appell::files;

/// File format of a figure.
#[derive(Clone, Copy)]
enum Format {
    Svg,
    Png,
    Pdf,
}

impl Format {
    /// By the extension; SVG without one, and for standard output.
    fn of(path: &Path) -> Result<Self, Error> {
        let Some(end) = extension(path) else {
            return Ok(Self::Svg);
        };
        match end.as_str() {
            "svg" => Ok(Self::Svg),
            "png" => Ok(Self::Png),
            "pdf" => Ok(Self::Pdf),
            other => Err(Error::Usage(format!(
                "a figure cannot be written as `.{other}`: choose a name that ends in .svg, .png or .pdf"
            ))),
        }
    }
}

/// Writes a figure in the format of its extension; `-` is standard output, as SVG.
pub(crate) fn write(path: &Path, svg: &str) -> Result<(), Error> {
    let bytes = match Format::of(path)? {
        Format::Svg => return Ok(files::write(path, svg)?),
        Format::Png => converted::png(svg)?,
        Format::Pdf => converted::pdf(svg)?,
    };
    Ok(files::write_with(path, |to| to.write_all(&bytes))?)
}

#[cfg(feature = "png")]
mod converted {
    use resvg::tiny_skia::{Pixmap, Transform};
    use resvg::usvg::{Options, Tree};
    use svg2pdf::{ConversionOptions, PageOptions, to_pdf};

    use crate::failure::Error;

    /// Pixels per unit of the figure.
    const SCALE: f32 = 2.0;

    fn failed(cause: &impl ToString) -> Error {
        let cause = cause.to_string();
        Error::Computation(format!("the figure cannot be converted: {cause}"))
    }

    fn tree(svg: &str) -> Result<Tree, Error> {
        let mut options = Options::default();
        let fonts = options.fontdb_mut();
        // The same letters on every machine, with the Greek ones and the dots above them.
        fonts.load_font_data(dejavu::sans::regular().to_vec());
        fonts.set_sans_serif_family("DejaVu Sans");
        Tree::from_str(svg, &options).map_err(|cause| failed(&cause))
    }

    /// The figure in its light colours, at twice its size.
    pub(super) fn png(svg: &str) -> Result<Vec<u8>, Error> {
        let tree = tree(svg)?;
        let size = tree.size().to_int_size().scale_by(SCALE);
        let pixels = size.and_then(|size| Pixmap::new(size.width(), size.height()));
        let mut pixels = pixels.ok_or_else(|| failed(&"it has no size"))?;
        let scale = Transform::from_scale(SCALE, SCALE);
        resvg::render(&tree, scale, &mut pixels.as_mut());
        pixels.encode_png().map_err(|cause| failed(&cause))
    }

    /// The figure in its light colours, on a page of its size.
    pub(super) fn pdf(svg: &str) -> Result<Vec<u8>, Error> {
        let tree = tree(svg)?;
        to_pdf(&tree, ConversionOptions::default(), PageOptions::default())
            .map_err(|cause| failed(&cause))
    }
}

#[cfg(not(feature = "png"))]
mod converted {
    use crate::failure::Error;

    pub(super) fn png(_: &str) -> Result<Vec<u8>, Error> {
        Err(Error::Usage(
            "this program was built without PNG and PDF: choose a name that ends in .svg, or build with \
             `--features png`"
                .to_owned(),
        ))
    }

    pub(super) fn pdf(svg: &str) -> Result<Vec<u8>, Error> {
        png(svg)
    }
}
