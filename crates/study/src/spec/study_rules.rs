//! What a study may say: names, numbers, and what its parts say of one another.

use std::collections::BTreeSet;

use super::range::{NOT_NEGATIVE, POSITIVE, Range, Shown, at_least, within};
use super::sample::{SampleSpec, Scale};
use super::study::{
    ArmSpec, BlockSpec, DEFAULT_PROFILE, ExpectSpec, FeatureSpec, MeasureSpec, ProfileSpec, SweepSpec,
    TradeoffSpec,
};
use super::{Spec, SpecError, StudySpec, brief};
use crate::claims::Claim;
use crate::store::FOLDERS;
use crate::tables::{CASE_NUMBERS, OWN_COLUMNS};

/// Every number of a study with a range, by its key; a profile's `blocks` and `measure` have the same.
pub const RULES: &[(&str, Range)] = &[
    // chosen: with a block for every case still exact in f64, and far from the streams of the second body on (assemble/body.rs).
    ("blocks.first", within(0.0, 1e14)),
    ("blocks.count", at_least(1.0)),
    ("arm.*.blocks", at_least(1.0)),
    ("measure.largest_spacing", within(0.0, 1e6).open_below()),
    ("measure.link_ratio", POSITIVE),
    ("measure.min_mass_share", within(0.0, 1.0)),
    ("measure.bodies", at_least(1.0)),
    ("measure.settle_window", NOT_NEGATIVE),
    ("claim.*.largest_spacing", within(0.0, 1e6).open_below()),
    ("arm.*.trade.coarser", within(1.0, 1e3).open_below()),
];

/// Arms of a study (chosen: far more than a report can show).
pub const MOST_ARMS: usize = 1000;
/// Axes of a sweep (chosen: with two values on each, more cases than a study may have).
pub const MOST_AXES: usize = 20;
/// Points of a sampled axis: as many as the sequence has.
const MOST_POINTS: u32 = 65_536;
/// Characters of a name (chosen: file systems take 255 with all that is added).
const MOST_IN_NAME: usize = 64;
/// What files of results end in; a profile's folder stands beside them.
const ENDINGS: [&str; 2] = [".csv", ".html"];

/// Ids of all arms.
pub(super) struct Ids<'a>(BTreeSet<&'a str>);

impl<'a> Ids<'a> {
    fn of(arms: &'a [ArmSpec]) -> Self {
        Ids(arms.iter().map(|arm| arm.id.as_str()).collect())
    }

    pub(super) fn check(&self, place: impl Into<String>, id: &str) -> Result<(), SpecError> {
        if self.0.contains(id) {
            return Ok(());
        }
        let known: Vec<&str> = self.0.iter().copied().collect();
        refuse(place, format!("names the arm \"{id}\"; the study has: {}", known.join(", ")))
    }
}

impl Spec for StudySpec {
    fn validate(&self) -> Result<(), SpecError> {
        check_name("`name`", &self.name)?;
        let ids = &Ids::of(&self.arm);
        self.check_arms(ids)?;
        check_blocks("blocks", &self.blocks)?;
        check_measure("measure", &self.measure)?;
        if self.scene.contains_key("seed") {
            return refuse("`scene.seed`", "is the number of the block in a study; set `blocks.first`");
        }
        self.check_conditions(ids)?;
        self.check_sweep(ids)?;
        self.check_maps(ids)?;
        self.feature.iter().enumerate().try_for_each(|(n, feature)| self.check_feature(ids, n, feature))?;
        self.noise_floor.iter().try_for_each(|id| ids.check("`noise_floor`", id))?;
        self.tradeoff.iter().try_for_each(|tradeoff| self.check_tradeoff(tradeoff))?;
        self.equivalence.iter().try_for_each(|e| ids.check("`equivalence.reference`", &e.reference))?;
        for (family, claims) in [("claim", &self.claim), ("control", &self.control)] {
            claims.iter().enumerate().try_for_each(|(n, claim)| self.check_claim(ids, family, n, claim))?;
        }
        for (number, arms) in self.density_noise.iter().enumerate() {
            arms.names().into_iter().try_for_each(|id| ids.check(format!("`density_noise.{number}`"), id))?;
        }
        self.expect.iter().enumerate().try_for_each(|(n, expect)| self.check_expect(ids, n, expect))?;
        self.profile.iter().try_for_each(|(name, profile)| self.check_profile(ids, name, profile))
    }
}

