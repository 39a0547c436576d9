//! Named ChaCha8 streams of one seed, and the distributions drawn from them.

use std::f64::consts::PI;

pub use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use snowlab_solver::geometry::{Matrix, Vector};

/// What a stream of random numbers is for. The discriminant is the ChaCha stream number and never changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u64)]
pub enum Purpose {
    /// Positions of particles.
    Placement = 1,
    /// Void fields.
    Voids = 2,
    /// The shift of the scene against the grid.
    GridPhase = 3,
    /// Noise on particle masses, volumes or stiffness.
    Noise = 4,
    /// Random subsets of particles.
    Thinning = 5,
    /// Perturbations of an initial state.
    Perturbation = 6,
}

/// The random numbers of one block: one seed, one independent ChaCha8 stream per [`Purpose`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Streams {
    seed: u64,
}

impl Streams {
    /// The streams of `seed`; neighbouring seeds are unrelated.
    pub const fn new(seed: u64) -> Self {
        Self { seed }
    }

    /// The seed.
    pub const fn seed(&self) -> u64 {
        self.seed
    }

    /// The stream for `purpose`, from its beginning. The 256-bit key is four outputs of SplitMix64 started at the
    /// seed (Steele, Lea & Flood 2014), spelled out here so that no dependency can change it.
    pub fn stream(&self, purpose: Purpose) -> ChaCha8Rng {
        let mut key = [0_u8; 32];
        let mut state = self.seed;
        for word in key.chunks_exact_mut(8) {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut mixed = state;
            mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            word.copy_from_slice(&(mixed ^ (mixed >> 31)).to_le_bytes());
        }
        let mut generator = ChaCha8Rng::from_seed(key);
        generator.set_stream(purpose as u64);
        generator
    }
}

/// Uniform in `[0, 1)`: the upper 53 bits of one 64-bit word.
pub fn uniform(rng: &mut ChaCha8Rng) -> f64 {
    (rng.next_u64() >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
}

/// Uniform in the unit cube `[0, 1)^D`, axes in order.
pub fn uniform_vector<const D: usize>(rng: &mut ChaCha8Rng) -> Vector<f64, D> {
    let mut point = Vector::<f64, D>::zeros();
    for axis in 0..D {
        point[axis] = uniform(rng);
    }
    point
}

/// Uniform among `0..count`, `count > 0`; the bias is below `count / 2^53`.
pub fn uniform_index(rng: &mut ChaCha8Rng, count: usize) -> usize {
    ((uniform(rng) * count as f64) as usize).min(count - 1)
}

/// Standard normal (Box & Muller 1958, the cosine of the pair); two words each.
pub fn normal(rng: &mut ChaCha8Rng) -> f64 {
    let radius = (-2.0 * libm::log(1.0 - uniform(rng))).sqrt();
    radius * libm::cos(2.0 * PI * uniform(rng))
}

/// Independent standard normal components.
pub fn normal_vector<const D: usize>(rng: &mut ChaCha8Rng) -> Vector<f64, D> {
    let mut sample = Vector::<f64, D>::zeros();
    for axis in 0..D {
        sample[axis] = normal(rng);
    }
    sample
}

/// Gamma of mean 1 and standard deviation `spread`, that is of shape `1/spread^2` (Marsaglia & Tsang 2000; shapes
/// below 1 by their power of a uniform number). A `spread` of 0 or one that is no number gives 1; others are held
/// to 1e-6..1e3.
pub fn unit_mean_gamma(rng: &mut ChaCha8Rng, spread: f64) -> f64 {
    if spread.is_nan() || spread <= 0.0 {
        return 1.0;
    }
    let spread = spread.clamp(1e-6, 1e3);
    let shape = 1.0 / (spread * spread);
    let boosted = if shape < 1.0 { shape + 1.0 } else { shape };
    let d = boosted - 1.0 / 3.0;
    let c = 1.0 / (9.0 * d).sqrt();
    let sample = loop {
        let x = normal(rng);
        let v = 1.0 + c * x;
        if v <= 0.0 {
            continue;
        }
        let v = v * v * v;
        if libm::log(1.0 - uniform(rng)) < 0.5 * x * x + d - d * v + d * libm::log(v) {
            break d * v;
        }
    };
    let boost = if shape < 1.0 { libm::pow(1.0 - uniform(rng), 1.0 / shape) } else { 1.0 };
    sample * boost / shape
}

/// Uniform direction on the unit circle or sphere: a normalised Gaussian vector (Muller 1959).
pub fn direction<const D: usize>(rng: &mut ChaCha8Rng) -> Vector<f64, D> {
    let sample = normal_vector::<D>(rng);
    let length = sample.norm();
    if length > 0.0 {
        sample / length
    } else {
        Vector::<f64, D>::from_fn(|axis, _| if axis == 0 { 1.0 } else { 0.0 })
    }
}

/// Uniformly distributed orthonormal axes, as columns: Gram-Schmidt on Gaussian vectors (Stewart 1980), done twice
/// for orthogonality to the last bits (Giraud, Langou & Rozloznik 2005).
pub fn orientation<const D: usize>(rng: &mut ChaCha8Rng) -> Matrix<f64, D> {
    let mut axes = Matrix::<f64, D>::identity();
    for axis in 0..D {
        let mut column = direction::<D>(rng);
        for _ in 0..2 {
            for earlier in 0..axis {
                let previous = axes.column(earlier).into_owned();
                column -= previous * previous.dot(&column);
            }
            let length = column.norm();
            // Chosen: below this the directions agree to half the digits, which leaves nothing to make an axis of.
            if length < 1e-8 {
                return Matrix::<f64, D>::identity();
            }
            column /= length;
        }
        axes.set_column(axis, &column);
    }
    axes
}
