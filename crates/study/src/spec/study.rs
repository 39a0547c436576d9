//! A study file: a scene, what varies in it, how it is measured, and what is claimed of it.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::sample::SampleSpec;
use crate::claims::{Claim, DensityNoise};

/// The profile of a study run without one.
pub const DEFAULT_PROFILE: &str = "default";

/// A study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct StudySpec {
    /// Name; results go to `<out>/<name>`.
    pub name: String,
    /// The question it answers, in a sentence or two.
    pub question: String,
    /// What a reader of the report must know before the verdicts.
    #[serde(default)]
    pub caveats: Vec<String>,
    /// The scene that arms and sweeps vary.
    pub scene: toml::Table,
    /// Blocks: seeds shared by the arms of a comparison.
    pub blocks: BlockSpec,
    /// The arms.
    pub arm: Vec<ArmSpec>,
    /// Axes that every arm is run along: all combinations.
    #[serde(default)]
    pub sweep: Vec<SweepSpec>,
    /// Conditions under which arms are run again.
    #[serde(default)]
    pub condition: Vec<ConditionSpec>,
    /// How fragments are measured.
    pub measure: MeasureSpec,
    /// The speed that a pilot chose, and where that is recorded.
    #[serde(default)]
    pub pilot: Option<PilotSpec>,
    /// Arms that nothing can break (an elastic ball, a ball at rest): the claims need them to read as one piece.
    #[serde(default)]
    pub noise_floor: Vec<String>,
    /// Pairs of arms that differ by a feature.
    #[serde(default)]
    pub feature: Vec<FeatureSpec>,
    /// Settings that are learnt from what arms trade.
    #[serde(default)]
    pub tradeoff: Option<TradeoffSpec>,
    /// Arms that are to break alike.
    #[serde(default)]
    pub equivalence: Option<EquivalenceSpec>,
    /// Claims judged from the arms: one family.
    #[serde(default)]
    pub claim: Vec<Claim>,
    /// Controls judged from the arms: a second family.
    #[serde(default)]
    pub control: Vec<Claim>,
    /// Paths of the control `density-noise`.
    #[serde(default)]
    pub density_noise: Vec<DensityNoise>,
    /// Maps of how cases end over two axes of the sweep.
    #[serde(default)]
    pub map: Vec<MapSpec>,
    /// Ranges that the results must lie in.
    #[serde(default)]
    pub expect: Vec<ExpectSpec>,
    /// Named variations of the whole study.
    #[serde(default)]
    pub profile: BTreeMap<String, ProfileSpec>,
}

/// Which seeds a study uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BlockSpec {
    /// Seed of the first block. Studies that must not share seeds start apart.
    pub first: u64,
    /// Number of blocks of every arm that does not say otherwise.
    pub count: u64,
}

/// One arm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ArmSpec {
    /// Short name.
    pub id: String,
    /// Words for figures; the id when left out.
    #[serde(default)]
    pub label: Option<String>,
    /// Values set in the scene, by dotted path.
    #[serde(default)]
    pub set: BTreeMap<String, toml::Value>,
    /// Number of blocks, where it differs from the study's.
    #[serde(default)]
    pub blocks: Option<u64>,
    /// What its accuracy and cost are compared with.
    #[serde(default)]
    pub trade: Option<TradeSpec>,
    /// Name of the figure in which the arm's first block is pictured before and after; none when left out.
    #[serde(default)]
    pub picture: Option<String>,
    /// What it runs again, and under which condition; no arm of a file has it, those made of conditions do.
    #[serde(skip)]
    pub under: Option<Under>,
}

/// What an arm runs again under a condition.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Under {
    /// The arm that is run again: its `set` holds here too, before the condition's.
    pub arm: String,
    /// Id of the condition.
    pub condition: String,
    /// What it checks of the numerics, if it does.
    pub check: Option<Rerun>,
}

/// A condition under which arms are run again: a check of the numerics, or other circumstances that a claim may or may not hold in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ConditionSpec {
    /// Short name: the arm `a` under it is `a@id`.
    pub id: String,
    /// Words for figures and tables; the id when left out.
    #[serde(default)]
    pub label: Option<String>,
    /// What it checks of the numerics, where it changes the step or the transfer and nothing else.
    #[serde(default)]
    pub check: Option<Rerun>,
    /// Arms that are run under it.
    pub arms: Vec<String>,
    /// Values set in the scene after the arm's own, by dotted path.
    #[serde(default)]
    pub set: BTreeMap<String, toml::Value>,
    /// Values set in single arms after those.
    #[serde(default)]
    pub arm_set: BTreeMap<String, BTreeMap<String, toml::Value>>,
    /// Number of blocks, where it differs from the study's.
    #[serde(default)]
    pub blocks: Option<u64>,
}

