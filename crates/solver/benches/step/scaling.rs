//! More threads than this machine has, by a model: blocks of measured cost, handed out as the fast engine hands them out.

use std::collections::BTreeMap;

use snowlab_solver::{KernelKind, Real, Simulation, Transfer};

use crate::ball::{Ball, PARTICLES_A_CELL};
use crate::contest::burst_of;

const THREADS: [usize; 6] = [1, 2, 4, 8, 16, 64];
/// Of the time of a block: scattering its particles, adding its tile to the grid, and all that gathers from its tile. A sampling profiler says
/// 0.44, 0.11 and 0.45 at 300 thousand particles in 2D, and 0.46, 0.09 and 0.45 at 100 thousand in 3D (MLS, f32).
const SHARES: [f64; 3] = [0.45, 0.10, 0.45];
/// Particles of a ball so small that its steps on two threads take as long as handing over does (chosen: a few blocks of one chunk).
const FEW: usize = 64;
/// Parallel parts of a step: scatter, nodes, gather; sorting has three, in every fifth step of a fall.
const PARTS: f64 = 3.6;

/// Measures and prints the model's table.
pub fn run() {
    let handover = handover();
    println!(
        "handing over to a second thread and back takes {:.1} us for each parallel part",
        handover * 1e6
    );
    println!(
        "{:<30}{:>8}{:>9}{:>10}{:>10}  speed-up on so many threads, by the model",
        "case", "blocks", "ns a", "us a", "measured"
    );
    print!("{:<30}{:>8}{:>9}{:>10}{:>10}", "", "", "particle", "block", "on two");
    THREADS.iter().for_each(|threads| print!("{threads:>7}"));
    println!();
    case::<f32, 2>(30_000, handover);
    case::<f32, 2>(300_000, handover);
    case::<f32, 3>(100_000, handover);
    case::<f32, 3>(1_000_000, handover);
}

/// A parallel part ends so much later on two threads than on one where there is next to nothing to do [s].
fn handover() -> f64 {
    let few = ball(FEW, PARTICLES_A_CELL);
    let [one, two] = [1, 2].map(|threads| burst_of::<f32, 2>(&few, threads));
    ((two - one) / PARTS).max(0.0)
}

fn ball(particles: usize, per_cell: f64) -> Ball {
    Ball {
        kernel: KernelKind::Cubic,
        transfer: Transfer::Mls,
        particles,
        gap: 1e3,
        squashed: false,
        energy_budget: false,
        per_cell,
    }
}

fn case<T: Real, const D: usize>(particles: usize, handover: f64) {
    let (full, sparse) = (ball(particles, PARTICLES_A_CELL), ball(particles / 2, 0.5 * PARTICLES_A_CELL));
    let time = |ball: &Ball, threads| burst_of::<T, D>(ball, threads);
    // As many blocks with half the particles: what a block costs and what a particle does.
    let (whole, half, two) = (time(&full, 1), time(&sparse, 1), time(&full, 2));
    let counts = block_counts::<T, D>(&full);
    let of_particle = (whole - half) / (particles - particles / 2) as f64;
    let of_block = ((whole - of_particle * particles as f64) / counts.len() as f64).max(0.0);
    print!(
        "{:<30}{:>8}{:>9.1}{:>10.2}{:>10.2}",
        format!("{D}D cubic f32 MLS {}k", particles / 1000),
        counts.len(),
        of_particle * 1e9,
        of_block * 1e6,
        whole / two
    );
    let costs: Vec<(usize, f64)> =
        counts.into_iter().map(|(colour, count)| (colour, of_block + of_particle * count as f64)).collect();
    for threads in THREADS {
        print!("{:>7.1}", whole / step_time(&costs, threads, handover));
    }
    println!();
}

/// Colour and particles of every block, in the order of blocks.
fn block_counts<T: Real, const D: usize>(ball: &Ball) -> Vec<(usize, usize)> {
    // As in the engine's grid: edge of a block, and blocks on an axis after which tiles have no node in common.
    let (edge, period): (f64, i64) = if D == 2 { (8.0, 2) } else { (4.0, 3) };
    let (scene, state) = ball.build::<T, D>();
    let simulation = Simulation::new(scene, state).expect("a valid scene");
    let spacing = simulation.scene().spacing.as_f64();
    let mut blocks: BTreeMap<Vec<i64>, usize> = BTreeMap::new();
    for x in &simulation.state().motion.position {
        let corner = x.iter().map(|x| ((x.as_f64() / spacing - 1.0) / edge).floor() as i64).collect();
        *blocks.entry(corner).or_default() += 1;
    }
    let colour = |corner: &[i64]| corner.iter().fold(0, |c, n| c * period + n.rem_euclid(period)) as usize;
    blocks.into_iter().map(|(corner, count)| (colour(&corner), count)).collect()
}

/// Of a step over blocks of these colours and costs [s].
fn step_time(blocks: &[(usize, f64)], threads: usize, handover: f64) -> f64 {
    let mut by_colour = blocks.to_vec();
    by_colour.sort_by_key(|(colour, _)| *colour);
    let [scatter, add, gather] = SHARES;
    // Scattering: in the order of colours; a tile is added when all of the colours before have been.
    let mut free = vec![0.0_f64; threads];
    let (mut colour, mut before, mut latest) = (usize::MAX, 0.0_f64, 0.0_f64);
    for &(own, cost) in &by_colour {
        if own != colour {
            (colour, before) = (own, latest);
        }
        let thread = earliest(&free);
        let end = (free[thread] + scatter * cost).max(before) + add * cost;
        free[thread] = end;
        latest = latest.max(end);
    }
    // Gathering: whoever is free takes the next.
    let mut busy = vec![0.0_f64; threads];
    for &(_, cost) in blocks {
        let thread = earliest(&busy);
        busy[thread] += gather * cost;
    }
    let handover = if threads > 1 { PARTS * handover } else { 0.0 };
    latest + busy.iter().copied().fold(0.0, f64::max) + handover
}

fn earliest(free: &[f64]) -> usize {
    (0..free.len()).min_by(|&a, &b| free[a].total_cmp(&free[b])).expect("a thread")
}
