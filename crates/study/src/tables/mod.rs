//! The tables of a study.

mod verdicts;

use crate::assemble::Made;
use crate::record::HistoryRow;
use crate::results::CaseResult;
use crate::statistics::{Interval, summarise};
use crate::table::{Cell, Row, Table};

pub use verdicts::{claims, density_noise, replicates, robustness};

/// Endpoints that are summarised by arm.
pub const ENDPOINTS: [&str; 10] = [
    "ln_neff",
    "damage",
    "fragments",
    "dust",
    "d50",
    "crack",
    "ln_neff_mean_link",
    "ln_neff_flood",
    "ln_neff_bonds",
    "ln_extent",
];
/// The tables' own columns, whose names an axis of a sweep cannot have.
pub const OWN_COLUMNS: [&str; 73] = [
    "arm",
    "block",
    "cases",
    "clamped_particles",
    "clamps",
    "components",
    "contact_loss",
    "contact_time",
    "crack",
    "d50",
    "damage",
    "damping",
    "digest",
    "dust",
    "elastic",
    "end_time",
    "endpoint",
    "failure",
    "fragments",
    "gate",
    "greatest",
    "host",
    "impulse",
    "iterations",
    "jobs",
    "key",
    "kinetic",
    "largest_residual",
    "least",
    "least_void_width",
    "ln_extent",
    "ln_neff",
    "ln_neff_bonds",
    "ln_neff_earlier",
    "ln_neff_flood",
    "ln_neff_kernel",
    "ln_neff_long_link",
    "ln_neff_mean_link",
    "loosened_1_05",
    "loosened_1_3",
    "loosened_2",
    "lower",
    "mass",
    "mass_share",
    "mean",
    "mean_step",
    "median",
    "most_iterations",
    "ns_per_particle_step",
    "outcome",
    "particle_steps",
    "particles",
    "particles_per_cell",
    "peak_memory",
    "plastic_loss",
    "porosity",
    "potential",
    "rank",
    "rejected_steps",
    "run_out",
    "sd",
    "settled",
    "since_contact",
    "steps",
    "time",
    "time_unit",
    "transfer_loss",
    "upper",
    "used",
    "void_draws",
    "voids",
    "wall_seconds",
    "watchdog_restores",
];
/// The numeric columns of `cases` beside the axes of a sweep: what an expectation can be held against.
pub const CASE_NUMBERS: [&str; 45] = [
    "block",
    "clamped_particles",
    "clamps",
    "components",
    "contact_loss",
    "contact_time",
    "crack",
    "d50",
    "damage",
    "damping",
    "dust",
    "elastic",
    "end_time",
    "fragments",
    "impulse",
    "iterations",
    "kinetic",
    "largest_residual",
    "ln_extent",
    "ln_neff",
    "ln_neff_bonds",
    "ln_neff_earlier",
    "ln_neff_flood",
    "ln_neff_kernel",
    "ln_neff_long_link",
    "ln_neff_mean_link",
    "loosened_1_05",
    "loosened_1_3",
    "loosened_2",
    "mass",
    "mean_step",
    "most_iterations",
    "particle_steps",
    "particles",
    "particles_per_cell",
    "plastic_loss",
    "porosity",
    "rejected_steps",
    "run_out",
    "steps",
    "time_unit",
    "transfer_loss",
    "void_draws",
    "voids",
    "watchdog_restores",
];
/// Confidence of the intervals of the summary.
const CONFIDENCE: f64 = 0.95;

/// `cases`: one row a case.
pub fn cases(results: &[CaseResult]) -> Table {
    Table { name: "cases", rows: results.iter().map(case_row).collect() }
}

fn arm_and_axes(row: &mut Row, result: &CaseResult) {
    row.put("arm", "-", "arm of the study", result.case.arm.as_str());
    for (name, number) in &result.case.axes {
        row.put(name, "-", "axis of the sweep", *number);
    }
}

fn identity(row: &mut Row, result: &CaseResult) {
    arm_and_axes(row, result);
    row.count("block", "seed shared by the arms of a block", result.case.block);
}

