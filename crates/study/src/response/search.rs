//! The least value of a function in a box, without derivatives.

/// First step, over the width of the box (chosen: a quarter, from which two halvings reach a sixteenth).
const FIRST: f64 = 0.25;
/// Last step, over the width.
const LAST: f64 = 2e-3;

/// Pattern search (Hooke & Jeeves 1961, J. ACM 8, 212): steps along each axis, then along the whole move, halved where nothing is gained. The place and the
/// value there.
pub(super) fn minimum(cost: impl Fn(&[f64]) -> f64, start: Vec<f64>, limits: &[[f64; 2]]) -> (Vec<f64>, f64) {
    let held =
        |x: Vec<f64>| -> Vec<f64> { x.iter().zip(limits).map(|(x, [a, b])| x.clamp(*a, *b)).collect() };
    let mut best = held(start);
    let mut least = cost(&best);
    let mut step = FIRST;
    while step > LAST {
        let (moved, found) = explore(&cost, best.clone(), least, step, limits);
        if found < least {
            let further = held(moved.iter().zip(&best).map(|(new, old)| 2.0 * new - old).collect());
            let beyond = cost(&further);
            (best, least) = (moved, found);
            let (moved, found) = explore(&cost, further, beyond, step, limits);
            if found < least {
                (best, least) = (moved, found);
            }
        } else {
            step *= 0.5;
        }
    }
    (best, least)
}

fn explore(
    cost: impl Fn(&[f64]) -> f64,
    mut x: Vec<f64>,
    mut least: f64,
    step: f64,
    limits: &[[f64; 2]],
) -> (Vec<f64>, f64) {
    for axis in 0..x.len() {
        let [low, high] = limits[axis];
        for side in [1.0, -1.0] {
            let mut tried = x.clone();
            tried[axis] = (tried[axis] + side * step * (high - low)).clamp(low, high);
            let found = cost(&tried);
            if found < least {
                (x, least) = (tried, found);
                break;
            }
        }
    }
    (x, least)
}

#[cfg(test)]
mod tests {
    use super::minimum;

    #[test]
    fn the_bottom_of_a_bowl_and_the_edge_of_a_slope_are_found() {
        let bowl = |x: &[f64]| (x[0] - 0.3).powi(2) + 10.0 * (x[1] + 0.2 * x[0]).powi(2);
        let (at, least) = minimum(bowl, vec![0.9, 0.9], &[[-1.0, 1.0]; 2]);
        assert!((at[0] - 0.3).abs() < 0.02 && (at[1] + 0.06).abs() < 0.02 && least < 1e-3, "{at:?}: {least}");
        let (at, _) = minimum(|x: &[f64]| -x[0], vec![0.0], &[[-1.0, 2.0]]);
        assert_eq!(at, [2.0]);
    }
}
