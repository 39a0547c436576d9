//! A ball on obstacles that move: thrown at a floor that comes towards it, and set on a belt.

use rayon::prelude::*;
use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::geometry::Vector;
use snowlab_solver::{KernelKind, Simulation, State, Transfer};

use super::Setting;
use super::chart::{Line, Panel, chart};
use super::evidence::{Check, Effort, Evidence, EvidenceFigure};
use super::scenes::{
    GRAVITY, TRANSFERS, body_motion, disc, elastic, observed_order, scene, transfer_name, wall,
};
use crate::figure::axis::Scale;
use crate::statistics::mean;
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
/// How long the bounce is watched [s]: the ball has left the floor.
const BOUNCE: f64 = 0.1;
/// How long the ball on the belt is watched [s]: it slips for a third of it, and then swings up and down for a period and more.
const ROLL: f64 = 0.35;
/// Times at which the ball on the belt is looked at.
const LOOKS: u32 = 175;

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
    history: Vec<Moment>,
}

/// The ball on the belt at one time.
#[derive(Clone, Copy)]
struct Moment {
    /// [s].
    time: f64,
    /// Over the belt's.
    velocity: f64,
    /// Upwards [m/s].
    rise: f64,
    /// Angular velocity times radius over the belt's speed.
    spin: f64,
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
        let mut history = Vec::new();
        for look in 0..=LOOKS {
            simulation.advance_to(ROLL * f64::from(look) / f64::from(LOOKS))?;
            let now = body_motion(simulation.scene(), simulation.state(), all.clone());
            history.push(Moment {
                time: simulation.state().time,
                velocity: now.velocity[0] / BELT,
                rise: now.velocity[1],
                spin: now.angular_momentum / now.inertia * RADIUS / BELT,
            });
        }
        Ok(Roll { transfer, cells, history })
    }

    /// The ball's velocity over what Coulomb's law gives it while it slips, mu (g t + v_y): the floor bears its weight and what it swings.
    /// Half-way to rolling.
    fn slipping(&self) -> f64 {
        let before = self.history.iter().rev().find(|moment| moment.time <= 0.5 * slip_end());
        before.map_or(f64::NAN, |m| m.velocity * BELT / (FRICTION * (GRAVITY * m.time + m.rise)))
    }

    /// The same of the spin: a rigid disc's R times spin is twice that.
    fn spinning(&self) -> f64 {
        let before = self.history.iter().rev().find(|moment| moment.time <= 0.5 * slip_end());
        before.map_or(f64::NAN, |m| m.spin * BELT / (2.0 * FRICTION * (GRAVITY * m.time + m.rise)))
    }

    /// The last whole swing up and down: from one upward passage of v_y = 0 to the next; all that follows the slipping, where there is none.
    fn last_swing(&self) -> &[Moment] {
        let upward = |pair: &[Moment]| pair[0].rise < 0.0 && pair[1].rise >= 0.0;
        let passages: Vec<usize> =
            (1..self.history.len()).filter(|&k| upward(&self.history[k - 1..=k])).collect();
        match passages[..] {
            [.., begin, end] => &self.history[begin..end],
            _ => &self.history[self.history.partition_point(|moment| moment.time < slip_end())..],
        }
    }

    /// Mean over the last swing.
    fn settled(&self, value: fn(&Moment) -> f64) -> f64 {
        mean(&self.last_swing().iter().map(value).collect::<Vec<_>>()).unwrap_or(f64::NAN)
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
    let line = |value: fn(&Moment) -> f64| -> Vec<Line> {
        let points =
            |roll: &&Roll| roll.history.iter().map(|moment| (moment.time, value(moment))).collect::<Vec<_>>();
        finest.iter().map(|roll| Line::new(transfer_name(roll.transfer), points(roll))).collect()
    };
    let mut panels = [
        Panel::new("velocity over the belt's", Scale::Linear, line(|moment| moment.velocity)),
        Panel::new("spin R over the belt's velocity", Scale::Linear, line(|moment| moment.spin)),
    ];
    panels[0].level = Some((1.0 / 3.0, "1/3"));
    panels[1].level = Some((2.0 / 3.0, "2/3"));
    let mut checks = bounce_checks(&bounces);
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
        tables: vec![bounce_table(&bounces), shifts_table(&bounces, grids.len()), roll_table(&rolls)],
    })
}

