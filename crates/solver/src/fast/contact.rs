//! Contact with obstacles: which blocks have one near, and what it does to the particles there.

use super::grid::block_edge;
use super::simd::{CHUNK, Lanes};
use super::update::Update;
use crate::collision::{Collider, collide_particle};
use crate::geometry::Vector;
use crate::ledger::StepLedger;
use crate::real::Real;

/// A centre and a radius [m] of a ball round the tile of `block`.
pub(super) fn surroundings<T: Real, const D: usize>(first_node: [i32; D], spacing: T) -> (Vector<T, D>, T) {
    let half = T::of(0.5 * f64::from(block_edge::<D>()));
    let centre = Vector::from_fn(|k, _| (T::of_index(first_node[k]) + half) * spacing);
    // Half an edge, two cells' drift (one, and one in this step) and a node's distance from the stencil's middle.
    (centre, (half + T::of(4.0)) * spacing * T::of((D as f64).sqrt()))
}

/// Whether some obstacle of `colliders` reaches into the ball at `time` [s].
pub(super) fn is_near<T: Real, const D: usize>(
    colliders: &[Collider<T, D>],
    (centre, radius): &(Vector<T, D>, T),
    time: f64,
) -> bool {
    colliders.iter().any(|collider| {
        let place = centre - collider.velocity * T::of(time);
        collider.shape.surface(&place).distance <= *radius
    })
}

/// Lanes as numbers, by component.
pub(super) type Unpacked<T, const D: usize> = [[T; CHUNK]; D];

#[inline(always)]
pub(super) fn unpack<V: Lanes<T>, T: Real, const D: usize>(lanes: &[V; D]) -> Unpacked<T, D> {
    let mut numbers = [[T::zero(); CHUNK]; D];
    for i in 0..D {
        lanes[i].store(&mut numbers[i]);
    }
    numbers
}

#[inline(always)]
pub(super) fn pack<V: Lanes<T>, T: Real, const D: usize>(numbers: &Unpacked<T, D>, lanes: &mut [V; D]) {
    for i in 0..D {
        lanes[i] = V::load(&numbers[i]);
    }
}

/// Contact of `count` particles, one by one: of the velocities they keep and of those that move them.
#[inline(never)]
pub(super) fn collide_lanes<T: Real, const D: usize>(
    update: &Update<T, D>,
    count: usize,
    masses: &[T],
    places: &Unpacked<T, D>,
    [kept, movers]: [&mut Unpacked<T, D>; 2],
    ledger: &mut StepLedger<D>,
) {
    for lane in 0..count {
        let of = |numbers: &Unpacked<T, D>| Vector::<T, D>::from_fn(|i, _| numbers[i][lane]);
        let (place, mut velocity, mut mover) = (of(places), of(kept), of(movers));
        let mass = masses[lane];
        collide_particle(update.scene, mass, &place, &mut velocity, &mut mover, update.interval, ledger);
        for i in 0..D {
            (kept[i][lane], movers[i][lane]) = (velocity[i], mover[i]);
        }
    }
}
