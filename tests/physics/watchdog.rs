//! A step that is too long: what happens without a guard, with the watchdog, and with the adaptive step.

use snowlab_solver::collision::Contact;
use snowlab_solver::diagnostics::energies;
use snowlab_solver::{InitialParticle, Scene, Simulation, SimulationError, State, TimeStepControl, Transfer};

use crate::support::{Random, elastic_scene, fixed, flip, floor, lattice, particle, scene, state};

const H: f64 = 0.005;

fn total(scene: &Scene<f64, 2>, state: &State<f64, 2>) -> f64 {
    let e = energies(scene, state);
    e.kinetic + e.elastic + e.potential
}

/// A frozen (elastic) disc of 1264 particles that touches down at 3 cm/s.
pub fn disc() -> (Scene<f64, 2>, State<f64, 2>) {
    let mut scene = elastic_scene::<f64, 2>(H);
    scene.colliders = vec![floor(0.0, Contact::Separate, 0.3)];
    let mut body = lattice(H, [-10, 0], [20, 20], 2, [0.0, -0.03]);
    body.retain(|p| (p.position.y - 10.0 * H).hypot(p.position.x) < 10.0 * H);
    assert_eq!(body.len(), 1264);
    let start = state(&scene, &body);
    (scene, start)
}

/// dt c / h = 1.35: 12 % over what this body stands (stability.rs: 1.21).
const TOO_LONG: f64 = 1.35 * H / 22.048;

#[test]
fn without_a_guard_a_step_too_long_blows_up_in_silence() {
    let (mut scene, start) = disc();
    let before = total(&scene, &start);
    scene.time_step = fixed(TOO_LONG);
    let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
    simulation.advance_to(0.1).expect("no error: that is the trouble");
    let after = energies(&scene, simulation.state());
    assert!(after.kinetic > 50.0 * before, "kinetic energy {} J of {before} J", after.kinetic);
    assert!(after.elastic > 1000.0 * before, "elastic energy {} J of {before} J", after.elastic);
}

#[test]
fn the_watchdog_refuses_it_and_keeps_the_last_good_state() {
    let (mut scene, start) = disc();
    let before = total(&scene, &start);
    scene.time_step = TimeStepControl { watchdog_interval: 50, ..fixed(TOO_LONG) };
    let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
    match simulation.advance_to(0.1).expect_err("the watchdog must bark") {
        SimulationError::EnergyRise { time, before: low, after: high, scale, tolerance, dt } => {
            assert!(high > low + 0.01 * scale && tolerance == 0.01 && dt == TOO_LONG);
            assert!(
                scale > 0.9 * before && scale < 1.1 * before,
                "measured by {scale} J, the scene has {before} J"
            );
            assert!(time > simulation.state().time && time < 0.05, "noticed at {time} s");
        }
        other => panic!("{other}"),
    }
    let kept = simulation.state();
    assert_eq!(kept.steps % 50, 0);
    assert_eq!(kept.ledger.watchdog_restores, 1);
    assert!(
        total(&scene, kept) < 1.02 * before,
        "the state kept has {} J of {before} J",
        total(&scene, kept)
    );
}

#[test]
fn the_adaptive_step_stays_bounded_and_saves_a_bad_courant_number() {
    use snowlab_solver::StepLength::Adaptive;
    for wave in [None, Some(1.35)] {
        let (mut scene, start) = disc();
        let before = total(&scene, &start);
        scene.time_step.length = Adaptive { wave, advection: 0.25, greatest: 1.0 };
        let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
        for frame in 1..=20 {
            simulation.advance_to(0.005 * f64::from(frame)).expect("a stable run");
        }
        let end = simulation.state();
        // What the watchdog let through before it noticed is within its tolerance.
        assert!(total(&scene, end) < 1.02 * before, "{wave:?}: {} J of {before} J", total(&scene, end));
        // A C_wave that is too great is halved, once, and the run goes on from the last good state.
        let (restores, factor) = if wave.is_some() { (1, 0.5) } else { (0, 1.0) };
        assert_eq!((end.ledger.watchdog_restores, end.step_factor), (restores, factor), "{wave:?}");
        assert!(end.motion.velocity.iter().all(|v| v.norm() < 0.2));
    }
}

/// dt c / h = 1.45: the energy rises within 50 steps, and no element turns inside out.
const BLATANT: f64 = 1.45 * H / 22.048;

/// Shorter than the interval of checks: seen at the end, whatever comes between.
#[test]
fn a_run_of_fewer_steps_than_the_interval_is_watched_too() {
    let (mut scene, start) = disc();
    scene.time_step = TimeStepControl { watchdog_interval: 50, ..fixed(BLATANT) };
    let mut simulation = Simulation::new(scene.clone(), start.clone()).expect("a valid scene");
    simulation.confirm().expect("the start is sound");
    for _ in 0..49 {
        simulation.advance_one(1.0).expect("nothing is noticed yet");
    }
    let risen = total(&scene, simulation.state()) / total(&scene, &start);
    assert!(risen > 1.05, "energy rose by a factor of {risen}");
    let refused = simulation.confirm().expect_err("the watchdog must bark");
    assert!(matches!(refused, SimulationError::EnergyRise { .. }), "{refused}");
    assert_eq!((simulation.state().time, simulation.state().steps), (0.0, 0), "back at the start");
    let mut simulation = Simulation::new(scene, start).expect("a valid scene");
    simulation.advance_to(49.0 * BLATANT).expect_err("advance_to looks at the end");
}

