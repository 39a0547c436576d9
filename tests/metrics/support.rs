//! Placements for the tests of the metrics, each from its own seed.

use nalgebra::SMatrix;
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;
use snowlab_solver::geometry::Vector;

/// The study's grid spacing h_0 [m] and ball radius R [m].
pub const SPACING: f64 = 7.2e-3;
pub const RADIUS: f64 = 0.25;

pub fn random(seed: u64) -> ChaCha8Rng {
    ChaCha8Rng::seed_from_u64(seed)
}

/// Uniform in [0, 1).
pub fn uniform(random: &mut ChaCha8Rng) -> f64 {
    (random.next_u64() >> 11) as f64 / (1u64 << 53) as f64
}

/// `count` points, independent and uniform in the box [0, size]^D.
pub fn sheet<const D: usize>(count: usize, size: f64, seed: u64) -> Vec<Vector<f64, D>> {
    let mut random = random(seed);
    (0..count).map(|_| Vector::from_fn(|_, _| size * uniform(&mut random))).collect()
}

/// `count` points, independent and uniform in the ball of `radius` about the origin, by rejection.
pub fn ball<const D: usize>(count: usize, radius: f64, seed: u64) -> Vec<Vector<f64, D>> {
    let mut random = random(seed);
    let mut points = Vec::with_capacity(count);
    while points.len() < count {
        let point = Vector::<f64, D>::from_fn(|_, _| radius * (2.0 * uniform(&mut random) - 1.0));
        if point.norm_squared() <= radius * radius {
            points.push(point);
        }
    }
    points
}

/// The sites of the square lattice of `pitch` inside `keep`, within `half` of the origin on every axis.
pub fn lattice<const D: usize>(
    pitch: f64,
    half: f64,
    keep: impl Fn(&Vector<f64, D>) -> bool,
) -> Vec<Vector<f64, D>> {
    let side = 2 * (half / pitch) as usize + 1;
    let site = |index: usize| {
        let mut rest = index;
        Vector::from_fn(|_, _| {
            let k = rest % side;
            rest /= side;
            (k as f64 - (side / 2) as f64) * pitch
        })
    };
    (0..side.pow(D as u32)).map(site).filter(keep).collect()
}

/// Masses in [0.1, 1.1) kg.
pub fn masses(count: usize, seed: u64) -> Vec<f64> {
    let mut random = random(seed);
    (0..count).map(|_| 0.1 + uniform(&mut random)).collect()
}

/// A permutation of 0..count.
pub fn permutation(count: usize, seed: u64) -> Vec<usize> {
    let mut random = random(seed);
    let mut order: Vec<usize> = (0..count).collect();
    for place in (1..count).rev() {
        order.swap(place, (random.next_u64() % (place as u64 + 1)) as usize);
    }
    order
}

/// A rotation in the plane of the first two axes, then (3D) of the last two.
pub fn rotated<const D: usize>(points: &[Vector<f64, D>], angle: f64) -> Vec<Vector<f64, D>> {
    let mut turn = SMatrix::<f64, D, D>::identity();
    for axis in 1..D {
        let mut plane = SMatrix::<f64, D, D>::identity();
        let (sine, cosine) = angle.sin_cos();
        plane[(axis - 1, axis - 1)] = cosine;
        plane[(axis - 1, axis)] = -sine;
        plane[(axis, axis - 1)] = sine;
        plane[(axis, axis)] = cosine;
        turn = plane * turn;
    }
    points.iter().map(|point| turn * point).collect()
}

pub fn shifted<const D: usize>(points: &[Vector<f64, D>], shift: f64) -> Vec<Vector<f64, D>> {
    points.iter().map(|point| point.add_scalar(shift)).collect()
}

/// Debris so far away that f64 resolves no cells of a raster with a fixed origin there.
pub const BEYOND_THE_RASTER: &str = "debris beyond the raster";

/// The table of placements every variant of every metric is run through: name, points and a length of the
/// order of their spacing. Clouds, coincident points, points on cell walls, clumps, a line, debris at any
/// distance, none and one.
pub fn placements<const D: usize>() -> Vec<(&'static str, Vec<Vector<f64, D>>, f64)> {
    let mut far = sheet::<D>(120, 1.0, 11);
    let at = |k: usize, x: f64| Vector::from_fn(|axis, _| if axis == k % D { x } else { 0.5 });
    for (k, distance) in [1e3, -1e6, 1e9, -1e10, 1e11, -1e12].into_iter().enumerate() {
        far.extend([at(k, distance), at(k, distance + 0.05)]);
    }
    let mut beyond = far.clone();
    for (k, distance) in [1e15, -1e15, 1e17, 1e30, -1e99].into_iter().enumerate() {
        beyond.extend([at(k, distance), at(k, distance.next_up())]);
    }
    let mut clumps = Vec::new();
    for (k, centre) in sheet::<D>(8, 3.0, 12).into_iter().enumerate() {
        clumps.extend(ball::<D>(25, 0.2, 20 + k as u64).into_iter().map(|point| point + centre));
    }
    let twice: Vec<_> = sheet::<D>(70, 1.0, 13).into_iter().flat_map(|point| [point; 3]).collect();
    let line = sheet::<1>(200, 20.0, 14).into_iter().map(|x| Vector::from_fn(|_, _| x[0])).collect();
    vec![
        ("none", Vec::new(), 0.1),
        ("one", vec![Vector::from_fn(|axis, _| axis as f64)], 0.1),
        ("two at one place", vec![Vector::zeros(); 2], 0.1),
        ("cloud", sheet::<D>(240, 1.0, 10), if D == 2 { 0.08 } else { 0.15 }),
        ("cloud below zero", shifted(&sheet::<D>(240, 1.0, 15), -0.7), if D == 2 { 0.06 } else { 0.12 }),
        ("coincident", twice, if D == 2 { 0.12 } else { 0.2 }),
        ("clumps", clumps, 0.3),
        ("line", line, 0.1),
        (
            "on cell walls",
            lattice::<D>(0.25, if D == 2 { 1.75 } else { 0.75 }, |point| (point.sum() * 4.0) % 3.0 != 0.0),
            0.25,
        ),
        ("far debris", far, 0.1),
        (BEYOND_THE_RASTER, beyond, 0.1),
    ]
}
