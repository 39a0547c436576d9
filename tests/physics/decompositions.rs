//! Polar and singular value decompositions, determinant and cofactor, at the edges.

use snowlab_solver::Real;
use snowlab_solver::geometry::{Matrix, Vector};
use snowlab_solver::math::{
    clamp_stretches, cofactor, determinant, polar_rotation, signed_svd, stretches_within,
};

use crate::support::{Random, largest};

/// Distance from a proper rotation.
fn improper<T: Real, const D: usize>(r: &Matrix<T, D>) -> f64 {
    let gram = largest(&(r.transpose() * r - Matrix::identity()));
    gram.max((determinant(r).as_f64() - 1.0).abs())
}

fn check<T: Real, const D: usize>(f: &Matrix<T, D>) {
    let (eps, size) = (T::default_epsilon().as_f64(), largest(f));
    let (svd, r) = (signed_svd(f), polar_rotation(f));
    assert!(improper(&svd.u) <= 16.0 * eps, "U of {f}: {}", svd.u);
    assert!(improper(&svd.v) <= 16.0 * eps, "V of {f}: {}", svd.v);
    assert!(improper(&r) <= 16.0 * eps, "R of {f}: {r}");
    let error = largest(&(svd.recompose() - f));
    assert!(error <= 16.0 * eps * size, "U S V^T is {error:e} off {f}");
    let s = svd.stretches.map(|s| s.as_f64());
    let slack = 8.0 * eps * size;
    for k in 0..D - 1 {
        assert!(s[k] >= -slack && s[k] + slack >= s[k + 1].abs(), "order of {s} for {f}");
    }
    // R = U V^T maximises tr(R^T F); the sum of the signed stretches is that maximum, unique R or not.
    let reached = (r.transpose() * f).trace().as_f64();
    assert!(
        (reached - s.sum()).abs() <= 32.0 * eps * size,
        "tr(R^T F) = {reached}, sum s = {} for {f}",
        s.sum()
    );
    // S = R^T F is symmetric.
    let stretch = r.transpose() * f;
    assert!(largest(&(stretch - stretch.transpose())) <= 32.0 * eps * size, "S of {f}: {stretch}");
}

fn from_stretches<T: Real, const D: usize>(random: &mut Random, s: &[f64]) -> Matrix<T, D> {
    let (u, v) = (random.rotation::<f64, D>(), random.rotation::<f64, D>());
    let diagonal = Matrix::<f64, D>::from_diagonal(&Vector::from_fn(|k, _| s[k]));
    (u * diagonal * v.transpose()).map(T::of)
}

fn check_random<T: Real, const D: usize>(seed: u64) {
    let mut random = Random(seed);
    for number in 0..4000 {
        let scale = 10f64.powi(number % 9 - 4);
        check::<T, D>(&random.matrix(scale));
        let near = random.rotation::<T, D>() * (Matrix::identity() + random.matrix::<T, D>(1e-3));
        check(&near);
    }
}

#[test]
fn thousands_of_random_matrices() {
    check_random::<f64, 2>(1);
    check_random::<f64, 3>(2);
    check_random::<f32, 2>(3);
    check_random::<f32, 3>(4);
}

/// Stretches of the edge cases: repeated, zero, negative, nearly so, and far apart.
const EDGES: [[f64; 3]; 22] = [
    [1.0, 1.0, 1.0],
    [2.0, 2.0, 1.0],
    [2.0, 1.0, 1.0],
    [1.0, 1.0, -1.0],
    [1.0, -1.0, 1.0],
    [1.0, -1.0, -1.0],
    [3.0, 2.0, -2.0],
    [3.0, 2.0, -1.9999999],
    [1.0, 1e-3, -1e-3],
    [1.0, 1.0, 0.0],
    [1.0, 0.0, 0.0],
    [0.0, 0.0, 0.0],
    [1.0, 1e-8, 1e-8],
    [1.0, 1e-16, 1e-16],
    [1.0, 1e-20, -1e-20],
    [1.0, 1.0, 1e-12],
    [1.0, 1.0, -1e-12],
    [1e6, 1.0, 1e-6],
    [1.0, 1.0 + 1e-9, 1.0 - 1e-9],
    [0.975, 0.975, 1.0075],
    [0.1, 100.0, -0.5],
    [-1.0, -2.0, -3.0],
];

