//! Bodies from meshes: the same shape from every format, where it is told to be, and what follows from the file.

use std::f64::consts::PI;
use std::path::Path;

use snowlab_solver::Vector;
use snowlab_study::assemble::{Assembly, assemble};
use snowlab_study::cost::extents;
use snowlab_study::memory::of_case;
use snowlab_study::results::Archive;
use snowlab_study::spec::{self, SceneSpec};
use snowlab_study::sweep::Study;
use tempfile::TempDir;

use crate::made::shapes::{Point, Shape, cube, icosphere};
use crate::made::written;

/// A scene in which one body has the region and placement of the given words.
fn scene(region: &str, placement: &str, more: &str) -> String {
    format!(
        "dimension = 3\n[numerics]\nspacing = 0.05\n[[body]]\nregion = {region}\nplacement = {placement}\n{more}\n\
         [output]\nframe_interval = 1e-4\nend = 2e-4\n"
    )
}

fn mesh(path: &str, more: &str) -> String {
    format!("{{ kind = \"mesh\", path = \"{path}\"{more} }}")
}

const RANDOM: &str = "{ kind = \"random\", count = 400 }";

fn built(text: &str, folder: &Path) -> Assembly<f64, 3> {
    assemble::<f64, 3>(&spec::parse::<SceneSpec>(text).expect(text), folder).expect(text)
}

fn positions(text: &str, folder: &Path) -> Vec<Vector<f64, 3>> {
    let state = built(text, folder).state;
    (0..state.len()).map(|p| state.world_position(p)).collect()
}

fn folder_with(files: &[(&str, Vec<u8>)]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    files.iter().for_each(|(name, bytes)| std::fs::write(folder.path().join(name), bytes).unwrap());
    folder
}

/// A ball whose coordinates single precision has too.
fn ball() -> Shape {
    icosphere(3).mapped(|v| v.map(|c| f64::from(c as f32)))
}

#[test]
fn every_format_has_the_same_particles() {
    for shape in [ball(), cube()] {
        let folder = folder_with(&[
            ("text.obj", written::obj(&shape)),
            ("text.stl", written::stl_text(&shape)),
            ("binary.STL", written::stl_binary(&shape)),
            ("text.ply", written::ply_text(&shape)),
            ("little.ply", written::ply_binary(&shape, false)),
            ("big.ply", written::ply_binary(&shape, true)),
        ]);
        let of = |name: &str| positions(&scene(&mesh(name, ", scale = 0.3"), RANDOM, ""), folder.path());
        let expected = of("text.obj");
        assert_eq!(expected.len(), 400);
        for name in ["text.stl", "binary.STL", "text.ply", "little.ply", "big.ply"] {
            assert_eq!(of(name), expected, "{name}");
        }
    }
}

#[test]
fn a_mesh_is_a_body_as_a_ball_is() {
    let folder = folder_with(&[("ball.ply", written::ply_binary(&icosphere(4), false))]);
    let placed = mesh("ball.ply", ", scale = 0.25, centre = [0.5, -1.0, 2.0]");
    let ball = "{ kind = \"ball\", centre = [0.5, -1.0, 2.0], radius = 0.25 }";
    let [of_mesh, of_ball] = [&placed[..], ball]
        .map(|region| built(&scene(region, RANDOM, "velocity = [0.0, 0.0, -5.0]"), folder.path()));
    let near =
        |found: f64, expected: f64| assert!((found / expected - 1.0).abs() < 0.01, "{found} for {expected}");
    near(of_mesh.made.mass, of_ball.made.mass);
    near(of_mesh.made.mass, 400.0 * 4.0 / 3.0 * PI * 0.25_f64.powi(3));
    near(of_mesh.made.crossing_time, of_ball.made.crossing_time);
    near(of_mesh.made.particles_per_cell, of_ball.made.particles_per_cell);
    let [of_mesh, of_ball] =
        [&placed[..], ball].map(|region| spec::parse::<SceneSpec>(&scene(region, RANDOM, "")).unwrap());
    let width = |scene: &SceneSpec| extents(scene, folder.path()).unwrap();
    assert_eq!(width(&of_mesh).len(), 3);
    width(&of_mesh).iter().zip(width(&of_ball)).for_each(|(found, expected)| near(*found, expected));
    // The mesh itself is 5120 triangles more.
    let memory = |scene: &SceneSpec| of_case(scene, folder.path(), None).unwrap();
    let more = memory(&of_mesh) - memory(&of_ball);
    assert!((1e6..5e6).contains(&more), "{more} bytes");
}

