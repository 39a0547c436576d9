//! Do the fragment statistics converge: with the grid, with the particles, with the step? The cases are those of
//! `studies/convergence.toml`, run and kept as any study's are.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use rayon::prelude::*;

use super::Setting;
use super::chart::{Line, Panel, chart};
use super::evidence::{Check, Effort, Evidence, EvidenceFigure};
use crate::case_run::Job;
use crate::figure::axis::Scale;
use crate::keeper::Limits;
use crate::manifest::Program;
use crate::results::{Archive, CaseResult};
use crate::run::Unobserved;
use crate::spec::parse;
use crate::statistics::{mean, standard_deviation, t_interval};
use crate::sweep::Study;
use crate::table::{Row, Table};

/// The study.
const STUDY: &str = include_str!("../../../../studies/convergence.toml");

/// A quantity of a case.
struct Quantity {
    name: &'static str,
    meaning: &'static str,
    unit: &'static str,
    of: fn(&CaseResult) -> f64,
}

const QUANTITIES: [Quantity; 5] = [
    Quantity {
        name: "ln_neff",
        meaning: "ln of the effective number of fragments, one link for all",
        unit: "-",
        of: |case| case.metrics.as_ref().map_or(f64::NAN, |metrics| metrics.end.ln_neff),
    },
    Quantity {
        name: "damage",
        meaning: "share of the mass outside the largest fragment",
        unit: "-",
        of: |case| case.metrics.as_ref().map_or(f64::NAN, |metrics| metrics.end.damage),
    },
    Quantity {
        name: "dust",
        meaning: "share of the mass in pieces below the cut",
        unit: "-",
        of: |case| case.metrics.as_ref().map_or(f64::NAN, |metrics| metrics.end.dust),
    },
    Quantity {
        name: "ln_neff_kernel",
        meaning: "ln of the effective number of fragments by the kernel graph, whose reach is the grid's",
        unit: "-",
        of: |case| case.metrics.as_ref().map_or(f64::NAN, |metrics| metrics.ln_neff_kernel),
    },
    Quantity {
        name: "plastic_loss",
        meaning: "energy lost to plastic flow",
        unit: "J/m",
        of: |case| case.record.history.last().map_or(f64::NAN, |row| row.plastic_loss),
    },
];

/// Refinement along one axis, from coarse to fine.
struct RefinementPath {
    name: &'static str,
    refined: &'static str,
    /// Arms of the study.
    arms: &'static [&'static str],
    /// What is refined, of a case.
    level: fn(&CaseResult) -> f64,
}

const PATHS: [RefinementPath; 4] = [
    RefinementPath {
        name: "grid, random",
        refined: "spacing h [mm] at 4 particles per cell, random",
        arms: &["random-grid-1", "random-grid-2", "random-grid-3", "random-grid-4"],
        level: spacing,
    },
    RefinementPath {
        name: "grid, jittered",
        refined: "spacing h [mm] at 4 particles per cell, jittered",
        arms: &["jittered-grid-1", "jittered-grid-2", "jittered-grid-3", "jittered-grid-4"],
        level: spacing,
    },
    RefinementPath {
        name: "particles",
        refined: "particles per cell at h = 7.2 mm, random",
        arms: &["particles-1", "particles-2", "random-grid-3", "particles-8", "particles-16"],
        level: particles_per_cell,
    },
    RefinementPath {
        name: "step",
        refined: "wave Courant number at h = 7.2 mm and 2 particles per cell, random",
        arms: &["particles-2", "step-half", "step-quarter"],
        level: wave_courant,
    },
];

/// [mm], to the micrometre.
fn spacing(result: &CaseResult) -> f64 {
    (1e6 * result.case.scene.numerics.spacing).round() * 1e-3
}

/// To a tenth: numbers of particles are round.
fn particles_per_cell(result: &CaseResult) -> f64 {
    (10.0 * result.record.made.particles_per_cell).round() / 10.0
}

fn wave_courant(result: &CaseResult) -> f64 {
    result.case.scene.numerics.wave_courant.unwrap_or(f64::NAN)
}

/// Values of one quantity by block.
type Blocks = BTreeMap<u64, f64>;

/// All cases of an arm.
struct Arms<'a>(BTreeMap<&'a str, Vec<&'a CaseResult>>);

impl<'a> Arms<'a> {
    fn of(results: &'a [CaseResult]) -> Self {
        let mut arms = BTreeMap::<&str, Vec<&CaseResult>>::new();
        for result in results {
            arms.entry(&result.case.arm).or_default().push(result);
        }
        Arms(arms)
    }