impl StudySpec {
    fn check_arms(&self, ids: &Ids) -> Result<(), SpecError> {
        if self.arm.is_empty() {
            return refuse("`arm`", "is empty; a study has one [[arm]] or more");
        }
        if self.arm.len() > MOST_ARMS {
            let message = format!("has {} entries; allowed: 1 to {MOST_ARMS} [[arm]]", self.arm.len());
            return refuse("`arm`", format!("{message}; make two studies of it"));
        }
        let mut seen = BTreeSet::new();
        for (number, arm) in self.arm.iter().enumerate() {
            let place = format!("`arm.{number}.id`");
            check_name(&place, &arm.id)?;
            if !seen.insert(&arm.id) {
                let message = format!("is \"{}\", which stands twice; give each arm its own id", arm.id);
                return refuse(place, message);
            }
            if let Some(count) = arm.blocks {
                check_number(&format!("arm.{number}.blocks"), "arm.*.blocks", count as f64)?;
            }
            self.check_seed_is_not_set(&format!("arm.{number}.set"), arm.set.keys())?;
            if let Some(trade) = &arm.trade {
                let place = format!("`arm.{number}.trade.reference`");
                ids.check(&place, &trade.reference)?;
                if trade.reference == arm.id {
                    let message = format!(
                        "is \"{}\", the arm itself; name the one whose results are the truth",
                        arm.id
                    );
                    return refuse(place, message);
                }
                if let Some(ratio) = trade.coarser {
                    check_number(&format!("arm.{number}.trade.coarser"), "arm.*.trade.coarser", ratio)?;
                }
            }
            // It becomes the name of a file.
            arm.picture.iter().try_for_each(|name| check_name(&format!("`arm.{number}.picture`"), name))?;
        }
        Ok(())
    }

