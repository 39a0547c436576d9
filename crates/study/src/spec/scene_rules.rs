//! What the numbers of a scene may be: a table by key, and what ties keys together.

use snowlab_sampler::MOST_PARTICLES;
use toml::Value;

use super::range::{NOT_NEGATIVE, POSITIVE, Range, Shown, at_least, within};
use super::scene::{
    AdvectionName, BodySpec, EndFrom, IntegratorSpec, MaterialSpec, NumericsSpec, OutputSpec, PlacementSpec,
    SolidSpec, TimeUnit,
};
use super::{SceneSpec, Spec, SpecError};

/// Lengths up to 1e6 m, as the sampler takes them.
const LENGTH: Range = within(0.0, 1e6).open_below();
const COORDINATE: Range = within(-1e6, 1e6);
/// Speeds, spins and gravity (chosen: far beyond any impact, and their squares are far from overflow).
const MOTION: Range = within(-1e6, 1e6);
const DEGREES: Range = within(-360.0, 360.0);
/// Bodies of a scene: particles tell theirs by 16 bits.
const MOST_BODIES: usize = 65_535;
/// Frames of a run (chosen: far more than a film has, far less than a disk holds).
const MOST_FRAMES: f64 = 100_000.0;

/// How many numbers a key takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// One.
    Single,
    /// As many as the scene has dimensions.
    Vector,
    /// As a vector, or none.
    MaybeVector,
    /// One in 2D, three in 3D, or none.
    MaybeSpin,
}

/// What a key of a scene takes.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    /// The key; `*` stands for a number in a list, and the region for every region inside it.
    pub key: &'static str,
    /// How many numbers.
    pub length: Length,
    /// Where each of them lies.
    pub range: Range,
}

const fn one(key: &'static str, range: Range) -> Rule {
    Rule { key, length: Length::Single, range }
}

const fn vector(key: &'static str, range: Range) -> Rule {
    Rule { key, length: Length::Vector, range }
}

const fn maybe_vector(key: &'static str, range: Range) -> Rule {
    Rule { key, length: Length::MaybeVector, range }
}

/// Every number of a scene but the bounds of J_P, which may be infinite. Ranges are those of the method, where the key
/// has one; else finite numbers of the sign that means something.
pub const RULES: &[Rule] = &[
    one("seed", NOT_NEGATIVE),
    maybe_vector("gravity", MOTION),
    one("numerics.spacing", LENGTH),
    one("numerics.flip_share", within(0.0, 1.0)),
    one("numerics.flip_reference_step", POSITIVE),
    one("numerics.fixed_step", POSITIVE),
    one("numerics.wave_courant", POSITIVE),
    one("numerics.advective_courant", within(0.0, 1.0).open_below()),
    one("numerics.greatest_step", POSITIVE),
    one("numerics.max_steps", at_least(1.0)),
    one("numerics.integrator.beta", within(0.0, 1.0)),
    one("numerics.integrator.tolerance", within(0.0, 1.0).open_below().open_above()),
    one("numerics.integrator.max_iterations", at_least(1.0)),
    vector("body.*.region.centre", COORDINATE),
    one("body.*.region.radius", LENGTH),
    vector("body.*.region.half_extent", LENGTH),
    vector("body.*.region.semi_axes", LENGTH),
    one("body.*.region.angle", DEGREES),
    one("body.*.region.scale", LENGTH),
    maybe_vector("body.*.region.rotation", DEGREES),
    one("body.*.placement.count", within(1.0, MOST_PARTICLES as f64)),
    one("body.*.placement.angle", DEGREES),
    one("body.*.placement.filled_volume", POSITIVE),
    one("body.*.voids.porosity", within(0.0, 0.6).open_below()),
    one("body.*.voids.mean_radius", LENGTH),
    one("body.*.voids.radius_spread", within(0.0, 1.0)),
    one("body.*.voids.irregularity", within(0.0, 0.2)),
    one("body.*.voids.aspect", within(1.0, 5.0)),
    one("body.*.voids.angle", DEGREES),
    one("body.*.voids.gap", within(0.0, 1e6)),
    one("body.*.voids.correlation_length", LENGTH),
    one("body.*.voids.judged_at", LENGTH),
    one("body.*.heterogeneity.spread", within(0.0, 3.0)),
    one("body.*.heterogeneity.correlation_length", LENGTH),
    one("body.*.heterogeneity.factor", POSITIVE),
    one("body.*.heterogeneity.thickness", LENGTH),
    one("body.*.material.density", POSITIVE),
    one("body.*.material.young", POSITIVE),
    one("body.*.material.poisson", within(0.0, 0.5).open_above()),
    one("body.*.material.critical_compression", within(0.0, 1.0).open_below().open_above()),
    one("body.*.material.critical_stretch", POSITIVE),
    one("body.*.material.hardening", within(0.0, 100.0)),
    one("body.*.material.hardening_limit", at_least(1.0)),
    maybe_vector("body.*.velocity", MOTION),
    Rule { key: "body.*.spin", length: Length::MaybeSpin, range: MOTION },
    one("body.*.phase_shift", within(0.0, 1e6)),
    one("body.*.stiffness_scale", POSITIVE),
    vector("collider.*.shape.point", COORDINATE),
    vector("collider.*.shape.normal", COORDINATE),
    vector("collider.*.shape.centre", COORDINATE),
    one("collider.*.shape.radius", LENGTH),
    vector("collider.*.shape.half_extent", LENGTH),
    one("collider.*.shape.angle", DEGREES),
    one("collider.*.friction", NOT_NEGATIVE),
    maybe_vector("collider.*.velocity", MOTION),
    one("output.frame_interval", POSITIVE),
    one("output.end", POSITIVE),
];

