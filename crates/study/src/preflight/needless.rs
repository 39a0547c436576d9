//! Features that a scene names and does not need, and what leaving each out would save.

use std::path::Path;
use std::time::Duration;

use serde::Serialize;

use crate::pace::{ratio, start};
use crate::spec::scene::{EngineName, MaterialSpec, PrecisionName};
use crate::spec::{SceneSpec, SpecError};

use super::facts::Facts;
use super::hazards::Advice;
use super::rehearsal::Rehearsal;

/// A feature that may go.
#[derive(Clone, Debug, Serialize)]
pub struct Needless {
    /// Where it is set, why it is not needed, and how to leave it out.
    #[serde(flatten)]
    pub advice: Advice,
    /// Share of the run's time that leaving it out saves, measured on this machine by turns; negative where it costs. `None` where the scene
    /// without it does not run.
    pub saves: Option<f64>,
}

/// A feature and the scene without it; `None` where the scene needs it or does not have it.
type Rule = fn(&SceneSpec, &Facts, &[Rehearsal]) -> Option<(Advice, SceneSpec)>;

const RULES: [Rule; 7] = [engine, plasticity, precision, energy_budget, watchdog, untouched, implicit];

/// The features that the scene can do without, each measured for about `budget`.
///
/// # Errors
/// A scene that cannot be built.
pub fn needless(
    spec: &SceneSpec,
    facts: &Facts,
    rehearsals: &[Rehearsal],
    folder: &Path,
    threads: usize,
    budget: Duration,
) -> Result<Vec<Needless>, SpecError> {
    let found = RULES.iter().filter_map(|rule| rule(spec, facts, rehearsals));
    let measure = |(advice, without): (Advice, SceneSpec)| {
        let (mut base, mut varied) = (start(spec, folder, threads)?, start(&without, folder, threads)?);
        let saves = ratio(base.run.as_mut(), varied.run.as_mut(), budget).ok().map(|ratio| 1.0 - ratio);
        Ok(Needless { advice, saves })
    };
    found.map(measure).collect()
}

fn with(spec: &SceneSpec, change: impl FnOnce(&mut SceneSpec)) -> SceneSpec {
    let mut changed = spec.clone();
    change(&mut changed);
    changed
}

fn engine(spec: &SceneSpec, _: &Facts, _: &[Rehearsal]) -> Option<(Advice, SceneSpec)> {
    let is_slow =
        spec.numerics.engine == EngineName::Reference && snowlab_solver::Engine::Fast.is_available();
    let finding = "is `reference`, whose steps are those of `fast` but for the order of sums";
    let advice = Advice::new("numerics.engine", finding, "leave it out");
    is_slow.then(|| (advice, with(spec, |scene| scene.numerics.engine = EngineName::Fast)))
}

fn plasticity(spec: &SceneSpec, facts: &Facts, rehearsals: &[Rehearsal]) -> Option<(Advice, SceneSpec)> {
    let has_snow = spec.body.iter().any(|body| matches!(body.material, MaterialSpec::Snow { .. }));
    let yields = rehearsals.is_empty() || rehearsals.iter().any(|small| small.plastic_loss != 0.0);
    if !has_snow || yields || facts.speed_over_yield.is_some_and(|ratio| ratio >= 1.0) {
        return None;
    }
    let elastic = with(spec, |scene| {
        for body in &mut scene.body {
            if let MaterialSpec::Snow { density, young, poisson, .. } = body.material {
                body.material = MaterialSpec::Elastic { density, young, poisson };
            }
        }
    });
    let finding = "is `snow`, and nothing yields in the rehearsals";
    Some((
        Advice::new("body.0.material.kind", finding, "use `elastic`, with the same density and moduli"),
        elastic,
    ))
}

fn precision(spec: &SceneSpec, _: &Facts, _: &[Rehearsal]) -> Option<(Advice, SceneSpec)> {
    let finding = "is `f64`; single balls break otherwise in `f32`, but not more or less on average (docs/performance.md)";
    let single = || with(spec, |scene| scene.numerics.precision = PrecisionName::F32);
    let advice = Advice::new("numerics.precision", finding, "use `f32` where averages count");
    (spec.numerics.precision == PrecisionName::F64).then(|| (advice, single()))
}

fn energy_budget(spec: &SceneSpec, _: &Facts, _: &[Rehearsal]) -> Option<(Advice, SceneSpec)> {
    let finding = "books the energy lost in transfers and contacts, which moves nothing";
    let advice =
        Advice::new("numerics.energy_budget", finding, "set it to false where those columns are not read");
    spec.numerics.energy_budget.then(|| (advice, with(spec, |scene| scene.numerics.energy_budget = false)))
}

fn watchdog(spec: &SceneSpec, facts: &Facts, rehearsals: &[Rehearsal]) -> Option<(Advice, SceneSpec)> {
    let was_quiet = !rehearsals.is_empty() && rehearsals.iter().all(|small| small.watchdog_restores == 0);
    let is_safe = spec.numerics.fixed_step.is_none() && facts.courant <= facts.courant_limit;
    let finding = "guards against steps that make energy, and had nothing to do in the rehearsals";
    let advice = Advice::new("numerics.watchdog", finding, "set it to false, at the price of a guard");
    let applies = spec.numerics.watchdog && was_quiet && is_safe;
    applies.then(|| (advice, with(spec, |scene| scene.numerics.watchdog = false)))
}

fn untouched(spec: &SceneSpec, _: &Facts, rehearsals: &[Rehearsal]) -> Option<(Advice, SceneSpec)> {
    let (first, others) = rehearsals.split_first()?;
    let idle = |number: &usize| others.iter().all(|small| small.untouched.contains(number));
    let idle: Vec<usize> = first.untouched.iter().copied().filter(idle).collect();
    let names: Vec<String> = idle.iter().map(|number| format!("`collider.{number}`")).collect();
    let key = format!("collider.{}", idle.first()?);
    let advice =
        Advice::new(key, format!("nothing touches {} in the rehearsals", names.join(", ")), "leave it out");
    Some((
        advice,
        with(spec, |scene| idle.iter().rev().for_each(|&number| drop(scene.collider.remove(number)))),
    ))
}

fn implicit(spec: &SceneSpec, facts: &Facts, _: &[Rehearsal]) -> Option<(Advice, SceneSpec)> {
    spec.numerics.integrator.as_ref()?;
    let yields = facts.speed_over_yield.is_some_and(|ratio| ratio > 1.0);
    let finding = "is implicit, which pays for stiff bodies near rest and not for snow that breaks (docs/integrators.md)";
    let explicit = with(spec, |scene| {
        scene.numerics.integrator = None;
        scene.numerics.wave_courant = None;
    });
    yields.then(|| (Advice::new("numerics.integrator", finding, "leave it out"), explicit))
}