    /// The values of the cases that can be used.
    fn values(&self, arm: &str, quantity: &Quantity) -> Blocks {
        let cases = self.0.get(arm).into_iter().flatten();
        let usable = cases.filter(|case| case.failure().is_none());
        usable.map(|case| (case.case.block, (quantity.of)(case))).filter(|(_, v)| v.is_finite()).collect()
    }

    /// Cases whose largest fragment has come to rest.
    fn settled(&self, arm: &str) -> u64 {
        let cases = self.0.get(arm).into_iter().flatten();
        cases.filter(|case| case.metrics.as_ref().is_some_and(|metrics| metrics.settled)).count() as u64
    }

    /// The levels of a path that were run.
    fn levels(&self, path: &RefinementPath) -> Vec<(&'static str, f64)> {
        let level = |arm: &&'static str| self.0.get(arm).map(|cases| (*arm, (path.level)(cases[0])));
        path.arms.iter().filter_map(level).collect()
    }
}

/// Carries it out; cases that an earlier run has finished are not run again.
pub fn run(setting: &Setting) -> anyhow::Result<Evidence> {
    let profile = (setting.effort == Effort::Quick).then_some("quick");
    let study = Study::expand(parse(STUDY)?, profile)?;
    let archive = Archive::open(&study, setting.out, Path::new("."))?;
    // Those to be run longest first, so that both cores stay busy to the end.
    let mut missing = archive.missing();
    missing.sort_by(|&a, &b| work(&study, b).total_cmp(&work(&study, a)));
    let (limits, program) = (Limits::default(), Program::this(Path::new(".")));
    let job = Job::alone(&limits, &program);
    missing
        .par_iter()
        .with_max_len(1)
        .try_for_each(|&index| archive.run(index, &job, &mut Unobserved).map(|_| ()))
        .with_context(|| format!("cannot keep the cases of {}", setting.out.display()))?;
    let results = archive.results()?;
    let arms = Arms::of(&results);
    let stopped = results.iter().filter(|result| result.failure().is_some()).count();
    Ok(Evidence {
        tables: vec![levels_table(&arms), refinements_table(&arms), cases_table(&results)],
        figures: vec![
            figure(
                &arms,
                "convergence-grid",
                "The grid is refined at 4 particles per cell.",
                &[0, 1],
                "h [mm]",
            )?,
            figure(
                &arms,
                "convergence-particles",
                "Particles are added at one grid, h = 7.2 mm, random placement.",
                &[2],
                "particles per cell",
            )?,
            figure(
                &arms,
                "convergence-step",
                "The step is shortened, at h = 7.2 mm and 2 particles per cell.",
                &[3],
                "wave Courant number",
            )?,
        ],
        checks: vec![Check {
            quantity: "cases that stopped, or could not be measured".into(),
            measured: stopped as f64,
            theory: "0".into(),
            allowed: [0.0, 0.0],
            source: "whether statistics converge is a finding, not a check; that every case counts is one",
        }],
    })
}

/// Particles over spacing and Courant number, which the work of a case goes with.
fn work(study: &Study, index: usize) -> f64 {
    let scene = &study.cases[index].scene;
    let count = scene.body[0].placement.count().unwrap_or(0) as f64;
    count / scene.numerics.spacing / scene.numerics.wave_courant.unwrap_or(1.0)
}

/// One row for each path and level.
fn levels_table(arms: &Arms) -> Table {
    let mut rows = Vec::new();
    for path in &PATHS {
        for (arm, level) in arms.levels(path) {
            let mut row = Row::default();
            row.put("path", "-", "what is refined", path.name)
                .number("level", "-", "h [mm], particles per cell, or wave Courant number", level)
                .put("arm", "-", "arm of studies/convergence.toml", arm)
                .count("blocks", "seeds", arms.values(arm, &QUANTITIES[0]).len() as u64)
                .count(
                    "settled",
                    "of them, those whose largest fragment no longer changes",
                    arms.settled(arm),
                );
            for quantity in &QUANTITIES {
                let values: Vec<f64> = arms.values(arm, quantity).into_values().collect();
                let deviation = format!("{}_deviation", quantity.name);
                row.put(quantity.name, quantity.unit, quantity.meaning, mean(&values)).put(
                    &deviation,
                    quantity.unit,
                    "standard deviation of the seeds",
                    standard_deviation(&values),
                );
            }
            rows.push(row);
        }
    }
    Table { name: "convergence-levels", rows }
}

/// What the last refinement of a path changed in a quantity, seed by seed.
struct LastRefinement {
    change: f64,
    /// At 95 %, by Student's t.
    interval: [f64; 2],
    /// Change over the standard deviation of the seeds on the finer level; none where they are all the same.
    over_spread: Option<f64>,
    blocks: usize,
}

