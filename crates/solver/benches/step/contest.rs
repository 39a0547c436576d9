//! One row: all contestants in turn, in short bursts from the same state.

use std::time::{Duration, Instant};

use snowlab_solver::timestep::step_length;
use snowlab_solver::{Engine, Real, Scene, Simulation, State};

use crate::ball::Ball;
use crate::decomposition::{Decomposition, General, Own};
use crate::naive::Naive;
use crate::rows::{Row, Size};

/// Who takes the steps; the fast engine with its number of threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Contestant {
    Naive,
    NaiveOwnSvd,
    Reference,
    Fast(usize),
}

/// Nanoseconds a particle-step.
#[derive(Clone, Copy, Debug)]
pub struct Time {
    pub contestant: Contestant,
    pub median: f64,
    pub least: f64,
}

/// What a row's contestants took.
#[derive(Clone, Debug)]
pub struct Outcome {
    pub times: Vec<Time>,
    /// Of the fast engine, for particles and grid.
    pub bytes_per_particle: f64,
    /// The share of the particles that yield in the first step.
    pub yielding: f64,
}

/// The fast engine sorts in every 16th step at least: a burst is so many steps, or a multiple, that each has its share of sorting. The
/// watchdog, which looks every 50 steps, looks in the untimed first one.
const FAST_STEPS: usize = 16;
/// Particle-steps in a burst (chosen: some 30 ms of the fast engine in 3D, 150 ms of the naive step: long beside the clock, short beside
/// the changes of a shared machine's load).
const FAST_BURST: usize = 300_000;
const PLAIN_BURST: usize = 200_000;

impl Size {
    pub fn contestants(self) -> &'static [Contestant] {
        use Contestant::{Fast, Naive, NaiveOwnSvd, Reference};
        match self {
            Size::Sweep => &[Fast(1), Fast(2)],
            Size::Quick | Size::Full | Size::Tried => &[Naive, NaiveOwnSvd, Reference, Fast(1), Fast(2)],
        }
    }

    /// Bursts of each contestant (chosen: a median of 11 shrugs off five disturbed ones; a burst of a million particles is long).
    fn bursts(self) -> usize {
        match self {
            Size::Quick | Size::Sweep => 11,
            Size::Full => 7,
            Size::Tried => 1,
        }
    }
}

/// Measures a row of `N` nodes a particle and axis.
pub fn run<T: Real, const D: usize, const N: usize>(row: &Row, size: Size) -> Outcome {
    let start = Start::<T, D>::of(row);
    let contestants = size.contestants();
    let mut nanoseconds = vec![Vec::new(); contestants.len()];
    for _ in 0..size.bursts() {
        for (contestant, nanoseconds) in contestants.iter().zip(&mut nanoseconds) {
            let steps = steps(*contestant, row.particles, size);
            let time = start.burst::<N>(*contestant, steps);
            nanoseconds.push(time.as_secs_f64() * 1e9 / (steps * row.particles) as f64);
        }
    }
    let times = contestants.iter().zip(nanoseconds).map(|(&contestant, mut nanoseconds)| {
        nanoseconds.sort_by(f64::total_cmp);
        Time { contestant, median: nanoseconds[nanoseconds.len() / 2], least: nanoseconds[0] }
    });
    let (bytes_per_particle, yielding) = start.first_step();
    Outcome { times: times.collect(), bytes_per_particle, yielding }
}

fn steps(contestant: Contestant, particles: usize, size: Size) -> usize {
    match (size, contestant) {
        (Size::Tried, _) => 1,
        (_, Contestant::Fast(_)) => FAST_BURST.div_ceil(particles).next_multiple_of(FAST_STEPS),
        _ => (PLAIN_BURST / particles).max(1),
    }
}

/// Where every burst begins.
struct Start<T: Real, const D: usize> {
    scene: Scene<T, D>,
    state: State<T, D>,
    /// Of the naive step [s].
    dt: f64,
}

impl<T: Real, const D: usize> Start<T, D> {
    fn of(row: &Row) -> Self {
        let (scene, state) = row.ball().build::<T, D>();
        let mut simulation = Simulation::with_threads(scene.clone(), state, 2).expect("a valid scene");
        simulation.advance_to(row.lead()).expect("a stable run");
        advance(&mut simulation, 3);
        let mut state = simulation.state().clone();
        state.steps = 0;
        // chosen: the hardening of a burst leaves it stable.
        let dt = 0.5 * step_length(&scene, &state);
        Start { scene, state, dt }
    }

    /// A simulation that is loaded and warm.
    fn simulation(&self, engine: Engine, threads: usize) -> Simulation<T, D> {
        let scene = Scene { engine, ..self.scene.clone() };
        let mut simulation =
            Simulation::with_threads(scene, self.state.clone(), threads).expect("a valid scene");
        advance(&mut simulation, 1);
        simulation
    }

    fn burst<const N: usize>(&self, contestant: Contestant, steps: usize) -> Duration {
        match contestant {
            Contestant::Naive => self.naive_burst::<N, General>(steps),
            Contestant::NaiveOwnSvd => self.naive_burst::<N, Own>(steps),
            Contestant::Reference => timed(|| self.simulation(Engine::Reference, 1), steps, advance),
            Contestant::Fast(threads) => timed(|| self.simulation(Engine::Fast, threads), steps, advance),
        }
    }

    fn naive_burst<const N: usize, S: Decomposition>(&self, steps: usize) -> Duration {
        let dt = T::of(self.dt);
        let body = || {
            let mut naive = Naive::<T, D, N>::new(&self.scene, &self.state);
            naive.step::<S>(dt);
            naive
        };
        timed(body, steps, |naive, steps| (0..steps).for_each(|_| naive.step::<S>(dt)))
    }

    /// Bytes a particle, and the share of the particles that yield.
    fn first_step(&self) -> (f64, f64) {
        let simulation = self.simulation(Engine::Fast, 1);
        let after = simulation.state();
        let pairs = self.state.by_id().into_iter().zip(after.by_id());
        let ratios =
            |(p, q): (usize, usize)| (self.state.motion.plastic_ratio[p], after.motion.plastic_ratio[q]);
        let yielding = pairs.map(ratios).filter(|(before, after)| before != after).count();
        let particles = self.state.len() as f64;
        (simulation.bytes() as f64 / particles, yielding as f64 / particles)
    }
}

/// Seconds a step of the falling `ball` by the fast engine: the median of 11 bursts.
pub fn burst_of<T: Real, const D: usize>(ball: &Ball, threads: usize) -> f64 {
    let (scene, state) = ball.build::<T, D>();
    let dt = 0.5 * step_length(&scene, &state);
    let start = Start { scene, state, dt };
    let steps = steps(Contestant::Fast(threads), ball.particles, Size::Quick);
    let mut seconds: Vec<f64> = (0..Size::Quick.bursts())
        .map(|_| {
            let burst = timed(|| start.simulation(Engine::Fast, threads), steps, advance);
            burst.as_secs_f64() / steps as f64
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

/// How long `steps` steps take of what `body` makes, whose making is not timed.
fn timed<B>(body: impl Fn() -> B, steps: usize, advance: impl Fn(&mut B, usize)) -> Duration {
    let mut body = body();
    let start = Instant::now();
    advance(&mut body, steps);
    start.elapsed()
}

fn advance<T: Real, const D: usize>(simulation: &mut Simulation<T, D>, steps: usize) {
    for _ in 0..steps {
        simulation.advance_one(f64::INFINITY).expect("a stable run");
    }
}
