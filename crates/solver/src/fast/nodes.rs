//! Stages 3 to 5: the velocity of nodes, block by block.

use super::grid::{BLOCK_NODES, Node, node_coordinates, read_motion, write_motion};
use super::simd::{CHANNELS, InstructionSet, ROW_NODES, Row};
use crate::collision::collide_node;
use crate::geometry::Vector;
use crate::ledger::StepLedger;
use crate::real::Real;
use crate::scene::Scene;

/// What a step asks of the nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Push<T: Real, const D: usize> {
    pub gravity: Vector<T, D>,
    pub dt: T,
    /// A node of no more mass counts as empty [kg].
    pub empty: T,
    pub apart: bool,
}

/// Sums over the nodes of a block.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NodeEnergies {
    /// Kinetic energy after particles to grid [J].
    pub before: f64,
    /// Kinetic energy at the end of the step, where it is asked for [J].
    pub after: f64,
    /// Mass on nodes that counted as empty [kg].
    pub dropped_mass: f64,
}

/// v = p / m, then v += dt (f / m + g), on nodes that hold mass; others stand still.
#[inline(always)]
pub(super) fn push_nodes<I: InstructionSet<T>, T: Real, const D: usize>(
    push: &Push<T, D>,
    sums: &[Node<T>],
    forces: &[Node<T>],
    motion: &mut [Node<T>],
    change: &mut [Node<T>],
) -> NodeEnergies {
    let (sums, forces) = (sums.as_flattened(), forces.as_flattened());
    let (motion, change) = (motion.as_flattened_mut(), change.as_flattened_mut());
    let mut fall = [T::zero(); CHANNELS];
    for k in 0..D {
        fall[k] = push.gravity[k];
    }
    let (gravity, dt, empty) = (I::Row::repeat(&fall), I::Row::splat(push.dt), I::Row::splat(push.empty));
    let one = I::Row::splat(T::one());
    let mut energies = NodeEnergies::default();
    let mut kinetic = I::Row::zero();
    let mut first = 0;
    while first < BLOCK_NODES * CHANNELS {
        let row = I::Row::load(&sums[first..]);
        let mass = if D == 2 { row.spread::<2>() } else { row.spread::<3>() };
        let per_mass = one.over(mass).where_above(mass, empty);
        let start = row * per_mass;
        if push.apart {
            kinetic = start.mul_add(row, kinetic);
            let pull =
                I::Row::load(&forces[first..]).mul_add(per_mass, gravity.where_above(mass, empty)) * dt;
            let end = start + pull;
            if D == 2 {
                end.store(&mut motion[first..]);
                let mut pulls = [T::zero(); ROW_NODES * CHANNELS];
                pull.store(&mut pulls);
                for node in 0..ROW_NODES {
                    for k in 0..2 {
                        motion[first + node * CHANNELS + 2 + k] = pulls[node * CHANNELS + k];
                    }
                }
            } else {
                end.store(&mut motion[first..]);
                pull.store(&mut change[first..]);
            }
        } else {
            (gravity.where_above(mass, empty) * dt + start).store(&mut motion[first..]);
        }
        for node in 0..ROW_NODES {
            let mass = sums[first + node * CHANNELS + D];
            if mass <= push.empty {
                energies.dropped_mass += mass.as_f64();
            }
        }
        first += ROW_NODES * CHANNELS;
    }
    if push.apart {
        energies.before = 0.5 * sum_of_velocities::<I, T, D>(kinetic);
    }
    energies
}

/// Kinetic energy of a block's nodes at the end of a step [J].
#[inline(always)]
pub(super) fn kinetic_energy<I: InstructionSet<T>, T: Real, const D: usize>(
    sums: &[Node<T>],
    motion: &[Node<T>],
) -> f64 {
    let (sums, motion) = (sums.as_flattened(), motion.as_flattened());
    let mut kinetic = I::Row::zero();
    let mut first = 0;
    while first < BLOCK_NODES * CHANNELS {
        let row = I::Row::load(&sums[first..]);
        let mass = if D == 2 { row.spread::<2>() } else { row.spread::<3>() };
        let velocity = I::Row::load(&motion[first..]);
        kinetic = (velocity * mass).mul_add(velocity, kinetic);
        first += ROW_NODES * CHANNELS;
    }
    0.5 * sum_of_velocities::<I, T, D>(kinetic)
}

/// The sum over the first D channels of all nodes of a row.
#[inline(always)]
fn sum_of_velocities<I: InstructionSet<T>, T: Real, const D: usize>(row: I::Row) -> f64 {
    let mut places = [T::zero(); ROW_NODES * CHANNELS];
    row.store(&mut places);
    let mut sum = 0.0;
    for node in 0..ROW_NODES {
        for k in 0..D {
            sum += places[node * CHANNELS + k].as_f64();
        }
    }
    sum
}

/// Stage 5 for the nodes of a block that begins at `first`, with obstacles where they are at `time` [s]; what they did.
pub(super) fn collide_nodes<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    push: &Push<T, D>,
    first: [i32; D],
    sums: &[Node<T>],
    motion: &mut [Node<T>],
    change: &mut [Node<T>],
    time: f64,
) -> StepLedger<D> {
    let mut contact = StepLedger::new(scene.colliders.len());
    for local in 0..BLOCK_NODES {
        let mass = sums[local][D];
        if mass <= push.empty {
            continue;
        }
        let coordinates = node_coordinates(first, local);
        let x = Vector::from_fn(|k, _| T::of_index(coordinates[k]) * scene.spacing);
        let mut node = read_motion::<T, D>(motion, change, local, push.apart);
        collide_node(scene, &x, mass, &mut node, time, &mut contact);
        write_motion(motion, change, local, push.apart, &node);
    }
    contact
}
