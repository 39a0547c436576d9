//! How hard bodies strike, which carries errors from scene to scene.
//!
//! While a wave crosses a body of n cells at its narrowest, an impact at the Mach number M = v / c_P presses n M cells of it in. A grid that places the
//! contact a share of a cell off is off by that share of what there is to see: the error goes like 1 / (n M) (docs/findings.md shows by how much it
//! does).

use std::path::Path;

use crate::cost::extents;
use crate::preflight::facts;
use crate::results::{Archive, CaseResult};
use crate::spec::SceneSpec;
use crate::spec::scene::RegionSpec;
use crate::spec::study::TradeoffSpec;
use crate::table::Row;

/// The impact of a scene.
struct Impact {
    /// Number of the scene.
    scene: f64,
    mach: f64,
    /// Cells that it presses in while a wave crosses the body.
    cells: f64,
}

/// The impacts of a study's scenes.
pub(super) struct Impacts(Vec<Impact>);

impl Impacts {
    /// Those of one arm, whichever it is: only ratios of its cells count, and an arm has the same grid in all scenes.
    pub(super) fn of(archive: &Archive, results: &[CaseResult], tradeoff: &TradeoffSpec) -> Self {
        let mut all: Vec<Impact> = Vec::new();
        let arm = results.first().map(|result| &result.case.arm);
        for result in results.iter().filter(|result| Some(&result.case.arm) == arm) {
            let (spec, number) = (&result.case.scene, result.case.number(&tradeoff.axis));
            let Some(scene) = number.filter(|number| all.iter().all(|known| known.scene != *number)) else {
                continue;
            };
            let mach = facts(spec, archive.folder).map_or(f64::NAN, |facts| facts.mach);
            all.push(Impact { scene, mach, cells: mach * cells_across(spec, archive.folder) });
        }
        Impacts(all)
    }

    /// What an error in a scene is times, to be that of the first scene; 1 where nothing strikes anything.
    pub(super) fn carried(&self, scene: f64) -> f64 {
        let own = self.0.iter().find(|impact| impact.scene == scene);
        let ratio = own.zip(self.0.first()).map(|(own, first)| own.cells / first.cells);
        ratio.filter(|ratio| ratio.is_finite() && *ratio > 0.0).unwrap_or(1.0)
    }

    /// For what impact errors are told, and from which they are learnt.
    pub(super) fn columns(&self, row: &mut Row) {
        let all = || self.0.iter().map(|impact| impact.mach);
        row.put(
            "mach",
            "-",
            "Mach number of the first scene's impact, for which errors are told",
            all().next(),
        )
        .put("mach_least", "-", "the least of all scenes", all().reduce(f64::min))
        .put("mach_greatest", "-", "the greatest of all scenes", all().reduce(f64::max));
    }
}

/// Cells across the first body, where it is narrowest.
pub(super) fn cells_across(scene: &SceneSpec, folder: &Path) -> f64 {
    let least = |extents: Vec<f64>| extents.into_iter().reduce(f64::min);
    let narrowest = match scene.body.first().and_then(|body| body.region.as_ref()) {
        // One that is turned is narrower than what bounds it.
        Some(RegionSpec::Box(shape)) => least(shape.half_extent.clone()).map(|half| 2.0 * half),
        _ => extents(scene, folder).and_then(least),
    };
    narrowest.map_or(f64::NAN, |extent| extent / scene.numerics.spacing)
}
