//! The step as people write it first: an array of structs, a dense grid, a loop over every particle's nodes, one thread. What it is
//! measured for is in performance; that it is right, in `agreement.rs`.

use snowlab_solver::geometry::{Matrix, Vector};
use snowlab_solver::math::determinant;
use snowlab_solver::{FlipShare, Lame, Material, Real, Scene, Shape, State, Transfer};

use crate::decomposition::Decomposition;

/// A material point.
#[derive(Clone, Copy, Debug)]
pub struct Particle<T: Real, const D: usize> {
    pub id: u32,
    /// [m]
    pub position: Vector<T, D>,
    /// [m/s]
    velocity: Vector<T, D>,
    /// C [1/s]
    affine: Matrix<T, D>,
    /// F_E
    deformation: Matrix<T, D>,
    /// J_P
    plastic_ratio: T,
    /// [kg]
    mass: T,
    /// [m^D]
    volume: T,
}

#[derive(Clone, Copy, Debug)]
struct Node<T: Real, const D: usize> {
    /// [kg]
    mass: T,
    /// Momentum [kg m/s] from the particles, velocity [m/s] to them.
    motion: Vector<T, D>,
    /// Force [N] from the particles, change of velocity in the step [m/s] to them.
    change: Vector<T, D>,
}

/// What stays the same.
#[derive(Clone, Debug)]
struct Law<T: Real, const D: usize> {
    /// h [m]
    spacing: T,
    transfer: Transfer,
    /// a of FLIP.
    share: T,
    /// [m/s^2]
    gravity: Vector<T, D>,
    /// [Pa]
    lame: Lame<T>,
    /// 1 - theta_c
    least_stretch: T,
    /// 1 + theta_s
    greatest_stretch: T,
    /// xi
    hardening: T,
    /// Of the horizontal floor [m].
    floor: T,
    /// mu
    friction: T,
}

/// A body, the grid round it, and what moves them; `N` nodes a particle and axis: 4 for the cubic kernel, 3 for the quadratic.
#[derive(Clone, Debug)]
pub struct Naive<T: Real, const D: usize, const N: usize> {
    pub particles: Vec<Particle<T, D>>,
    nodes: Vec<Node<T, D>>,
    law: Law<T, D>,
}

/// A particle's weights.
struct Weights<T: Real, const D: usize, const N: usize> {
    first: [i32; D],
    weight: [[T; N]; D],
    /// [1/m]
    slope: [[T; N]; D],
    /// x_i - x_p of the first node [m].
    arm: Vector<T, D>,
    spacing: T,
}

/// The part of the grid in use.
struct Extent<const D: usize> {
    first: [i32; D],
    count: [usize; D],
}

impl<T: Real, const D: usize, const N: usize> Naive<T, D, N> {
    /// The body of `state`, in its order, with the scene's one material and its floor.
    pub fn new(scene: &Scene<T, D>, state: &State<T, D>) -> Self {
        let (motion, constants) = (&state.motion, &state.constants);
        let particles = (0..state.len()).map(|p| Particle {
            id: constants.id[p],
            position: motion.position[p],
            velocity: motion.velocity[p],
            affine: motion.affine.get(p).copied().unwrap_or_else(Matrix::zeros),
            deformation: motion.deformation[p],
            plastic_ratio: motion.plastic_ratio[p],
            mass: constants.mass[p],
            volume: constants.volume[p],
        });
        Naive { particles: particles.collect(), nodes: Vec::new(), law: Law::of(scene) }
    }

    /// Advances by `dt` [s].
    pub fn step<S: Decomposition>(&mut self, dt: T) {
        let extent = self.clear_grid();
        self.particles_to_grid::<S>(&extent, dt);
        self.push_nodes(&extent, dt);
        self.grid_to_particles::<S>(&extent, dt);
    }

    /// An empty grid over the box that the particles fill.
    fn clear_grid(&mut self) -> Extent<D> {
        let (mut low, mut high) = ([i32::MAX; D], [i32::MIN; D]);
        for particle in &self.particles {
            for k in 0..D {
                let first = first_node::<T, N>(particle.position[k] / self.law.spacing);
                (low[k], high[k]) = (low[k].min(first), high[k].max(first));
            }
        }
        let extent = Extent { first: low, count: std::array::from_fn(|k| (high[k] - low[k]) as usize + N) };
        self.nodes.clear();
        let still = Node { mass: T::zero(), motion: Vector::zeros(), change: Vector::zeros() };
        self.nodes.resize(extent.count.iter().product(), still);
        extent
    }

