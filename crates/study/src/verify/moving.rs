//! A ball on obstacles that move: thrown at a floor that comes towards it, and set on a belt.

use rayon::prelude::*;
use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::geometry::Vector;
use snowlab_solver::{KernelKind, Simulation, State, Transfer};

use super::Setting;
use super::chart::{Line, Panel, chart};
use super::evidence::{Check, Effort, Evidence, EvidenceFigure};
use super::scenes::{GRAVITY, TRANSFERS, body_motion, disc, elastic, scene, transfer_name, wall};
use crate::figure::axis::Scale;
use crate::table::{Row, Table};

/// Radius of the ball [m].
const RADIUS: f64 = 0.1;
/// Speed at which ball and floor meet [m/s].
const SPEED: f64 = 1.0;
/// Speeds of the floor towards the ball [m/s].
const FLOORS: [f64; 3] = [0.0, 0.5, 1.0];
/// Speed of the belt [m/s], and its friction.
const BELT: f64 = 1.0;
const FRICTION: f64 = 0.3;
/// How long the bounce is watched [s], and the ball on the belt: twice the time it slips.
const BOUNCE: f64 = 0.1;
const ROLL: f64 = 0.25;

struct Bounce {
    transfer: Transfer,
    cells: usize,
    floor: f64,
    /// Speed apart over speed together, both against the floor.
    restitution: f64,
    /// Work of the floor, and momentum it gave times its speed [J/m].
    work: f64,
    work_of_momentum: f64,
}

impl Bounce {
    fn name(&self) -> String {
        format!("{}, floor at {} m/s, {} cells", transfer_name(self.transfer), self.floor, self.cells)
    }

    fn new(transfer: Transfer, cells: usize, floor: f64) -> anyhow::Result<Self> {
        let h = RADIUS / cells as f64;
        let mut scene = scene::<f64, 2>(h, KernelKind::Cubic, transfer, elastic());
        let moving = Vector::<f64, 2>::new(0.0, floor);
        scene.colliders = vec![Collider { velocity: moving, ..wall(1, 1.0, 0.0, Contact::Separate) }];
        let centre = Vector::<f64, 2>::new(0.0, RADIUS + 2.0 * h);
        let bodies = disc(h, centre, RADIUS, Vector::<f64, 2>::new(0.0, floor - SPEED));
        let all = 0..bodies.len() as u32;
        let state = State::at_rest(&scene, Vector::zeros(), &bodies)?;
        let mut simulation = Simulation::new(scene, state)?;
        simulation.advance_to(BOUNCE)?;
        let (scene, state) = (simulation.scene(), simulation.state());
        let end = body_motion(scene, state, all);
        Ok(Bounce {
            transfer,
            cells,
            floor,
            restitution: (end.velocity[1] - floor) / SPEED,
            work: state.ledger.collider_work(),
            work_of_momentum: end.mass * (end.velocity[1] - (floor - SPEED)) * floor,
        })
    }
}

struct Roll {
    transfer: Transfer,
    cells: usize,
    /// Time [s], velocity over the belt's, angular velocity times radius over the belt's speed.
    history: Vec<[f64; 3]>,
    /// Horizontal over vertical impulse of the belt, over mu, half-way to rolling.
    slipping: f64,
}

