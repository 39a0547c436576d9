//! Follows a known motion on a grid, and measures by how much the particles miss it.

use std::f64::consts::TAU;

use snowlab_sampler::{Purpose, Streams, rng};
use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::geometry::Vector;
use snowlab_solver::timestep::step_length;
use snowlab_solver::{InitialParticle, Real, Simulation, State};

use super::series::{Motion, Placement, Series, VORTEX, waves};
use super::solutions::{Solution, deformation_gradient};
use crate::statistics::{mean, standard_deviation};
use crate::verify::scenes::{elastic, fixed_step, lattice, observed_order, particle, rate_form, scene, wall};

/// By this share of their distance each ring of the vortex is turned against the one inside, so that no row of particles lies along a radius:
/// the golden ratio's, which no ratio of small numbers comes near.
const GOLDEN: f64 = 0.618_033_988_749_895;

/// Errors of the particles' displacement at the end, over its amplitude.
#[derive(Clone, Copy, Debug)]
pub struct Errors {
    /// Root mean square.
    pub l2: f64,
    /// Largest.
    pub linf: f64,
}

/// A series on one grid.
#[derive(Clone, Debug)]
pub struct Run {
    pub series: Series,
    /// Cells to the metre.
    pub cells: usize,
    pub particles: usize,
    pub steps: u64,
    /// By seed.
    pub errors: Vec<Errors>,
}

impl Run {
    /// Mean over the seeds.
    pub fn mean(&self, of: fn(&Errors) -> f64) -> f64 {
        mean(&self.each(of)).unwrap_or(f64::NAN)
    }

    /// Standard deviation over the seeds, where there are several.
    pub fn deviation(&self, of: fn(&Errors) -> f64) -> Option<f64> {
        standard_deviation(&self.each(of))
    }

    fn each(&self, of: fn(&Errors) -> f64) -> Vec<f64> {
        self.errors.iter().map(of).collect()
    }
}

/// The order at which an error falls over some grids, by seed.
pub fn orders(runs: &[Run], of: fn(&Errors) -> f64) -> Vec<f64> {
    let points = |seed: usize| runs.iter().map(move |run| (1.0 / run.cells as f64, of(&run.errors[seed])));
    (0..runs[0].errors.len()).map(|seed| observed_order(&points(seed).collect::<Vec<_>>())).collect()
}

/// A body to follow: what moves it, where it ends, and what its error is compared with.
struct Task<S, T: Real, const D: usize> {
    solution: S,
    bodies: Vec<InitialParticle<D>>,
    walls: Vec<Collider<T, D>>,
    /// When the error is taken [s].
    end: f64,
    /// Amplitude of the displacement [m].
    size: f64,
}

impl Series {
    /// Runs it on a grid of `cells` to the metre.
    pub fn run(&self, cells: usize) -> anyhow::Result<Run> {
        let mut run = Run { series: *self, cells, particles: 0, steps: 0, errors: Vec::new() };
        for seed in self.seeds() {
            let errors = match (self.motion, self.single) {
                (Motion::Waves2, false) => self.follow(self.waves::<f64, 2>(cells, seed), &mut run),
                (Motion::Waves2, true) => self.follow(self.waves::<f32, 2>(cells, seed), &mut run),
                (Motion::Waves3, false) => self.follow(self.waves::<f64, 3>(cells, seed), &mut run),
                (Motion::Waves3, true) => self.follow(self.waves::<f32, 3>(cells, seed), &mut run),
                (Motion::Vortex, false) => self.follow(self.vortex::<f64>(cells), &mut run),
                (Motion::Vortex, true) => self.follow(self.vortex::<f32>(cells), &mut run),
            }?;
            run.errors.push(errors);
        }
        Ok(run)
    }
}

