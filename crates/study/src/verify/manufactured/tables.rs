//! Tables, figures and checks of what was run.

use super::follow::{Errors, Run, orders};
use super::series::{Series, VORTEX, waves};
use crate::figure::Drawing;
use crate::figure::axis::Scale;
use crate::statistics::{mean, standard_deviation};
use crate::table::{Row, Table};
use crate::verify::chart::{Line, Panel, chart};
use crate::verify::scenes::kernel_name;

const L2: fn(&Errors) -> f64 = |errors| errors.l2;
const LINF: fn(&Errors) -> f64 = |errors| errors.linf;

/// The order of an error over some grids, mean over the seeds.
pub fn order(runs: &[Run], of: fn(&Errors) -> f64) -> f64 {
    mean(&orders(runs, of)).unwrap_or(f64::NAN)
}

/// The three finest of the grids.
pub fn finest(runs: &[Run]) -> &[Run] {
    &runs[runs.len().saturating_sub(3)..]
}

fn identity(row: &mut Row, series: &Series) {
    row.put("solution", "-", "motion", series.motion.name())
        .put("kernel", "-", "B-spline", kernel_name(series.kernel))
        .put("transfer", "-", "velocity transfer", series.transfer_name())
        .put("placement", "-", "where particles begin", series.placement_name())
        .put("precision", "-", "floating point type", if series.single { "f32" } else { "f64" })
        .put(
            "walls",
            "-",
            "mirrored, or normal velocity zeroed",
            if series.mirrored { "mirrored" } else { "zeroed" },
        );
}

/// One row for each run.
pub fn runs_table(name: &'static str, runs: &[Run]) -> Table {
    let row = |run: &Run| {
        let mut row = Row::default();
        identity(&mut row, &run.series);
        row.count("cells", "cells per metre", run.cells as u64)
            .number("step", "-", "step over the default", run.series.step)
            .count("particles", "number of particles", run.particles as u64)
            .count("particles_per_cell", "particles per cell", run.series.per_cell() as u64)
            .count("steps", "steps", run.steps)
            .count("seeds", "placements drawn", run.errors.len() as u64)
            .number(
                "l2",
                "-",
                "root mean square error of displacement over its amplitude, mean over the seeds",
                run.mean(L2),
            )
            .put("l2_deviation", "-", "its standard deviation over the seeds", run.deviation(L2))
            .number(
                "linf",
                "-",
                "largest error of displacement over its amplitude, mean over the seeds",
                run.mean(LINF),
            );
        row
    };
    Table { name, rows: runs.iter().map(row).collect() }
}

/// One row for each series.
pub fn orders_table(grouped: &[&[Run]]) -> Table {
    let row = |runs: &&[Run]| {
        let last = &runs[runs.len() - 1];
        let fine = orders(finest(runs), L2);
        let mut row = Row::default();
        identity(&mut row, &last.series);
        row.count("particles_per_cell", "particles per cell", last.series.per_cell() as u64)
            .number("reference_step", "s", "step for which flip's share is 0.95", last.series.reference_step)
            .count("seeds", "placements drawn", last.errors.len() as u64)
            .count("cells", "cells per metre of the finest grid", last.cells as u64)
            .number("l2", "-", "L2 error on the finest grid, mean over the seeds", last.mean(L2))
            .put("l2_deviation", "-", "its standard deviation over the seeds", last.deviation(L2))
            .number("linf", "-", "largest error on the finest grid, mean over the seeds", last.mean(LINF))
            .number(
                "order_l2_coarse",
                "-",
                "order of the L2 error over the three coarsest grids",
                order(&runs[..3], L2),
            )
            .number(
                "order_l2",
                "-",
                "order of the L2 error over the three finest grids",
                order(finest(runs), L2),
            )
            .put(
                "order_l2_deviation",
                "-",
                "its standard deviation over the seeds",
                standard_deviation(&fine),
            )
            .number(
                "order_linf",
                "-",
                "order of the largest error over the three finest grids",
                order(finest(runs), LINF),
            );
        row
    };
    Table { name: "manufactured-orders", rows: grouped.iter().map(row).collect() }
}

/// How far the motions go.
pub fn solutions_table() -> Table {
    let row = |(name, meaning, value): (&str, &str, f64)| {
        let mut row = Row::default();
        row.put("solution", "-", "motion", name).put("measure", "-", "what is largest", meaning).number(
            "largest",
            "-",
            "its largest value",
            value,
        );
        row
    };
    let rows = [("waves", "strain", waves().largest_strain()), ("vortex", "shear", VORTEX.largest_shear())];
    Table { name: "manufactured-solutions", rows: rows.into_iter().map(row).collect() }
}

/// Errors against the grid of the series that are named, beside the slopes of orders 1 and 2.
pub fn figure(grouped: &[&[Run]], name: &dyn Fn(&Series) -> Option<String>) -> anyhow::Result<Drawing> {
    let shown: Vec<(String, &[Run])> =
        grouped.iter().filter_map(|runs| Some((name(&runs[0].series)?, *runs))).collect();
    let lines = |of: fn(&Errors) -> f64| -> Vec<Line> {
        let line = |(name, runs): &(String, &[Run])| {
            let points = runs.iter().map(|run| (run.cells as f64, run.mean(of)));
            Line::new(name.as_str(), points.collect::<Vec<_>>())
        };
        shown.iter().map(line).collect()
    };
    let scale = Scale::Logarithmic;
    let panels = [
        Panel::new("L2 error", scale, lines(L2)).with_orders(-1.0),
        Panel::new("largest error", scale, lines(LINF)).with_orders(-1.0),
    ];
    let note = "Error of the particles' displacement over its amplitude, mean over the seeds.";
    chart("cells per metre", scale, note, &panels)
}
