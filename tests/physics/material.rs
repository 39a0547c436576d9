//! The constitutive law: the point values of the specification, stress as the derivative of energy, the return map.

use snowlab_solver::Material;
use snowlab_solver::geometry::{Matrix, Vector};
use snowlab_solver::material::{ConstitutiveModel, PlasticFlow};
use snowlab_solver::math::{determinant, signed_svd};
use snowlab_solver::{Elastic, Lame, Real, Snow};

use crate::support::{Random, YOUNG, assert_near, elastic, largest, snow};

/// F, tau_yy, tau_xx [Pa], J_P, hardening: E = 1.4e5 Pa, nu = 0.2, defaults else.
const POINTS: [(f64, f64, f64, f64, f64); 6] = [
    (0.99, -1540.0, -385.0, 1.0, 1.0),
    (0.975, -3791.66667, -947.916667, 1.0, 1.0),
    (0.95, -4899.90557, -1224.97639, 0.974358974, 1.29228279),
    (1.005, 781.666667, 195.416667, 1.0, 1.0),
    (1.0075, 1175.41667, 293.854167, 1.0, 1.0),
    (1.02, 1038.26725, 259.566812, 1.012406948, 0.883318467),
];

fn axial<T: Real, const D: usize>(stretch: f64) -> Matrix<T, D> {
    let mut f = Matrix::identity();
    f[(1, 1)] = T::of(stretch);
    f
}

/// Kirchhoff stress, J_P and hardening after the return map of `trial`.
fn respond<T: Real, const D: usize>(snow: &Snow<T>, trial: &Matrix<T, D>) -> (Matrix<T, D>, T, T) {
    let (f, ratio) = match snow.flow(trial, T::one()) {
        Some(flow) => (flow.deformation, flow.plastic_ratio),
        None => (*trial, T::one()),
    };
    let hardening = ConstitutiveModel::<T, D>::hardening(snow, ratio);
    (snow.kirchhoff(&f, hardening), ratio, hardening)
}

fn check_points<T: Real, const D: usize>(relative: f64) {
    for (stretch, tau_yy, tau_xx, expected_ratio, expected_hardening) in POINTS {
        let (tau, ratio, hardening) = respond(&snow::<T>(), &axial::<T, D>(stretch));
        let what = format!("{D}D, F = {stretch}");
        assert_near(tau[(1, 1)].as_f64(), tau_yy, relative, &format!("{what}, tau_yy"));
        for k in (0..D).filter(|&k| k != 1) {
            assert_near(tau[(k, k)].as_f64(), tau_xx, relative, &format!("{what}, tau on axis {k}"));
        }
        assert_near(ratio.as_f64(), expected_ratio, relative.min(1e-6), &format!("{what}, J_P"));
        assert_near(
            hardening.as_f64(),
            expected_hardening,
            relative.min(1e-5),
            &format!("{what}, hardening"),
        );
        for i in 0..D {
            for j in (0..D).filter(|&j| j != i) {
                assert!(tau[(i, j)].as_f64().abs() <= relative * tau_yy.abs(), "{what}: shear {tau}");
            }
        }
    }
}

/// The table has 9 digits, so 1e-8 is what it can show; f32 strains of 1e-2 keep 1e-7 / 1e-2 = 1e-5 of their value.
#[test]
fn stresses_at_the_six_points_in_2d_and_in_plane_strain() {
    check_points::<f64, 2>(1e-8);
    check_points::<f64, 3>(1e-8);
    check_points::<f32, 2>(5e-5);
    check_points::<f32, 3>(5e-5);
}

/// Away from the table's rounding: inside the limits tau_yy = M (F - 1) F and tau_xx = lambda (F - 1) F, exactly.
#[test]
fn uniaxial_strain_is_linear_in_first_piola_stress() {
    let Lame { mu, lambda } = snow::<f64>().lame;
    for stretch in [0.5, 0.976, 0.9999, 1.0, 1.0001, 1.3, 2.0] {
        let piola = elastic::<f64>().first_piola(&axial::<f64, 3>(stretch), 1.0);
        assert!((piola[(1, 1)] - (lambda + 2.0 * mu) * (stretch - 1.0)).abs() < 1e-9);
        assert!((piola[(0, 0)] - lambda * (stretch - 1.0) * stretch).abs() < 1e-9);
    }
}