/// A plank of 3 x 1 x 1, its middle at (1, 0, 0), turned in every way.
#[test]
fn a_mesh_is_turned_and_put_where_the_scene_says() {
    let plank = cube().mapped(|v| Point::new(1.5 * v.x + 1.0, 0.5 * v.y, 0.5 * v.z));
    let folder = folder_with(&[("plank.obj", written::obj(&plank))]);
    for (more, middle, half) in [
        ("", [1.0, 0.0, 0.0], [1.5, 0.5, 0.5]),
        (", scale = 2.0", [2.0, 0.0, 0.0], [3.0, 1.0, 1.0]),
        (", centre = [0.0, 5.0, 0.0]", [0.0, 5.0, 0.0], [1.5, 0.5, 0.5]),
        (", rotation = [0.0, 0.0, 90.0]", [0.0, 1.0, 0.0], [0.5, 1.5, 0.5]),
        (", rotation = [0.0, 90.0, 0.0]", [0.0, 0.0, -1.0], [0.5, 0.5, 1.5]),
        // About x, which leaves it, then about z, which lays it along y.
        (", rotation = [90.0, 0.0, 90.0]", [0.0, 1.0, 0.0], [0.5, 1.5, 0.5]),
        // To y by the turn about z, were that the first; the turn about x then would raise it.
        (", up = \"y\", rotation = [0.0, 0.0, 90.0]", [0.0, 1.0, 0.0], [0.5, 1.5, 0.5]),
    ] {
        let placement = "{ kind = \"random\", count = 4000 }";
        let points = positions(&scene(&mesh("plank.obj", more), placement, ""), folder.path());
        let bounds = points.iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[min, max], point| {
            [0, 1].map(|end| {
                [0, 1, 2].map(|k| if end == 0 { point[k].min(min[k]) } else { point[k].max(max[k]) })
            })
        });
        for k in 0..3 {
            let (least, greatest) = (middle[k] - half[k], middle[k] + half[k]);
            let short = [bounds[0][k] - least, greatest - bounds[1][k]];
            assert!(
                short.iter().all(|s| (-1e-9..0.02 * half[k]).contains(s)),
                "{more}: axis {k}: {bounds:?}"
            );
        }
    }
    // What a file calls up comes to stand up.
    let tower = cube().mapped(|v| Point::new(v.x, 3.0 * v.y, v.z + 7.0));
    std::fs::write(folder.path().join("tower.obj"), written::obj(&tower)).unwrap();
    let points = positions(&scene(&mesh("tower.obj", ", up = \"y\""), RANDOM, ""), folder.path());
    assert!(
        points.iter().any(|x| x.z > 2.0)
            && points.iter().all(|x| x.z.abs() < 3.0 && (-8.0..-6.0).contains(&x.y))
    );
}

