//! What is about to go wrong in a scene, and what helps.

use std::fmt;

use serde::Serialize;

use crate::memory::in_words;
use crate::spec::SceneSpec;
use crate::spec::scene::{ColliderSpec, ContactName, EndFrom, MaterialSpec, PrecisionName, SolidSpec};

use super::facts::Facts;

/// Something about a key of a scene, and what to do.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct Advice {
    /// The dotted key.
    pub key: String,
    /// What was found.
    pub finding: String,
    /// What helps.
    pub remedy: String,
}

impl Advice {
    pub(super) fn new(key: impl Into<String>, finding: impl Into<String>, remedy: impl Into<String>) -> Self {
        Advice { key: key.into(), finding: finding.into(), remedy: remedy.into() }
    }
}

impl fmt::Display for Advice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}`: {}; {}", self.key, self.finding, self.remedy)
    }
}

/// Impacts faster than this share of the wave speed compress the material by as much before the wave has told the rest of it (chosen: where the
/// densities that snow packs to begin, J_P about 1/2).
const FAST: f64 = 0.5;
/// Fewer particles to a cell leave gaps that open without a crack (chosen: docs/experiment.md has 2 and more).
const SPARSE: f64 = 1.0;
/// Share of the cells that random placement may leave empty (chosen: at two to a cell it is 14 %).
const EMPTY: f64 = 0.2;
/// More particles to a cell than this resolve nothing that the grid does (chosen: four along each axis in 2D).
const DENSE: f64 = 16.0;
/// Cells that a thing must have across to be seen as what it is: the width of the cubic kernel is 4, and that of a bridge or void 2 at the least,
/// for material less than 2 h apart still moves together.
const SEEN: f64 = 2.0;
/// Cells across the whole body below which waves, cracks and fragments have no room (chosen).
const SMALL: f64 = 8.0;
/// Poisson's ratio above which the return map, which clamps stretches one by one, makes energy of the change of volume (measured: plastic loss of
/// the ball in studies/extremes.toml is 8.5 J/m at 0, 4.7 at 0.4, 0.4 at 0.45 and -7.9 at 0.49).
const INCOMPRESSIBLE: f64 = 0.4;
/// Hardening coefficient times volume lost: what the moduli may grow by where snow packs to half its volume (e^(xi / 2)); above this steps shrink
/// tenfold (chosen: twice S13's 10).
const HARD: f64 = 20.0;
/// Cells from the local origin up to which f32 resolves a step's motion (as for the origin itself, `assemble`).
const FAR: f64 = 16384.0;

/// Cells, or degrees, within which an edge is taken to lie where round-off decides (chosen: f32 resolves 1e-6 of a metre-sized scene).
const ON_NODES: f64 = 1e-4;

/// One kind of thing that can go wrong.
type Rule = fn(&SceneSpec, &Facts) -> Vec<Advice>;

const RULES: [Rule; 15] = [
    memory,
    unstable_step,
    nothing_meets,
    buried,
    edges_on_nodes,
    pressed,
    coincident,
    fast_impact,
    out_of_reach,
    unguarded,
    long_implicit_steps,
    hardening,
    placement,
    widths,
    incompressible,
];

/// All that is about to go wrong, the worst first.
pub fn hazards(spec: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    RULES.iter().flat_map(|rule| rule(spec, facts)).collect()
}

fn unstable_step(spec: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    let Facts { courant, courant_limit, first_step, .. } = *facts;
    if spec.numerics.integrator.is_some() || courant <= courant_limit {
        return Vec::new();
    }
    let longest = first_step * courant_limit / courant;
    let (key, remedy) = match spec.numerics.fixed_step {
        Some(_) => ("numerics.fixed_step", format!("set it to {:.2e} s, or leave it out", 0.5 * longest)),
        None => ("numerics.wave_courant", format!("set it to {:.2}, or leave it out", 0.5 * courant_limit)),
    };
    let finding = format!(
        "the first step of {first_step:.2e} s has dt c / h = {courant:.2}, above the limit of {courant_limit:.2} for explicit steps: the run \
         becomes unstable"
    );
    vec![Advice::new(key, finding, remedy)]
}

fn unguarded(spec: &SceneSpec, _: &Facts) -> Vec<Advice> {
    let numerics = &spec.numerics;
    let packs = spec.body.iter().any(|body| matches!(body.material, MaterialSpec::Snow { .. }));
    if numerics.fixed_step.is_none() || numerics.integrator.is_some() || !packs {
        return Vec::new();
    }
    vec![Advice::new(
        "numerics.fixed_step",
        "snow that packs hardens, and a step that is stable at the start is not then; plastic flow hides it from every guard \
         (docs/stability.md)",
        "leave it out: the step then follows the stiffest particle",
    )]
}

fn fast_impact(_: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    let Facts { mach, impact_speed, wave_speed, .. } = *facts;
    if mach <= FAST {
        return Vec::new();
    }
    let what = if mach > 1.0 { "faster than" } else { "nearly as fast as" };
    vec![Advice::new(
        "body.0.velocity",
        format!(
            "an impact at {impact_speed:.3} m/s is {what} waves in the material ({wave_speed:.3} m/s, Mach {mach:.2}): it is crushed where it \
             touches, hardening shortens steps, and elements may turn inside out"
        ),
        format!(
            "lower the speed below {:.2} m/s, raise `young`, or set `hardening_limit`",
            FAST * wave_speed
        ),
    )]
}

fn nothing_meets(spec: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    if facts.first_meeting.is_finite() || !facts.buried.is_empty() {
        return Vec::new();
    }
    let waits = spec.output.end_from == EndFrom::Contact;
    if !waits
        && facts.impact_speed == 0.0
        && facts.speed_at_start == 0.0
        && spec.gravity.iter().all(|g| *g == 0.0)
    {
        return vec![Advice::new(
            "body.0.velocity",
            "nothing moves and nothing acts",
            "set a velocity, or `gravity`",
        )];
    }
    let (key, consequence) = if waits {
        ("output.end_from", "the run waits for a contact that does not come, and stops with `no-contact`")
    } else {
        ("output.end", "nothing meets an obstacle or another body before the run ends")
    };
    vec![Advice::new(key, consequence, "check positions, velocities, obstacles and `output.end`")]
}

fn buried(spec: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    let of = |&(number, count): &(usize, usize)| {
        let is_mirror = spec.collider[number].contact == ContactName::Mirror;
        let what = if is_mirror { "behind the mirror" } else { "inside the obstacle" };
        Advice::new(
            format!("collider.{number}.shape"),
            format!(
                "{count} of {} particles lie {what} at the start, where they are held or carried along",
                facts.particles
            ),
            "move the obstacle or the body apart by two cells",
        )
    };
    facts.buried.iter().map(of).collect()
}

/// Below the edge of a box that stands on edge, nodes on the plane between its faces are as near to one as to the other. Two edges lie in each plane
/// along an axis: at the centre, but for the half of what the box is longer than wide.
fn edges_on_nodes(spec: &SceneSpec, _: &Facts) -> Vec<Advice> {
    let h = spec.numerics.spacing;
    let is_on_nodes = |x: f64| ((x / h).round() - x / h).abs() < ON_NODES;
    let of = |(number, collider): (usize, &ColliderSpec)| {
        let SolidSpec::Box(solid) = &collider.shape else { return None };
        let stands_on_edge = ((solid.angle - 45.0) % 90.0).abs() < ON_NODES;
        let off = (solid.half_extent[0] - solid.half_extent[1]) / std::f64::consts::SQRT_2;
        let lines = solid.centre[..2].iter().flat_map(|x| [x - off, x + off]);
        (stands_on_edge && lines.into_iter().any(is_on_nodes)).then(|| {
            Advice::new(
                format!("collider.{number}.shape"),
                "the box stands on an edge above a line of nodes: round-off decides to which of its sides they push, and f32 and f64 part there",
                "shift it by a fraction of a cell, or take a ball: no grid resolves a sharp edge",
            )
        })
    };
    spec.collider.iter().enumerate().filter_map(of).collect()
}

fn placement(_: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    let per_cell = facts.particles_per_cell;
    let key = "body.0.placement.count";
    if per_cell > DENSE {
        let finding = format!(
            "{per_cell:.1} particles to a cell: most of the time goes into what the grid does not resolve"
        );
        return vec![Advice::new(key, finding, "use fewer particles, or a smaller `numerics.spacing`")];
    }
    if per_cell < SPARSE {
        let finding = format!(
            "{per_cell:.2} particles to a cell: neighbours lose touch, and the body falls apart without a crack"
        );
        return vec![Advice::new(key, finding, "use more particles, or a greater `numerics.spacing`")];
    }
    match facts.empty_cells {
        Some(empty) if empty > EMPTY => vec![Advice::new(
            key,
            format!(
                "random placement with {per_cell:.2} particles to a cell leaves {:.0} % of the cells empty: the body has flaws of the grid's \
                 own size before anything touches it",
                100.0 * empty
            ),
            "use more particles, or a placement of kind `jittered`",
        )],
        _ => Vec::new(),
    }
}

fn widths(_: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    let of = |what: &str, key: &str, cells: Option<f64>, least: f64, so: &str, remedy: &str| {
        let cells = cells.filter(|cells| *cells < least)?;
        Some(Advice::new(key, format!("{what} has {cells:.1} cells across: {so}"), remedy))
    };
    let closes = "the grid does not see it, and what it parts moves together";
    let found = [
        of(
            "the narrowest void",
            "body.0.voids",
            facts.cells_across_void,
            SEEN,
            closes,
            "make voids wider, or `numerics.spacing` smaller",
        ),
        of(
            "the thinnest bridge between voids",
            "body.0.voids",
            facts.cells_across_bridge,
            SEEN,
            "its strength is the grid's and not the material's",
            "make the gap wider, or `numerics.spacing` smaller",
        ),
        of(
            "the smallest extent",
            "numerics.spacing",
            Some(facts.cells_across),
            SMALL,
            "there is no room for a wave or a crack",
            "make it smaller, or the bodies larger",
        ),
    ];
    found.into_iter().flatten().collect()
}

fn pressed(_: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    let of = |&(one, other, time): &(usize, usize, f64)| {
        Advice::new(
            format!("collider.{other}.velocity"),
            format!(
                "`collider.{one}` and `collider.{other}` meet after {time:.3e} s: what is between them is crushed without bound, and then carried \
                 along by the later of the two"
            ),
            "let the run end before, or stop the walls short of each other",
        )
    };
    facts.presses.iter().map(of).collect()
}

fn coincident(_: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    let count = facts.coincident;
    let advice = || {
        Advice::new(
            "body.0.placement",
            format!("{count} particles lie exactly where another does: they never part"),
            "leave out one of each pair, or place them anew",
        )
    };
    (count > 0).then(advice).into_iter().collect()
}

fn incompressible(spec: &SceneSpec, _: &Facts) -> Vec<Advice> {
    let of = |(number, poisson): (usize, f64)| {
        Advice::new(
            format!("body.{number}.material.poisson"),
            format!(
                "is {poisson}: plastic flow of nearly incompressible snow makes energy, which no guard sees (docs/extremes.md)"
            ),
            format!("use at most {INCOMPRESSIBLE}"),
        )
    };
    let ratios = spec.body.iter().enumerate().filter_map(|(number, body)| match body.material {
        MaterialSpec::Snow { poisson, .. } => Some((number, poisson)),
        MaterialSpec::Elastic { .. } => None,
    });
    ratios.filter(|(_, poisson)| *poisson > INCOMPRESSIBLE).map(of).collect()
}

fn hardening(spec: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    let yields = facts.speed_over_yield.is_some_and(|ratio| ratio > 1.0);
    let of = |(number, xi): (usize, f64)| {
        Advice::new(
            format!("body.{number}.material.hardening"),
            format!(
                "is {xi} without a limit: snow packed to half its volume is e^{:.0} times as stiff, and a single such particle shortens the steps \
                 of all",
                0.5 * xi
            ),
            "set `hardening_limit`, such as 64",
        )
    };
    let unlimited = spec.body.iter().enumerate().filter_map(|(number, body)| match body.material {
        MaterialSpec::Snow { hardening, hardening_limit: None, .. } => Some((number, hardening)),
        _ => None,
    });
    unlimited.filter(|(_, xi)| yields && *xi > HARD).map(of).collect()
}

fn long_implicit_steps(spec: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    let yields = facts.speed_over_yield.is_some_and(|ratio| ratio > 1.0);
    if spec.numerics.integrator.is_none() || spec.numerics.wave_courant.is_some() || !yields {
        return Vec::new();
    }
    vec![Advice::new(
        "numerics.wave_courant",
        "is left out: implicit steps as long as motion allows make plastic loss out of nothing where snow yields (docs/integrators.md)",
        "set it to 4 or less",
    )]
}

fn out_of_reach(spec: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    if spec.numerics.precision == PrecisionName::F64 || facts.reach < FAR {
        return Vec::new();
    }
    vec![Advice::new(
        "numerics.precision",
        format!(
            "particles are up to {:.0} cells apart from the origin of their coordinates: f32 does not resolve a step's motion there",
            facts.reach
        ),
        "use `f64`, or bring the bodies together",
    )]
}

fn memory(_: &SceneSpec, facts: &Facts) -> Vec<Advice> {
    let (Some(needed), Some(free)) = (facts.memory, facts.memory_free) else { return Vec::new() };
    if needed <= free {
        return Vec::new();
    }
    vec![Advice::new(
        "body.0.placement.count",
        format!("the run takes about {}, and {} are free", in_words(needed), in_words(free)),
        "use fewer particles or frames, `precision = \"f32\"`, or another machine",
    )]
}
