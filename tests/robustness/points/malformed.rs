//! Every way we know in which a file of points can be wrong, and what is said about it.

use std::path::Path;

use snowlab_study::points::{read, write};

use super::file;

/// The refusal of a file, behind its name.
fn refusal<const D: usize>(path: &Path) -> String {
    let message = read::<D>(path).expect_err("the file should be refused").to_string();
    let name = path.display().to_string();
    message.strip_prefix(&name).unwrap_or_else(|| panic!("{message:?} does not name the file")).to_string()
}

/// Content, and what the refusal says behind the name of the file.
type Refused<'a> = (&'a [u8], &'a [&'a str]);

#[test]
fn each_malformed_csv_is_refused_with_its_line_and_a_remedy() {
    let long_line = [b"x,y\n1,".to_vec(), vec![b'1'; 1 << 20], b"\n".to_vec()].concat();
    let open_quote = [b"name,x,y\n\"a,1,2\n".to_vec(), b"b,1,2\n".repeat(1 << 18)].concat();
    let table: &[Refused] = &[
        (b"", &[": the file is empty; give it a header"]),
        (b"\n \r\n# only words\n", &[": the file is empty; give it a header"]),
        (b"x;y\n1,5;2\n", &[", line 2: `x`: field 1 is `1,5`; a number such as 0.25"]),
        (b"x,y\n1,2\n3,nan\n", &[", line 3: `y` is NaN; only finite numbers"]),
        (b"x,y\n1,2\n3,1e400\n", &[", line 3: `y` is inf; only finite numbers"]),
        (b"1,-inf\n", &[", line 1: `y` is -inf; only finite numbers"]),
        (b"x,y,vx,vy\n1,2,nan,0\n", &[", line 2: `vx` is NaN"]),
        (b"x,y\n\n# note\n1,2,3\n", &[", line 4: 3 field(s), but the first line has 2; give every line"]),
        (b"x,y\r\n1,2\r\n1\r\n", &[", line 3: 1 field(s), but the first line has 2"]),
        (b"x,y\n1,\n", &[", line 2: `y`: field 2 is ``; a number"]),
        (b"x,y\n1,0x10\n", &[", line 2: `y`: field 2 is `0x10`; a number"]),
        (b"x,y\n1,\x07\n", &["field 2 is `\\u{7}`"]),
        (b"x,vx\n1,2\n", &[", line 1: in the header", "`y` is missing; found `x vx`, needed are x, y"]),
        (b"a,b\n1,2\n", &[", line 1: in the header, separated by ',': `x` is missing"]),
        (b"0.5,two\n1,2\n", &["`x` is missing; found `0.5 two`", "numbers alone counts as no header"]),
        (b"x,y,X\n1,2,3\n", &[", line 1: in the header", "`x` is there twice; name each column once"]),
        (b"x,y,mass,MASS\n1,2,3,4\n", &["`mass` is there twice"]),
        (b"7\n8\n", &[", line 1: there is no header and each line has 1 number(s)", "name the columns"]),
        (b"1,2,3,4\n", &[", line 1: there is no header and each line has 4 number(s)"]),
        (b"x,y,mass\n1,2,0\n", &[", line 2: `mass` is 0.0; allowed is 1e-100 to 1e100 kg: correct it"]),
        (b"x,y,mass\n1,2,-1\n", &[", line 2: `mass` is -1.0; allowed"]),
        (b"x,y,mass\n1,2,nan\n", &[", line 2: `mass` is NaN; allowed"]),
        (b"x,y\n1,2\n\xff\xfe,3\n", &[", line 3: this is not UTF-8 text; save the file as UTF-8"]),
        (b"\xff\xfex\0,\0y\0\n\0", &[", line 1: this is not UTF-8 text"]),
        (
            b"x,y,z\n1,2,0\n1,2,0.25\n",
            &[", line 3: point 1 (from 0) has a z or vz other than 0", "set them all"],
        ),
        (&long_line, &[", line 2: the line is longer than 1048576 bytes"]),
        (&open_quote, &["a quote (\") is opened in line 2 and not closed; close it"]),
    ];
    for (content, parts) in table {
        let (_directory, path) = file("points.csv", content);
        let message = refusal::<2>(&path);
        let start = String::from_utf8_lossy(&content[..content.len().min(60)]);
        let missing: Vec<_> = parts.iter().filter(|part| !message.contains(*part)).collect();
        assert!(missing.is_empty(), "{start:?}: {message:?} lacks {missing:?}");
    }
    let (_directory, path) = file("points.csv", "x,y\n1,2\n");
    assert_eq!(
        refusal::<3>(&path),
        ": `z` is missing, so the points are 2D; add a column z to read them in 3D"
    );
}

