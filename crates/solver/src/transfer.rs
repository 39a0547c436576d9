//! Stages 1, 2 and 7: between particles and grid.

use crate::geometry::{Matrix, Vector};
use crate::grid::{Anchor, Grid};
use crate::kernel::{Cubic, Kernel, KernelKind, Quadratic};
use crate::particles::{ParticleConstants, ParticleMotion};
use crate::real::Real;
use crate::scene::Scene;
use crate::stencil::Stencil;

/// What the grid tells each particle at the end of a step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Gathered<T: Real, const D: usize> {
    /// sum w v_i^{n+1} [m/s].
    pub velocity: Vec<Vector<T, D>>,
    /// sum w (v_i^{n+1} - v_i^n) [m/s].
    pub change: Vec<Vector<T, D>>,
    /// grad v = sum v_i^{n+1} (grad w)^T [1/s].
    pub gradient: Vec<Matrix<T, D>>,
    /// C = sum w v_i^{n+1} (x_i - x_p)^T D^-1 [1/s]; empty without an affine transfer.
    pub affine: Vec<Matrix<T, D>>,
}

impl<T: Real, const D: usize> Gathered<T, D> {
    /// Makes room for what `motion`'s particles are told.
    pub(crate) fn resize(&mut self, motion: &ParticleMotion<T, D>) {
        self.velocity.resize(motion.len(), Vector::zeros());
        self.change.resize(motion.len(), Vector::zeros());
        self.gradient.resize(motion.len(), Matrix::zeros());
        self.affine.resize(motion.affine.len(), Matrix::zeros());
    }
}

/// A method generic over kernel and transfer, called with both as compile-time constants.
macro_rules! for_kernel_and_transfer {
    ($scene:expr, $function:ident, $($argument:expr),*) => {
        match ($scene.kernel, $scene.transfer) {
            ($crate::KernelKind::Cubic, $crate::Transfer::Flip(_)) => $function::<T, $crate::kernel::Cubic, D, false, false>($($argument),*),
            ($crate::KernelKind::Cubic, $crate::Transfer::Apic) => $function::<T, $crate::kernel::Cubic, D, true, false>($($argument),*),
            ($crate::KernelKind::Cubic, $crate::Transfer::Mls) => $function::<T, $crate::kernel::Cubic, D, true, true>($($argument),*),
            ($crate::KernelKind::Quadratic, $crate::Transfer::Flip(_)) => $function::<T, $crate::kernel::Quadratic, D, false, false>($($argument),*),
            ($crate::KernelKind::Quadratic, $crate::Transfer::Apic) => $function::<T, $crate::kernel::Quadratic, D, true, false>($($argument),*),
            ($crate::KernelKind::Quadratic, $crate::Transfer::Mls) => $function::<T, $crate::kernel::Quadratic, D, true, true>($($argument),*),
        }
    };
}

pub(crate) use for_kernel_and_transfer;

/// Stage 0 of a step: the nodes that particles reach.
pub(crate) fn place_stencils<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    motion: &ParticleMotion<T, D>,
    grid: &mut Grid<T, D>,
) {
    match scene.kernel {
        KernelKind::Cubic => grid.activate(first_nodes::<T, Cubic, D>(&motion.position, scene.spacing)),
        KernelKind::Quadratic => {
            grid.activate(first_nodes::<T, Quadratic, D>(&motion.position, scene.spacing))
        }
    }
}

/// The first node of every particle's stencil.
pub(crate) fn first_nodes_of<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    positions: &[Vector<T, D>],
) -> Vec<[i32; D]> {
    match scene.kernel {
        KernelKind::Cubic => first_nodes::<T, Cubic, D>(positions, scene.spacing).collect(),
        KernelKind::Quadratic => first_nodes::<T, Quadratic, D>(positions, scene.spacing).collect(),
    }
}