/// One row of `cases`.
pub fn case_row(result: &CaseResult) -> Row {
    let mut row = Row::default();
    identity(&mut row, result);
    let record = &result.record;
    // Of a case that was not built there is nothing to tell.
    let made = record.was_built().then_some(&record.made);
    let count = |pick: fn(&Made) -> usize| made.map_or(Cell::Missing, |made| Cell::Count(pick(made) as u64));
    row.put("key", "-", "name of the case's folder: hash of scene and solver version", result.key.as_str())
        .put("outcome", "-", "ok, ok-with-clamps or stopped(reason)", record.outcome.in_words().as_str())
        .put(
            "failure",
            "-",
            "why the case stopped, could not be measured or failed the gate; empty where it can be used",
            result.failure().as_deref().map_or(Cell::Missing, Cell::from),
        )
        .put("particles", "-", "number of particles N", count(|made| made.particles))
        .put(
            "particles_per_cell",
            "-",
            "particles per cell of the filled space",
            made.map(|made| made.particles_per_cell),
        )
        .put("porosity", "-", "share of the body that is void", made.map(|made| made.porosity))
        .put("voids", "-", "number of voids", count(|made| made.voids))
        .put(
            "least_void_width",
            "m",
            "width of the narrowest void: the largest circle or ball in it",
            made.map(|made| made.least_void_width),
        )
        .put("void_draws", "-", "draws until a void field was accepted", count(|made| made.void_draws))
        .put("mass", "kg/m or kg", "mass of all particles", made.map(|made| made.mass));
    measured(&mut row, result);
    let last = record.history.last();
    row.put("time_unit", "s", "R/v, or 1 s", made.map(|_| record.time_unit))
        .put("contact_time", "s", "first step in which an obstacle changed a velocity", record.contact_time)
        .number("end_time", "s", "time of the measurement", record.end_time)
        .count("steps", "accepted steps", record.steps)
        .count("particle_steps", "steps times particles", record.particle_steps)
        .number("mean_step", "s", "mean time step", record.mean_step)
        .number("damping", "-", "integral of (1 - a)/dt over time, a the FLIP share", record.damping)
        .count("rejected_steps", "steps tried and refused", record.rejected_steps)
        .count("watchdog_restores", "times the watchdog went back to a snapshot", record.watchdog_restores)
        .count(
            "iterations",
            "applications of implicit steps' operators, in accepted steps",
            record.iterations,
        )
        .count("most_iterations", "the most of them in a step", u64::from(record.most_iterations))
        .number(
            "largest_residual",
            "-",
            "largest residual a solve left, over its right side",
            record.largest_residual,
        )
        .count("clamps", "times a particle's J_P met a bound", record.clamps)
        .count("clamped_particles", "particles whose J_P ever met a bound", record.clamped_particles as u64)
        .put("kinetic", "J/m or J", "kinetic energy at the end", last.map(|h| h.kinetic))
        .put("elastic", "J/m or J", "elastic energy at the end", last.map(|h| h.elastic))
        .put("plastic_loss", "J/m or J", "energy lost to plastic flow", last.map(|h| h.plastic_loss))
        .put(
            "transfer_loss",
            "J/m or J",
            "energy lost between particles and grid",
            last.and_then(|h| h.transfer_loss),
        )
        .put("contact_loss", "J/m or J", "energy lost in contacts", last.and_then(|h| h.contact_loss))
        .put(
            "impulse",
            "kg/s or kg m/s",
            "impulse on the first obstacle along the last axis",
            impulse(result),
        )
        .put("digest", "-", "BLAKE3 of the final state", record.digest.as_str());
    row
}

fn impulse(result: &CaseResult) -> Option<f64> {
    result.record.history.last()?.impulses.first()?.last().copied()
}

