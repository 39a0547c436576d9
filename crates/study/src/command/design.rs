//! design: a placement for a wanted fragmentation, from the response that a study with a sampled axis has measured.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail, ensure};
use clap::Args;
use serde::Serialize;
use snowlab_study::response::validate::{self, Validation};
use snowlab_study::response::{Data, Metric, Proposal, Refusal, Surface, Wanted, propose, sampled_arms};
use snowlab_study::spec::override_path;
use snowlab_study::spec::study::{BlockSpec, StudySpec, SweepSpec};
use snowlab_study::statistics::Interval;
use snowlab_study::sweep::Study;
use snowlab_study::template::records;
use toml::Value;

use super::opened::{Opened, StudyArguments};
use super::{Exit, print_json};

/// Balls for each target of a validation (the study's plan).
const BALLS: u64 = 8;
/// How far behind the study's own seeds those of a validation begin (chosen: beyond any study's number of blocks).
const FRESH: u64 = 1000;

/// What is wanted.
#[derive(Debug, Args)]
pub struct DesignArguments {
    /// Study with a sampled axis, which has been run
    #[arg(default_value = "studies/knob.toml")]
    file: PathBuf,
    /// A named variation of the study
    #[arg(long)]
    profile: Option<String>,
    /// Folder of results
    #[arg(long, default_value = "results")]
    out: PathBuf,
    /// Effective number of fragments
    #[arg(long, group = "target")]
    neff: Option<f64>,
    /// Number of fragments
    #[arg(long, group = "target")]
    fragments: Option<f64>,
    /// Speed of the impact [m/s]: the factor `speed`
    #[arg(long)]
    speed: Option<f64>,
    /// A factor that is given, as NAME=NUMBER; any number of times
    #[arg(long = "given", value_name = "NAME=NUMBER")]
    given: Vec<String>,
    /// Arm, such as one kind of voids; all that have been sampled if not told
    #[arg(long)]
    arm: Option<String>,
    /// Write the proposed scene
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Write a study that throws balls at so many targets, to see how often what comes out lies in the predicted interval
    #[arg(long, value_name = "FILE", group = "target", requires = "targets")]
    validation: Option<PathBuf>,
    /// How many targets
    #[arg(long)]
    targets: Option<usize>,
    /// Hold what came out of such a study against the predictions
    #[arg(long, value_name = "FILE", group = "target")]
    score: Option<PathBuf>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// A proposal in words and numbers.
#[derive(Serialize)]
struct Told {
    arm: String,
    response: &'static str,
    model: &'static str,
    factors: BTreeMap<String, f64>,
    /// Of the response as it is asked for: a number of fragments.
    mean: f64,
    lower: f64,
    upper: f64,
}

/// Proposes, or prepares or judges a validation.
pub fn design(arguments: &DesignArguments) -> anyhow::Result<Exit> {
    let DesignArguments { file, profile, out, .. } = arguments;
    let opened = StudyArguments { file: file.clone(), profile: profile.clone(), out: out.clone() };
    let Opened { study, .. } = opened.open()?;
    let results = opened.archive(&study)?.store.root().to_path_buf();
    if let Some(file) = &arguments.validation {
        return write_validation(arguments, &study, &results, file);
    }
    if let Some(file) = &arguments.score {
        return score(arguments, &study, &results, file);
    }
    let (metric, target) = match (arguments.neff, arguments.fragments) {
        (Some(number), _) => (Metric::EffectiveNumber, number),
        (_, Some(number)) => (Metric::Fragments, number),
        _ => bail!("tell what is wanted: --neff NUMBER or --fragments NUMBER (or --validation, or --score)"),
    };
    if !(target.is_finite() && target >= 1.0) {
        bail!("{target} fragments are wanted; allowed: 1 or more");
    }
    let wanted = Wanted { response: libm::log(target), given: given(arguments)? };
    let surfaces = surfaces(&study, &results, metric, arguments.arm.as_deref())?;
    // Of the arms that can, the one whose balls spread least.
    let (mut found, mut refused, mut others) = (Vec::<(&Surface, Proposal)>::new(), Vec::new(), Vec::new());
    for surface in &surfaces {
        match propose(surface, &wanted) {
            Ok(proposal) => found.push((surface, proposal)),
            Err(Refusal::OutOfReach { band, .. }) => refused.push((&surface.data.arm, band)),
            Err(refusal) => others.push(format!("{}: {refusal}", surface.data.arm)),
        }
    }
    let Some((surface, proposal)) =
        found.into_iter().min_by(|a, b| a.1.prediction.deviation.total_cmp(&b.1.prediction.deviation))
    else {
        ensure!(!refused.is_empty(), "{}", others.join("\n"));
        bail!("{}", out_of_reach(target, metric, &wanted, &refused));
    };
    let told = told(surface, &proposal);
    if let Some(path) = &arguments.scene {
        let scene = scene(&study.spec, surface, &proposal)?;
        std::fs::write(path, scene).with_context(|| path.display().to_string())?;
    }
    if arguments.json {
        return print_json(&told);
    }
    print(&told, surface, &proposal);
    Ok(Exit::Done)
}

/// What can be had in place of what was asked for.
fn out_of_reach(target: f64, metric: Metric, wanted: &Wanted, refused: &[(&String, Interval)]) -> String {
    let given: Vec<String> = wanted.given.iter().map(|(name, number)| format!("{name} = {number}")).collect();
    let with = if given.is_empty() { String::new() } else { format!(" with {}", given.join(", ")) };
    let mut text = format!(
        "{target} as the {} is out of reach{with}; 5 to 95 % of what is predicted over the factors' ranges:",
        response(metric)
    );
    for (arm, band) in refused {
        text += &format!("\n  {arm:16} {:.2} to {:.2}", libm::exp(band.lower), libm::exp(band.upper));
    }
    if !given.is_empty() {
        text += "\nLeave out what is given to see what else reaches it.";
    }
    text
}

fn response(metric: Metric) -> &'static str {
    match metric {
        Metric::Fragments => "number of fragments",
        _ => "effective number of fragments",
    }
}

