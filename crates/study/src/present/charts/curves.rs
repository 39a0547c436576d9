//! Curves over the link, over time and over the particle number.

use crate::claims::Contrast;
use crate::figure::axis::Scale;
use crate::figure::curves::{Curve, Curves, Quantity, Spread, curves};
use crate::figure::strips::Summary;
use crate::measure::{Metrics, SeriesRow};
use crate::statistics::quantile;
use crate::tables::usable;

use super::{Arms, Findings, Titled, drawn, summary};

pub(super) fn links(findings: Findings, arms: &Arms) -> anyhow::Result<Option<Titled>> {
    let link = |m: &Metrics| m.link_curve.iter().map(|row| row.0).collect();
    let components = bands(arms, link, |m| m.link_curve.iter().map(|row| row.1 as f64).collect());
    let ln_neff = bands(arms, link, |m| m.link_curve.iter().map(|row| row.3).collect());
    let (components, ln_neff) = (named(arms, &components), named(arms, &ln_neff));
    let quantities = [
        Quantity {
            label: "components N",
            scale: Scale::Logarithmic,
            hold: &[1.0],
            level: None,
            guides: &[],
            curves: &components,
        },
        Quantity {
            label: "A = ln N_{eff}",
            scale: Scale::Linear,
            hold: &[0.0],
            level: None,
            guides: &[],
            curves: &ln_neff,
        },
    ];
    let figure = Curves {
        title: "",
        x_label: "link / h",
        x_scale: Scale::Linear,
        mark: Some((findings.archive.study.measure.link_ratio, "link used")),
        spread: Spread::Band,
        note: "median over cases, band from the 10 % to the 90 % quantile",
        quantities: &quantities,
    };
    Ok(drawn(curves(&figure))?.map(|drawing| Titled {
        name: "link-curves".into(),
        title: "Components against the link".into(),
        caption: "All components, and ln N_eff, at the end of the run for every link from 0.5 h to 4 h. Where the curve is flat, the count does not hang on the ruler.".into(),
        alternative: "Curves of the number of components and of ln N_eff against the link, one for each arm.".into(),
        drawing,
    }))
}

pub(super) fn histories(arms: &Arms) -> anyhow::Result<Option<Titled>> {
    // Frames before contact differ in number between cases; from contact on they are at the same times.
    let after = |m: &Metrics, pick: fn(&SeriesRow) -> f64| -> Vec<f64> {
        m.series.iter().filter(|row| row.since_contact > 0.0).map(pick).collect()
    };
    let time = |m: &Metrics| after(m, |row| row.since_contact);
    let count = bands(arms, time, |m| after(m, |row| row.fragments.fragments as f64));
    let largest = bands(arms, time, |m| after(m, |row| 1.0 - row.fragments.damage));
    let (count, largest) = (named(arms, &count), named(arms, &largest));
    let quantities = [
        Quantity {
            label: "fragments N_{f}",
            scale: Scale::Linear,
            hold: &[0.0],
            level: None,
            guides: &[],
            curves: &count,
        },
        Quantity {
            label: "largest share M_{1}/M",
            scale: Scale::Linear,
            hold: &[1.0],
            level: None,
            guides: &[],
            curves: &largest,
        },
    ];
    let figure = Curves {
        title: "",
        x_label: "time since contact [R/v]",
        x_scale: Scale::Linear,
        mark: None,
        spread: Spread::Band,
        note: "median over cases, band from the 10 % to the 90 % quantile",
        quantities: &quantities,
    };
    Ok(drawn(curves(&figure))?.map(|drawing| Titled {
        name: "fragments-over-time".into(),
        title: "Fragments over time".into(),
        caption:
            "Number of fragments and share of the largest from first contact to the time of the measurement."
                .into(),
        alternative: "Curves of the fragment count and of the largest share against time, one for each arm."
            .into(),
        drawing,
    }))
}