/// The floor's work is its momentum times its speed.
fn bounce_checks(bounces: &[Bounce]) -> Vec<Check> {
    let check = |bounce: &Bounce| Check {
        quantity: format!("work of the floor over momentum times speed, less 1, {}", bounce.name()),
        measured: bounce.work / bounce.work_of_momentum - 1.0,
        theory: "0".into(),
        allowed: [-1e-9, 1e-9],
        source: "conservation of momentum, to round-off",
    };
    bounces.iter().filter(|bounce| bounce.floor > 0.0).map(check).collect()
}

/// What the floor's speed changes in the bounce, a finding: by Galileo's principle nothing in the limit.
fn shifts_table(bounces: &[Bounce], grids: usize) -> Table {
    let mut rows = Vec::new();
    for of_transfer in bounces.chunks(grids * FLOORS.len()) {
        let by_grid: Vec<&[Bounce]> = of_transfer.chunks(FLOORS.len()).collect();
        for (number, &floor) in FLOORS.iter().enumerate().skip(1) {
            let shifts: Vec<(f64, f64)> = by_grid
                .iter()
                .map(|grid| {
                    (1.0 / grid[0].cells as f64, 1.0 - grid[number].restitution / grid[0].restitution)
                })
                .collect();
            let order = (grids > 1).then(|| observed_order(&shifts));
            let mut row = Row::default();
            row.put("transfer", "-", "velocity transfer", transfer_name(of_transfer[0].transfer))
                .number("floor", "m/s", "speed of the floor towards the ball", floor)
                .number("coarsest", "-", "share it takes from the restitution, coarsest grid", shifts[0].1)
                .number("finest", "-", "the same, finest grid", shifts[shifts.len() - 1].1)
                .put("order", "-", "order in h, fitted to all grids", order);
            rows.push(row);
        }
    }
    Table { name: "bounce-shifts", rows }
}

/// While it slips, Coulomb's law holds; on the finest grid the affine transfers then roll as a rigid disc does, to 15 %.
fn roll_checks(roll: &Roll, finest: bool) -> Vec<Check> {
    let name = |what: &str| format!("{what}, {}, {} cells", transfer_name(roll.transfer), roll.cells);
    let mut checks = vec![Check {
        quantity: name("velocity over mu (g t + v_y), slipping"),
        measured: roll.slipping(),
        theory: "1".into(),
        allowed: [0.98, 1.02],
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
        let (velocity, spin) = (roll.settled(|moment| moment.velocity), roll.settled(|moment| moment.spin));
        checks.push(check(
            name("velocity over the belt's, mean of the last swing"),
            velocity,
            "1/3",
            1.0 / 3.0,
        ));
        checks.push(check(
            name("spin R over the belt's speed, mean of the last swing"),
            spin,
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
            .number("slipping", "-", "velocity over mu (g t + v_y), half-way to rolling", roll.slipping())
            .number("spinning", "-", "spin R over 2 mu (g t + v_y), half-way to rolling", roll.spinning())
            .number(
                "velocity",
                "-",
                "velocity over the belt's, mean of the last swing up and down",
                roll.settled(|moment| moment.velocity),
            )
            .number(
                "spin",
                "-",
                "angular velocity times radius over the belt's speed, mean of the last swing",
                roll.settled(|moment| moment.spin),
            );
        row
    };
    Table { name: "roll", rows: rolls.iter().map(row).collect() }
}
