//! Sorting particles by the block of the grid and, within it, by the node in which their stencils begin: stably, so that the order depends on
//! positions and the previous order alone.

use std::collections::HashMap;

use super::dispatch::{Kernels, Set};
use super::grid::{BLOCK_NODES, BlockHash, NEIGHBOURS, block_edge, neighbour};
use super::particles::{Block, Label, Layout, Particles};
use super::pool::{Pool, Shared};
use super::simd::{CHUNK, InstructionSet, Lanes};
use super::weights::LaneKernel;
use crate::geometry::Vector;
use crate::real::Real;
use crate::scene::Scene;
use crate::transfer::first_node;

/// Where a particle comes from: its chunk, and its lane there. Padding has none.
type Source = Option<(u32, u8)>;

/// A particle's new place as seen from its block: which of the blocks round it (times [`BLOCK_NODES`]), and the node there.
pub(super) type Course = u16;
/// That of padding.
const NOWHERE: Course = Course::MAX;

/// Some particles of block `from` on their way to block `corner`, which is number `towards` of those round it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Move<const D: usize> {
    corner: [i32; D],
    from: u32,
    towards: u16,
    particles: u32,
}

impl<T: Real, const D: usize> Particles<T, D> {
    /// Writes to `into` the same particles, sorted.
    pub fn sort(&self, scene: &Scene<T, D>, into: &mut Self, pool: &Pool, set: Set, kernels: &Kernels<T, D>) {
        into.layout = self.layout;
        into.placed = true;
        if self.placed {
            self.sort_neighbours(scene, into, pool, set, kernels);
        } else {
            self.sort_all(scene, into);
        }
    }

    /// From wherever they are, by a counting sort over all nodes.
    fn sort_all(&self, scene: &Scene<T, D>, into: &mut Self) {
        let edge = block_edge::<D>();
        let mut directory = HashMap::<[i32; D], u32, BlockHash>::default();
        let mut corners: Vec<[i32; D]> = Vec::new();
        let mut homes: Vec<(u32, u32)> = Vec::with_capacity(self.len());
        let per_spacing = T::one() / scene.spacing;
        let fields = self.layout.fields();
        for (chunk, lane) in self.places() {
            let x = Vector::<T, D>::from_fn(|i, _| self.fields[chunk * fields + i][lane]);
            let node = first_node(scene.kernel, &x, per_spacing);
            let corner = node.map(|n| n.div_euclid(edge));
            let next = corners.len() as u32;
            let number = *directory.entry(corner).or_insert(next);
            if number == next {
                corners.push(corner);
            }
            let local = node.iter().fold(0, |local, n| local * edge + n.rem_euclid(edge));
            homes.push((number, local as u32));
        }
        // Blocks in the order of their coordinates.
        let mut order: Vec<u32> = (0..corners.len() as u32).collect();
        order.sort_unstable_by_key(|&b| corners[b as usize]);
        let mut cursors = vec![0_u32; corners.len() * BLOCK_NODES];
        for &(block, local) in &homes {
            cursors[block as usize * BLOCK_NODES + local as usize] += 1;
        }
        into.blocks.clear();
        let mut chunk = 0;
        for &b in &order {
            let first = (chunk * CHUNK) as u32;
            let particles = add_up(&mut cursors[b as usize * BLOCK_NODES..][..BLOCK_NODES], first) as usize;
            let block = Block { corner: corners[b as usize], first_chunk: chunk, particles };
            chunk += block.chunks();
            into.blocks.push(block);
        }
        let mut sources: Vec<[Source; CHUNK]> = vec![[None; CHUNK]; chunk];
        for (&(block, local), (chunk, lane)) in homes.iter().zip(self.places()) {
            let cursor = &mut cursors[block as usize * BLOCK_NODES + local as usize];
            sources.as_flattened_mut()[*cursor as usize] = Some((chunk as u32, lane as u8));
            *cursor += 1;
        }
        into.resize(chunk);
        let chunks = into.fields.chunks_exact_mut(fields).zip(&mut into.labels);
        for ((to, labels), sources) in chunks.zip(&sources) {
            self.gather_chunk(sources, to, labels);
        }
    }

