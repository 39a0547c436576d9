//! Two elastic discs that meet head on (Sulsky, Chen & Schreyer 1994, section 4.1).

use rayon::prelude::*;
use snowlab_solver::diagnostics::energies;
use snowlab_solver::geometry::Vector;
use snowlab_solver::timestep::step_length;
use snowlab_solver::{KernelKind, Simulation, State, StepLength, Transfer};

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

/// Cells to a radius where the step alone is refined.
const REFINED: usize = 10;

struct Run {
    transfer: Transfer,
    /// Cells to a radius.
    cells: usize,
    /// Step over the default.
    step: f64,
    history: Vec<Moment>,
    /// Largest momentum of both over that of one at the start.
    momentum: f64,
}

/// The discs at one time.
struct Moment {
    /// [s].
    time: f64,
    /// Of the right disc [m/s].
    velocity: f64,
    /// Of both discs [J/m].
    kinetic: f64,
    elastic: f64,
    /// Lost in transfers so far [J/m].
    lost: f64,
}

impl Run {
    fn new(transfer: Transfer, cells: usize, step: f64) -> anyhow::Result<Self> {
        let h = RADIUS / cells as f64;
        let mut scene = scene::<f64, 2>(h, KernelKind::Cubic, transfer, elastic());
        let centre = Vector::<f64, 2>::new(RADIUS + 0.5 * GAP, 0.0);
        let velocity = Vector::<f64, 2>::new(-SPEED, 0.0);
        let right = disc(h, centre, RADIUS, velocity);
        let each = right.len() as u32;
        let bodies = [right, disc(h, -centre, RADIUS, -velocity)].concat();
        let state = State::at_rest(&scene, Vector::zeros(), &bodies)?;
        scene.time_step.length = StepLength::Fixed(step * step_length(&scene, &state));
        let mut simulation = Simulation::new(scene, state)?;
        let mut run = Run { transfer, cells, step, history: Vec::new(), momentum: 0.0 };
        loop {
            let (scene, state) = (simulation.scene(), simulation.state());
            let (right, left) =
                (body_motion(scene, state, 0..each), body_motion(scene, state, each..2 * each));
            run.momentum = run.momentum.max((right.velocity + left.velocity).norm() / SPEED);
            let energies = energies(scene, state);
            run.history.push(Moment {
                time: state.time,
                velocity: right.velocity[0],
                kinetic: energies.kinetic,
                elastic: energies.elastic,
                lost: state.ledger.particles_to_grid_loss + state.ledger.grid_to_particles_loss,
            });
            if state.time >= END {
                return Ok(run);
            }
            simulation.advance_one(END)?;
        }
    }

    fn first(&self) -> &Moment {
        &self.history[0]
    }

    fn last(&self) -> &Moment {
        &self.history[self.history.len() - 1]
    }

    /// Speed apart over speed together.
    fn restitution(&self) -> f64 {
        self.last().velocity / SPEED
    }

    /// Energy at the end, kinetic and elastic, over that at the start.
    fn kept(&self) -> f64 {
        (self.last().kinetic + self.last().elastic) / self.first().kinetic
    }

    /// Lost in transfers, over the energy at the start.
    fn lost(&self) -> f64 {
        self.last().lost / self.first().kinetic
    }

    /// What the ledger cannot account for, over the energy at the start.
    fn residual(&self) -> f64 {
        self.kept() + self.lost() - 1.0
    }

    /// When the right disc's velocity first exceeds a value, between steps by a straight line [s].
    fn reaches(&self, velocity: f64) -> f64 {
        let passed = self.history.windows(2).find(|pair| pair[1].velocity > velocity);
        passed.map_or(END, |pair| {
            let share = (velocity - pair[0].velocity) / (pair[1].velocity - pair[0].velocity);
            pair[0].time + share * (pair[1].time - pair[0].time)
        })
    }

    /// By how many cells apart the discs felt each other: their distance when they had lost 1 % of their speed.
    fn reach(&self) -> f64 {
        (GAP - 2.0 * SPEED * self.reaches(-0.99 * SPEED)) / (RADIUS / self.cells as f64)
    }

