//! Where the explicit step stops being stable, measured on elastic material, beside what docs/stability.md derives.

use snowlab_solver::diagnostics::energies;
use snowlab_solver::geometry::Vector;
use snowlab_solver::kernel::{Cubic, Quadratic};
use snowlab_solver::step::{Workspace, step};
use snowlab_solver::timestep::{meet, step_length, wave_limit};
use snowlab_solver::{FlipShare, KernelKind, Material, Scene, Simulation, Snow, State, StepLength, Transfer};

use crate::kernels::gradient_sum;
use crate::support::{
    KERNELS, Random, assert_near, elastic, elastic_scene, fixed, flip, lattice, particle, scene, snow, state,
    transfers,
};

/// c = sqrt((2 mu + D lambda) V / m) of a particle of the default density [m/s].
fn wave_speed<const D: usize>() -> f64 {
    (elastic::<f64>().lame.wave_modulus::<D>() / 400.0).sqrt()
}

/// Whether `steps` steps of dt = `courant` h / c leave the energy of a slightly disturbed body (strains of 1e-6)
/// bounded. Just below its limit a step without damping swings by a factor of 50 or more; above it 1e12 is soon reached.
fn bounded<const D: usize>(scene: &Scene<f64, D>, start: &State<f64, D>, courant: f64, steps: usize) -> bool {
    let (mut state, dt) = (start.clone(), courant * scene.spacing / wave_speed::<D>());
    let mut workspace = Workspace::new(scene, &state).expect("a valid scene");
    let total = |state: &State<f64, D>| {
        let e = energies(scene, state);
        e.kinetic + e.elastic
    };
    let before = total(&state);
    for number in 1..=steps {
        if step(scene, &mut state, &mut workspace, dt).is_err() {
            return false;
        }
        if number % 50 == 0 && !(total(&state) < 1e6 * before) {
            return false;
        }
    }
    true
}

fn check_one<const D: usize>(kernel: KernelKind, transfer: Transfer, limit: f64) {
    let scene = Scene { kernel, transfer, ..elastic_scene::<f64, D>(1.0) };
    let squeezed = |place: f64| {
        let mut start = state(&scene, &[particle([place; D], [0.0; D], 0.3)]);
        start.motion.deformation[0] *= 1.0 - 1e-6;
        start
    };
    // The worst place between nodes, on all axes at once.
    let place = |i: i32| f64::from(i) * 2.5e-3 - 1e-9;
    let sum =
        |x| if kernel == KernelKind::Cubic { gradient_sum::<Cubic>(x) } else { gradient_sum::<Quadratic>(x) };
    let worst = (0..=200).map(place).max_by(|a, b| sum(*a).total_cmp(&sum(*b))).expect("places");
    let what = format!("{D}D {kernel:?} {transfer:?}");
    assert!(bounded(&scene, &squeezed(worst), 0.99 * limit, 3000), "{what}: unstable at 0.99 of {limit}");
    assert!(!bounded(&scene, &squeezed(worst), 1.01 * limit, 3000), "{what}: stable at 1.01 of {limit}");
    for x in (0..=200).step_by(20).map(place) {
        assert!(
            bounded(&scene, &squeezed(x), 0.99 * limit, 500),
            "{what}: unstable at 0.99 of {limit}, x = {x}"
        );
    }
}

/// The last column of the table in docs/stability.md, which is `wave_limit`.
const ONE: [(KernelKind, Transfer, f64); 6] = [
    (KernelKind::Cubic, Transfer::Flip(FlipShare::PerStep(0.95)), 0.798),
    (KernelKind::Cubic, Transfer::Apic, 1.105),
    (KernelKind::Cubic, Transfer::Mls, 1.155),
    (KernelKind::Quadratic, Transfer::Flip(FlipShare::PerStep(0.95)), 0.577),
    (KernelKind::Quadratic, Transfer::Apic, 0.707),
    (KernelKind::Quadratic, Transfer::Mls, 1.0),
];

#[test]
fn one_particle_is_stable_up_to_the_limit_and_no_further() {
    for (kernel, transfer, limit) in ONE {
        assert_near(wave_limit(kernel, transfer), limit, 1e-3, &format!("{kernel:?} {transfer:?}"));
        check_one::<2>(kernel, transfer, limit);
        check_one::<3>(kernel, transfer, limit);
    }
    // Whatever the share, FLIP hands no velocity gradient on.
    check_one::<2>(KernelKind::Cubic, flip(0.0), ONE[0].2);
    check_one::<2>(KernelKind::Cubic, flip(1.0), ONE[0].2);
}

