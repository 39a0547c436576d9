//! The particles as the fast engine keeps them: by blocks of the grid, each block in chunks of 16, each chunk field by field. What fills
//! up the last chunk of a block has neither mass nor volume.

use serde::{Deserialize, Serialize};

use super::simd::{CHUNK, Lanes};
use super::strain::Matrix as LaneMatrix;
use crate::geometry::{Matrix, Vector};
use crate::particles::{ParticleConstants, ParticleMotion};
use crate::real::Real;
use crate::scene::Scene;
use crate::state::State;

/// Where the fields of a chunk begin, in units of [`CHUNK`] numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Layout<const D: usize> {
    affine: bool,
    forced: bool,
}

impl<const D: usize> Layout<D> {
    /// x [m].
    pub const POSITION: usize = 0;
    /// v [m/s].
    pub const VELOCITY: usize = D;
    /// F_E - I, row by row.
    pub const STRAIN: usize = 2 * D;
    /// J_P.
    pub const RATIO: usize = 2 * D + D * D;
    /// Factor on the Lame parameters.
    pub const STIFFNESS: usize = Self::RATIO + 1;
    pub const MASS: usize = Self::RATIO + 2;
    pub const VOLUME: usize = Self::RATIO + 3;
    /// The particle's own part of the stiffness factor.
    pub const SCALE: usize = Self::RATIO + 4;
    /// C [1/s], row by row, where the transfer has it.
    pub const AFFINE: usize = Self::RATIO + 5;

    /// Acceleration by a force of its own, where there is any.
    pub fn force(self) -> usize {
        Self::AFFINE + if self.affine { D * D } else { 0 }
    }

    /// Fields of a chunk.
    pub fn fields(self) -> usize {
        self.force() + if self.forced { D } else { 0 }
    }

    /// Whether there are forces of their own.
    pub fn forced(self) -> bool {
        self.forced
    }
}

/// Coordinates as a list: arrays of any length are not known to serde.
mod integers {
    use serde::de::Error;
    use serde::{Deserialize, Deserializer, Serializer};

    pub fn serialize<S: Serializer, const D: usize>(values: &[i32; D], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(values)
    }

    pub fn deserialize<'de, F: Deserializer<'de>, const D: usize>(from: F) -> Result<[i32; D], F::Error> {
        let values = Vec::<i32>::deserialize(from)?;
        let wrong = |values: Vec<i32>| F::Error::custom(format!("{} coordinates, not {D}", values.len()));
        values.try_into().map_err(wrong)
    }
}

/// The particles whose stencils began in one block of nodes when they were last sorted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Block<const D: usize> {
    /// The block's coordinates: those of its least node over its edge.
    #[serde(with = "integers")]
    pub corner: [i32; D],
    pub first_chunk: usize,
    pub particles: usize,
}

impl<const D: usize> Block<D> {
    pub fn chunks(&self) -> usize {
        self.particles.div_ceil(CHUNK)
    }

    /// Numbers of its chunks.
    pub fn chunk_range(&self) -> std::ops::Range<usize> {
        self.first_chunk..self.first_chunk + self.chunks()
    }
}

/// Numbers of a particle that no arithmetic is done with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Label {
    pub id: u32,
    pub material: u16,
    /// Whether J_P ever met a bound.
    pub clamped: bool,
}

/// All particles.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(bound = "")]
pub(crate) struct Particles<T: Real, const D: usize> {
    pub layout: Layout<D>,
    /// `layout.fields()` entries a chunk.
    pub fields: Vec<[T; CHUNK]>,
    pub labels: Vec<[Label; CHUNK]>,
    pub blocks: Vec<Block<D>>,
    /// Whether all particles are in their block or one next to it.
    pub placed: bool,
}

impl<T: Real, const D: usize> Clone for Particles<T, D> {
    fn clone(&self) -> Self {
        let mut copy = Self::default();
        copy.clone_from(self);
        copy
    }

    /// Into the memory that is there.
    fn clone_from(&mut self, other: &Self) {
        let Particles { layout, fields, labels, blocks, placed } = other;
        (self.layout, self.placed) = (*layout, *placed);
        self.fields.clone_from(fields);
        self.labels.clone_from(labels);
        self.blocks.clone_from(blocks);
    }
}

impl<T: Real, const D: usize> Particles<T, D> {
    /// The particles of `state` in its order, as one block that lies nowhere.
    pub fn of(scene: &Scene<T, D>, state: &State<T, D>) -> Self {
        let layout =
            Layout { affine: scene.transfer.keeps_affine(), forced: !state.body_acceleration.is_empty() };
        let count = state.len();
        let mut particles = Particles::<T, D> { layout, ..Particles::default() };
        particles.blocks = vec![Block { corner: [0; D], first_chunk: 0, particles: count }];
        particles.resize(count.div_ceil(CHUNK));
        let State { motion, constants, body_acceleration, .. } = state;
        for p in 0..count {
            let (chunk, lane) = (p / CHUNK, p % CHUNK);
            let fields = &mut particles.fields[chunk * layout.fields()..][..layout.fields()];
            let mut put = |field: usize, value: T| fields[field][lane] = value;
            for i in 0..D {
                put(Layout::<D>::POSITION + i, motion.position[p][i]);
                put(Layout::<D>::VELOCITY + i, motion.velocity[p][i]);
                for j in 0..D {
                    let unit = if i == j { T::one() } else { T::zero() };
                    put(Layout::<D>::STRAIN + i * D + j, motion.deformation[p][(i, j)] - unit);
                    if layout.affine {
                        put(Layout::<D>::AFFINE + i * D + j, motion.affine[p][(i, j)]);
                    }
                }
                if layout.forced {
                    put(layout.force() + i, body_acceleration[p][i]);
                }
            }
            put(Layout::<D>::RATIO, motion.plastic_ratio[p]);
            put(Layout::<D>::STIFFNESS, motion.stiffness[p]);
            put(Layout::<D>::MASS, constants.mass[p]);
            put(Layout::<D>::VOLUME, constants.volume[p]);
            put(Layout::<D>::SCALE, constants.stiffness_scale[p]);
            particles.labels[chunk][lane] = Label {
                id: constants.id[p],
                material: constants.material[p],
                clamped: motion.clamped.get(p).copied().unwrap_or(false),
            };
        }
        particles
    }

