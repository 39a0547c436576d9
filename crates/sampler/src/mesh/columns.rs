//! What a surface encloses more than once or the wrong way round, along vertical lines.

use super::Point;
use super::tree::Tree;

/// Lines along each axis. Chosen: overlaps as wide as 1/256 of the mesh are seen, in less than a tenth of a second
/// (measured at 80 thousand triangles).
const LINES: usize = 256;

/// What the lines found.
pub struct Found {
    /// Volume enclosed less that of the solid: what parts have in common counts again for each, what faces inwards less.
    pub excess: f64,
    /// Volume round which the surface winds the wrong way.
    pub inside_out: f64,
    /// Middle of the longest stretch of that.
    pub at: Point,
}

/// Follows lines through the middles of equal cells of the box about `tree`.
pub fn measure(tree: &Tree) -> Found {
    let bounds = tree.bounds();
    let cell = (bounds.max - bounds.min) / LINES as f64;
    let mut found = Found { excess: 0.0, inside_out: 0.0, at: Point::zeros() };
    let (mut crossings, mut longest) = (Vec::new(), 0.0);
    for number in 0..LINES * LINES {
        let steps = Point::new((number % LINES) as f64 + 0.5, (number / LINES) as f64 + 0.5, 0.0);
        let point = bounds.min + cell.component_mul(&steps);
        crossings.clear();
        tree.crossings(&point, &mut crossings);
        crossings.sort_unstable_by(|a, b| b.0.total_cmp(&a.0).then(b.1.cmp(&a.1)));
        let mut winding = 0;
        for pair in crossings.windows(2) {
            winding += pair[0].1;
            let length = pair[0].0 - pair[1].0;
            found.excess += f64::from(winding - i32::from(winding >= 1)) * length;
            if winding < 0 {
                found.inside_out += f64::from(-winding) * length;
                if length > longest {
                    longest = length;
                    found.at = Point::new(point.x, point.y, pair[1].0 + 0.5 * length);
                }
            }
        }
    }
    found.excess *= cell.x * cell.y;
    found.inside_out *= cell.x * cell.y;
    found
}
