//! Shapes as files: OBJ, STL and PLY, each as text, the last two in binary too.

use std::fmt::Write;

use super::shapes::{Point, Shape};

/// Faces of four corners where two triangles in a row share their first and last, as those of a cube do.
pub fn obj(shape: &Shape) -> Vec<u8> {
    let mut text = String::from("# ours\nmtllib none.mtl\no body\n");
    shape.vertices.iter().for_each(|v| writeln!(text, "v {} {} {}", v.x, v.y, v.z).unwrap());
    text += "vn 0 0 1\nvt 0 0\nusemtl none\ns off\n";
    let mut rest = &shape.triangles[..];
    while let [[a, b, c], more @ ..] = rest {
        let corner = |number: &u32| format!(" {}/1/1", number + 1);
        match more {
            [[d, e, f], more @ ..] if d == a && e == c => {
                writeln!(text, "f{}{}{}{}", corner(a), corner(b), corner(c), corner(f)).unwrap();
                rest = more;
            }
            more => {
                writeln!(text, "f{}{}{}", corner(a), corner(b), corner(c)).unwrap();
                rest = more;
            }
        }
    }
    text.into_bytes()
}

fn corners(shape: &Shape) -> impl Iterator<Item = [Point; 3]> {
    shape.triangles.iter().map(|corners| corners.map(|corner| shape.vertices[corner as usize]))
}

/// Two solids.
pub fn stl_text(shape: &Shape) -> Vec<u8> {
    let mut text = String::from("solid one\n");
    for (number, corners) in corners(shape).enumerate() {
        if number == shape.triangles.len() / 2 {
            text += "endsolid one\nsolid\n";
        }
        text += " facet normal nan 0 0\n  outer loop\n";
        corners.iter().for_each(|v| writeln!(text, "   vertex {:e} {:e} {:e}", v.x, v.y, v.z).unwrap());
        text += "  endloop\n endfacet\n";
    }
    (text + "endsolid\n").into_bytes()
}

/// With a name that looks like text.
pub fn stl_binary(shape: &Shape) -> Vec<u8> {
    let mut bytes = format!("{:80}", "solid as text would begin").into_bytes();
    bytes.extend((shape.triangles.len() as u32).to_le_bytes());
    for corners in corners(shape) {
        bytes.extend([0; 12]);
        bytes.extend(corners.iter().flatten().flat_map(|c| (*c as f32).to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

pub fn ply_text(shape: &Shape) -> Vec<u8> {
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment ours\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar uint vertex_index\nend_header\n",
        shape.vertices.len(),
        shape.triangles.len()
    );
    shape.vertices.iter().for_each(|v| writeln!(text, "{} {} {}", v.x, v.y, v.z).unwrap());
    shape.triangles.iter().for_each(|[a, b, c]| writeln!(text, "3 {a} {b} {c}").unwrap());
    text.into_bytes()
}

/// Doubles, with a colour between them.
pub fn ply_binary(shape: &Shape, big_endian: bool) -> Vec<u8> {
    let order = if big_endian { "big" } else { "little" };
    let mut bytes = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n\
         property uchar red\nproperty double z\nelement face {}\nproperty uchar flags\n\
         property list uchar int vertex_indices\nend_header\n",
        shape.vertices.len(),
        shape.triangles.len()
    )
    .into_bytes();
    let double = |c: f64| if big_endian { c.to_be_bytes() } else { c.to_le_bytes() };
    for v in &shape.vertices {
        bytes.extend([double(v.x), double(v.y)].concat());
        bytes.push(200);
        bytes.extend(double(v.z));
    }
    for corners in &shape.triangles {
        bytes.extend([0, 3]);
        let corner = |c: u32| if big_endian { c.to_be_bytes() } else { c.to_le_bytes() };
        bytes.extend(corners.iter().flat_map(|c| corner(*c)));
    }
    bytes
}