    /// Makes room for so many chunks.
    pub fn resize(&mut self, chunks: usize) {
        self.fields.resize(chunks * self.layout.fields(), [T::zero(); CHUNK]);
        self.labels.resize(chunks, [Label::default(); CHUNK]);
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.blocks.iter().map(|block| block.particles).sum()
    }

    /// Chunk and lane of every particle, in order of storage.
    pub fn places(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        self.blocks
            .iter()
            .flat_map(|block| (0..block.particles).map(|p| (block.first_chunk + p / CHUNK, p % CHUNK)))
    }

    /// Writes the particles to `state`, in order of storage.
    pub fn write(&self, scene: &Scene<T, D>, state: &mut State<T, D>) {
        let layout = self.layout;
        let (mut motion, mut constants) = (ParticleMotion::default(), ParticleConstants::default());
        let mut forces = Vec::new();
        let keeps_clamped = scene.bounds_plastic_ratio();
        let count = self.len();
        motion.position.reserve(count);
        motion.velocity.reserve(count);
        motion.deformation.reserve(count);
        motion.plastic_ratio.reserve(count);
        motion.stiffness.reserve(count);
        constants.mass.reserve(count);
        constants.volume.reserve(count);
        constants.stiffness_scale.reserve(count);
        constants.material.reserve(count);
        constants.id.reserve(count);
        for (chunk, lane) in self.places() {
            let fields = &self.fields[chunk * layout.fields()..][..layout.fields()];
            let vector = |first: usize| Vector::<T, D>::from_fn(|i, _| fields[first + i][lane]);
            let matrix = |first: usize| Matrix::<T, D>::from_fn(|i, j| fields[first + i * D + j][lane]);
            motion.position.push(vector(Layout::<D>::POSITION));
            motion.velocity.push(vector(Layout::<D>::VELOCITY));
            motion.deformation.push(matrix(Layout::<D>::STRAIN) + Matrix::identity());
            motion.plastic_ratio.push(fields[Layout::<D>::RATIO][lane]);
            motion.stiffness.push(fields[Layout::<D>::STIFFNESS][lane]);
            if layout.affine {
                motion.affine.push(matrix(Layout::<D>::AFFINE));
            }
            if layout.forced {
                forces.push(vector(layout.force()));
            }
            constants.mass.push(fields[Layout::<D>::MASS][lane]);
            constants.volume.push(fields[Layout::<D>::VOLUME][lane]);
            constants.stiffness_scale.push(fields[Layout::<D>::SCALE][lane]);
            let label = self.labels[chunk][lane];
            constants.material.push(label.material);
            constants.id.push(label.id);
            if keeps_clamped {
                motion.clamped.push(label.clamped);
            }
        }
        (state.motion, state.constants, state.body_acceleration) = (motion, constants, forces);
    }

    /// Whether the arrays fit one another and `scene`.
    pub fn is_consistent(&self, scene: &Scene<T, D>) -> bool {
        let chunks = self.labels.len();
        let mut next = 0;
        let follows_on = |block: &Block<D>| {
            let begins = block.first_chunk == next && (1..=chunks * CHUNK).contains(&block.particles);
            next += block.particles.min(chunks * CHUNK).div_ceil(CHUNK);
            begins && next <= chunks
        };
        self.layout.affine == scene.transfer.keeps_affine()
            && self.fields.len() == chunks * self.layout.fields()
            && self.blocks.iter().all(follows_on)
    }

    /// Sets the accelerations of all lanes by `of` their ids; `false` where there is no room for any.
    pub fn accelerate(&mut self, of: &impl Fn(u32) -> Vector<T, D>) -> bool {
        if !self.layout.forced {
            return false;
        }
        let first = self.layout.force();
        for (chunk, labels) in self.fields.chunks_exact_mut(self.layout.fields()).zip(&self.labels) {
            for lane in 0..CHUNK {
                let acceleration = of(labels[lane].id);
                (0..D).for_each(|k| chunk[first + k][lane] = acceleration[k]);
            }
        }
        true
    }

    /// Bytes in store.
    pub fn bytes(&self) -> usize {
        std::mem::size_of_val(&self.fields[..]) + std::mem::size_of_val(&self.labels[..])
    }
}

/// The matrix of lanes whose entries begin at `field` of a chunk.
#[inline(always)]
pub(super) fn load_matrix<T: Real, V: Lanes<T>, const D: usize>(
    chunk: &[[T; CHUNK]],
    field: usize,
    lane: usize,
) -> LaneMatrix<V, D> {
    let mut m = [[V::splat(T::zero()); D]; D];
    for i in 0..D {
        for j in 0..D {
            m[i][j] = V::load(&chunk[field + i * D + j][lane..]);
        }
    }
    m
}

/// Back to where [`load_matrix`] takes it from.
#[inline(always)]
pub(super) fn store_matrix<T: Real, V: Lanes<T>, const D: usize>(
    m: &LaneMatrix<V, D>,
    chunk: &mut [[T; CHUNK]],
    field: usize,
    lane: usize,
) {
    for i in 0..D {
        for j in 0..D {
            m[i][j].store(&mut chunk[field + i * D + j][lane..]);
        }
    }
}
