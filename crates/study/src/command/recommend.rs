//! recommend: the cheapest setting that is close enough, for a scene of one's own.

use std::path::{Path, PathBuf};

use anyhow::{Context, ensure};
use clap::Args;
use serde::Serialize;
use snowlab_study::preflight::{facts, preflight};
use snowlab_study::spec::scene::RegionSpec;
use snowlab_study::spec::{self, SceneSpec};
use snowlab_study::template::records;
use snowlab_study::trade::{Binding, Preset, Setting, Wanted, recommend as choose};
use toml::Table;

use super::{Exit, print_json};

/// What is wanted.
#[derive(Debug, Args)]
pub struct RecommendArguments {
    /// Greatest relative error of displacements, impulse and kinetic energy in the first waves, such as 0.05
    #[arg(long)]
    error: Option<f64>,
    /// Greatest difference of fragments, in standard deviations between balls, such as 0.3
    #[arg(long)]
    spread: Option<f64>,
    /// Wishes by a name
    #[arg(long, conflicts_with_all = ["error", "spread"])]
    preset: Option<Preset>,
    /// The scene it is for
    #[arg(long, value_name = "FILE")]
    scene: Option<PathBuf>,
    /// Write the scene with the setting
    #[arg(long, value_name = "FILE", requires = "scene")]
    write: Option<PathBuf>,
    /// What has been measured of settings, by `snowlab tradeoff studies/tradeoff.toml`
    #[arg(long, value_name = "FILE", default_value = "results/tradeoff/settings.csv")]
    settings: PathBuf,
    /// Threads of the run whose time is predicted; all cores if not told
    #[arg(long)]
    threads: Option<usize>,
    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// The answer.
#[derive(Debug, Serialize)]
struct Answer {
    setting: Setting,
    binding: Binding,
    /// What to set in the scene, or what the setting is without one.
    set: Table,
    /// Whether anything strikes anything in the scene.
    strikes: bool,
    /// Wall time [s] of the scene, or of the study's first scene on one thread.
    seconds: Option<f64>,
}

/// Prints the cheapest setting that keeps what is wanted.
pub fn recommend(arguments: &RecommendArguments) -> anyhow::Result<Exit> {
    let file = &arguments.settings;
    ensure!(
        file.exists(),
        "{}: there is no such table; run `snowlab tradeoff` on a study of settings, or name its table with --settings FILE",
        file.display()
    );
    let settings = Setting::read(&records(file)?).with_context(|| file.display().to_string())?;
    let wanted = match arguments.preset {
        Some(preset) => preset.wanted(),
        None => Wanted { error: arguments.error, spread: arguments.spread },
    };
    ensure!(
        wanted != Wanted::default(),
        "nothing is wanted; give --error NUMBER, --spread NUMBER or --preset NAME"
    );
    for (name, value) in [("--error", wanted.error), ("--spread", wanted.spread)] {
        ensure!(value.is_none_or(|v| v > 0.0 && v.is_finite()), "{name}: allowed: numbers above 0");
    }
    let answer = match &arguments.scene {
        Some(path) => for_scene(arguments, &settings, wanted, path)?,
        None => {
            let (setting, binding) = choose(&settings, wanted)?;
            let (set, seconds) = (setting.numerics.clone(), Some(setting.seconds));
            Answer { setting: setting.clone(), binding, set, strikes: true, seconds }
        }
    };
    if arguments.json {
        return print_json(&answer);
    }
    print(&answer, wanted, arguments.scene.is_some())?;
    Ok(Exit::Done)
}

/// Wishes are held against errors at the scene's own impact; a preset is the same setting in every scene.
fn for_scene(
    arguments: &RecommendArguments,
    settings: &[Setting],
    wanted: Wanted,
    path: &Path,
) -> anyhow::Result<Answer> {
    let (scene, text) = spec::read::<SceneSpec>(path)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    let of_file = |error: spec::SpecError| error.in_text(&text).within(path.display());
    let now = facts(&scene, folder).map_err(of_file)?;
    let at_its_impact = |setting: &Setting| setting.at(now.mach);
    let (setting, binding) = if arguments.preset.is_some() {
        let (setting, binding) = choose(settings, wanted)?;
        (at_its_impact(setting), binding)
    } else {
        let settings: Vec<Setting> = settings.iter().map(at_its_impact).collect();
        let (setting, binding) = choose(&settings, wanted)?;
        (setting.clone(), binding)
    };
    let table =
        setting.apply(&scene, folder, now.particles_per_cell).with_context(|| path.display().to_string())?;
    let made: SceneSpec = spec::parse(&toml::to_string(&table)?)?;
    let threads =
        arguments.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, usize::from));
    let predicted = preflight(&made, folder, threads)?.predicted;
    if let Some(file) = &arguments.write {
        write(file, &made, folder)?;
    }
    let mut set = setting.numerics.clone();
    set.insert("spacing".into(), table["numerics"]["spacing"].clone());
    let counts =
        made.body.iter().filter_map(|body| Some(toml::Value::Integer(body.placement.count()? as i64)));
    set.insert("count".into(), toml::Value::Array(counts.collect()));
    let seconds = predicted.map(|predicted| predicted.seconds);
    Ok(Answer { setting, binding, set, strikes: now.mach > 0.0, seconds })
}