fn given(arguments: &DesignArguments) -> anyhow::Result<BTreeMap<String, f64>> {
    let mut given: BTreeMap<String, f64> = BTreeMap::new();
    for text in &arguments.given {
        let (name, number) = text
            .split_once('=')
            .and_then(|(name, number)| Some((name.trim(), number.trim().parse().ok()?)))
            .with_context(|| format!("--given {text}: write NAME=NUMBER, such as porosity=0.2"))?;
        given.insert(name.to_string(), number);
    }
    given.extend(arguments.speed.map(|speed| ("speed".to_string(), speed)));
    Ok(given)
}

/// The surfaces of an arm, or of all arms that are run along a sampled axis.
fn surfaces(
    study: &Study,
    results: &Path,
    metric: Metric,
    arm: Option<&str>,
) -> anyhow::Result<Vec<Surface>> {
    let sampled: Vec<&str> = match arm {
        Some(arm) => vec![arm],
        None => sampled_arms(&study.spec),
    };
    if sampled.is_empty() {
        bail!(
            "the study `{}` has no [sweep.sample]; a response is learnt from points of such an axis",
            study.spec.name
        );
    }
    let fit = |arm: &str| -> anyhow::Result<Surface> {
        let data = Data::read(&study.spec, arm, metric, results)?;
        Surface::fit(data).map_err(|message| anyhow::anyhow!("arm `{arm}`: {message}"))
    };
    sampled.into_iter().map(fit).collect()
}

fn told(surface: &Surface, proposal: &Proposal) -> Told {
    let factors = &surface.data.factors;
    Told {
        arm: surface.data.arm.clone(),
        response: response(surface.data.metric),
        model: surface.kind.words(),
        factors: factors.iter().zip(&proposal.numbers).map(|(f, n)| (f.name.clone(), *n)).collect(),
        mean: libm::exp(proposal.prediction.mean),
        lower: libm::exp(proposal.interval.lower),
        upper: libm::exp(proposal.interval.upper),
    }
}

