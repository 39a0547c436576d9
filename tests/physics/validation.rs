//! What a scene and an initial state are refused for, one value at a time.

use snowlab_solver::collision::{Collider, Contact};
use snowlab_solver::geometry::{Matrix, Shape, Vector};
use snowlab_solver::{
    FlipShare, InitialParticle, Lame, Material, Scene, SceneError, Simulation, Snow, State, StepLength,
    Transfer,
};

use crate::support::{floor, half_space, particle, scene, snow, vector};

const NAN: f64 = f64::NAN;
const INF: f64 = f64::INFINITY;

fn base() -> Scene<f64, 2> {
    let mut scene = scene(0.1);
    scene.colliders = vec![floor(0.0, Contact::Separate, 0.5)];
    scene
}

#[track_caller]
fn refused(quantity: &str, change: impl Fn(&mut Scene<f64, 2>)) {
    let mut scene = base();
    change(&mut scene);
    match scene.validate() {
        Err(SceneError::OutOfRange { quantity: found, allowed, .. }) => {
            assert_eq!(found, quantity);
            assert!(!allowed.is_empty());
        }
        other => panic!("{quantity}: {other:?}"),
    }
    // The same on every way in.
    assert!(State::at_rest(&scene, Vector::<f64, 2>::zeros(), &[]).is_err());
    let state = State::at_rest(&base(), Vector::<f64, 2>::zeros(), &[]).expect("a valid scene");
    assert!(Simulation::new(scene, state).is_err());
}

fn with_snow(change: impl Fn(&mut Snow<f64>)) -> impl Fn(&mut Scene<f64, 2>) {
    move |scene| {
        let mut material = snow();
        change(&mut material);
        scene.materials = vec![Material::Snow(material)];
    }
}

#[test]
fn the_scene_that_the_others_are_made_from_is_valid() {
    base().validate().expect("valid");
    assert!(Scene::<f64, 4> { ..crate::support::scene(0.1) }.validate().is_err(), "D is 2 or 3");
}

#[test]
fn spacing_gravity_and_materials() {
    for value in [0.0, -1.0, NAN, INF] {
        refused("spacing", |s| s.spacing = value);
    }
    for value in [NAN, INF] {
        refused("gravity", |s| s.gravity[1] = value);
    }
    refused("materials", |s| s.materials.clear());
    for (young, poisson) in [(0.0, 0.2), (-1.0, 0.2), (NAN, 0.2), (INF, 0.2), (1e5, NAN), (1e5, -1.5)] {
        refused("shear modulus mu", with_snow(|m| m.lame = Lame::from_young(young, poisson)));
    }
    for poisson in [0.5, 0.6, -0.1] {
        refused("first Lame parameter lambda", with_snow(|m| m.lame = Lame::from_young(1e5, poisson)));
    }
    for value in [0.0, 1.0, 1.5, -0.1, NAN] {
        refused("critical compression", with_snow(|m| m.critical_compression = value));
    }
    for value in [0.0, -0.1, NAN, INF] {
        refused("critical stretch", with_snow(|m| m.critical_stretch = value));
    }
    for value in [-0.1, 101.0, NAN] {
        refused("hardening", with_snow(|m| m.hardening = value));
    }
    for value in [-0.1, 1.0, NAN] {
        refused("lower bound of J_P", with_snow(|m| m.plastic_ratio_bounds.0 = value));
    }
    for value in [1.0, 0.5, NAN] {
        refused("upper bound of J_P", with_snow(|m| m.plastic_ratio_bounds.1 = value));
    }
    for value in [0.9, -1.0, NAN] {
        refused("limit of hardening", with_snow(|m| m.hardening_limit = value));
    }
    // The second of two materials is looked at too.
    refused("hardening", |s| s.materials.push(Material::Snow(Snow { hardening: NAN, ..snow() })));
}