/// A block of 8 by 8 cells, 4 particles in each: the table's columns for a lattice and for random placement.
const BULK: [(KernelKind, Transfer, f64, f64); 6] = [
    (KernelKind::Cubic, Transfer::Flip(FlipShare::PerStep(0.95)), 1.21, 1.06),
    (KernelKind::Cubic, Transfer::Apic, 1.51, 1.37),
    (KernelKind::Cubic, Transfer::Mls, 1.52, 1.35),
    (KernelKind::Quadratic, Transfer::Flip(FlipShare::PerStep(0.95)), 0.97, 0.86),
    (KernelKind::Quadratic, Transfer::Apic, 1.14, 1.09),
    (KernelKind::Quadratic, Transfer::Mls, 1.33, 1.17),
];

#[test]
fn bodies_are_stable_beyond_the_limit_of_one_particle() {
    for (kernel, transfer, regular, random) in BULK {
        for (at_random, limit) in [(false, regular), (true, random)] {
            let scene = Scene { kernel, transfer, ..elastic_scene::<f64, 2>(1.0) };
            let mut random = Random(5);
            let mut body = lattice(1.0, [0, 0], [8, 8], 2, [0.0; 2]);
            for p in &mut body {
                if at_random {
                    p.position = Vector::<f64, 2>::from_fn(|_, _| random.between(0.0, 8.0));
                }
                p.velocity = random.vector(1e-5);
            }
            let start = state(&scene, &body);
            let what = format!("{kernel:?} {transfer:?}, at random: {at_random}");
            assert!(limit > wave_limit(kernel, transfer));
            assert!(bounded(&scene, &start, 0.97 * limit, 1000), "{what}: unstable at 0.97 of {limit}");
            assert!(!bounded(&scene, &start, 1.04 * limit, 1000), "{what}: stable at 1.04 of {limit}");
        }
    }
}

/// Fixed corotated material stiffens where it is stretched: the default step follows.
#[test]
fn strongly_deformed_elastic_particles_stay_bounded_at_the_default_step() {
    check_deformed(Material::Elastic(elastic()));
}

/// Snow whose yield surface lies beyond any of these stretches is such a material. (Without hardening: it would add energy of its
/// own where the swing goes through the other side of the yield surface.)
#[test]
fn strongly_deformed_snow_of_great_critical_stretch_stays_bounded_too() {
    let yields_late = Snow { critical_stretch: 9.0, critical_compression: 0.9, hardening: 0.0, ..snow() };
    check_deformed(Material::Snow(yields_late));
}

fn check_deformed(material: Material<f64>) {
    for kernel in KERNELS {
        for transfer in [flip(0.95), Transfer::Apic, Transfer::Mls] {
            for stretch in [0.5, 0.8, 1.5, 2.5] {
                let scene = Scene { kernel, transfer, materials: vec![material], ..scene::<f64, 2>(1.0) };
                let mut start = state(&scene, &[particle([0.2, 0.45], [0.0; 2], 0.3)]);
                start.motion.deformation[0] *= stretch;
                let total =
                    |state: &State<f64, 2>| energies(&scene, state).kinetic + energies(&scene, state).elastic;
                let before = total(&start);
                let mut simulation = Simulation::new(scene.clone(), start).expect("a valid scene");
                for _ in 0..400 {
                    simulation.advance_one(1e3).expect("a stable step");
                    let now = total(simulation.state());
                    // The swing of a step without damping: no more in 20 000 steps than in the first few.
                    assert!(
                        now <= 2.5 * before,
                        "{kernel:?} {transfer:?} F = {stretch}: {now} J of {before} J"
                    );
                }
                assert_eq!(simulation.state().ledger.rejected_steps, 0);
            }
        }
    }
}

#[test]
fn the_step_is_the_least_of_waves_advection_and_the_greatest() {
    let h = 0.01;
    let mut scene = scene::<f64, 2>(h);
    let mut body = lattice(h, [0, 0], [4, 4], 2, [0.0, 0.0]);
    // c^2 = (2 mu + 2 lambda) V / m: half the mass in the same volume is faster by sqrt 2.
    let soft = step_length(&scene, &state(&scene, &body));
    assert_near(
        soft,
        0.5 * wave_limit(scene.kernel, scene.transfer) * h / wave_speed::<2>(),
        1e-12,
        "at rest",
    );
    assert_near(wave_speed::<2>(), 22.047_927_592_204_92, 1e-9, "c of the default snow in 2D");
    body[7].mass *= 0.5;
    assert_near(step_length(&scene, &state(&scene, &body)), soft / 2f64.sqrt(), 1e-12, "a light particle");
    body[7].mass *= 2.0;
    body[7].stiffness_scale = 9.0;
    assert_near(step_length(&scene, &state(&scene, &body)), soft / 3.0, 1e-12, "a stiff particle");
    body[7].stiffness_scale = 1.0;

    // One particle packed to J_P = 0.5 shortens it sqrt(e^5) = 12.18 times; a torn one, J_P = 2, changes nothing.
    let mut packed = state(&scene, &body);
    packed.set_plastic_ratio(&scene, 3, 0.5);
    packed.set_plastic_ratio(&scene, 4, 2.0);
    assert_near(soft / step_length(&scene, &packed), 12.182_493_960_703_473, 1e-12, "packed snow");
    packed.step_factor = 0.25;
    assert_near(
        soft / step_length(&scene, &packed),
        4.0 * 12.182_493_960_703_473,
        1e-12,
        "the watchdog's factor",
    );

    body[2].velocity.x = 400.0;
    assert_near(step_length(&scene, &state(&scene, &body)), 0.25 * h / 400.0, 1e-12, "a fast particle");
    body[2].velocity.x = 0.0;
    scene.time_step.length = StepLength::Adaptive { wave: Some(0.1), advection: 0.25, greatest: 1.0 };
    assert_near(
        step_length(&scene, &state(&scene, &body)),
        0.1 * h / wave_speed::<2>(),
        1e-12,
        "C_wave as given",
    );
    scene.time_step.length = StepLength::Adaptive { wave: None, advection: 0.25, greatest: 1e-7 };
    assert_eq!(step_length(&scene, &state(&scene, &body)), 1e-7);
    assert_eq!(step_length(&scene, &state(&scene, &[])), 1e-7);
    scene.time_step = fixed(3e-4);
    assert_eq!(step_length(&scene, &packed), 3e-4);
}

