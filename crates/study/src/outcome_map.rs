//! How cases end over two axes of a sweep: for each arm the limit found, beside the limit derived for its step.

use snowlab_solver::material::ConstitutiveModel;
use snowlab_solver::timestep::wave_limit;

use crate::assemble::{kernel, material, transfer};
use crate::record::Outcome;
use crate::results::CaseResult;
use crate::spec::SceneSpec;
use crate::spec::study::{MapSpec, SoundSpec, SweepSpec};
use crate::sweep::Study;
use crate::table::{Row, Table};
use crate::tables::case_row;

/// How a case ended, the better first.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum End {
    /// `ok`, and sound.
    Sound,
    /// `ok-with-clamps`, and sound.
    Clamped,
    /// Sound, but with shorter steps than were asked for: some were refused.
    Halved,
    /// It ended well, but outside the range of a sound case.
    Unsound,
    /// It stopped, by this reason.
    Stopped(String),
}

impl End {
    /// Whether the case is sound with the steps it asked for.
    pub fn is_sound(&self) -> bool {
        matches!(self, End::Sound | End::Clamped)
    }

    fn of(result: &CaseResult, sound: Option<&SoundSpec>) -> End {
        let record = &result.record;
        if let Outcome::Stopped { reason, .. } = &record.outcome {
            return End::Stopped(reason.clone());
        }
        let inside = |sound: &SoundSpec| {
            let [least, greatest] = sound.range;
            case_row(result).value(&sound.metric).is_some_and(|value| value >= least && value <= greatest)
        };
        match record.outcome {
            _ if !sound.is_none_or(inside) => End::Unsound,
            _ if record.rejected_steps + record.watchdog_restores > 0 => End::Halved,
            Outcome::OkWithClamps => End::Clamped,
            _ => End::Sound,
        }
    }

    /// As `maps.csv` and legends have it; `unsound` is what the study calls a case outside the range of a sound one.
    pub fn in_words(&self, unsound: &str) -> String {
        match self {
            End::Sound => "ok".into(),
            End::Clamped => "ok-with-clamps".into(),
            End::Halved => "ok, with steps refused".into(),
            End::Unsound => format!("ok, but {unsound}"),
            End::Stopped(reason) => format!("stopped({reason})"),
        }
    }
}

/// An axis of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapAxis {
    /// Name of the axis of the sweep.
    pub name: String,
    /// Words for it.
    pub label: String,
    /// Its numbers, ascending.
    pub numbers: Vec<f64>,
}

impl MapAxis {
    fn of(study: &Study, name: &str, label: Option<&String>) -> Self {
        let axis = study.spec.sweep.iter().find(|axis| axis.name == name);
        let mut numbers = axis.map_or(Vec::new(), SweepSpec::all_numbers);
        numbers.sort_by(f64::total_cmp);
        numbers.dedup();
        MapAxis { name: name.into(), label: label.map_or(name, String::as_str).into(), numbers }
    }
}

/// One arm of a map at one place of its vertical axis.
#[derive(Clone, Debug, PartialEq)]
pub struct MapRow {
    /// Where on the vertical axis.
    pub y: f64,
    /// The worst end at each number of the horizontal axis; `None` where nothing has been run.
    pub ends: Vec<Option<End>>,
    /// Where on the horizontal axis the first step is as long as the derived limit, if steps go by that axis.
    pub derived: Option<f64>,
}

impl MapRow {
    /// Places along the horizontal axis before the first case that is not sound, and of that one.
    fn found(&self, x: &MapAxis) -> (Option<f64>, Option<(f64, &End)>) {
        let run: Vec<(f64, &End)> =
            x.numbers.iter().zip(&self.ends).filter_map(|(x, end)| Some((*x, end.as_ref()?))).collect();
        let first = run.iter().position(|(_, end)| !end.is_sound());
        let before = run[..first.unwrap_or(run.len())].last().map(|(x, _)| *x);
        (before, first.map(|place| run[place]))
    }
}

/// One arm of a map.
#[derive(Clone, Debug, PartialEq)]
pub struct MapArm {
    /// Its id.
    pub id: String,
    /// Words for it.
    pub label: String,
    /// From the least number of the vertical axis on.
    pub rows: Vec<MapRow>,
}

/// A map.
#[derive(Clone, Debug, PartialEq)]
pub struct OutcomeMap {
    /// As the study has it.
    pub spec: MapSpec,
    /// The horizontal axis.
    pub x: MapAxis,
    /// The vertical axis.
    pub y: MapAxis,
    /// The arms that have been run.
    pub arms: Vec<MapArm>,
}

impl OutcomeMap {
    /// The ends of its cases in words.
    pub fn words(&self, end: &End) -> String {
        end.in_words(self.spec.sound.as_ref().map_or("not sound", |sound| &sound.otherwise))
    }

