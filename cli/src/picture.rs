//! Figures as SVG, or as PNG if the file name says so.

use std::path::Path;

use crate::failure::Error;
use appell::files;

/// Writes a figure, as PNG if the name ends in `.png`; `-` is standard output, as SVG.
pub(crate) fn write(path: &Path, svg: &str) -> Result<(), Error> {
    if path
        .extension()
        .is_some_and(|end| end.eq_ignore_ascii_case("png"))
    {
        let png = png(svg)?;
        Ok(files::write_with(path, |to| to.write_all(&png))?)
    } else {
        Ok(files::write(path, svg)?)
    }
}

/// The figure in its light colours, at twice its size.
#[cfg(feature = "png")]
fn png(svg: &str) -> Result<Vec<u8>, Error> {
    use resvg::tiny_skia::{Pixmap, Transform};
    use resvg::usvg::{Options, Tree};

    /// Pixels per unit of the figure.
    const SCALE: f32 = 2.0;
    let failed = |cause: String| {
        Error::Computation(format!("the figure cannot be converted to PNG: {cause}"))
    };
    let mut options = Options::default();
    let fonts = options.fontdb_mut();
    // The same letters on every machine, with the Greek ones and the dots above them.
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    let tree = Tree::from_str(svg, &options).map_err(|cause| failed(cause.to_string()))?;
    let size = tree.size().to_int_size().scale_by(SCALE);
    let pixels = size.and_then(|size| Pixmap::new(size.width(), size.height()));
    let mut pixels = pixels.ok_or_else(|| failed("it has no size".to_owned()))?;
    let scale = Transform::from_scale(SCALE, SCALE);
    resvg::render(&tree, scale, &mut pixels.as_mut());
    pixels
        .encode_png()
        .map_err(|cause| failed(cause.to_string()))
}

#[cfg(not(feature = "png"))]
fn png(_: &str) -> Result<Vec<u8>, Error> {
    let help = "this program was built without PNG support: choose a name that ends in .svg, or build \
    with `--features png`";
    Err(Error::Usage(help.to_owned()))
}
