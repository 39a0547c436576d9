//! The scene of all measurements: a ball of snow that falls on a floor.

use snowlab_solver::geometry::{Matrix, Vector, unit};
use snowlab_solver::{
    Advection, Collider, Contact, Engine, InitialParticle, Integrator, KernelKind, Lame, Material, Real,
    Scene, Shape, Snow, State, TimeStepControl, Transfer,
};

/// [m].
pub const RADIUS: f64 = 0.25;
/// Downwards at the beginning [m/s].
pub const SPEED: f64 = 8.0;
/// (nearly; chosen: between the 4 and the 8 that people use).
pub const PARTICLES_A_CELL: f64 = 6.0;

/// What a ball may differ in.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    pub kernel: KernelKind,
    pub transfer: Transfer,
    pub particles: usize,
    /// Between the ball and the floor [m].
    pub gap: f64,
    /// Whether it is being flattened and sheared, as if the floor had already stopped its foot.
    pub squashed: bool,
    pub energy_budget: bool,
    /// Particles to a cell.
    pub per_cell: f64,
}

impl Ball {
    /// The ball at t = 0, with S13's snow.
    pub fn build<T: Real, const D: usize>(&self) -> (Scene<T, D>, State<T, D>) {
        let (scene, volume) = (self.scene(), self.volume(D));
        let particles: Vec<_> = evenly_spread::<D>()
            .take(self.particles)
            .map(|position| InitialParticle {
                position,
                velocity: self.velocity(&position),
                mass: 400.0 * volume,
                volume,
                stiffness_scale: 1.0,
                material: 0,
                deformation: Matrix::identity(),
                plastic_ratio: 1.0,
            })
            .collect();
        let state = State::at_rest(&scene, Vector::zeros(), &particles).expect("a valid body");
        (scene, state)
    }

    /// Of a particle at `x` [m]; [m/s]. Squashed, nothing moves at the foot, at `SPEED` the centre, and the shear (chosen) keeps principal axes
    /// off the grid's, where a decomposition would be easy.
    fn velocity<const D: usize>(&self, x: &Vector<f64, D>) -> Vector<f64, D> {
        let mut velocity = unit::<f64, D>(1) * -SPEED;
        if self.squashed {
            let rate = SPEED / RADIUS;
            velocity[0] += rate * x[1];
            velocity[1] -= rate * x[1];
            velocity[D - 1] += 0.5 * rate * x[0];
        }
        velocity
    }

    /// Grid spacing in so many dimensions [m].
    pub fn spacing(&self, dimension: usize) -> f64 {
        (self.per_cell * self.volume(dimension)).powf(1.0 / dimension as f64)
    }

    /// Of a particle [m^dimension].
    fn volume(&self, dimension: usize) -> f64 {
        let of_unit_ball = if dimension == 2 { 1.0 } else { 4.0 / 3.0 } * std::f64::consts::PI;
        of_unit_ball * RADIUS.powi(dimension as i32) / self.particles as f64
    }

    fn scene<T: Real, const D: usize>(&self) -> Scene<T, D> {
        Scene {
            spacing: T::of(self.spacing(D)),
            kernel: self.kernel,
            transfer: self.transfer,
            engine: Engine::Fast,
            integrator: Integrator::Explicit,
            advection: Advection::Interpolated,
            // S13, table 2.
            materials: vec![Material::Snow(Snow {
                lame: Lame::from_young(1.4e5, 0.2),
                critical_compression: T::of(2.5e-2),
                critical_stretch: T::of(7.5e-3),
                hardening: T::of(10.0),
                plastic_ratio_bounds: (T::zero(), T::of(f64::INFINITY)),
                hardening_limit: T::of(f64::INFINITY),
            })],
            colliders: vec![Collider {
                shape: Shape::HalfSpace {
                    point: unit::<T, D>(1) * T::of(-RADIUS - self.gap),
                    normal: unit(1),
                },
                contact: Contact::Separate,
                friction: T::of(0.5),
                velocity: Vector::zeros(),
            }],
            gravity: unit::<T, D>(1) * T::of(-9.81),
            time_step: TimeStepControl::default(),
            energy_budget: self.energy_budget,
        }
    }
}

/// Points in a ball about the origin: those of an additive recurrence in the cube round it, by powers of the inverse root of
/// x^(D+1) = x + 1 (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
fn evenly_spread<const D: usize>() -> impl Iterator<Item = Vector<f64, D>> {
    let root: f64 = if D == 2 { 1.324_717_957_244_746 } else { 1.220_744_084_605_759_5 };
    (1..)
        .map(move |n| {
            Vector::from_fn(|k, _| (2.0 * (f64::from(n) * root.powi(-1 - k as i32)).fract() - 1.0) * RADIUS)
        })
        .filter(|x: &Vector<f64, D>| x.norm() <= RADIUS)
}