impl Roll {
    fn new(transfer: Transfer, cells: usize) -> anyhow::Result<Self> {
        let h = RADIUS / cells as f64;
        let mut scene = scene::<f64, 2>(h, KernelKind::Cubic, transfer, elastic());
        scene.gravity[1] = -GRAVITY;
        scene.colliders = vec![Collider {
            friction: FRICTION,
            velocity: Vector::<f64, 2>::new(BELT, 0.0),
            ..wall(1, 1.0, 0.0, Contact::Separate)
        }];
        let bodies = disc(h, Vector::<f64, 2>::new(0.0, RADIUS), RADIUS, Vector::zeros());
        let all = 0..bodies.len() as u32;
        let state = State::at_rest(&scene, Vector::zeros(), &bodies)?;
        let mut simulation = Simulation::new(scene, state)?;
        let (mut history, mut slipping) = (Vec::new(), f64::NAN);
        for frame in 0..=50 {
            simulation.advance_to(ROLL * f64::from(frame) / 50.0)?;
            let now = body_motion(simulation.scene(), simulation.state(), all.clone());
            let spin = now.angular_momentum / now.inertia;
            history.push([simulation.state().time, now.velocity[0] / BELT, spin * RADIUS / BELT]);
            if simulation.state().time <= 0.5 * slip_end() {
                let impulse = simulation.state().ledger.colliders[0].impulse;
                slipping = impulse[0] / (FRICTION * impulse[1]);
            }
        }
        Ok(Roll { transfer, cells, history, slipping })
    }

    fn last(&self) -> &[f64; 3] {
        &self.history[self.history.len() - 1]
    }
}

/// A disc set on a belt of speed V slips until it rolls, at V / (3 mu g): mu g t = V - 2 mu g t (I = m R^2 / 2). [s]
fn slip_end() -> f64 {
    BELT / (3.0 * FRICTION * GRAVITY)
}

/// Carries it out.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let effort = setting.effort;
    let grids: &[usize] = effort.choose(&[8], &[5, 10, 20, 40]);
    let pairs: Vec<(Transfer, usize)> = TRANSFERS
        .into_iter()
        .flat_map(|transfer| grids.iter().map(move |cells| (transfer, *cells)))
        .collect();
    let bounces = pairs
        .par_iter()
        .flat_map_iter(|&(transfer, cells)| FLOORS.map(|floor| (transfer, cells, floor)))
        .map(|(transfer, cells, floor)| Bounce::new(transfer, cells, floor))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let rolls = pairs
        .par_iter()
        .map(|&(transfer, cells)| Roll::new(transfer, cells))
        .collect::<anyhow::Result<Vec<_>>>()?;
    let finest: Vec<&Roll> = rolls.chunks(grids.len()).filter_map(|rolls| rolls.last()).collect();
    let line = |column: usize| -> Vec<Line> {
        let points = |roll: &&Roll| roll.history.iter().map(|row| (row[0], row[column])).collect::<Vec<_>>();
        finest.iter().map(|roll| Line::new(transfer_name(roll.transfer), points(roll))).collect()
    };
    let mut panels = [
        Panel::new("velocity over the belt's", Scale::Linear, line(1)),
        Panel::new("spin R over the belt's velocity", Scale::Linear, line(2)),
    ];
    panels[0].level = Some((1.0 / 3.0, "1/3"));
    panels[1].level = Some((2.0 / 3.0, "2/3"));
    let mut checks = bounce_checks(&bounces, grids.len());
    for of_transfer in rolls.chunks(grids.len()) {
        let last = of_transfer.len() - 1;
        let full = effort == Effort::Full;
        checks.extend(
            of_transfer.iter().enumerate().flat_map(|(index, roll)| roll_checks(roll, full && index == last)),
        );
    }
    Ok(Evidence {
        figures: vec![EvidenceFigure {
            name: "roll",
            caption: "A ball set on a belt: it slips, then rolls with a third of the belt's speed.",
            drawing: chart("time [s]", Scale::Linear, "", &panels)?,
        }],
        checks,
        tables: vec![bounce_table(&bounces), roll_table(&rolls)],
    })
}

