//! A block on an inclined plane with friction.

use rayon::prelude::*;
use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::geometry::{Shape, Vector};
use snowlab_solver::{KernelKind, Simulation, State, Transfer};

use super::Setting;
use super::chart::{Line, Panel, chart};
use super::evidence::{Check, Evidence, EvidenceFigure};
use super::scenes::{TRANSFERS, body_motion, elastic, lattice, scene, transfer_name};
use crate::figure::axis::Scale;
use crate::table::{Row, Table};

/// Slope of the plane [rad].
const SLOPE: f64 = std::f64::consts::FRAC_PI_6;
/// Coefficients of friction: without, sliding, and above tan(30 degrees) = 0.577, where it holds.
const FRICTIONS: [f64; 4] = [0.0, 0.2, 0.4, 0.8];
/// Width and height of the block [m].
const BLOCK: [f64; 2] = [0.2, 0.1];
/// How long it is watched [s].
const END: f64 = 0.5;
const GRAVITY: f64 = 9.81;

struct Run {
    transfer: Transfer,
    friction: f64,
    /// Cells to the block's height.
    cells: usize,
    /// Time [s] and way of the centre of mass downhill [m].
    way: Vec<(f64, f64)>,
    /// Mean force on the plane over the second half of the time, across and along it, over the weight.
    force: [f64; 2],
}

impl Run {
    fn new(transfer: Transfer, friction: f64, cells: usize) -> anyhow::Result<Self> {
        let h = BLOCK[1] / cells as f64;
        let mut scene = scene::<f64, 2>(h, KernelKind::Cubic, transfer, elastic());
        scene.gravity[1] = -GRAVITY;
        let (sin, cos) = libm::sincos(SLOPE);
        let (normal, downhill) = (Vector::<f64, 2>::new(sin, cos), Vector::<f64, 2>::new(cos, -sin));
        scene.colliders = vec![Collider {
            shape: Shape::HalfSpace { point: Vector::zeros(), normal },
            contact: Contact::Separate,
            friction,
            velocity: Vector::zeros(),
        }];
        let mut bodies = lattice::<2>(h, [2 * cells, cells], 2);
        for body in &mut bodies {
            body.position = downhill * body.position[0] + normal * body.position[1];
        }
        let all = 0..bodies.len() as u32;
        let state = State::at_rest(&scene, Vector::zeros(), &bodies)?;
        let mut simulation = Simulation::new(scene, state)?;
        let start = body_motion(simulation.scene(), simulation.state(), all.clone());
        let (mut way, mut half) = (Vec::new(), Vector::<f64, 2>::zeros());
        for frame in 0..=50 {
            simulation.advance_to(END * f64::from(frame) / 50.0)?;
            let state = simulation.state();
            let now = body_motion(simulation.scene(), state, all.clone());
            way.push((state.time, (now.centre - start.centre).dot(&downhill)));
            if frame == 25 {
                half = state.ledger.colliders[0].impulse;
            }
        }
        let impulse = simulation.state().ledger.colliders[0].impulse - half;
        let weight = start.mass * GRAVITY * 0.5 * END;
        let force = [-impulse.dot(&normal) / weight, impulse.dot(&downhill) / weight];
        Ok(Run { transfer, friction, cells, way, force })
    }

    fn slides(&self) -> bool {
        self.friction < libm::tan(SLOPE)
    }

    /// Way downhill at the end [m].
    fn end(&self) -> f64 {
        self.way[self.way.len() - 1].1
    }

    /// g t^2 / 2 (sin - mu cos), 0 where friction holds [m].
    fn predicted(&self, time: f64) -> f64 {
        let (sin, cos) = libm::sincos(SLOPE);
        0.5 * GRAVITY * time * time * (sin - self.friction * cos).max(0.0)
    }

    /// The force along the plane over the weight: mu cos while it slides, sin where it holds.
    fn predicted_friction(&self) -> f64 {
        let (sin, cos) = libm::sincos(SLOPE);
        sin.min(self.friction * cos)
    }