/// The first node of the stencil at `x` [m].
pub(crate) fn first_node<T: Real, const D: usize>(
    kernel: KernelKind,
    x: &Vector<T, D>,
    per_spacing: T,
) -> [i32; D] {
    let mut first = [0; D];
    for axis in 0..D {
        let x = x[axis] * per_spacing;
        first[axis] = match kernel {
            KernelKind::Cubic => Cubic::first_node(x),
            KernelKind::Quadratic => Quadratic::first_node(x),
        };
    }
    first
}

fn first_nodes<T: Real, K: Kernel, const D: usize>(
    positions: &[Vector<T, D>],
    spacing: T,
) -> impl Iterator<Item = [i32; D]> + '_ {
    let per_spacing = T::one() / spacing;
    positions.iter().map(move |x| {
        let mut first = [0; D];
        for axis in 0..D {
            first[axis] = K::first_node(x[axis] * per_spacing);
        }
        first
    })
}

/// Stages 1 and 2: mass, momentum and internal force of every node. `stress` holds V_p tau_p [J].
pub(crate) fn particles_to_grid<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    motion: &ParticleMotion<T, D>,
    constants: &ParticleConstants<T>,
    stress: &[Matrix<T, D>],
    grid: &mut Grid<T, D>,
) {
    for_kernel_and_transfer!(scene, scatter, motion, constants, stress, grid)
}

fn scatter<T: Real, K: Kernel, const D: usize, const AFFINE: bool, const MLS: bool>(
    motion: &ParticleMotion<T, D>,
    constants: &ParticleConstants<T>,
    stress: &[Matrix<T, D>],
    grid: &mut Grid<T, D>,
) {
    let per_spacing = T::one() / grid.spacing;
    for p in 0..motion.len() {
        let stencil = Stencil::<T, D>::with::<K, AFFINE, MLS>(&motion.position[p], grid.spacing, per_spacing);
        let anchor: Anchor<D> = grid.anchor(p);
        let mass = constants.mass[p];
        let momentum = motion.velocity[p] * mass;
        let spin = if AFFINE { motion.affine[p] * mass } else { Matrix::zeros() };
        let traction = -stress[p];
        for index in 0..Stencil::<T, D>::rows::<K>() {
            let row = stencil.row::<K>(index);
            let first = anchor.row(&row.offset);
            let nodes = &mut grid.sums[first..first + K::SUPPORT];
            let row_mass = mass * row.weight;
            let mut row_momentum = momentum * row.weight;
            let mut row_force = traction.column(0) * row.gradient[0];
            for k in 1..D - 1 {
                row_force += traction.column(k) * row.gradient[k];
            }
            let row_force_slope = traction.column(D - 1) * row.gradient[D - 1];
            if AFFINE {
                for k in 0..D - 1 {
                    row_momentum += spin.column(k) * row.moment[k];
                }
            }
            let row_spin = spin.column(D - 1) * row.weight;
            for k in 0..K::SUPPORT {
                let (weight, slope) = (stencil.weight[D - 1][k], stencil.slope[D - 1][k]);
                let node = &mut nodes[k];
                node.mass += row_mass * weight;
                node.momentum += row_momentum * weight;
                if AFFINE {
                    node.momentum += row_spin * stencil.moment[D - 1][k];
                }
                node.force += row_force * weight + row_force_slope * slope;
            }
        }
    }
}

/// Adds the particles' own forces m_p a_p to their nodes; nothing where there are none.
pub(crate) fn add_body_forces<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    motion: &ParticleMotion<T, D>,
    constants: &ParticleConstants<T>,
    acceleration: &[Vector<T, D>],
    grid: &mut Grid<T, D>,
) {
    match scene.kernel {
        KernelKind::Cubic => scatter_forces::<T, Cubic, D>(motion, constants, acceleration, grid),
        KernelKind::Quadratic => scatter_forces::<T, Quadratic, D>(motion, constants, acceleration, grid),
    }
}

