//! From a study to its cases: pure values, listed before anything runs.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::path::Path;

use toml::Value;

use crate::spec::override_path;
use crate::spec::study::{
    ArmSpec, BlockSpec, DEFAULT_PROFILE, MeasureSpec, ProfileSpec, Rerun, StudySpec, SweepSpec,
};
use crate::spec::{self, SceneSpec, Spec, SpecError};

/// One run of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// The arm's id.
    pub arm: String,
    /// The block: seed of all random streams.
    pub block: u64,
    /// Axis name and number of each axis of the sweep; no number where the arm is not run along it.
    pub axes: Vec<(String, Option<f64>)>,
    /// The scene in full.
    pub scene: SceneSpec,
}

impl Case {
    /// The point of the sweep: name and number of each axis that the arm is run along.
    pub fn point(&self) -> impl Iterator<Item = (&str, f64)> {
        self.axes.iter().filter_map(|(name, number)| Some((name.as_str(), (*number)?)))
    }

    /// The number of the axis `name`, if the arm is run along it.
    pub fn number(&self, name: &str) -> Option<f64> {
        self.point().find(|(axis, _)| *axis == name).map(|(_, number)| number)
    }
}

/// A study with its profile applied.
#[derive(Clone, Debug)]
pub struct Study {
    /// The study as written.
    pub spec: StudySpec,
    /// The profile's name, `default` without one.
    pub profile: String,
    /// Measurement of this profile.
    pub measure: MeasureSpec,
    /// All cases, by arm, then axes, then block.
    pub cases: Vec<Case>,
}

/// More cases than this are refused (chosen: far more than a cluster runs of one study, far less than memory holds).
pub const MOST_CASES: u64 = 1_000_000;
/// Values in the scenes of all cases together (chosen: half a gigabyte, which is listed in half a minute).
pub const MOST_VALUES: u64 = 10_000_000;

impl Study {
    /// Reads a study file and expands it under the profile of the given name; its text comes with it.
    ///
    /// # Errors
    /// [`SpecError`], naming file, line and key.
    pub fn read(path: &Path, profile: Option<&str>) -> Result<(Self, String), SpecError> {
        let (spec, text) = spec::read::<StudySpec>(path)?;
        let study = Study::expand_text(&text, spec, profile).map_err(|error| error.within(path.display()))?;
        Ok((study, text))
    }

    /// Parses the text of a study file and expands it under the profile of the given name.
    ///
    /// # Errors
    /// [`SpecError::Value`], naming line and key.
    pub fn parse(text: &str, profile: Option<&str>) -> Result<Self, SpecError> {
        Study::expand_text(text, spec::parse(text)?, profile)
    }

    /// Expands what `text` says, whose lines errors name.
    fn expand_text(text: &str, spec: StudySpec, profile: Option<&str>) -> Result<Self, SpecError> {
        Study::expand(spec.clone(), profile)
            .map_err(|error| error.in_study(text, &spec, profile.unwrap_or(DEFAULT_PROFILE)))
    }

    /// Expands `spec` under the profile of the given name.
    ///
    /// # Errors
    /// [`SpecError::Value`], naming arm and key.
    pub fn expand(spec: StudySpec, profile: Option<&str>) -> Result<Self, SpecError> {
        spec.validate()?;
        let spec = spec.with_conditions();
        let name = profile.unwrap_or(DEFAULT_PROFILE);
        let chosen = profile_of(&spec, profile)?;
        check_count(&spec, &chosen)?;
        let mut cases = Vec::new();
        for arm in spec.arm.iter().filter(|arm| runs(&chosen, arm)) {
            let points: Vec<Vec<AxisPoint>> = axes_of(&spec, arm).map(|axis| points_of(axis, arm)).collect();
            for axes in &combinations(&points) {
                let number = |name: &str| {
                    let mut numbers = axes.iter().flat_map(|axis| &axis.numbers);
                    numbers.find(|(column, _)| *column == name).map(|(_, number)| *number)
                };
                let scene = scene_of(&spec, &chosen, arm, axes)?;
                if let (Some(by), Some(checked)) =
                    (arm.under.as_ref().and_then(|under| under.check), rerun(&spec, arm))
                {
                    differs_by(arm, by, &scene, &scene_of(&spec, &chosen, checked, axes)?)?;
                }
                let blocks = blocks_of(&spec, &chosen, arm);
                for block in blocks.first..blocks.first + blocks.count {
                    cases.push(Case {
                        arm: arm.id.clone(),
                        block,
                        axes: columns(&spec).map(|name| (name.to_string(), number(name))).collect(),
                        scene: SceneSpec { seed: block, ..scene.clone() },
                    });
                }
            }
        }
        let measure = chosen.measure.clone().unwrap_or_else(|| spec.measure.clone());
        Ok(Study { measure, profile: name.to_string(), spec, cases })
    }

    /// Ids of the arms that are run, in the order of the file.
    pub fn arms(&self) -> Vec<&str> {
        let run: BTreeSet<&str> = self.cases.iter().map(|case| case.arm.as_str()).collect();
        self.spec.arm.iter().map(|arm| arm.id.as_str()).filter(|id| run.contains(id)).collect()
    }

