//! What is measured: the cases that have goals, and a sweep over the number of particles.

use snowlab_solver::{FlipShare, KernelKind, Transfer};

use crate::ball::{Ball, PARTICLES_A_CELL, RADIUS, SPEED};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Precision {
    F32,
    F64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// Free fall: no particle yields.
    Falling,
    /// Squashed on the floor: most particles yield in every step.
    Impact,
}

/// How a row differs from the default.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Variant {
    Plain,
    /// With the energy lost in transfers and contacts booked in every step.
    Budget,
    /// By AVX2 on a CPU that has AVX-512.
    Avx2,
}

/// How large, and how long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Size {
    /// 100 thousand particles in 3D.
    Quick,
    /// A million particles in 3D.
    Full,
    /// The first row from 10 thousand to 4 million particles.
    Sweep,
    /// All rows with few particles, once: to see that they run.
    Tried,
}

/// Million particle-steps per second on two threads. Chosen: what a prototype reached on two cores of a server with AVX-512, and what seemed in
/// reach beyond.
#[derive(Clone, Copy, Debug)]
pub struct Goal {
    pub goal: f64,
    pub stretch: f64,
}

#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub dimension: usize,
    pub precision: Precision,
    pub kernel: KernelKind,
    pub transfer: Transfer,
    pub phase: Phase,
    pub variant: Variant,
    pub particles: usize,
    pub goal: Option<Goal>,
}

use Phase::{Falling, Impact};
use Precision::{F32, F64};

impl Size {
    pub fn rows(self) -> Vec<Row> {
        match self {
            Size::Quick => goal_rows(100_000),
            Size::Full => goal_rows(1_000_000),
            Size::Sweep => [10_000, 30_000, 100_000, 300_000, 1_000_000, 4_000_000]
                .map(|particles| row(3, F32, Transfer::Mls, Falling, particles))
                .to_vec(),
            Size::Tried => goal_rows(3000).into_iter().map(|row| Row { particles: 3000, ..row }).collect(),
        }
    }
}

impl Row {
    /// "3D cubic f32 MLS falling", and the variant.
    pub fn name(&self) -> String {
        let kernel = format!("{:?}", self.kernel).to_lowercase();
        let precision = format!("{:?}", self.precision).to_lowercase();
        let transfer = match self.transfer {
            Transfer::Flip(_) => "FLIP",
            Transfer::Apic => "APIC",
            Transfer::Mls => "MLS",
        };
        let phase = format!("{:?}", self.phase).to_lowercase();
        let variant = match self.variant {
            Variant::Plain => "",
            Variant::Budget => " budget",
            Variant::Avx2 => " avx2",
        };
        format!("{}D {kernel} {precision} {transfer} {phase}{variant}", self.dimension)
    }

    /// [`Row::name`] and the number of particles.
    pub fn label(&self) -> String {
        format!("{} {}k", self.name(), self.particles / 1000)
    }

    /// Whether the label has all of these words.
    pub fn has(&self, words: &[String]) -> bool {
        words.iter().all(|word| self.label().split(' ').any(|part| part == word))
    }

    /// The body at t = 0.
    pub fn ball(&self) -> Ball {
        Ball {
            kernel: self.kernel,
            transfer: self.transfer,
            particles: self.particles,
            gap: if self.phase == Falling { 1e3 } else { 0.0 },
            squashed: self.phase == Impact,
            energy_budget: self.variant == Variant::Budget,
            per_cell: PARTICLES_A_CELL,
        }
    }

    /// When measuring begins [s]: free fall is alike from the first steps on; the squashed ball yields from a strain of (S13's) 2.5 % on,
    /// and has twice that when it has moved by a twentieth of its radius.
    pub fn lead(&self) -> f64 {
        if self.phase == Falling { 0.0 } else { 0.05 * RADIUS / SPEED }
    }
}

fn row(dimension: usize, precision: Precision, transfer: Transfer, phase: Phase, particles: usize) -> Row {
    let (kernel, variant, goal) = (KernelKind::Cubic, Variant::Plain, None);
    Row { dimension, precision, kernel, transfer, phase, variant, particles, goal }
}

/// `n` particles in 3D.
fn goal_rows(n: usize) -> Vec<Row> {
    use Transfer::{Apic, Mls};
    let flip = Transfer::Flip(FlipShare::PerStep(0.95));
    let with = |goal, stretch, row| Row { goal: Some(Goal { goal, stretch }), ..row };
    let quadratic = Row { kernel: KernelKind::Quadratic, ..row(3, F32, Mls, Falling, n) };
    let narrow = Row { variant: Variant::Avx2, ..row(3, F32, Mls, Falling, n) };
    vec![
        with(20.0, 30.0, row(3, F32, Mls, Falling, n)),
        with(14.0, 20.0, row(3, F32, Mls, Impact, n)),
        with(15.0, 22.0, row(3, F32, flip, Falling, n)),
        with(10.0, 14.0, row(3, F64, Mls, Falling, n)),
        with(25.0, 35.0, quadratic),
        with(45.0, 70.0, row(2, F32, Mls, Falling, 30_000)),
        with(35.0, 60.0, row(2, F32, Mls, Falling, 300_000)),
        with(32.0, 45.0, row(2, F32, flip, Falling, 30_000)),
        with(18.0, 25.0, row(2, F64, flip, Falling, 30_000)),
        row(3, F32, Apic, Falling, n),
        with(12.0, 18.0, narrow),
        Row { variant: Variant::Budget, ..row(3, F32, Mls, Falling, n) },
    ]
}