/// The floor's work is its momentum times its speed; and what its speed changes in the bounce vanishes with h.
fn bounce_checks(bounces: &[Bounce], grids: usize) -> Vec<Check> {
    let mut checks = Vec::new();
    for bounce in bounces.iter().filter(|bounce| bounce.floor > 0.0) {
        checks.push(Check {
            quantity: format!("work of the floor over momentum times speed, {}", bounce.name()),
            measured: bounce.work / bounce.work_of_momentum,
            theory: "1".into(),
            allowed: [1.0 - 1e-9, 1.0 + 1e-9],
            source: "conservation of momentum, to round-off",
        });
    }
    for of_transfer in bounces.chunks(grids * FLOORS.len()) {
        let by_grid: Vec<&[Bounce]> = of_transfer.chunks(FLOORS.len()).collect();
        // The coarsest grid has five cells to the radius: less than the contact is wide.
        let [_, coarse, .., fine] = by_grid[..] else { continue };
        for number in 1..FLOORS.len() {
            let shift = |grid: &[Bounce]| 1.0 - grid[number].restitution / grid[0].restitution;
            checks.push(Check {
                quantity: format!("what the floor's speed takes, {}, over that at {} cells", fine[number].name(), coarse[0].cells),
                measured: shift(fine) / shift(coarse),
                theory: "0 as h tends to 0".into(),
                allowed: [0.0, 0.7],
                source: "Galileo's principle in the limit; chosen: it falls with the square root of h at least",
            });
        }
    }
    checks
}

/// While it slips, Coulomb's law holds for the impulses; on the finest grid the affine transfers then roll as a rigid disc does, to 15 %.
fn roll_checks(roll: &Roll, finest: bool) -> Vec<Check> {
    let name = |what: &str| format!("{what}, {}, {} cells", transfer_name(roll.transfer), roll.cells);
    let mut checks = vec![Check {
        quantity: name("impulse along over mu times impulse across, slipping"),
        measured: roll.slipping,
        theory: "1".into(),
        allowed: [0.98, 1.0 + 1e-9],
        source: "Coulomb's law; chosen: 2 %, for the ball's own swings",
    }];
    if finest && roll.transfer.keeps_affine() {
        let check = |quantity: String, measured: f64, theory: &str, value: f64| Check {
            quantity,
            measured,
            theory: theory.into(),
            allowed: [0.85 * value, 1.15 * value],
            source: "a rigid disc; chosen: 15 %, what the width of the contact, some cells, still changes",
        };
        checks.push(check(name("velocity once rolling over the belt's"), roll.last()[1], "1/3", 1.0 / 3.0));
        checks.push(check(
            name("spin R once rolling over the belt's speed"),
            roll.last()[2],
            "2/3",
            2.0 / 3.0,
        ));
    }
    checks
}

fn bounce_table(bounces: &[Bounce]) -> Table {
    let row = |bounce: &Bounce| {
        let mut row = Row::default();
        row.put("transfer", "-", "velocity transfer", transfer_name(bounce.transfer))
            .count("cells", "cells to the radius", bounce.cells as u64)
            .number("floor", "m/s", "speed of the floor towards the ball", bounce.floor)
            .number("restitution", "-", "speed apart over speed together", bounce.restitution)
            .number("work", "J/m", "work of the floor, from contacts", bounce.work)
            .number(
                "work_of_momentum",
                "J/m",
                "the ball's momentum times the floor's speed",
                bounce.work_of_momentum,
            );
        row
    };
    Table { name: "bounce", rows: bounces.iter().map(row).collect() }
}

fn roll_table(rolls: &[Roll]) -> Table {
    let row = |roll: &Roll| {
        let mut row = Row::default();
        row.put("transfer", "-", "velocity transfer", transfer_name(roll.transfer))
            .count("cells", "cells to the radius", roll.cells as u64)
            .number(
                "slipping",
                "-",
                "impulse along over mu times impulse across, half-way to rolling",
                roll.slipping,
            )
            .number("velocity", "-", "velocity at the end over the belt's", roll.last()[1])
            .number(
                "spin",
                "-",
                "angular velocity times radius over the belt's speed, at the end",
                roll.last()[2],
            );
        row
    };
    Table { name: "roll", rows: rolls.iter().map(row).collect() }
}