/// Writes a scene whose files are named from `folder`: where it comes to lie elsewhere, by their whole paths.
fn write(file: &Path, scene: &SceneSpec, folder: &Path) -> anyhow::Result<()> {
    let mut scene = scene.clone();
    // Of a bare name the folder is empty, which is none.
    let whole = |path: &Path| std::path::absolute(Path::new(".").join(path));
    if whole(file.parent().unwrap_or(Path::new(".")))? != whole(folder)? {
        for mesh in
            scene.body.iter_mut().filter_map(|body| body.region.as_mut()).flat_map(RegionSpec::meshes_mut)
        {
            mesh.path = whole(&folder.join(&mesh.path))?.display().to_string();
        }
    }
    std::fs::write(file, toml::to_string(&scene)?).with_context(|| file.display().to_string())
}

fn print(answer: &Answer, wanted: Wanted, for_scene: bool) -> anyhow::Result<()> {
    let Answer { setting, binding, set, seconds, .. } = answer;
    println!(
        "{}: {:.0} cells across the body, {:.3} particles to a cell",
        setting.arm, setting.cells_across, setting.particles_per_cell
    );
    for (key, value) in set {
        match key.as_str() {
            "count" => println!("  body.N.placement.count = {value}, body by body"),
            _ => println!("  numerics.{key} = {value}"),
        }
    }
    let [least, greatest] = setting.machs;
    let whose = match for_scene {
        true if answer.strikes => "that of this scene",
        true => "nothing strikes anything in this scene",
        false => "the first scene of the study",
    };
    println!(
        "  error of the first waves at an impact of Mach {:.2} ({whose}; learnt from {least:.2} to {greatest:.2}): {:.3} on the mean over scenes; in one \
         scene between {:.3} and {:.3} with 90 % confidence",
        setting.mach, setting.error, setting.error_lower, setting.error_bound
    );
    let [held_out, below] = setting.held_out;
    println!("  in {below} of {held_out} scenes that nothing was learnt from it was below that");
    match setting.spread {
        Some(spread) => {
            println!("  fragments: within {spread:.2} standard deviations of those of a grid twice as fine")
        }
        None => println!("  fragments: not measured with this setting"),
    }
    match (seconds, for_scene) {
        (Some(seconds), true) => println!("  time: about {seconds:.1} s"),
        (Some(seconds), false) => {
            println!("  time: {seconds:.2} s for the first scene of studies/tradeoff.toml, on one thread")
        }
        (None, _) => println!("  time: not predicted; see `snowlab preflight`"),
    }
    let wish = match binding {
        Binding::Error => format!("--error {}", wanted.error.unwrap_or_default()),
        Binding::Fragments => format!("--spread {}", wanted.spread.unwrap_or_default()),
        Binding::Neither => "nothing: it is the cheapest of all".to_string(),
    };
    println!("  what keeps from a cheaper one: {wish}");
    Ok(())
}
