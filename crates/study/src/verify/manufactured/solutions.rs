//! Motions that are known exactly, since the body force is chosen to make them so (manufactured solutions).
//!
//! With x(X, t) given, F = dx/dX and the elastic law give P(F), and rho_0 b = rho_0 d2x/dt2 - Div P is the force that keeps
//! the body on that motion. It is evaluated at the particle's place at rest, X.

use std::f64::consts::PI;

use snowlab_solver::geometry::{Matrix, Vector};
use snowlab_solver::material::ConstitutiveModel;

use crate::verify::scenes::{DENSITY, elastic, lame};

/// A known motion of a body of elastic material with S13's moduli and density.
pub trait Solution<const D: usize>: Sync {
    /// x(X, t) [m].
    fn position(&self, rest: &Vector<f64, D>, time: f64) -> Vector<f64, D>;
    /// b(X, t) [m/s^2].
    fn body_acceleration(&self, rest: &Vector<f64, D>, time: f64) -> Vector<f64, D>;
}

/// Standing waves along the axes of the unit square or cube, each of period 2 / c and out of step with its neighbour:
/// u_k = A sin(pi X_k) sin(c pi t + k pi). The strains reach A pi.
#[derive(Clone, Copy, Debug)]
pub struct StandingWaves {
    /// A [m].
    pub amplitude: f64,
    /// c [m/s].
    pub speed: f64,
}

impl StandingWaves {
    /// The largest strain, A pi.
    pub fn largest_strain(&self) -> f64 {
        PI * self.amplitude
    }

    /// sin(c pi t + k pi).
    fn swing(&self, axis: usize, time: f64) -> f64 {
        let sign = if axis.is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * libm::sin(self.speed * PI * time)
    }
}

impl<const D: usize> Solution<D> for StandingWaves {
    fn position(&self, rest: &Vector<f64, D>, time: f64) -> Vector<f64, D> {
        Vector::from_fn(|k, _| rest[k] + self.amplitude * libm::sin(PI * rest[k]) * self.swing(k, time))
    }

    /// P_kk = 2 mu (F_kk - 1) + lambda (J - 1) J / F_kk, the other entries 0, so that b_k = pi^2 u_k ((2 mu + lambda (J / F_kk)^2) / rho_0 - c^2).
    fn body_acceleration(&self, rest: &Vector<f64, D>, time: f64) -> Vector<f64, D> {
        let moduli = lame();
        let stretch = |k: usize| 1.0 + self.amplitude * PI * libm::cos(PI * rest[k]) * self.swing(k, time);
        Vector::from_fn(|k, _| {
            let across = (0..D).filter(|&l| l != k).fold(1.0, |product, l| product * stretch(l));
            let displacement = self.amplitude * libm::sin(PI * rest[k]) * self.swing(k, time);
            let modulus = (2.0 * moduli.mu + moduli.lambda * across * across) / DENSITY;
            PI * PI * displacement * (modulus - self.speed * self.speed)
        })
    }
}

/// A vortex in a ring about the origin (after Kamojjala et al. 2015): the circle of radius R is turned by
/// alpha = A (1 - cos(2 pi t / T)) / 2 h(R), h = 1 - 32 s^2 + 256 s^4, s = R - (a + b) / 2, b - a = 1/2. h and h' vanish at both
/// edges, which are free of stress. Every particle is turned and sheared, by gamma = R dalpha/dR.
#[derive(Clone, Copy, Debug)]
pub struct Vortex {
    /// A [rad].
    pub angle: f64,
    /// T [s].
    pub period: f64,
    /// (a + b) / 2 [m].
    pub middle: f64,
}

impl Vortex {
    /// a [m].
    pub fn inner(&self) -> f64 {
        self.middle - 0.25
    }

    /// The largest shear, max |R dalpha/dR| where A is reached; of a thousand radii, to 1e-5 of itself.
    pub fn largest_shear(&self) -> f64 {
        let radii = (0..=1000).map(|k| self.inner() + 0.5 * f64::from(k) / 1000.0);
        let shear = |radius: f64| (self.angle * radius * self.profile(radius)[1]).abs();
        radii.map(shear).fold(0.0, f64::max)
    }

    /// h, h' and h''.
    fn profile(&self, radius: f64) -> [f64; 3] {
        let s = radius - self.middle;
        let ss = s * s;
        [1.0 - 32.0 * ss + 256.0 * ss * ss, -64.0 * s + 1024.0 * s * ss, -64.0 + 3072.0 * ss]
    }

    /// g = A (1 - cos(omega t)) / 2 with its first two derivatives in time.
    fn swing(&self, time: f64) -> [f64; 3] {
        let omega = 2.0 * PI / self.period;
        let (sin, cos) = libm::sincos(omega * time);
        let half = 0.5 * self.angle;
        [half * (1.0 - cos), half * omega * sin, half * omega * omega * cos]
    }

