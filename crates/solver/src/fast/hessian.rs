//! The Hessian of the grid's elastic energy for the particles of a block: what `../implicit/operator.rs` does, 16 particles at a time.
//!
//! With F_E = V R and u's gradient G, a particle answers by T = dP(G F_E) F_E^T. In the axes U of V, where V = diag(s), G' = U^T G U and T'
//! likewise, the tangent of `../material/tangent.rs` is
//!
//! ```text
//! T'_ii = sum_j s_i s_j A_ij G'_jj
//! T'_ij = s_j^2 (flip + twist) / 2 G'_ij + s_i s_j (flip - twist) / 2 G'_ji
//! ```
//!
//! so that neither R nor a singular value decomposition is needed: the numbers of U, of s s^T A and of each pair of axes are kept over the solve.

use super::batch::{BATCH, Next, Scratch, weigh};
use super::gather::{TOLD_FIRST, TOLD_VELOCITY, Told, gather_batch};
use super::material::{ChunkMaterial, MaterialNumbers};
use super::particles::{Block, Label, Layout, Particles, load_matrix, store_matrix};
use super::scatter::{MOMENT, OWN_FORCE, SLOPE, scatter_batch};
use super::simd::{CHANNELS, CHUNK, InstructionSet, Lanes};
use super::strain::{Matrix, Spectrum, left_strain, recompose, root_less_one, spectrum, volume_change};
use super::weights::LaneKernel;
use crate::material::LEAST_SUM_OF_STRETCHES;
use crate::real::Real;

/// Fields of a chunk's tangents: U, row by row; s s^T A, row by row; the three numbers of each pair.
pub(super) const fn tangent_fields<const D: usize>() -> usize {
    2 * D * D + 3 * pairs::<D>()
}

const fn pairs<const D: usize>() -> usize {
    D * (D - 1) / 2
}

/// Axes i < j of pair number `pair`, and the third axis (none in 2D).
#[inline(always)]
fn axes<const D: usize>(pair: usize) -> (usize, usize, usize) {
    if D == 2 { (0, 1, 2) } else { [(0, 1, 2), (0, 2, 1), (1, 2, 0)][pair] }
}

/// What the tangents of a step have in common.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linearisation<T> {
    /// The square of what makes a gradient from sums with slopes, or moments, in units of the spacing [1/m^2].
    pub per_spacing_squared: T,
    /// Whether negative eigenvalues count as 0.
    pub definite: bool,
}

/// The tangents of the particles of some chunks, times V_p.
#[inline(always)]
pub(super) fn linearise<I: InstructionSet<T>, T: Real, const D: usize>(
    fields: &[[T; CHUNK]],
    labels: &[[Label; CHUNK]],
    layout: Layout<D>,
    materials: &[MaterialNumbers<T>],
    how: &Linearisation<T>,
    tangents: &mut [[T; CHUNK]],
) {
    let chunks = fields.chunks_exact(layout.fields()).zip(labels);
    for ((chunk, labels), tangents) in chunks.zip(tangents.chunks_exact_mut(tangent_fields::<D>())) {
        let mut mixed = None;
        let material = ChunkMaterial::of(labels, materials, &mut mixed);
        let mut lane = 0;
        while lane < CHUNK {
            linearise_lanes::<I::Lanes, T, D>(chunk, lane, material, how, tangents);
            lane += I::Lanes::COUNT;
        }
    }
}

