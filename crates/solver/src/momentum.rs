//! Stage 3: the velocity of grid nodes.

use crate::collision::keep_middle_out;
use crate::geometry::Vector;
use crate::grid::{Grid, NodeMotion};
use crate::ledger::StepLedger;
use crate::real::Real;
use crate::scene::Scene;

/// v* = v + dt (f / m + g) on every node that holds mass; others stand still, and what they hold is booked.
pub(crate) fn update_grid_velocity<T: Real, const D: usize>(
    grid: &mut Grid<T, D>,
    gravity: &Vector<T, D>,
    dt: T,
    empty: T,
    ledger: &mut StepLedger<D>,
) {
    for (sums, motion) in grid.sums.iter().zip(&mut grid.motion) {
        if sums.mass <= empty {
            ledger.dropped_mass += sums.mass.as_f64();
            *motion = NodeMotion::still();
            continue;
        }
        let per_mass = T::one() / sums.mass;
        let change = (sums.force * per_mass + gravity) * dt;
        *motion = NodeMotion { velocity: sums.momentum * per_mass + change, change };
    }
}

/// v^{n+1} to (v^n + v^{n+1}) / 2 on every node, held by the obstacles of `time` [s].
pub(crate) fn back_to_the_middle<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    grid: &mut Grid<T, D>,
    time: f64,
) {
    let half = T::of(0.5);
    for index in 0..grid.node_count() {
        let NodeMotion { velocity, change } = grid.motion[index];
        let middle = velocity - change * half;
        grid.motion[index].velocity = keep_middle_out(scene, &grid.position(index), middle, time);
    }
}

/// Kinetic energy of the nodes' sums, p^2 / 2m [J].
pub(crate) fn kinetic_of_sums<T: Real, const D: usize>(grid: &Grid<T, D>, empty: T) -> f64 {
    let held = grid.sums.iter().filter(|sums| sums.mass > empty);
    held.map(|sums| (sums.momentum.norm_squared() / sums.mass).as_f64()).sum::<f64>() * 0.5
}

/// Kinetic energy of the nodes' motion, m v^2 / 2 [J].
pub(crate) fn kinetic_of_motion<T: Real, const D: usize>(grid: &Grid<T, D>) -> f64 {
    let nodes = grid.sums.iter().zip(&grid.motion);
    nodes.map(|(sums, motion)| (motion.velocity.norm_squared() * sums.mass).as_f64()).sum::<f64>() * 0.5
}
