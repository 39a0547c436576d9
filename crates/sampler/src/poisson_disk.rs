//! Poisson-disk placement: random points no two of which are near, fitted to the exact count.

use snowlab_solver::geometry::Vector;

use crate::domain::Domain;
use crate::error::SamplerError;
use crate::neighbours::Neighbours;
use crate::rng::{self, ChaCha8Rng};

/// Points of a filled set times the volume of a cube of the least distance, over the volume filled; only a first guess.
/// Source: sets of 30 000 points in a disc and 100 000 in a ball made by this file (0.632 and 0.574).
const fn packing(dimension: usize) -> f64 {
    if dimension == 2 { 0.632 } else { 0.574 }
}

/// Rounds of the search for the distance. Chosen: one or two are usual, more with few points or many voids.
const ROUNDS: usize = 30;
/// Surplus that is accepted, over the count. Chosen: small enough to leave no visible gaps, above the scatter of a
/// fill.
const SURPLUS: f64 = 0.02;
/// Candidates about every point. Chosen: of a cube about the annulus of Bridson (2007) about a half fall into it,
/// which leaves his k = 30.
const CANDIDATES: usize = 60;
/// Points asked for, per uniform dart that seeds the fill. Chosen: every part of a region in pieces gets darts, and a
/// fill that grows from few darts visits memory in order.
const COUNT_PER_DART: usize = 4;
/// Darts until the first lands. Chosen: fifty times as many as the emptiest domain allowed needs on average.
const MOST_DARTS: usize = 100_000;
/// Most cells of the background grid. Chosen: 400 MB.
const MOST_CELLS: f64 = 1e8;

/// Positions and a distance below which no two of them are [m].
pub(crate) struct Disks<const D: usize> {
    pub positions: Vec<Vector<f64, D>>,
    pub least_distance: f64,
}

/// Fills the domain with points of least distance `r` (darts, then Bridson 2007), searches `r` for a count at most 2 %
/// above the one asked for, and drops the surplus, each time a point with the nearest neighbour.
pub(crate) fn place<const D: usize>(
    domain: &Domain<'_, D>,
    count: usize,
    rng: &mut ChaCha8Rng,
) -> Result<Disks<D>, SamplerError> {
    let aim = count as f64 * (1.0 + 0.5 * SURPLUS);
    let mut distance = root::<D>(packing(D) * domain.filled_volume / aim);
    let most = (count as f64 * (1.0 + SURPLUS)).ceil() as usize + 1;
    let mut best: Option<Disks<D>> = None;
    let mut placed = 0;
    let mut rounds = 0;
    while rounds < ROUNDS {
        rounds += 1;
        let positions = Fill::new(domain, distance)?.run(count / COUNT_PER_DART, rng);
        placed = positions.len();
        if placed == 0 {
            break;
        }
        // Never by more than a half, for counts so small that they say little.
        let step = root::<D>(placed as f64 / aim).clamp(0.5, 1.5);
        let next = distance * if placed < count { step.min(0.99) } else { step };
        if placed >= count && best.as_ref().is_none_or(|best| placed < best.positions.len()) {
            best = Some(Disks { positions, least_distance: distance });
        }
        // Chosen: after six rounds any set of enough points will do.
        if best.as_ref().is_some_and(|best| best.positions.len() <= most || rounds >= 6) {
            break;
        }
        distance = next;
    }
    match best {
        Some(Disks { positions, least_distance }) => {
            Ok(Disks { positions: thinned(&positions, count, least_distance), least_distance })
        }
        None => {
            Err(SamplerError::CannotPlace { sampler: "poisson-disk", placed, wanted: count, tries: rounds })
        }
    }
}

/// Drops points until `count` are left: those with the nearest neighbours first, but none whose nearest neighbour was
/// dropped before it unless nothing else is left.
fn thinned<const D: usize>(positions: &[Vector<f64, D>], count: usize, distance: f64) -> Vec<Vector<f64, D>> {
    let neighbours = Neighbours::new(positions, 2.0 * distance);
    let mut nearest: Vec<(f64, usize, usize)> = (0..positions.len())
        .map(|point| {
            let mut best = (f64::INFINITY, point, point);
            neighbours.for_each(point, |other, squared| {
                if squared < best.0 {
                    best = (squared, point, other);
                }
            });
            best
        })
        .collect();
    nearest.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let mut dropped = vec![false; positions.len()];
    let mut surplus = positions.len() - count;
    for spare_neighbours in [true, false] {
        for &(_, point, neighbour) in &nearest {
            if surplus > 0 && !dropped[point] && !(spare_neighbours && dropped[neighbour]) {
                dropped[point] = true;
                surplus -= 1;
            }
        }
    }
    positions.iter().zip(dropped).filter(|(_, dropped)| !dropped).map(|(point, _)| *point).collect()
}

