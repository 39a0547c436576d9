//! Error rates of the whole rule: normal differences, checks that repeat the primary measurement (so that rule 6
//! gives no protection), 2000 draws each.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use snowlab_study::claims::*;
use snowlab_study::statistics::normal_quantile;

use super::arms::*;

const DRAWS: usize = 2000;

/// Shares of `supported` and `refuted` among verdicts on 24 blocks of d ~ N(mean, spread).
fn shares(mean: f64, spread: f64, family_size: usize) -> (f64, f64) {
    let mut rng = ChaCha8Rng::seed_from_u64(2017);
    let quick = Resampling { seed: 1, resamples: 1000, sign_flips: 1, permutations: 1 };
    let (mut supported, mut refuted) = (0, 0);
    for _ in 0..DRAWS {
        let d: Vec<f64> =
            (0..24).map(|_| mean + spread * normal_quantile(rng.random_range(1e-12..1.0 - 1e-12))).collect();
        match assess(&paired(), &differing(&d), family_size, quick).unwrap().verdict {
            Verdict::Supported => supported += 1,
            Verdict::Refuted(_) => refuted += 1,
            _ => {}
        }
    }
    (f64::from(supported) / DRAWS as f64, f64::from(refuted) / DRAWS as f64)
}

/// Two standard errors of a share over the draws.
fn slack(share: f64) -> f64 {
    2.0 * (share * (1.0 - share) / DRAWS as f64).sqrt()
}

#[test]
fn no_effect_is_rarely_supported() {
    // A two-sided interval at 1 - 0.05/m lies above 0 in 2.5 %/m of draws under the null; asking also for a mean of
    // at least delta, and for BCa to agree, can only lower that (20,000 draws: 2.1 % and 0.46 %).
    for family_size in [1, 5] {
        let (supported, _) = shares(0.0, 0.6, family_size);
        let nominal = 0.025 / family_size as f64;
        assert!(supported > 0.0 && supported <= nominal + slack(nominal), "m {family_size}: {supported}");
    }
}

#[test]
fn an_effect_of_delta_is_rarely_refuted() {
    // U is a one-sided 95 % bound: it falls below d = delta in 5 % of draws (20,000 draws: 4.6 %).
    let (_, refuted) = shares(smallest_effect(), 0.4, 5);
    assert!(refuted > 0.0 && refuted <= 0.05 + slack(0.05), "refuted {refuted}");
}

#[test]
fn clear_effects_get_their_answer() {
    // d = ln 2 at a spread of 0.6: t = 5.7 on average; d = 0 at a spread of 0.3: delta is 3.6 standard errors off.
    let (supported, refuted) = shares(2.0_f64.ln(), 0.6, 5);
    assert!(supported > 0.95 && refuted == 0.0, "supported {supported}, refuted {refuted}");
    let (supported, refuted) = shares(0.0, 0.3, 5);
    assert!(refuted > 0.90 && supported < 0.002, "supported {supported}, refuted {refuted}");
}
