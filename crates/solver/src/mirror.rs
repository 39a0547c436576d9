//! Planes of symmetry on rows of nodes: what falls on nodes beyond the plane is folded back with its normal component
//! reversed, and the motion is reflected out again, so that the material sees its own mirror image.

use crate::collision::{Contact, MirrorPlane};
use crate::error::SceneError;
use crate::geometry::{Vector, unit};
use crate::grid::{Grid, NodeSums};
use crate::ledger::StepLedger;
use crate::real::Real;
use crate::scene::Scene;

/// A node on or beyond a mirror, the node it is folded onto (itself, on the plane), and the sums both had before.
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

/// Folds sums onto the material's side. Nodes beyond two planes go over one after the other.
pub(crate) fn fold<T: Real, const D: usize>(
    planes: &[(usize, MirrorPlane)],
    grid: &mut Grid<T, D>,
    folds: &mut Vec<Fold<T, D>>,
) {
    folds.clear();
    for &(collider, plane) in planes {
        for outer in 0..grid.node_count() {
            let mut image = grid.coordinates(outer);
            let depth = image[plane.axis] - plane.node;
            let beyond = if plane.material_above { depth <= 0 } else { depth >= 0 };
            if !beyond || grid.sums[outer].mass == T::zero() {
                continue;
            }
            image[plane.axis] = plane.node - depth;
            // A stencil that begins within the material holds the image of each of its nodes beyond the plane.
            let Some(inner) = grid.find(image) else { continue };
            let (own_outer, own_inner) = (grid.sums[outer], grid.sums[inner]);
            folds.push(Fold { outer, inner, own_outer, own_inner, axis: plane.axis, collider });
            let sums = &mut grid.sums[inner];
            sums.mass += own_outer.mass;
            sums.momentum += reflect(&own_outer.momentum, plane.axis);
            sums.force += reflect(&own_outer.force, plane.axis);
            if outer != inner {
                grid.sums[outer] = NodeSums::empty();
            }
        }
    }
}

/// Reflects the motion of folded nodes out again, restores their own sums, and books the mirror's impulse: what the
/// momentum of the nodes' own material gained beyond its internal forces and gravity.
pub(crate) fn unfold<T: Real, const D: usize>(
    folds: &[Fold<T, D>],
    grid: &mut Grid<T, D>,
    gravity: &Vector<T, D>,
    dt: T,
    ledger: &mut StepLedger<D>,
) {
    for fold in folds.iter().rev() {
        let inner = grid.motion[fold.inner];
        let image = |v: &Vector<T, D>| if fold.outer == fold.inner { *v } else { reflect(v, fold.axis) };
        grid.motion[fold.outer].velocity = image(&inner.velocity);
        grid.motion[fold.outer].change = image(&inner.change);
        let mut gain = balance(&fold.own_outer, &grid.motion[fold.outer].velocity, gravity, dt);
        if fold.outer != fold.inner {
            gain += balance(&fold.own_inner, &inner.velocity, gravity, dt);
        }
        // A mirror pushes along its normal only; what else the nodes gained came from other mirrors.
        ledger.push(
            fold.collider,
            &(unit::<T, D>(fold.axis) * gain[fold.axis]),
            &Vector::zeros(),
            &Vector::zeros(),
        );
        grid.sums[fold.inner] = fold.own_inner;
        grid.sums[fold.outer] = fold.own_outer;
    }
}

/// Momentum gained by a node's own material in a step beyond internal forces and gravity.
fn balance<T: Real, const D: usize>(
    own: &NodeSums<T, D>,
    velocity: &Vector<T, D>,
    gravity: &Vector<T, D>,
    dt: T,
) -> Vector<T, D> {
    velocity * own.mass - own.momentum - (own.force + gravity * own.mass) * dt
}

fn reflect<T: Real, const D: usize>(v: &Vector<T, D>, axis: usize) -> Vector<T, D> {
    let mut image = *v;
    image[axis] = -image[axis];
    image
}
