//! Stages 1, 2 and 7, block by block through a [`Tile`].

use super::lanes::{Array, HasWide, Lanes};
use super::tile::{Tile, add, places};
use super::weights::LaneKernel;
use crate::geometry::{Matrix, Vector};
use crate::grid::Grid;
use crate::kernel::MAX_SUPPORT;
use crate::particles::{ParticleConstants, ParticleMotion};
use crate::real::Real;
use crate::scene::Scene;
use crate::transfer::{Gathered, for_kernel_and_transfer};

/// A function on lanes as two: `$name` takes the widest that the CPU has.
macro_rules! for_widest {
    ($(#[$doc:meta])* fn $name:ident => $body:ident, $wide:ident ($($argument:ident: $kind:ty),*)) => {
        $(#[$doc])*
        fn $name<T: Real, K: LaneKernel, const D: usize, const AFFINE: bool, const MLS: bool>($($argument: $kind),*) {
            #[cfg(target_arch = "x86_64")]
            if std::arch::is_x86_feature_detected!("avx2") {
                // SAFETY: the CPU has what the function is compiled for.
                #[expect(unsafe_code, reason = "a function compiled for AVX2, called where AVX2 was found")]
                return unsafe { $wide::<T, K, D, AFFINE, MLS>($($argument),*) };
            }
            $body::<T, K, Array<T>, D, AFFINE, MLS>($($argument),*)
        }

        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = "avx2")]
        fn $wide<T: Real, K: LaneKernel, const D: usize, const AFFINE: bool, const MLS: bool>($($argument: $kind),*) {
            $body::<T, K, <T as HasWide>::Wide, D, AFFINE, MLS>($($argument),*)
        }
    };
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

/// The first half of stage 7: interpolated velocity, its change, its gradient, and C where the transfer keeps it.
pub(crate) fn grid_to_particles<T: Real, const D: usize>(
    scene: &Scene<T, D>,
    motion: &ParticleMotion<T, D>,
    grid: &Grid<T, D>,
    gathered: &mut Gathered<T, D>,
) {
    for_kernel_and_transfer!(scene, gather, motion, grid, gathered)
}

for_widest!(
    fn scatter => scatter_blocks, scatter_wide(
        motion: &ParticleMotion<T, D>,
        constants: &ParticleConstants<T>,
        stress: &[Matrix<T, D>],
        grid: &mut Grid<T, D>
    )
);
for_widest!(
    fn gather => gather_blocks, gather_wide(
        motion: &ParticleMotion<T, D>,
        grid: &Grid<T, D>,
        gathered: &mut Gathered<T, D>
    )
);

/// Weights, slopes [1/m] and moments [m] of one particle on one axis, four lanes each; as `Stencil` has them.
#[derive(Clone, Copy)]
struct Weights<V> {
    weight: V,
    slope: V,
    moment: V,
}

impl<V: Copy> Weights<V> {
    #[inline(always)]
    fn at<T: Real, K: LaneKernel, const AFFINE: bool, const MLS: bool>(
        x: T,
        spacing: T,
        per_spacing: T,
    ) -> Self
    where
        V: Lanes<T>,
    {
        let scaled = x * per_spacing;
        let (first, weight, slope) = K::weight_lanes::<T, V>(scaled);
        let moment = if AFFINE {
            let arm = (T::of_index(first) - scaled) * spacing;
            let node = [arm, arm + spacing, arm + (spacing + spacing), arm + (spacing + spacing + spacing)];
            weight.times(V::of(node))
        } else {
            weight
        };
        let slope = if MLS {
            moment.times(V::splat(T::of(K::INVERSE_INERTIA) * per_spacing * per_spacing))
        } else {
            slope.times(V::splat(per_spacing))
        };
        Weights { weight, slope, moment }
    }
}

/// What the axes but the last contribute to the rows: weights, slopes and moments as plain numbers.
type Across<T> = [[[T; MAX_SUPPORT]; 3]; 2];

#[inline(always)]
fn stencil<T: Real, K: LaneKernel, V: Lanes<T>, const D: usize, const AFFINE: bool, const MLS: bool>(
    x: &Vector<T, D>,
    spacing: T,
    per_spacing: T,
) -> (Across<T>, Weights<V>) {
    let mut across = [[[T::zero(); MAX_SUPPORT]; 3]; 2];
    for axis in 0..D - 1 {
        let weights = Weights::<V>::at::<T, K, AFFINE, MLS>(x[axis], spacing, per_spacing);
        weights.weight.store(&mut across[axis][0]);
        weights.slope.store(&mut across[axis][1]);
        if AFFINE {
            weights.moment.store(&mut across[axis][2]);
        }
    }
    (across, Weights::at::<T, K, AFFINE, MLS>(x[D - 1], spacing, per_spacing))
}

/// The offset of a row, its weight, and for each axis but the last the weight with that axis's replaced by its slope and by its moment.
#[inline(always)]
fn row<T: Real, K: LaneKernel, const D: usize>(
    across: &Across<T>,
    index: usize,
) -> ([usize; D], T, [T; 2], [T; 2]) {
    let mut offset = [0; D];
    if D == 2 {
        offset[0] = index;
        let [weight, slope, moment] = &across[0];
        return (offset, weight[index], [slope[index], T::zero()], [moment[index], T::zero()]);
    }
    let (i, j) = (index / K::SUPPORT, index % K::SUPPORT);
    (offset[0], offset[1]) = (i, j);
    let ([w0, s0, m0], [w1, s1, m1]) = (&across[0], &across[1]);
    (offset, w0[i] * w1[j], [s0[i] * w1[j], w0[i] * s1[j]], [m0[i] * w1[j], w0[i] * m1[j]])
}

const fn rows<K: LaneKernel, const D: usize>() -> usize {
    if D == 3 { K::SUPPORT * K::SUPPORT } else { K::SUPPORT }
}

#[inline(always)]
fn scatter_blocks<
    T: Real,
    K: LaneKernel,
    V: Lanes<T>,
    const D: usize,
    const AFFINE: bool,
    const MLS: bool,
>(
    motion: &ParticleMotion<T, D>,
    constants: &ParticleConstants<T>,
    stress: &[Matrix<T, D>],
    grid: &mut Grid<T, D>,
) {
    let mut tile = Tile::<T, D>::new();
    let (spacing, per_spacing) = (grid.spacing, T::one() / grid.spacing);
    let mut block = None;
    for p in 0..motion.len() {
        let (home, local) = grid.home(p);
        if block != Some(home) {
            if let Some(done) = block {
                tile.pour(grid, done);
            }
            block = Some(home);
        }
        let (across, last) = stencil::<T, K, V, D, AFFINE, MLS>(&motion.position[p], spacing, per_spacing);
        let mass = constants.mass[p];
        let carried_mass = last.weight.times(V::splat(mass));
        // For each component: momentum on the last axis's weights; spin and traction by axis, on them or on moments and slopes.
        let zero = V::splat(T::zero());
        let (mut momentum, mut spin, mut pull) = ([zero; D], [[zero; 2]; D], [[zero; 3]; D]);
        for i in 0..D {
            momentum[i] = last.weight.times(V::splat(motion.velocity[p][i] * mass));
            for k in 0..D - 1 {
                pull[i][k] = last.weight.times(V::splat(-stress[p][(i, k)]));
            }
            pull[i][2] = last.slope.times(V::splat(-stress[p][(i, D - 1)]));
            if AFFINE {
                for k in 0..D - 1 {
                    spin[i][k] = last.weight.times(V::splat(motion.affine[p][(i, k)] * mass));
                }
                let along = V::splat(motion.affine[p][(i, D - 1)] * mass);
                momentum[i] = momentum[i].plus_product(last.moment, along);
            }
        }
        for index in 0..rows::<K, D>() {
            let (offset, weight, slopes, moments) = row::<T, K, D>(&across, index);
            let nodes = tile.row(&local, &offset);
            let weight = V::splat(weight);
            add(&mut nodes[0], local[D - 1], carried_mass.times(weight));
            for i in 0..D {
                let mut carried = momentum[i].times(weight);
                let mut force = pull[i][2].times(weight);
                for k in 0..D - 1 {
                    force = force.plus_product(pull[i][k], V::splat(slopes[k]));
                    if AFFINE {
                        carried = carried.plus_product(spin[i][k], V::splat(moments[k]));
                    }
                }
                add(&mut nodes[1 + i], local[D - 1], carried);
                add(&mut nodes[1 + D + i], local[D - 1], force);
            }
        }
    }
    if let Some(done) = block {
        tile.pour(grid, done);
    }
}

#[inline(always)]
fn gather_blocks<T: Real, K: LaneKernel, V: Lanes<T>, const D: usize, const AFFINE: bool, const MLS: bool>(
    motion: &ParticleMotion<T, D>,
    grid: &Grid<T, D>,
    gathered: &mut Gathered<T, D>,
) {
    let mut tile = Tile::<T, D>::new();
    let (spacing, per_spacing) = (grid.spacing, T::one() / grid.spacing);
    let inverse_inertia = T::of(K::INVERSE_INERTIA) * per_spacing * per_spacing;
    let mut block = None;
    for p in 0..motion.len() {
        let (home, local) = grid.home(p);
        if block != Some(home) {
            tile.fill(grid, home);
            block = Some(home);
        }
        let (across, last) = stencil::<T, K, V, D, AFFINE, MLS>(&motion.position[p], spacing, per_spacing);
        // Sums over the rows, lane by lane: with the rows' weights, and with each axis's slopes and moments.
        let zero = V::splat(T::zero());
        let (mut velocity, mut change) = ([zero; D], [zero; D]);
        let (mut gradient, mut moment) = ([[zero; 2]; D], [[zero; 2]; D]);
        for index in 0..rows::<K, D>() {
            let (offset, weight, slopes, moments) = row::<T, K, D>(&across, index);
            let nodes = tile.row(&local, &offset);
            let weight = V::splat(weight);
            for i in 0..D {
                let v = V::load(places(&mut nodes[i], local[D - 1]));
                velocity[i] = velocity[i].plus_product(v, weight);
                for k in 0..D - 1 {
                    gradient[i][k] = gradient[i][k].plus_product(v, V::splat(slopes[k]));
                    if AFFINE {
                        moment[i][k] = moment[i][k].plus_product(v, V::splat(moments[k]));
                    }
                }
                if !AFFINE {
                    let dv = V::load(places(&mut nodes[D + i], local[D - 1]));
                    change[i] = change[i].plus_product(dv, weight);
                }
            }
        }
        for i in 0..D {
            gathered.velocity[p][i] = velocity[i].times(last.weight).sum();
            gathered.gradient[p][(i, D - 1)] = velocity[i].times(last.slope).sum();
            for k in 0..D - 1 {
                gathered.gradient[p][(i, k)] = gradient[i][k].times(last.weight).sum();
            }
            if AFFINE {
                gathered.affine[p][(i, D - 1)] = velocity[i].times(last.moment).sum() * inverse_inertia;
                for k in 0..D - 1 {
                    gathered.affine[p][(i, k)] = moment[i][k].times(last.weight).sum() * inverse_inertia;
                }
            } else {
                gathered.change[p][i] = change[i].times(last.weight).sum();
            }
        }
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::kernel::{Cubic, Quadratic};

    /// Some 500 particles with fields of all signs in a box of 12 cells, in no order.
    fn particles<T: Real, const D: usize>() -> (ParticleMotion<T, D>, ParticleConstants<T>, Vec<Matrix<T, D>>)
    {
        let mut seed = 1_u64;
        let mut number = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            T::of((seed >> 33) as f64 / f64::from(1_u32 << 31) * 2.0 - 1.0)
        };
        let mut motion = ParticleMotion {
            position: vec![],
            velocity: vec![],
            affine: vec![],
            deformation: vec![],
            plastic_ratio: vec![],
            stiffness: vec![],
            clamped: vec![],
        };
        let (mut constants, mut stress) = (
            ParticleConstants {
                mass: vec![],
                volume: vec![],
                stiffness_scale: vec![],
                material: vec![],
                id: vec![],
            },
            Vec::new(),
        );
        for _ in 0..500 {
            motion.position.push(Vector::from_fn(|_, _| number() * T::of(6.0)));
            motion.velocity.push(Vector::from_fn(|_, _| number()));
            motion.affine.push(Matrix::from_fn(|_, _| number()));
            constants.mass.push(number() + T::of(1.5));
            stress.push(Matrix::from_fn(|_, _| number()));
        }
        (motion, constants, stress)
    }

    fn check<T: Real, K: LaneKernel, const D: usize, const AFFINE: bool, const MLS: bool>() {
        let (motion, constants, stress) = particles::<T, D>();
        let mut grids = [(); 2].map(|()| {
            let mut grid = Grid::<T, D>::new(T::one());
            grid.activate(motion.position.iter().map(|x| x.map(K::first_node::<T>).into()));
            grid
        });
        scatter_blocks::<T, K, Array<T>, D, AFFINE, MLS>(&motion, &constants, &stress, &mut grids[0]);
        scatter::<T, K, D, AFFINE, MLS>(&motion, &constants, &stress, &mut grids[1]);
        let bits = |grid: &Grid<T, D>| format!("{:?}", grid.sums);
        assert!(bits(&grids[0]) == bits(&grids[1]), "sums on the grid differ");
        for index in 0..grids[0].node_count() {
            let (velocity, change) = (grids[0].sums[index].momentum, grids[0].sums[index].force);
            grids[0].motion[index] = crate::grid::NodeMotion { velocity, change };
        }
        let mut told = [(); 2].map(|()| Gathered::<T, D> {
            velocity: vec![],
            change: vec![],
            gradient: vec![],
            affine: vec![],
        });
        told.iter_mut().for_each(|told| told.resize(&motion));
        gather_blocks::<T, K, Array<T>, D, AFFINE, MLS>(&motion, &grids[0], &mut told[0]);
        gather::<T, K, D, AFFINE, MLS>(&motion, &grids[0], &mut told[1]);
        assert!(format!("{:?}", told[0]) == format!("{:?}", told[1]), "what particles are told differs");
    }

    fn check_transfers<T: Real, K: LaneKernel, const D: usize>() {
        check::<T, K, D, false, false>();
        check::<T, K, D, true, false>();
        check::<T, K, D, true, true>();
    }

    #[test]
    fn registers_and_arrays_give_the_same_bits() {
        let widest = if std::arch::is_x86_feature_detected!("avx2") {
            "AVX2"
        } else {
            "arrays alone: this CPU has no AVX2"
        };
        println!("compared with arrays: {widest}");
        check_transfers::<f64, Cubic, 2>();
        check_transfers::<f64, Quadratic, 2>();
        check_transfers::<f64, Cubic, 3>();
        check_transfers::<f64, Quadratic, 3>();
        check_transfers::<f32, Cubic, 2>();
        check_transfers::<f32, Quadratic, 2>();
        check_transfers::<f32, Cubic, 3>();
        check_transfers::<f32, Quadratic, 3>();
    }
}
