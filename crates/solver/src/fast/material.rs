//! Materials in the form that chunks of particles want.

use super::particles::Label;
use super::simd::{CHUNK, Lanes};
use super::strain::{Moduli, YieldSurface};
use crate::material::{ConstitutiveModel, Lame, Material};
use crate::real::Real;

/// What a chunk's particles are made of, lane by lane.
#[derive(Clone, Debug)]
pub(super) struct ChunkMaterial<T> {
    pub mu: [T; CHUNK],
    pub lambda: [T; CHUNK],
    /// 2 mu + D lambda.
    pub wave_modulus: [T; CHUNK],
    least: [T; CHUNK],
    greatest: [T; CHUNK],
    hardening: [T; CHUNK],
    ratio: [[T; CHUNK]; 2],
    limit: [T; CHUNK],
    /// Bits of the lanes that can flow, and of those whose modulus grows with stretch.
    pub flows: u32,
    pub stiffens: u32,
}

/// A material's numbers in the form that chunks want.
#[derive(Clone, Debug)]
pub(super) struct MaterialNumbers<T> {
    /// A chunk of nothing else.
    whole: ChunkMaterial<T>,
    lame: Lame<T>,
    wave_modulus: T,
    surface: [T; 6],
    flows: bool,
    stiffens: bool,
}

impl<T: Real> MaterialNumbers<T> {
    pub fn of<const D: usize>(material: &Material<T>) -> Self {
        let lame = ConstitutiveModel::<T, D>::lame(material);
        let (surface, flows, stiffens) = match material {
            Material::Snow(snow) => {
                let (lower, upper) = snow.plastic_ratio_bounds;
                // Infinite bounds are the greatest number here.
                let finite = |bound: T| bound.min(T::max_value().unwrap_or(bound));
                let (least, greatest) = (-snow.critical_compression, snow.critical_stretch);
                let surface =
                    [least, greatest, snow.hardening, lower, finite(upper), finite(snow.hardening_limit)];
                (surface, true, !snow.stretch_is_covered())
            }
            Material::Elastic(_) => ([T::zero(); 6], false, true),
        };
        let (wave_modulus, whole) = (lame.wave_modulus::<D>(), ChunkMaterial::nothing());
        let mut numbers = MaterialNumbers { whole, lame, wave_modulus, surface, flows, stiffens };
        let mut whole = ChunkMaterial::nothing();
        (0..CHUNK).for_each(|lane| whole.put(lane, &numbers));
        numbers.whole = whole;
        numbers
    }
}

impl<T: Real> ChunkMaterial<T> {
    fn nothing() -> Self {
        let zero = [T::zero(); CHUNK];
        ChunkMaterial {
            mu: zero,
            lambda: zero,
            wave_modulus: zero,
            least: zero,
            greatest: zero,
            hardening: zero,
            ratio: [zero; 2],
            limit: zero,
            flows: 0,
            stiffens: 0,
        }
    }

    fn put(&mut self, lane: usize, material: &MaterialNumbers<T>) {
        (self.mu[lane], self.lambda[lane]) = (material.lame.mu, material.lame.lambda);
        self.wave_modulus[lane] = material.wave_modulus;
        let [least, greatest, hardening, lower, upper, limit] = material.surface;
        (self.least[lane], self.greatest[lane], self.hardening[lane]) = (least, greatest, hardening);
        (self.ratio[0][lane], self.ratio[1][lane], self.limit[lane]) = (lower, upper, limit);
        self.flows |= u32::from(material.flows) << lane;
        self.stiffens |= u32::from(material.stiffens) << lane;
    }

    /// Of the particles with `labels`; `mixed` has room for one that has to be put together.
    #[inline(always)]
    pub fn of<'a>(
        labels: &[Label; CHUNK],
        materials: &'a [MaterialNumbers<T>],
        mixed: &'a mut Option<Self>,
    ) -> &'a Self {
        let first = labels[0].material;
        if materials.len() == 1 || labels.iter().all(|label| label.material == first) {
            return &materials[first as usize].whole;
        }
        mixed.insert(Self::mix(labels, materials))
    }

    #[inline(never)]
    fn mix(labels: &[Label; CHUNK], materials: &[MaterialNumbers<T>]) -> Self {
        let mut chunk = Self::nothing();
        for (lane, label) in labels.iter().enumerate() {
            chunk.put(lane, &materials[label.material as usize]);
        }
        chunk
    }

    #[inline(always)]
    pub fn moduli<V: Lanes<T>>(&self, lane: usize) -> Moduli<V> {
        Moduli { mu: V::load(&self.mu[lane..]), lambda: V::load(&self.lambda[lane..]) }
    }

    #[inline(always)]
    pub fn surface<V: Lanes<T>>(&self, lane: usize) -> YieldSurface<V> {
        YieldSurface {
            least: V::load(&self.least[lane..]),
            greatest: V::load(&self.greatest[lane..]),
            hardening: V::load(&self.hardening[lane..]),
            ratio: [V::load(&self.ratio[0][lane..]), V::load(&self.ratio[1][lane..])],
            limit: V::load(&self.limit[lane..]),
        }
    }
}