/// A set of points that grows, on a grid whose cells hold one point each.
struct Fill<'a, const D: usize> {
    domain: &'a Domain<'a, D>,
    distance: f64,
    cell: f64,
    shape: [usize; D],
    /// Number of the point in every cell plus one; 0 in an empty cell.
    cells: Vec<u32>,
    positions: Vec<Vector<f64, D>>,
    /// Steps to the cells that may hold a point nearer than the distance, nearest first.
    around: Vec<[isize; D]>,
}

impl<'a, const D: usize> Fill<'a, D> {
    fn new(domain: &'a Domain<'a, D>, distance: f64) -> Result<Self, SamplerError> {
        // The diagonal of a cell is the distance, less a little for rounding.
        let cell = distance / (D as f64).sqrt() * (1.0 - 1e-9);
        // Two more cells on every side, so that no step around a point leaves the grid.
        let sides = (domain.bounds.max - domain.bounds.min).map(|side| (side / cell).floor() + 5.0);
        let total = sides.product();
        if total.is_nan() || total > MOST_CELLS {
            return Err(SamplerError::RasterTooFine { cell, cells: total, most: MOST_CELLS });
        }
        let mut shape = [0; D];
        for axis in 0..D {
            shape[axis] = sides[axis] as usize;
        }
        let cells = vec![0; total as usize];
        Ok(Self { domain, distance, cell, shape, cells, positions: Vec::new(), around: steps_around() })
    }

    fn run(mut self, darts: usize, rng: &mut ChaCha8Rng) -> Vec<Vector<f64, D>> {
        for number in 0..MOST_DARTS.max(darts) {
            if number >= darts && !self.positions.is_empty() {
                break;
            }
            let dart = self.domain.point_at(&rng::uniform_vector::<D>(rng));
            self.offer(&dart);
        }
        let mut active = 0;
        while active < self.positions.len() {
            let centre = self.positions[active];
            for _ in 0..CANDIDATES {
                let offset = (rng::uniform_vector::<D>(rng).add_scalar(-0.5)) * (4.0 * self.distance);
                let ratio = offset.norm_squared() / (self.distance * self.distance);
                if (1.0..=4.0).contains(&ratio) {
                    self.offer(&(centre + offset));
                }
            }
            active += 1;
        }
        self.positions
    }

    /// Takes the point [m] if it lies in the domain and near no other.
    fn offer(&mut self, point: &Vector<f64, D>) {
        let Some(steps) = self.steps(point) else { return };
        for around in &self.around {
            let mut flat = 0;
            for axis in (0..D).rev() {
                flat = flat * self.shape[axis] + (steps[axis] as isize + around[axis]) as usize;
            }
            let other = self.cells[flat];
            if other != 0
                && (self.positions[other as usize - 1] - point).norm_squared() < self.distance * self.distance
            {
                return;
            }
        }
        if !self.domain.contains(point) {
            return;
        }
        let flat = (0..D).rev().fold(0, |flat, axis| flat * self.shape[axis] + steps[axis]);
        self.positions.push(*point);
        self.cells[flat] = self.positions.len() as u32;
    }

    /// The cell of a point in the bounding box.
    fn steps(&self, point: &Vector<f64, D>) -> Option<[usize; D]> {
        let mut steps = [0; D];
        for axis in 0..D {
            let step = (point[axis] - self.domain.bounds.min[axis]) / self.cell + 2.0;
            if !(step >= 2.0 && step < (self.shape[axis] - 2) as f64) {
                return None;
            }
            steps[axis] = step as usize;
        }
        Some(steps)
    }
}

/// The cells within two steps along every axis that may, but for rounding, hold a point nearer than the distance;
/// nearest first.
fn steps_around<const D: usize>() -> Vec<[isize; D]> {
    let mut steps: Vec<(usize, [isize; D])> = (0..5_usize.pow(D as u32))
        .map(|flat| {
            let mut rest = flat;
            let step = std::array::from_fn(|_| {
                let own = (rest % 5) as isize - 2;
                rest /= 5;
                own
            });
            let squared = step.iter().map(|own: &isize| own.unsigned_abs().pow(2)).sum();
            (squared, step)
        })
        .filter(|(_, step)| {
            // In cells the squared distance is D; a cell s steps away along an axis is at least s - 1 away.
            let gap: usize = step.iter().map(|own| own.unsigned_abs().saturating_sub(1).pow(2)).sum();
            gap <= D
        })
        .collect();
    steps.sort();
    steps.into_iter().map(|(_, step)| step).collect()
}

fn root<const D: usize>(volume: f64) -> f64 {
    if D == 2 { volume.sqrt() } else { libm::cbrt(volume) }
}