fn scatter_forces<T: Real, K: Kernel, const D: usize>(
    motion: &ParticleMotion<T, D>,
    constants: &ParticleConstants<T>,
    acceleration: &[Vector<T, D>],
    grid: &mut Grid<T, D>,
) {
    let per_spacing = T::one() / grid.spacing;
    for (p, acceleration) in acceleration.iter().enumerate() {
        let stencil =
            Stencil::<T, D>::with::<K, false, false>(&motion.position[p], grid.spacing, per_spacing);
        let anchor: Anchor<D> = grid.anchor(p);
        let force = acceleration * constants.mass[p];
        for index in 0..Stencil::<T, D>::rows::<K>() {
            let row = stencil.row::<K>(index);
            let first = anchor.row(&row.offset);
            for (k, node) in grid.sums[first..first + K::SUPPORT].iter_mut().enumerate() {
                node.force += force * (row.weight * stencil.weight[D - 1][k]);
            }
        }
    }
}

/// The first half of stage 7: interpolated velocity, its change, its gradient, and C where the transfer keeps it.
pub(crate) fn grid_to_particles<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    motion: &ParticleMotion<T, D>,
    grid: &Grid<T, D>,
    gathered: &mut Gathered<T, D>,
) {
    gathered.resize(motion);
    for_kernel_and_transfer!(scene, gather, motion, grid, gathered)
}

fn gather<T: Real, K: Kernel, const D: usize, const AFFINE: bool, const MLS: bool>(
    motion: &ParticleMotion<T, D>,
    grid: &Grid<T, D>,
    gathered: &mut Gathered<T, D>,
) {
    let per_spacing = T::one() / grid.spacing;
    let inverse_inertia = T::of(K::INVERSE_INERTIA) * per_spacing * per_spacing;
    for p in 0..motion.len() {
        let stencil = Stencil::<T, D>::with::<K, AFFINE, MLS>(&motion.position[p], grid.spacing, per_spacing);
        let anchor: Anchor<D> = grid.anchor(p);
        let mut velocity = Vector::<T, D>::zeros();
        let mut change = Vector::<T, D>::zeros();
        let mut gradient = Matrix::<T, D>::zeros();
        let mut moment = Matrix::<T, D>::zeros();
        for index in 0..Stencil::<T, D>::rows::<K>() {
            let row = stencil.row::<K>(index);
            let first = anchor.row(&row.offset);
            let nodes = &grid.motion[first..first + K::SUPPORT];
            let mut row_velocity = Vector::<T, D>::zeros();
            let mut row_change = Vector::<T, D>::zeros();
            let mut row_slope = Vector::<T, D>::zeros();
            let mut row_moment = Vector::<T, D>::zeros();
            for k in 0..K::SUPPORT {
                let node = &nodes[k];
                row_velocity += node.velocity * stencil.weight[D - 1][k];
                row_slope += node.velocity * stencil.slope[D - 1][k];
                if AFFINE {
                    row_moment += node.velocity * stencil.moment[D - 1][k];
                } else {
                    row_change += node.change * stencil.weight[D - 1][k];
                }
            }
            velocity += row_velocity * row.weight;
            change += row_change * row.weight;
            for k in 0..D {
                let (along, across) =
                    if k == D - 1 { (&row_slope, &row_moment) } else { (&row_velocity, &row_velocity) };
                for i in 0..D {
                    gradient[(i, k)] += along[i] * row.gradient[k];
                    if AFFINE {
                        moment[(i, k)] += across[i] * row.moment[k];
                    }
                }
            }
        }
        gathered.velocity[p] = velocity;
        gathered.change[p] = change;
        gathered.gradient[p] = gradient;
        if AFFINE {
            gathered.affine[p] = moment * inverse_inertia;
        }
    }
}

/// The second half of stage 7: the velocity a particle keeps. `share` is the FLIP share a of this step.
pub(crate) fn transfer_velocity<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    motion: &ParticleMotion<T, D>,
    gathered: &Gathered<T, D>,
    share: T,
    next: &mut ParticleMotion<T, D>,
) {
    if scene.transfer.keeps_affine() {
        next.velocity.copy_from_slice(&gathered.velocity);
        next.affine.copy_from_slice(&gathered.affine);
        return;
    }
    for p in 0..motion.len() {
        let flip = motion.velocity[p] + gathered.change[p];
        next.velocity[p] = gathered.velocity[p] * (T::one() - share) + flip * share;
    }
}
