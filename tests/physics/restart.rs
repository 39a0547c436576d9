//! Refused steps leave no trace; a state is all there is to a run; a place far away is a place like any other.

use snowlab_solver::collision::Contact;
use snowlab_solver::error::{Rejection, RejectionReason};
use snowlab_solver::geometry::Vector;
use snowlab_solver::step::{Workspace, step};
use snowlab_solver::{
    Checkpoint, Integrator, KernelKind, LinearSolve, Scene, SceneError, Simulation, SimulationError, State,
    StepLength, Transfer,
};

use crate::support::{elastic_scene, fixed, flip, floor, lattice, particle, scene, state};

/// A block of snow on its way into a floor, 8 m/s.
fn fall<T: snowlab_solver::Real>(transfer: Transfer) -> (Scene<T, 2>, State<T, 2>) {
    let h = 0.03125;
    let mut scene = Scene { transfer, ..scene::<T, 2>(h) };
    scene.gravity[1] = T::of(-9.81);
    scene.colliders = vec![floor(0.0, Contact::Separate, 0.3)];
    let particles = lattice(h, [-4, 1], [8, 6], 2, [1.0, -8.0]);
    let state = state(&scene, &particles);
    (scene, state)
}

#[test]
fn a_refused_step_changes_no_bit() {
    for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
        let (scene, start) = fall::<f64>(transfer);
        let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
        simulation.advance_to(0.008).expect("a stable run");
        let before = simulation.state().clone();
        let mut after = before.clone();
        let mut workspace = Workspace::new(&scene, &after).expect("a valid scene");
        for dt in [1e-2, 1.0, 1e10, f64::NAN, f64::INFINITY] {
            step(&scene, &mut after, &mut workspace, dt).expect_err("an absurd step");
            assert_eq!(after, before, "dt = {dt}");
        }
        // And a good step after refused ones is the step it would have been.
        let mut fresh = before.clone();
        step(&scene, &mut after, &mut workspace, 1e-5).expect("a good step");
        let mut clean = Workspace::new(&scene, &fresh).expect("a valid scene");
        step(&scene, &mut fresh, &mut clean, 1e-5).expect("a good step");
        assert_eq!(after, fresh);
    }
}

#[test]
fn a_step_is_refused_for_what_is_wrong_with_it() {
    let scene = elastic_scene::<f64, 2>(0.1);
    // One cell is 0.1 m: 3 m/s for 0.04 s are 1.2 cells.
    let mut alone = state(&scene, &[particle([0.0, 0.0], [3.0, 0.0], 1e-3)]);
    let mut workspace = Workspace::new(&scene, &alone).expect("a valid scene");
    let refused = step(&scene, &mut alone, &mut workspace, 0.04).expect_err("too far");
    let Rejection { particle: Some(0), reason: RejectionReason::TooFar { cells } } = refused else {
        panic!("{refused:?}")
    };
    assert!((cells - 1.2).abs() < 1e-12);
    step(&scene, &mut alone, &mut workspace, 0.03).expect("0.9 cells are allowed");
    // A uniform compression at 50 / s turns inside out (one axis: 1 - 50 dt < 0) from dt = 0.02 s on.
    let compressed = Scene { transfer: Transfer::Apic, ..scene };
    let mut particles = lattice(0.1, [-1, -1], [2, 2], 2, [0.0, 0.0]);
    particles.iter_mut().for_each(|p| p.velocity[0] = -50.0 * p.position[0]);
    let mut block = state(&compressed, &particles);
    block.motion.affine.iter_mut().for_each(|c| c[(0, 0)] = -50.0);
    let mut workspace = Workspace::new(&compressed, &block).expect("a valid scene");
    match step(&compressed, &mut block, &mut workspace, 0.021) {
        Err(Rejection { reason: RejectionReason::Inverted { determinant }, .. }) => {
            assert!((determinant + 0.05).abs() < 1e-12, "det(I + dt grad v) = {determinant}")
        }
        other => panic!("{other:?}"),
    }
    step(&compressed, &mut block, &mut workspace, 0.019).expect("det = 0.05 is allowed");
}

