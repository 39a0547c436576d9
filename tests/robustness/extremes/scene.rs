//! Scenes in one box of ranges.

use std::fmt::{self, Display};

use proptest::collection::vec;
use proptest::prelude::*;

use super::numerics::{Numerics, numerics};

/// Steps of a scene at most (chosen: a scene takes some milliseconds).
pub const MOST_STEPS: u64 = 200;
/// Particles of a body at most (chosen likewise).
const MOST_PARTICLES: usize = 150;

/// A number between powers of ten, any of them as likely.
pub fn decades(least: f64, greatest: f64) -> impl Strategy<Value = f64> + Clone {
    (least..=greatest).prop_map(|power| 10f64.powf(power))
}

/// A scene as TOML.
#[derive(Clone, Debug)]
pub struct RandomScene {
    dimension: usize,
    seed: u64,
    gravity: Vec<f64>,
    numerics: Numerics,
    bodies: Vec<RandomBody>,
    colliders: Vec<RandomCollider>,
    end: f64,
    end_from: &'static str,
}

/// A body; lengths in spacings.
#[derive(Clone, Debug)]
struct RandomBody {
    region: &'static str,
    centre: Vec<f64>,
    extent: Vec<f64>,
    placement: &'static str,
    count: usize,
    material: RandomMaterial,
    velocity: Vec<f64>,
    spin: Vec<f64>,
    stiffness_scale: f64,
}

#[derive(Clone, Debug)]
struct RandomMaterial {
    elastic: bool,
    density: f64,
    young: f64,
    poisson: f64,
    yields: [f64; 2],
    hardening: f64,
    limit: Option<f64>,
    bounds: Option<[f64; 2]>,
}

/// An obstacle; lengths in spacings.
#[derive(Clone, Debug)]
struct RandomCollider {
    shape: &'static str,
    centre: Vec<f64>,
    extent: f64,
    normal: Vec<f64>,
    contact: &'static str,
    friction: f64,
    velocity: Vec<f64>,
}

/// All scenes of a dimension.
pub fn scenes<const D: usize>() -> impl Strategy<Value = RandomScene> {
    let times = (decades(-1.0, 2.0), prop_oneof![4 => Just("start"), 1 => Just("contact")]);
    let gravity = prop_oneof![
        2 => Just(vec![0.0; D]),
        1 => vector(D, 10.0),
        1 => vector(D, 1e6),
    ];
    let offset = prop_oneof![4 => Just(0.0), 1 => Just(1e4)];
    let parts = (vec(bodies(D), 1..=3), vec(colliders(D), 0..=3));
    (0..1000u64, gravity, numerics(), parts, times, offset).prop_map(
        |(seed, gravity, numerics, (mut bodies, mut colliders), (cells, end_from), offset)| {
            let end = cells * numerics.spacing / bodies.iter().map(RandomBody::speed).fold(0.0, f64::max);
            // The box is moved as a whole.
            let shift = (offset / numerics.spacing).round();
            bodies.iter_mut().for_each(|body| body.centre[0] += shift);
            colliders.iter_mut().for_each(|collider| collider.centre[0] += shift);
            let end_from = if colliders.is_empty() { "start" } else { end_from };
            RandomScene { dimension: D, seed, gravity, numerics, bodies, colliders, end, end_from }
        },
    )
}

fn vector(dimension: usize, most: f64) -> BoxedStrategy<Vec<f64>> {
    vec(-most..=most, dimension).boxed()
}

/// From rest to 100 m/s, each power of ten as likely, and now and then beyond.
fn velocities(dimension: usize) -> impl Strategy<Value = Vec<f64>> {
    let speed = prop_oneof![1 => Just(0.0), 6 => decades(-3.0, 2.0), 1 => decades(2.0, 5.0)];
    (vec(-1.0..=1.0, dimension), speed)
        .prop_map(|(direction, speed)| direction.into_iter().map(|part: f64| part * speed).collect())
}

fn bodies(dimension: usize) -> impl Strategy<Value = RandomBody> {
    let place = (vector(dimension, 5.0), vec(0.1..=6.0f64, dimension));
    let spins = prop_oneof![3 => Just(Vec::new()), 1 => vector(2 * dimension - 3, 1e4)];
    let kinds = (
        prop_oneof![Just("ball"), Just("box"), Just("ellipsoid")],
        prop_oneof![Just("random"), Just("jittered"), Just("lattice"), Just("poisson-disk")],
    );
    let count = prop_oneof![1 => Just(1), 1 => Just(2), 6 => 1..=MOST_PARTICLES];
    (kinds, place, count, materials(), velocities(dimension), spins, decades(-3.0, 3.0)).prop_map(
        |((region, placement), (centre, extent), count, material, velocity, spin, stiffness_scale)| {
            RandomBody { region, centre, extent, placement, count, material, velocity, spin, stiffness_scale }
        },
    )
}

fn materials() -> impl Strategy<Value = RandomMaterial> {
    let poisson = prop_oneof![Just(0.0), Just(0.2), Just(0.4999999), 0.0..0.4999];
    let yields =
        (prop_oneof![Just(2.5e-2), Just(1e-9), Just(0.999), decades(-6.0, -0.1)], decades(-9.0, 2.0));
    let hardening = prop_oneof![Just(0.0), Just(10.0), Just(100.0), 0.0..=100.0];
    let bounds = (0.0..0.999f64, 1.001..10.0f64).prop_map(|(lower, upper)| [lower, upper]);
    let limits = (proptest::option::of(decades(0.0, 6.0)), proptest::option::of(bounds));
    (any::<bool>(), decades(-9.0, 9.0), decades(0.0, 12.0), poisson, yields, hardening, limits).prop_map(
        |(elastic, density, young, poisson, yields, hardening, (limit, bounds))| RandomMaterial {
            elastic,
            density,
            young,
            poisson,
            yields: [yields.0, yields.1],
            hardening,
            limit,
            bounds,
        },
    )
}

