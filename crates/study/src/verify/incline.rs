//! A block on an inclined plane with friction.

use rayon::prelude::*;
use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::geometry::{Shape, Vector};
use snowlab_solver::{KernelKind, Simulation, State, Transfer};

use super::Setting;
use super::chart::{Line, Panel, chart};
use super::evidence::{Check, Evidence, EvidenceFigure};
use super::scenes::{GRAVITY, TRANSFERS, body_motion, elastic, lattice, scene, transfer_name};
use crate::figure::axis::Scale;
use crate::table::{Row, Table};

/// Slope of the plane [rad].
const SLOPE: f64 = std::f64::consts::FRAC_PI_6;
/// Coefficients of friction: below tan(30 degrees) = 0.577 the block gets faster, above slower; with 1.2 friction stops it.
const FRICTIONS: [f64; 5] = [0.0, 0.2, 0.4, 0.8, 1.2];
/// Speed downhill at the start [m/s]: from rest the block would swing against its own base.
const SPEED: f64 = 1.0;
/// Width and height of the block [m]: friction up to mu = 4/3 leaves the load within the middle third of the base, which then does not lift.
const BLOCK: [f64; 2] = [0.4, 0.1];
/// How long it is watched [s].
const END: f64 = 0.5;
/// Stiffness over that of snow: nearly rigid, as the formula has it.
const STIFFNESS: f64 = 400.0;
/// Softer blocks, to show what that does, with apic and the greatest friction.
const SOFTER: [f64; 3] = [1.0, 10.0, 100.0];

/// What is run.
#[derive(Clone, Copy)]
struct Block {
    transfer: Transfer,
    friction: f64,
    /// Cells to the block's height.
    cells: usize,
    /// Over that of snow.
    stiffness: f64,
}

struct Run {
    block: Block,
    /// Time [s] and way of the centre of mass downhill [m].
    way: Vec<(f64, f64)>,
    /// Mean force on the plane over the second half of the time, across and along it, over the weight.
    force: [f64; 2],
}

impl Run {
    fn new(block: Block) -> anyhow::Result<Self> {
        let Block { transfer, friction, cells, stiffness } = block;
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
        let mut bodies = lattice::<2>(h, [4 * cells, cells], 2);
        for body in &mut bodies {
            body.position = downhill * body.position[0] + normal * body.position[1];
            body.velocity = downhill * SPEED;
            body.stiffness_scale = stiffness;
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
        Ok(Run { block, way, force })
    }

    /// Way downhill at the end [m].
    fn end(&self) -> f64 {
        self.way[self.way.len() - 1].1
    }

    /// g (sin - mu cos) [m/s^2], the acceleration while it slides.
    fn acceleration(&self) -> f64 {
        let (sin, cos) = libm::sincos(SLOPE);
        GRAVITY * (sin - self.block.friction * cos)
    }

    /// When friction has stopped it [s].
    fn stop(&self) -> f64 {
        let a = self.acceleration();
        if a < 0.0 { -SPEED / a } else { f64::INFINITY }
    }

    /// v t + g t^2 / 2 (sin - mu cos), until it stops [m].
    fn predicted(&self, time: f64) -> f64 {
        let time = time.min(self.stop());
        SPEED * time + 0.5 * self.acceleration() * time * time
    }

    /// The force along the plane over the weight in the second half of the time: mu cos while it slides, sin once it stands.
    fn predicted_friction(&self) -> f64 {
        let (sin, cos) = libm::sincos(SLOPE);
        if self.stop() < 0.5 * END { sin } else { self.block.friction * cos }
    }

    fn name(&self, what: &str) -> String {
        let Block { transfer, friction, cells, .. } = self.block;
        format!("{what}, {}, mu = {friction}, {cells} cells", transfer_name(transfer))
    }
}

/// Carries it out.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let effort = setting.effort;
    let grids: &[usize] = effort.choose(&[2], &[2, 4, 8]);
    let cases: Vec<_> = TRANSFERS
        .into_iter()
        .flat_map(|transfer| FRICTIONS.map(|friction| (transfer, friction)))
        .flat_map(|(transfer, friction)| {
            grids.iter().map(move |&cells| Block { transfer, friction, cells, stiffness: STIFFNESS })
        })
        .collect();
    let soft =
        |stiffness| Block { transfer: Transfer::Apic, friction: FRICTIONS[4], cells: grids[0], stiffness };
    let all = cases.iter().copied().chain(SOFTER.map(soft)).collect::<Vec<_>>();
    let runs = all.into_par_iter().map(Run::new).collect::<anyhow::Result<Vec<_>>>()?;
    let finest: Vec<&Run> = runs[..cases.len()].chunks(grids.len()).filter_map(|runs| runs.last()).collect();
    let lines = |way: fn(&Run, f64, f64) -> f64| -> Vec<Line> {
        let shown = finest.iter().filter(|run| run.block.transfer == Transfer::Apic);
        let line = |run: &&Run| {
            let points = run.way.iter().map(|(time, measured)| (*time, way(run, *time, *measured)));
            Line::new(format!("mu = {}", run.block.friction), points.collect::<Vec<_>>())
        };
        shown.map(line).collect()
    };
    let panels = [Panel {
        theory: lines(|run, time, _| run.predicted(time)),
        ..Panel::new("way downhill [m]", Scale::Linear, lines(|_, _, measured| measured))
    }];
    Ok(Evidence {
        figures: vec![EvidenceFigure {
            name: "incline",
            caption: "A block on a plane of 30 degrees, apic, on the finest grid; dashed: Coulomb's law.",
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
    [
        Check {
            quantity: run.name("way downhill [m]"),
            measured: run.end(),
            theory: format!("v t + g t^2 / 2 (sin - mu cos) = {way:.4}"),
            allowed: [0.99 * way, 1.01 * way],
            source: "Coulomb's law; chosen: 1 %",
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
            theory: format!("mu cos, sin where it stands: {friction:.4}"),
            allowed: [0.98 * friction - 1e-9, 1.02 * friction + 1e-9],
            source: "Coulomb's law; chosen: 2 %, for the block swings on the plane",
        },
    ]
}

fn table(runs: &[Run]) -> Table {
    let row = |run: &Run| {
        let mut row = Row::default();
        row.put("transfer", "-", "velocity transfer", transfer_name(run.block.transfer))
            .number("friction", "-", "Coulomb coefficient mu", run.block.friction)
            .count("cells", "cells to the block's height", run.block.cells as u64)
            .number("stiffness", "-", "stiffness over that of snow", run.block.stiffness)
            .number("stop", "s", "when friction stops it, by Coulomb's law; empty: never", run.stop())
            .number("way", "m", "way downhill after 0.5 s", run.end())
            .number(
                "way_predicted",
                "m",
                "v t + g t^2 / 2 (sin - mu cos), until it stops",
                run.predicted(END),
            )
            .number("force_across", "-", "mean force across the plane over the weight", run.force[0])
            .number("force_across_predicted", "-", "cos", libm::cos(SLOPE))
            .number("force_along", "-", "mean force along the plane over the weight", run.force[1])
            .number(
                "force_along_predicted",
                "-",
                "mu cos while it slides, sin where it stands",
                run.predicted_friction(),
            );
        row
    };
    Table { name: "incline", rows: runs.iter().map(row).collect() }
}
