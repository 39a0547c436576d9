//! How long a step may be.

use crate::geometry::Vector;
use crate::kernel::KernelKind;
use crate::material::ConstitutiveModel;
use crate::real::Real;
use crate::scene::{Integrator, Scene, StepLength, Transfer};
use crate::state::State;

/// By how much an implicit step may be longer than the one before (chosen: from the explicit limit to twenty times it in eight steps; after a
/// halving it takes two to try the refused length again).
const GROWTH: f64 = 1.5;

/// The largest dt max_p c_p / h at which the explicit step is stable for a particle on its own, the least stable placement there is;
/// c_p^2 = (2 mu + D lambda) V / m. 2 / sqrt(2 g - k): g = max sum_i |dw/dx|^2 / w on one axis bounds the grid's frequency, k is the
/// part of g that the particle's affine velocity keeps from one step to the next. Derived and measured in docs/stability.md.
pub fn wave_limit(kernel: KernelKind, transfer: Transfer) -> f64 {
    let (bound, inverse_inertia) = (kernel.gradient_bound(), kernel.inverse_inertia());
    let (greatest, kept) = match transfer {
        Transfer::Flip(_) => (bound, 0.0),
        Transfer::Apic => (bound, inverse_inertia),
        // For D^-1 w (x_i - x_p) the sum is D^-1 itself.
        Transfer::Mls => (inverse_inertia, inverse_inertia),
    };
    2.0 / (greatest + greatest - kept).sqrt()
}

/// max_p c_p^2 [m^2/s^2], with the stiffness each particle has now.
pub fn fastest_wave_squared<T: Real, const D: usize>(scene: &Scene<T, D>, state: &State<T, D>) -> T {
    let (motion, constants) = (&state.motion, &state.constants);
    let mut fastest = T::zero();
    for p in 0..motion.len() {
        let modulus = scene.materials[constants.material[p] as usize].wave_modulus(&motion.deformation[p]);
        let squared = modulus * motion.stiffness[p] * constants.volume[p] / constants.mass[p];
        if squared > fastest {
            fastest = squared;
        }
    }
    fastest
}

/// max |v_p|^2 [m^2/s^2].
pub(crate) fn fastest_particle_squared<T: Real, const D: usize>(velocities: &[Vector<T, D>]) -> T {
    velocities.iter().fold(T::zero(), |fastest, v| {
        let squared = v.norm_squared();
        if squared > fastest { squared } else { fastest }
    })
}

/// The length of the next step [s], before it is cut to meet an output.
pub fn step_length<T: Real, const D: usize>(scene: &Scene<T, D>, state: &State<T, D>) -> f64 {
    match scene.time_step.length {
        StepLength::Fixed(dt) => dt,
        StepLength::Adaptive { .. } => {
            let wave = fastest_wave_squared(scene, state);
            let history = StepHistory { factor: state.step_factor, reach: state.step_reach };
            step_length_for(scene, history, [wave, fastest_particle_squared(&state.motion.velocity)])
        }
    }
}

/// What earlier steps say of the next one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StepHistory {
    /// The watchdog's factor.
    pub factor: f64,
    /// The length up to which the latest step was free to go [s]; 0 before the first.
    pub reach: f64,
}

/// [`step_length`] from max c_p^2 and max |v_p|^2 [m^2/s^2].
pub(crate) fn step_length_for<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    history: StepHistory,
    fastest_squared: [T; 2],
) -> f64 {
    match scene.time_step.length {
        StepLength::Fixed(dt) => dt,
        StepLength::Adaptive { wave, advection, greatest } => {
            let h = scene.spacing.as_f64();
            let explicit = 0.5 * wave_limit(scene.kernel, scene.transfer);
            let [wave_speed, speed] = fastest_squared.map(|squared| squared.as_f64().sqrt());
            let of_wave = |courant: f64| courant * history.factor * h / wave_speed;
            // A speed of 0 gives an infinite limit, which `greatest` bounds.
            let bound = (advection * h / speed).min(greatest);
            if scene.integrator == Integrator::Explicit {
                return bound.min(of_wave(wave.unwrap_or(explicit)));
            }
            let bound = wave.map_or(bound * history.factor, |courant| bound.min(of_wave(courant)));
            let first = of_wave(explicit);
            bound.min(if history.reach > 0.0 { GROWTH * history.reach } else { first })
        }
    }
}

/// `dt` cut so that `remaining` seconds are met exactly: the last two steps share evenly what is left for them, rather
/// than that the last one is tiny.
pub fn meet(dt: f64, remaining: f64) -> f64 {
    // Times add up with round-off: a step that misses the end by that much meets it.
    if dt * (1.0 + 1e-9) >= remaining {
        remaining
    } else if 2.0 * dt > remaining {
        0.5 * remaining
    } else {
        dt
    }
}