impl Series {
    /// The unit square or cube full of particles between walls.
    fn waves<T: Real, const D: usize>(
        &self,
        cells: usize,
        seed: u64,
    ) -> Task<impl Solution<D> + use<T, D>, T, D> {
        let mut bodies = lattice::<D>(1.0 / cells as f64, [cells; D], self.per_axis);
        let mut stream = Streams::new(seed).stream(Purpose::Placement);
        let apart = 1.0 / (cells * self.per_axis) as f64;
        for body in &mut bodies {
            let drawn = rng::uniform_vector::<D>(&mut stream);
            match self.placement {
                Placement::Lattice => {}
                Placement::Jittered => body.position += drawn.add_scalar(-0.5) * apart,
                Placement::Random => body.position = drawn,
            }
        }
        let contact = if self.mirrored { Contact::Mirror } else { Contact::Slip };
        let walls = (0..D).flat_map(|axis| [wall(axis, 1.0, 0.0, contact), wall(axis, -1.0, 1.0, contact)]);
        let solution = waves();
        // Shortly before the first crest, at c t = 1/2: there an error of phase would not show.
        let end = 0.4 / solution.speed;
        Task { solution, bodies, walls: walls.collect(), end, size: solution.amplitude }
    }

    /// A ring of particles on rings, so that both edges are met exactly.
    fn vortex<T: Real>(&self, cells: usize) -> Task<impl Solution<2> + use<T>, T, 2> {
        let apart = 1.0 / (cells * self.per_axis) as f64;
        let mut bodies = Vec::new();
        for number in 0..cells * self.per_axis / 2 {
            let radius = VORTEX.inner() + (number as f64 + 0.5) * apart;
            let count = (TAU * radius / apart).round();
            let volume = TAU * radius * apart / count;
            bodies.extend((0..count as usize).map(|place| {
                let (sin, cos) = libm::sincos(TAU * (place as f64 + GOLDEN * number as f64) / count);
                particle(Vector::<f64, 2>::new(cos, sin) * radius, volume)
            }));
        }
        // Where it is turned most.
        let end = 0.5 * VORTEX.period;
        Task { solution: VORTEX, bodies, walls: Vec::new(), end, size: VORTEX.angle * VORTEX.middle }
    }

    /// The errors at the end of a task; notes particles and steps in `run`.
    fn follow<S: Solution<D>, T: Real, const D: usize>(
        &self,
        task: Task<S, T, D>,
        run: &mut Run,
    ) -> anyhow::Result<Errors> {
        let Task { solution, mut bodies, walls, end, size } = task;
        let transfer = rate_form(self.transfer, self.reference_step);
        let mut scene = scene::<T, D>(1.0 / run.cells as f64, self.kernel, transfer, elastic());
        scene.colliders = walls;
        // Steps of one length, that of the default at the start: where it varies, symplectic Euler is of first order in time.
        let longest = self.step * step_length(&scene, &State::at_rest(&scene, Vector::zeros(), &bodies)?);
        let steps = libm::ceil(end / longest);
        let dt = end / steps;
        scene.time_step = fixed_step(dt);
        let rest: Vec<Vector<f64, D>> = bodies.iter().map(|body| body.position).collect();
        // A step takes velocities from half a step before the positions to half a step after. At t = 0 the body is at rest's places.
        for body in &mut bodies {
            let now = solution.position(&body.position, 0.0);
            body.velocity = (now - solution.position(&body.position, -dt)) / dt;
        }
        let mut state = State::at_rest(&scene, Vector::zeros(), &bodies)?;
        for (affine, rest) in state.motion.affine.iter_mut().zip(&rest) {
            let before = deformation_gradient(&solution, rest, -dt);
            *affine = ((deformation_gradient(&solution, rest, 0.0) - before) / dt).map(T::of);
        }
        let mut simulation = Simulation::new(scene, state)?;
        // Counted, for a last step cut in two by round-off would have its velocities half-way at the wrong time.
        for _ in 0..steps as u64 {
            let now = simulation.time();
            simulation.accelerate(|id| solution.body_acceleration(&rest[id as usize], now).map(T::of));
            simulation.advance_one(f64::INFINITY)?;
        }
        let state = simulation.state();
        (run.particles, run.steps) = (rest.len(), state.steps);
        let (mut squares, mut largest) = (0.0, 0.0_f64);
        for (p, rest) in state.by_id().into_iter().zip(&rest) {
            let off = (state.world_position(p) - solution.position(rest, state.time)).norm() / size;
            squares += off * off / bodies.len() as f64;
            largest = largest.max(off);
        }
        Ok(Errors { l2: squares.sqrt(), linf: largest })
    }
}
