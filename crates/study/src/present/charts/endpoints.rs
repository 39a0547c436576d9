//! Every case's endpoints, and the sizes of its fragments.

use crate::figure::axis::Scale;
use crate::figure::sizes::{SizeArm, sizes};
use crate::figure::strips::{Endpoint, Strip, Strips, strips};
use crate::results::CaseResult;
use crate::tables::case_row;

use super::{Arms, Titled, drawn, summary};

pub(super) fn endpoints(arms: &Arms) -> anyhow::Result<Option<Titled>> {
    let shown = [
        ("ln_neff", "A = ln N_{eff}"),
        ("damage", "damage D"),
        ("fragments", "fragments N_{f}"),
        ("crack", "crack length [m]"),
    ];
    let values = |endpoint: &str| -> Vec<Vec<f64>> {
        let of =
            |cases: &Vec<&CaseResult>| cases.iter().filter_map(|r| case_row(r).value(endpoint)).collect();
        arms.cases.iter().map(of).collect()
    };
    let columns: Vec<Vec<Vec<f64>>> = shown.iter().map(|(endpoint, _)| values(endpoint)).collect();
    let strips_of: Vec<Vec<Strip>> = columns
        .iter()
        .map(|column| column.iter().map(|values| Strip { values, summary: summary(values) }).collect())
        .collect();
    let panels: Vec<Endpoint> = shown
        .iter()
        .zip(&strips_of)
        .map(|((_, label), strips)| Endpoint { label, scale: Scale::Linear, hold: &[], strips })
        .collect();
    let figure = Strips {
        title: "",
        arms: &arms.names(),
        endpoints: &panels,
        note: "every case a point; mean with its 95 % t interval",
    };
    Ok(drawn(strips(&figure))?.map(|drawing| Titled {
        name: "endpoints".into(),
        title: "Endpoints by arm".into(),
        caption: "Every case as a point, with the mean of the arm and its 95 % t interval.".into(),
        alternative: "Strips of every case's ln N_eff, damage, fragment count and crack length, one for each arm; the numbers are in the summary table.".into(),
        drawing,
    }))
}

pub(super) fn distributions(arms: &Arms) -> anyhow::Result<Option<Titled>> {
    let cases: Vec<Vec<&[f64]>> =
        (0..arms.cases.len()).map(|arm| arms.metrics(arm).map(|m| m.sizes.as_slice()).collect()).collect();
    let shown: Vec<SizeArm> =
        arms.labels.iter().zip(&cases).map(|(label, cases)| SizeArm { arm: label, cases }).collect();
    Ok(drawn(sizes("", &shown))?.map(|drawing| Titled {
        name: "fragment-sizes".into(),
        title: "Fragment sizes".into(),
        caption: "Share of the fragments that weigh at least m, against m over the mass of the ball: mean over cases, band from the 10 % to the 90 % quantile.".into(),
        alternative: "Complementary cumulative distributions of fragment mass, one curve for each arm.".into(),
        drawing,
    }))
}