#[test]
fn meshes_take_every_placement_and_are_joined_and_cut() {
    let folder = folder_with(&[("ball.obj", written::obj(&icosphere(2)))]);
    let one = mesh("ball.obj", ", scale = 0.3");
    let ball = "{ kind = \"ball\", centre = [0.3, 0.0, 0.0], radius = 0.2 }";
    let joined = format!("{{ kind = \"union\", parts = [{one}, {ball}] }}");
    let cut = format!("{{ kind = \"difference\", solid = {one}, removed = {ball} }}");
    let hollow = format!(
        "{{ kind = \"difference\", solid = {one}, removed = {} }}",
        mesh("ball.obj", ", scale = 0.2")
    );
    for kind in ["random", "jittered", "lattice", "poisson-disk"] {
        let placement = format!("{{ kind = \"{kind}\", count = 300 }}");
        for region in [&one, &joined, &cut, &hollow] {
            let points = positions(&scene(region, &placement, ""), folder.path());
            assert_eq!(points.len(), 300, "{kind}: {region}");
            let in_ball = |x: &Vector<f64, 3>| (x - Vector::<f64, 3>::new(0.3, 0.0, 0.0)).norm() < 0.2;
            assert_eq!(points.iter().any(in_ball), region == &one || region == &joined || region == &hollow);
            assert_eq!(points.iter().any(|x| x.norm() < 0.18), region != &hollow, "{kind}: {region}");
        }
    }
    let more = "voids = { kind = \"gaussian-field\", porosity = 0.2, correlation_length = 0.1, judged_at = 0.02 }\n\
                heterogeneity = { kind = \"shell\", of = \"stiffness\", factor = 5.0, thickness = 0.05 }\nphase_shift = 0.05";
    let made =
        built(&scene(&one, "{ kind = \"random\", count = 2000, count_of = \"solid\" }", more), folder.path());
    assert!((made.made.porosity - 0.2).abs() < 0.01, "{}", made.made.porosity);
    assert_eq!(made.made.particles, 1600);
    assert!(made.made.phase.iter().any(|shift| *shift > 0.0));
    let stiff = made.state.constants.stiffness_scale.iter().filter(|scale| **scale == 5.0).count();
    // A shell of a sixth of the radius is 1 - (5/6)^3 = 0.42 of a ball, and a little more of what is inscribed.
    assert!((550..850).contains(&stiff), "{stiff}");
}

#[test]
fn the_key_of_a_case_goes_with_its_mesh() {
    let folder =
        folder_with(&[("a.stl", written::stl_binary(&cube())), ("b.stl", written::stl_binary(&cube()))]);
    let inner = format!("{{ kind = \"union\", parts = [{}, {}] }}", mesh("a.stl", ""), mesh("b.stl", ""));
    let text = scene(&inner, RANDOM, "").replace("dimension", "[scene]\ndimension");
    let text = text.replace("[numerics]", "[scene.numerics]").replace("[[body]]", "[[scene.body]]");
    let study = "name = \"tiny\"\nquestion = \"Of which mesh?\"\nblocks = { first = 1, count = 1 }\n\
                 measure = { largest_spacing = 0.1 }\n[[arm]]\nid = \"one\"\n";
    let study = study.to_string() + &text.replace("[output]", "[scene.output]");
    let study = Study::expand(spec::parse(&study).expect(&study), None).unwrap();
    let key = || {
        let archive = Archive::open(&study, &folder.path().join("results"), folder.path()).unwrap();
        archive.key(0).to_string()
    };
    let (before, write) = (key(), |name: &str, shape: &Shape| {
        std::fs::write(folder.path().join(name), written::stl_binary(shape)).unwrap();
    });
    assert_eq!(key(), before);
    write("b.stl", &cube().mapped(|v| v * 2.0));
    assert_ne!(key(), before, "another mesh is another case");
    write("b.stl", &cube());
    assert_eq!(key(), before, "the same mesh is the same case");
    std::fs::remove_file(folder.path().join("a.stl")).unwrap();
    let error = Archive::open(&study, &folder.path().join("results"), folder.path()).err().unwrap();
    assert!(error.to_string().contains("a.stl"), "{error}");
}

