//! Particles in the order of the grid's blocks, so that neighbours in space are neighbours in memory.

use crate::grid::EDGE_BITS;
use crate::real::Real;
use crate::scene::Scene;
use crate::state::State;
use crate::transfer::first_nodes_of;

/// Sorts by the block in which a particle's stencil begins, then by its first node; stably, so that the order depends on
/// positions and the previous order alone.
pub(crate) fn sort_by_block<T: Real, const D: usize>(scene: &Scene<T, D>, state: &mut State<T, D>) {
    let nodes = first_nodes_of(scene, &state.motion.position);
    let mut keyed: Vec<([i32; D], [i32; D], u32)> =
        nodes.into_iter().zip(0..).map(|(node, p)| (node.map(|n| n >> EDGE_BITS), node, p)).collect();
    if keyed.is_sorted() {
        return;
    }
    keyed.sort_by_key(|&(block, node, _)| (block, node));
    let order: Vec<u32> = keyed.into_iter().map(|(_, _, p)| p).collect();
    state.reorder(&order);
}
