//! Constructed observations that the tests share.

use std::collections::BTreeMap;

use snowlab_study::claims::*;

pub const RESAMPLING: Resampling =
    Resampling { seed: 7, resamples: 2000, sign_flips: 2000, permutations: 2000 };

pub fn paired() -> Claim {
    Claim {
        id: "coarse-breaks-more".into(),
        sentence: "5k random points break into more pieces than 30k".into(),
        contrast: Contrast::Paired { treated: "5k".into(), control: "30k".into() },
        largest_spacing: None,
    }
}

/// A case without fault.
pub fn case(block: usize, arm: &str, value: f64) -> ArmValue {
    ArmValue {
        block: block as u64,
        arm: arm.into(),
        value,
        status: CaseStatus::Ok,
        settled: true,
        damage: 0.3,
        damping: 50.0,
    }
}

/// One block per difference: treated 1 + d, control 1.
pub fn rows(differences: &[f64]) -> Vec<ArmValue> {
    differences
        .iter()
        .enumerate()
        .flat_map(|(block, d)| [case(block, "5k", 1.0 + d), case(block, "30k", 1.0)])
        .collect()
}

/// `blocks` differences of the given mean, alternately `spread` above and below it.
pub fn around(mean: f64, spread: f64, blocks: usize) -> Vec<f64> {
    (0..blocks).map(|block| mean + if block % 2 == 0 { spread } else { -spread }).collect()
}

/// Observations in which every check repeats the primary measurement.
pub fn observed(rows: Vec<ArmValue>) -> Observations {
    let checks: BTreeMap<_, _> = Check::ALL.into_iter().map(|check| (check, rows.clone())).collect();
    Observations { rows, conditions: Conditions::MET, checks }
}

/// Observations with given differences and checks that repeat them.
pub fn differing(differences: &[f64]) -> Observations {
    observed(rows(differences))
}

/// Assessment in a family of five.
pub fn judged(observations: &Observations) -> Assessment {
    assess(&paired(), observations, 5, RESAMPLING).unwrap()
}
