//! The nearest of many points.

use std::collections::HashMap;

/// Points in square cells, about one to a cell.
pub struct Nearest<'a, const D: usize> {
    points: &'a [[f32; D]],
    side: f64,
    cells: HashMap<[i64; D], Vec<u32>>,
}

impl<'a, const D: usize> Nearest<'a, D> {
    /// Sorts `points` [m], which fill a box of these extents [m].
    pub fn new(points: &'a [[f32; D]], extents: [f64; D]) -> Self {
        let volume: f64 = extents.iter().product();
        let side = libm::pow(volume / points.len().max(1) as f64, 1.0 / D as f64).max(f64::MIN_POSITIVE);
        let mut cells: HashMap<[i64; D], Vec<u32>> = HashMap::new();
        for (index, point) in points.iter().enumerate() {
            cells.entry(cell(point, side)).or_default().push(index as u32);
        }
        Nearest { points, side, cells }
    }

    /// The index of the point nearest to `x` [m], the first of several; `None` without points.
    pub fn of(&self, x: &[f32; D]) -> Option<usize> {
        if self.points.is_empty() {
            return None;
        }
        let centre = cell(x, self.side);
        let mut best: Option<(f64, u32)> = None;
        for ring in 0_i64.. {
            // What lies in the next ring is at least so far away.
            if best.is_some_and(|(square, _)| square <= ((ring - 1).max(0) as f64 * self.side).powi(2)) {
                break;
            }
            for cell in shell(centre, ring) {
                for &index in self.cells.get(&cell).into_iter().flatten() {
                    let point = self.points[index as usize];
                    let square = (0..D).map(|k| (f64::from(point[k]) - f64::from(x[k])).powi(2)).sum();
                    if best.is_none_or(|least| (square, index) < least) {
                        best = Some((square, index));
                    }
                }
            }
        }
        best.map(|(_, index)| index as usize)
    }
}

fn cell<const D: usize>(point: &[f32; D], side: f64) -> [i64; D] {
    point.map(|x| (f64::from(x) / side).floor() as i64)
}

/// The cells whose greatest offset from `centre` is `ring`.
fn shell<const D: usize>(centre: [i64; D], ring: i64) -> impl Iterator<Item = [i64; D]> {
    let width = 2 * ring + 1;
    (0..width.pow(D as u32)).filter_map(move |number| {
        let offset: [i64; D] = std::array::from_fn(|k| number / width.pow(k as u32) % width - ring);
        let is_outermost = offset.iter().any(|o| o.abs() == ring);
        is_outermost.then(|| std::array::from_fn(|k| centre[k] + offset[k]))
    })
}

#[cfg(test)]
mod tests {
    use super::Nearest;

    #[test]
    fn the_nearest_is_that_of_a_search_of_all() {
        // Multiples of irrational numbers fill the square evenly, but for a corner that is left empty.
        let spread = |k: usize| [0.754_877_7, 0.569_840_3].map(|step: f32| (k as f32 * step).fract());
        let points: Vec<[f32; 2]> = (1..400).map(spread).filter(|p| p[0] + p[1] > 0.5).collect();
        let nearest = Nearest::new(&points, [1.0, 1.0]);
        for x in (1000..1200).map(spread).chain([[0.0, 0.0], [-2.0, 3.0]]) {
            let square =
                |p: &[f32; 2]| (0..2).map(|k| (f64::from(p[k]) - f64::from(x[k])).powi(2)).sum::<f64>();
            let least = points.iter().map(square).fold(f64::INFINITY, f64::min);
            assert_eq!(square(&points[nearest.of(&x).unwrap()]), least, "{x:?}");
        }
        assert_eq!(Nearest::<3>::new(&[], [1.0; 3]).of(&[0.0; 3]), None);
    }
}
