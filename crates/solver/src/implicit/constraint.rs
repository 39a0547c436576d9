//! Which nodes obstacles hold during a solve, and how.

use std::collections::{BTreeMap, BTreeSet};

use crate::collision::{Collider, Contact};
use crate::geometry::{Matrix, Vector, unit};
use crate::real::Real;
use crate::scene::Scene;

/// A node whose velocity is known along some directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Held<T: Real, const D: usize> {
    pub node: usize,
    /// The velocity it keeps along those directions [m/s], nothing along the others.
    pub velocity: Vector<T, D>,
    /// Projects on the directions that are free.
    pub free: Matrix<T, D>,
}

impl<T: Real, const D: usize> Held<T, D> {
    fn nowhere(node: usize) -> Self {
        Held { node, velocity: Vector::zeros(), free: Matrix::identity() }
    }

    /// Of `node` at `x` [m], which an explicit step would give the velocity `v` [m/s], at `time` [s]; `None` where nothing holds it.
    fn of(
        colliders: &[Collider<T, D>],
        node: usize,
        x: &Vector<T, D>,
        v: &Vector<T, D>,
        time: f64,
        released: &Released,
    ) -> Option<Self> {
        let mut held = Held::nowhere(node);
        for (number, collider) in colliders.iter().enumerate() {
            let acts = collider.contact != Contact::Mirror && !released.contains(&(node, number));
            if !acts || collider.respond(x, v, time).is_none() {
                continue;
            }
            if collider.contact == Contact::Sticky {
                held.hold_all(&collider.velocity);
            } else {
                held.hold(&collider.normal_at(x, time), &collider.velocity);
            }
        }
        (held.free != Matrix::<T, D>::identity()).then_some(held)
    }

    /// Holds what is still free of the velocity along `normal` at that of `velocity`.
    fn hold(&mut self, normal: &Vector<T, D>, velocity: &Vector<T, D>) {
        let direction = self.free * normal;
        let length = direction.norm();
        // chosen: an obstacle whose normal is within 1e-3 of the others' leaves nothing to hold.
        if length < T::of(1e-3) {
            return;
        }
        let direction = direction / length;
        self.velocity += direction * direction.dot(&(velocity - self.velocity));
        self.free -= direction * direction.transpose();
    }

    /// The known part of the change from the velocity `v` [m/s].
    pub fn change_from(&self, v: &Vector<T, D>) -> Vector<T, D> {
        self.velocity - (v - self.free * v)
    }

    fn hold_all(&mut self, velocity: &Vector<T, D>) {
        self.velocity += self.free * velocity;
        self.free = Matrix::zeros();
    }
}

/// Pairs of node and obstacle that have come apart in the course of a solve.
pub(crate) type Released = BTreeSet<(usize, usize)>;

/// How far a node would have to leave in a step, in cells, for what holds it to be in its way (chosen: less does not show in a
/// result, and may be the solver's tolerance).
const LEAVING: f64 = 1e-3;

/// Releases the nodes that obstacles they may leave would have to pull at: those of `held` that `impulse_per_mass` [m/s], the
/// obstacles' on each of the nodes over its mass, draws towards one of them. Returns whether there were any.
pub(crate) fn release<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    held: &[Held<T, D>],
    place: impl Fn(usize) -> Vector<T, D>,
    impulse_per_mass: impl Fn(usize) -> Vector<T, D>,
    time: f64,
    dt: f64,
    released: &mut Released,
) -> bool {
    let before = released.len();
    let least = T::of(LEAVING / dt) * scene.spacing;
    for &Held { node, .. } in held {
        let (x, push) = (place(node), impulse_per_mass(node));
        for (number, collider) in scene.colliders.iter().enumerate() {
            let pulls = collider.contact == Contact::Separate
                && collider.contains(&x, time)
                && -push.dot(&collider.normal_at(&x, time)) > least;
            if pulls {
                released.insert((node, number));
            }
        }
    }
    released.len() > before
}

/// The nodes of `nodes` (number, place [m], velocity after an explicit step [m/s]) that obstacles hold at `time` [s], but for those `released`,
/// and those on mirrors' planes (number, axis).
pub(crate) fn held_nodes<T: Real, const D: usize>(
    colliders: &[Collider<T, D>],
    nodes: impl Iterator<Item = (usize, Vector<T, D>, Vector<T, D>)>,
    on_planes: impl Iterator<Item = (usize, usize)>,
    time: f64,
    released: &Released,
) -> Vec<Held<T, D>> {
    let mut held = BTreeMap::new();
    if colliders.iter().any(|c| c.contact != Contact::Mirror) {
        held.extend(
            nodes.filter_map(|(node, x, v)| Some((node, Held::of(colliders, node, &x, &v, time, released)?))),
        );
    }
    for (node, axis) in on_planes {
        held.entry(node).or_insert_with(|| Held::nowhere(node)).hold(&unit(axis), &Vector::zeros());
    }
    held.into_values().collect()
}
