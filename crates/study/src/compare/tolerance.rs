//! Whether two entries are the same.

use super::Rules;

/// How far two entries may lie apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tolerance {
    /// Not at all: they are words.
    Words,
    /// Numbers by at most `absolute + relative max(|a|, |b|)`.
    Numbers { relative: f64, absolute: f64 },
}

/// How far two entries do lie apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Distance {
    /// One of them is not a number.
    Words,
    /// |a - b|, and that over max(|a|, |b|).
    Numbers { absolute: f64, relative: f64 },
}

impl Tolerance {
    /// That of a column.
    pub(super) fn of(column: &str, rules: &Rules) -> Self {
        let relative = rules.columns.get(column).copied().unwrap_or(rules.relative);
        Tolerance::Numbers { relative, absolute: rules.absolute }
    }

    /// How far two entries lie apart, where that is further than they may.
    pub(super) fn left(self, [a, b]: [&str; 2]) -> Option<Distance> {
        if a == b {
            return None;
        }
        let Tolerance::Numbers { relative, absolute } = self else { return Some(Distance::Words) };
        let (Some(x), Some(y)) = (number(a), number(b)) else { return Some(Distance::Words) };
        let largest = x.abs().max(y.abs());
        let apart = distance(a, b).unwrap_or((x - y).abs());
        // Divided first: what lies apart may be more than the greatest number there is.
        (apart > absolute + relative * largest)
            .then(|| Distance::Numbers { absolute: apart, relative: (x / largest - y / largest).abs() })
    }
}

impl Distance {
    /// What differences are ordered by. That of words is the greatest.
    pub(super) fn order(self) -> f64 {
        match self {
            Distance::Words => f64::INFINITY,
            Distance::Numbers { relative, .. } => relative,
        }
    }
}

/// A number that can be measured against another: an entry such as `inf` or `NaN` is a word.
fn number(entry: &str) -> Option<f64> {
    entry.parse::<f64>().ok().filter(|value| value.is_finite())
}

/// Between counts, which an f64 does not hold to the last digit.
fn distance(a: &str, b: &str) -> Option<f64> {
    let (a, b) = (a.parse::<i128>().ok()?, b.parse::<i128>().ok()?);
    Some(a.abs_diff(b) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_same(relative: f64, absolute: f64, a: &str, b: &str) -> bool {
        let both = [(a, b), (b, a)].map(|(a, b)| Tolerance::Numbers { relative, absolute }.left([a, b]));
        assert_eq!(both[0], both[1], "{a} and {b} the other way round");
        both[0].is_none()
    }

    #[test]
    fn without_a_tolerance_numbers_are_the_same_and_nothing_else() {
        for (a, b) in
            [("1", "1.0"), ("0.1", "1e-1"), ("0", "-0.0"), ("", ""), ("NaN", "NaN"), ("true", "true")]
        {
            assert!(is_same(0.0, 0.0, a, b), "{a} {b}");
        }
        let next = format!("{:?}", 0.1_f64.next_up());
        for (a, b) in [("0.1", next.as_str()), ("9007199254740992", "9007199254740993"), ("5e-324", "0")] {
            assert!(!is_same(0.0, 0.0, a, b), "{a} {b}");
        }
    }

    #[test]
    fn the_edge_of_a_tolerance_belongs_to_it() {
        assert!(is_same(0.0, 0.5, "1.0", "1.5") && !is_same(0.0, 0.5, "1.0", "1.5000000000000002"));
        assert!(is_same(0.5, 0.0, "1", "2") && !is_same(0.5, 0.0, "0.9999999", "2"));
        assert!(is_same(0.25, 0.5, "1", "2"), "0.5 + 0.25 * 2");
        // The larger of the two decides: zero and anything lie a whole apart.
        assert!(is_same(1.0, 0.0, "0", "1e300") && !is_same(0.999, 0.0, "0", "1e-300"));
    }

    #[test]
    fn no_tolerance_reaches_what_is_not_a_number() {
        for (a, b) in
            [("", "0"), ("", "1"), ("ok", "okay"), ("inf", "1"), ("NaN", "1"), ("inf", "-inf"), ("1", " 1")]
        {
            assert!(!is_same(1.0, 1e300, a, b), "{a} {b}");
        }
        assert_eq!(Tolerance::Words.left(["1", "1.0"]), Some(Distance::Words));
    }

    #[test]
    fn numbers_at_the_ends_of_the_range_have_a_distance() {
        let found = Tolerance::Numbers { relative: 0.0, absolute: 0.0 }.left(["1.7e308", "-1.7e308"]);
        assert_eq!(found.map(Distance::order), Some(2.0));
        assert!(!is_same(0.1, 0.0, "1e308", "-1e308"));
    }
}