/// Means of A over the particle numbers of the first trend that is claimed.
pub(super) fn trend(findings: Findings) -> anyhow::Result<Option<Titled>> {
    let trends = findings.archive.study.spec.claim.iter().filter_map(|claim| match &claim.contrast {
        Contrast::Trend { arms } => Some(arms),
        _ => None,
    });
    let Some(trend) = trends.into_iter().next() else { return Ok(None) };
    let mut points: Vec<(f64, Summary)> = Vec::new();
    for arm in trend {
        let cases = findings.results.iter().filter(|r| r.case.arm == arm.arm && usable(r));
        let values: Vec<f64> = cases.filter_map(|r| Some(r.metrics.as_ref()?.end.ln_neff)).collect();
        points.extend(summary(&values).map(|s| (arm.particles, s)));
    }
    let column = |pick: fn(&(f64, Summary)) -> f64| points.iter().map(pick).collect::<Vec<f64>>();
    let (x, middle, low, high) =
        (column(|p| p.0), column(|p| p.1.mean), column(|p| p.1.low), column(|p| p.1.high));
    let curve = [Curve { arm: "random", x: &x, middle: &middle, low: &low, high: &high }];
    let quantities = [Quantity {
        label: "A = ln N_{eff}",
        scale: Scale::Linear,
        hold: &[0.0],
        level: None,
        guides: &[],
        curves: &curve,
    }];
    let figure = Curves {
        title: "",
        x_label: "particles N",
        x_scale: Scale::Logarithmic,
        mark: None,
        spread: Spread::Bars,
        note: "all particles, no thinning; mean with its 95 % t interval",
        quantities: &quantities,
    };
    if points.is_empty() {
        return Ok(None);
    }
    Ok(drawn(curves(&figure))?.map(|drawing| Titled {
        name: "particle-number".into(),
        title: "Fragmentation against particle number".into(),
        caption:
            "Random placement at one grid spacing: mean of ln N_eff over blocks with its 95 % t interval."
                .into(),
        alternative: "Mean ln N_eff of random placement against the number of particles, with intervals."
            .into(),
        drawing,
    }))
}

/// Median and 10 % and 90 % quantiles over cases at each abscissa.
pub(super) struct Band {
    x: Vec<f64>,
    middle: Vec<f64>,
    low: Vec<f64>,
    high: Vec<f64>,
}

impl Band {
    /// `rows` are cases, each a value at each abscissa; as many abscissae are used as all cases have.
    pub(super) fn of(x: &[f64], rows: &[Vec<f64>]) -> Self {
        let length = rows.iter().map(Vec::len).min().unwrap_or(0).min(x.len());
        let at = |share: f64| -> Vec<f64> {
            let column = |k: usize| rows.iter().map(|row| row[k]).collect::<Vec<_>>();
            (0..length).map(|k| quantile(&column(k), share).unwrap_or(f64::NAN)).collect()
        };
        Band { x: x[..length].to_vec(), middle: at(0.5), low: at(0.1), high: at(0.9) }
    }

    pub(super) fn curve<'a>(&'a self, arm: &'a str) -> Curve<'a> {
        Curve { arm, x: &self.x, middle: &self.middle, low: &self.low, high: &self.high }
    }
}

fn bands(arms: &Arms, x: impl Fn(&Metrics) -> Vec<f64>, y: impl Fn(&Metrics) -> Vec<f64>) -> Vec<Band> {
    (0..arms.cases.len())
        .map(|arm| {
            let rows: Vec<Vec<f64>> = arms.metrics(arm).map(&y).collect();
            let axis = arms.metrics(arm).map(&x).min_by_key(Vec::len).unwrap_or_default();
            Band::of(&axis, &rows)
        })
        .collect()
}

fn named<'a>(arms: &'a Arms, bands: &'a [Band]) -> Vec<Curve<'a>> {
    arms.labels.iter().zip(bands).map(|(label, band)| band.curve(label)).collect()
}