impl Spec for SceneSpec {
    fn validate(&self) -> Result<(), SpecError> {
        if ![2, 3].contains(&self.dimension) {
            return Err(SpecError::value("`dimension`", format!("is {}; allowed: 2 or 3", self.dimension)));
        }
        check_meshes(self)?;
        let document = Value::try_from(self).map_err(|error| SpecError::value("scene", error.to_string()))?;
        check_numbers(&document, "", "", self.dimension)?;
        if self.body.is_empty() || self.body.len() > MOST_BODIES {
            let message = format!("has {} entries; allowed: 1 to {MOST_BODIES} [[body]]", self.body.len());
            return Err(SpecError::value("`body`", message));
        }
        self.body.iter().enumerate().try_for_each(|(number, body)| check_body(body, number))?;
        let count: usize = self.body.iter().filter_map(|body| body.placement.count()).sum();
        if count > MOST_PARTICLES {
            let message = format!("have {count} particles together; allowed: {MOST_PARTICLES}");
            return Err(SpecError::value("`body`", message));
        }
        for (number, collider) in self.collider.iter().enumerate() {
            if let SolidSpec::HalfSpace { normal, .. } = &collider.shape
                && normal.iter().all(|component| *component == 0.0)
            {
                let place = format!("`collider.{number}.shape.normal`");
                return Err(SpecError::value(
                    place,
                    format!("is {normal:?}, which has no direction; give one that is not zero"),
                ));
            }
        }
        check_advection(&self.numerics)?;
        check_output(&self.output, self)
    }
}

/// Before their numbers, of which there are three.
fn check_meshes(scene: &SceneSpec) -> Result<(), SpecError> {
    let has_mesh = |body: &BodySpec| body.region.as_ref().is_some_and(|region| !region.meshes().is_empty());
    match scene.body.iter().position(has_mesh) {
        Some(number) if scene.dimension == 2 => {
            let message =
                "has a `mesh`, which encloses a volume; set `dimension = 3`, or use another kind of region";
            Err(SpecError::value(format!("`body.{number}.region`"), message))
        }
        _ => Ok(()),
    }
}

/// Holds every number below `value`, which stands at `path`, against the rule of `key`, its path without numbers of lists.
fn check_numbers(value: &Value, path: &str, key: &str, dimension: usize) -> Result<(), SpecError> {
    let join =
        |front: &str, back: &str| if front.is_empty() { back.into() } else { format!("{front}.{back}") };
    match value {
        Value::Table(table) => table.iter().try_for_each(|(name, inner)| {
            // A region inside a region keeps the rules of a region.
            let in_region =
                key.ends_with(".region") && ["parts", "solid", "removed"].contains(&name.as_str());
            let inner_key = if in_region { key.to_string() } else { join(key, name) };
            check_numbers(inner, &join(path, name), &inner_key, dimension)
        }),
        Value::Array(items) if !items.iter().all(is_number) => {
            items.iter().enumerate().try_for_each(|(index, inner)| {
                let inner_key = if key.ends_with(".region") { key.to_string() } else { format!("{key}.*") };
                check_numbers(inner, &join(path, &index.to_string()), &inner_key, dimension)
            })
        }
        Value::Array(items) => check_rule(value, items, path, key, dimension),
        number if is_number(number) => check_rule(value, std::slice::from_ref(number), path, key, dimension),
        _ => Ok(()),
    }
}