#[test]
fn transfer_and_time_step() {
    for value in [-0.1, 1.1, NAN] {
        refused("FLIP share", |s| s.transfer = Transfer::Flip(FlipShare::PerStep(value)));
        refused("FLIP share", |s| {
            s.transfer = Transfer::Flip(FlipShare::Rate { share: value, reference_step: 1e-5 })
        });
    }
    for value in [0.0, -1.0, NAN, INF] {
        refused("FLIP reference step", |s| {
            s.transfer = Transfer::Flip(FlipShare::Rate { share: 0.9, reference_step: value })
        });
        refused("fixed time step", |s| s.time_step.length = StepLength::Fixed(value));
        let adaptive = |wave, advection, greatest| StepLength::Adaptive { wave, advection, greatest };
        refused("wave Courant number", |s| s.time_step.length = adaptive(Some(value), 0.25, 1.0));
        refused("advective Courant number", |s| s.time_step.length = adaptive(None, value, 1.0));
        refused("greatest time step", |s| s.time_step.length = adaptive(None, 0.25, value));
    }
    refused("advective Courant number", |s| {
        s.time_step.length = StepLength::Adaptive { wave: None, advection: 1.01, greatest: 1.0 }
    });
    for value in [-0.01, NAN, INF] {
        refused("watchdog tolerance", |s| s.time_step.watchdog_tolerance = value);
    }
}

#[test]
fn colliders() {
    for value in [-0.1, NAN, INF] {
        refused("collider friction", |s| s.colliders[0].friction = value);
    }
    for value in [NAN, INF] {
        refused("collider velocity", |s| s.colliders[0].velocity[0] = value);
        refused("collider position", |s| {
            s.colliders[0].shape =
                Shape::HalfSpace { point: vector([value, 0.0]), normal: vector([0.0, 1.0]) }
        });
        refused("collider position", |s| {
            s.colliders[0].shape = Shape::Ball { centre: vector([0.0, value]), radius: 1.0 }
        });
        refused("collider position", |s| {
            s.colliders[0].shape = Shape::Box {
                centre: vector([0.0, value]),
                half_extent: vector([1.0, 1.0]),
                orientation: Matrix::identity(),
            }
        });
    }
    for normal in [[0.0, 2.0], [0.0, 0.0], [NAN, 0.0]] {
        refused("half-space normal length", |s| {
            s.colliders[0].shape = Shape::HalfSpace { point: vector([0.0, 0.0]), normal: vector(normal) }
        });
    }
    for value in [0.0, -1.0, NAN, INF] {
        refused("ball collider radius", |s| {
            s.colliders[0].shape = Shape::Ball { centre: vector([0.0, 0.0]), radius: value }
        });
        refused("box collider half extent", |s| {
            s.colliders[0].shape = Shape::Box {
                centre: vector([0.0, 0.0]),
                half_extent: vector([1.0, value]),
                orientation: Matrix::identity(),
            }
        });
    }
    let mut mirrored = Matrix::<f64, 2>::identity();
    mirrored[(0, 0)] = -1.0;
    for orientation in [
        mirrored,
        Matrix::<f64, 2>::zeros(),
        Matrix::<f64, 2>::identity() * 2.0,
        Matrix::<f64, 2>::repeat(NAN),
    ] {
        refused("box collider orientation", |s| {
            s.colliders[0].shape =
                Shape::Box { centre: vector([0.0, 0.0]), half_extent: vector([1.0, 1.0]), orientation }
        });
    }
}

