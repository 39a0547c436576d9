//! A strain path through both yield limits: the material is stretched, packed and stretched again along one axis, inside a real step.

use snowlab_solver::geometry::Vector;
use snowlab_solver::{KernelKind, Simulation, State, Transfer};

use super::Setting;
use super::evidence::{Check, Evidence, EvidenceFigure};
use super::scenes::{
    CRITICAL_COMPRESSION, CRITICAL_STRETCH, HARDENING, axial_modulus, fixed_step, lattice, scene, snow,
};
use crate::figure::axis::Scale;
use crate::figure::curves::{Curve, Curves, Quantity, Spread, curves};
use crate::table::{Row, Table};

/// Total stretches at which the path turns (chosen: past yield each time, and far enough to harden visibly).
const TURNS: [f64; 4] = [1.0, 1.02, 0.95, 1.0];
/// Grid spacing [m]; without influence.
const SPACING: f64 = 0.01;

/// A point of the path.
struct Point {
    stretch: f64,
    elastic_stretch: f64,
    plastic_ratio: f64,
    stress: f64,
}

/// The axial stretch, the elastic part of it, J_P and tau_yy of the closed form.
fn closed_form(path: &[f64]) -> Vec<Point> {
    let mut ratio = 1.0;
    let point = |&stretch: &f64| {
        let elastic = (stretch / ratio).clamp(1.0 - CRITICAL_COMPRESSION, 1.0 + CRITICAL_STRETCH);
        ratio = stretch / elastic;
        let modulus = axial_modulus() * libm::exp(HARDENING * (1.0 - ratio));
        Point {
            stretch,
            elastic_stretch: elastic,
            plastic_ratio: ratio,
            stress: modulus * (elastic - 1.0) * elastic,
        }
    };
    path.iter().map(point).collect()
}

/// The same of the particle in the middle of a block whose particles are given the velocity of the path at every step.
fn simulated<const D: usize>(path: &[f64]) -> anyhow::Result<Vec<Point>> {
    // chosen: the whole path takes 3 us at most, in which the news of the free surface gets a hundredth of a cell far.
    let dt = 1e-8;
    let mut scene = scene::<f64, D>(SPACING, KernelKind::Cubic, Transfer::Apic, snow());
    scene.time_step = fixed_step(dt);
    let state = State::at_rest(&scene, Vector::zeros(), &lattice(SPACING, [8; D], 2))?;
    let middle = 4.0 * SPACING;
    let mut simulation = Simulation::new(scene, state)?;
    let mut points = Vec::new();
    for pair in path.windows(2) {
        let rate = (pair[1] / pair[0] - 1.0) / dt;
        let state = simulation.state_mut();
        for p in 0..state.len() {
            let height = state.motion.position[p][1] - middle;
            state.motion.velocity[p] = Vector::from_fn(|axis, _| if axis == 1 { rate * height } else { 0.0 });
            state.motion.affine[p].fill(0.0);
            state.motion.affine[p][(1, 1)] = rate;
        }
        simulation.advance_one(f64::INFINITY)?;
        points.push(middle_point(&simulation, pair[1], middle));
    }
    Ok(points)
}

fn middle_point<const D: usize>(simulation: &Simulation<f64, D>, stretch: f64, middle: f64) -> Point {
    use snowlab_solver::material::ConstitutiveModel;
    let (state, material) = (simulation.state(), &simulation.scene().materials[0]);
    let away = |p: &usize| (state.motion.position[*p] - Vector::<f64, D>::repeat(middle)).norm();
    let p = (0..state.len()).min_by(|a, b| away(a).total_cmp(&away(b))).unwrap_or(0);
    let f = &state.motion.deformation[p];
    Point {
        stretch,
        elastic_stretch: f[(1, 1)],
        plastic_ratio: state.motion.plastic_ratio[p],
        stress: material.kirchhoff(f, state.motion.stiffness[p])[(1, 1)],
    }
}

