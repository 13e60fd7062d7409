//! Volume and inertia of meshes: STL, binary or as text, and OBJ. As in `MuJoCo`, pyramids from an inner point over
//! the faces have positive volume, which is exact for convex meshes.

use crate::inertia::{Inertia, of_triangles};
use crate::rotation::{Vector, add, cross, dot, minus, scaled};
use crate::xml::{Element, children};

use super::Reader;

/// Bytes of a binary STL before its triangles, and of each.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

/// Three corners.
pub(crate) type Triangle = [Vector; 3];

impl<'x> Reader<'x, '_> {
    /// Volume of a mesh, and its inertia with a mass of 1; in words why not.
    pub(super) fn mesh(&self, root: Element<'x>, name: &str) -> Result<(f64, Inertia), String> {
        let assets = children(root, "asset").flat_map(|asset| children(asset, "mesh"));
        let element = assets
            .into_iter()
            .find(|mesh| called(*mesh).as_deref() == Some(name))
            .ok_or_else(|| format!("there is no mesh `{}`", appell_spec::shown(name)))?;
        let given = self.given(element, "mesh", element.attribute("class"));
        let scale = match given.attribute("scale") {
            Some(_) => given
                .exactly("scale", "three factors, x y z,")
                .ok_or("its scale is not known")?,
            None => [1.0; 3],
        };
        for (key, usual) in [
            ("inertia", "legacy"),
            ("refpos", "0 0 0"),
            ("refquat", "1 0 0 0"),
        ] {
            if given.word(key).is_some_and(|word| word != usual) {
                return Err(format!("its `{key}` is read as `{usual}` only"));
            }
        }
        let file = given
            .attribute("file")
            .ok_or("a mesh without a file is not read")?;
        let compiler = |key: &str| {
            let all = children(root, "compiler").filter_map(|element| element.attribute(key));
            all.last()
        };
        let folder = compiler("meshdir").or_else(|| compiler("assetdir"));
        let folder = folder.map(|folder| folder.trim_end_matches('/'));
        let named = match compiler("strippath") {
            Some("true") => file.value().rsplit(['/', '\\']).next().unwrap_or_default(),
            _ => file.value(),
        };
        let found = self.whole.beside(&file.range(), folder, named);
        let (path, bytes) = found.map_err(|why| {
            let named = [folder, Some(named)].into_iter().flatten();
            let named = named.collect::<Vec<_>>().join("/");
            format!(
                "its file `{}` cannot be read: {why}",
                appell_spec::shown(&named)
            )
        })?;
        let triangles =
            triangles(&path, &bytes).ok_or_else(|| format!("`{path}` is no mesh as STL or OBJ"))?;
        let scaled_by = |corner: Vector| [0, 1, 2].map(|k| corner[k] * scale[k]);
        let triangles: Vec<Triangle> = (triangles.into_iter())
            .map(|corners| corners.map(scaled_by))
            .collect();
        let pyramids = pyramids(&triangles);
        of_triangles(&pyramids).ok_or_else(|| format!("`{path}` has no volume"))
    }
}

/// The name of an asset, that of its file where it has none itself.
pub(super) fn called(asset: Element<'_>) -> Option<String> {
    let stem = |file: &str| {
        let file = file.rsplit(['/', '\\']).next().unwrap_or(file);
        file.rsplit_once('.')
            .map_or(file, |(stem, _)| stem)
            .to_owned()
    };
    let own = asset.attribute("name").map(str::to_owned);
    own.or_else(|| asset.attribute("file").map(stem))
}

/// Tetrahedra over the faces from the centre of the surface.
fn pyramids(triangles: &[Triangle]) -> Vec<[Vector; 4]> {
    let (mut area, mut moment) = (0.0, [0.0; 3]);
    for &[a, b, c] in triangles {
        let normal = cross(minus(b, a), minus(c, a));
        let own = dot(normal, normal).sqrt();
        area += own;
        moment = add(moment, scaled(add(a, add(b, c)), own / 3.0));
    }
    let apex = if area > 0.0 {
        scaled(moment, 1.0 / area)
    } else {
        moment
    };
    triangles.iter().map(|&[a, b, c]| [apex, a, b, c]).collect()
}

fn triangles(path: &str, bytes: &[u8]) -> Option<Vec<Triangle>> {
    let ends = |with: &str| path.to_ascii_lowercase().ends_with(with);
    if ends(".obj") {
        return wavefront(std::str::from_utf8(bytes).ok()?);
    }
    if ends(".stl") {
        return binary(bytes).or_else(|| text(std::str::from_utf8(bytes).ok()?));
    }
    None
}