#[test]
fn mirrors_must_be_static_planes_of_nodes() {
    let with = |collider: Collider<f64, 2>| {
        let mut scene = base();
        scene.colliders.push(collider);
        scene.validate()
    };
    with(half_space(0, 1.0, 0.3, Contact::Mirror)).expect("3 cells");
    with(half_space(0, -1.0, -0.5, Contact::Mirror)).expect("-5 cells");
    let tilted = Shape::HalfSpace { point: vector([0.0, 0.0]), normal: vector([0.6, 0.8]) };
    let ball = Shape::Ball { centre: vector([0.0, 0.0]), radius: 1.0 };
    let good = half_space(0, 1.0, 0.3, Contact::Mirror);
    for (collider, reason) in [
        (half_space(0, 1.0, 0.35, Contact::Mirror), "cells"),
        (Collider { shape: tilted, ..good }, "normal"),
        (Collider { shape: ball, ..good }, "half-space"),
        (Collider { velocity: vector([1.0, 0.0]), ..good }, "moves"),
    ] {
        match with(collider) {
            Err(SceneError::Mirror { reason: found }) => assert!(found.contains(reason), "{found}"),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn particles() {
    type Change = fn(&mut InitialParticle<2>, f64);
    let fields: [(&str, Change, &[f64]); 5] = [
        ("position", |p, v| p.position[1] = v, &[NAN, INF]),
        ("velocity", |p, v| p.velocity[0] = v, &[NAN, INF]),
        ("mass", |p, v| p.mass = v, &[0.0, -1.0, NAN, INF]),
        ("volume", |p, v| p.volume = v, &[0.0, -1.0, NAN, INF]),
        ("stiffness scale", |p, v| p.stiffness_scale = v, &[0.0, -1.0, NAN, INF]),
    ];
    for (quantity, change, values) in fields {
        for &value in values {
            let mut particles = vec![particle([0.0, 0.0], [0.0, 0.0], 1.0); 3];
            change(&mut particles[2], value);
            match State::<f64, 2>::at_rest(&base(), Vector::zeros(), &particles) {
                Err(SceneError::Particle { particle: 2, quantity: found, .. }) => assert_eq!(found, quantity),
                other => panic!("{quantity}: {other:?}"),
            }
        }
    }
    let mut stray = particle([0.0, 0.0], [0.0, 0.0], 1.0);
    stray.material = 1;
    let error = State::<f64, 2>::at_rest(&base(), Vector::zeros(), &[stray]).expect_err("no such material");
    assert_eq!(error.to_string(), "particle 0: material is 1; allowed: an index of the scene's");
    // Positive in f64 but nothing in f32.
    let mut light = particle([0.0, 0.0], [0.0, 0.0], 1.0);
    light.mass = 1e-60;
    let scene = crate::support::scene::<f32, 2>(0.1);
    let error = State::<f32, 2>::at_rest(&scene, Vector::zeros(), &[light]).expect_err("vanishes in f32");
    assert!(matches!(error, SceneError::Particle { quantity: "mass", .. }), "{error}");
}

/// A state that does not fit together is refused before a step reads past the end of a field.
#[test]
fn fields_of_different_lengths() {
    let scene = base();
    let whole =
        State::<f64, 2>::at_rest(&scene, Vector::zeros(), &vec![particle([0.0, 0.0], [0.0, 0.0], 1.0); 3])
            .expect("a valid state");
    type Change = fn(&mut State<f64, 2>);
    let changes: [(&str, Change); 12] = [
        ("velocity", |s| s.motion.velocity.truncate(2)),
        ("affine", |s| s.motion.affine.push(Matrix::zeros())),
        ("deformation", |s| s.motion.deformation.truncate(2)),
        ("plastic_ratio", |s| s.motion.plastic_ratio.truncate(2)),
        ("stiffness", |s| s.motion.stiffness.truncate(2)),
        ("mass", |s| s.constants.mass.truncate(2)),
        ("volume", |s| s.constants.volume.truncate(2)),
        ("stiffness_scale", |s| s.constants.stiffness_scale.truncate(2)),
        ("material", |s| s.constants.material.truncate(2)),
        ("id", |s| s.constants.id.truncate(2)),
        ("ledger", |s| s.ledger.colliders.clear()),
        ("velocity", |s| s.motion.velocity.clear()),
    ];
    for (field, change) in changes {
        let mut broken = whole.clone();
        change(&mut broken);
        match Simulation::new(scene.clone(), broken) {
            Err(SceneError::Length { field: found, .. }) => assert_eq!(found, field),
            other => panic!("{field}: {:?}", other.err()),
        }
    }
    // A state made without affine matrices does not fit an APIC scene.
    let apic = Scene { transfer: Transfer::Apic, ..scene };
    assert!(matches!(Simulation::new(apic, whole), Err(SceneError::Length { field: "affine", .. })));
}