    /// The words for an arm in figures.
    pub fn label(&self, arm: &str) -> String {
        let spec = self.spec.arm.iter().find(|spec| spec.id == arm);
        spec.and_then(|spec| spec.label.clone()).unwrap_or_else(|| arm.to_string())
    }
}

fn profile_of(spec: &StudySpec, profile: Option<&str>) -> Result<ProfileSpec, SpecError> {
    match profile {
        None => Ok(spec.profile.get(DEFAULT_PROFILE).cloned().unwrap_or_default()),
        Some(name) => spec.profile.get(name).cloned().ok_or_else(|| {
            let known: Vec<_> = spec.profile.keys().map(String::as_str).collect();
            let known = if known.is_empty() { "none".into() } else { known.join(", ") };
            let message = format!("is not in the study; it has: {known}");
            SpecError::value(format!("profile `{name}`"), message)
        }),
    }
}

/// Counts the cases, and the values in their scenes, before any is made.
fn check_count(spec: &StudySpec, profile: &ProfileSpec) -> Result<(), SpecError> {
    let base = values_of(spec.scene.values()) + values_of(profile.set.values());
    // Of each axis one value is set at a time.
    let swept = |arm| {
        axes_of(spec, arm)
            .map(|axis| axis.values.iter().map(value_count).max().unwrap_or(0) + factors(axis))
            .sum::<u64>()
    };
    let (mut most_points, mut blocks, mut cases, mut values) = (0_u64, 0_u64, 0_u64, 0_u64);
    for arm in spec.arm.iter().filter(|arm| runs(profile, arm)) {
        let points = axes_of(spec, arm).fold(1_u64, |n, axis| n.saturating_mul(axis.points() as u64));
        let count = blocks_of(spec, profile, arm).count;
        let own_cases = points.saturating_mul(count);
        let checked = rerun(spec, arm).map_or(0, |arm| values_of(own(profile, arm).map(|(_, v)| v)));
        let own = values_of(own(profile, arm).map(|(_, value)| value));
        most_points = most_points.max(points);
        blocks = blocks.saturating_add(count);
        cases = cases.saturating_add(own_cases);
        values = values.saturating_add(own_cases.saturating_mul(base + swept(arm) + checked + own));
    }
    let message = if cases > MOST_CASES {
        format!(
            "{cases} cases ({most_points} points of the sweep, {blocks} blocks of all arms together); allowed: \
             {MOST_CASES}; make the sweep or the blocks fewer"
        )
    } else if values > MOST_VALUES {
        format!(
            "{cases} cases with {values} values in all their scenes together; allowed: {MOST_VALUES}; make the \
             sweep, the blocks or the scene smaller"
        )
    } else {
        return Ok(());
    };
    Err(SpecError::value("`sweep`, `blocks`", message))
}

fn values_of<'a>(values: impl Iterator<Item = &'a Value>) -> u64 {
    values.map(value_count).sum()
}

/// A value and all that are in it.
fn value_count(value: &Value) -> u64 {
    1 + match value {
        Value::Table(table) => values_of(table.values()),
        Value::Array(items) => values_of(items.iter()),
        _ => 0,
    }
}

fn arm_of<'a>(spec: &'a StudySpec, id: &str) -> Option<&'a ArmSpec> {
    spec.arm.iter().find(|arm| arm.id == id)
}

/// The arm that is run again, where the arm is one under a condition.
fn rerun<'a>(spec: &'a StudySpec, arm: &ArmSpec) -> Option<&'a ArmSpec> {
    arm.under.as_ref().and_then(|under| arm_of(spec, &under.arm))
}

/// A check is the arm it checks but for what it changes: the lengths of steps, or the transfer.
fn differs_by(arm: &ArmSpec, by: Rerun, scene: &SceneSpec, checked: &SceneSpec) -> Result<(), SpecError> {
    let mut same = scene.clone();
    let (numerics, theirs) = (&mut same.numerics, &checked.numerics);
    let allowed = match by {
        Rerun::HalfStep => {
            numerics.fixed_step = theirs.fixed_step;
            numerics.wave_courant = theirs.wave_courant;
            numerics.advective_courant = theirs.advective_courant;
            numerics.greatest_step = theirs.greatest_step;
            "`fixed_step`, `wave_courant`, `advective_courant` and `greatest_step` of `numerics`"
        }
        Rerun::OtherTransfer => {
            numerics.transfer = theirs.transfer;
            "`numerics.transfer`"
        }
    };
    if same == *checked && scene != checked {
        return Ok(());
    }
    let what = if scene == checked { "nothing is changed" } else { "more is changed" };
    let message = format!("{what}; allowed in a check of this kind: {allowed}, one or more");
    Err(SpecError::value(format!("arm `{}`, `check` of its condition", arm.id), message))
}

