//! A preconditioner of two levels: residuals that change from node to node are divided by a diagonal, smooth ones are solved for on a
//! coarse grid, where the many iterations that news takes from one end of a stiff body to the other fall away.
//!
//! P^-1 = S^-1 + I A_c^-1 I^T, an additive Schwarz method (Smith, Bjorstad & Gropp, Domain Decomposition, 1996, section 1.5), with
//!
//! - S the nodes' masses and what the Hessian has on its diagonal, to its order of magnitude;
//! - I the interpolation by multilinear hats from the nodes of a grid [`RATIO`] times as coarse;
//! - A_c = I^T M I + c K: K is the stiffness of isotropic elasticity at rest for those hats, with the particles' moduli and volumes in
//!   place of integrals. Particles are its only points of quadrature, as in the Hessian, so parts that have come apart are apart here too.
//!
//! Wang et al. (HOT, SIGGRAPH 2020, section 5) go from particles to coarser grids as well, through several levels, for the Hessian itself. At rest, A_c
//! stays positive definite whatever the particles do, and takes two numbers of each.

use std::collections::{BTreeMap, HashMap};

use super::skyline::Skyline;
use crate::real::Real;

/// Nodes of the grid to one of the coarse grid, along an axis: chosen by time, docs/integrators.md.
const RATIO: i32 = 4;
/// The diagonal of H over sum w V (lambda + 2 mu) / h^2. Chosen: of a lattice that is filled evenly and cubic kernels, where it is 0.32 for
/// each of two axes, (integral of B'^2) (integral of B^2) = (2/3) (151/315); rounded up, as the greatest eigenvalue is what counts.
const DIAGONAL: f64 = 1.0;
/// Corners of a cell, of which the first 2^D are used.
const CORNERS: usize = 8;
/// Parts of a coarse cell, whose particles count as one in its middle; of these the first RATIO^D are used.
const PARTS: usize = 64;

/// A particle, as the coarse grid sees it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point<const D: usize> {
    /// Position over the spacing.
    pub place: [f64; D],
    /// V lambda and V mu, hardening included [J].
    pub moduli: [f64; 2],
}

/// A node of the grid that is not empty.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FineNode<const D: usize> {
    pub index: usize,
    pub coordinates: [i32; D],
    /// [kg]
    pub mass: f64,
}

/// The preconditioner of one step.
#[derive(Debug)]
pub(crate) struct TwoLevel<const D: usize> {
    nodes: Vec<Interpolated>,
    /// Of the coarse unknowns, node by node.
    factor: Skyline,
    sums: Vec<f64>,
}

/// A node and the coarse nodes round it.
#[derive(Debug)]
struct Interpolated {
    index: usize,
    /// 1 / S [1/kg].
    per_diagonal: f64,
    corners: [u32; CORNERS],
    weights: [f64; CORNERS],
}

/// What a coarse cell holds.
#[derive(Clone, Debug)]
struct Cell {
    moduli: [[f64; 2]; PARTS],
    mass: [[f64; CORNERS]; CORNERS],
    /// Its corners' numbers.
    corners: [u32; CORNERS],
}

impl<const D: usize> TwoLevel<D> {
    /// For M + c H [kg] on a grid of `spacing` [m], from its particles and its nodes that are not empty.
    pub fn new(
        spacing: f64,
        c: f64,
        points: impl Iterator<Item = Point<D>>,
        nodes: impl Iterator<Item = FineNode<D>>,
    ) -> Self {
        let mut cells = Cells::<D>::default();
        points.for_each(|point| cells.add_point(&point));
        let mut interpolated = Vec::new();
        for node in nodes {
            let (cell, weights) = cells.add_node(&node);
            let interpolation =
                Interpolated { index: node.index, per_diagonal: node.mass, corners: [0; CORNERS], weights };
            interpolated.push((cell, interpolation));
        }
        let per_spacing = 1.0 / spacing;
        let numbers = cells.number_corners();
        let mut stiffness_and_mass = vec![[0.0; 2]; numbers];
        let mut factor = Skyline::new(&cells.rows(numbers));
        for cell in &cells.all {
            cell.add_to::<D>(&mut factor, c * per_spacing * per_spacing, &mut stiffness_and_mass);
        }
        factor.factorise();
        let share = DIAGONAL * c * per_spacing * per_spacing;
        let nodes = interpolated.into_iter().map(|(cell, node)| {
            let corners = cells.all[cell].corners;
            let [mut stiffness, mut mass] = [0.0; 2];
            for (&corner, weight) in corners.iter().zip(node.weights).take(1 << D) {
                let [of_stiffness, of_mass] = stiffness_and_mass[corner as usize];
                stiffness += weight * of_stiffness;
                mass += weight * of_mass;
            }
            let diagonal = node.per_diagonal * (1.0 + share * stiffness / mass);
            Interpolated { per_diagonal: 1.0 / diagonal, corners, ..node }
        });
        TwoLevel { nodes: nodes.collect(), factor, sums: vec![0.0; numbers * D] }
    }