/// A binary STL: a head, a count, and for each triangle a normal, three corners and two bytes.
fn binary(bytes: &[u8]) -> Option<Vec<Triangle>> {
    let count = u32::from_le_bytes(bytes.get(80..HEAD)?.try_into().ok()?);
    let body = bytes.get(HEAD..)?;
    if body.len() != usize::try_from(count).ok()?.checked_mul(TRIANGLE)? {
        return None;
    }
    let number = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
    let corner = |bytes: &[u8]| [0, 4, 8].map(|at| f64::from(number(&bytes[at..])));
    let triangle = |one: &[u8]| [12, 24, 36].map(|at| corner(&one[at..]));
    Some(body.chunks_exact(TRIANGLE).map(triangle).collect())
}

/// An STL as text: three lines `vertex x y z` for each triangle.
fn text(text: &str) -> Option<Vec<Triangle>> {
    let lines = text.lines().map(str::trim_start);
    let corners = lines.filter_map(|line| line.strip_prefix("vertex "));
    let corners = corners.map(vector).collect::<Option<Vec<Vector>>>()?;
    let all = corners.chunks_exact(3);
    let is_whole = !corners.is_empty() && all.remainder().is_empty();
    is_whole.then(|| all.map(|c| [c[0], c[1], c[2]]).collect())
}

/// An OBJ: corners, and faces by their numbers, fans of triangles.
fn wavefront(text: &str) -> Option<Vec<Triangle>> {
    let (mut corners, mut triangles): (Vec<Vector>, Vec<Triangle>) = (Vec::new(), Vec::new());
    for line in text.lines().map(str::trim) {
        if let Some(rest) = line.strip_prefix("v ") {
            corners.push(vector(rest)?);
        } else if let Some(rest) = line.strip_prefix("f ") {
            let place = |word: &str| {
                let number: i64 = word.split('/').next()?.parse().ok()?;
                let count = i64::try_from(corners.len()).ok()?;
                // From 1, or backwards from the end.
                let index = if number < 0 {
                    count + number
                } else {
                    number - 1
                };
                corners.get(usize::try_from(index).ok()?).copied()
            };
            let face = rest.split_whitespace().map(place);
            let face = face.collect::<Option<Vec<Vector>>>()?;
            let fans = face.windows(2).skip(1);
            triangles.extend(fans.map(|pair| [face[0], pair[0], pair[1]]));
        }
    }
    Some(triangles)
}

fn vector(text: &str) -> Option<Vector> {
    let mut numbers = text
        .split_whitespace()
        .map_while(|word| word.parse::<f64>().ok());
    Some([numbers.next()?, numbers.next()?, numbers.next()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A box from the origin to a corner, as OBJ with faces of four corners.
    const BOX: &str = "v 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 4\nv 2 0 4\nv 2 3 4\nv 0 3 4\n\
                       f 1 4 3 2\nf 5 6 7 8\nf 1/1 2/2 6/3 5/4\nf 2 3 7 6\nf -5 -1 -2 -6\nf 4 1 5 8\n";

    #[test]
    fn a_box_has_the_inertia_of_a_box() {
        let triangles = triangles("box.OBJ", BOX.as_bytes()).expect("a mesh");
        assert_eq!(triangles.len(), 12);
        let (volume, inertia) = of_triangles(&pyramids(&triangles)).expect("a mesh");
        assert!((volume - 24.0).abs() < 1e-12);
        for (ours, theirs) in inertia.centre.iter().zip([1.0, 1.5, 2.0]) {
            assert!((ours - theirs).abs() < 1e-12);
        }
        let moments = [25.0 / 12.0, 20.0 / 12.0, 13.0 / 12.0, 0.0, 0.0, 0.0];
        for (ours, theirs) in inertia.tensor.iter().zip(moments) {
            assert!((ours - theirs).abs() < 1e-12, "{:?}", inertia.tensor);
        }
    }

    #[test]
    fn both_forms_of_stl_are_read() {
        let text = "solid a\nfacet normal 0 0 1\n outer loop\n  vertex 0 0 1\n  vertex 1 0 1.5\n  vertex 0 1 1\n endloop\nendfacet\nendsolid a\n";
        let told = triangles("a.stl", text.as_bytes()).expect("a mesh");
        let mut bytes = vec![0; 80];
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend([0; 12]);
        for number in [0.0_f32, 0.0, 1.0, 1.0, 0.0, 1.5, 0.0, 1.0, 1.0] {
            bytes.extend(number.to_le_bytes());
        }
        bytes.extend([0; 2]);
        assert_eq!(triangles("a.stl", &bytes).expect("a mesh"), told);
        assert_eq!(triangles("a.stl", &bytes[..100]), None);
        assert_eq!(triangles("a.obj", b"f 1 2 9"), None);
    }
}
