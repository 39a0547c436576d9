//! Planes of symmetry on rows of nodes: what falls on nodes beyond the plane is folded back with its normal component
//! reversed, and the motion is reflected out again, so that the material sees its own mirror image. Nodes on the plane keep their
//! own sums and do not move along its normal.

use std::ops::IndexMut;

use crate::collision::{Contact, MirrorPlane};
use crate::error::SceneError;
use crate::geometry::{Vector, unit};
use crate::grid::{NodeMotion, NodeSums, Nodes};
use crate::ledger::{StepLedger, impulse_energy};
use crate::real::Real;
use crate::scene::Scene;

/// A node beyond a mirror and the node it is folded onto, or twice the same node on the plane, with the sums before.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fold<T: Real, const D: usize> {
    outer: usize,
    inner: usize,
    own_outer: NodeSums<T, D>,
    own_inner: NodeSums<T, D>,
    axis: usize,
    collider: usize,
}

/// The mirrors of a scene, with their numbers among the colliders.
pub(crate) fn planes<T: Real, const D: usize>(
    scene: &Scene<T, D>,
) -> Result<Vec<(usize, MirrorPlane)>, SceneError> {
    let mirrors = scene.colliders.iter().enumerate().filter(|(_, c)| c.contact == Contact::Mirror);
    mirrors.map(|(number, c)| Ok((number, c.mirror_plane(scene.spacing)?))).collect()
}

/// Folds sums onto the material's side: nodes beyond two planes go over one after the other. Then holds the nodes on the planes, last,
/// since a mirror one cell away folds onto them.
pub(crate) fn fold<T: Real, const D: usize>(
    planes: &[(usize, MirrorPlane)],
    grid: &mut impl Nodes<T, D>,
    gravity: &Vector<T, D>,
    folds: &mut Vec<Fold<T, D>>,
) {
    folds.clear();
    for beyond in [true, false] {
        for &(collider, plane) in planes {
            for outer in 0..grid.node_count() {
                let mut image = grid.coordinates(outer);
                let above = image[plane.axis] - plane.node;
                let depth = if plane.material_above { -above } else { above };
                let concerned = if beyond { depth > 0 } else { depth == 0 };
                if !concerned || grid.sums(outer).mass == T::zero() {
                    continue;
                }
                image[plane.axis] = plane.node - above;
                // A stencil that begins within the material holds the image of each of its nodes beyond the plane.
                let Some(inner) = grid.find(image) else { continue };
                let (own_outer, own_inner) = (grid.sums(outer), grid.sums(inner));
                folds.push(Fold { outer, inner, own_outer, own_inner, axis: plane.axis, collider });
                if beyond {
                    fold_onto(grid, outer, inner, plane.axis, gravity);
                } else {
                    let mut held = own_outer;
                    hold(&mut held, plane.axis, gravity);
                    grid.set_sums(outer, &held);
                }
            }
        }
    }
}

/// Adds the image of node `outer` to node `inner`. The image falls the other way: its weight less that of its mass where it
/// now lies is added to the force.
fn fold_onto<T: Real, const D: usize>(
    grid: &mut impl Nodes<T, D>,
    outer: usize,
    inner: usize,
    axis: usize,
    gravity: &Vector<T, D>,
) {
    let (own, mut sums) = (grid.sums(outer), grid.sums(inner));
    sums.mass += own.mass;
    sums.momentum += reflect(&own.momentum, axis);
    sums.force += reflect(&own.force, axis) + (reflect(gravity, axis) - gravity) * own.mass;
    grid.set_sums(inner, &sums);
    grid.set_sums(outer, &NodeSums::empty());
}

/// Takes momentum and force along `axis` from a node on the plane, its weight included.
fn hold<T: Real, const D: usize>(sums: &mut NodeSums<T, D>, axis: usize, gravity: &Vector<T, D>) {
    sums.momentum[axis] = T::zero();
    sums.force[axis] = -gravity[axis] * sums.mass;
}