#[inline(always)]
fn linearise_lanes<V: Lanes<T>, T: Real, const D: usize>(
    chunk: &[[T; CHUNK]],
    lane: usize,
    material: &ChunkMaterial<T>,
    how: &Linearisation<T>,
    tangents: &mut [[T; CHUNK]],
) {
    let number = |x: f64| V::splat(T::of(x));
    let (zero, one, half) = (number(0.0), number(1.0), number(0.5));
    let h = load_matrix::<T, V, D>(chunk, Layout::<D>::STRAIN, lane);
    let Spectrum { values, vectors } = spectrum::<T, V, D>(&left_strain::<T, V, D>(&h));
    let moduli = material.moduli::<V>(lane);
    let scale = V::load(&chunk[Layout::<D>::VOLUME][lane..])
        * V::load(&chunk[Layout::<D>::STIFFNESS][lane..])
        * V::splat(how.per_spacing_squared);
    let (two_mu, lambda) = ((moduli.mu + moduli.mu) * scale, moduli.lambda * scale);
    let change = volume_change::<T, V, D>(&h);
    let volume = one + change;
    let pressure = lambda * change;
    let (mut strain, mut stretch) = (values, values);
    for i in 0..D {
        strain[i] = root_less_one::<T, V>(values[i]);
        stretch[i] = one + strain[i];
    }
    // A without definiteness, times s s^T: 2 mu s_i^2 + lambda J^2, and lambda J^2 + lambda (J - 1) J beside the diagonal.
    let mut diagonal = vectors;
    for i in 0..D {
        for j in 0..D {
            let shared = lambda * volume * volume;
            diagonal[i][j] = if i == j {
                (two_mu * stretch[i]).mul_add(stretch[i], shared)
            } else {
                pressure.mul_add(volume, shared)
            };
        }
    }
    if how.definite {
        let mut a = diagonal;
        for i in 0..D {
            for j in 0..D {
                a[i][j] = diagonal[i][j] / (stretch[i] * stretch[j]);
            }
        }
        let Spectrum { values: mut eigenvalues, vectors: axes } = spectrum::<T, V, D>(&a);
        for value in &mut eigenvalues {
            *value = value.max(zero);
        }
        let a = recompose::<T, V, D>(&axes, &eigenvalues);
        for i in 0..D {
            for j in 0..D {
                diagonal[i][j] = a[i][j] * (stretch[i] * stretch[j]);
            }
        }
    }
    store_matrix(&vectors, tangents, 0, lane);
    store_matrix(&diagonal, tangents, D * D, lane);
    for pair in 0..pairs::<D>() {
        let (i, j, k) = axes::<D>(pair);
        let third = if D == 2 { pressure } else { pressure * stretch[k.min(D - 1)] };
        // The sum of the stretches less 2, held as in the plain tangent.
        let both = (strain[i] + strain[j]).max(number(LEAST_SUM_OF_STRETCHES - 2.0));
        let (mut flip, mut twist) = (two_mu - third, two_mu * (both / (one + one + both)) + third);
        if how.definite {
            (flip, twist) = (flip.max(zero), twist.max(zero));
        }
        let (sum, difference) = ((flip + twist) * half, (flip - twist) * half);
        let first = 2 * D * D + 3 * pair;
        (stretch[j] * stretch[j] * sum).store(&mut tangents[first][lane..]);
        (stretch[i] * stretch[j] * difference).store(&mut tangents[first + 1][lane..]);
        (stretch[i] * stretch[i] * sum).store(&mut tangents[first + 2][lane..]);
    }
}