/// Seams of texture, colours, strips of one face a group, a corner written twice: all of it is one surface.
#[test]
fn vertices_at_one_place_are_one() {
    let shape = ball();
    let corners: Vec<Point> =
        shape.triangles.iter().flatten().map(|corner| shape.vertices[*corner as usize]).collect();
    let apart = Shape {
        triangles: (0..shape.triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
        // As far as six digits put them.
        vertices: corners.iter().enumerate().map(|(k, v)| v.add_scalar(3e-7 * (k % 3) as f64)).collect(),
    };
    let text = String::from_utf8(written::obj(&apart)).unwrap();
    let grouped = text.replace("\nf", "\ng\nf");
    let coloured = grouped.lines().map(|line| {
        if line.starts_with("v ") { format!("{line} 0.5 0.5 0.5\r\n") } else { format!("{line}\r\n") }
    });
    let folder = folder_with(&[("apart.obj", coloured.collect::<String>().into_bytes())]);
    let made = built(&scene(&mesh("apart.obj", ""), RANDOM, ""), folder.path()).made;
    assert!((made.filled_volume / (4.0 / 3.0 * PI) - 1.0).abs() < 0.02, "{}", made.filled_volume);
}

/// Backwards counts, polygons of any number of corners, of which some are not convex, and a weight.
#[test]
fn polygons_become_fans() {
    // The letter L, 2 x 2 less a quarter, 1 thick; its sides are the outlines' edges.
    let outline = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    let mut text = String::new();
    for z in [0, 1] {
        outline.iter().for_each(|[x, y]| text += &format!("v {} {} {} 2\n", 2.0 * x, 2.0 * y, 2 * z));
    }
    text += "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n";
    (0..6).for_each(|k| {
        let [a, b] = [k, (k + 1) % 6];
        text += &format!("f {} {} {} {}\n", a - 12, b - 12, b - 6, a - 6);
    });
    let folder = folder_with(&[("letter.obj", text.into_bytes())]);
    let text = scene(&mesh("letter.obj", ""), RANDOM, "");
    assert!((built(&text, folder.path()).made.filled_volume - 3.0).abs() < 1e-12);
    assert!(positions(&text, folder.path()).iter().all(|x| x.x < 1.0 || x.y < 1.0));
}

/// The mesh that comes with the project: three balls that overlap, z up, in units of the lowest one's radius.
#[test]
fn the_snowman_is_ours_and_can_be_sampled() {
    use std::fmt::Write;
    let ball = |height: f64, radius: f64| {
        let six_digits = |c: f64| (1e6 * c).round() / 1e6;
        icosphere(2).mapped(|v| (v * radius + Point::new(0.0, 0.0, height)).map(six_digits))
    };
    let shape = ball(1.0, 1.0).and(&ball(2.4, 0.7)).and(&ball(3.4, 0.5));
    let mut text = String::from("# Three balls that overlap, written by tests/studies/meshes.rs\n");
    shape.vertices.iter().for_each(|v| writeln!(text, "v {} {} {}", v.x, v.y, v.z).unwrap());
    shape.triangles.iter().for_each(|[a, b, c]| writeln!(text, "f {} {} {}", a + 1, b + 1, c + 1).unwrap());
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../studies/meshes");
    if std::fs::read_to_string(folder.join("snowman.obj")).ok().as_ref() != Some(&text) {
        let other = Path::new(env!("CARGO_TARGET_TMPDIR")).join("snowman.obj");
        std::fs::write(&other, text).unwrap();
        panic!("the code makes another one; cp {} studies/meshes/snowman.obj", other.display());
    }
    let scene = std::fs::read_to_string(folder.join("snowman.toml")).unwrap();
    let made = built(&scene, &folder).made;
    // Less what neighbours share, as two balls of radii R, r at distance d do (Weisstein, "Sphere-Sphere Intersection").
    let lens = |big: f64, small: f64, d: f64| {
        PI * (big + small - d).powi(2) * (d * d + 2.0 * d * (big + small) - 3.0 * (big - small).powi(2))
            / (12.0 * d)
    };
    let balls = 4.0 / 3.0 * PI * (1.0 + 0.7_f64.powi(3) + 0.5_f64.powi(3));
    let expected = (balls - lens(1.0, 0.7, 1.4) - lens(0.7, 0.5, 1.0)) * 0.1_f64.powi(3);
    // The balls are inscribed: 2 % of a radius is 6 % of a volume.
    assert!((0.94..1.0).contains(&(made.filled_volume / expected)), "{} of {expected}", made.filled_volume);
    assert!(made.particles_per_cell > 2.0, "{}", made.particles_per_cell);
}