fn runs(profile: &ProfileSpec, arm: &ArmSpec) -> bool {
    let named = |id: &String| profile.arms.as_ref().is_none_or(|arms| arms.contains(id));
    match &arm.under {
        None => named(&arm.id),
        Some(under) => {
            let all = profile.arms.is_none();
            let chosen = profile.conditions.as_ref().map_or(all, |ids| ids.contains(&under.condition));
            chosen && named(&under.arm)
        }
    }
}

fn blocks_of(spec: &StudySpec, profile: &ProfileSpec, arm: &ArmSpec) -> BlockSpec {
    let count = match (&profile.blocks, arm.blocks) {
        (Some(blocks), Some(own)) => own.min(blocks.count),
        (Some(blocks), None) => blocks.count,
        (None, own) => own.unwrap_or(spec.blocks.count),
    };
    BlockSpec { count, ..profile.blocks.unwrap_or(spec.blocks) }
}

/// The axes that an arm is run along.
fn axes_of<'a>(spec: &'a StudySpec, arm: &'a ArmSpec) -> impl Iterator<Item = &'a SweepSpec> {
    let id = arm.under.as_ref().map_or(&arm.id, |under| &under.arm);
    spec.sweep.iter().filter(move |axis| axis.takes(id))
}

/// The columns that the axes have in the tables.
fn columns(spec: &StudySpec) -> impl Iterator<Item = &str> {
    spec.sweep.iter().flat_map(SweepSpec::columns)
}

/// Values that a sampled axis sets at a time.
fn factors(axis: &SweepSpec) -> u64 {
    axis.sample
        .iter()
        .flat_map(|sample| &sample.factor)
        .map(|factor| 1 + factor.along.iter().flatten().count() as u64)
        .sum()
}

/// One point of one axis.
struct AxisPoint<'a> {
    /// Columns of the tables.
    numbers: Vec<(&'a str, f64)>,
    /// Values by path.
    settings: Vec<(&'a str, Cow<'a, Value>)>,
}

fn points_of<'a>(axis: &'a SweepSpec, arm: &'a ArmSpec) -> Vec<AxisPoint<'a>> {
    if let Some(sample) = &axis.sample {
        let id = arm.under.as_ref().map_or(&arm.id, |under| &under.arm);
        let point = |point| {
            let factors = || sample.factors_of(id).map(move |(k, factor)| (factor, sample.number(point, k)));
            AxisPoint {
                numbers: factors().map(|(factor, number)| (factor.name.as_str(), number)).collect(),
                settings: factors()
                    .map(|(factor, number)| (factor.path.as_str(), Cow::Owned(factor.value(number))))
                    .collect(),
            }
        };
        return (0..sample.points).map(point).collect();
    }
    let point = |(index, value)| AxisPoint {
        numbers: vec![(axis.name.as_str(), axis.number(index))],
        settings: settings_of(axis, value)
            .into_iter()
            .map(|(path, value)| (path, Cow::Borrowed(value)))
            .collect(),
    };
    axis.values.iter().enumerate().map(point).collect()
}

fn settings_of<'a>(axis: &'a SweepSpec, value: &'a Value) -> Vec<(&'a str, &'a Value)> {
    match (&axis.path, value) {
        (Some(path), value) => vec![(path, value)],
        (None, Value::Table(settings)) => {
            settings.iter().map(|(path, value)| (path.as_str(), value)).collect()
        }
        (None, _) => Vec::new(),
    }
}

/// All combinations of the axes' points, the last axis fastest; one empty combination without axes.
fn combinations<'a>(axes: &'a [Vec<AxisPoint<'a>>]) -> Vec<Vec<&'a AxisPoint<'a>>> {
    axes.iter().fold(vec![Vec::new()], |rows, points| {
        rows.iter().flat_map(|row| points.iter().map(|point| [row.as_slice(), &[point]].concat())).collect()
    })
}

/// What is set in an arm and nowhere else.
fn own<'a>(profile: &'a ProfileSpec, arm: &'a ArmSpec) -> impl Iterator<Item = (&'a String, &'a Value)> {
    [&arm.set].into_iter().chain(profile.arm_set.get(&arm.id)).flatten()
}

fn scene_of(
    spec: &StudySpec,
    profile: &ProfileSpec,
    arm: &ArmSpec,
    axes: &[&AxisPoint],
) -> Result<SceneSpec, SpecError> {
    let mut scene = Value::Table(spec.scene.clone());
    let place = format!("arm `{}`", arm.id);
    let checked = rerun(spec, arm);
    let settings = profile
        .set
        .iter()
        .chain(checked.into_iter().flat_map(|arm| own(profile, arm)))
        .chain(own(profile, arm));
    let settings = settings.map(|(path, value)| (path.as_str(), value));
    let swept = axes.iter().flat_map(|axis| &axis.settings).map(|(path, value)| (*path, value.as_ref()));
    for (path, value) in settings.chain(swept) {
        override_path::set(&mut scene, path, value.clone())
            .map_err(|message| SpecError::value(format!("{place}, path `{path}`"), message))?;
    }
    spec::scene_of(&scene).map_err(|error| error.within(place))
}