    fn of(study: &Study, spec: &MapSpec, results: &[CaseResult]) -> Self {
        let x = MapAxis::of(study, &spec.x, spec.x_label.as_ref());
        let y = MapAxis::of(study, &spec.y, spec.y_label.as_ref());
        let run = study.arms();
        let arms = spec.arms_of(&study.spec).into_iter().filter(|id| run.contains(id));
        let arms = arms.map(|id| MapArm {
            id: id.into(),
            label: study.label(id),
            rows: y.numbers.iter().map(|&at| row(spec, &x, at, id, results)).collect(),
        });
        OutcomeMap { spec: spec.clone(), arms: arms.collect(), x, y }
    }
}

fn row(spec: &MapSpec, x: &MapAxis, y: f64, arm: &str, results: &[CaseResult]) -> MapRow {
    let here: Vec<&CaseResult> =
        results.iter().filter(|r| r.case.arm == arm && r.case.number(&spec.y) == Some(y)).collect();
    let at = |x: f64| here.iter().filter(move |result| result.case.number(&spec.x) == Some(x));
    let ends = x.numbers.iter().map(|&x| at(x).map(|result| End::of(result, spec.sound.as_ref())).max());
    let limits: Option<Vec<f64>> = here
        .iter()
        .map(|result| Some(result.case.number(&spec.x)? / share_of_limit(&result.case.scene)?))
        .collect();
    MapRow { y, ends: ends.collect(), derived: limits.and_then(|limits| the_same(&limits)) }
}

/// The number that all are, but for a share of 1e-3 (chosen: numbers that stand for values are rounded).
fn the_same(numbers: &[f64]) -> Option<f64> {
    let first = *numbers.first()?;
    numbers.iter().all(|number| (number / first - 1.0).abs() < 1e-3).then_some(first)
}

/// The maps of a study from its results.
pub fn maps(study: &Study, results: &[CaseResult]) -> Vec<OutcomeMap> {
    study.spec.map.iter().map(|spec| OutcomeMap::of(study, spec, results)).collect()
}

/// The first step that a scene asks for over the limit derived for it (docs/stability.md): dt max c / (h C_limit), c of particles with the
/// density of their material at F = I. `None` with implicit steps, which have no such limit.
pub fn share_of_limit(scene: &SceneSpec) -> Option<f64> {
    let numerics = &scene.numerics;
    if numerics.integrator.is_some() {
        return None;
    }
    let limit = wave_limit(kernel(numerics.kernel), transfer(numerics));
    let Some(dt) = numerics.fixed_step else {
        // The default is half the limit.
        return Some(numerics.wave_courant.map_or(0.5, |courant| courant / limit));
    };
    let squared = scene.body.iter().map(|body| {
        let modulus = match scene.dimension {
            3 => ConstitutiveModel::<f64, 3>::lame(&material(&body.material)).wave_modulus::<3>(),
            _ => ConstitutiveModel::<f64, 2>::lame(&material(&body.material)).wave_modulus::<2>(),
        };
        modulus * body.stiffness_scale / body.material.density()
    });
    Some(dt * squared.fold(0.0, f64::max).sqrt() / (numerics.spacing * limit))
}

/// `maps`: one row a map, arm and place of the vertical axis.
pub fn table(maps: &[OutcomeMap]) -> Table {
    let mut rows = Vec::new();
    for map in maps {
        for arm in &map.arms {
            rows.extend(arm.rows.iter().map(|row| table_row(map, arm, row)));
        }
    }
    Table { name: "maps", rows }
}

fn table_row(map: &OutcomeMap, arm: &MapArm, found: &MapRow) -> Row {
    let (sound, broken) = found.found(&map.x);
    let over = |place: Option<f64>| Some(place? / found.derived?);
    let at = broken.map(|(x, _)| x);
    let mut row = Row::default();
    row.put("map", "-", "id of the map", map.spec.id.as_str())
        .put("arm", "-", "arm of the study", arm.id.as_str())
        .put("y", "-", "vertical axis", map.y.name.as_str())
        .number("at", "of y", "place on the vertical axis", found.y)
        .put("x", "-", "horizontal axis", map.x.name.as_str())
        .put("derived", "of x", "where the first step is as long as the limit derived for it", found.derived)
        .put("sound_to", "of x", "the last place before a case that is not sound", sound)
        .put("fails_from", "of x", "the first place of a case that is not sound", at)
        .put("sound_to_over_derived", "-", "sound_to over derived", over(sound))
        .put("fails_from_over_derived", "-", "fails_from over derived", over(at))
        .put(
            "end",
            "-",
            "how that case ended",
            broken.map_or(String::new(), |(_, end)| map.words(end)).as_str(),
        );
    row
}