    /// `out` = P^-1 r at every node that is not empty. `read` and `write` take a field's entry of a node.
    pub fn apply<V, T: Real>(
        &mut self,
        r: &[V],
        out: &mut [V],
        read: impl Fn(&V) -> [T; D],
        write: impl Fn(&mut V, [T; D]),
    ) {
        let TwoLevel { nodes, factor, sums } = self;
        sums.fill(0.0);
        for node in &*nodes {
            let r = read(&r[node.index]);
            for (&corner, weight) in node.corners.iter().zip(node.weights).take(1 << D) {
                for k in 0..D {
                    sums[corner as usize * D + k] += weight * r[k].as_f64();
                }
            }
        }
        factor.solve(sums);
        for node in &*nodes {
            let r = read(&r[node.index]);
            let mut z: [f64; D] = std::array::from_fn(|k| r[k].as_f64() * node.per_diagonal);
            for (&corner, weight) in node.corners.iter().zip(node.weights).take(1 << D) {
                for k in 0..D {
                    z[k] += weight * sums[corner as usize * D + k];
                }
            }
            write(&mut out[node.index], z.map(T::of));
        }
    }
}

/// The coarse cells that hold particles or nodes, in the order in which they were met.
#[derive(Debug, Default)]
struct Cells<const D: usize> {
    all: Vec<Cell>,
    places: Vec<[i32; 3]>,
    numbers: HashMap<[i32; 3], usize>,
    latest: Option<([i32; 3], usize)>,
}

impl<const D: usize> Cells<D> {
    fn at(&mut self, place: [i32; 3]) -> usize {
        if let Some((latest, number)) = self.latest
            && latest == place
        {
            return number;
        }
        let next = self.all.len();
        let number = *self.numbers.entry(place).or_insert(next);
        if number == next {
            self.places.push(place);
            let moduli = [[0.0; 2]; PARTS];
            self.all.push(Cell { moduli, mass: [[0.0; CORNERS]; CORNERS], corners: [0; CORNERS] });
        }
        self.latest = Some((place, number));
        number
    }

    fn add_point(&mut self, point: &Point<D>) {
        let (mut place, mut part) = ([0; 3], 0);
        for k in 0..D {
            let cell = point.place[k].floor() as i32;
            place[k] = cell.div_euclid(RATIO);
            part = part * RATIO as usize + cell.rem_euclid(RATIO) as usize;
        }
        let number = self.at(place);
        for (sum, modulus) in self.all[number].moduli[part].iter_mut().zip(point.moduli) {
            *sum += modulus;
        }
    }

    /// The node's cell, and its hats there.
    fn add_node(&mut self, node: &FineNode<D>) -> (usize, [f64; CORNERS]) {
        let (mut place, mut local) = ([0; 3], [0.0; D]);
        for k in 0..D {
            place[k] = node.coordinates[k].div_euclid(RATIO);
            local[k] = f64::from(node.coordinates[k].rem_euclid(RATIO)) / f64::from(RATIO);
        }
        let weights = hats(&local);
        let number = self.at(place);
        for (row, a) in self.all[number].mass.iter_mut().zip(weights) {
            for (sum, b) in row.iter_mut().zip(weights) {
                *sum += node.mass * a * b;
            }
        }
        (number, weights)
    }

    /// Gives every corner of a cell its number, near ones near numbers (reverse Cuthill-McKee, 1969); how many there are.
    fn number_corners(&mut self) -> usize {
        let mut first = BTreeMap::new();
        for place in &self.places {
            for corner in 0..1 << D {
                let next = first.len() as u32;
                first.entry(corner_place::<D>(place, corner)).or_insert(next);
            }
        }
        for (cell, place) in self.all.iter_mut().zip(&self.places) {
            for corner in 0..1 << D {
                cell.corners[corner] = first[&corner_place::<D>(place, corner)];
            }
        }
        let order = super::skyline::near_numbers(&self.neighbours(first.len()));
        for cell in &mut self.all {
            for corner in &mut cell.corners[..1 << D] {
                *corner = order[*corner as usize];
            }
        }
        first.len()
    }

