//! Frequency and decay of a small wave on a lattice of particles, exactly as the steps have them.
//!
//! A wave e^{ikx} of one velocity V at the nodes reaches a particle as a V, its gradient as b V / h and the affine matrix as D^-1 c V / h,
//! with d = (x_i - x_p) / h and
//!
//! ```text
//! a = sum_i N e^{ikhd}     b = sum_i N' e^{ikhd}     c = sum_i N d e^{ikhd}     (D^-1 in units of h^-2)
//! ```
//!
//! What particles give back to the nodes is the conjugate's mean over the particles of a cell. So with A, B and Q the means of |a|^2, |b|^2
//! and |c|^2, a step takes the strain e and the velocity (the nodes' for apic and mls, for flip what particles would give them) to
//!
//! ```text
//! V* = V - dt c^2 e,   e' = e + dt (B / h^2) V*,   V' = r V - dt c^2 s e
//! flip   r = a + (1 - a) A      s = A      a the share of flip
//! apic   r = A + D^-1 Q         s = r
//! mls    the same, with D^-2 Q in the place of B
//! ```
//!
//! whose matrix has the trace 1 + r - z and the determinant r - z (r - s), z = (dt c / h)^2 B, and the roots e^{(-decay +- i frequency) dt}.

use snowlab_solver::kernel::{Cubic, Kernel, Quadratic};
use snowlab_solver::{KernelKind, Transfer};

/// A lattice of particles on a grid, and the steps it is moved in.
#[derive(Clone, Copy, Debug)]
pub struct Lattice {
    pub kernel: KernelKind,
    pub transfer: Transfer,
    /// Particles per cell and axis.
    pub per_axis: usize,
    /// Spacing of the grid [m].
    pub spacing: f64,
    /// Speed of waves in the continuum [m/s].
    pub speed: f64,
    /// Step [s].
    pub dt: f64,
}

/// How a wave goes on.
#[derive(Clone, Copy, Debug)]
pub struct Wave {
    /// Angular frequency [1/s].
    pub frequency: f64,
    /// Decay of the amplitude [1/s].
    pub decay: f64,
}

impl Lattice {
    /// The wave of number `k` [1/m].
    pub fn wave(&self, k: f64) -> Wave {
        let [value, gradient, affine] = self.means(k * self.spacing);
        let inverse_inertia = self.kernel.inverse_inertia();
        let fitted = value + inverse_inertia * affine;
        let (kept, given, strain) = match self.transfer {
            Transfer::Flip(share) => {
                let share = share.of_step(self.dt);
                (share + (1.0 - share) * value, value, gradient)
            }
            Transfer::Apic => (fitted, fitted, gradient),
            Transfer::Mls => (fitted, fitted, inverse_inertia * inverse_inertia * affine),
        };
        let z = (self.dt * self.speed / self.spacing).powi(2) * strain;
        let (trace, determinant) = (1.0 + kept - z, kept - z * (kept - given));
        Wave {
            frequency: libm::acos(0.5 * trace / determinant.sqrt()) / self.dt,
            decay: -0.5 * libm::log(determinant) / self.dt,
        }
    }

    /// What of the particles' velocity moves them at the start: flip's go with A of it, those of apic and mls with all, but for O((kh)^4).
    pub fn moving(&self, k: f64) -> f64 {
        if self.transfer.keeps_affine() { 1.0 } else { self.means(k * self.spacing)[0] }
    }

    /// A, B and Q at k h = `phase`.
    fn means(&self, phase: f64) -> [f64; 3] {
        let mut means = [0.0; 3];
        for place in 0..self.per_axis {
            let x = (place as f64 + 0.5) / self.per_axis as f64;
            let (first, weights, slopes) = match self.kernel {
                KernelKind::Cubic => Cubic::weights(x),
                KernelKind::Quadratic => Quadratic::weights(x),
            };
            let mut sums = [[0.0; 2]; 3];
            for (node, (weight, slope)) in weights.iter().zip(&slopes).enumerate() {
                let d = f64::from(first) + node as f64 - x;
                let (sin, cos) = libm::sincos(phase * d);
                for (sum, factor) in sums.iter_mut().zip([*weight, *slope, weight * d]) {
                    *sum = [sum[0] + factor * cos, sum[1] + factor * sin];
                }
            }
            for (mean, [re, im]) in means.iter_mut().zip(sums) {
                *mean += (re * re + im * im) / self.per_axis as f64;
            }
        }
        means
    }
}
