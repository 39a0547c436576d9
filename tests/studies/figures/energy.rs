//! Stacked parts of the energy over time.

use snowlab_study::figure::energy::{Energy, EnergyCase, energy};

use super::{ARMS, keep};

#[test]
fn energy_stacks_parts() {
    let time: Vec<f64> = (0..80).map(|k| f64::from(k) * 0.09).collect();
    let fall = |t: f64, rate: f64| (-(t - 1.0).max(0.0) * rate).exp();
    let made: Vec<Vec<Vec<f64>>> = (0..4)
        .map(|arm| {
            let rate = 0.7 + 0.2 * f64::from(arm);
            let kinetic: Vec<f64> = time.iter().map(|t| fall(*t, rate)).collect();
            let elastic: Vec<f64> =
                time.iter().map(|t| 0.2 * (fall(*t, rate) - fall(*t, 3.0 * rate))).collect();
            let lost: Vec<f64> = kinetic.iter().zip(&elastic).map(|(k, e)| 1.0 - k - e).collect();
            let part = |share: f64| lost.iter().map(|v| v * share).collect::<Vec<_>>();
            vec![kinetic.clone(), elastic.clone(), part(0.5), part(0.2), part(0.3)]
        })
        .collect();
    let slices: Vec<Vec<&[f64]>> = made.iter().map(|case| case.iter().map(Vec::as_slice).collect()).collect();
    let cases: Vec<_> =
        slices.iter().zip(ARMS).map(|(parts, arm)| EnergyCase { arm, time: &time, parts }).collect();
    let figure = Energy {
        title: "Where the energy of impact goes",
        x_label: "time after contact [R/v]",
        y_label: "share of the energy at contact",
        parts: &["kinetic", "elastic", "lost to plastic flow", "lost to friction", "lost to the transfer"],
        cases: &cases,
        note: "One case per arm (block 1).",
    };
    keep("energy", &energy(&figure).expect("the data is sound"));
}