    /// The corners that share a cell with each.
    fn neighbours(&self, numbers: usize) -> Vec<Vec<u32>> {
        let mut neighbours = vec![Vec::new(); numbers];
        for cell in &self.all {
            for &a in &cell.corners[..1 << D] {
                neighbours[a as usize].extend_from_slice(&cell.corners[..1 << D]);
            }
        }
        for of_one in &mut neighbours {
            of_one.sort_unstable();
            of_one.dedup();
        }
        neighbours
    }

    /// Of every unknown the first that it shares a cell with.
    fn rows(&self, numbers: usize) -> Vec<usize> {
        let mut first: Vec<usize> = (0..numbers).collect();
        for cell in &self.all {
            let corners = &cell.corners[..1 << D];
            let least = corners.iter().copied().min().map_or(0, |least| least as usize);
            for &corner in corners {
                first[corner as usize] = first[corner as usize].min(least);
            }
        }
        (0..numbers * D).map(|row| first[row / D] * D).collect()
    }
}

fn corner_place<const D: usize>(cell: &[i32; 3], corner: usize) -> [i32; 3] {
    std::array::from_fn(|k| if k < D { cell[k] + (corner >> k & 1) as i32 } else { 0 })
}

/// The hats of a cell's corners at `local`, in units of the cell.
fn hats<const D: usize>(local: &[f64; D]) -> [f64; CORNERS] {
    let mut weights = [0.0; CORNERS];
    for (corner, weight) in weights.iter_mut().enumerate().take(1 << D) {
        *weight = (0..D).map(|k| hat(local[k], corner >> k & 1)).product();
    }
    weights
}

fn hat(local: f64, upper: usize) -> f64 {
    if upper == 1 { local } else { 1.0 - local }
}

/// The hats' gradients there, in units of the fine cell.
fn slopes<const D: usize>(local: &[f64; D]) -> [[f64; D]; CORNERS] {
    let mut slopes = [[0.0; D]; CORNERS];
    for (corner, slope) in slopes.iter_mut().enumerate().take(1 << D) {
        for k in 0..D {
            let others: f64 = (0..D).filter(|&i| i != k).map(|i| hat(local[i], corner >> i & 1)).product();
            slope[k] = if corner >> k & 1 == 1 { others } else { -others } / f64::from(RATIO);
        }
    }
    slopes
}

impl Cell {
    /// Adds the cell's share of I^T M I + c K, where `share` is c / h^2; and of sum w V (lambda + 2 mu) and mass to the corners' sums.
    fn add_to<const D: usize>(&self, matrix: &mut Skyline, share: f64, sums: &mut [[f64; 2]]) {
        let mut block = [[[[0.0; D]; D]; CORNERS]; CORNERS];
        for (a, of_a) in block.iter_mut().enumerate().take(1 << D) {
            for (b, of_both) in of_a.iter_mut().enumerate().take(a + 1) {
                for k in 0..D {
                    of_both[k][k] = self.mass[a][b];
                }
            }
            sums[self.corners[a] as usize][1] += self.mass[a].iter().sum::<f64>();
        }
        for (part, &[lambda, mu]) in self.moduli.iter().enumerate().take((RATIO as usize).pow(D as u32)) {
            if mu == 0.0 && lambda == 0.0 {
                continue;
            }
            let mut local = [0.0; D];
            let mut rest = part;
            for k in (0..D).rev() {
                local[k] = ((rest % RATIO as usize) as f64 + 0.5) / f64::from(RATIO);
                rest /= RATIO as usize;
            }
            let (weights, slopes) = (hats(&local), slopes(&local));
            for a in 0..1 << D {
                sums[self.corners[a] as usize][0] += weights[a] * (lambda + 2.0 * mu);
                for b in 0..=a {
                    let (of_a, of_b) = (&slopes[a], &slopes[b]);
                    let across: f64 = of_a.iter().zip(of_b).map(|(x, y)| x * y).sum();
                    for i in 0..D {
                        for j in 0..D {
                            let mut k = lambda * of_a[i] * of_b[j] + mu * of_a[j] * of_b[i];
                            if i == j {
                                k += mu * across;
                            }
                            block[a][b][i][j] += share * k;
                        }
                    }
                }
            }
        }
        for a in 0..1 << D {
            for b in 0..=a {
                let (row, column) = (self.corners[a] as usize * D, self.corners[b] as usize * D);
                for i in 0..D {
                    for j in 0..D {
                        if a == b && j > i {
                            continue;
                        }
                        matrix.add(row + i, column + j, block[a][b][i][j]);
                    }
                }
            }
        }
    }
}