/// T of G for some particles side by side.
#[inline(always)]
fn respond<T: Real, V: Lanes<T>, const D: usize>(
    tangents: &[[T; CHUNK]],
    lane: usize,
    g: &Matrix<V, D>,
) -> Matrix<V, D> {
    let u = load_matrix::<T, V, D>(tangents, 0, lane);
    let diagonal = load_matrix::<T, V, D>(tangents, D * D, lane);
    let zero = V::splat(T::zero());
    // U^T G U.
    let (mut gu, mut turned) = ([[zero; D]; D], [[zero; D]; D]);
    for i in 0..D {
        for j in 0..D {
            for k in 0..D {
                gu[i][j] = g[i][k].mul_add(u[k][j], gu[i][j]);
            }
        }
    }
    for i in 0..D {
        for j in 0..D {
            for k in 0..D {
                turned[i][j] = u[k][i].mul_add(gu[k][j], turned[i][j]);
            }
        }
    }
    let mut t = [[zero; D]; D];
    for i in 0..D {
        for j in 0..D {
            t[i][i] = diagonal[i][j].mul_add(turned[j][j], t[i][i]);
        }
    }
    for pair in 0..pairs::<D>() {
        let (i, j, _) = axes::<D>(pair);
        let first = 2 * D * D + 3 * pair;
        let own = V::load(&tangents[first][lane..]);
        let other = V::load(&tangents[first + 1][lane..]);
        let back = V::load(&tangents[first + 2][lane..]);
        t[i][j] = own.mul_add(turned[i][j], other * turned[j][i]);
        t[j][i] = back.mul_add(turned[j][i], other * turned[i][j]);
    }
    // U T' U^T.
    let (mut ut, mut out) = ([[zero; D]; D], [[zero; D]; D]);
    for i in 0..D {
        for j in 0..D {
            for k in 0..D {
                ut[i][j] = u[i][k].mul_add(t[k][j], ut[i][j]);
            }
        }
    }
    for i in 0..D {
        for j in 0..D {
            for k in 0..D {
                out[i][j] = ut[i][k].mul_add(u[j][k], out[i][j]);
            }
        }
    }
    out
}

/// The block's share of H u: u is in the tile, and what it adds to the nodes goes to the second tile.
#[inline(always)]
pub(super) fn hessian_block<
    I: InstructionSet<T>,
    T: Real,
    K: LaneKernel,
    const D: usize,
    const MOMENTS: bool,
    const SLOPES: bool,
>(
    particles: &Particles<T, D>,
    tangents: &[[T; CHUNK]],
    block: &Block<D>,
    per_spacing: T,
    scratch: &mut Scratch<T>,
) {
    let (stride, width) = (particles.layout.fields(), tangent_fields::<D>());
    let Scratch { tile, second_tile, batch } = scratch;
    second_tile.fill(T::zero());
    let nothing = [I::Lanes::splat(T::zero()); CHANNELS];
    let mut done = 0;
    while done < block.particles {
        let count = (block.particles - done).min(BATCH);
        let first = block.first_chunk + done / CHUNK;
        let chunks = first..first + count.div_ceil(CHUNK);
        let lanes = chunks.len() * CHUNK;
        let fields = &particles.fields[chunks.start * stride..chunks.end * stride];
        let tangents = &tangents[chunks.start * width..chunks.end * width];
        weigh::<I, T, K, D, MOMENTS, SLOPES>(batch, block, fields, stride, per_spacing);
        gather_batch::<I, T, K, D, MOMENTS, SLOPES>(batch, lanes, TOLD_VELOCITY, tile, Next::NOTHING);
        for (number, tangents) in tangents.chunks_exact(width).enumerate() {
            let mut lane = 0;
            while lane < CHUNK {
                let p = number * CHUNK + lane;
                let one = I::Lanes::splat(T::one());
                let gradient = Told::from(batch, p).matrix::<I::Lanes, D>(TOLD_FIRST, one);
                let answer = respond::<T, I::Lanes, D>(tangents, lane, &gradient);
                let given = &mut batch.channels.as_flattened_mut()[p * super::batch::GIVEN..];
                I::Lanes::store_channels(nothing, &mut given[OWN_FORCE * CHANNELS..], super::batch::GIVEN);
                for k in 0..D {
                    let mut column = nothing;
                    for i in 0..D {
                        column[i] = answer[i][k];
                    }
                    let place = &mut given[(SLOPE + k) * CHANNELS..];
                    I::Lanes::store_channels(column, place, super::batch::GIVEN);
                }
                lane += I::Lanes::COUNT;
            }
        }
        let groups = if SLOPES { [OWN_FORCE, MOMENT, SLOPE] } else { [OWN_FORCE, SLOPE, SLOPE] };
        scatter_batch::<I, T, K, D, MOMENTS, SLOPES>(batch, count, groups, second_tile, Next::NOTHING);
        done += count;
    }
}
