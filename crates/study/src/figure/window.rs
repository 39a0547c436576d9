//! Which part of space the panels of particles show, and what of a thing lies in it.

use super::axis::Axis;
use super::snowballs::Snapshot;

/// Share of the particles in fragments that may lie outside the window on each side (chosen: as for dust).
const OUTSIDE: f64 = 0.0005;

/// Positions of the particles that belong to fragments; of all particles if none does. Specks of dust fly far and
/// must not shrink the rest.
pub(super) fn in_fragments(snapshot: &Snapshot<'_>) -> Vec<[f64; 2]> {
    let paired = snapshot.positions.iter().zip(snapshot.fragments);
    let kept: Vec<_> = paired.filter(|(_, rank)| rank.is_some()).map(|(p, _)| *p).collect();
    if kept.is_empty() { snapshot.positions.to_vec() } else { kept }
}

/// Lower left and upper right corner of a box round all but [`OUTSIDE`] of each list of points; `None` without any.
pub(super) fn window(lists: &[Vec<[f64; 2]>]) -> Option<([f64; 2], [f64; 2])> {
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for list in lists {
        for axis in 0..2 {
            let mut values: Vec<f64> = list.iter().map(|p| p[axis]).filter(|v| v.is_finite()).collect();
            values.sort_by(f64::total_cmp);
            let Some(last) = values.len().checked_sub(1) else { continue };
            let cut = (OUTSIDE * values.len() as f64) as usize;
            low[axis] = low[axis].min(values[cut]);
            high[axis] = high[axis].max(values[last - cut]);
        }
    }
    (low[0] <= high[0] && low[1] <= high[1]).then_some((low, high))
}

/// Whether a particle's centre lies in what the axes show.
pub(super) fn inside(axes: &[Axis; 2], position: [f64; 2]) -> bool {
    (0..2).all(|k| (axes[k].low..=axes[k].high).contains(&position[k]))
}

/// The part of a polygon that the axes show (Sutherland & Hodgman 1974: cut by one edge of the view at a time);
/// plotters would pull corners outside onto the edge and bend the sides.
pub(super) fn within(axes: &[Axis; 2], polygon: &[[f64; 2]]) -> Vec<(f64, f64)> {
    let mut kept = polygon.to_vec();
    for (k, edge, sign) in
        [(0, axes[0].low, 1.0), (0, axes[0].high, -1.0), (1, axes[1].low, 1.0), (1, axes[1].high, -1.0)]
    {
        let depth = |p: [f64; 2]| sign * (p[k] - edge);
        let mut cut = Vec::new();
        for (a, b) in kept.iter().copied().zip(kept.iter().copied().cycle().skip(1)) {
            if depth(a) >= 0.0 {
                cut.push(a);
            }
            if (depth(a) < 0.0) != (depth(b) < 0.0) {
                let share = depth(a) / (depth(a) - depth(b));
                let mut crossing = [0, 1].map(|k| a[k] + share * (b[k] - a[k]));
                // To the last bit: who asks what the view has cut compares.
                crossing[k] = edge;
                cut.push(crossing);
            }
        }
        kept = cut;
    }
    kept.into_iter().map(Into::into).collect()
}
