//! The calibration by stretch: when does an unbroken placement read as broken?

use crate::evaluate::stretched_arms;
use crate::figure::axis::Scale;
use crate::figure::curves::{Curve, Curves, Quantity, Spread, curves};
use crate::metrics::calibration::WHOLE_SHARE;

use super::curves::Band;
use super::{Findings, Titled, drawn};

pub(super) fn stretch(findings: Findings) -> anyhow::Result<Option<Titled>> {
    let (count, arms) = stretched_arms(findings.archive, findings.results)?;
    let bands: Vec<(String, Band)> = arms
        .iter()
        .filter(|arm| !arm.blocks.is_empty())
        .map(|arm| {
            let x: Vec<f64> = arm.blocks[0].iter().map(|(stretch, _)| *stretch).collect();
            let shares: Vec<Vec<f64>> =
                arm.blocks.iter().map(|block| block.iter().map(|(_, share)| *share).collect()).collect();
            (findings.archive.study.label(&arm.arm), Band::of(&x, &shares))
        })
        .collect();
    let shown: Vec<Curve> = bands.iter().map(|(label, band)| band.curve(label)).collect();
    let quantities = [Quantity {
        label: "largest share M_{1}/M",
        scale: Scale::Linear,
        hold: &[0.0, 1.0],
        level: Some((WHOLE_SHARE, "reads as whole above")),
        guides: &[],
        curves: &shown,
    }];
    let figure = Curves {
        title: "",
        x_label: "uniaxial stretch of the placement at t = 0",
        x_scale: Scale::Logarithmic,
        mark: None,
        spread: Spread::Band,
        note: "median over up to three blocks, band from the 10 % to the 90 % quantile",
        quantities: &quantities,
    };
    Ok(drawn(curves(&figure))?.map(|drawing| Titled {
        name: "calibration".into(),
        title: "Calibration by stretch".into(),
        caption: format!("Share of the largest fragment that friends-of-friends sees when the placement at t = 0, thinned to {count} particles, is stretched and nothing tears. Arms of a claim that seem to fall apart at stretches over 15 % apart are compared by flood fill instead."),
        alternative: "Curves of the largest share against the stretch, one for each arm compared; the stretches at which each falls apart stand with the verdicts.".into(),
        drawing,
    }))
}
