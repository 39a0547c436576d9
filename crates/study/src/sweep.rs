//! From a study to its cases: pure values, listed before anything runs.

use std::collections::BTreeSet;

use toml::Value;

use crate::spec::override_path;
use crate::spec::study::{
    ArmSpec, BlockSpec, DEFAULT_PROFILE, MeasureSpec, ProfileSpec, StudySpec, SweepSpec,
};
use crate::spec::{self, SceneSpec, Spec, SpecError};

/// One run of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// The arm's id.
    pub arm: String,
    /// The block: seed of all random streams.
    pub block: u64,
    /// Axis name and number of each axis of the sweep.
    pub axes: Vec<(String, f64)>,
    /// The scene in full.
    pub scene: SceneSpec,
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
const MOST_CASES: u64 = 1_000_000;

impl Study {
    /// Expands `spec` under the profile of the given name.
    ///
    /// # Errors
    /// [`SpecError::Value`], naming arm and key.
    pub fn expand(spec: StudySpec, profile: Option<&str>) -> Result<Self, SpecError> {
        spec.validate()?;
        let name = profile.unwrap_or(DEFAULT_PROFILE);
        let chosen = profile_of(&spec, profile)?;
        check_count(&spec, &chosen)?;
        let mut cases = Vec::new();
        for arm in spec.arm.iter().filter(|arm| runs(&chosen, arm)) {
            for axes in combinations(&spec.sweep) {
                let scene = scene_of(&spec, &chosen, arm, &axes)?;
                let blocks = blocks_of(&spec, &chosen, arm);
                for block in blocks.first..blocks.first + blocks.count {
                    cases.push(Case {
                        arm: arm.id.clone(),
                        block,
                        axes: axes.iter().map(|axis| (axis.name.clone(), axis.number)).collect(),
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
            let message = format!("is not in the study; it has: {}", known.join(", "));
            SpecError::value(format!("profile `{name}`"), message)
        }),
    }
}

/// Counts the cases before any is made.
fn check_count(spec: &StudySpec, profile: &ProfileSpec) -> Result<(), SpecError> {
    let points = spec.sweep.iter().fold(1_u64, |n, axis| n.saturating_mul(axis.values.len() as u64));
    let blocks = spec
        .arm
        .iter()
        .filter(|arm| runs(profile, arm))
        .fold(0_u64, |sum, arm| sum.saturating_add(blocks_of(spec, profile, arm).count));
    let cases = points.saturating_mul(blocks);
    if cases <= MOST_CASES {
        return Ok(());
    }
    let message = format!(
        "{cases} cases ({points} points of the sweep, {blocks} blocks of all arms together); allowed: \
         {MOST_CASES}; make the sweep or the blocks fewer"
    );
    Err(SpecError::value("`sweep`, `blocks`", message))
}

fn runs(profile: &ProfileSpec, arm: &ArmSpec) -> bool {
    profile.arms.as_ref().is_none_or(|arms| arms.contains(&arm.id))
}

fn blocks_of(spec: &StudySpec, profile: &ProfileSpec, arm: &ArmSpec) -> BlockSpec {
    profile.blocks.unwrap_or(BlockSpec { count: arm.blocks.unwrap_or(spec.blocks.count), ..spec.blocks })
}

/// One point of one axis.
#[derive(Clone)]
struct AxisPoint {
    name: String,
    path: String,
    value: Value,
    number: f64,
}

/// All combinations of the axes' points, the last axis fastest; one empty combination without axes.
fn combinations(sweep: &[SweepSpec]) -> Vec<Vec<AxisPoint>> {
    sweep.iter().fold(vec![Vec::new()], |rows, axis| {
        let points: Vec<AxisPoint> = axis
            .values
            .iter()
            .enumerate()
            .map(|(index, value)| AxisPoint {
                name: axis.name.clone(),
                path: axis.path.clone(),
                value: value.clone(),
                number: axis
                    .numbers
                    .as_ref()
                    .and_then(|n| n.get(index).copied())
                    .unwrap_or_else(|| number(value)),
            })
            .collect();
        rows.iter()
            .flat_map(|row| {
                points.iter().map(move |point| [row.as_slice(), std::slice::from_ref(point)].concat())
            })
            .collect()
    })
}

fn number(value: &Value) -> f64 {
    value.as_float().or_else(|| value.as_integer().map(|i| i as f64)).unwrap_or(f64::NAN)
}

fn scene_of(
    spec: &StudySpec,
    profile: &ProfileSpec,
    arm: &ArmSpec,
    axes: &[AxisPoint],
) -> Result<SceneSpec, SpecError> {
    let mut scene = Value::Table(spec.scene.clone());
    let place = format!("arm `{}`", arm.id);
    let own = profile.arm_set.get(&arm.id).into_iter().flatten();
    let settings = profile.set.iter().chain(&arm.set).chain(own);
    for (path, value) in settings.chain(axes.iter().map(|axis| (&axis.path, &axis.value))) {
        override_path::set(&mut scene, path, value.clone())
            .map_err(|message| SpecError::value(format!("{place}, path `{path}`"), message))?;
    }
    spec::scene_of(&scene).map_err(|error| error.within(place))
}
