//! One void: a perturbed circle or sphere, as it is or stretched at constant volume into an ellipse or ellipsoid.

use std::f64::consts::PI;

use rand_chacha::ChaCha8Rng;
use snowlab_solver::geometry::{Matrix, Vector};

use crate::rng;

/// Lengths of the wave vectors that make an outline irregular; amplitudes fall as their inverse. Chosen: by the
/// Jacobi-Anger expansion a wave of length 4 to 9 on the unit circle has its power in the second to ninth harmonic of
/// the angle, so that outlines are dented and hardly shifted; six waves are enough for outlines to differ.
const WAVE_LENGTHS: [f64; 6] = [4.0, 5.0, 6.0, 7.0, 8.0, 9.0];

/// An irregular outline about the origin, star-shaped, of the area or volume of the unit circle or sphere:
/// `rho(n) = scale (1 + sum_j a_j cos(q_j . n + phase_j))` for a direction `n`, one formula in 2D and 3D.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Outline<const D: usize> {
    waves: [Wave<D>; WAVE_LENGTHS.len()],
    scale: f64,
    /// Sum of the amplitudes.
    most: f64,
}

#[derive(Clone, Debug, PartialEq)]
struct Wave<const D: usize> {
    vector: Vector<f64, D>,
    phase: f64,
    amplitude: f64,
}

impl<const D: usize> Outline<D> {
    /// Draws an outline whose radius varies by `irregularity` (relative root mean square); `directions` serve as
    /// quadrature for its volume.
    pub fn draw(irregularity: f64, directions: &[Vector<f64, D>], rng: &mut ChaCha8Rng) -> Self {
        let power: f64 = WAVE_LENGTHS.iter().map(|length| 1.0 / (length * length)).sum();
        let waves = WAVE_LENGTHS.map(|length| Wave {
            vector: rng::direction::<D>(rng) * length,
            phase: 2.0 * PI * rng::uniform(rng),
            amplitude: irregularity * (2.0 / power).sqrt() / length,
        });
        let most = waves.iter().map(|wave| wave.amplitude).sum();
        let mut outline = Self { waves, scale: 1.0, most };
        let mean_power = directions.iter().map(|n| volume_power::<D>(outline.radius(n))).sum::<f64>()
            / directions.len() as f64;
        outline.scale = if D == 2 { 1.0 / mean_power.sqrt() } else { 1.0 / libm::cbrt(mean_power) };
        outline
    }

    /// Radius in the direction `n` of unit length.
    pub fn radius(&self, n: &Vector<f64, D>) -> f64 {
        let sum: f64 =
            self.waves.iter().map(|wave| wave.amplitude * libm::cos(wave.vector.dot(n) + wave.phase)).sum();
        self.scale * (1.0 + sum)
    }

    /// Its points in the `directions`.
    pub fn points(&self, directions: &[Vector<f64, D>]) -> Vec<Vector<f64, D>> {
        directions.iter().map(|n| n * self.radius(n)).collect()
    }

    /// A radius the outline never falls below.
    pub fn least(&self) -> f64 {
        self.scale * (1.0 - self.most)
    }

    /// A radius the outline never exceeds.
    fn greatest(&self) -> f64 {
        self.scale * (1.0 + self.most)
    }
}

/// A void of a drawn field; lengths in metres.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Inclusion<const D: usize> {
    pub centre: Vector<f64, D>,
    /// Radius of the circle or sphere of the same area or volume [m].
    pub radius: f64,
    outline: Outline<D>,
    /// From an offset [m] to the frame of the outline.
    to_outline: Matrix<f64, D>,
    /// From the frame of the outline to an offset [m].
    from_outline: Matrix<f64, D>,
    /// No point of the void is farther than this from the centre [m].
    pub reach: f64,
    /// Every point nearer than this to the centre lies in the void [m].
    pub core: f64,
}

impl<const D: usize> Inclusion<D> {
    /// A void of equal-volume radius `radius` [m], stretched to `aspect` (long over short axis, 1: not at all) along
    /// the first column of `axes`; the stretch keeps area or volume, so the outline's is `radius^D` times the
    /// unit ball's whatever the aspect.
    pub fn new(
        centre: Vector<f64, D>,
        radius: f64,
        outline: Outline<D>,
        aspect: f64,
        axes: &Matrix<f64, D>,
    ) -> Self {
        let short = if D == 2 { 1.0 / aspect.sqrt() } else { 1.0 / libm::cbrt(aspect) };
        let mut stretch = Vector::<f64, D>::repeat(short);
        stretch[0] = short * aspect;
        let scaled =
            |factor: Vector<f64, D>| axes * Matrix::<f64, D>::from_diagonal(&factor) * axes.transpose();
        Self {
            centre,
            radius,
            to_outline: scaled(stretch.map(|s| 1.0 / (s * radius))),
            from_outline: scaled(stretch * radius),
            reach: radius * stretch.max() * outline.greatest(),
            core: radius * stretch.min() * outline.least(),
            outline,
        }
    }

    /// Whether `point` [m] lies in the void.
    pub fn contains(&self, point: &Vector<f64, D>) -> bool {
        let offset = point - self.centre;
        let squared = offset.norm_squared();
        if squared >= self.reach * self.reach {
            return false;
        }
        if squared < self.core * self.core {
            return true;
        }
        let local = self.to_outline * offset;
        let length = local.norm();
        if length < self.outline.least() {
            return true;
        }
        length < self.outline.greatest() && length < self.outline.radius(&(local / length))
    }

    /// Points of its surface as offsets from the centre [m], from [`Outline::points`].
    pub fn surface_offsets(&self, points: &[Vector<f64, D>]) -> Vec<Vector<f64, D>> {
        points.iter().map(|point| self.from_outline * point).collect()
    }
}

fn volume_power<const D: usize>(radius: f64) -> f64 {
    if D == 2 { radius * radius } else { radius * radius * radius }
}