#[test]
fn a_run_that_cannot_go_on_says_where_and_keeps_its_state() {
    let (mut scene, start) = fall::<f64>(flip(0.95));
    scene.time_step = fixed(0.5);
    let mut simulation = Simulation::new(scene.clone(), start.clone()).expect("a valid scene");
    match simulation.advance_to(1.0) {
        Err(SimulationError::StepRejected { time, dt, halvings, .. }) => {
            assert_eq!((time, dt, halvings), (0.0, 0.5, 0));
        }
        other => panic!("{other:?}"),
    }
    assert_eq!(simulation.state().ledger.rejected_steps, 1);
    simulation.state_mut().ledger.rejected_steps = 0;
    // Sorting may have changed the order, and nothing else.
    let (kept, order) = (simulation.state(), simulation.state().by_id());
    assert_eq!((kept.time, kept.steps, &kept.ledger), (0.0, 0, &start.ledger));
    for (id, &p) in order.iter().enumerate() {
        assert_eq!(kept.motion.position[p], start.motion.position[id]);
        assert_eq!(kept.motion.velocity[p], start.motion.velocity[id]);
    }

    // With the adaptive step, halving is tried max_rejections times: nothing helps a velocity that is not a number.
    scene.time_step = Default::default();
    scene.time_step.max_rejections = 5;
    let mut broken = start;
    broken.motion.velocity[7].y = f64::NAN;
    let mut simulation = Simulation::new(scene, broken).expect("a valid scene");
    match simulation.advance_to(1.0) {
        Err(SimulationError::StepRejected { halvings, .. }) => assert_eq!(halvings, 5),
        other => panic!("{other:?}"),
    }
    assert_eq!(simulation.state().steps, 0);
}

#[test]
fn the_step_limit_stops_a_run() {
    let (mut scene, start) = fall::<f64>(flip(0.95));
    scene.time_step.max_steps = 10;
    let mut simulation = Simulation::new(scene, start).expect("a valid scene");
    let error = simulation.advance_to(1.0).expect_err("too many steps");
    assert_eq!(error, SimulationError::TooManySteps { steps: 10, time: simulation.state().time });
    assert_eq!(simulation.state().steps, 10);
}

/// A run that is saved and restored where it was told to advance to: between two looks of the watchdog.
fn check_resume<T: snowlab_solver::Real>(transfer: Transfer, kernel: KernelKind) {
    let (mut scene, start) = fall::<T>(transfer);
    scene.kernel = kernel;
    let mut whole = Simulation::new(scene.clone(), start.clone()).expect("a valid scene");
    let mut first = Simulation::new(scene.clone(), start).expect("a valid scene");
    whole.advance_to(0.0061).expect("a stable run");
    first.advance_to(0.0061).expect("a stable run");
    let steps = first.state().steps;
    assert!(steps > 20 && !steps.is_multiple_of(50), "{steps} steps");
    let mut second = Simulation::new(scene, first.state().clone()).expect("a valid scene");
    whole.advance_to(0.0126).expect("a stable run");
    second.advance_to(0.0126).expect("a stable run");
    assert_eq!(whole.state(), second.state());
    assert!(whole.state().first_contact.is_some(), "the block must have hit the floor");
}

#[test]
fn a_resumed_run_has_the_bits_of_an_uninterrupted_one() {
    for kernel in [KernelKind::Cubic, KernelKind::Quadratic] {
        check_resume::<f64>(flip(0.95), kernel);
        check_resume::<f32>(Transfer::Apic, kernel);
        check_resume::<f64>(Transfer::Mls, kernel);
    }
}

/// Steps on to `end` as a driver does that never stops on the way.
fn drive<T: snowlab_solver::Real>(
    simulation: &mut Simulation<T, 2>,
    end: f64,
    mut after_step: impl FnMut(&Simulation<T, 2>),
) {
    while simulation.time() < end || !simulation.confirm().expect("a stable run") {
        simulation.advance_one(end).expect("a stable run");
        after_step(simulation);
    }
}

/// A run that is put away at several moments, as bytes, and taken up again from each.
fn check_checkpoints<T: snowlab_solver::Real>(
    scene: Scene<T, 2>,
    start: State<T, 2>,
    end: f64,
) -> State<T, 2> {
    let mut whole = Simulation::new(scene.clone(), start).expect("a valid scene");
    let mut kept: Vec<(u64, Vec<u8>)> = Vec::new();
    drive(&mut whole, end, |simulation| {
        let due = simulation.steps() >= 15 + kept.last().map_or(0, |(steps, _)| *steps);
        if due && let Some(checkpoint) = simulation.checkpoint() {
            kept.push((simulation.steps(), postcard::to_stdvec(&checkpoint).expect("plain data")));
        }
    });
    assert!(kept.len() >= 2, "{} checkpoints in {} steps", kept.len(), whole.steps());
    for (steps, bytes) in kept {
        let checkpoint: Checkpoint<T, 2> = postcard::from_bytes(&bytes).expect("what was written");
        assert_eq!(checkpoint.particles(), whole.state().len());
        let mut second = Simulation::resume(scene.clone(), checkpoint, 2).expect("it fits");
        assert_eq!(second.steps(), steps);
        drive(&mut second, end, |_| {});
        assert!(whole.state() == second.state(), "put away at step {steps}");
    }
    whole.state().clone()
}

