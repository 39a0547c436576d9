//! The Hessian of the grid's elastic energy, without a matrix: H u = sum_p V_p dP(F_E; grad u_p F_E) F_E^T grad w_p.

use crate::geometry::{Matrix, Vector};
use crate::grid::{Anchor, Grid};
use crate::kernel::Kernel;
use crate::material::Tangent;
use crate::particles::ParticleMotion;
use crate::real::Real;
use crate::scene::Scene;
use crate::stencil::Stencil;
use crate::transfer::for_kernel_and_transfer;

/// `out` = H u at every node, for the tangents (times V_p) of all particles [J/m^2 times u].
pub(crate) fn apply_hessian<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    motion: &ParticleMotion<T, D>,
    tangents: &[Tangent<T, D>],
    grid: &Grid<T, D>,
    u: &[Vector<T, D>],
    out: &mut [Vector<T, D>],
) {
    out.fill(Vector::zeros());
    for_kernel_and_transfer!(scene, apply, motion, tangents, grid, u, out)
}

fn apply<T: Real, K: Kernel, const D: usize, const AFFINE: bool, const MLS: bool>(
    motion: &ParticleMotion<T, D>,
    tangents: &[Tangent<T, D>],
    grid: &Grid<T, D>,
    u: &[Vector<T, D>],
    out: &mut [Vector<T, D>],
) {
    let per_spacing = T::one() / grid.spacing;
    for (p, tangent) in tangents.iter().enumerate() {
        let stencil = Stencil::<T, D>::with::<K, MLS, MLS>(&motion.position[p], grid.spacing, per_spacing);
        let anchor: Anchor<D> = grid.anchor(p);
        let f = &motion.deformation[p];
        let change = tangent.differential(&(gradient::<T, K, D>(&stencil, &anchor, u) * f)) * f.transpose();
        for index in 0..Stencil::<T, D>::rows::<K>() {
            let row = stencil.row::<K>(index);
            let first = anchor.row(&row.offset);
            let mut across = Vector::<T, D>::zeros();
            for k in 0..D - 1 {
                across += change.column(k) * row.gradient[k];
            }
            let along = change.column(D - 1) * row.gradient[D - 1];
            for k in 0..K::SUPPORT {
                out[first + k] += across * stencil.weight[D - 1][k] + along * stencil.slope[D - 1][k];
            }
        }
    }
}

/// sum u_i (grad w_i)^T.
#[inline(always)]
fn gradient<T: Real, K: Kernel, const D: usize>(
    stencil: &Stencil<T, D>,
    anchor: &Anchor<D>,
    u: &[Vector<T, D>],
) -> Matrix<T, D> {
    let mut gradient = Matrix::<T, D>::zeros();
    for index in 0..Stencil::<T, D>::rows::<K>() {
        let row = stencil.row::<K>(index);
        let first = anchor.row(&row.offset);
        let (mut value, mut slope) = (Vector::<T, D>::zeros(), Vector::<T, D>::zeros());
        for k in 0..K::SUPPORT {
            value += u[first + k] * stencil.weight[D - 1][k];
            slope += u[first + k] * stencil.slope[D - 1][k];
        }
        for k in 0..D {
            let along = if k == D - 1 { &slope } else { &value };
            for i in 0..D {
                gradient[(i, k)] += along[i] * row.gradient[k];
            }
        }
    }
    gradient
}