fn measured(row: &mut Row, result: &CaseResult) {
    let m = result.metrics.as_ref();
    let end = m.map(|m| m.end);
    let flag = |value: Option<bool>| value.map_or(Cell::Missing, Cell::Flag);
    let count = |value: Option<usize>| value.map_or(Cell::Missing, |v| Cell::Count(v as u64));
    row.put(
        "gate",
        "-",
        "whether the metric sees the bodies that were built, at t = 0",
        flag(m.map(|m| m.gate_valid)),
    )
    .put("settled", "-", "whether M1/M has come to rest", flag(m.map(|m| m.settled)))
    .put("fragments", "-", "N_f: components of at least the cut", count(end.map(|e| e.fragments)))
    .put("components", "-", "all components, friends-of-friends", count(end.map(|e| e.components)))
    .put("ln_neff", "-", "A = ln N_eff, all particles", end.map(|e| e.ln_neff))
    .put("damage", "-", "D = 1 - M1/M", end.map(|e| e.damage))
    .put("dust", "-", "share of the mass in components below the cut", end.map(|e| e.dust))
    .put("d50", "m", "equivalent diameter of the mass-weighted median fragment", end.map(|e| e.d50))
    .put("crack", "m or m^2", "crack length (area) from cut bonds", m.and_then(|m| m.crack))
    .put(
        "ln_neff_mean_link",
        "-",
        "mean of A over nine links in [2, 4] h_max",
        m.map(|m| m.ln_neff_mean_link),
    )
    .put("ln_neff_long_link", "-", "A at link 3 h_max", m.map(|m| m.ln_neff_long_link))
    .put("ln_neff_flood", "-", "A by flood fill", m.map(|m| m.ln_neff_flood))
    .put("ln_neff_bonds", "-", "A by the bond graph", m.map(|m| m.ln_neff_bonds))
    .put("ln_neff_kernel", "-", "A by the kernel graph", m.map(|m| m.ln_neff_kernel))
    .put("ln_neff_earlier", "-", "A one settle window earlier", m.map(|m| m.ln_neff_earlier))
    .put("ln_extent", "-", "ln of the horizontal width of 90 % of the mass [m]", m.and_then(|m| m.ln_extent))
    .put(
        "run_out",
        "m",
        "horizontal distance from the centre of mass of the first frame that 95 % of the mass stay within",
        m.map(|m| m.run_out),
    )
    .put("loosened_1_05", "-", "share of the mass with J_P > 1.05", m.map(|m| m.loosened[0]))
    .put("loosened_1_3", "-", "share of the mass with J_P > 1.3", m.map(|m| m.loosened[1]))
    .put("loosened_2", "-", "share of the mass with J_P > 2", m.map(|m| m.loosened[2]));
}

/// `fragments`: one row a fragment of at least the cut.
pub fn fragments(results: &[CaseResult]) -> Table {
    let mut rows = Vec::new();
    for result in results {
        for (rank, &share) in result.metrics.iter().flat_map(|m| &m.sizes).enumerate() {
            let mut row = Row::default();
            identity(&mut row, result);
            row.count("rank", "1 for the heaviest fragment of the case", rank as u64 + 1)
                .number("mass_share", "-", "mass of the fragment over the mass of the case", share)
                .number("mass", "kg/m or kg", "mass of the fragment", share * result.record.made.mass);
            rows.push(row);
        }
    }
    Table { name: "fragments", rows }
}

/// `frames`: one row a frame and case.
pub fn frames(results: &[CaseResult]) -> Table {
    let mut rows = Vec::new();
    for result in results {
        let series = result.metrics.iter().flat_map(|m| &m.series);
        for (at, ledger) in series.zip(&result.record.history) {
            let f = &at.fragments;
            let mut row = Row::default();
            identity(&mut row, result);
            row.number("time", "s", "time", at.time)
                .number(
                    "since_contact",
                    "R/v or s",
                    "time since contact in units of the output",
                    at.since_contact,
                )
                .count("steps", "steps taken", ledger.steps)
                .count("fragments", "N_f: components of at least the cut", f.fragments as u64)
                .number("ln_neff", "-", "A = ln N_eff", f.ln_neff)
                .number("damage", "-", "D = 1 - M1/M", f.damage)
                .number("dust", "-", "share of the mass in components below the cut", f.dust);
            energies(&mut row, ledger);
            rows.push(row);
        }
    }
    Table { name: "frames", rows }
}