/// Carries it out.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let effort = setting.effort;
    let legs = effort.choose(20, 100);
    let path: Vec<f64> = TURNS
        .windows(2)
        .flat_map(|turn| {
            (0..legs)
                .map(|k| turn[0] + (turn[1] - turn[0]) * f64::from(k) / f64::from(legs))
                .collect::<Vec<_>>()
        })
        .chain([TURNS[3]])
        .collect();
    let exact = closed_form(&path[1..]);
    let plane = simulated::<2>(&path)?;
    let space = simulated::<3>(&path)?;
    Ok(Evidence {
        tables: vec![table(&exact, &plane, &space)],
        figures: vec![EvidenceFigure {
            name: "strain-path",
            caption: "Stress and plastic volume ratio along the path: closed form and simulated particle lie on each other.",
            drawing: figure(&exact, &plane)?,
        }],
        checks: vec![check("2D", &exact, &plane), check("3D", &exact, &space)],
    })
}

fn check(dimension: &str, exact: &[Point], found: &[Point]) -> Check {
    let peak = exact.iter().fold(0.0_f64, |peak, point| peak.max(point.stress.abs()));
    let error = |(a, b): (&Point, &Point)| {
        ((a.stress - b.stress) / peak).abs().max((a.plastic_ratio - b.plastic_ratio).abs())
    };
    Check {
        quantity: format!("largest error of stress (over its peak) and J_P, {dimension}"),
        measured: exact.iter().zip(found).map(error).fold(0.0, f64::max),
        theory: "0".into(),
        allowed: [0.0, 1e-10],
        source: "closed form; round-off of some hundred steps",
    }
}

fn table(exact: &[Point], plane: &[Point], space: &[Point]) -> Table {
    let row = |((exact, plane), space): ((&Point, &Point), &Point)| {
        let mut row = Row::default();
        row.number("stretch", "-", "total stretch", exact.stretch)
            .number("elastic_stretch", "-", "its elastic part, closed form", exact.elastic_stretch)
            .number("plastic_ratio", "-", "J_P, closed form", exact.plastic_ratio)
            .number("stress", "Pa", "Kirchhoff stress tau_yy, closed form", exact.stress)
            .number("plastic_ratio_2d", "-", "J_P of the middle particle, 2D", plane.plastic_ratio)
            .number("stress_2d", "Pa", "tau_yy of the middle particle, 2D", plane.stress)
            .number("plastic_ratio_3d", "-", "J_P of the middle particle, 3D", space.plastic_ratio)
            .number("stress_3d", "Pa", "tau_yy of the middle particle, 3D", space.stress);
        row
    };
    Table { name: "strain-path", rows: exact.iter().zip(plane).zip(space).map(row).collect() }
}

fn figure(exact: &[Point], found: &[Point]) -> anyhow::Result<crate::figure::Drawing> {
    let progress: Vec<f64> = (0..exact.len()).map(|k| 3.0 * (k + 1) as f64 / exact.len() as f64).collect();
    let of = |points: &[Point], value: fn(&Point) -> f64| points.iter().map(value).collect::<Vec<_>>();
    let stress = [of(exact, |p| 1e-3 * p.stress), of(found, |p| 1e-3 * p.stress)];
    let ratio = [of(exact, |p| p.plastic_ratio), of(found, |p| p.plastic_ratio)];
    let names = ["closed form", "particle, 2D"];
    let stress_curves: Vec<Curve> = names
        .iter()
        .zip(&stress)
        .map(|(arm, y)| Curve { arm, x: &progress, middle: y, low: y, high: y })
        .collect();
    let ratio_curves: Vec<Curve> = names
        .iter()
        .zip(&ratio)
        .map(|(arm, y)| Curve { arm, x: &progress, middle: y, low: y, high: y })
        .collect();
    Ok(curves(&Curves {
        title: "",
        x_label: "leg of the path",
        x_scale: Scale::Linear,
        mark: None,
        spread: Spread::Band,
        note: "",
        quantities: &[
            Quantity {
                label: "stress [kPa]",
                scale: Scale::Linear,
                hold: &[],
                level: None,
                guides: &[],
                curves: &stress_curves,
            },
            Quantity {
                label: "J_{P}",
                scale: Scale::Linear,
                hold: &[],
                level: None,
                guides: &[],
                curves: &ratio_curves,
            },
        ],
    })?)
}