fn check_edges<T: Real, const D: usize>(scales: &[f64]) {
    let mut random = Random(5);
    for s in EDGES {
        for &scale in scales {
            check::<T, D>(&Matrix::from_fn(|i, j| if i == j { T::of(s[i] * scale) } else { T::zero() }));
            for _ in 0..20 {
                check::<T, D>(&from_stretches(&mut random, &s.map(|s| s * scale)));
            }
        }
    }
}

#[test]
fn edge_cases() {
    check_edges::<f64, 2>(&[1.0, 1e-6, 1e6]);
    check_edges::<f64, 3>(&[1.0, 1e-6, 1e6]);
    check_edges::<f32, 2>(&[1.0, 1e-6, 1e6]);
    check_edges::<f32, 3>(&[1.0, 1e-6, 1e6]);
}

/// Squares of the entries overflow or vanish here, although the entries and the answer do not.
#[test]
fn huge_and_tiny_matrices() {
    check_edges::<f64, 2>(&[1e-200, 1e-140, 1e140, 1e200]);
    check_edges::<f64, 3>(&[1e-200, 1e-140, 1e140, 1e200]);
    check_edges::<f32, 2>(&[1e-25, 1e-18, 1e18, 1e25]);
    check_edges::<f32, 3>(&[1e-25, 1e-18, 1e18, 1e25]);
}

/// Entries 0 and +-1 in every combination: all the exact symmetries and rank defects at once.
#[test]
fn all_matrices_of_zeros_and_ones() {
    for index in 0..3usize.pow(9) {
        let digit = |k: u32| (index / 3usize.pow(k) % 3) as f64 - 1.0;
        check::<f64, 3>(&Matrix::from_fn(|i, j| digit((3 * i + j) as u32)));
        if index < 81 {
            check::<f64, 2>(&Matrix::from_fn(|i, j| digit((2 * i + j) as u32)));
            check::<f32, 2>(&Matrix::from_fn(|i, j| digit((2 * i + j) as u32) as f32));
        }
    }
}

#[test]
fn polar_of_zero_is_the_identity_and_of_a_rotation_itself() {
    assert_eq!(polar_rotation(&Matrix::<f64, 2>::zeros()), Matrix::<f64, 2>::identity());
    assert_eq!(polar_rotation(&Matrix::<f64, 3>::zeros()), Matrix::<f64, 3>::identity());
    let mut random = Random(6);
    for _ in 0..100 {
        let (r2, r3) = (random.rotation::<f64, 2>(), random.rotation::<f64, 3>());
        assert!(largest(&(polar_rotation(&(r2 * 0.3)) - r2)) < 1e-15);
        assert!(largest(&(polar_rotation(&(r3 * 0.3)) - r3)) < 2e-15);
    }
}

/// Against U, s and V that were put in, where they are unique: distinct positive stretches.
#[test]
fn known_rotations_come_back() {
    let mut random = Random(8);
    for _ in 0..500 {
        let (u, v) = (random.rotation::<f64, 3>(), random.rotation::<f64, 3>());
        let s = Vector::<f64, 3>::new(1.5, 1.0, -0.4);
        let f = u * Matrix::from_diagonal(&s) * v.transpose();
        let svd = signed_svd(&f);
        assert!((svd.stretches - s).norm() < 1e-14);
        assert!(largest(&(polar_rotation(&f) - u * v.transpose())) < 1e-14);
    }
}

fn by_permutations<const D: usize>(f: &Matrix<f64, D>) -> f64 {
    let terms: &[(f64, [usize; 3])] = if D == 2 {
        &[(1.0, [0, 1, 2]), (-1.0, [1, 0, 2])]
    } else {
        &[
            (1.0, [0, 1, 2]),
            (1.0, [1, 2, 0]),
            (1.0, [2, 0, 1]),
            (-1.0, [0, 2, 1]),
            (-1.0, [1, 0, 2]),
            (-1.0, [2, 1, 0]),
        ]
    };
    terms.iter().map(|(sign, columns)| (0..D).fold(*sign, |product, i| product * f[(i, columns[i])])).sum()
}

fn check_algebra<const D: usize>() {
    let mut random = Random(9);
    for number in 0..500 {
        let mut f: Matrix<f64, D> = random.matrix(2.0);
        if number % 5 == 0 {
            // Singular: the last column is a combination of the others.
            let combined = f.columns(0, D - 1).column_sum();
            f.set_column(D - 1, &combined);
        }
        let (det, cof) = (determinant(&f), cofactor(&f));
        // Leibniz' sum over permutations.
        assert!((det - by_permutations(&f)).abs() < 1e-13);
        assert!(largest(&(f.transpose() * cof - Matrix::identity() * det)) < 1e-13, "F^T cof F = det F I");
        // cof F = d det / dF; det is at most linear in one entry, so a difference of any length is exact.
        for (i, j) in (0..D).flat_map(|i| (0..D).map(move |j| (i, j))) {
            let mut moved = f;
            moved[(i, j)] += 1.0;
            assert!((determinant(&moved) - det - cof[(i, j)]).abs() < 1e-13);
        }
    }
}