    fn check_seed_is_not_set<'a>(
        &self,
        place: &str,
        mut paths: impl Iterator<Item = &'a String>,
    ) -> Result<(), SpecError> {
        if paths.any(|path| path == "seed") {
            return refuse(
                format!("`{place}`"),
                "sets `seed`, which is the number of the block; set `blocks.first`",
            );
        }
        Ok(())
    }

    fn check_conditions(&self, ids: &Ids) -> Result<(), SpecError> {
        let arms: usize = self.condition.iter().map(|condition| condition.arms.len()).sum();
        if arms.max(self.condition.len()) + self.arm.len() > MOST_ARMS {
            let message = format!(
                "makes {arms} arms beside {} [[arm]]; allowed: {MOST_ARMS} together; make two studies of it",
                self.arm.len()
            );
            return refuse("`condition`", message);
        }
        let mut seen = BTreeSet::new();
        for (number, condition) in self.condition.iter().enumerate() {
            let place = |key: &str| format!("`condition.{number}.{key}`");
            check_name(&place("id"), &condition.id)?;
            if !seen.insert(&condition.id) {
                let message =
                    format!("is \"{}\", which stands twice; give each condition its own id", condition.id);
                return refuse(place("id"), message);
            }
            if condition.arms.is_empty() {
                return refuse(place("arms"), "is empty; name the arms that are run under it");
            }
            let mut named = BTreeSet::new();
            for id in &condition.arms {
                ids.check(place("arms"), id)?;
                if !named.insert(id) {
                    return refuse(place("arms"), format!("names the arm \"{id}\" twice; name each once"));
                }
            }
            if let Some(count) = condition.blocks {
                check_number(&format!("condition.{number}.blocks"), "arm.*.blocks", count as f64)?;
            }
            self.check_seed_is_not_set(&format!("condition.{number}.set"), condition.set.keys())?;
            for (id, set) in &condition.arm_set {
                if !named.contains(id) {
                    let known: Vec<&str> = condition.arms.iter().map(String::as_str).collect();
                    let message = format!("names the arm \"{id}\"; the condition has: {}", known.join(", "));
                    return refuse(place("arm_set"), message);
                }
                self.check_seed_is_not_set(&format!("condition.{number}.arm_set.{id}"), set.keys())?;
            }
            let twin = self.condition[..number].iter().find(|before| {
                before.check.is_some()
                    && before.check == condition.check
                    && before.arms.iter().any(|id| named.contains(id))
            });
            if let Some(twin) = twin {
                let message = format!(
                    "is what \"{}\" checks of one of its arms already; remove one, or name other arms",
                    twin.id
                );
                return refuse(place("check"), message);
            }
        }
        Ok(())
    }

    fn check_sweep(&self, ids: &Ids) -> Result<(), SpecError> {
        if self.sweep.len() > MOST_AXES {
            let message = format!("has {} axes; allowed: {MOST_AXES}", self.sweep.len());
            return refuse("`sweep`", format!("{message}; set several paths by one axis, or leave some out"));
        }
        let mut names: BTreeSet<&str> = OWN_COLUMNS.into();
        let mut paths = BTreeSet::new();
        for (number, axis) in self.sweep.iter().enumerate() {
            let place = |key: &str| format!("`sweep.{number}.{key}`");
            check_name(&place("name"), &axis.name)?;
            if let Some(sample) = &axis.sample {
                axis.arms.iter().try_for_each(|id| ids.check(place("arms"), id))?;
                self.check_sample(ids, number, axis, sample, &mut names)?;
                continue;
            }
            if !names.insert(&axis.name) {
                let message = format!(
                    "is \"{}\", which a column of the tables has already; give it another name",
                    axis.name
                );
                return refuse(place("name"), message);
            }
            if let Some(path) = &axis.path
                && !paths.insert(path)
            {
                let message = format!("is \"{path}\", which another axis sets; join their values");
                return refuse(place("path"), message);
            }
            self.check_seed_is_not_set(&format!("sweep.{number}.path"), axis.path.iter())?;
            check_values(axis, place)?;
            axis.arms.iter().try_for_each(|id| ids.check(place("arms"), id))?;
            if axis.path.is_none() {
                for (value, settings) in axis.values.iter().enumerate() {
                    let Some(settings) = settings.as_table() else {
                        let message = "must be a table of settings by path, since the axis has no `path`";
                        return refuse(format!("`sweep.{number}.values.{value}`"), message);
                    };
                    self.check_seed_is_not_set(&format!("sweep.{number}.values.{value}"), settings.keys())?;
                }
            }
            if axis.labels.as_ref().is_some_and(|labels| labels.len() != axis.values.len()) {
                let labels = axis.labels.iter().flatten().count();
                let message =
                    format!("has {labels} entries for {} values; give one for each", axis.values.len());
                return refuse(place("labels"), message);
            }
        }
        Ok(())
    }

    fn check_sample<'a>(
        &self,
        ids: &Ids,
        number: usize,
        axis: &SweepSpec,
        sample: &'a SampleSpec,
        names: &mut BTreeSet<&'a str>,
    ) -> Result<(), SpecError> {
        let place = |key: &str| format!("`sweep.{number}.sample.{key}`");
        let given = [
            ("path", axis.path.is_some()),
            ("values", !axis.values.is_empty()),
            ("labels", axis.labels.is_some()),
            ("numbers", axis.numbers.is_some()),
        ];
        if let Some((key, _)) = given.into_iter().find(|(_, given)| *given) {
            let message = "means nothing beside `sample`, whose points are its values; remove one of them";
            return refuse(format!("`sweep.{number}.{key}`"), message);
        }
        if !(1..=MOST_POINTS).contains(&sample.points) {
            let message = format!("is {}; allowed: 1 to {MOST_POINTS}", sample.points);
            return refuse(place("points"), message);
        }
        if !(1..=MOST_AXES).contains(&sample.factor.len()) {
            let message = format!("has {} entries; allowed: 1 to {MOST_AXES}", sample.factor.len());
            return refuse(place("factor"), message);
        }
        for (index, factor) in sample.factor.iter().enumerate() {
            let place = |key: &str| place(&format!("factor.{index}.{key}"));
            check_name(&place("name"), &factor.name)?;
            if !names.insert(&factor.name) {
                let message = format!(
                    "is \"{}\", which a column of the tables has already; give it another name",
                    factor.name
                );
                return refuse(place("name"), message);
            }
            self.check_seed_is_not_set(
                &format!("sweep.{number}.sample.factor.{index}.path"),
                [&factor.path].into_iter(),
            )?;
            let [least, greatest] = factor.range;
            let positive = factor.scale == Scale::Linear || least > 0.0;
            if !(least < greatest && least.is_finite() && greatest.is_finite() && positive) {
                let message = format!(
                    "is [{least:?}, {greatest:?}]; allowed: [least, greatest], least first, and above 0 where the scale is `logarithmic`"
                );
                return refuse(place("range"), message);
            }
            factor.arms.iter().try_for_each(|id| ids.check(place("arms"), id))?;
        }
        Ok(())
    }

    fn check_claim(&self, ids: &Ids, family: &str, number: usize, claim: &Claim) -> Result<(), SpecError> {
        let place = format!("`{family}.{number}.contrast`");
        if let Some(spacing) = claim.largest_spacing {
            let key = "claim.*.largest_spacing";
            check_number(&format!("{family}.{number}.largest_spacing"), key, spacing)?;
        }
        claim.validate().or_else(|error| refuse(&place, error.to_string()))?;
        claim.arms().into_iter().try_for_each(|id| ids.check(&place, id))?;
        if self.sweep.iter().any(|axis| axis.points() > 1) {
            let message = "compares arms, which a sweep runs more than once in a block; leave out [[sweep]]";
            return refuse(place, message);
        }
        Ok(())
    }

    fn check_tradeoff(&self, tradeoff: &TradeoffSpec) -> Result<(), SpecError> {
        let Some(axis) = self.sweep.iter().find(|axis| axis.name == tradeoff.axis) else {
            let known: Vec<&str> = self.sweep.iter().map(|axis| axis.name.as_str()).collect();
            let message =
                format!("is \"{}\"; allowed: an axis of the sweep ({})", tradeoff.axis, known.join(", "));
            return refuse("`tradeoff.axis`", message);
        };
        let numbers = axis.all_numbers();
        match tradeoff.held_out.iter().find(|number| !numbers.contains(number)) {
            None => Ok(()),
            Some(number) => {
                let message =
                    format!("has {number}; allowed: numbers of the axis `{}` ({numbers:?})", axis.name);
                refuse("`tradeoff.held_out`", message)
            }
        }
    }

    fn check_expect(&self, ids: &Ids, number: usize, expect: &ExpectSpec) -> Result<(), SpecError> {
        let place = |key: &str| format!("`expect.{number}.{key}`");
        check_ends(place("range"), expect.range)?;
        self.check_metric(place("metric"), &expect.metric)?;
        expect.arms.iter().try_for_each(|id| ids.check(place("arms"), id))?;
        for name in &expect.profiles {
            if name != DEFAULT_PROFILE && !self.profile.contains_key(name) {
                let known: Vec<&str> =
                    [DEFAULT_PROFILE].into_iter().chain(self.profile.keys().map(String::as_str)).collect();
                let message = format!("names the profile \"{name}\"; the study has: {}", known.join(", "));
                return refuse(place("profiles"), message);
            }
        }
        Ok(())
    }

    fn check_feature(&self, ids: &Ids, number: usize, feature: &FeatureSpec) -> Result<(), SpecError> {
        ids.check(format!("`feature.{number}.on`"), &feature.on)?;
        ids.check(format!("`feature.{number}.off`"), &feature.off)?;
        if feature.on == feature.off {
            let message =
                format!("is {:?}, the arm that has the feature; name one that does without", feature.off);
            return refuse(format!("`feature.{number}.off`"), message);
        }
        Ok(())
    }

    pub(super) fn check_metric(&self, place: String, metric: &str) -> Result<(), SpecError> {
        let axes = self.sweep.iter().flat_map(SweepSpec::columns);
        let known: Vec<&str> = CASE_NUMBERS.into_iter().chain(axes).collect();
        if known.contains(&metric) {
            return Ok(());
        }
        let alike = |name: &str| name.chars().zip(metric.chars()).take_while(|(a, b)| a == b).count();
        let most = known.iter().map(|name| alike(name)).max().unwrap_or(0);
        // Those that begin most like it: perhaps one of them is meant.
        let nearest: Vec<&str> = known.into_iter().filter(|name| most > 0 && alike(name) == most).collect();
        let hint =
            if nearest.is_empty() { String::new() } else { format!(", such as {}", nearest.join(", ")) };
        refuse(place, format!("is \"{metric}\"; allowed: a numeric column of `cases.csv`{hint}"))
    }

    fn check_profile(&self, ids: &Ids, name: &str, profile: &ProfileSpec) -> Result<(), SpecError> {
        let key = format!("profile.{name}");
        let place = |inner: &str| format!("`{key}.{inner}`");
        // It becomes the name of a folder beside those of the study.
        check_name(&format!("`{key}`"), name)?;
        if FOLDERS.contains(&name) {
            let message = format!("has the name of a folder of results ({})", FOLDERS.join(", "));
            return refuse(format!("`{key}`"), format!("{message}; give it another"));
        }
        if ENDINGS.iter().any(|ending| name.ends_with(ending)) {
            let message = format!("ends as a file of results does ({})", ENDINGS.join(", "));
            return refuse(format!("`{key}`"), format!("{message}; give it another name"));
        }
        if profile.arms.as_ref().is_some_and(Vec::is_empty) {
            return refuse(place("arms"), "is empty; name the arms to run, or leave it out to run all");
        }
        let mut seen = BTreeSet::new();
        for id in profile.arms.iter().flatten() {
            ids.check(place("arms"), id)?;
            if !seen.insert(id) {
                return refuse(place("arms"), format!("names the arm \"{id}\" twice; name each once"));
            }
        }
        for id in profile.conditions.iter().flatten() {
            if !self.condition.iter().any(|condition| condition.id == *id) {
                let known: Vec<&str> = self.condition.iter().map(|condition| condition.id.as_str()).collect();
                let known = if known.is_empty() { "none".into() } else { known.join(", ") };
                let message = format!("names the condition \"{id}\"; the study has: {known}");
                return refuse(place("conditions"), message);
            }
        }
        self.check_seed_is_not_set(&format!("{key}.set"), profile.set.keys())?;
        for (id, set) in &profile.arm_set {
            ids.check(place("arm_set"), id)?;
            self.check_seed_is_not_set(&format!("{key}.arm_set.{id}"), set.keys())?;
        }
        profile.blocks.iter().try_for_each(|blocks| check_blocks(&format!("{key}.blocks"), blocks))?;
        profile.measure.iter().try_for_each(|measure| check_measure(&format!("{key}.measure"), measure))
    }
}