    fn particles_to_grid<S: Decomposition>(&mut self, extent: &Extent<D>, dt: T) {
        let Naive { particles, nodes, law } = self;
        let inverse_inertia = inverse_inertia::<T, N>(law.spacing);
        for p in particles.iter() {
            let weights = Weights::<T, D, N>::at(&p.position, law.spacing);
            let stress = law.stress::<S>(p) * p.volume;
            let momentum = p.velocity * p.mass;
            let spin = p.affine * p.mass;
            if law.transfer == Transfer::Mls {
                // Momentum and impulse in one matrix (Hu et al. 2018, section 4).
                let spin = spin - stress * (dt * inverse_inertia);
                for_each_node::<D, N>(|offset| {
                    let node = &mut nodes[extent.index(&weights.first, &offset)];
                    let weight = weights.weight(&offset);
                    node.mass += p.mass * weight;
                    node.motion += (momentum + spin * weights.arm(&offset)) * weight;
                });
            } else {
                for_each_node::<D, N>(|offset| {
                    let node = &mut nodes[extent.index(&weights.first, &offset)];
                    let weight = weights.weight(&offset);
                    node.mass += p.mass * weight;
                    node.motion += momentum * weight;
                    if law.transfer == Transfer::Apic {
                        node.motion += spin * weights.arm(&offset) * weight;
                    }
                    node.change -= stress * weights.gradient(&offset);
                });
            }
        }
    }

    /// v += dt (f / m + g), and the floor.
    fn push_nodes(&mut self, extent: &Extent<D>, dt: T) {
        let Naive { nodes, law, .. } = self;
        let layer = if D == 3 { extent.count[D - 1] } else { 1 };
        for (index, node) in nodes.iter_mut().enumerate().filter(|(_, node)| node.mass > T::zero()) {
            let height =
                T::of_index(extent.first[1] + (index / layer % extent.count[1]) as i32) * law.spacing;
            let before = node.motion / node.mass;
            let pushed = before + (node.change / node.mass + law.gravity) * dt;
            node.motion = if height <= law.floor { law.touch_floor(pushed) } else { pushed };
            node.change = node.motion - before;
        }
    }

    fn grid_to_particles<S: Decomposition>(&mut self, extent: &Extent<D>, dt: T) {
        let Naive { particles, nodes, law } = self;
        let inverse_inertia = inverse_inertia::<T, N>(law.spacing);
        for p in particles.iter_mut() {
            let weights = Weights::<T, D, N>::at(&p.position, law.spacing);
            let (mut velocity, mut change) = (Vector::<T, D>::zeros(), Vector::<T, D>::zeros());
            let (mut gradient, mut affine) = (Matrix::<T, D>::zeros(), Matrix::<T, D>::zeros());
            for_each_node::<D, N>(|offset| {
                let node = &nodes[extent.index(&weights.first, &offset)];
                let moving = node.motion * weights.weight(&offset);
                velocity += moving;
                if let Transfer::Flip(_) = law.transfer {
                    change += node.change * weights.weight(&offset);
                } else {
                    affine += moving * weights.arm(&offset).transpose();
                }
                if law.transfer != Transfer::Mls {
                    gradient += node.motion * weights.gradient(&offset).transpose();
                }
            });
            p.affine = affine * inverse_inertia;
            p.velocity = match law.transfer {
                Transfer::Flip(_) => velocity * (T::one() - law.share) + (p.velocity + change) * law.share,
                Transfer::Apic | Transfer::Mls => velocity,
            };
            let gradient = if law.transfer == Transfer::Mls { p.affine } else { gradient };
            law.deform::<S>(p, &gradient, dt);
            law.advect(p, velocity, dt);
        }
    }
}

impl<T: Real, const D: usize> Law<T, D> {
    fn of(scene: &Scene<T, D>) -> Self {
        let [Material::Snow(snow)] = scene.materials[..] else { panic!("one snow") };
        let Shape::HalfSpace { point, .. } = scene.colliders[0].shape else { panic!("a floor") };
        let share = match scene.transfer {
            Transfer::Flip(FlipShare::PerStep(share)) => share,
            _ => 0.0,
        };
        Law {
            spacing: scene.spacing,
            transfer: scene.transfer,
            share: T::of(share),
            gravity: scene.gravity,
            lame: snow.lame,
            least_stretch: T::one() - snow.critical_compression,
            greatest_stretch: T::one() + snow.critical_stretch,
            hardening: snow.hardening,
            floor: point[1],
            friction: scene.colliders[0].friction,
        }
    }

    /// tau = 2 mu (F - R) F^T + lambda (J - 1) J I [Pa], hardened (S13 section 5).
    #[inline(always)]
    fn stress<S: Decomposition>(&self, p: &Particle<T, D>) -> Matrix<T, D> {
        let f = &p.deformation;
        let j = determinant(f);
        let hardening = (self.hardening * (T::one() - p.plastic_ratio)).exp();
        let two_mu = (self.lame.mu + self.lame.mu) * hardening;
        let pressure = self.lame.lambda * hardening * (j - T::one()) * j;
        (f - S::rotation(f)) * f.transpose() * two_mu + Matrix::identity() * pressure
    }