/// The columns of the energies and of where they went.
pub fn energies(row: &mut Row, ledger: &HistoryRow) {
    row.number("kinetic", "J/m or J", "kinetic energy", ledger.kinetic)
        .number("elastic", "J/m or J", "elastic energy", ledger.elastic)
        .number("potential", "J/m or J", "potential energy", ledger.potential)
        .number("plastic_loss", "J/m or J", "lost to plastic flow so far", ledger.plastic_loss)
        .put("transfer_loss", "J/m or J", "lost between particles and grid so far", ledger.transfer_loss)
        .put("contact_loss", "J/m or J", "lost in contacts so far", ledger.contact_loss);
}

/// `summary`: one row an arm (and point of the sweep) and endpoint, over the cases that can be used.
pub fn summary(results: &[CaseResult]) -> Table {
    let mut rows = Vec::new();
    for group in groups(results) {
        let case_rows: Vec<Row> = group.iter().filter(|r| usable(r)).map(|r| case_row(r)).collect();
        for endpoint in ENDPOINTS {
            let values: Vec<f64> = case_rows.iter().filter_map(|row| row.value(endpoint)).collect();
            let Some(s) = summarise(&values, CONFIDENCE) else { continue };
            let bound = |pick: fn(&Interval) -> f64| s.interval.as_ref().map(pick);
            let mut row = Row::default();
            arm_and_axes(&mut row, group[0]);
            row.put("endpoint", "-", "column of `cases`", endpoint)
                .count("cases", "cases run", group.len() as u64)
                .count("used", "cases that ended well, passed the gate and have the endpoint", s.count as u64)
                .number("mean", "of the endpoint", "mean", s.mean)
                .put("sd", "of the endpoint", "standard deviation", s.standard_deviation)
                .put(
                    "lower",
                    "of the endpoint",
                    "lower end of the 95 % t interval of the mean",
                    bound(|i| i.lower),
                )
                .put(
                    "upper",
                    "of the endpoint",
                    "upper end of the 95 % t interval of the mean",
                    bound(|i| i.upper),
                )
                .number("least", "of the endpoint", "least value", s.minimum)
                .number("median", "of the endpoint", "median", s.median)
                .number("greatest", "of the endpoint", "greatest value", s.maximum);
            rows.push(row);
        }
    }
    Table { name: "summary", rows }
}

/// Whether a case ended well and its metric may be believed.
pub fn usable(result: &CaseResult) -> bool {
    result.metrics.as_ref().is_some_and(|m| m.gate_valid)
}

/// Results of the same arm and point of the sweep, in the order of the study.
pub fn groups(results: &[CaseResult]) -> Vec<Vec<&CaseResult>> {
    let mut groups: Vec<Vec<&CaseResult>> = Vec::new();
    for result in results {
        match groups.last_mut() {
            Some(group) if group[0].case.arm == result.case.arm && group[0].case.axes == result.case.axes => {
                group.push(result);
            }
            _ => groups.push(vec![result]),
        }
    }
    groups
}

/// `timings`: the only table that knows a clock.
/// Without a manifest its entries are empty.
pub fn timings(results: &[CaseResult]) -> Table {
    let mut rows = Vec::new();
    for result in results {
        let clock = result.manifest.as_ref();
        let steps = result.record.particle_steps;
        let per_step = clock.filter(|_| steps > 0).map(|c| c.wall_seconds * 1e9 / steps as f64);
        let mut row = Row::default();
        identity(&mut row, result);
        row.put("wall_seconds", "s", "wall time of the case", clock.map(|c| c.wall_seconds))
            .put("ns_per_particle_step", "ns", "wall time over particle-steps, measuring included", per_step)
            .put(
                "peak_memory",
                "bytes",
                "peak memory of the process so far",
                clock.map(|c| c.peak_memory as f64),
            )
            .put("jobs", "-", "cases run side by side", clock.map(|c| c.jobs as f64))
            .put("host", "-", "machine", clock.map_or("", |c| c.program.host.as_str()));
        rows.push(row);
    }
    Table { name: "timings", rows }
}
