//! Nodes of the reference engine exist where particles are, and nowhere else.

use snowlab_solver::geometry::Vector;
use snowlab_solver::grid::{BLOCK_EDGE, Grid};
use snowlab_solver::step::{Workspace, step};
use snowlab_solver::{Engine, InitialParticle, KernelKind, Real, Scene};

use crate::support::{KERNELS, Random, lattice, scene, state};

/// The nodes in store after one step.
fn nodes<T: Real, const D: usize>(kernel: KernelKind, particles: &[InitialParticle<D>]) -> Grid<T, D> {
    let scene = Scene { kernel, engine: Engine::Reference, ..scene::<T, D>(0.5) };
    let mut state = state(&scene, particles);
    let mut workspace = Workspace::new(&scene, &state).expect("a valid scene");
    step(&scene, &mut state, &mut workspace, 1e-6).expect("a good step");
    workspace.grid().clone()
}

fn check_distance<T: Real, const D: usize>() {
    let near = lattice::<D>(0.5, [-3; D], [6; D], 2, [0.0; D]);
    let mut both = near.clone();
    both.extend(lattice::<D>(0.5, [2000; D], [6; D], 2, [0.0; D]));
    let mut middle = near.clone();
    middle.extend(lattice::<D>(0.5, [-2003; D], [6; D], 2, [0.0; D]));
    for kernel in KERNELS {
        let one = nodes::<T, D>(kernel, &near).node_count();
        // A body of 6 cells has stencils that begin at 7 to 9 nodes: 3 blocks of 4 on an axis, and one more to reach into.
        let most = (4 * BLOCK_EDGE).pow(D as u32);
        assert!(one <= most, "{one} nodes");
        for pair in [&both, &middle] {
            let two = nodes::<T, D>(kernel, pair).node_count();
            assert!(two <= 2 * most, "{two} nodes for two bodies 1 km apart, {one} for one");
        }
    }
}

#[test]
fn two_bodies_a_kilometre_apart_cost_no_more_than_two_bodies() {
    check_distance::<f64, 2>();
    check_distance::<f32, 2>();
    check_distance::<f64, 3>();
}

#[test]
fn every_node_is_found_where_it_lies_and_holds_what_particles_gave_it() {
    let mut random = Random(51);
    for kernel in KERNELS {
        let mut particles = lattice::<3>(0.5, [-5, -1, 3], [4, 3, 2], 1, [0.0; 3]);
        particles.iter_mut().for_each(|p| p.position += random.vector::<f64, 3>(0.4));
        let grid = nodes::<f64, 3>(kernel, &particles);
        let reach = if kernel == KernelKind::Cubic { 2.0 } else { 1.5 };
        let spline = |q: f64| match kernel {
            KernelKind::Cubic if q < 1.0 => q * q * q / 2.0 - q * q + 2.0 / 3.0,
            KernelKind::Cubic => (2.0 - q).max(0.0).powi(3) / 6.0,
            KernelKind::Quadratic if q < 0.5 => 0.75 - q * q,
            KernelKind::Quadratic => (1.5 - q).max(0.0).powi(2) / 2.0,
        };
        let mut seen = std::collections::BTreeSet::new();
        let mut negative = 0;
        for index in 0..grid.node_count() {
            let node = grid.coordinates(index);
            assert!(seen.insert(node), "node {node:?} is stored twice");
            assert_eq!(grid.find(node), Some(index));
            let x = Vector::<f64, 3>::from_fn(|k, _| f64::from(node[k]) * 0.5);
            assert_eq!(grid.position(index), x);
            negative += usize::from(node.iter().any(|n| *n < 0));
            // Brute force over all particles.
            let mass: f64 = particles
                .iter()
                .map(|p| {
                    let q = (p.position - x) / 0.5;
                    p.mass * q.iter().map(|q| spline(q.abs())).product::<f64>()
                })
                .sum();
            assert!((grid.sums[index].mass - mass).abs() < 1e-12 * (1.0 + mass), "mass of {node:?}");
        }
        assert!(negative > 50);
        // No node within reach of a particle is missing.
        for p in &particles {
            let base = p.position.map(|c| (c / 0.5).floor() as i32);
            for offset in 0..5usize.pow(3) {
                let node = [offset % 5, offset / 5 % 5, offset / 25].map(|o| o as i32 - 2);
                let node: [i32; 3] = std::array::from_fn(|k| base[k] + node[k]);
                let near = (0..3).all(|k| (p.position[k] / 0.5 - f64::from(node[k])).abs() < reach);
                assert!(!near || seen.contains(&node), "node {node:?} is missing");
            }
        }
        assert_eq!(grid.find([1000, 1000, 1000]), None);
    }
}