impl ConditionSpec {
    /// The words for it.
    pub fn label(&self) -> &str {
        self.label.as_deref().unwrap_or(&self.id)
    }

    /// `arm` run again under it.
    fn arm(&self, arm: &ArmSpec) -> ArmSpec {
        let own = self.arm_set.get(&arm.id).into_iter().flatten();
        ArmSpec {
            id: format!("{}@{}", arm.id, self.id),
            label: Some(format!("{}, {}", arm.label.as_ref().unwrap_or(&arm.id), self.label())),
            set: self.set.iter().chain(own).map(|(path, value)| (path.clone(), value.clone())).collect(),
            blocks: self.blocks.or(arm.blocks),
            trade: None,
            picture: None,
            under: Some(Under { arm: arm.id.clone(), condition: self.id.clone(), check: self.check }),
        }
    }
}

impl StudySpec {
    /// The study with an arm for every arm under every condition, behind those of the file.
    pub fn with_conditions(mut self) -> Self {
        let of = |condition: &ConditionSpec| -> Vec<ArmSpec> {
            let arms = condition.arms.iter().filter_map(|id| self.arm.iter().find(|arm| arm.id == *id));
            arms.map(|arm| condition.arm(arm)).collect()
        };
        let more: Vec<ArmSpec> = self.condition.iter().flat_map(of).collect();
        self.arm.extend(more);
        self
    }

    /// What the arm runs again, if it is an arm under a condition.
    pub fn under(&self, id: &str) -> Option<&Under> {
        self.arm.iter().find(|arm| arm.id == id).and_then(|arm| arm.under.as_ref())
    }
}

/// What an arm trades: its error beside another arm with the same particles, for the time it takes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TradeSpec {
    /// The arm whose results are the truth.
    pub reference: String,
    /// Name of the line in the figure that joins it with its like.
    pub family: String,
    /// The arm is the reference but for a grid so many times as coarse: it says how far the reference is from the truth, and is no setting.
    #[serde(default)]
    pub coarser: Option<f64>,
}

/// What settings are learnt from, and what they are held against.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TradeoffSpec {
    /// The axis whose points are scenes.
    pub axis: String,
    /// Numbers of the scenes that nothing is learnt from.
    #[serde(default)]
    pub held_out: Vec<f64>,
    /// The study that tells what settings do to fragments, by arms of the same ids.
    #[serde(default)]
    pub fragments: Option<String>,
}

/// Arms whose fragments are held against those of another.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EquivalenceSpec {
    /// The arm whose fragments are the truth.
    pub reference: String,
}

/// Changes that an answer must withstand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rerun {
    /// Half the time step.
    HalfStep,
    /// The other transfer.
    OtherTransfer,
}

/// One axis of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepSpec {
    /// Name of the axis: a column of the tables.
    pub name: String,
    /// Dotted path into the scene; left out, each value is a table of settings by path.
    #[serde(default)]
    pub path: Option<String>,
    /// Values; none where they are sampled.
    #[serde(default)]
    pub values: Vec<toml::Value>,
    /// Points spread over several factors, in place of values: each factor is a column of the tables.
    #[serde(default)]
    pub sample: Option<SampleSpec>,
    /// Words for the values in figures; their numbers when left out.
    #[serde(default)]
    pub labels: Option<Vec<String>>,
    /// Numbers that stand for the values in tables; the values themselves when left out.
    #[serde(default)]
    pub numbers: Option<Vec<f64>>,
    /// Words for the axis in figures, with the unit; its name when left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis_label: Option<String>,
    /// Arms that are run along it; all when left out. The others are run once, without what it sets.
    #[serde(default)]
    pub arms: Vec<String>,
}

impl SweepSpec {
    /// Words for it in figures.
    pub fn axis_label(&self) -> &str {
        self.axis_label.as_deref().unwrap_or(&self.name)
    }

    /// Number of its points.
    pub fn points(&self) -> usize {
        self.sample.as_ref().map_or(self.values.len(), |sample| sample.points as usize)
    }

    /// Its columns in the tables: its own name, or those of its factors.
    pub fn columns(&self) -> Vec<&str> {
        match &self.sample {
            None => vec![&self.name],
            Some(sample) => sample.factor.iter().map(|factor| factor.name.as_str()).collect(),
        }
    }

    /// The numbers that stand for its values in tables.
    pub fn all_numbers(&self) -> Vec<f64> {
        (0..self.values.len()).map(|index| self.number(index)).collect()
    }