#[test]
fn cofactor_is_the_derivative_of_the_determinant() {
    check_algebra::<2>();
    check_algebra::<3>();
}

fn check_within<T: Real, const D: usize>(margin: f64) {
    let mut random = Random(10);
    let (mut inside, mut outside) = (0, 0);
    for number in 0..6000 {
        let size = [1e-3, 5e-3, 1e-2, 3e-2, 1.0][number % 5];
        let centre = random.between(0.97, 1.01);
        let f =
            random.rotation::<T, D>() * (Matrix::identity() * T::of(centre) + random.matrix::<T, D>(size));
        let s = signed_svd(&f).stretches;
        let room =
            s.iter().fold(f64::INFINITY, |room, s| room.min((s.as_f64() - 0.975).min(1.0075 - s.as_f64())));
        if room.abs() < margin {
            continue;
        }
        let answer = stretches_within(&f, T::of(0.975), T::of(1.0075));
        assert_eq!(answer, room > 0.0, "stretches {s}");
        if answer { inside += 1 } else { outside += 1 }
    }
    assert!(inside > 800 && outside > 800, "{inside} inside, {outside} outside");
}

#[test]
fn the_short_test_for_yield_agrees_with_the_singular_values() {
    check_within::<f64, 2>(1e-14);
    check_within::<f64, 3>(1e-14);
    check_within::<f32, 2>(1e-6);
    check_within::<f32, 3>(1e-6);
    // An inverted element lies outside however close to 1 its stretches are in size.
    let mut inverted = Matrix::<f64, 3>::identity();
    inverted[(2, 2)] = -1.0;
    assert!(!stretches_within(&inverted, 0.975, 1.0075));
}

/// Against U, s and V that were put in: any mix of stretches inside and outside the bounds, equal, zero and negative ones too.
fn check_clamp<T: Real, const D: usize>(tolerance: f64) {
    let (least, greatest) = (0.975, 1.0075);
    let mut random = Random(11);
    for number in 0..3000 {
        let mut s = Vector::<f64, D>::from_fn(|_, _| random.between(0.9, 1.1));
        match number % 6 {
            0 => s.fill(random.between(0.9, 1.1)),
            1 => s[D - 1] = 0.0,
            2 => s[D - 1] = -0.3,
            3 => s[0] = 7.0,
            _ => {}
        }
        s.as_mut_slice().sort_by(|a, b| b.total_cmp(a));
        let (u, v) = (random.rotation::<f64, D>(), random.rotation::<f64, D>());
        let f = (u * Matrix::from_diagonal(&s) * v.transpose()).map(T::of);
        let bounded = clamp_stretches(&f, T::of(least), T::of(greatest));
        let clamped = s.map(|s| s.clamp(least, greatest));
        assert!((bounded.stretches.map(|s| s.as_f64()) - s).norm() <= tolerance * s.norm(), "{s} of {f}");
        assert!((bounded.clamped.map(|s| s.as_f64()) - clamped).norm() <= tolerance * s.norm(), "{s} of {f}");
        let expected = u * Matrix::from_diagonal(&clamped) * v.transpose();
        let error = largest(&(bounded.matrix.map(|e| e.as_f64()) - expected));
        assert!(error <= tolerance * s.norm(), "{s}: off by {error:e}");
    }
}

#[test]
fn clamped_stretches_keep_their_directions() {
    check_clamp::<f64, 2>(1e-13);
    check_clamp::<f64, 3>(1e-13);
    check_clamp::<f32, 2>(3e-6);
    check_clamp::<f32, 3>(3e-6);
    // Squares that vanish or overflow.
    for size in [1e-200, 1e200] {
        let f = Matrix::<f64, 2>::new(0.0, -2.0 * size, size, 0.0);
        let bounded = clamp_stretches(&f, 0.9, 1.1).matrix;
        let s = if size > 1.0 { 1.1 } else { 0.9 };
        assert!(largest(&(bounded - Matrix::<f64, 2>::new(0.0, -s, s, 0.0))) < 1e-15, "{bounded}");
    }
}