    /// R, e_r and e_t: the radius, and the directions outwards and round at the particle's place at `time`.
    fn frame(&self, rest: &Vector<f64, 2>, time: f64) -> (f64, Vector<f64, 2>, Vector<f64, 2>) {
        let radius = libm::hypot(rest[0], rest[1]);
        let turned = libm::atan2(rest[1], rest[0]) + self.swing(time)[0] * self.profile(radius)[0];
        let (sin, cos) = libm::sincos(turned);
        (radius, Vector::<f64, 2>::new(cos, sin), Vector::<f64, 2>::new(-sin, cos))
    }
}

impl Solution<2> for Vortex {
    fn position(&self, rest: &Vector<f64, 2>, time: f64) -> Vector<f64, 2> {
        let (radius, outwards, _) = self.frame(rest, time);
        outwards * radius
    }

    /// F = Q (I + gamma e_theta e_R^T), Q the rotation by alpha. Its polar rotation is Q times that by phi, tan phi = gamma / 2, and J = 1, so
    /// P = 2 mu [p1 (e_r e_R^T + e_t e_theta^T) + p2 e_r e_theta^T + p3 e_t e_R^T] with p1 = 1 - cos phi, p2 = sin phi,
    /// p3 = gamma - sin phi. With d/dR e_r = alpha' e_t and d/dTheta e_r = e_t:
    ///
    /// ```text
    /// Div P / (2 mu) = e_r (p1' - p3 alpha') + e_t (p1 alpha' + p3' + (p2 + p3) / R),     d2x/dt2 = R (alpha.. e_t - alpha.^2 e_r)
    /// ```
    fn body_acceleration(&self, rest: &Vector<f64, 2>, time: f64) -> Vector<f64, 2> {
        let (radius, outwards, round) = self.frame(rest, time);
        let [h, slope, bend] = self.profile(radius);
        let [g, rate, acceleration] = self.swing(time);
        let (turn, shear, shear_slope) = (g * slope, radius * g * slope, g * (slope + radius * bend));
        let length = (4.0 + shear * shear).sqrt();
        let (sin, cos) = (shear / length, 2.0 / length);
        let phi_slope = 2.0 * shear_slope / (length * length);
        let (p1, p2, p3) = (1.0 - cos, sin, shear - sin);
        let (p1_slope, p3_slope) = (sin * phi_slope, shear_slope - cos * phi_slope);
        let divergence =
            outwards * (p1_slope - p3 * turn) + round * (p1 * turn + p3_slope + (p2 + p3) / radius);
        let second = (round * (acceleration * h) - outwards * (rate * h * rate * h)) * radius;
        second - divergence * (2.0 * lame().mu / DENSITY)
    }
}

/// dx/dX at a place at rest, by central differences.
pub fn deformation_gradient<const D: usize>(
    solution: &impl Solution<D>,
    rest: &Vector<f64, D>,
    time: f64,
) -> Matrix<f64, D> {
    // chosen: truncation (the step's square over 6) and round-off both stay below 1e-10.
    let step = 1e-5;
    let mut f = Matrix::<f64, D>::zeros();
    for k in 0..D {
        let arm = along(k, step);
        let ends = solution.position(&(rest + arm), time) - solution.position(&(rest - arm), time);
        f.set_column(k, &(ends / (2.0 * step)));
    }
    f
}

/// The vector of the given length along an axis.
fn along<const D: usize>(axis: usize, length: f64) -> Vector<f64, D> {
    Vector::from_fn(|k, _| if k == axis { length } else { 0.0 })
}

/// The largest difference between a solution's body force and central differences of its motion and stress, over the largest force, at the
/// given places and time.
pub fn difference_from_finite_differences<const D: usize>(
    solution: &impl Solution<D>,
    places: &[Vector<f64, D>],
    time: f64,
) -> f64 {
    // chosen: third derivatives of the motion lose no more than 1e-7 to truncation and round-off.
    let (step, moment) = (1e-4, 1e-6);
    let material = elastic::<f64>();
    let stress = |x: &Vector<f64, D>| material.first_piola(&deformation_gradient(solution, x, time), 1.0);
    let (mut largest, mut size) = (0.0_f64, 0.0_f64);
    for x in places {
        let mut divergence = Vector::<f64, D>::zeros();
        for k in 0..D {
            let arm = along(k, step);
            divergence += (stress(&(x + arm)) - stress(&(x - arm))).column(k) / (2.0 * step);
        }
        let second = (solution.position(x, time + moment) + solution.position(x, time - moment)
            - solution.position(x, time) * 2.0)
            / (moment * moment);
        let force = solution.body_acceleration(x, time);
        largest = largest.max((second - divergence / DENSITY - force).norm());
        size = size.max(force.norm());
    }
    largest / size
}
