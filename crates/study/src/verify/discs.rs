//! Two elastic discs that meet head on (Sulsky, Chen & Schreyer 1994, section 4.1).

use rayon::prelude::*;
use snowlab_solver::diagnostics::energies;
use snowlab_solver::geometry::Vector;
use snowlab_solver::{KernelKind, Simulation, State, Transfer};

use super::Setting;
use super::chart::{Line, Panel, chart};
use super::evidence::{Check, Evidence, EvidenceFigure};
use super::scenes::{TRANSFERS, body_motion, disc, elastic, observed_order, scene, transfer_name};
use crate::figure::axis::Scale;
use crate::table::{Row, Table};

/// Radius [m].
const RADIUS: f64 = 0.1;
/// Distance between the discs at the start [m].
const GAP: f64 = 0.06;
/// Speed of each [m/s], a twentieth of that of waves.
const SPEED: f64 = 1.0;
/// End [s]: the discs have parted.
const END: f64 = 0.15;

struct Run {
    transfer: Transfer,
    /// Cells to a radius.
    cells: usize,
    /// Time [ms], velocity of the right disc [m/s], and energies of both [J/m]: kinetic, elastic, lost in transfers.
    history: Vec<[f64; 5]>,
    /// Largest momentum of both over that of one at the start.
    momentum: f64,
}

impl Run {
    fn new(transfer: Transfer, cells: usize) -> anyhow::Result<Self> {
        let h = RADIUS / cells as f64;
        let scene = scene::<f64, 2>(h, KernelKind::Cubic, transfer, elastic());
        let centre = Vector::<f64, 2>::new(RADIUS + 0.5 * GAP, 0.0);
        let velocity = Vector::<f64, 2>::new(-SPEED, 0.0);
        let right = disc(h, centre, RADIUS, velocity);
        let each = right.len() as u32;
        let bodies = [right, disc(h, -centre, RADIUS, -velocity)].concat();
        let state = State::at_rest(&scene, Vector::zeros(), &bodies)?;
        let mut simulation = Simulation::new(scene, state)?;
        let mut run = Run { transfer, cells, history: Vec::new(), momentum: 0.0 };
        for frame in 0..=300 {
            simulation.advance_to(END * f64::from(frame) / 300.0)?;
            let (scene, state) = (simulation.scene(), simulation.state());
            let (right, left) =
                (body_motion(scene, state, 0..each), body_motion(scene, state, each..2 * each));
            let sum = (right.velocity + left.velocity).norm() / SPEED;
            run.momentum = run.momentum.max(sum);
            let energies = energies(scene, state);
            let ledger = &state.ledger;
            run.history.push([
                1e3 * state.time,
                right.velocity[0],
                energies.kinetic,
                energies.elastic,
                ledger.particles_to_grid_loss + ledger.grid_to_particles_loss,
            ]);
        }
        Ok(run)
    }

    fn first(&self) -> &[f64; 5] {
        &self.history[0]
    }

    fn last(&self) -> &[f64; 5] {
        &self.history[self.history.len() - 1]
    }

    /// Speed apart over speed together.
    fn restitution(&self) -> f64 {
        self.last()[1] / SPEED
    }

    /// Energy at the end, kinetic and elastic, over that at the start.
    fn kept(&self) -> f64 {
        (self.last()[2] + self.last()[3]) / self.first()[2]
    }

    /// What the ledger cannot account for, over the energy at the start.
    fn residual(&self) -> f64 {
        self.kept() + self.last()[4] / self.first()[2] - 1.0
    }

    /// By how many cells apart the discs felt each other: their distance when they had lost 1 % of their speed.
    fn reach(&self) -> f64 {
        let felt = self.history.iter().find(|row| row[1] > -0.99 * SPEED);
        let time = felt.map_or(END, |row| 1e-3 * row[0]);
        (GAP - 2.0 * SPEED * time) / (RADIUS / self.cells as f64)
    }
}

