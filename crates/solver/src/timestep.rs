//! How long a step may be.

use crate::geometry::Vector;
use crate::kernel::KernelKind;
use crate::material::ConstitutiveModel;
use crate::real::Real;
use crate::scene::{Scene, StepLength, Transfer};
use crate::state::State;

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
            step_length_for(
                scene,
                state.step_factor,
                [wave, fastest_particle_squared(&state.motion.velocity)],
            )
        }
    }
}

/// [`step_length`] from max c_p^2 and max |v_p|^2 [m^2/s^2].
pub(crate) fn step_length_for<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    step_factor: f64,
    fastest_squared: [T; 2],
) -> f64 {
    match scene.time_step.length {
        StepLength::Fixed(dt) => dt,
        StepLength::Adaptive { wave, advection, greatest } => {
            let h = scene.spacing.as_f64();
            let courant =
                wave.unwrap_or_else(|| 0.5 * wave_limit(scene.kernel, scene.transfer)) * step_factor;
            let [wave_speed, speed] = fastest_squared.map(|squared| squared.as_f64().sqrt());
            // A speed of 0 gives an infinite limit, which `greatest` bounds.
            (courant * h / wave_speed).min(advection * h / speed).min(greatest)
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