    /// F_E' = (I + dt grad v) F_E with its stretches clamped; J_P takes the rest (S13 section 7).
    #[inline(always)]
    fn deform<S: Decomposition>(&self, p: &mut Particle<T, D>, gradient: &Matrix<T, D>, dt: T) {
        let trial = (Matrix::identity() + gradient * dt) * p.deformation;
        let (clamped, ratio) = S::clamp(&trial, self.least_stretch, self.greatest_stretch);
        p.deformation = clamped;
        p.plastic_ratio *= ratio;
    }

    /// x += dt v; what would arrive below the floor touches it.
    #[inline(always)]
    fn advect(&self, p: &mut Particle<T, D>, velocity: Vector<T, D>, dt: T) {
        let arrives_below = p.position[1] + velocity[1] * dt <= self.floor;
        if arrives_below {
            p.velocity = self.touch_floor(p.velocity);
        }
        p.position += if arrives_below { self.touch_floor(velocity) } else { velocity } * dt;
    }

    /// Free to leave; Coulomb friction while pressed on (S13 section 8).
    #[inline(always)]
    fn touch_floor(&self, mut v: Vector<T, D>) -> Vector<T, D> {
        if v[1] >= T::zero() {
            return v;
        }
        let grip = -self.friction * v[1];
        v[1] = T::zero();
        let speed = v.norm();
        if speed <= grip { Vector::zeros() } else { v * (T::one() - grip / speed) }
    }
}

impl<const D: usize> Extent<D> {
    #[inline(always)]
    fn index(&self, first: &[i32; D], offset: &[usize; D]) -> usize {
        (0..D).fold(0, |index, k| index * self.count[k] + (first[k] - self.first[k]) as usize + offset[k])
    }
}

impl<T: Real, const D: usize, const N: usize> Weights<T, D, N> {
    #[inline(always)]
    fn at(x: &Vector<T, D>, spacing: T) -> Self {
        let mut weights = Weights {
            first: [0; D],
            weight: [[T::zero(); N]; D],
            slope: [[T::zero(); N]; D],
            arm: Vector::zeros(),
            spacing,
        };
        for k in 0..D {
            let x = x[k] / spacing;
            let first = first_node::<T, N>(x);
            weights.first[k] = first;
            weights.arm[k] = (T::of_index(first) - x) * spacing;
            for n in 0..N {
                let (weight, slope) = spline::<T, N>(x - T::of_index(first + n as i32));
                weights.weight[k][n] = weight;
                weights.slope[k][n] = slope / spacing;
            }
        }
        weights
    }

    #[inline(always)]
    fn weight(&self, offset: &[usize; D]) -> T {
        (0..D).fold(T::one(), |product, k| product * self.weight[k][offset[k]])
    }

    /// [1/m]
    #[inline(always)]
    fn gradient(&self, offset: &[usize; D]) -> Vector<T, D> {
        Vector::from_fn(|axis, _| {
            (0..D).fold(T::one(), |product, k| {
                product * if k == axis { self.slope[k][offset[k]] } else { self.weight[k][offset[k]] }
            })
        })
    }

    /// x_i - x_p [m]
    #[inline(always)]
    fn arm(&self, offset: &[usize; D]) -> Vector<T, D> {
        Vector::from_fn(|k, _| self.arm[k] + T::of_index(offset[k] as i32) * self.spacing)
    }
}

/// The first node in reach of `x` [cells].
#[inline(always)]
fn first_node<T: Real, const N: usize>(x: T) -> i32 {
    if N == 4 { x.floor_index() - 1 } else { (x - T::of(0.5)).floor_index() }
}

/// The B-spline at the distance `q` [cells], and its slope (Steffen, Kirby & Berzins 2008).
#[inline(always)]
fn spline<T: Real, const N: usize>(q: T) -> (T, T) {
    let (sign, d) = if q < T::zero() { (-T::one(), -q) } else { (T::one(), q) };
    let (half, one) = (T::of(0.5), T::one());
    let (weight, slope) = if N == 4 && d < one {
        (half * d * d * d - d * d + T::of(2.0 / 3.0), T::of(1.5) * d * d - d - d)
    } else if N == 4 {
        let r = T::of(2.0) - d;
        (r * r * r / T::of(6.0), -half * r * r)
    } else if d < half {
        (T::of(0.75) - d * d, -d - d)
    } else {
        let r = T::of(1.5) - d;
        (half * r * r, -r)
    };
    (weight, slope * sign)
}

/// D^-1 of affine transfers [1/m^2] (Jiang et al. 2015, section 5.2).
#[inline(always)]
fn inverse_inertia<T: Real, const N: usize>(spacing: T) -> T {
    T::of(if N == 4 { 3.0 } else { 4.0 }) / (spacing * spacing)
}

#[inline(always)]
fn for_each_node<const D: usize, const N: usize>(mut visit: impl FnMut([usize; D])) {
    let mut offset = [0; D];
    for i in 0..N {
        offset[0] = i;
        for j in 0..N {
            offset[1] = j;
            if D == 2 {
                visit(offset);
                continue;
            }
            for k in 0..N {
                offset[D - 1] = k;
                visit(offset);
            }
        }
    }
}