fn colliders(dimension: usize) -> impl Strategy<Value = RandomCollider> {
    let shape = prop_oneof![2 => Just("half-space"), 1 => Just("ball"), 1 => Just("box")];
    let contact = prop_oneof![Just("separate"), Just("slip"), Just("sticky"), Just("mirror")];
    let normal = vec(-1.0..=1.0f64, dimension);
    let friction = prop_oneof![Just(0.0), Just(0.5), decades(-3.0, 3.0)];
    (shape, vector(dimension, 8.0), decades(-2.0, 1.0), normal, contact, friction, velocities(dimension))
        .prop_map(|(shape, centre, extent, normal, contact, friction, velocity)| {
            // Solids are no mirrors.
            let contact = if shape != "half-space" && contact == "mirror" { "sticky" } else { contact };
            RandomCollider { shape, centre, extent, normal, contact, friction, velocity }.at_rest_if_mirror()
        })
}

impl RandomCollider {
    /// A mirror is a plane of nodes at rest.
    fn at_rest_if_mirror(mut self) -> Self {
        if self.contact == "mirror" {
            self.velocity.fill(0.0);
            self.centre.iter_mut().for_each(|part| *part = part.round());
            let axis = self.normal.len() - 1;
            self.normal = (0..=axis).map(|k| f64::from(u8::from(k == axis))).collect();
        }
        self
    }
}

impl Display for RandomScene {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let h = self.numerics.spacing;
        writeln!(f, "dimension = {}\nseed = {}\ngravity = {:?}", self.dimension, self.seed, self.gravity)?;
        writeln!(f, "{}", self.numerics)?;
        writeln!(f, "[output]\nframe_interval = {:?}\nend = {:?}", self.end / 3.0, self.end)?;
        writeln!(f, "end_from = \"{}\"", self.end_from)?;
        self.bodies.iter().try_for_each(|body| body.write(f, h))?;
        self.colliders.iter().try_for_each(|collider| collider.write(f, h))
    }
}

fn times(vector: &[f64], h: f64) -> Vec<f64> {
    vector.iter().map(|part| part * h).collect()
}

impl RandomBody {
    /// About that of its waves and its own together [m/s].
    fn speed(&self) -> f64 {
        let RandomMaterial { density, young, poisson, .. } = self.material;
        let waves = (young * self.stiffness_scale / (density * (1.0 - 2.0 * poisson))).sqrt();
        waves + self.velocity.iter().map(|part| part.abs()).fold(0.0, f64::max)
    }

    fn write(&self, f: &mut fmt::Formatter<'_>, h: f64) -> fmt::Result {
        let (centre, extent) = (times(&self.centre, h), times(&self.extent, h));
        let size = match self.region {
            "ball" => format!("radius = {:?}", extent[0]),
            "box" => format!("half_extent = {extent:?}"),
            _ => format!("semi_axes = {extent:?}"),
        };
        writeln!(f, "[[body]]\nregion = {{ kind = \"{}\", centre = {centre:?}, {size} }}", self.region)?;
        writeln!(f, "placement = {{ kind = \"{}\", count = {} }}", self.placement, self.count)?;
        writeln!(f, "velocity = {:?}\nspin = {:?}", self.velocity, self.spin)?;
        writeln!(f, "stiffness_scale = {:?}\n{}", self.stiffness_scale, self.material)
    }
}

impl Display for RandomMaterial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = if self.elastic { "elastic" } else { "snow" };
        writeln!(f, "[body.material]\nkind = \"{kind}\"\ndensity = {:?}", self.density)?;
        writeln!(f, "young = {:?}\npoisson = {:?}", self.young, self.poisson)?;
        if self.elastic {
            return Ok(());
        }
        let [compression, stretch] = self.yields;
        writeln!(f, "critical_compression = {compression:?}\ncritical_stretch = {stretch:?}")?;
        writeln!(f, "hardening = {:?}", self.hardening)?;
        self.limit.map_or(Ok(()), |limit| writeln!(f, "hardening_limit = {limit:?}"))?;
        self.bounds.map_or(Ok(()), |bounds| writeln!(f, "plastic_ratio_bounds = {bounds:?}"))
    }
}

impl RandomCollider {
    fn write(&self, f: &mut fmt::Formatter<'_>, h: f64) -> fmt::Result {
        let (centre, extent) = (times(&self.centre, h), self.extent * h);
        let shape = match self.shape {
            "half-space" => format!("point = {centre:?}, normal = {:?}", self.normal),
            "ball" => format!("centre = {centre:?}, radius = {extent:?}"),
            _ => format!("centre = {centre:?}, half_extent = {:?}", vec![extent; centre.len()]),
        };
        writeln!(f, "[[collider]]\nshape = {{ kind = \"{}\", {shape} }}", self.shape)?;
        writeln!(
            f,
            "contact = \"{}\"\nfriction = {:?}\nvelocity = {:?}",
            self.contact, self.friction, self.velocity
        )
    }
}
