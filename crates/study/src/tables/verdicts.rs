//! The tables of what claims and controls come to.

use crate::claims::{CHECK_BLOCKS, CheckReading, Verdict};
use crate::evaluate::{Judged, JudgedNoise};
use crate::statistics::{FiellerSet, Interval};
use crate::table::{Row, Table};

/// `claims`: one row a claim.
pub fn claims(judged: &[Judged]) -> Table {
    let rows =
        judged.iter().map(|Judged { family, claim, primary, largest_spacing, assessment: a, .. }| {
            let e = &a.evidence;
            let lower = |i: Option<Interval>| i.map(|i| i.lower);
            let upper = |i: Option<Interval>| i.map(|i| i.upper);
            let checks = a.checks.iter().map(CheckReading::to_string).collect::<Vec<_>>().join("; ");
            let mut row = Row::default();
            row.put("family", "-", "claim or control", *family)
                .put("claim", "-", "id of the claim", a.claim.as_str())
                .put("sentence", "-", "what is claimed, in our words", claim.sentence.as_str())
                .put(
                    "primary",
                    "-",
                    "metric of the endpoint A, by the calibration",
                    primary.to_string().as_str(),
                )
                .number("largest_spacing", "m", "h_max, by which lengths are measured", *largest_spacing)
                .put("verdict", "-", "by the mechanical rule", a.verdict.to_string().as_str())
                .count("blocks", "complete blocks", e.blocks as u64)
                .count("lost_blocks", "blocks dropped because a case in them was lost", a.lost_blocks as u64)
                .put("effect", "ln N_eff", "mean of d over blocks, positive in PS17's direction", e.effect)
                .put("sd", "ln N_eff", "standard deviation of d over blocks", e.standard_deviation)
                .number("confidence", "-", "confidence of the intervals, 1 - 0.05/m", e.confidence)
                .put("lower_t", "ln N_eff", "lower end of the studentised interval", lower(e.interval_t))
                .put("upper_t", "ln N_eff", "upper end of the studentised interval", upper(e.interval_t))
                .put("lower_bca", "ln N_eff", "lower end of the BCa interval", lower(e.interval_bca))
                .put("upper_bca", "ln N_eff", "upper end of the BCa interval", upper(e.interval_bca))
                .put("upper_one_sided_t", "ln N_eff", "one-sided 95 % upper bound, studentised", e.upper_t)
                .put("upper_one_sided_bca", "ln N_eff", "one-sided 95 % upper bound, BCa", e.upper_bca)
                .put("p", "-", "sign flips or permutations within blocks", e.p_value)
                .put("p_holm", "-", "adjusted over the family by Holm", e.p_holm)
                .put("cliffs_delta", "-", "Cliff's delta of the extreme arms, descriptive", e.cliffs_delta)
                .put(
                    "checks",
                    "ln N_eff",
                    "the effect as measured otherwise, and in how many blocks",
                    checks.as_str(),
                )
                .put("explanation", "-", "the rule that decided, with its numbers", a.explanation.as_str());
            row
        });
    Table { name: "claims", rows: rows.collect() }
}

/// `robustness`: one row for each claim under each variation.
pub fn robustness(judged: &[Judged]) -> Table {
    let rows = judged.iter().flat_map(|judged| {
        let primary = judged.variations.first().and_then(|first| first.reading.finding);
        judged.variations.iter().map(move |variation| {
            let reading = &variation.reading;
            let finding =
                reading.finding.map_or("open".to_string(), |finding| Verdict::from(finding).to_string());
            let agrees = reading.blocks >= CHECK_BLOCKS;
            let agrees = agrees.then_some(if reading.finding == primary { "yes" } else { "no" });
            let mut row = Row::default();
            row.put("family", "-", "claim or control", judged.family)
                .put("claim", "-", "id of the claim", judged.claim.id.as_str())
                .put("kind", "-", "what was varied", variation.kind.word())
                .put("variation", "-", "the variation in words", variation.name.as_str())
                .count("blocks", "complete blocks", reading.blocks as u64)
                .put("effect", "ln N_eff", "mean of d over blocks", reading.effect)
                .put("lower", "ln N_eff", "95 % limit, studentised", reading.interval.map(|i| i.lower))
                .put("upper", "ln N_eff", "95 % limit, studentised", reading.interval.map(|i| i.upper))
                .put("direction", "-", "beside the primary effect", reading.direction.to_string().as_str())
                .put("finding", "-", "what rules 3 and 4 would say of it alone at 95 %", finding.as_str())
                .put(
                    "agrees",
                    "-",
                    "whether that is what they say of the primary measurement",
                    agrees.unwrap_or_default(),
                );
            row
        })
    });
    Table { name: "robustness", rows: rows.collect() }
}

/// `replicates`: how many blocks a study to come needs, with this one as its pilot.
pub fn replicates(judged: &[Judged]) -> Table {
    let planned = judged.iter().filter_map(|judged| Some((judged, judged.assessment.replicates.as_ref()?)));
    let rows = planned.map(|(judged, plan)| {
        let mut row = Row::default();
        row.put("family", "-", "claim or control", judged.family)
            .put("claim", "-", "id of the claim", judged.claim.id.as_str())
            .count("pilot_blocks", "complete blocks here", judged.assessment.evidence.blocks as u64)
            .number("sd", "ln N_eff", "standard deviation of d over them", plan.pilot_deviation)
            .number("sd_upper", "ln N_eff", "its upper 80 % limit", plan.deviation_limit)
            .count("wanted", "blocks for 80 % power at a ratio of 1.5, family of five", plan.wanted as u64)
            .count("planned", "those held within 24 to 48", plan.blocks as u64)
            .number(
                "detectable",
                "-",
                "ratio of N_eff that the planned blocks detect with 80 % power",
                plan.detectable_ratio,
            );
        row
    });
    Table { name: "replicates", rows: rows.collect() }
}

/// `density_noise`: one row for each path of that control.
pub fn density_noise(noise: &[JudgedNoise]) -> Table {
    let rows = noise.iter().map(|JudgedNoise { arms, primary, assessment: a }| {
        let (lower, upper) = match a.set {
            Some(FiellerSet::Bounded(set)) => (Some(set.lower), Some(set.upper)),
            _ => (None, None),
        };
        let mut row = Row::default();
        row.put("noisy", "-", "arm: a lattice with noise on its particles", arms.noisy.as_str())
            .put("lattice", "-", "arm: the lattice", arms.lattice.as_str())
            .put("random", "-", "arm: random placement", arms.random.as_str())
            .put("primary", "-", "metric of the endpoint A, by the calibration", primary.to_string().as_str())
            .put("verdict", "-", "by the mechanical rule", a.verdict.to_string().as_str())
            .count("blocks", "complete blocks", a.blocks as u64)
            .put("ratio", "-", "q = (A_noisy - A_lattice) / (A_random - A_lattice), of the means", a.ratio)
            .put("lower", "-", "95 % limit by Fieller; empty where there is none", lower)
            .put("upper", "-", "95 % limit by Fieller; empty where there is none", upper);
        row
    });
    Table { name: "density_noise", rows: rows.collect() }
}