/// Carries it out.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let effort = setting.effort;
    let grids: &[usize] = effort.choose(&[5, 10], &[5, 10, 20, 40]);
    let cases: Vec<_> = TRANSFERS
        .into_iter()
        .flat_map(|transfer| grids.iter().map(move |cells| (transfer, *cells)))
        .collect();
    let runs = cases
        .into_par_iter()
        .map(|(transfer, cells)| Run::new(transfer, cells))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let finest: Vec<&Run> = runs.chunks(grids.len()).filter_map(|runs| runs.last()).collect();
    let line = |value: &dyn Fn(&[f64; 5]) -> f64| -> Vec<Line> {
        let points = |run: &&Run| run.history.iter().map(|row| (row[0], value(row))).collect::<Vec<_>>();
        finest.iter().map(|run| Line::new(transfer_name(run.transfer), points(run))).collect()
    };
    let panels = [
        Panel::new("velocity [m/s]", Scale::Linear, line(&|row| row[1])),
        Panel::new("kinetic energy [J/m]", Scale::Linear, line(&|row| row[2])),
        Panel::new("elastic energy [J/m]", Scale::Linear, line(&|row| row[3])),
    ];
    Ok(Evidence {
        figures: vec![EvidenceFigure {
            name: "discs",
            caption: "Two elastic discs that meet: velocity of the right one, energies of both, on the finest grid.",
            drawing: chart("time [ms]", Scale::Linear, "", &panels)?,
        }],
        checks: runs.iter().flat_map(checks).chain(runs.chunks(grids.len()).map(order)).collect(),
        tables: vec![table(&runs)],
    })
}

fn checks(run: &Run) -> [Check; 3] {
    let name = |what: &str| format!("{what}, {}, {} cells", transfer_name(run.transfer), run.cells);
    [
        Check {
            quantity: name("momentum of both discs over that of one"),
            measured: run.momentum,
            theory: "0".into(),
            allowed: [0.0, 1e-10],
            source: "conservation of momentum, to round-off",
        },
        Check {
            quantity: name("restitution"),
            measured: run.restitution(),
            theory: "1 less what vibrates on".into(),
            allowed: [0.8, 1.0],
            source: "conservation of energy bounds it by 1; chosen: slow discs vibrate little",
        },
        Check {
            quantity: name("cells apart when the discs feel each other"),
            measured: run.reach(),
            theory: "at most 4".into(),
            allowed: [0.0, 4.0],
            source: "particles less than two kernel radii, 4 h, apart share nodes",
        },
    ]
}

/// What is not accounted for falls with the step, which goes with h.
fn order(runs: &[Run]) -> Check {
    let points: Vec<(f64, f64)> =
        runs.iter().map(|run| (1.0 / run.cells as f64, run.residual().abs())).collect();
    Check {
        quantity: format!("order in dt of the energy not accounted for, {}", transfer_name(runs[0].transfer)),
        measured: observed_order(&points),
        theory: "1".into(),
        allowed: [0.7, 1.6],
        source: "symplectic Euler is first order in energy; chosen: upwards more, for contact sharpens with h",
    }
}

fn table(runs: &[Run]) -> Table {
    let row = |run: &Run| {
        let mut row = Row::default();
        row.put("transfer", "-", "velocity transfer", transfer_name(run.transfer))
            .count("cells", "cells to a radius", run.cells as u64)
            .number("momentum", "-", "largest momentum of both over that of one at the start", run.momentum)
            .number("restitution", "-", "speed apart over speed together", run.restitution())
            .number("energy", "-", "energy at the end over that at the start", run.kept())
            .number(
                "transfer_loss",
                "-",
                "lost in transfers, over the start's",
                run.last()[4] / run.first()[2],
            )
            .number("residual", "-", "not accounted for, over the start's", run.residual())
            .number("reach", "-", "cells apart when 1 % of the speed is lost", run.reach());
        row
    };
    Table { name: "discs", rows: runs.iter().map(row).collect() }
}