fn print(told: &Told, surface: &Surface, proposal: &Proposal) {
    println!("{}, by the {} of {} points", told.arm, told.model, surface.data.points.len());
    for (factor, number) in surface.data.factors.iter().zip(&proposal.numbers) {
        println!("  {:16} {number:<10} {}", factor.name, factor.path);
    }
    println!(
        "  {}: {:.2}; four balls in five between {:.2} and {:.2}",
        told.response, told.mean, told.lower, told.upper
    );
}

/// The study's scene with what its arm and the proposal set.
fn scene(spec: &StudySpec, surface: &Surface, proposal: &Proposal) -> anyhow::Result<String> {
    let mut scene = Value::Table(spec.scene.clone());
    let arm = spec.arm.iter().find(|arm| arm.id == surface.data.arm);
    let own = arm.into_iter().flat_map(|arm| &arm.set).map(|(path, value)| (path.clone(), value.clone()));
    let factors = surface.data.factors.iter().zip(&proposal.numbers);
    for (path, value) in own.chain(factors.map(|(f, n)| (f.path.clone(), f.value(*n)))) {
        override_path::set(&mut scene, &path, value).map_err(|e| anyhow::anyhow!("{path}: {e}"))?;
    }
    Ok(toml::to_string(&scene)?)
}

/// Writes a study of targets spread over what can be reached: its points are frozen before it is run.
fn write_validation(
    arguments: &DesignArguments,
    study: &Study,
    results: &Path,
    file: &Path,
) -> anyhow::Result<Exit> {
    let count = arguments.targets.context("tell how many targets: --targets NUMBER")?;
    let surfaces = surfaces(study, results, Metric::EffectiveNumber, arguments.arm.as_deref())?;
    let targets = validate::targets(&surfaces, count).map_err(|refusal| anyhow::anyhow!("{refusal}"))?;
    let sweep: Vec<SweepSpec> =
        surfaces.iter().enumerate().filter_map(|(k, s)| validate::axis(s, k, &targets)).collect();
    let blocks = BlockSpec { first: study.spec.blocks.first + FRESH, count: BALLS };
    let spec = StudySpec {
        name: format!("{}-validation", study.spec.name),
        question: "How often does what comes out lie in the predicted interval?".into(),
        blocks,
        arm: study
            .spec
            .arm
            .iter()
            .filter(|arm| sweep.iter().any(|axis| axis.takes(&arm.id)))
            .cloned()
            .collect(),
        sweep,
        caveats: Vec::new(),
        profile: BTreeMap::new(),
        expect: Vec::new(),
        ..study.spec.clone()
    };
    let head = format!(
        "# Made by `snowlab design {} --validation FILE --targets {count}` from its results, and not changed since: targets spread over what can be\n\
         # reached, each with the placement that was proposed for it.\n",
        arguments.file.display()
    );
    let text = toml::to_string(&spec).context("the study cannot be written")?;
    std::fs::write(file, head + &text).with_context(|| file.display().to_string())?;
    println!("{}: {} targets, {BALLS} balls each", file.display(), targets.len());
    Ok(Exit::Done)
}

/// Holds what came out of such a study against the predictions.
fn score(arguments: &DesignArguments, study: &Study, results: &Path, file: &Path) -> anyhow::Result<Exit> {
    let (validated, _) = Study::read(file, None)?;
    let folder = results.with_file_name(&validated.spec.name);
    let rows = records(&folder.join("cases.csv")).context("run the validation and `snowlab report` it")?;
    let surfaces = surfaces(study, results, Metric::EffectiveNumber, arguments.arm.as_deref())?;
    let mut outcomes = Vec::new();
    for surface in &surfaces {
        for axis in validated.spec.sweep.iter().filter(|axis| axis.takes(&surface.data.arm)) {
            outcomes.extend(validate::outcomes(surface, axis, &rows));
        }
    }
    outcomes.sort_by(|a, b| a.target.total_cmp(&b.target));
    let found = Validation::of(&surfaces, &outcomes).context("no target has been run")?;
    let tables = [validate::table(&outcomes), found.table()];
    for table in &tables {
        table.write(&folder)?;
    }
    println!("{}", found.in_words());
    println!("{}", folder.join("validation.csv").display());
    Ok(Exit::Done)
}