    /// From where they were sorted last, none farther than in the next block: block by block, on all threads.
    fn sort_neighbours(
        &self,
        scene: &Scene<T, D>,
        into: &mut Self,
        pool: &Pool,
        set: Set,
        kernels: &Kernels<T, D>,
    ) {
        let fields = self.layout.fields();
        let mut courses = vec![[NOWHERE; CHUNK]; self.labels.len()];
        let shared = Shared::new(&mut courses);
        let locate = |number: usize| {
            let block = &self.blocks[number];
            let (first, chunks) = (block.first_chunk, block.chunks());
            #[expect(unsafe_code, reason = "tasks write to chunks of their own")]
            // SAFETY: every chunk belongs to one block, and every block to one task.
            let courses = unsafe { shared.range(first, chunks) };
            let fields = &self.fields[first * fields..(first + chunks) * fields];
            (kernels.locate)(set, scene, self.layout, block, fields, courses);
            courses.as_flattened_mut()[block.particles..].fill(NOWHERE);
            let mut counts = [0_u32; NEIGHBOURS];
            for course in &courses.as_flattened()[..block.particles] {
                counts[usize::from(*course) / BLOCK_NODES] += 1;
            }
            counts
        };
        let counts = pool.run(self.blocks.len(), 1, || (), |(), number| locate(number));

        // Blocks in the order of their coordinates, and what comes to each in the order of storage.
        let mut moves = Vec::new();
        for (from, (block, counts)) in self.blocks.iter().zip(&counts).enumerate() {
            for (towards, &particles) in counts.iter().enumerate().filter(|(_, particles)| **particles > 0) {
                let corner = neighbour(block.corner, towards);
                moves.push(Move { corner, from: from as u32, towards: towards as u16, particles });
            }
        }
        moves.sort_unstable();
        let arrivals: Vec<&[Move<D>]> = moves.chunk_by(|a, b| a.corner == b.corner).collect();
        into.blocks.clear();
        let mut chunk = 0;
        for moves in &arrivals {
            let particles = moves.iter().map(|part| part.particles as usize).sum();
            let block = Block { corner: moves[0].corner, first_chunk: chunk, particles };
            chunk += block.chunks();
            into.blocks.push(block);
        }
        into.resize(chunk);
        let (to_fields, to_labels) = (Shared::new(&mut into.fields), Shared::new(&mut into.labels));
        let blocks = &into.blocks;
        let fill = |sources: &mut Vec<[Source; CHUNK]>, number: usize| {
            let block = &blocks[number];
            self.sources_of(block, arrivals[number], &courses, sources);
            for (offset, sources) in sources.iter().enumerate() {
                let chunk = block.first_chunk + offset;
                #[expect(unsafe_code, reason = "tasks write to chunks of their own")]
                // SAFETY: every chunk belongs to one block, and every block to one task.
                let (to, labels) =
                    unsafe { (to_fields.range(chunk * fields, fields), &mut to_labels.range(chunk, 1)[0]) };
                self.gather_chunk(sources, to, labels);
            }
        };
        pool.run(blocks.len(), 1, Vec::new, fill);
    }

