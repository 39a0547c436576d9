//! Meshes: their volumes and insides against solids that are known, and what is no solid.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use snowlab_sampler::rng::{ChaCha8Rng, uniform, uniform_vector};
use snowlab_sampler::{
    InclusionField, Mesh, PlacedMesh, Purpose, Region, Sampler, SamplerError, Streams, VoidField, draw_voids,
    place, rotation,
};
use snowlab_solver::geometry::{Matrix, Vector};

use crate::made::shapes::{Point, Shape, cube, icosphere};

fn mesh(shape: &Shape) -> Result<Mesh, SamplerError> {
    Mesh::new(&shape.vertices, &shape.triangles)
}

/// In the scene as it is.
fn region(shape: &Shape) -> Region<3> {
    let mesh = Arc::new(mesh(shape).expect("it closes"));
    Region::Mesh(PlacedMesh::new(mesh, 1.0, Matrix::<f64, 3>::identity(), None).expect("it has a place"))
}

fn random() -> ChaCha8Rng {
    Streams::new(11).stream(Purpose::Noise)
}

/// Uniform in the cube from `-half` to `half`.
fn point_in_cube(half: f64, rng: &mut ChaCha8Rng) -> Point {
    uniform_vector::<3>(rng).map(|share| half * (2.0 * share - 1.0))
}

#[test]
fn an_icosphere_lies_between_its_balls() {
    let shape = icosphere(4);
    let (inner, region) = (shape.inner_radius(), region(&shape));
    assert!((0.99..0.999).contains(&inner), "{inner}");
    let ball = 4.0 / 3.0 * PI;
    let volume = region.volume(0.1).unwrap();
    assert!(ball * inner.powi(3) < volume && volume < ball, "{volume}");
    let mut rng = random();
    for _ in 0..20_000 {
        let point = point_in_cube(1.2, &mut rng);
        let (radius, depth) = (point.norm(), region.depth(&point));
        assert_eq!(region.contains(&point), depth >= 0.0, "{point:?}");
        // Both balls bound the distance to what lies between them.
        assert!(inner - radius - 1e-12 < depth && depth < 1.0 - radius + 1e-12, "{point:?}: {depth}");
    }
}

/// A ring of `around` straight pieces whose cross-section has `across` corners: radius 1 to the middle, 0.4 of the tube.
const AROUND: usize = 37;
const ACROSS: usize = 11;
const TUBE: f64 = 0.4;

fn torus() -> Shape {
    let number = |i: usize, j: usize| ((i % AROUND) * ACROSS + j % ACROSS) as u32;
    let vertex = |k: usize| {
        let (u, v) = (TAU * (k / ACROSS) as f64 / AROUND as f64, TAU * (k % ACROSS) as f64 / ACROSS as f64);
        let radius = 1.0 + TUBE * v.cos();
        Point::new(radius * u.cos(), radius * u.sin(), TUBE * v.sin())
    };
    let faces = (0..AROUND * ACROSS).flat_map(|k| {
        let (i, j) = (k / ACROSS, k % ACROSS);
        let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
        [[a, b, c], [a, c, d]]
    });
    Shape { vertices: (0..AROUND * ACROSS).map(vertex).collect(), triangles: faces.collect() }
}

/// Whether the ring of straight pieces holds `point`: along a piece every section is the polygon, drawn out.
fn in_torus(point: &Point) -> bool {
    let piece = TAU / AROUND as f64;
    let angle = point.y.atan2(point.x).rem_euclid(TAU);
    let middle = ((angle / piece).floor() + 0.5) * piece;
    let radius = (point.x * middle.cos() + point.y * middle.sin()) / (0.5 * piece).cos();
    let (x, z) = (radius - 1.0, point.z);
    let side = TAU / ACROSS as f64;
    (0..ACROSS).all(|k| {
        let normal = (k as f64 + 0.5) * side;
        x * normal.cos() + z * normal.sin() < TUBE * (0.5 * side).cos()
    })
}

#[test]
fn a_torus_is_the_one_of_solid_geometry() {
    let region = region(&torus());
    // Of a piece: sin(2 pi / n) times the first moment of the section about the axis.
    let (n, m) = (AROUND as f64, ACROSS as f64);
    let expected = n * (TAU / n).sin() * 0.5 * m * TUBE * TUBE * (TAU / m).sin();
    let volume = region.volume(0.1).unwrap();
    assert!((volume - expected).abs() < 1e-12 * expected, "{volume} for {expected}");
    let (mut rng, mut inside) = (random(), 0);
    for _ in 0..50_000 {
        let point = point_in_cube(1.5, &mut rng).component_mul(&Point::new(1.0, 1.0, 0.4));
        assert_eq!(region.contains(&point), in_torus(&point), "{point:?}");
        inside += usize::from(in_torus(&point));
    }
    assert!((5_000..45_000).contains(&inside), "{inside}");
    assert!(!region.contains(&Point::zeros()), "the hole");
}

