//! The sizes of all fragments.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use snowlab_study::figure::sizes::{SizeArm, sizes};

use super::{ARMS, keep};

#[test]
fn sizes_take_the_fragments_of_every_case() {
    let mut rng = ChaCha8Rng::seed_from_u64(11);
    let mut case = |arm: usize| -> Vec<f64> {
        let mut rest = 1.0_f64;
        let mut shares: Vec<f64> = (0..4 + 8 * arm)
            .map(|_| {
                let share = rest * rng.random_range(0.05..0.6);
                rest -= share;
                share.max(0.002)
            })
            .collect();
        shares.push(rest.max(0.002));
        shares
    };
    let made: Vec<Vec<Vec<f64>>> = (0..4).map(|arm| (0..24).map(|_| case(arm)).collect()).collect();
    let slices: Vec<Vec<&[f64]>> = made.iter().map(|arm| arm.iter().map(Vec::as_slice).collect()).collect();
    let arms: Vec<_> = slices.iter().zip(ARMS).map(|(cases, arm)| SizeArm { arm, cases }).collect();
    keep("sizes", &sizes("Sizes of fragments", &arms).expect("the data is sound"));
}