impl LastRefinement {
    /// Whether the interval leaves out 0.
    fn words(&self) -> &'static str {
        match self.interval {
            [0.0, 0.0] => "equal on both, which is no evidence",
            [lower, upper] if lower <= 0.0 && 0.0 <= upper => "not seen to move",
            _ => "still moves",
        }
    }
}

fn last_refinement(arms: &Arms, path: &RefinementPath, quantity: &Quantity) -> Option<LastRefinement> {
    let levels = arms.levels(path);
    let [.., (coarse, _), (fine, _)] = levels[..] else { return None };
    let (coarse, fine) = (arms.values(coarse, quantity), arms.values(fine, quantity));
    let changes: Vec<f64> =
        fine.iter().filter_map(|(block, value)| coarse.get(block).map(|before| value - before)).collect();
    let interval = t_interval(&changes, 0.95)?;
    let change = mean(&changes)?;
    let spread = standard_deviation(&fine.into_values().collect::<Vec<_>>())?;
    Some(LastRefinement {
        change,
        interval: [interval.lower, interval.upper],
        over_spread: (spread > 0.0).then_some(change / spread),
        blocks: changes.len(),
    })
}

/// One row for each path and quantity.
fn refinements_table(arms: &Arms) -> Table {
    let mut rows = Vec::new();
    for path in &PATHS {
        for quantity in &QUANTITIES {
            let found = last_refinement(arms, path, quantity);
            let words = found.as_ref().map_or("not told by so few seeds", LastRefinement::words);
            let of = |value: fn(&LastRefinement) -> f64| found.as_ref().map(value);
            let mut row = Row::default();
            row.put("path", "-", "what is refined", path.name)
                .put("refined", "-", "the same in words", path.refined)
                .put("quantity", "-", "quantity", quantity.name)
                .put("meaning", "-", "what it is", quantity.meaning)
                .put("unit", "-", "its unit", quantity.unit)
                .count(
                    "blocks",
                    "seeds run on both levels",
                    found.as_ref().map_or(0, |found| found.blocks as u64),
                )
                .put(
                    "change",
                    "as the quantity",
                    "mean change by the last refinement",
                    of(|found| found.change),
                )
                .put(
                    "lower",
                    "as the quantity",
                    "lower end of its 95 % interval",
                    of(|found| found.interval[0]),
                )
                .put(
                    "upper",
                    "as the quantity",
                    "upper end of its 95 % interval",
                    of(|found| found.interval[1]),
                )
                .put(
                    "over_spread",
                    "-",
                    "change over the seeds' standard deviation",
                    found.as_ref().and_then(|found| found.over_spread),
                )
                .put("verdict", "-", "whether the interval leaves out 0", words);
            rows.push(row);
        }
    }
    Table { name: "convergence-refinements", rows }
}

fn cases_table(results: &[CaseResult]) -> Table {
    let row = |result: &CaseResult| {
        let failure = result.failure().unwrap_or_default();
        let mut row = Row::default();
        row.put("arm", "-", "arm of studies/convergence.toml", result.case.arm.as_str())
            .count("block", "seed", result.case.block)
            .put("key", "-", "key of the case", result.key.as_str())
            .put("failure", "-", "why it cannot be used; empty where it can", failure.as_str())
            .count("particles", "particles", result.record.made.particles as u64)
            .count("steps", "steps", result.record.steps);
        for quantity in &QUANTITIES {
            row.number(quantity.name, quantity.unit, quantity.meaning, (quantity.of)(result));
        }
        row
    };
    Table { name: "convergence-cases", rows: results.iter().map(row).collect() }
}

/// Means with the seeds' standard deviation, of the first two quantities.
fn figure(
    arms: &Arms,
    name: &'static str,
    caption: &'static str,
    paths: &[usize],
    x_label: &str,
) -> anyhow::Result<EvidenceFigure> {
    let lines = |quantity: &Quantity| -> Vec<Line> {
        let line = |path: &RefinementPath| {
            let points = arms.levels(path).into_iter().filter_map(|(arm, level)| {
                let values: Vec<f64> = arms.values(arm, quantity).into_values().collect();
                let spread = standard_deviation(&values).unwrap_or(0.0);
                mean(&values).map(|mean| (level, mean, spread))
            });
            Line::with_spread(path.name, points)
        };
        paths.iter().map(|&index| line(&PATHS[index])).collect()
    };
    let panels = [
        Panel::new("ln N_eff", Scale::Linear, lines(&QUANTITIES[0])),
        Panel::new("damage D", Scale::Linear, lines(&QUANTITIES[1])),
    ];
    let note = "Mean over the seeds; bars are their standard deviation.";
    Ok(EvidenceFigure { name, caption, drawing: chart(x_label, Scale::Logarithmic, note, &panels)? })
}
