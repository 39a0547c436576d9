//! What a study may say of its maps.

use std::collections::BTreeSet;

use super::study::{MapSpec, SweepSpec};
use super::study_rules::{Ids, check_ends, check_name, refuse};
use super::{SpecError, StudySpec};

impl StudySpec {
    pub(super) fn check_maps(&self, ids: &Ids) -> Result<(), SpecError> {
        let mut seen = BTreeSet::new();
        for (number, map) in self.map.iter().enumerate() {
            let place = |key: &str| format!("`map.{number}.{key}`");
            // It becomes the name of a figure.
            check_name(&place("id"), &map.id)?;
            if !seen.insert(&map.id) {
                let message = format!("is \"{}\", which stands twice; give each map its own id", map.id);
                return refuse(place("id"), message);
            }
            let axes = [("x", &map.x), ("y", &map.y)];
            axes.iter().try_for_each(|(key, name)| self.check_axis(place(key), name))?;
            if map.x == map.y {
                return refuse(place("y"), format!("is \"{}\" as `x` is; name another axis", map.y));
            }
            map.arms.iter().try_for_each(|id| ids.check(place("arms"), id))?;
            self.check_crossing(place("arms"), map)?;
            if let Some(sound) = &map.sound {
                check_ends(place("sound.range"), sound.range)?;
                self.check_metric(place("sound.metric"), &sound.metric)?;
            }
        }
        Ok(())
    }

    fn check_axis(&self, place: String, name: &str) -> Result<(), SpecError> {
        let plain = self.sweep.iter().filter(|axis| axis.sample.is_none());
        let names: Vec<&str> = plain.map(|axis| axis.name.as_str()).collect();
        if names.contains(&name) {
            return Ok(());
        }
        let known = if names.is_empty() { "none".into() } else { names.join(", ") };
        refuse(place, format!("names the axis \"{name}\"; the study's [[sweep]] has: {known}"))
    }

    /// Every arm of a map has to be run along its two axes, and along no third.
    fn check_crossing(&self, place: String, map: &MapSpec) -> Result<(), SpecError> {
        let takes = |id: &str| -> Vec<&str> {
            self.sweep
                .iter()
                .filter(|axis| axis.takes(id))
                .map(|axis: &SweepSpec| axis.name.as_str())
                .collect()
        };
        let crosses = |id: &str| [&map.x, &map.y].iter().all(|axis| takes(id).contains(&axis.as_str()));
        let arms: Vec<&str> = map.arms_of(self);
        if arms.is_empty() {
            let message = format!("no arm is run along both \"{}\" and \"{}\"", map.x, map.y);
            return refuse(place, format!("{message}; name one in `arms` of both axes"));
        }
        let Some(id) = arms.into_iter().find(|id| !crosses(id) || takes(id).len() > 2) else {
            return Ok(());
        };
        let along = takes(id).join(", ");
        let message = format!(
            "\"{id}\" is run along: {along}; a map takes arms of its two axes, \"{}\" and \"{}\"",
            map.x, map.y
        );
        refuse(place, format!("{message}, and of no other; set `arms` of the axes"))
    }
}

impl MapSpec {
    /// The arms of the map, in the order of the study: those named, or all that are run along both its axes.
    pub fn arms_of<'a>(&self, study: &'a StudySpec) -> Vec<&'a str> {
        let axes: Vec<&SweepSpec> =
            study.sweep.iter().filter(|axis| [&self.x, &self.y].contains(&&axis.name)).collect();
        let shown = |id: &str| match self.arms.is_empty() {
            true => axes.iter().all(|axis| axis.takes(id)),
            false => self.arms.iter().any(|arm| arm == id),
        };
        study.arm.iter().map(|arm| arm.id.as_str()).filter(|id| shown(id)).collect()
    }
}