/// Points on faces, edges, diagonals and their planes: each is where its image shifted towards +x, +y, +z is.
#[test]
fn nothing_leaks_through_edges_and_corners() {
    let region = region(&cube());
    let steps: Vec<f64> = (-6..=6).map(|k| f64::from(k) / 4.0).collect();
    for &x in &steps {
        for &y in &steps {
            for &z in &steps {
                let point = Point::new(x, y, z);
                let expected = point.iter().all(|c| (-1.0..1.0).contains(c));
                assert_eq!(region.contains(&point), expected, "{point:?}");
                let depth = 1.0 - point.amax();
                if depth >= 0.0 {
                    assert!((region.depth(&point).abs() - depth).abs() < 1e-15, "{point:?}");
                }
            }
        }
    }
    // Columns through vertices and along edges of a shape that is not aligned with anything.
    let shape = icosphere(2);
    let (inner, region) = (shape.inner_radius(), self::region(&shape));
    for vertex in &shape.vertices {
        for height in [-3.0, -1.001, -0.5, 0.0, 0.5, 1.001, 3.0] {
            let radius = Point::new(vertex.x, vertex.y, height).norm();
            let found = region.contains(&Point::new(vertex.x, vertex.y, height));
            assert!(radius < inner && found || radius > 1.0 && !found || (inner..=1.0).contains(&radius));
        }
    }
}

/// Affine images of the icosphere, some turned inside out by the map, agree with the ellipsoid but within the sagitta.
#[test]
fn random_affine_images_agree_with_the_ellipsoid() {
    let (shape, mut rng) = (icosphere(3), random());
    let (inner, mut reflected) = (shape.inner_radius(), 0);
    for _ in 0..40 {
        let map = Matrix::<f64, 3>::from_fn(|_, _| 2.0 * uniform(&mut rng) - 1.0);
        let shift = point_in_cube(50.0, &mut rng);
        let Some(inverse) = map.try_inverse().filter(|inverse| inverse.norm() < 50.0) else { continue };
        reflected += usize::from(map.determinant() < 0.0);
        let image = shape.mapped(|vertex| map * vertex + shift);
        let region = region(&image);
        let expected = mesh(&shape).unwrap().volume() * map.determinant().abs();
        let volume = region.volume(0.1).unwrap();
        assert!((volume - expected).abs() < 1e-9 * expected, "{volume} for {expected}");
        for _ in 0..2_000 {
            let before = point_in_cube(1.2, &mut rng);
            let (radius, found) = (before.norm(), region.contains(&(map * before + shift)));
            assert!(radius > inner - 1e-9 || found, "{before:?} is inside");
            assert!(radius < 1.0 + 1e-9 || !found, "{before:?} is outside");
        }
        assert!(inverse.norm() > 0.0);
    }
    assert!((5..35).contains(&reflected), "{reflected}");
}

#[test]
fn a_mesh_is_scaled_turned_and_put_where_it_is_told() {
    let long = cube().mapped(|v| Point::new(3.0 * v.x + 1.0, v.y, v.z));
    let mesh = Arc::new(mesh(&long).unwrap());
    let quarter = rotation::<3>(0.5 * PI);
    let centre = Point::new(10.0, 20.0, 30.0);
    let region: Region<3> =
        Region::Mesh(PlacedMesh::new(Arc::clone(&mesh), 0.5, quarter, Some(centre)).unwrap());
    assert!((region.volume(0.1).unwrap() - 3.0).abs() < 1e-12);
    let bounds = region.bounding_box();
    assert!((bounds.min - Point::new(9.5, 18.5, 29.5)).amax() < 1e-12, "{bounds:?}");
    assert!((bounds.max - Point::new(10.5, 21.5, 30.5)).amax() < 1e-12, "{bounds:?}");
    assert!(
        region.contains(&Point::new(10.4, 21.4, 30.4)) && !region.contains(&Point::new(11.4, 20.0, 30.0))
    );
    assert!((region.depth(&centre) - 0.5).abs() < 1e-12);
    let as_it_is: Region<3> = Region::Mesh(PlacedMesh::new(Arc::clone(&mesh), 0.5, quarter, None).unwrap());
    assert!(as_it_is.contains(&Point::new(0.0, 1.9, 0.0)) && !as_it_is.contains(&Point::new(0.0, -1.1, 0.0)));
    for scale in [0.0, -1.0, f64::NAN, 1e7] {
        let refused = PlacedMesh::new(Arc::clone(&mesh), scale, quarter, None);
        assert!(matches!(refused, Err(SamplerError::OutOfRange { .. })), "{scale}");
    }
    let far = PlacedMesh::new(Arc::clone(&mesh), 1e6, quarter, None);
    assert!(matches!(far, Err(SamplerError::OutOfRange { .. })));
    let skewed = PlacedMesh::new(mesh, 1.0, Matrix::<f64, 3>::repeat(0.5), None);
    assert!(matches!(skewed, Err(SamplerError::Orientation { .. })));
}

