//! Scenes, bodies and numbers that the tests share.

use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::geometry::{Matrix, Shape, Vector, unit};
use snowlab_solver::{
    Advection, Elastic, FlipShare, InitialParticle, Integrator, KernelKind, Lame, Material, Real, Scene,
    Snow, State, StepLength, TimeStepControl, Transfer,
};

pub const YOUNG: f64 = 1.4e5;
pub const POISSON: f64 = 0.2;
pub const DENSITY: f64 = 400.0;
/// lambda + 2 mu of the default snow [Pa].
pub const M: f64 = 155_555.555_555_555_56;
pub const KERNELS: [KernelKind; 2] = [KernelKind::Cubic, KernelKind::Quadratic];

/// SplitMix64 (Steele, Lea & Flood 2014).
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Uniform in [low, high).
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn vector<T: Real, const D: usize>(&mut self, size: f64) -> Vector<T, D> {
        Vector::from_fn(|_, _| T::of(self.between(-size, size)))
    }

    pub fn matrix<T: Real, const D: usize>(&mut self, size: f64) -> Matrix<T, D> {
        Matrix::from_fn(|_, _| T::of(self.between(-size, size)))
    }

    /// A proper rotation: Gram and Schmidt on random vectors.
    pub fn rotation<T: Real, const D: usize>(&mut self) -> Matrix<T, D> {
        let mut columns: Vec<Vector<f64, D>> = Vec::new();
        while columns.len() < D {
            let mut v: Vector<f64, D> = self.vector(1.0);
            for _ in 0..2 {
                for c in &columns {
                    v -= c * c.dot(&v);
                }
            }
            if v.norm() > 0.1 {
                columns.push(v / v.norm());
            }
        }
        let mut r = Matrix::<f64, D>::from_columns(&columns);
        if snowlab_solver::math::determinant(&r) < 0.0 {
            r.column_mut(0).neg_mut();
        }
        r.map(T::of)
    }
}

pub fn snow<T: Real>() -> Snow<T> {
    Snow {
        lame: Lame::from_young(YOUNG, POISSON),
        critical_compression: T::of(2.5e-2),
        critical_stretch: T::of(7.5e-3),
        hardening: T::of(10.0),
        plastic_ratio_bounds: (T::zero(), T::of(f64::INFINITY)),
        hardening_limit: T::of(f64::INFINITY),
    }
}

pub fn elastic<T: Real>() -> Elastic<T> {
    Elastic { lame: Lame::from_young(YOUNG, POISSON) }
}

/// S13's scene: cubic kernel, FLIP share 0.95 per step, snow, no gravity, no obstacle.
pub fn scene<T: Real, const D: usize>(spacing: f64) -> Scene<T, D> {
    Scene {
        spacing: T::of(spacing),
        kernel: KernelKind::Cubic,
        transfer: Transfer::Flip(FlipShare::PerStep(0.95)),
        engine: crate::ENGINE,
        integrator: Integrator::Explicit,
        advection: Advection::Interpolated,
        materials: vec![Material::Snow(snow())],
        colliders: Vec::new(),
        gravity: Vector::zeros(),
        time_step: TimeStepControl::default(),
        energy_budget: true,
    }
}

pub fn elastic_scene<T: Real, const D: usize>(spacing: f64) -> Scene<T, D> {
    Scene { materials: vec![Material::Elastic(elastic())], ..scene(spacing) }
}

/// A fixed step without a watchdog.
pub fn fixed(dt: f64) -> TimeStepControl {
    TimeStepControl { length: StepLength::Fixed(dt), watchdog_interval: 0, ..TimeStepControl::default() }
}

pub fn flip(share: f64) -> Transfer {
    Transfer::Flip(FlipShare::PerStep(share))
}

pub fn transfers() -> [Transfer; 5] {
    [flip(0.95), flip(1.0), flip(0.0), Transfer::Apic, Transfer::Mls]
}

pub fn vector<const D: usize>(components: [f64; D]) -> Vector<f64, D> {
    Vector::from_row_slice(&components)
}

pub fn particle<const D: usize>(position: [f64; D], velocity: [f64; D], volume: f64) -> InitialParticle<D> {
    InitialParticle {
        position: vector(position),
        velocity: vector(velocity),
        mass: DENSITY * volume,
        volume,
        stiffness_scale: 1.0,
        material: 0,
        deformation: Matrix::identity(),
        plastic_ratio: 1.0,
    }
}

/// `per_axis`^D particles a cell on a lattice, in the cells `first .. first + cells` of spacing `h`.
pub fn lattice<const D: usize>(
    h: f64,
    first: [i32; D],
    cells: [i32; D],
    per_axis: i32,
    velocity: [f64; D],
) -> Vec<InitialParticle<D>> {
    let counts = cells.map(|c| (c * per_axis) as usize);
    let apart = h / f64::from(per_axis);
    (0..counts.iter().product())
        .map(|index: usize| {
            let mut rest = index;
            let mut position = [0.0; D];
            for axis in (0..D).rev() {
                position[axis] = f64::from(first[axis]) * h + ((rest % counts[axis]) as f64 + 0.5) * apart;
                rest /= counts[axis];
            }
            particle(position, velocity, apart.powi(D as i32))
        })
        .collect()
}

pub fn state<T: Real, const D: usize>(scene: &Scene<T, D>, particles: &[InitialParticle<D>]) -> State<T, D> {
    State::at_rest(scene, Vector::zeros(), particles).expect("a valid scene")
}

pub fn half_space<T: Real, const D: usize>(
    axis: usize,
    sign: f64,
    at: f64,
    contact: Contact,
) -> Collider<T, D> {
    Collider {
        shape: Shape::HalfSpace {
            point: unit::<T, D>(axis) * T::of(at),
            normal: unit::<T, D>(axis) * T::of(sign),
        },
        contact,
        friction: T::zero(),
        velocity: Vector::zeros(),
    }
}

/// A floor below y = `at`.
pub fn floor<T: Real, const D: usize>(at: f64, contact: Contact, friction: f64) -> Collider<T, D> {
    Collider { friction: T::of(friction), ..half_space(1, 1.0, at, contact) }
}

pub fn largest<T: Real, const D: usize>(m: &Matrix<T, D>) -> f64 {
    m.iter().fold(0.0, |largest, e| e.as_f64().abs().max(largest))
}

/// |a - b| <= relative |b|.
#[track_caller]
pub fn assert_near(a: f64, b: f64, relative: f64, what: &str) {
    assert!((a - b).abs() <= relative * b.abs(), "{what}: {a:e} is not {b:e} to {relative:e}");
}
