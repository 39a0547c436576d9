//! Two engines, one step: the fast engine beside the plain definition, through the same impact.

use snowlab_solver::geometry::{Matrix, Vector};
use snowlab_solver::{
    Contact, Engine, InitialParticle, KernelKind, Real, Scene, Simulation, State, Transfer,
};

use super::Setting;
use super::evidence::{Check, Evidence};
use super::scenes::{KERNELS, TRANSFERS, kernel_name, lattice, scene, snow, transfer_name, wall};
use crate::table::{Row, Table};

/// Steps through the impact (chosen: the front has then gone half through the ball, and particles have yielded in every combination, as the table shows).
const STEPS: usize = 60;
/// Grid spacing [m].
const SPACING: f64 = 0.0125;
/// Radius of the ball in cells.
const RADIUS: usize = 6;
/// Its speed towards the floor [m/s].
const SPEED: f64 = 8.0;

/// How far the engines are apart.
struct Apart {
    dimension: usize,
    precision: &'static str,
    kernel: KernelKind,
    transfer: Transfer,
    particles: usize,
    yielded: f64,
    /// Largest distance of a particle from itself [cells].
    cells: f64,
    /// Largest difference of J_P.
    ratio: f64,
}

/// A ball on a turned lattice, half a cell above the floor.
fn ball<const D: usize>() -> Vec<InitialParticle<D>> {
    let radius = RADIUS as f64 * SPACING;
    let middle = Vector::<f64, D>::repeat(radius + SPACING);
    // chosen: an angle that lines up no row of particles with the grid.
    let (sin, cos) = libm::sincos(0.47);
    let mut turn = Matrix::<f64, D>::identity();
    (turn[(0, 0)], turn[(0, 1)], turn[(1, 0)], turn[(1, 1)]) = (cos, -sin, sin, cos);
    let mut lift = Vector::<f64, D>::zeros();
    lift[1] = radius + 0.5 * SPACING;
    lattice::<D>(SPACING, [2 * RADIUS + 2; D], 2)
        .into_iter()
        .filter(|body| (body.position - middle).norm() < radius)
        .map(|mut body| {
            body.position = turn * (body.position - middle) + lift;
            body.velocity[1] = -SPEED;
            body
        })
        .collect()
}

fn end<T: Real, const D: usize>(scene: &Scene<T, D>, engine: Engine) -> anyhow::Result<State<T, D>> {
    let scene = Scene { engine, ..scene.clone() };
    let state = State::at_rest(&scene, Vector::zeros(), &ball::<D>())?;
    let mut simulation = Simulation::with_threads(scene, state, 2)?;
    for _ in 0..STEPS {
        simulation.advance_one(f64::INFINITY)?;
    }
    Ok(simulation.state().clone())
}

fn apart<T: Real, const D: usize>(precision: &'static str) -> anyhow::Result<Vec<Apart>> {
    let mut rows = Vec::new();
    for kernel in KERNELS {
        for transfer in TRANSFERS {
            let mut scene = scene::<T, D>(SPACING, kernel, transfer, snow());
            scene.colliders = vec![wall(1, 1.0, 0.0, Contact::Separate)];
            scene.colliders[0].friction = T::of(0.5);
            let [plain, fast] = [end(&scene, Engine::Reference)?, end(&scene, Engine::Fast)?];
            let (mut cells, mut ratio, mut yielded) = (0.0_f64, 0.0_f64, 0);
            for (p, q) in plain.by_id().into_iter().zip(fast.by_id()) {
                let away = (plain.world_position(p) - fast.world_position(q)).norm() / SPACING;
                let [a, b] = [plain.motion.plastic_ratio[p], fast.motion.plastic_ratio[q]].map(T::as_f64);
                (cells, ratio) = (cells.max(away), ratio.max((a - b).abs()));
                yielded += usize::from(a != 1.0);
            }
            let yielded = yielded as f64 / plain.len() as f64;
            rows.push(Apart {
                dimension: D,
                precision,
                kernel,
                transfer,
                particles: plain.len(),
                yielded,
                cells,
                ratio,
            });
        }
    }
    Ok(rows)
}

/// Carries it out.
pub fn run(_: &Setting) -> anyhow::Result<Evidence> {
    let mut rows = apart::<f64, 2>("f64")?;
    rows.extend(apart::<f64, 3>("f64")?);
    rows.extend(apart::<f32, 2>("f32")?);
    rows.extend(apart::<f32, 3>("f32")?);
    let largest = |precision: &str| {
        rows.iter().filter(|row| row.precision == precision).fold(0.0_f64, |most, row| most.max(row.cells))
    };
    let check = |precision: &str, bound: f64, source: &'static str| Check {
        quantity: format!(
            "largest distance between the engines after {STEPS} steps of an impact, {precision} [cells]"
        ),
        measured: largest(precision),
        theory: "round-off".into(),
        allowed: [0.0, bound],
        source,
    };
    let mut checks = vec![
        check("f64", 1e-8, "chosen: far below any error of the method"),
        check("f32", 2e-5, "chosen: far below any error of the method"),
    ];
    if Engine::Fast.is_available() {
        checks.push(Check {
            quantity: "the two are not one engine: their least distance, f64 [cells]".into(),
            measured: rows
                .iter()
                .filter(|row| row.precision == "f64")
                .fold(f64::INFINITY, |l, row| l.min(row.cells)),
            theory: "above 0".into(),
            allowed: [f64::MIN_POSITIVE, 1e-8],
            source: "sums are taken in other orders",
        });
    }
    Ok(Evidence { tables: vec![table(&rows)], figures: Vec::new(), checks })
}

fn table(rows: &[Apart]) -> Table {
    let row = |apart: &Apart| {
        let mut row = Row::default();
        row.count("dimension", "dimension", apart.dimension as u64)
            .put("precision", "-", "floating point type", apart.precision)
            .put("kernel", "-", "kernel", kernel_name(apart.kernel))
            .put("transfer", "-", "transfer", transfer_name(apart.transfer))
            .count("particles", "particles", apart.particles as u64)
            .number("yielded", "-", "share of the particles that have yielded", apart.yielded)
            .number("cells", "cells", "largest distance of a particle between the engines", apart.cells)
            .number("plastic_ratio", "-", "largest difference of J_P between the engines", apart.ratio);
        row
    };
    Table { name: "engines", rows: rows.iter().map(row).collect() }
}