/// Reflects the motion of folded nodes out again, restores their own sums, and books the mirror's impulse. `share` is the FLIP share a.
pub(crate) fn unfold<T: Real, const D: usize>(
    folds: &[Fold<T, D>],
    grid: &mut impl Nodes<T, D>,
    gravity: &Vector<T, D>,
    dt: T,
    share: T,
    ledger: &mut StepLedger<D>,
) {
    let still = Vector::zeros();
    let gain = |own: &NodeSums<T, D>, motion: &NodeMotion<T, D>, axis: usize| {
        unit::<T, D>(axis) * momentum_gain(own, motion, axis, dt * gravity[axis], dt, share)
    };
    for fold in folds.iter().rev() {
        let axis = fold.axis;
        if fold.outer == fold.inner {
            let mut motion = grid.motion(fold.inner);
            // Another obstacle may have pushed the node off the plane; the mirror takes that back.
            let pushed = unit::<T, D>(axis) * motion.velocity[axis];
            motion.velocity -= pushed;
            motion.change[axis] = T::zero();
            let taken = -pushed * fold.own_inner.mass;
            ledger.push(fold.collider, &taken, impulse_energy(&taken, &pushed, &still));
            ledger.push(fold.collider, &gain(&fold.own_inner, &motion, axis), 0.0);
            grid.set_motion(fold.inner, &motion);
        } else {
            let inner = grid.motion(fold.inner);
            let outer =
                NodeMotion { velocity: reflect(&inner.velocity, axis), change: reflect(&inner.change, axis) };
            grid.set_motion(fold.outer, &outer);
            // All that shares the inner node gains nothing together beyond its internal forces and gravity (and what other obstacles
            // book): what the image of the outer part gains, the rest loses. Seen from outside both gain the same.
            let outside = gain(&fold.own_outer, &outer, axis);
            ledger.push(fold.collider, &(outside + outside), 0.0);
        }
        grid.set_sums(fold.inner, &fold.own_inner);
        grid.set_sums(fold.outer, &fold.own_outer);
    }
}

/// Gives nodes the sums back that were theirs before they were folded.
pub(crate) fn restore_sums<T: Real, const D: usize>(folds: &[Fold<T, D>], grid: &mut impl Nodes<T, D>) {
    for fold in folds.iter().rev() {
        grid.set_sums(fold.inner, &fold.own_inner);
        grid.set_sums(fold.outer, &fold.own_outer);
    }
}

/// Sets a field of velocities beyond the planes to its mirror image, and its normal component on them to 0.
pub(crate) fn reflect_out<V, T: Real, const D: usize>(folds: &[Fold<T, D>], field: &mut [V])
where
    V: Copy + IndexMut<usize, Output = T>,
{
    for fold in folds.iter().rev() {
        if fold.outer == fold.inner {
            field[fold.inner][fold.axis] = T::zero();
        } else {
            field[fold.outer] = field[fold.inner];
            field[fold.outer][fold.axis] = -field[fold.inner][fold.axis];
        }
    }
}

/// Folds a field of forces onto the material's side: the transpose of [`reflect_out`].
pub(crate) fn fold_in<V, T: Real, const D: usize>(folds: &[Fold<T, D>], field: &mut [V])
where
    V: IndexMut<usize, Output = T>,
{
    for fold in folds {
        if fold.outer == fold.inner {
            field[fold.inner][fold.axis] = T::zero();
            continue;
        }
        for k in 0..D {
            let image = std::mem::replace(&mut field[fold.outer][k], T::zero());
            field[fold.inner][k] += if k == fold.axis { -image } else { image };
        }
    }
}

/// The nodes on planes, each with the axis along which it does not move.
pub(crate) fn nodes_on_planes<T: Real, const D: usize>(
    folds: &[Fold<T, D>],
) -> impl Iterator<Item = (usize, usize)> + '_ {
    folds.iter().filter(|fold| fold.outer == fold.inner).map(|fold| (fold.inner, fold.axis))
}

/// What the particles' momentum along `axis` gains through a node in a step, beyond internal forces and gravity. PIC and APIC hand back
/// m v^{n+1} for the momentum they gave; FLIP hands back m (v^{n+1} - v^n), where v^n is the folded one.
fn momentum_gain<T: Real, const D: usize>(
    own: &NodeSums<T, D>,
    motion: &NodeMotion<T, D>,
    axis: usize,
    fall: T,
    dt: T,
    share: T,
) -> T {
    let start = motion.velocity[axis] - motion.change[axis];
    let given = own.momentum[axis] * (T::one() - share) + start * own.mass * share;
    (motion.velocity[axis] - fall) * own.mass - given - own.force[axis] * dt
}

fn reflect<T: Real, const D: usize>(v: &Vector<T, D>, axis: usize) -> Vector<T, D> {
    let mut image = *v;
    image[axis] = -image[axis];
    image
}