/// However often a state is confirmed, the rise since the last check on schedule counts, not that since the last look. Here somebody
/// adds 0.4 % to the energy of a body in free flight after every step.
#[test]
fn small_rises_add_up_to_one_that_is_refused() {
    let mut scene = elastic_scene::<f64, 2>(H);
    scene.time_step = TimeStepControl { watchdog_interval: 50, ..fixed(1e-5) };
    let start = state(&scene, &lattice(H, [0, 0], [4, 4], 2, [1.0, 0.0]));
    let before = total(&scene, &start);
    let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
    simulation.confirm().expect("the start is sound");
    for steps in 1..100 {
        simulation.advance_one(1.0).expect("a stable step");
        simulation.state_mut().motion.velocity.iter_mut().for_each(|v| *v *= 1.002);
        match simulation.confirm() {
            Ok(true) => {}
            Ok(false) => panic!("a fixed step has nothing to go on with"),
            Err(refused) => {
                assert!(matches!(refused, SimulationError::EnergyRise { .. }), "{refused}");
                assert_eq!(steps, 3, "3 times 0.4 % are more than 1 %");
                // Back to what was confirmed last, and no further.
                assert_eq!(simulation.state().steps, 2);
                assert!(total(&scene, simulation.state()) < 1.01 * before);
                return;
            }
        }
    }
    panic!("the watchdog must bark");
}

/// A disc of 1500 particles of snow, at random, on its way into the floor.
fn snowball(speed: f64, transfer: Transfer) -> (Scene<f64, 2>, State<f64, 2>) {
    let mut scene = Scene { transfer, ..scene::<f64, 2>(H) };
    scene.gravity[1] = -9.81;
    scene.colliders = vec![floor(0.0, Contact::Separate, 0.3)];
    let (mut random, radius) = (Random(3), 0.05);
    let mut body: Vec<InitialParticle<2>> = Vec::new();
    while body.len() < 1500 {
        let x = [random.between(-radius, radius), random.between(-radius, radius)];
        if x[0].hypot(x[1]) < radius {
            let volume = std::f64::consts::PI * radius * radius / 1500.0;
            body.push(particle([x[0], x[1] + radius + 2.0 * H], [0.0, -speed], volume));
        }
    }
    let start = state(&scene, &body);
    (scene, start)
}

/// Greatest J_P at the end, and the greatest energy on the way, of the adaptive run.
fn adaptive(speed: f64, transfer: Transfer, time: f64) -> (f64, f64) {
    let (scene, start) = snowball(speed, transfer);
    let (before, mut greatest) = (total(&scene, &start), 0.0f64);
    let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
    while simulation.state().time < time {
        simulation.advance_one(time).expect("a stable run");
        greatest = greatest.max(total(&scene, simulation.state()) / before);
    }
    assert_eq!(simulation.state().ledger.watchdog_restores, 0);
    let ratios = &simulation.state().motion.plastic_ratio;
    assert!(ratios.iter().all(|j| *j > 0.3), "packed beyond reason");
    (ratios.iter().fold(0.0, |a, b| b.max(a)), greatest)
}

#[test]
fn snow_at_8_metres_a_second_needs_the_adaptive_step() {
    let (mut scene, start) = snowball(8.0, flip(0.95));
    // dt c / h = 0.44 at J_P = 1: half the limit, until the snow is packed.
    scene.time_step = fixed(1e-4);
    let mut simulation = Simulation::new(scene, start).expect("a valid scene");
    let refused = simulation.advance_to(0.01875).expect_err("packed snow is too stiff for this step");
    assert!(matches!(refused, SimulationError::StepRejected { .. }), "{refused}");
    for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
        let (torn, energy) = adaptive(8.0, transfer, 0.01875);
        assert!(torn < 1.5, "{transfer:?}: J_P up to {torn}");
        assert!(energy <= 1.0 + 1e-3, "{transfer:?}: energy up to {energy} of the start's");
    }
}

/// Where plastic flow eats what the unstable step creates, energy does not rise and neither guard sees anything: particles are torn
/// by noise, J_P ends above 5 where the adaptive run has hardly more than 1. Only the adaptive step protects from this.
#[test]
fn plastic_flow_hides_an_unstable_step_from_every_guard() {
    let (mut scene, start) = snowball(3.0, flip(0.95));
    let before = total(&scene, &start);
    scene.time_step = TimeStepControl { watchdog_interval: 50, ..fixed(1.3e-4) };
    let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
    simulation.advance_to(0.05).expect("nothing is noticed");
    assert!(total(&scene, simulation.state()) < before);
    let torn = simulation.state().motion.plastic_ratio.iter().fold(0.0f64, |a, b| b.max(a));
    let (sound, _) = adaptive(3.0, flip(0.95), 0.05);
    assert!(torn > 5.0 && sound < 1.5, "J_P up to {torn} at the fixed step, {sound} at the adaptive one");
}
