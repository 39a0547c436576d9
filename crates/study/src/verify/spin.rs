//! An elastic block that spins freely.

use rayon::prelude::*;
use snowlab_solver::diagnostics::energies;
use snowlab_solver::geometry::Vector;
use snowlab_solver::{FlipShare, KernelKind, Simulation, State, Transfer};

use super::Setting;
use super::chart::{Line, Panel, chart};
use super::evidence::{Check, Evidence, EvidenceFigure};
use super::scenes::{body_motion, elastic, lattice, scene, transfer_name};
use crate::figure::axis::Scale;
use crate::table::{Row, Table};

/// Side of the block [m].
const SIDE: f64 = 0.2;
/// Angular velocity at the start [1/s]: the corners move at a tenth of the speed of waves, and stretch by 0.5 %.
const SPIN: f64 = 14.0;

/// FLIP with and without its share of PIC beside the affine transfers.
const TRANSFERS: [(&str, Transfer); 4] = [
    ("flip 0.95", Transfer::Flip(FlipShare::PerStep(0.95))),
    ("flip 1", Transfer::Flip(FlipShare::PerStep(1.0))),
    ("apic", Transfer::Apic),
    ("mls", Transfer::Mls),
];

struct Run {
    name: &'static str,
    transfer: Transfer,
    /// Cells to a side.
    cells: usize,
    /// Turns, angular momentum, and energy, kinetic and elastic, the latter two over those at the start.
    history: Vec<[f64; 3]>,
}

impl Run {
    fn new(name: &'static str, transfer: Transfer, cells: usize, turns: f64) -> anyhow::Result<Self> {
        let h = SIDE / cells as f64;
        let scene = scene::<f64, 2>(h, KernelKind::Cubic, transfer, elastic());
        let mut bodies = lattice::<2>(h, [cells; 2], 2);
        for body in &mut bodies {
            // Off the grid's rows, so that no symmetry of the grid helps.
            body.position += Vector::<f64, 2>::new(0.3 * h, 0.2 * h).add_scalar(-0.5 * SIDE);
        }
        let all = 0..bodies.len() as u32;
        let centre = bodies.iter().fold(Vector::<f64, 2>::zeros(), |sum, body| sum + body.position)
            / bodies.len() as f64;
        for body in &mut bodies {
            let arm = body.position - centre;
            body.velocity = Vector::<f64, 2>::new(-arm[1], arm[0]) * SPIN;
        }
        let mut state = State::at_rest(&scene, Vector::zeros(), &bodies)?;
        for affine in &mut state.motion.affine {
            (affine[(0, 1)], affine[(1, 0)]) = (-SPIN, SPIN);
        }
        let mut simulation = Simulation::new(scene, state)?;
        let measure = |simulation: &Simulation<f64, 2>| {
            let (scene, state) = (simulation.scene(), simulation.state());
            let energies = energies(scene, state);
            let angular = body_motion(scene, state, all.clone()).angular_momentum;
            (angular, energies.kinetic + energies.elastic)
        };
        let (angular, energy) = measure(&simulation);
        let end = turns * std::f64::consts::TAU / SPIN;
        let mut history = Vec::new();
        for frame in 0..=40 {
            let share = f64::from(frame) / 40.0;
            simulation.advance_to(end * share)?;
            let now = measure(&simulation);
            history.push([turns * share, now.0 / angular, now.1 / energy]);
        }
        Ok(Run { name, transfer, cells, history })
    }

    /// Angular momentum lost in the first turn, over that at the start.
    fn first_turn(&self) -> f64 {
        let row = self.history.iter().find(|row| row[0] >= 1.0);
        row.map_or(f64::NAN, |row| 1.0 - row[1])
    }

    fn last(&self) -> &[f64; 3] {
        &self.history[self.history.len() - 1]
    }

    fn name(&self) -> String {
        format!("{}, {} cells", self.name, self.cells)
    }
}

