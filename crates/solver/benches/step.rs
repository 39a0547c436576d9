//! Time of a step, in nanoseconds per particle: a ball of snow in free fall and the same ball on impact, of several bursts of steps
//! the median and the least, for both engines in turn. Words on the command line choose cases: `cargo bench -p snowlab-solver -- 2D cubic`.

use std::time::Instant;

use snowlab_solver::geometry::{Matrix, Vector, unit};
use snowlab_solver::{
    Advection, Collider, Contact, Engine, FlipShare, InitialParticle, KernelKind, Lame, Material, Real,
    Scene, Shape, Simulation, Snow, State, TimeStepControl, Transfer,
};

const ENGINES: [Engine; 2] = [Engine::Reference, Engine::Fast];
const RADIUS: f64 = 0.25;
const SPEED: f64 = 8.0;
const BURSTS: usize = 11;
/// Particle-steps in a burst (chosen: some 50 ms in 2D).
const BURST: usize = 300_000;

struct Case {
    kernel: KernelKind,
    transfer: Transfer,
    particles: usize,
}

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    // `cargo bench` says `--bench`; `cargo test --benches` does not, and only sees that all cases run.
    let timed = std::env::args().any(|word| word == "--bench");
    let flip = Transfer::Flip(FlipShare::PerStep(0.95));
    let case = |kernel, transfer, particles| Case { kernel, transfer, particles };
    use KernelKind::{Cubic, Quadratic};
    println!("ns per particle-step{:>26}{:>20}{:>18}", "reference", "fast", "ratio");
    println!("{:<36}{:>10}{:>10}{:>10}{:>10}", "case", "median", "least", "median", "least");
    bench::<f64, 2>("f64", &case(Cubic, flip, 30_000), &words, timed);
    bench::<f32, 2>("f32", &case(Cubic, Transfer::Mls, 30_000), &words, timed);
    bench::<f64, 2>("f64", &case(Cubic, Transfer::Apic, 30_000), &words, timed);
    bench::<f64, 2>("f64", &case(Quadratic, flip, 30_000), &words, timed);
    bench::<f32, 3>("f32", &case(Cubic, Transfer::Mls, 100_000), &words, timed);
    bench::<f64, 3>("f64", &case(Cubic, flip, 100_000), &words, timed);
}

/// One case in both phases, with both engines in turn.
fn bench<T: Real, const D: usize>(precision: &str, case: &Case, words: &[String], timed: bool) {
    let transfer = match case.transfer {
        Transfer::Flip(_) => "FLIP",
        Transfer::Apic => "APIC",
        Transfer::Mls => "MLS",
    };
    let thousands = case.particles / 1000;
    for (phase, gap, lead) in [("falling", 1e3, 0.0), ("impact", 0.0, 0.25 * RADIUS / SPEED)] {
        let kernel = format!("{:?}", case.kernel).to_lowercase();
        let name = format!("{D}D {kernel} {precision} {transfer} {thousands}k {phase}");
        if !words.iter().all(|word| name.split(' ').any(|part| part == word)) {
            continue;
        }
        let mut simulations = ENGINES.map(|engine| ball::<T, D>(case, engine, gap));
        if !timed {
            simulations.iter_mut().for_each(|simulation| advance(simulation, 1));
            println!("{name}: runs");
            continue;
        }
        // Free fall is alike from the first step on; an impact is under way when the body has moved by a quarter of its radius.
        for simulation in &mut simulations {
            simulation.advance_to(lead).expect("a stable run");
            advance(simulation, 3);
        }
        let steps = BURST.div_ceil(case.particles);
        let mut nanoseconds = ENGINES.map(|_| Vec::new());
        for _ in 0..BURSTS {
            for (simulation, nanoseconds) in simulations.iter_mut().zip(&mut nanoseconds) {
                let start = Instant::now();
                advance(simulation, steps);
                nanoseconds.push(start.elapsed().as_secs_f64() * 1e9 / (steps * case.particles) as f64);
            }
        }
        let [reference, fast] = nanoseconds.map(|mut nanoseconds: Vec<f64>| {
            nanoseconds.sort_by(f64::total_cmp);
            [nanoseconds[BURSTS / 2], nanoseconds[0]]
        });
        println!(
            "{name:<36}{:>10.1}{:>10.1}{:>10.1}{:>10.1}{:>8.2}",
            reference[0],
            reference[1],
            fast[0],
            fast[1],
            reference[0] / fast[0]
        );
    }
}

fn advance<T: Real, const D: usize>(simulation: &mut Simulation<T, D>, steps: usize) {
    for _ in 0..steps {
        simulation.advance_one(f64::INFINITY).expect("a stable run");
    }
}

/// A ball of snow at `SPEED` above a floor at the distance `gap` [m], with (nearly) six particles a cell.
fn ball<T: Real, const D: usize>(case: &Case, engine: Engine, gap: f64) -> Simulation<T, D> {
    let volume = if D == 2 { std::f64::consts::PI } else { 4.0 / 3.0 * std::f64::consts::PI }
        * RADIUS.powi(D as i32)
        / case.particles as f64;
    let spacing = (6.0 * volume).powf(1.0 / D as f64);
    let scene = Scene {
        spacing: T::of(spacing),
        kernel: case.kernel,
        transfer: case.transfer,
        engine,
        advection: Advection::Interpolated,
        materials: vec![Material::Snow(Snow {
            lame: Lame::from_young(1.4e5, 0.2),
            critical_compression: T::of(2.5e-2),
            critical_stretch: T::of(7.5e-3),
            hardening: T::of(10.0),
            plastic_ratio_bounds: (T::zero(), T::of(f64::INFINITY)),
        })],
        colliders: vec![Collider {
            shape: Shape::HalfSpace { point: unit::<T, D>(1) * T::of(-RADIUS - gap), normal: unit(1) },
            contact: Contact::Separate,
            friction: T::of(0.5),
            velocity: Vector::zeros(),
        }],
        gravity: unit::<T, D>(1) * T::of(-9.81),
        time_step: TimeStepControl::default(),
        energy_budget: false,
    };
    let particles: Vec<_> = evenly_spread::<D>()
        .take(case.particles)
        .map(|position| InitialParticle {
            position,
            velocity: unit::<f64, D>(1) * -SPEED,
            mass: 400.0 * volume,
            volume,
            stiffness_scale: 1.0,
            material: 0,
            deformation: Matrix::identity(),
            plastic_ratio: 1.0,
        })
        .collect();
    let state = State::at_rest(&scene, Vector::zeros(), &particles).expect("a valid body");
    Simulation::new(scene, state).expect("a valid scene")
}

/// Points in a ball about the origin: those of an additive recurrence in the cube round it, by powers of the inverse root of
/// x^(D+1) = x + 1 (Roberts 2018, "The unreasonable effectiveness of quasirandom sequences").
fn evenly_spread<const D: usize>() -> impl Iterator<Item = Vector<f64, D>> {
    let root: f64 = if D == 2 { 1.324_717_957_244_746 } else { 1.220_744_084_605_759_5 };
    (1..)
        .map(move |n| {
            Vector::from_fn(|k, _| (2.0 * (f64::from(n) * root.powi(-1 - k as i32)).fract() - 1.0) * RADIUS)
        })
        .filter(|x: &Vector<f64, D>| x.norm() <= RADIUS)
}