#[test]
fn a_run_put_away_at_any_moment_goes_on_to_the_same_bits() {
    for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
        let (scene, start) = fall::<f32>(transfer);
        check_checkpoints(scene, start, 0.03);
        let (scene, start) = fall::<f64>(transfer);
        check_checkpoints(scene, start, 0.03);
    }
    let (mut implicit, start) = fall::<f64>(Transfer::Mls);
    implicit.integrator = Integrator::SemiImplicit { beta: 1.0, solve: LinearSolve::default() };
    implicit.time_step.length = StepLength::Fixed(1e-4);
    check_checkpoints(implicit, start, 0.03);
    // A step too long, at which the watchdog goes back.
    let (mut watched, start) = crate::watchdog::disc();
    watched.time_step.length = StepLength::Adaptive { wave: Some(1.35), advection: 0.25, greatest: 1.0 };
    assert!(check_checkpoints(watched, start, 0.1).ledger.watchdog_restores > 0);
}

#[test]
fn a_checkpoint_of_another_scene_is_refused() {
    let (scene, start) = fall::<f64>(Transfer::Mls);
    let mut run = Simulation::new(scene.clone(), start).expect("a valid scene");
    let mut kept = None;
    drive(&mut run, 0.0121, |simulation| {
        if let Some(checkpoint) = simulation.checkpoint() {
            let bytes = postcard::to_stdvec(&checkpoint).expect("plain data");
            kept = Some((bytes, simulation.state().motion.velocity[0].y));
        }
    });
    let (bytes, velocity) = kept.expect("a checkpoint on the way");
    let read = || postcard::from_bytes::<Checkpoint<f64, 2>>(&bytes).expect("what was written");
    let mut others = vec![scene.clone(); 3];
    others[0].transfer = flip(0.95);
    others[1].colliders.clear();
    others[2].materials.clear();
    for other in others {
        let refused = Simulation::resume(other, read(), 1).map(|_| ()).expect_err("another scene");
        assert!(matches!(refused, SceneError::Checkpoint { .. } | SceneError::Length { .. }), "{refused}");
    }
    // The same bytes with one number that is none.
    let place = bytes.windows(8).position(|window| window == velocity.to_le_bytes()).expect("the velocity");
    let mut broken = bytes.clone();
    broken[place..place + 8].copy_from_slice(&f64::NAN.to_le_bytes());
    let broken = postcard::from_bytes::<Checkpoint<f64, 2>>(&broken).expect("a checkpoint as to its form");
    assert!(Simulation::resume(scene, broken, 1).is_err());
}

#[test]
fn outputs_are_met_exactly_and_cost_no_tiny_step() {
    let (mut scene, start) = fall::<f64>(flip(0.95));
    scene.time_step.length = StepLength::Fixed(3e-5);
    let mut simulation = Simulation::new(scene, start).expect("a valid scene");
    for frame in 1..=20 {
        let time = f64::from(frame) * 1e-3;
        simulation.advance_to(time).expect("a stable run");
        assert_eq!(simulation.state().time, time);
        // 1e-3 / 3e-5 = 33.3: 32 whole steps and two halves of the rest.
        assert_eq!(simulation.state().steps, 34 * frame as u64);
    }
}

/// A scene at 0 and the same scene at 10 km: coordinates are local, so f32 has the same bits. The positions are multiples of 2^-12 m, so
/// that adding and subtracting 10 000 m is exact in f64.
#[test]
fn a_scene_far_from_the_origin_has_the_bits_of_one_at_it() {
    for transfer in [flip(0.95), Transfer::Apic] {
        let (scene, _) = fall::<f32>(transfer);
        let particles = lattice(0.03125, [-4, 1], [8, 6], 2, [1.0, -8.0]);
        let far = Vector::<f64, 2>::new(10_000.0, -10_000.0);
        let mut shifted = particles.clone();
        shifted.iter_mut().for_each(|p| p.position += far);
        let run = |origin, particles: &[_]| {
            let state = State::<f32, 2>::at_rest(&scene, origin, particles).expect("a valid state");
            let mut simulation = Simulation::new(scene.clone(), state).expect("a valid scene");
            simulation.advance_to(0.01).expect("a stable run");
            simulation.state().clone()
        };
        let (near, distant) = (run(Vector::zeros(), &particles), run(far, &shifted));
        assert_eq!(near.motion, distant.motion);
        assert_eq!(near.constants, distant.constants);
        assert_eq!((near.time, near.steps), (distant.time, distant.steps));
        assert_eq!(near.world_position(5) + far, distant.world_position(5));
        assert_eq!(near.ledger.colliders, distant.ledger.colliders);
        assert!(near.first_contact.is_some());
    }
}