#[test]
fn parts_that_overlap_are_one_solid_and_inner_ones_that_face_inwards_are_cavities() {
    let beside = cube().mapped(|v| v + Point::new(0.7, 0.3, 1.1));
    let both = mesh(&cube().and(&beside)).unwrap();
    // What both have, 1.3 x 1.7 x 0.9, counts once; seen along lines 2.7 / 256 apart, each side is right to one of them.
    let shared = 1.3 * 1.7 * 0.9;
    assert!(
        (both.volume() - (16.0 - shared)).abs() < shared * (1.0 / 123.0 + 1.0 / 189.0),
        "{}",
        both.volume()
    );
    for (point, expected) in [([0.0, 0.0, 0.5], true), ([1.5, 1.0, 1.9], true), ([1.5, 0.0, 0.0], false)] {
        assert_eq!(both.contains(&Point::from(point)), expected, "{point:?}");
    }
    let inner = cube().mapped(|v| v * 0.5).turned();
    let hollow = mesh(&cube().and(&inner)).unwrap();
    let is = |volume: f64, expected: f64| (volume - expected).abs() < 1e-14 * expected;
    assert!(is(hollow.volume(), 7.0), "{}", hollow.volume());
    assert!(!hollow.contains(&Point::zeros()) && hollow.contains(&Point::new(0.7, 0.0, 0.0)));
    let apart = mesh(&cube().and(&cube().mapped(|v| v.add_scalar(5.0)))).unwrap();
    assert!(is(apart.volume(), 16.0), "{}", apart.volume());
}

#[test]
fn what_is_no_solid_is_refused_with_a_place_and_a_remedy() {
    let inwards = mesh(&cube().turned()).expect("it is turned round");
    assert!((inwards.volume() - 8.0).abs() < 1e-14 && inwards.contains(&Point::zeros()));
    let cut = |change: fn(&mut Vec<[u32; 3]>)| {
        let mut shape = cube();
        change(&mut shape.triangles);
        mesh(&shape).unwrap_err()
    };
    let says = |error: SamplerError, words: &[&str]| {
        let text = error.to_string();
        assert!(words.iter().all(|word| text.contains(word)) && text.len() < 320, "{text}");
    };
    let open = cut(|triangles| triangles.truncate(11));
    assert!(matches!(open, SamplerError::OpenMesh { open: 3, crowded: 0, turned: 0, .. }), "{open:?}");
    says(open, &["3 edges of one triangle alone (holes), the first near [1.0", "Fill Holes"]);
    let turned = cut(|triangles| triangles[0].swap(0, 1));
    assert!(matches!(turned, SamplerError::OpenMesh { open: 0, crowded: 0, turned: 3, .. }), "{turned:?}");
    says(turned, &["3 edges of two that face opposite ways", "Recalculate Outside"]);
    let crowded = cut(|triangles| triangles.push([0, 3, 7]));
    assert!(matches!(crowded, SamplerError::OpenMesh { open: 1, crowded: 2, turned: 0, .. }), "{crowded:?}");
    let missing = cut(|triangles| triangles[4][1] = 8);
    assert_eq!(missing, SamplerError::NoSuchVertex { triangle: 4, vertex: 8, vertices: 8 });
    let none = cut(Vec::clear);
    assert!(matches!(none, SamplerError::CountOutOfRange { value: 0, .. }), "{none:?}");
    let inwards = mesh(&cube().and(&cube().mapped(|v| v * 0.5 + Point::repeat(5.0)).turned())).unwrap_err();
    let SamplerError::MeshInsideOut { share, at } = inwards else { panic!("{inwards:?}") };
    // 1 of 8 - 1.
    assert!((share - 1.0 / 7.0).abs() < 0.02 && at.iter().all(|c| (c - 5.0).abs() < 0.5), "{share} {at:?}");
    assert_eq!(mesh(&cube().mapped(|v| Point::new(v.x, v.y, 0.0))), Err(SamplerError::FlatMesh));
    for bad in [f64::NAN, f64::INFINITY, 1e10] {
        let refused = mesh(&cube().mapped(|v| Point::new(v.x, if v.y > 0.0 { bad } else { v.y }, v.z)));
        assert!(matches!(refused, Err(SamplerError::OutOfRange { .. })), "{bad}");
    }
    let Region::Mesh(placed) = region(&cube()) else { unreachable!() };
    assert_eq!(Region::<2>::Mesh(placed).validate(), Err(SamplerError::MeshInPlane));
}