/// A PLY with this header behind `format`, and data.
fn ply(format: &str, header: &str, data: &[u8]) -> Vec<u8> {
    [format!("ply\nformat {format} 1.0\n{header}end_header\n").as_bytes(), data].concat()
}

#[test]
fn each_malformed_ply_is_refused_with_its_place_and_a_remedy() {
    let (ascii, little) = ("ascii", "binary_little_endian");
    let vertex = |count: &str| format!("element vertex {count}\nproperty float x\nproperty float y\n");
    let two = [1f32, 2.0].map(f32::to_le_bytes).concat();
    let bad = [1f32, f32::NAN].map(f32::to_le_bytes).concat();
    let huge = u64::MAX.to_string();
    let list = |count: &str| format!("element face 1\nproperty list {count} double i\n{}", vertex("1"));
    let table: Vec<(Vec<u8>, &[&str])> = vec![
        (b"".to_vec(), &[": a PLY file begins with a line `ply`"]),
        (b"solid cube\n".to_vec(), &[", line 1: a PLY file begins with a line `ply`"]),
        (b"\x89PNG\r\n\x1a\n".to_vec(), &[", line 1: this is not UTF-8 text"]),
        (
            b"ply\nformat ascii 1.0\n".to_vec(),
            &[", line 2: the file ends in its header, before `end_header`"],
        ),
        (
            b"ply\nelement vertex 0\nproperty float x\nproperty float y\nend_header\n".to_vec(),
            &["the header has no `format`; add"],
        ),
        (ply("ascii2", "", b""), &[", line 2: `ascii2` is no format; allowed are ascii, binary"]),
        (ply(ascii, "format ascii 2.0\n", b""), &[", line 3: `format ascii 2.0` is no line of a PLY header"]),
        (ply(ascii, "elephant\n", b""), &[", line 3: `elephant` is no line of a PLY header; allowed"]),
        (ply(ascii, &vertex("-1"), b""), &[", line 3: element `vertex` counts `-1` rows; a whole number"]),
        (ply(ascii, &vertex("1e3"), b""), &["counts `1e3` rows; a whole number from 0"]),
        (
            ply(ascii, &vertex("18446744073709551616"), b""),
            &["a whole number from 0 to 18446744073709551615"],
        ),
        (
            ply(ascii, &vertex("1").replace("float x", "real x"), b""),
            &[", line 4: `real` is no type; allowed"],
        ),
        (ply(ascii, "property float x\n", b""), &[", line 3: property `x` stands before any element"]),
        (ply(ascii, &list("float"), b""), &[", line 4: list `i` is counted by a float; use a whole type"]),
        (ply(ascii, "element face 0\n", b""), &[": the header has no `element vertex`"]),
        (ply(ascii, &vertex("0").repeat(2), b""), &[": the header has `element vertex` twice"]),
        (ply(ascii, "element vertex 1\nproperty float x\n", b"1\n"), &["`element vertex`: `y` is missing"]),
        (
            ply(ascii, "element vertex 1\nproperty float x\nproperty list uchar float y\n", b"1 1 1\n"),
            &["`y` is missing"],
        ),
        (ply(ascii, &(vertex("1") + "property int x\n"), b"1 2 3\n"), &["`x` is there twice"]),
        (
            ply(ascii, &(huge_empty(&huge) + &vertex("1")), b"1 2\n"),
            &["element `void`", "no property; give it one"],
        ),
        (ply(little, &(huge_empty(&huge) + &vertex("1")), &two), &["element `void`", "no property"]),
        // Counts beyond what is there: refused where the data end, before any memory is taken for them.
        (
            ply(ascii, &vertex(&huge), b"1 2\n"),
            &["vertex 1 (from 0): the file ends here", "promises 18446744073709551615 rows"],
        ),
        (
            ply(little, &vertex(&huge), &two),
            &[": vertex 1 (from 0): the file ends here", "correct the count"],
        ),
        (ply(little, &vertex("2"), &[&two[..], &two[..5]].concat()), &[": vertex 1 (from 0): the file ends"]),
        (
            ply(little, &format!("element face {huge}\nproperty double a\n{}", vertex("1")), &two),
            &[": element `face`, row 1 (from 0): the file ends here"],
        ),
        (ply(little, &list("uint"), &[255; 40]), &[": element `face`, row 0 (from 0): the file ends here"]),
        (
            ply(little, &list("int"), &[255; 40]),
            &[": element `face`, row 0 (from 0): list `i` counts -1 items"],
        ),
        (
            ply(ascii, &list("int"), b"-1\n1 2\n"),
            &["element `face`, row 0 (from 0): list `i` counts `-1` items"],
        ),
        (
            ply(ascii, &list("int"), b"99999999999 1\n1 2\n"),
            &[", line 9: element `face`", "the line ends before `i`"],
        ),
        (ply(ascii, &vertex("2"), b"1 2\n3\n"), &[", line 8: vertex 1 (from 0): the line ends before `y`"]),
        (
            ply(ascii, &vertex("1"), b"1 2 3\n"),
            &[", line 7: vertex 0 (from 0): `3` follows the last property"],
        ),
        (ply(ascii, &vertex("1"), b"1 two\n"), &[", line 7: vertex 0 (from 0): `y` is `two`; a number"]),
        (
            ply(ascii, &vertex("2"), b"1 2\n1 inf\n"),
            &[", line 8: vertex 1 (from 0): `y` is inf; only finite"],
        ),
        (ply(ascii, &vertex("1"), b"1 \xff\n"), &[", line 7: this is not UTF-8 text"]),
        (
            ply(little, &vertex("2"), &[&two[..], &bad[..]].concat()),
            &[": vertex 1 (from 0): `y` is NaN; only finite"],
        ),
        (
            ply(ascii, &vertex("1"), b"1 2\n3 4\n"),
            &[", line 8: data follow the last row", "correct its counts"],
        ),
        (ply(little, &vertex("1"), &two.repeat(2)), &[": data follow the last row that the header promises"]),
        (
            ply(ascii, &(vertex("1") + "property float mass\n"), b"1 2 0\n"),
            &[", line 8: vertex 0 (from 0): `mass` is 0.0; allowed"],
        ),
        (
            ply(ascii, &(vertex("2") + "property float z\n"), b"1 2 0\n1 2 3\n"),
            &[", line 9: point 1 (from 0) has a z or vz other than 0"],
        ),
        (
            [b"ply\ncomment ".to_vec(), vec![b'a'; 1 << 20]].concat(),
            &[", line 2: the line is longer than 1048576 bytes"],
        ),
    ];
    for (content, parts) in table {
        let (_directory, path) = file("points.ply", &content);
        let message = refusal::<2>(&path);
        let start = String::from_utf8_lossy(&content[..content.len().min(200)]);
        let missing: Vec<_> = parts.iter().filter(|part| !message.contains(*part)).collect();
        assert!(missing.is_empty(), "{start:?}: {message:?} lacks {missing:?}");
    }
}

fn huge_empty(count: &str) -> String {
    format!("element void {count}\n")
}

#[test]
fn files_that_are_no_files_of_points_are_refused() {
    let (directory, path) = file("points.vtp", "x,y\n1,2\n");
    assert_eq!(refusal::<2>(&path), ": `.vtp` is not a format of points; use .csv or .ply");
    assert!(write::<2>(&path, &[]).unwrap_err().to_string().contains("use .csv or .ply"));
    assert_eq!(
        refusal::<2>(&directory.path().join("points")),
        ": a name without ending is not a format of points; use .csv or .ply"
    );
    assert!(refusal::<2>(&directory.path().join("absent.csv")).contains("No such file"));
    std::fs::create_dir(directory.path().join("room.ply")).unwrap();
    assert!(refusal::<2>(&directory.path().join("room.ply")).contains("directory"));
    assert!(write::<2>(&directory.path().join("absent/a.csv"), &[]).is_err());
}
