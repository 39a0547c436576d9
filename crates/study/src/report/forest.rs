//! The plot on a verdict's card: effect and interval on an axis that all cards share.

use serde::Serialize;

use super::data::{EffectSize, ReportData};

/// Width of a plot [user units].
const WIDTH: f64 = 300.0;
/// Space left free at both ends (chosen: a mark at the end is seen whole).
const MARGIN: f64 = 10.0;
/// How far the axis reaches at least, over the smallest effect of interest (chosen: the zone is seen to end).
const BEYOND: f64 = 1.5;

/// Places along a plot [user units], with a digit after the point.
#[derive(Debug, PartialEq, Serialize)]
pub(super) struct Plot {
    /// Place of no effect.
    zero: String,
    /// Where effects that are too small to matter begin, and how wide their zone is; empty without a smallest effect.
    zone: Option<[String; 2]>,
    lower: String,
    upper: String,
    effect: String,
}

/// The plot of each verdict; none where no effect was estimated.
pub(super) fn plots(data: &ReportData) -> Vec<Option<Plot>> {
    let sizes = || data.verdicts.iter().map(|verdict| verdict.size.filter(is_finite));
    let delta = data.smallest_effect;
    let ends = sizes().flatten().flat_map(|size| [size.lower, size.effect, size.upper]);
    let (low, high) = ends
        .chain([-BEYOND * delta, BEYOND * delta])
        .fold((0.0_f64, 0.0_f64), |(low, high), end| (low.min(end), high.max(end)));
    let scale = (WIDTH - 2.0 * MARGIN) / (high - low).max(f64::MIN_POSITIVE);
    let place = |value: f64| format!("{:.1}", MARGIN + scale * (value - low));
    let plot = |size: EffectSize| Plot {
        zero: place(0.0),
        zone: (delta > 0.0).then(|| [place(-delta), format!("{:.1}", 2.0 * delta * scale)]),
        lower: place(size.lower),
        upper: place(size.upper),
        effect: place(size.effect),
    };
    sizes().map(|size| size.map(plot)).collect()
}

fn is_finite(size: &EffectSize) -> bool {
    [size.effect, size.lower, size.upper].iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::super::ReportVerdict;
    use super::*;

    fn data(sizes: &[Option<[f64; 3]>], smallest_effect: f64) -> ReportData {
        let size = |[lower, effect, upper]: [f64; 3]| EffectSize { effect, lower, upper };
        let verdict = |s: &Option<[f64; 3]>| ReportVerdict { size: s.map(size), ..ReportVerdict::default() };
        ReportData { verdicts: sizes.iter().map(verdict).collect(), smallest_effect, ..ReportData::default() }
    }

    #[test]
    fn all_plots_share_one_axis() {
        let plots = plots(&data(&[Some([-1.0, 0.0, 1.0]), None, Some([0.0, 1.0, 1.8])], 0.5));
        let [first, none, last] = &plots[..] else { panic!("a plot each") };
        assert!(none.is_none());
        let (first, last) = (first.as_ref().unwrap(), last.as_ref().unwrap());
        assert_eq!(
            (first.lower.as_str(), first.effect.as_str(), first.upper.as_str()),
            ("10.0", "110.0", "210.0")
        );
        assert_eq!((last.lower.as_str(), last.upper.as_str()), ("110.0", "290.0"));
        assert_eq!(first.zone, Some(["60.0".to_string(), "100.0".to_string()]));
    }

    #[test]
    fn numbers_that_are_none_have_no_plot_and_spoil_no_other() {
        let plots = plots(&data(&[Some([f64::NAN, 0.0, 1.0]), Some([-1.0, 0.0, 1.0])], 0.0));
        assert!(plots[0].is_none());
        let plot = plots[1].as_ref().unwrap();
        assert_eq!((plot.lower.as_str(), plot.zero.as_str(), plot.zone.is_none()), ("10.0", "150.0", true));
    }
}