/// Compression past 1 - theta_c, back through rest, and out past 1 + theta_s, in one particle's history.
#[test]
fn a_strain_path_through_both_limits_keeps_the_total_volume() {
    let snow = snow::<f64>();
    let (mut f, mut ratio, mut total) = (Matrix::<f64, 2>::identity(), 1.0, 1.0);
    let path = (0..200).map(|i| if i < 60 { 0.999 } else { 1.0007 });
    let mut yields = (0, 0);
    for increment in path {
        total *= increment;
        f = axial::<f64, 2>(increment) * f;
        if let Some(flow) = snow.flow(&f, ratio) {
            if flow.plastic_ratio < ratio {
                yields.0 += 1
            } else {
                yields.1 += 1
            }
            (f, ratio) = (flow.deformation, flow.plastic_ratio);
        }
        assert!((0.975 - 1e-12..=1.0075 + 1e-12).contains(&f[(1, 1)]));
        assert_near(determinant(&f) * ratio, total, 1e-12, "J_E J_P");
    }
    // 0.999^n < 0.975 from n = 26 of 60 on; 0.975 1.0007^n > 1.0075 from n = 47 of 140 on.
    assert_eq!(yields, (35, 94));
    assert_near(f[(1, 1)], 1.0075, 1e-12, "stretch at the end");
    assert_near(ratio, 0.999f64.powi(60) * 1.0007f64.powi(140) / 1.0075, 1e-12, "J_P at the end");
}

#[test]
fn hardening_doubles_and_halves_where_the_exponential_says() {
    let snow = snow::<f64>();
    let hardening = |ratio| ConstitutiveModel::<f64, 2>::hardening(&snow, ratio);
    assert_eq!(hardening(1.0), 1.0);
    assert_near(hardening(0.5), 148.413_159_102_576_6, 1e-14, "e^5");
    assert_near(hardening(1.1), 0.367_879_441_171_442_3, 1e-14, "e^-1");
    assert_near(hardening(0.0), 22_026.465_794_806_718, 1e-14, "e^10 bounds hardening");
    assert_eq!(hardening(1e15), 0.0);
}

fn cases<const D: usize>() -> Vec<Matrix<f64, D>> {
    let mut random = Random(7);
    let mut list: Vec<Matrix<f64, D>> = (0..100).map(|_| random.matrix(1.5)).collect();
    let mut mirrored = Matrix::identity();
    mirrored[(0, 0)] = -1.1;
    let mut flat = Matrix::identity();
    flat[(D - 1, D - 1)] = 0.0;
    let rotated = random.rotation::<f64, D>();
    list.extend([mirrored, flat, rotated * mirrored, rotated * flat * rotated, rotated, rotated * 0.97]);
    list
}

/// Distance of F from where R jumps (2D: s_0 + s_1 = 0; 3D: s_1 + s_2 = 0), where Psi has no derivative.
fn room_for_differences<const D: usize>(f: &Matrix<f64, D>) -> f64 {
    let s = signed_svd(f).stretches;
    s[D - 2] + s[D - 1]
}

fn check_derivative<const D: usize>() {
    let (law, step) = (elastic::<f64>(), 1e-5);
    let (mut inverted, mut singular) = (0, 0);
    for f in cases::<D>() {
        let room = room_for_differences(&f);
        if room < 0.1 {
            continue;
        }
        inverted += usize::from(determinant(&f) < -1e-3);
        singular += usize::from(determinant(&f).abs() < 1e-12);
        let piola = law.first_piola(&f, 1.7);
        let numeric = Matrix::<f64, D>::from_fn(|i, j| {
            let at = |d: f64| {
                let mut moved = f;
                moved[(i, j)] += d;
                law.energy_density(&moved, 1.7)
            };
            (at(step) - at(-step)) / (2.0 * step)
        });
        let error = largest(&(numeric - piola));
        // Central differences: step^2 of the third derivative, which near a jump of R grows as 1 / room^2.
        let allowed = 1e-9 * (1.0 + 1.0 / (room * room)) * 1.4e5;
        assert!(error <= allowed, "{D}D: {error:e} Pa off at {f} (room {room})");
        let tau = law.kirchhoff(&f, 1.7);
        assert!(
            largest(&(tau - piola * f.transpose())) <= 1e-9 * (1.0 + largest(&tau)),
            "tau = P F^T at {f}"
        );
        assert!(largest(&(tau - tau.transpose())) <= 1e-9 * (1.0 + largest(&tau)), "tau is symmetric at {f}");
    }
    assert!(inverted >= 10 && singular >= 2, "{inverted} inverted and {singular} singular cases were tried");
}

