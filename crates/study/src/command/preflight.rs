//! preflight: what a scene will meet, take and not need.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use snowlab_study::memory::in_words;
use snowlab_study::preflight::{Advice, Facts, Predicted, Preflight, StepBound, facts, hazards, preflight};
use snowlab_study::spec::{self, SceneSpec};
use snowlab_study::sweep::Study;

use super::opened::duration;
use super::{Exit, cores, print_json};

/// Which scene.
#[derive(Debug, Args)]
pub struct PreflightArguments {
    /// Scene file
    scene: PathBuf,
    /// Threads that the run will have; all cores if not told
    #[arg(long)]
    threads: Option<usize>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// Looks into a scene.
pub fn look(arguments: &PreflightArguments) -> anyhow::Result<Exit> {
    let path = &arguments.scene;
    let (scene, text) = spec::read::<SceneSpec>(path)?;
    let threads = arguments.threads.unwrap_or_else(cores);
    let folder = path.parent().unwrap_or(Path::new("."));
    let found =
        preflight(&scene, folder, threads).map_err(|error| error.in_text(&text).within(path.display()))?;
    if arguments.json {
        return print_json(&found);
    }
    print(path, &scene, &found, threads);
    Ok(Exit::Done)
}

/// Says on the way to a run what is about to go wrong in it.
pub fn warn(scene: &SceneSpec, folder: &Path) -> Result<(), spec::SpecError> {
    for advice in hazards(scene, &facts(scene, folder)?) {
        eprintln!("snowlab: {advice}");
    }
    Ok(())
}

/// Cases are looked at before a study for so long (chosen: what nobody minds before minutes of running).
const LOOKING: Duration = Duration::from_secs(2);

/// Says what is about to go wrong in the cases of the given numbers: once for each kind of thing, with the arms that it is about. Of each point of
/// an arm the first case is looked at; scenes that cannot be built are left to the run.
pub fn warn_of_study(study: &Study, numbers: &[usize], folder: &Path) {
    let began = Instant::now();
    let (mut looked, mut found) = (BTreeSet::new(), BTreeMap::<Advice, BTreeSet<&str>>::new());
    for case in numbers.iter().map(|&number| &study.cases[number]) {
        let point = format!("{} {:?}", case.arm, case.axes);
        if began.elapsed() > LOOKING || !looked.insert(point) {
            continue;
        }
        for advice in facts(&case.scene, folder).iter().flat_map(|facts| hazards(&case.scene, facts)) {
            found.entry(advice).or_default().insert(&case.arm);
        }
    }
    for (advice, arms) in found {
        let arms: Vec<&str> = arms.into_iter().collect();
        eprintln!("snowlab: {}: {advice}", arms.join(", "));
    }
}

fn print(path: &Path, scene: &SceneSpec, found: &Preflight, threads: usize) {
    let Preflight { facts, rehearsals, predicted, hazards, needless } = found;
    let h = scene.numerics.spacing;
    println!("{}: {} particles in {}D, h = {h} m", path.display(), facts.particles, facts.dimension);
    lines(facts)
        .into_iter()
        .chain(predicted.map(|p| cost(&p, threads)))
        .for_each(|(name, what)| line(name, &what));
    for small in rehearsals {
        let what = format!("{} steps, {}", small.steps, small.outcome);
        line(&format!("rehearsed at {} h", small.coarser), &what);
    }
    if hazards.is_empty() {
        println!("\nnothing is about to go wrong that could be told from here");
    } else {
        println!("\nabout to go wrong");
        hazards.iter().for_each(tell);
    }
    if !needless.is_empty() {
        println!("\nnot needed");
    }
    for feature in needless {
        tell(&feature.advice);
        println!("    saves: {}", saving(feature.saves));
    }
}

/// Of less the machine's own noise says nothing (chosen: what medians over turns vary by).
const NOTICEABLE: f64 = 0.02;

fn saving(share: Option<f64>) -> String {
    match share {
        None => "not known, without it the scene does not run".into(),
        Some(share) if share >= NOTICEABLE => format!("{:.0} % of the time", 100.0 * share),
        Some(share) if share <= -NOTICEABLE => format!("nothing, it costs {:.0} % more time", -100.0 * share),
        Some(_) => "nothing that can be measured".into(),
    }
}

fn tell(advice: &Advice) {
    println!("  `{}`: {}", advice.key, advice.finding);
    println!("    remedy: {}", advice.remedy);
}

fn line(name: &str, what: &str) {
    println!("  {name:18} {what}");
}

fn lines(facts: &Facts) -> Vec<(&'static str, String)> {
    let bound = match facts.bound {
        StepBound::Waves => "elastic waves",
        StepBound::Motion => "the fastest particle",
        StepBound::Greatest => "`greatest_step`",
        StepBound::Fixed => "`fixed_step`",
    };
    let Facts { courant, courant_limit, first_step, .. } = facts;
    let mut lines = vec![(
        "first step",
        format!("{first_step:.2e} s, by {bound}; dt c / h = {courant:.2}, stable below {courant_limit:.2}"),
    )];
    if facts.first_meeting.is_finite() {
        lines.push((
            "first meeting",
            format!("after {:.3e} s, at {:.2} m/s", facts.first_meeting, facts.impact_speed),
        ));
        lines.push(("Mach number", format!("{:.2} (waves: {:.1} m/s)", facts.mach, facts.wave_speed)));
    }
    if let Some(ratio) = facts.speed_over_yield {
        lines.push((
            "speed over yield",
            format!("{ratio:.1}; flat faces yield from 1 on, edges and points before"),
        ));
    }
    let empty = facts
        .empty_cells
        .map(|share| format!("; random placement leaves {:.1} % of them empty", 100.0 * share));
    lines.push(("particles a cell", format!("{:.2}{}", facts.particles_per_cell, empty.unwrap_or_default())));
    lines.push(("cells across", format!("{:.1}", facts.cells_across)));
    let widths =
        [("narrowest void", facts.cells_across_void), ("thinnest bridge", facts.cells_across_bridge)];
    lines.extend(widths.into_iter().filter_map(|(name, cells)| Some((name, format!("{:.1} cells", cells?)))));
    if let (Some(memory), Some(free)) = (facts.memory, facts.memory_free) {
        lines.push(("memory", format!("{}; {} are free", in_words(memory), in_words(free))));
    }
    lines
}

fn cost(predicted: &Predicted, threads: usize) -> (&'static str, String) {
    let Predicted { steps, seconds, .. } = *predicted;
    ("to take", format!("{steps:.0} steps, {} on {threads} threads", duration(seconds)))
}