/// The yield surface of snow in use keeps stretches so small that c is that of F = I, to the last bit.
#[test]
fn the_step_of_snow_in_use_does_not_look_at_stretches() {
    let at = |critical_stretch: f64| {
        let mut scene = scene::<f64, 3>(0.01);
        scene.materials = vec![Material::Snow(Snow { critical_stretch, ..snow() })];
        let mut state = state(&scene, &[particle([0.0; 3], [0.0; 3], 1e-7)]);
        let rest = step_length(&scene, &state);
        state.motion.deformation[0] *= 1.0 + critical_stretch;
        rest / step_length(&scene, &state)
    };
    assert_eq!(at(7.5e-3), 1.0);
    assert_eq!(at(0.01), 1.0);
    let volume = 1.1f64.powi(3);
    assert_near(at(0.1), (volume * (2.0 * volume - 1.0)).sqrt(), 1e-12, "10 %");
}

#[test]
fn steps_meet_an_output_without_a_tiny_last_one() {
    assert_eq!(meet(1.0, 5.0), 1.0);
    assert_eq!(meet(1.0, 2.0), 1.0);
    assert_eq!(meet(1.0, 1.75), 0.875);
    assert_eq!(meet(1.0, 1.0), 1.0);
    assert_eq!(meet(1.0, 0.25), 0.25);
    assert_eq!(meet(f64::INFINITY, 0.25), 0.25);
}

/// The default halves the limit of one particle, in every kernel and transfer, in f32 and 3D too.
#[test]
fn the_default_step_is_half_the_limit() {
    for kernel in KERNELS {
        for transfer in transfers() {
            let scene = Scene { kernel, transfer, ..elastic_scene::<f32, 3>(0.0625) };
            let body = [particle([0.1; 3], [0.0; 3], 0.3)];
            let courant = step_length(&scene, &state(&scene, &body)) * wave_speed::<3>() / 0.0625;
            assert_near(courant, 0.5 * wave_limit(kernel, transfer), 1e-6, "C_wave");
        }
    }
}

/// Two particles in one place with opposite velocities: the grid stands still, so each step keeps the FLIP share of the velocity and
/// nothing else happens. A share given as a rate leaves share^(t / reference), whatever the steps.
#[test]
fn a_flip_share_given_as_a_rate_damps_alike_at_every_step() {
    let left = |share, dt: f64, time: f64| {
        let transfer = Transfer::Flip(share);
        let scene = Scene { transfer, time_step: fixed(dt), ..scene::<f64, 2>(0.1) };
        let pair = [particle([0.03, 0.01], [1.0, 0.0], 1e-3), particle([0.03, 0.01], [-1.0, 0.0], 1e-3)];
        let mut simulation = Simulation::new(scene.clone(), state(&scene, &pair)).expect("a valid scene");
        simulation.advance_to(time).expect("a stable run");
        (simulation.state().motion.velocity[0].x.abs(), simulation.state().ledger.damping)
    };
    let rate = FlipShare::Rate { share: 0.95, reference_step: 1e-5 };
    for dt in [1e-5, 2.5e-6, 3.3e-6, 4e-5] {
        let (speed, damping) = left(rate, dt, 4e-4);
        assert_near(speed, 0.95f64.powi(40), 1e-9, &format!("rate, dt = {dt}"));
        let steps = (4e-4 / dt).ceil();
        assert_near(damping, steps * (1.0 - 0.95f64.powf(40.0 / steps)), 0.02, "the ledger's sum of 1 - a");
    }
    assert_near(left(FlipShare::PerStep(0.95), 1e-5, 4e-4).0, 0.95f64.powi(40), 1e-9, "per step, 40 steps");
    assert_near(left(FlipShare::PerStep(0.95), 4e-5, 4e-4).0, 0.95f64.powi(10), 1e-9, "per step, 10 steps");
}
