//! Identities of the B-splines, one axis at a time and as products.

use snowlab_solver::Real;
use snowlab_solver::geometry::{Matrix, Vector};
use snowlab_solver::kernel::{Cubic, Kernel, Quadratic};
use snowlab_solver::stencil::Stencil;

use crate::support::{Random, largest};

/// The kernels as the specification writes them.
fn cubic(q: f64) -> f64 {
    let q = q.abs();
    if q < 1.0 {
        q * q * q / 2.0 - q * q + 2.0 / 3.0
    } else if q < 2.0 {
        (2.0 - q).powi(3) / 6.0
    } else {
        0.0
    }
}

fn quadratic(q: f64) -> f64 {
    let q = q.abs();
    if q < 0.5 {
        0.75 - q * q
    } else if q < 1.5 {
        (1.5 - q).powi(2) / 2.0
    } else {
        0.0
    }
}

/// Positions in cells: a fine sweep, the nodes and the cell centres themselves, and both sides of them.
fn positions() -> Vec<f64> {
    let mut list: Vec<f64> = (-300..=300).map(|i| f64::from(i) * 0.01).collect();
    for edge in (-8..=8).map(|i| f64::from(i) * 0.5) {
        list.extend([edge, edge - 1e-12, edge + 1e-12, edge - 1e-7, edge + 1e-7]);
    }
    list
}

fn check_axis<K: Kernel>(definition: fn(f64) -> f64) {
    for x in positions() {
        let (first, weight, slope) = K::weights(x);
        assert_eq!(first, K::first_node(x));
        let (mut sum, mut slope_sum, mut place, mut place_slope, mut inertia) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for k in 0..4 {
            let node = f64::from(first + k as i32);
            if k >= K::SUPPORT {
                assert_eq!((weight[k], slope[k]), (0.0, 0.0));
                continue;
            }
            assert!(weight[k] >= 0.0);
            assert!((weight[k] - definition(x - node)).abs() < 1e-15, "N at q = {}", x - node);
            let numeric = (definition(x - node + 1e-6) - definition(x - node - 1e-6)) / 2e-6;
            assert!((slope[k] - numeric).abs() < 2e-6, "N' at q = {}: {} {numeric}", x - node, slope[k]);
            sum += weight[k];
            slope_sum += slope[k];
            place += weight[k] * node;
            place_slope += slope[k] * node;
            inertia += weight[k] * (node - x).powi(2);
        }
        // Nodes outside the support carry nothing.
        assert!(definition(x - f64::from(first - 1)) < 1e-30);
        assert!(definition(x - f64::from(first + K::SUPPORT as i32)) < 1e-30);
        assert!((sum - 1.0).abs() < 4e-16, "partition of unity at {x}: {sum}");
        assert!(slope_sum.abs() < 4e-16, "slopes sum to zero at {x}: {slope_sum}");
        assert!((place - x).abs() < 2e-15, "linear reproduction at {x}: {place}");
        assert!((place_slope - 1.0).abs() < 4e-15, "slope of a linear field at {x}: {place_slope}");
        assert!((inertia * K::INVERSE_INERTIA - 1.0).abs() < 4e-15, "inertia at {x}: {inertia}");
    }
}

#[test]
fn weights_are_the_splines_and_reproduce_linear_fields() {
    check_axis::<Cubic>(cubic);
    check_axis::<Quadratic>(quadratic);
    assert_eq!((Cubic::INVERSE_INERTIA, Quadratic::INVERSE_INERTIA), (3.0, 4.0));
}

/// N and N' do not jump where the first node does.
fn check_continuity<K: Kernel>() {
    for edge in (-6..=6).map(|i| f64::from(i) * 0.5) {
        let at = |x: f64, node: i32| {
            let (first, weight, slope) = K::weights(x);
            let k = node - first;
            if (0..K::SUPPORT as i32).contains(&k) {
                (weight[k as usize], slope[k as usize])
            } else {
                (0.0, 0.0)
            }
        };
        for node in -6..=6 {
            let ((w0, s0), (w1, s1)) = (at(edge - 1e-9, node), at(edge + 1e-9, node));
            assert!((w0 - w1).abs() < 1e-8 && (s0 - s1).abs() < 1e-8, "node {node} at {edge}");
        }
    }
}

#[test]
fn weights_and_slopes_are_continuous_across_cells() {
    check_continuity::<Cubic>();
    check_continuity::<Quadratic>();
}

/// sum N'^2 / N over the nodes, the definition of GRADIENT_BOUND.
pub fn gradient_sum<K: Kernel>(x: f64) -> f64 {
    let (_, weight, slope) = K::weights(x);
    (0..K::SUPPORT).filter(|&k| weight[k] > 0.0).map(|k| slope[k] * slope[k] / weight[k]).sum()
}