    fn name(&self, what: &str) -> String {
        format!("{what}, {}, mu = {}, {} cells", transfer_name(self.transfer), self.friction, self.cells)
    }
}

/// Carries it out.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let effort = setting.effort;
    let grids: &[usize] = effort.choose(&[4], &[2, 4, 8, 16]);
    let cases: Vec<_> = TRANSFERS
        .into_iter()
        .flat_map(|transfer| FRICTIONS.into_iter().map(move |friction| (transfer, friction)))
        .flat_map(|(transfer, friction)| grids.iter().map(move |cells| (transfer, friction, *cells)))
        .collect();
    let runs = cases
        .into_par_iter()
        .map(|(transfer, friction, cells)| Run::new(transfer, friction, cells))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let finest: Vec<&Run> = runs.chunks(grids.len()).filter_map(|runs| runs.last()).collect();
    let mut lines: Vec<Line> = finest
        .iter()
        .filter(|run| run.transfer == Transfer::Apic)
        .map(|run| Line::new(format!("mu = {}", run.friction), run.way.iter().copied()))
        .collect();
    let theory = finest.iter().find(|run| run.transfer == Transfer::Apic && run.friction == 0.2);
    lines.extend(
        theory.map(|run| {
            Line::new("0.2, theory", run.way.iter().map(|&(time, _)| (time, run.predicted(time))))
        }),
    );
    let panels = [Panel::new("way downhill [m]", Scale::Linear, lines)];
    Ok(Evidence {
        figures: vec![EvidenceFigure {
            name: "incline",
            caption: "A block on a plane of 30 degrees, apic, on the finest grid.",
            drawing: chart("time [s]", Scale::Linear, "", &panels)?,
        }],
        checks: finest.iter().flat_map(|run| checks(run)).collect(),
        tables: vec![table(&runs)],
    })
}

fn checks(run: &Run) -> [Check; 3] {
    let way = run.predicted(END);
    let (_, cos) = libm::sincos(SLOPE);
    let friction = run.predicted_friction();
    // What the block moves while it settles on the plane: half a cell.
    let settling = 0.5 * BLOCK[1] / run.cells as f64;
    [
        Check {
            quantity: run.name("way downhill [m]"),
            measured: run.end(),
            theory: if run.slides() { format!("g t^2 / 2 (sin - mu cos) = {way:.4}") } else { "0".into() },
            allowed: [0.99 * way - 0.1 * settling, 1.01 * way + 0.1 * settling],
            source: "Coulomb's law; chosen: 1 %, and a twentieth of a cell",
        },
        Check {
            quantity: run.name("force across the plane over the weight"),
            measured: run.force[0],
            theory: format!("cos = {cos:.4}"),
            allowed: [0.98 * cos, 1.02 * cos],
            source: "balance of forces; chosen: 2 %, for the block swings on the plane",
        },
        Check {
            quantity: run.name("force along the plane over the weight"),
            measured: run.force[1],
            theory: format!("min(mu cos, sin) = {friction:.4}"),
            allowed: [0.98 * friction - 1e-9, 1.02 * friction + 1e-9],
            source: "Coulomb's law; chosen: 2 %, for the block swings on the plane",
        },
    ]
}

fn table(runs: &[Run]) -> Table {
    let row = |run: &Run| {
        let mut row = Row::default();
        row.put("transfer", "-", "velocity transfer", transfer_name(run.transfer))
            .number("friction", "-", "Coulomb coefficient mu", run.friction)
            .count("cells", "cells to the block's height", run.cells as u64)
            .number("way", "m", "way downhill after 0.5 s", run.end())
            .number("way_predicted", "m", "g t^2 / 2 (sin - mu cos), or 0", run.predicted(END))
            .number("force_across", "-", "mean force across the plane over the weight", run.force[0])
            .number("force_along", "-", "mean force along the plane over the weight", run.force[1])
            .number("force_along_predicted", "-", "min(mu cos, sin)", run.predicted_friction());
        row
    };
    Table { name: "incline", rows: runs.iter().map(row).collect() }
}