#[test]
fn stress_is_the_derivative_of_energy_inverted_and_singular_included() {
    check_derivative::<2>();
    check_derivative::<3>();
}

fn check_rotation<T: Real, const D: usize>(tolerance: f64) {
    let mut random = Random(11);
    for _ in 0..200 {
        let r = random.rotation::<T, D>();
        let law: Elastic<T> = elastic();
        assert!(law.energy_density(&r, T::one()).as_f64().abs() <= 1.4e5 * tolerance * tolerance * 50.0);
        assert!(largest(&law.kirchhoff(&r, T::one())) <= 1.4e5 * tolerance * 20.0);
        // And energy does not see a rotation of space or of the material.
        let f = Matrix::<T, D>::identity() + random.matrix::<T, D>(0.3);
        let q = random.rotation::<T, D>();
        let (plain, turned) = (law.energy_density(&f, T::one()), law.energy_density(&(r * f * q), T::one()));
        assert!((plain - turned).as_f64().abs() <= 1.4e5 * tolerance * 50.0, "{plain} against {turned}");
    }
}

#[test]
fn rotations_store_no_energy() {
    check_rotation::<f64, 2>(f64::EPSILON);
    check_rotation::<f64, 3>(f64::EPSILON);
    check_rotation::<f32, 2>(f64::from(f32::EPSILON));
    check_rotation::<f32, 3>(f64::from(f32::EPSILON));
}

fn check_return_map<T: Real, const D: usize>(tolerance: f64) {
    let (snow, mut random, mut flows) = (snow::<T>(), Random(13), 0);
    for number in 0..3000 {
        let size = [0.005, 0.03, 0.3][number % 3];
        let base = random.rotation::<T, D>();
        let trial = base * (Matrix::identity() + random.matrix::<T, D>(size));
        if determinant(&trial) <= T::zero() {
            continue;
        }
        let before = T::of(random.between(0.4, 1.6));
        let s = signed_svd(&trial).stretches;
        let within = s.iter().all(|s| (0.975..=1.0075).contains(&s.as_f64()));
        let Some(flow) = snow.flow(&trial, before) else {
            // Only at the limit itself may round-off decide otherwise.
            let near = s.iter().all(|s| (0.975 - tolerance..=1.0075 + tolerance).contains(&s.as_f64()));
            assert!(near, "stretches {s} must flow");
            continue;
        };
        let PlasticFlow { deformation, plastic_ratio, clamped, trial_energy, energy } = flow;
        let one = T::one();
        for (f, from_stretches) in [(&trial, trial_energy), (&deformation, energy)] {
            let whole = ConstitutiveModel::<T, D>::energy_density(&snow, f, one).as_f64();
            let off = (from_stretches.as_f64() - whole).abs();
            // dPsi = P : dF, and |P| is about sqrt(E Psi).
            let bound = tolerance * (YOUNG * (whole + YOUNG * tolerance * tolerance)).sqrt();
            assert!(off <= bound, "energy {from_stretches} of {f}, {whole}");
        }
        flows += 1;
        assert!(!within, "stretches {s} must not flow");
        assert!(!clamped);
        let kept = signed_svd(&deformation).stretches;
        for k in 0..D {
            let expected = s[k].as_f64().clamp(0.975, 1.0075);
            assert!((kept[k].as_f64() - expected).abs() <= tolerance, "{kept} from {s}");
        }
        let (all, split) = (determinant(&trial) * before, determinant(&deformation) * plastic_ratio);
        assert!((all - split).as_f64().abs() <= tolerance * all.as_f64(), "J_E J_P: {all} became {split}");
        // The rotations are those of the trial: U^T F V stays diagonal, so R is untouched.
        let (r, r_kept) = (
            snowlab_solver::math::polar_rotation(&trial),
            snowlab_solver::math::polar_rotation(&deformation),
        );
        assert!(largest(&(r - r_kept)) <= tolerance * 4.0, "rotation {r} became {r_kept}");
        // At unchanged stiffness the map takes energy out; with hardening it still must not add any, for the work of
        // the yield stress over a strain increment exceeds what xi theta / 2 < 1 of it stores.
        let psi = |f: &Matrix<T, D>| snow.energy_density(f, T::one()).as_f64();
        assert!(psi(&deformation) <= psi(&trial) + 1.4e5 * tolerance, "energy rose at {s}");
        // A second application changes nothing but round-off at the limit.
        if let Some(again) = snow.flow(&deformation, plastic_ratio) {
            assert!(largest(&(again.deformation - deformation)) <= tolerance);
            assert!(
                (again.plastic_ratio - plastic_ratio).as_f64().abs() <= tolerance * plastic_ratio.as_f64()
            );
        }
    }
    assert!(flows > 1500, "{flows} flows were tried");
}

