//! Families, scope conditions and the control of density noise.

use snowlab_study::claims::*;
use snowlab_study::statistics::FiellerSet;

use super::arms::*;

fn named(id: &str) -> Claim {
    Claim { id: id.into(), ..paired() }
}

#[test]
fn every_number_is_given_even_without_a_verdict() {
    let assessment = judged(&differing(&around(0.5, 0.1, 8)));
    assert_eq!(assessment.verdict, Verdict::NotRun(NotRun::TooFewBlocks { complete: 8 }));
    let e = &assessment.evidence;
    assert_eq!((e.blocks, e.effect, e.confidence), (8, Some(0.5), 0.99));
    // s = 0.1 sqrt(8/7); t(0.995, 7) = 3.4995, t(0.95, 7) = 1.8946.
    let error = 0.1 / 7.0_f64.sqrt();
    assert!((e.interval_t.unwrap().lower - (0.5 - 3.4995 * error)).abs() < 1e-5);
    assert!((e.upper_t.unwrap() - (0.5 + 1.8946 * error)).abs() < 1e-5);
    let bca = e.interval_bca.unwrap();
    // All resamples of 0.4 and 0.6 lie between the two, but for round-off.
    assert!(0.3999 < bca.lower && bca.lower < 0.45 && 0.55 < bca.upper && bca.upper < 0.6001);
    assert!(e.upper_bca.unwrap() < bca.upper);
    // All eight of one sign: two of 256 patterns.
    assert_eq!((e.p_value, e.cliffs_delta), (Some(2.0 / 256.0), Some(1.0)));
    let line = assessment.to_string();
    assert!(
        line.starts_with("coarse-breaks-more: not-run (n < 12); n = 8, d = 0.500, 99.0 % t [0.368, 0.632]")
    );
    assert!(line.ends_with("(8 complete blocks; a verdict takes 12)"), "{line}");
    // One block: an effect and nothing else.
    let single = judged(&differing(&[0.5])).evidence;
    assert_eq!((single.effect, single.interval_t, single.interval_bca), (Some(0.5), None, None));
}

#[test]
fn blocks_with_a_case_not_yet_run_are_counted_and_dropped() {
    let mut observations = differing(&around(1.0, 0.05, 14));
    observations.rows.retain(|row| row.block != 3 || row.arm != "5k");
    let assessment = judged(&observations);
    assert_eq!(
        (assessment.evidence.blocks, assessment.incomplete_blocks, assessment.lost_blocks),
        (13, 1, 0)
    );
    assert_eq!(assessment.verdict, Verdict::Supported);
}

#[test]
fn family_counts_ids_and_adjusts_by_holm() {
    let strong = || differing(&around(0.6, 0.1, 12));
    let none = || differing(&around(0.0, 0.1, 12));
    // Two paths of one id, so m = 3.
    let members =
        [(named("a"), strong()), (named("b"), none()), (named("b"), strong()), (named("c"), differing(&[]))];
    let family = assess_family(&members, RESAMPLING).unwrap();
    let confidences: Vec<f64> = family.iter().map(|a| a.evidence.confidence).collect();
    assert_eq!(confidences, [1.0 - 0.05 / 3.0; 4]);
    // a: 2/4096 x 3. b: the larger p of its paths, 1, for both. c: no p value.
    let p: Vec<Option<f64>> = family.iter().map(|a| a.evidence.p_holm).collect();
    assert_eq!(p, [Some(3.0 * 2.0 / 4096.0), Some(1.0), Some(1.0), None]);
}

#[test]
fn scope_conditions_read_same_opposite_or_undetermined() {
    let primary = rows(&around(0.5, 0.1, 24));
    let read = |differences: &[f64]| direction(&paired(), &primary, &rows(differences)).unwrap().direction;
    assert_eq!(read(&around(0.2, 0.1, 8)), Direction::Same);
    assert_eq!(read(&around(-0.2, 0.1, 8)), Direction::Opposite);
    assert_eq!(read(&around(0.05, 0.3, 8)), Direction::Undetermined);
    assert_eq!(read(&around(0.2, 0.1, 7)), Direction::Undetermined);
    // Against a primary effect of the other sign the same rows read the other way.
    let reversed = rows(&around(-0.5, 0.1, 24));
    let reading = direction(&paired(), &reversed, &rows(&around(0.2, 0.1, 8))).unwrap();
    assert_eq!((reading.direction, reading.blocks), (Direction::Opposite, 8));
    assert_eq!(reading.direction.to_string(), "opposite");
}

#[test]
fn density_noise_is_judged_by_the_ratio() {
    let arms = DensityNoise { noisy: "w".into(), lattice: "l".into(), random: "r".into() };
    let judged = |q: f64, noise: f64, blocks: usize| {
        let rows = around(1.0, noise, blocks)
            .iter()
            .enumerate()
            .flat_map(|(block, level)| {
                let lattice = 0.5 + 0.1 * (block % 3) as f64;
                [
                    case(block, "w", lattice + q * level),
                    case(block, "l", lattice),
                    case(block, "r", lattice + 2.0 - level),
                ]
            })
            .collect();
        density_noise(&arms, &observed(rows)).unwrap()
    };
    let good = judged(0.9, 0.1, 16);
    assert!((good.ratio.unwrap() - 0.9).abs() < 1e-12);
    let Some(FiellerSet::Bounded(set)) = good.set else { panic!("bounded") };
    assert!(set.contains(0.9));
    assert_eq!(good.verdict.to_string(), "supported");
    assert_eq!(judged(0.2, 0.1, 16).verdict.to_string(), "refuted (q < 0.5)");
    assert_eq!(judged(0.5, 0.1, 16).verdict.to_string(), "inconclusive (not resolved)");
    assert_eq!(judged(1.5, 0.1, 16).verdict.to_string(), "inconclusive (not resolved)");
    assert_eq!(judged(0.9, 3.0, 16).verdict.to_string(), "inconclusive (not resolved)");
    assert_eq!(judged(0.9, 0.1, 11).verdict.to_string(), "not-run (n < 12)");
}