fn is_number(value: &Value) -> bool {
    value.is_float() || value.is_integer()
}

fn check_rule(
    value: &Value,
    numbers: &[Value],
    path: &str,
    key: &str,
    dimension: usize,
) -> Result<(), SpecError> {
    let Some(rule) = RULES.iter().find(|rule| rule.key == key) else { return Ok(()) };
    let wanted = match rule.length {
        Length::Single => 1,
        Length::Vector | Length::MaybeVector => dimension,
        Length::MaybeSpin => 2 * dimension - 3,
    };
    let left_out = numbers.is_empty() && matches!(rule.length, Length::MaybeVector | Length::MaybeSpin);
    let inside = |number: &Value| {
        let number = number.as_float().or_else(|| number.as_integer().map(|whole| whole as f64));
        number.is_some_and(|number| rule.range.contains(number))
    };
    if left_out || numbers.len() == wanted && numbers.iter().all(inside) {
        return Ok(());
    }
    // One more than there may be tells a list that is too long.
    let shown: Vec<String> = numbers.iter().take(wanted + 1).map(shown).collect();
    let message = if value.is_array() {
        let plural = if wanted == 1 { "number" } else { "numbers, each" };
        let more = if numbers.len() > shown.len() { ", ..." } else { "" };
        let shown = shown.join(", ") + more;
        format!("is [{shown}]; allowed in {dimension}D: {wanted} {plural} {}", rule.range)
    } else {
        format!("is {}; allowed: {}", shown.concat(), rule.range)
    };
    Err(SpecError::value(format!("`{path}`"), message))
}

fn shown(number: &Value) -> String {
    // chosen: as many digits as a number of f64 needs.
    let long = Some(number.to_string()).filter(|text| text.len() > 24).and(number.as_float());
    long.map_or(number.to_string(), |number| Shown(number).to_string())
}

fn check_body(body: &BodySpec, number: usize) -> Result<(), SpecError> {
    let refuse =
        |key: &str, message: String| Err(SpecError::value(format!("`body.{number}.{key}`"), message));
    let from_file = matches!(body.placement, PlacementSpec::File { .. });
    if !from_file && body.region.is_none() {
        return refuse("region", "is missing; only a placement of kind `file` does without".into());
    }
    let sampled = [
        ("region", body.region.is_some()),
        ("voids", body.voids.is_some()),
        ("heterogeneity", body.heterogeneity.is_some()),
    ];
    for (key, given) in sampled {
        if from_file && given {
            return refuse(
                key,
                "means nothing with a placement of kind `file`, whose points are all; remove it".into(),
            );
        }
    }
    if let MaterialSpec::Snow { plastic_ratio_bounds: Some([lower, upper]), .. } = body.material
        && !((0.0..1.0).contains(&lower) && upper > 1.0)
    {
        let message = format!(
            "is [{lower:?}, {upper:?}]; allowed: [lower, upper], lower 0 or more, below 1, and upper above 1"
        );
        return refuse("material.plastic_ratio_bounds", message);
    }
    Ok(())
}

fn check_advection(numerics: &NumericsSpec) -> Result<(), SpecError> {
    let trapezoidal = matches!(numerics.integrator, Some(IntegratorSpec::Trapezoidal(_)));
    if trapezoidal && numerics.advection == AdvectionName::Blended {
        let message = "is `blended`; allowed with a `trapezoidal` integrator: `interpolated`";
        return Err(SpecError::value("`numerics.advection`", message));
    }
    Ok(())
}

fn check_output(output: &OutputSpec, scene: &SceneSpec) -> Result<(), SpecError> {
    let frames = output.end / output.frame_interval;
    if frames > MOST_FRAMES {
        let message = format!(
            "is {:?}, which makes {} frames until the end; allowed: {MOST_FRAMES}",
            output.frame_interval,
            Shown(frames.round())
        );
        return Err(SpecError::value("`output.frame_interval`", message));
    }
    if output.time_unit == TimeUnit::Crossing && scene.body[0].velocity.iter().all(|v| *v == 0.0) {
        let message = "is `crossing`, but the first body does not move; give it a velocity or use `second`";
        return Err(SpecError::value("`output.time_unit`", message));
    }
    if output.end_from == EndFrom::Contact && scene.collider.is_empty() {
        let message = "is `contact`, but the scene has no [[collider]]; add one or use `start`";
        return Err(SpecError::value("`output.end_from`", message));
    }
    Ok(())
}