const COUNT: usize = 8_000;

#[test]
fn every_sampler_fills_a_mesh_evenly() {
    let region = region(&icosphere(4).mapped(|v| v.component_mul(&Point::new(0.3, 0.2, 0.25))));
    for sampler in [
        Sampler::Random,
        Sampler::Jittered { angle: 0.4 },
        Sampler::Lattice { angle: 0.4 },
        Sampler::PoissonDisk,
    ] {
        let placement = place(&region, &sampler, None, COUNT, &Streams::new(3)).unwrap();
        assert_eq!(placement.positions.len(), COUNT);
        let mut octants = [0_usize; 8];
        for point in &placement.positions {
            assert!(region.contains(point), "{sampler:?}: {point:?}");
            octants[(0..3).map(|axis| usize::from(point[axis] > 0.0) << axis).sum::<usize>()] += 1;
        }
        // The most that 1000 +- sqrt(1000 x 7/8) goes astray in a hundred thousand tries.
        assert!(octants.iter().all(|count| (868..1132).contains(count)), "{sampler:?}: {octants:?}");
    }
}

#[test]
fn meshes_have_voids_and_are_joined_and_cut() {
    let body = region(&icosphere(3).mapped(|v| v * 0.3));
    let (spacing, streams) = (0.016, Streams::new(2));
    let field = VoidField::Inclusions(InclusionField { porosity: 0.06, ..InclusionField::circles(spacing) });
    let voids = draw_voids(&body, &field, spacing, &streams).unwrap();
    let placement = place(&body, &Sampler::Random, Some(&voids), 2_000, &streams).unwrap();
    assert!((voids.porosity - 0.06).abs() < 0.01 * 0.06 && placement.positions.len() == 2_000);
    assert!(placement.positions.iter().all(|point| body.contains(point) && !voids.contains(point)));

    let ball = |x: f64, radius: f64| Region::Ball { centre: Vector::<f64, 3>::new(x, 0.0, 0.0), radius };
    let join = Region::Union(vec![body.clone(), ball(0.3, 0.1)]);
    let cut = Region::Difference { solid: Box::new(body.clone()), removed: Box::new(ball(0.3, 0.1)) };
    let cut_out = Region::Difference { solid: Box::new(ball(0.0, 0.4)), removed: Box::new(body.clone()) };
    let volume = |region: &Region<3>| region.volume(region.volume_raster()).unwrap();
    // What the ball has in common with the body: once in the first, twice taken from the sum of both.
    let shared = volume(&body) - volume(&cut);
    // Counted in cells of 1/128 of the longest side, every surface is right to a twentieth of a cell.
    let near = |found: f64, expected: f64, surface: f64| {
        assert!((found - expected).abs() < 0.05 * surface * 0.8 / 128.0, "{found} for {expected}");
    };
    let sphere = |radius: f64| 4.0 * PI * radius * radius;
    near(volume(&join), volume(&body) + volume(&ball(0.3, 0.1)) - shared, sphere(0.3) + sphere(0.1));
    near(volume(&cut_out), volume(&ball(0.0, 0.4)) - volume(&body), sphere(0.3) + sphere(0.4));
    for region in [join, cut, cut_out] {
        let placement = place(&region, &Sampler::Jittered { angle: 0.4 }, None, 500, &streams).unwrap();
        assert!(placement.positions.iter().all(|point| region.contains(point) && region.depth(point) >= 0.0));
    }
}