    /// From 1 % of the change of velocity to 99 % [s].
    fn contact_time(&self) -> f64 {
        let change = self.last().velocity + SPEED;
        self.reaches(-SPEED + 0.99 * change) - self.reaches(-SPEED + 0.01 * change)
    }
}

/// Carries it out.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let effort = setting.effort;
    let grids: &[usize] = effort.choose(&[5, REFINED], &[5, REFINED, 20, 40]);
    let steps = [1.0, 0.5, 0.25];
    let settings: Vec<(usize, f64)> = grids
        .iter()
        .map(|&cells| (cells, 1.0))
        .chain(steps[1..].iter().map(|&step| (REFINED, step)))
        .collect();
    let cases: Vec<_> = TRANSFERS
        .into_iter()
        .flat_map(|transfer| settings.iter().map(move |setting| (transfer, *setting)))
        .collect();
    let runs = cases
        .into_par_iter()
        .map(|(transfer, (cells, step))| Run::new(transfer, cells, step))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let finest: Vec<&Run> = runs.chunks(settings.len()).map(|runs| &runs[grids.len() - 1]).collect();
    let line = |value: &dyn Fn(&Moment) -> f64| -> Vec<Line> {
        let points = |run: &&Run| {
            run.history.iter().map(|moment| (1e3 * moment.time, value(moment))).collect::<Vec<_>>()
        };
        finest.iter().map(|run| Line::new(transfer_name(run.transfer), points(run))).collect()
    };
    let panels = [
        Panel::new("velocity [m/s]", Scale::Linear, line(&|moment| moment.velocity)),
        Panel::new("kinetic energy [J/m]", Scale::Linear, line(&|moment| moment.kinetic)),
        Panel::new("elastic energy [J/m]", Scale::Linear, line(&|moment| moment.elastic)),
    ];
    Ok(Evidence {
        figures: vec![EvidenceFigure {
            name: "discs",
            caption: "Two elastic discs that meet: velocity of the right one, energies of both, on the finest grid.",
            drawing: chart("time [ms]", Scale::Linear, "", &panels)?,
        }],
        checks: runs.iter().flat_map(checks).chain(runs.chunks(settings.len()).map(order)).collect(),
        tables: vec![table(&runs)],
    })
}

fn checks(run: &Run) -> [Check; 3] {
    let name = |what: &str| {
        format!(
            "{what}, {}, {} cells, {} of the default step",
            transfer_name(run.transfer),
            run.cells,
            run.step
        )
    };
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
            theory: "at most 1".into(),
            allowed: [0.0, 1.0],
            source: "conservation of energy",
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

/// What is not accounted for falls with h at the default step. It does not fall with the step alone: a finding.
fn order(runs: &[Run]) -> Check {
    let refined = runs.iter().filter(|run| run.step == 1.0);
    let points: Vec<(f64, f64)> = refined.map(|run| (1.0 / run.cells as f64, run.residual().abs())).collect();
    Check {
        quantity: format!(
            "order in h, at the default step, of the energy not accounted for, {}",
            transfer_name(runs[0].transfer)
        ),
        measured: observed_order(&points),
        theory: "1".into(),
        allowed: [0.7, 1.6],
        source: "symplectic Euler is first order in energy; chosen: upwards more, for losses in transfers fall too",
    }
}

fn table(runs: &[Run]) -> Table {
    let row = |run: &Run| {
        let mut row = Row::default();
        row.put("transfer", "-", "velocity transfer", transfer_name(run.transfer))
            .count("cells", "cells to a radius", run.cells as u64)
            .number("step", "-", "step over the default", run.step)
            .number("momentum", "-", "largest momentum of both over that of one at the start", run.momentum)
            .number("restitution", "-", "speed apart over speed together", run.restitution())
            .number("energy", "-", "energy at the end over that at the start", run.kept())
            .number("transfer_loss", "-", "lost in transfers, over the start's", run.lost())
            .number("residual", "-", "not accounted for, over the start's", run.residual())
            .number("reach", "-", "cells apart when 1 % of the speed is lost", run.reach())
            .number("contact_time", "s", "from 1 % of the change of velocity to 99 %", run.contact_time());
        row
    };
    Table { name: "discs", rows: runs.iter().map(row).collect() }
}