#[test]
fn gradient_bounds_are_the_maxima() {
    let largest = |sum: fn(f64) -> f64| (0..=200_000).map(|i| sum(f64::from(i) * 5e-6)).fold(0.0, f64::max);
    // The bound of a run must not lie below the maximum, and above it by no more than its digits.
    let cubic = largest(gradient_sum::<Cubic>);
    assert!(cubic <= Cubic::GRADIENT_BOUND && Cubic::GRADIENT_BOUND - cubic < 1e-3, "cubic: {cubic}");
    // The quadratic's supremum lies at the cell's middle, where the node that drops out still counts 2.
    let quadratic = largest(gradient_sum::<Quadratic>);
    assert!(quadratic <= Quadratic::GRADIENT_BOUND && 6.0 - quadratic < 1e-4, "quadratic: {quadratic}");
    assert_eq!(Quadratic::GRADIENT_BOUND, 6.0);
}

/// Sums over the product nodes, of w, grad w and w (x_i - x_p), for a field v = a + B x.
fn check_stencil<T: Real, K: Kernel, const D: usize, const MLS: bool>(tolerance: f64) {
    let mut random = Random(21);
    for number in 0..300 {
        let h = T::of([0.005, 0.3, 7.0][number % 3]);
        let mut x: Vector<T, D> = random.vector(5.0);
        if number % 4 == 0 {
            x[0] = T::of(f64::from(number as i32 % 7) * 0.5 - 1.5);
        }
        x *= h;
        let stencil = Stencil::<T, D>::at::<K, MLS>(&x, h, T::one() / h);
        let (a, b) = (random.vector::<T, D>(1.0), random.matrix::<T, D>(1.0));
        let (mut mass, mut velocity) = (T::zero(), Vector::<T, D>::zeros());
        let (mut gradient, mut spin) = (Matrix::<T, D>::zeros(), Matrix::<T, D>::zeros());
        let (mut gradient_sum, mut moment_sum) = (Vector::<T, D>::zeros(), Vector::<T, D>::zeros());
        let mut by_rows = 0;
        for (number, (node, weight)) in stencil.nodes::<K>().enumerate() {
            let offset: [usize; D] = std::array::from_fn(|k| (node[k] - stencil.first[k]) as usize);
            let (w, slope, moment) = stencil.node(offset);
            assert!((w - weight).abs().as_f64() <= 4.0 * T::default_epsilon().as_f64() * w.as_f64());
            let arm = Vector::<T, D>::from_fn(|k, _| T::of_index(node[k])) * h - x;
            assert!(((moment - arm * w) / h).norm().as_f64() < tolerance, "moment at {x}");
            // In cells, so that the field has the same size at every spacing.
            let v = a + b * (arm + x) / h;
            mass += w;
            velocity += v * w;
            gradient += v * slope.transpose() * h;
            spin += v * moment.transpose() / h;
            gradient_sum += slope * h;
            moment_sum += moment / h;
            // The row form is what the transfers read.
            let row = stencil.row::<K>(number / K::SUPPORT);
            let k = number % K::SUPPORT;
            assert_eq!(row.offset[..D - 1], offset[..D - 1]);
            let row_weight = row.weight * stencil.weight[D - 1][k];
            assert!((row_weight - w).abs().as_f64() < tolerance);
            for axis in 0..D {
                let (of_slope, of_moment) = if axis == D - 1 {
                    (stencil.slope[axis][k], stencil.moment[axis][k])
                } else {
                    (stencil.weight[D - 1][k], stencil.weight[D - 1][k])
                };
                assert!(((row.gradient[axis] * of_slope - slope[axis]) * h).abs().as_f64() < tolerance);
                assert!(((row.moment[axis] * of_moment - moment[axis]) / h).abs().as_f64() < tolerance);
            }
            by_rows += 1;
        }
        assert_eq!(by_rows, Stencil::<T, D>::rows::<K>() * K::SUPPORT);
        let inverse_inertia = T::of(K::INVERSE_INERTIA);
        assert!((mass - T::one()).abs().as_f64() < tolerance, "sum w = {mass}");
        assert!(gradient_sum.norm().as_f64() < tolerance, "sum grad w = {gradient_sum}");
        assert!(moment_sum.norm().as_f64() < tolerance, "sum w (x_i - x_p) = {moment_sum}");
        assert!((velocity - a - b * x / h).norm().as_f64() < tolerance, "sum w v");
        assert!(largest(&(gradient - b)) < tolerance, "sum v grad w = {gradient}, grad v = {b}");
        assert!(largest(&(spin * inverse_inertia - b)) < tolerance, "C = {spin}, grad v = {b}");
    }
}

#[test]
fn stencils_reproduce_linear_fields_by_gradients_and_by_moments() {
    check_stencil::<f64, Cubic, 2, false>(1e-13);
    check_stencil::<f64, Cubic, 3, false>(1e-13);
    check_stencil::<f64, Cubic, 2, true>(1e-13);
    check_stencil::<f64, Cubic, 3, true>(1e-13);
    check_stencil::<f64, Quadratic, 2, false>(1e-13);
    check_stencil::<f64, Quadratic, 3, false>(1e-13);
    check_stencil::<f64, Quadratic, 2, true>(1e-13);
    check_stencil::<f64, Quadratic, 3, true>(1e-13);
    check_stencil::<f32, Cubic, 3, false>(5e-5);
    check_stencil::<f32, Quadratic, 3, true>(5e-5);
}