pub(super) fn check_ends(place: String, [least, greatest]: [f64; 2]) -> Result<(), SpecError> {
    if least <= greatest {
        return Ok(());
    }
    refuse(place, format!("is [{least:?}, {greatest:?}]; allowed: [least, greatest], least first"))
}

fn check_values(axis: &SweepSpec, place: impl Fn(&str) -> String) -> Result<(), SpecError> {
    if axis.values.is_empty() {
        return refuse(place("values"), "is empty; give the axis one value or more");
    }
    match &axis.numbers {
        Some(numbers) if numbers.len() != axis.values.len() => {
            let message =
                format!("has {} entries for {} values; give one for each", numbers.len(), axis.values.len());
            refuse(place("numbers"), message)
        }
        Some(numbers) if !numbers.iter().all(|number| number.is_finite()) => {
            refuse(place("numbers"), format!("is {numbers:?}; allowed: finite numbers"))
        }
        None if !axis.values.iter().all(|value| value.is_float() || value.is_integer()) => refuse(
            place("values"),
            "are not numbers, so that tables cannot show them; give `numbers` to stand for them",
        ),
        _ => Ok(()),
    }
}

fn check_blocks(key: &str, blocks: &BlockSpec) -> Result<(), SpecError> {
    check_number(&format!("{key}.first"), "blocks.first", blocks.first as f64)?;
    check_number(&format!("{key}.count"), "blocks.count", blocks.count as f64)
}

