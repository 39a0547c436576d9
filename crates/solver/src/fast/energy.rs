//! What the watchdog asks of the particles: their elastic and potential energy.

use super::material::{ChunkMaterial, MaterialNumbers};
use super::particles::{Label, Layout, load_matrix};
use super::simd::{CHUNK, InstructionSet, Lanes};
use super::strain::energy_density;
use crate::geometry::Vector;
use crate::real::Real;
use crate::watchdog::StoredEnergy;

/// sum V_p Psi_p, and - sum m g . x with x from `origin`, the world's from the local one, of some chunks' particles [J].
#[inline(always)]
pub(super) fn stored_energy<I: InstructionSet<T>, T: Real, const D: usize>(
    fields: &[[T; CHUNK]],
    labels: &[[Label; CHUNK]],
    layout: Layout<D>,
    materials: &[MaterialNumbers<T>],
    gravity: &Vector<T, D>,
    origin: &Vector<f64, D>,
) -> StoredEnergy {
    let mut total = StoredEnergy::default();
    let fall = gravity.map(|g| g.as_f64()).dot(origin);
    for (chunk, labels) in fields.chunks_exact(layout.fields()).zip(labels) {
        let mut mixed = None;
        let material = ChunkMaterial::of(labels, materials, &mut mixed);
        let (mut elastic, mut potential) = ([T::zero(); CHUNK], [T::zero(); CHUNK]);
        let mut lane = 0;
        while lane < CHUNK {
            let load = |field: usize| &chunk[field][lane..];
            let strain = load_matrix::<T, I::Lanes, D>(chunk, Layout::<D>::STRAIN, lane);
            let density = energy_density::<T, I::Lanes, D>(&strain, &material.moduli(lane));
            let volume =
                I::Lanes::load(load(Layout::<D>::VOLUME)) * I::Lanes::load(load(Layout::<D>::STIFFNESS));
            let mut height = I::Lanes::splat(T::zero());
            for k in 0..D {
                let x = I::Lanes::load(load(Layout::<D>::POSITION + k));
                height = x.mul_add(I::Lanes::splat(gravity[k]), height);
            }
            let mass = I::Lanes::load(load(Layout::<D>::MASS));
            (density * volume).store(&mut elastic[lane..]);
            (-height * mass).store(&mut potential[lane..]);
            lane += I::Lanes::COUNT;
        }
        for lane in 0..CHUNK {
            let mass = chunk[Layout::<D>::MASS][lane].as_f64();
            total.elastic += elastic[lane].as_f64();
            total.potential += potential[lane].as_f64() - mass * fall;
        }
    }
    total
}