/// Carries it out.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let effort = setting.effort;
    let grids: &[usize] = effort.choose(&[8], &[8, 16, 32]);
    let turns = effort.choose(2.0, 20.0);
    let cases: Vec<_> = TRANSFERS
        .into_iter()
        .flat_map(|(name, transfer)| grids.iter().map(move |cells| (name, transfer, *cells)))
        .collect();
    let runs = cases
        .into_par_iter()
        .map(|(name, transfer, cells)| Run::new(name, transfer, cells, turns))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let coarsest: Vec<&Run> = runs.iter().filter(|run| run.cells == grids[0]).collect();
    let line = |column: usize| -> Vec<Line> {
        let points = |run: &&Run| run.history.iter().map(|row| (row[0], row[column])).collect::<Vec<_>>();
        coarsest.iter().map(|run| Line::new(run.name, points(run))).collect()
    };
    let panels = [
        Panel::new("angular momentum over the start's", Scale::Linear, line(1)),
        Panel::new("energy over the start's", Scale::Linear, line(2)),
    ];
    Ok(Evidence {
        figures: vec![EvidenceFigure {
            name: "spin",
            caption: "A spinning block of 8 by 8 cells: what each transfer keeps.",
            drawing: chart("turns", Scale::Linear, "", &panels)?,
        }],
        checks: checks(&runs, grids.len()),
        tables: vec![table(&runs)],
    })
}

fn checks(runs: &[Run], grids: usize) -> Vec<Check> {
    let kept = |run: &Run| {
        let affine = run.transfer.keeps_affine();
        Check {
            quantity: format!("angular momentum kept, {}", run.name()),
            measured: run.last()[1],
            theory: if affine { "1".into() } else { "at most 1 in size".into() },
            allowed: if affine { [1.0 - 1e-10, 1.0 + 1e-10] } else { [-1.0 - 1e-10, 1.0 + 1e-10] },
            source: "apic conserves it to round-off (Jiang et al. 2015, section 5.3); a blend with PIC loses it",
        }
    };
    let energy = |run: &Run| Check {
        quantity: format!("energy kept, {}", run.name()),
        measured: run.last()[2],
        theory: "at most 1".into(),
        allowed: [0.0, 1.0 + 1e-3],
        source: "conservation of energy; symplectic Euler's swings by less than 1e-3",
    };
    let falling = |runs: &[Run]| {
        let (coarsest, finest) = (&runs[0], &runs[runs.len() - 1]);
        (runs.len() > 1 && !finest.transfer.keeps_affine()).then(|| Check {
            quantity: format!("loss in the first turn, finest grid over coarsest, {}", finest.name),
            measured: finest.first_turn() / coarsest.first_turn(),
            theory: "0 as h tends to 0".into(),
            allowed: [-0.8, 0.8],
            source: "losses come from what the grid does not resolve",
        })
    };
    let each = runs.iter().flat_map(|run| [kept(run), energy(run)]);
    each.chain(runs.chunks(grids).filter_map(falling)).collect()
}

fn table(runs: &[Run]) -> Table {
    let row = |run: &Run| {
        let [turns, angular, energy] = *run.last();
        let mut row = Row::default();
        row.put("transfer", "-", "velocity transfer", transfer_name(run.transfer))
            .put("name", "-", "the same with FLIP's share per step", run.name)
            .count("cells", "cells to a side", run.cells as u64)
            .number("turns", "-", "turns", turns)
            .number("angular_momentum", "-", "angular momentum at the end over that at the start", angular)
            .number("angular_momentum_error", "-", "the same less 1", angular - 1.0)
            .number("first_turn", "-", "angular momentum lost in the first turn", run.first_turn())
            .number("energy", "-", "kinetic and elastic energy at the end over that at the start", energy);
        row
    };
    Table { name: "spin", rows: runs.iter().map(row).collect() }
}