fn check_measure(key: &str, measure: &MeasureSpec) -> Result<(), SpecError> {
    for (name, value) in [
        ("largest_spacing", measure.largest_spacing),
        ("link_ratio", measure.link_ratio),
        ("min_mass_share", measure.min_mass_share),
        ("bodies", measure.bodies as f64),
        ("settle_window", measure.settle_window),
    ] {
        check_number(&format!("{key}.{name}"), &format!("measure.{name}"), value)?;
    }
    Ok(())
}

fn check_number(place: &str, key: &str, value: f64) -> Result<(), SpecError> {
    match RULES.iter().find(|(known, range)| *known == key && !range.contains(value)) {
        None => Ok(()),
        Some((_, range)) => refuse(format!("`{place}`"), format!("is {}; allowed: {range}", Shown(value))),
    }
}

pub(super) fn check_name(place: &str, name: &str) -> Result<(), SpecError> {
    let plain = (1..=MOST_IN_NAME).contains(&name.len())
        && name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || "-_.".contains(c))
        && !name.starts_with('.');
    if plain {
        return Ok(());
    }
    let name = brief(name, 2 * MOST_IN_NAME);
    refuse(
        place,
        format!(
            "is \"{name}\"; allowed: 1 to {MOST_IN_NAME} of the characters a-z 0-9 - _ . and no dot first"
        ),
    )
}

pub(super) fn refuse(place: impl Into<String>, message: impl Into<String>) -> Result<(), SpecError> {
    Err(SpecError::value(place, message))
}