    /// Fills in where the particles of `block`, to which `arrivals` come, lie now.
    fn sources_of(
        &self,
        block: &Block<D>,
        arrivals: &[Move<D>],
        courses: &[[Course; CHUNK]],
        sources: &mut Vec<[Source; CHUNK]>,
    ) {
        let mut cursors = [0_u32; BLOCK_NODES];
        let nodes_of = |part: &Move<D>| {
            let from = &self.blocks[part.from as usize];
            let chunks = from.chunk_range();
            let first = part.towards * BLOCK_NODES as u16;
            let courses = courses[chunks.clone()].as_flattened().iter().enumerate();
            courses.filter_map(move |(p, course)| {
                let node = usize::from(course.wrapping_sub(first));
                (node < BLOCK_NODES).then_some((chunks.start + p / CHUNK, p % CHUNK, node))
            })
        };
        for part in arrivals {
            nodes_of(part).for_each(|(_, _, node)| cursors[node] += 1);
        }
        add_up(&mut cursors, 0);
        sources.clear();
        sources.resize(block.chunks(), [None; CHUNK]);
        let places = sources.as_flattened_mut();
        for part in arrivals {
            for (chunk, lane, node) in nodes_of(part) {
                places[cursors[node] as usize] = Some((chunk as u32, lane as u8));
                cursors[node] += 1;
            }
        }
    }

    /// Copies the particles at `sources` to a chunk. Padding repeats the chunk's first particle, without mass and volume.
    fn gather_chunk(&self, sources: &[Source; CHUNK], to: &mut [[T; CHUNK]], labels: &mut [Label; CHUNK]) {
        let fields = self.layout.fields();
        let from = self.fields.as_flattened();
        let mut places = [0; CHUNK];
        for lane in 0..CHUNK {
            let (chunk, source_lane) = sources[lane].or(sources[0]).unwrap_or_default();
            labels[lane] = self.labels[chunk as usize][usize::from(source_lane)];
            places[lane] = chunk as usize * fields * CHUNK + usize::from(source_lane);
        }
        for (field, to) in to.iter_mut().enumerate() {
            for lane in 0..CHUNK {
                to[lane] = from[places[lane] + field * CHUNK];
            }
        }
        for lane in 0..CHUNK {
            if sources[lane].is_none() {
                to[Layout::<D>::MASS][lane] = T::zero();
                to[Layout::<D>::VOLUME][lane] = T::zero();
            }
        }
    }
}

/// Makes of counts where each begins, after `first`; where the last one ends less `first`.
fn add_up(counts: &mut [u32], first: u32) -> u32 {
    let mut next = first;
    for count in counts {
        next += std::mem::replace(count, next);
    }
    next - first
}

/// The courses of a block's particles from its chunks' positions.
#[inline(always)]
pub(super) fn locate<I: InstructionSet<T>, T: Real, K: LaneKernel, const D: usize>(
    per_spacing: T,
    layout: Layout<D>,
    block: &Block<D>,
    fields: &[[T; CHUNK]],
    courses: &mut [[Course; CHUNK]],
) {
    let edge = block_edge::<D>();
    let (length, per_edge) =
        (I::Lanes::splat(T::of_index(edge)), I::Lanes::splat(T::of(1.0 / f64::from(edge))));
    let (one, three) = (I::Lanes::splat(T::one()), I::Lanes::splat(T::of(3.0)));
    let per_spacing = I::Lanes::splat(per_spacing);
    for (chunk, courses) in fields.chunks_exact(layout.fields()).zip(courses) {
        let mut lane = 0;
        while lane < CHUNK {
            let zero = I::Lanes::splat(T::zero());
            let (mut towards, mut node) = (zero, zero);
            for axis in 0..D {
                let x = I::Lanes::load(&chunk[Layout::<D>::POSITION + axis][lane..]) * per_spacing;
                // The place's node is one more than the first of the stencil.
                let first = I::Lanes::splat(T::of_index(block.corner[axis] * edge + 1));
                let local = K::place::<T, I::Lanes>(x).node - first;
                let away = (local * per_edge).floor();
                towards = towards.mul_add(three, away + one);
                node = node.mul_add(length, local - away * length);
            }
            let mut numbers = [0; CHUNK];
            let of_block = I::Lanes::splat(T::of_index(BLOCK_NODES as i32));
            towards.mul_add(of_block, node).store_integers(&mut numbers);
            for k in 0..I::Lanes::COUNT {
                courses[lane + k] = numbers[k] as Course;
            }
            lane += I::Lanes::COUNT;
        }
    }
}