#[test]
fn return_map_clamps_stretches_and_nothing_else() {
    check_return_map::<f64, 2>(1e-13);
    check_return_map::<f64, 3>(1e-13);
    check_return_map::<f32, 2>(3e-6);
    check_return_map::<f32, 3>(3e-6);
}

/// Psi(new, hardened) <= Psi(trial, old stiffness) for compression, where hardening follows: 0.975 has
/// d ln Psi_hard / ds = xi / 0.975, a fraction xi theta_c / 2 = 1/8 of the loss 2 / theta_c.
#[test]
fn hardening_never_stores_more_than_flow_releases() {
    let snow = snow::<f64>();
    for excess in [1e-6, 1e-4, 1e-3, 1e-2, 0.05] {
        for stretches in [[0.975 - excess, 1.0], [0.975 - excess, 0.975 - excess], [1.0075 + excess, 1.0]] {
            let trial = Matrix::<f64, 2>::from_diagonal(&Vector::<f64, 2>::new(stretches[0], stretches[1]));
            let flow = snow.flow(&trial, 1.0).expect("past the limit");
            let hardened = ConstitutiveModel::<f64, 2>::hardening(&snow, flow.plastic_ratio);
            let released =
                snow.energy_density(&trial, 1.0) - snow.energy_density(&flow.deformation, hardened);
            assert!(released > 0.0, "{released} J/m^2 at {stretches:?}");
        }
    }
}

#[test]
fn bounds_on_the_plastic_ratio_hold_and_are_reported() {
    let bounded = Snow { plastic_ratio_bounds: (0.6, 1.2), ..snow::<f64>() };
    let crushed = bounded.flow(&(Matrix::<f64, 2>::identity() * 0.7), 1.0).expect("flows");
    assert_eq!((crushed.plastic_ratio, crushed.clamped), (0.6, true));
    let torn = bounded.flow(&(Matrix::<f64, 2>::identity() * 1.4), 1.0).expect("flows");
    assert_eq!((torn.plastic_ratio, torn.clamped), (1.2, true));
    let free = bounded.flow(&(Matrix::<f64, 2>::identity() * 0.95), 1.0).expect("flows");
    assert!(!free.clamped);
    assert_near(free.plastic_ratio, (0.95f64 / 0.975).powi(2), 1e-14, "J_P inside its bounds");
}

#[test]
fn hardening_has_a_limit_where_it_is_given_one() {
    let limited = Snow { hardening_limit: 8.0, ..snow::<f64>() };
    let factor = |ratio: f64| ConstitutiveModel::<f64, 2>::hardening(&limited, ratio);
    assert_near(factor(0.9), 1.0_f64.exp(), 1e-14, "below the limit it is S13's");
    assert_eq!(factor(0.5), 8.0);
    assert!(factor(1.2) < 1.0, "what has opened softens as ever");
}

/// The bound that the time step uses must not lie below the true largest eigenvalue of d2Psi/dF2 contracted with F, here taken
/// by differences of tau along random directions: |d tau| <= modulus |G| for F' = (I + G) F, stress-free part aside.
#[test]
fn wave_modulus_bounds_the_stiffness_at_rest() {
    let Lame { mu, lambda } = elastic::<f64>().lame;
    assert_near(elastic::<f64>().lame.wave_modulus::<2>(), 2.0 * mu + 2.0 * lambda, 1e-15, "2 mu + 2 lambda");
    let (law, step) = (Material::Elastic(elastic::<f64>()), 1e-6);
    let mut random = Random(17);
    let mut reached: f64 = 0.0;
    let mut directions: Vec<Matrix<f64, 3>> = (0..500).map(|_| random.matrix(1.0)).collect();
    directions.push(Matrix::identity());
    for g in directions {
        let tau = |s: f64| law.kirchhoff(&(Matrix::<f64, 3>::identity() + g * s), 1.0);
        let slope = (tau(step) - tau(-step)) / (2.0 * step);
        reached = reached.max(slope.norm() / g.norm());
    }
    let bound = ConstitutiveModel::<f64, 3>::wave_modulus(&law, &Matrix::identity());
    assert_near(reached, bound, 1e-6, "the largest response is the volumetric one");
}
