use rand::{Rng, RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Most blocks for which all sign patterns are enumerated: 2^16 patterns.
const EXACT_BLOCKS: usize = 16;

/// Relative slack within which a permuted statistic counts as large as the observed one (round-off of ties).
const TIE: f64 = 1e-12;

/// Two-sided sign-flip permutation p value of the hypothesis that the paired differences are symmetric about
/// zero (Fisher 1935, The Design of Experiments, sec. 21): the share of sign patterns whose |sum| is at least
/// the observed one.
///
/// Exact over all 2^n patterns for n <= 16; beyond that `draws` patterns of ChaCha8 seeded by `seed`, with
/// (count + 1)/(draws + 1) (Davison & Hinkley 1997, eq. 4.11). `None` for no differences.
pub fn sign_flip_p(differences: &[f64], draws: usize, seed: u64) -> Option<f64> {
    if differences.is_empty() {
        return None;
    }
    let scale: f64 = differences.iter().map(|d| d.abs()).sum();
    let observed = differences.iter().sum::<f64>().abs() - TIE * scale;
    let as_large = |signs: &[u64]| signed_sum(differences, signs).abs() >= observed;
    if differences.len() <= EXACT_BLOCKS {
        let patterns = 1_u64 << differences.len();
        let count = (0..patterns).filter(|&signs| as_large(&[signs])).count();
        return Some(count as f64 / patterns as f64);
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut signs = vec![0_u64; differences.len().div_ceil(64)];
    let count = (0..draws)
        .filter(|_| {
            signs.fill_with(|| rng.next_u64());
            as_large(&signs)
        })
        .count();
    Some((count + 1) as f64 / (draws + 1) as f64)
}

/// Sum of the differences, each negated where its bit of `signs` is set.
fn signed_sum(differences: &[f64], signs: &[u64]) -> f64 {
    differences
        .iter()
        .enumerate()
        .map(|(index, d)| if signs[index / 64] >> (index % 64) & 1 == 1 { -d } else { *d })
        .sum()
}

/// Largest minus smallest of the arm means; `rows` has one row per block with one value per arm. `None` for no
/// rows or no arms.
///
/// # Panics
/// If the rows differ in length.
pub fn range_of_means<R: AsRef<[f64]>>(rows: &[R]) -> Option<f64> {
    let arms = rows.first()?.as_ref().len();
    let mut sums = vec![0.0; arms];
    for row in rows {
        assert_eq!(row.as_ref().len(), arms, "range_of_means: every block needs one value per arm");
        sums.iter_mut().zip(row.as_ref()).for_each(|(sum, value)| *sum += value);
    }
    let largest = sums.iter().copied().reduce(f64::max)?;
    let smallest = sums.iter().copied().reduce(f64::min)?;
    Some((largest - smallest) / rows.len() as f64)
}

/// Permutation p value of the range of the arm means: within each block the values are dealt to the arms at
/// random, `draws` times, from ChaCha8 seeded by `seed`; (count + 1)/(draws + 1) (Davison & Hinkley 1997,
/// eq. 4.11). `None` for no rows or no arms.
///
/// # Panics
/// If the rows differ in length.
pub fn range_permutation_p(rows: &[Vec<f64>], draws: usize, seed: u64) -> Option<f64> {
    let scale = rows.iter().flatten().fold(0.0_f64, |largest, value| largest.max(value.abs()));
    let observed = range_of_means(rows)? - TIE * scale;
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut dealt = rows.to_vec();
    let mut count = 0;
    for _ in 0..draws {
        dealt.iter_mut().for_each(|row| shuffle(row, &mut rng));
        count += usize::from(range_of_means(&dealt)? >= observed);
    }
    Some((count + 1) as f64 / (draws + 1) as f64)
}

/// Fisher-Yates shuffle (Knuth, The Art of Computer Programming, vol. 2, algorithm 3.4.2 P).
fn shuffle(row: &mut [f64], rng: &mut ChaCha8Rng) {
    for last in (1..row.len()).rev() {
        row.swap(last, rng.random_range(0..=last as u32) as usize);
    }
}