    /// The number that stands for the value of this index, NaN for one that has none.
    pub fn number(&self, index: usize) -> f64 {
        let written = self.numbers.as_ref().and_then(|numbers| numbers.get(index).copied());
        let own =
            || self.values[index].as_float().or(self.values[index].as_integer().map(|whole| whole as f64));
        written.or_else(own).unwrap_or(f64::NAN)
    }

    /// Whether the arm `id` is run along it.
    pub fn takes(&self, id: &str) -> bool {
        self.arms.is_empty() || self.arms.iter().any(|arm| arm == id)
    }
}

/// Two arms that are the same but for one feature of the solver, which `snowlab features` holds against each other.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FeatureSpec {
    /// Words for the feature.
    pub name: String,
    /// The arm that has it.
    pub on: String,
    /// The arm that does without.
    pub off: String,
}

/// A map of how cases end over two axes of the sweep: a figure and rows of `maps.csv`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MapSpec {
    /// Short name: that of the figure.
    pub id: String,
    /// Title.
    pub title: String,
    /// Name of the axis that is laid out horizontally.
    pub x: String,
    /// Name of the axis that is laid out vertically.
    pub y: String,
    /// Words for the horizontal axis; its name when left out.
    #[serde(default)]
    pub x_label: Option<String>,
    /// Words for the vertical axis; its name when left out.
    #[serde(default)]
    pub y_label: Option<String>,
    /// Arms, a panel each; all that are run along both axes when left out.
    #[serde(default)]
    pub arms: Vec<String>,
    /// What a case must be beside having ended well; nothing when left out.
    #[serde(default)]
    pub sound: Option<SoundSpec>,
}

/// What tells a sound case from one that ended well all the same.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SoundSpec {
    /// A numeric column of `cases.csv`.
    pub metric: String,
    /// Its least and greatest value in a sound case.
    pub range: [f64; 2],
    /// Words for a case outside the range.
    pub otherwise: String,
}

/// How fragments are measured. Lengths are in metres and the same in every arm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MeasureSpec {
    /// h_max: the largest spacing among the arms compared [m].
    pub largest_spacing: f64,
    /// Link of friends-of-friends over h_max.
    #[serde(default = "link_ratio")]
    pub link_ratio: f64,
    /// m_cut over the mass of the solid body.
    #[serde(default = "min_mass_share")]
    pub min_mass_share: f64,
    /// Bodies that the gate expects at t = 0.
    #[serde(default = "bodies")]
    pub bodies: usize,
    /// `settled` looks back over this many time units of the output.
    #[serde(default = "settle_window")]
    pub settle_window: f64,
}

/// What a pilot decided.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PilotSpec {
    /// Whether a speed was found with a median damage in [0.05, 0.6].
    pub operating_point_found: bool,
    /// Where to read of it.
    pub source: String,
}

/// A range that a metric must lie in.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ExpectSpec {
    /// A numeric column of `cases.csv`.
    pub metric: String,
    /// Arms it is asked of; all when left out.
    #[serde(default)]
    pub arms: Vec<String>,
    /// What must lie in the range.
    #[serde(default)]
    pub statistic: ExpectStatistic,
    /// Least and greatest value allowed.
    pub range: [f64; 2],
    /// Profiles it holds for; all when left out.
    #[serde(default)]
    pub profiles: Vec<String>,
    /// Why this range.
    pub why: String,
}

/// What of an arm's values must lie in a range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ExpectStatistic {
    /// Every case's.
    #[default]
    Each,
    /// The mean.
    Mean,
    /// The median.
    Median,
}

/// A variation of the whole study.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ProfileSpec {
    /// Values set in the scene of every arm, before the arm's own.
    #[serde(default)]
    pub set: BTreeMap<String, toml::Value>,
    /// Values set in single arms, after the arm's own.
    #[serde(default)]
    pub arm_set: BTreeMap<String, BTreeMap<String, toml::Value>>,
    /// Arms that are run; all when left out.
    #[serde(default)]
    pub arms: Option<Vec<String>>,
    /// Conditions under which arms are run again; when left out all, or none where `arms` are named.
    #[serde(default)]
    pub conditions: Option<Vec<String>>,
    /// Blocks of every arm; one that has fewer of its own keeps their number.
    #[serde(default)]
    pub blocks: Option<BlockSpec>,
    /// Measurement, where the scene's change asks for another.
    #[serde(default)]
    pub measure: Option<MeasureSpec>,
}

fn link_ratio() -> f64 {
    2.0
}
fn min_mass_share() -> f64 {
    crate::metrics::gate::DUST_CUT
}
fn bodies() -> usize {
    1
}
fn settle_window() -> f64 {
    2.0
}
