//! Cholesky's factorisation of a sparse, positive definite matrix whose rows are kept from their first entry to the diagonal, and an order
//! of the unknowns that keeps them short (George & Liu, Computer Solution of Large Sparse Positive Definite Systems, 1981, chapter 4).

/// A symmetric matrix, or its factor L.
#[derive(Clone, Debug)]
pub(crate) struct Skyline {
    /// Of every row the column of its first entry, and where in `entries` column 0 would be.
    first: Vec<usize>,
    begin: Vec<usize>,
    entries: Vec<f64>,
}

impl Skyline {
    /// Zeros, for a matrix whose row i has its first entry in column `first[i]`.
    pub fn new(first: &[usize]) -> Self {
        let mut begin = Vec::with_capacity(first.len());
        let mut entries = 0;
        for (row, &first) in first.iter().enumerate() {
            begin.push(entries);
            entries += row + 1 - first;
        }
        Skyline { first: first.to_vec(), begin, entries: vec![0.0; entries] }
    }

    /// Adds to an entry and to its mirror image.
    ///
    /// # Panics
    /// Where the row was said to begin after it.
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        let (row, column) = (row.max(column), row.min(column));
        assert!(column >= self.first[row], "row {row} begins after column {column}");
        self.entries[self.begin[row] + column - self.first[row]] += value;
    }

    fn row(&self, row: usize) -> &[f64] {
        &self.entries[self.begin[row]..self.begin[row] + row + 1 - self.first[row]]
    }

    /// A = L L^T becomes L. A pivot that rounding left at 0 or less counts as infinite: its unknown is then 0.
    pub fn factorise(&mut self) {
        for i in 0..self.first.len() {
            let (done, rest) = self.entries.split_at_mut(self.begin[i]);
            let (first, row) = (self.first[i], &mut rest[..i + 1 - self.first[i]]);
            let scale = row[i - first];
            for j in first..i {
                let begin = self.first[j].max(first);
                let other = &done[self.begin[j]..self.begin[j] + j + 1 - self.first[j]];
                let known =
                    dot(&row[begin - first..j - first], &other[begin - self.first[j]..j - self.first[j]]);
                row[j - first] = (row[j - first] - known) / other[j - self.first[j]];
            }
            let known = dot(&row[..i - first], &row[..i - first]);
            let pivot = row[i - first] - known;
            row[i - first] = if pivot > f64::EPSILON * scale { pivot.sqrt() } else { f64::INFINITY };
        }
    }

    /// x becomes A^-1 x, of the factorised matrix.
    pub fn solve(&self, x: &mut [f64]) {
        for i in 0..x.len() {
            let (row, first) = (self.row(i), self.first[i]);
            x[i] = (x[i] - dot(&row[..i - first], &x[first..i])) / row[i - first];
        }
        for i in (0..x.len()).rev() {
            let (row, first) = (self.row(i), self.first[i]);
            x[i] /= row[i - first];
            let value = x[i];
            for (x, l) in x[first..i].iter_mut().zip(row) {
                *x -= l * value;
            }
        }
    }
}

/// a . b, in an order that compilers can put side by side.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    const SIDE_BY_SIDE: usize = 8;
    let mut sums = [0.0; SIDE_BY_SIDE];
    let (mut a, mut b) = (a.chunks_exact(SIDE_BY_SIDE), b.chunks_exact(SIDE_BY_SIDE));
    for (a, b) in a.by_ref().zip(b.by_ref()) {
        for k in 0..SIDE_BY_SIDE {
            sums[k] += a[k] * b[k];
        }
    }
    let rest: f64 = a.remainder().iter().zip(b.remainder()).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// A new number for each unknown, so that those with a matrix entry in common get near ones: by breadth from one with the fewest, in
/// each connected part, backwards (reverse Cuthill-McKee). `neighbours` holds those of each, itself or not.
pub(crate) fn near_numbers(neighbours: &[Vec<u32>]) -> Vec<u32> {
    const NONE: u32 = u32::MAX;
    let unknowns = neighbours.len();
    let degree = |unknown: u32| neighbours[unknown as usize].len();
    let mut starts: Vec<u32> = (0..unknowns as u32).collect();
    starts.sort_by_key(|&unknown| degree(unknown));
    let mut numbers = vec![NONE; unknowns];
    let mut queue: Vec<u32> = Vec::with_capacity(unknowns);
    for start in starts {
        if numbers[start as usize] != NONE {
            continue;
        }
        let mut read = queue.len();
        let mut take = |unknown: u32, queue: &mut Vec<u32>| {
            if numbers[unknown as usize] == NONE {
                numbers[unknown as usize] = (unknowns - 1 - queue.len()) as u32;
                queue.push(unknown);
            }
        };
        take(start, &mut queue);
        while read < queue.len() {
            let mut next = neighbours[queue[read] as usize].clone();
            next.sort_by_key(|&unknown| degree(unknown));
            next.into_iter().for_each(|unknown| take(unknown, &mut queue));
            read += 1;
        }
    }
    numbers
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stiffness of springs between unknowns side by side in a plane, and to the ground.
    fn springs(edge: usize) -> Vec<Vec<f64>> {
        let mut matrix = vec![vec![0.0; edge * edge]; edge * edge];
        for i in 0..edge * edge {
            matrix[i][i] += 0.1;
            for j in [(i % edge + 1 < edge).then_some(i + 1), (i + edge < edge * edge).then_some(i + edge)] {
                let Some(j) = j else { continue };
                let stiffness = 1.0 + (i % 3) as f64;
                matrix[i][i] += stiffness;
                matrix[j][j] += stiffness;
                matrix[i][j] -= stiffness;
                matrix[j][i] -= stiffness;
            }
        }
        matrix
    }

    #[test]
    fn a_factorised_matrix_gives_back_what_it_was_multiplied_with() {
        let matrix = springs(7);
        let first: Vec<usize> =
            matrix.iter().map(|row| row.iter().position(|&x| x != 0.0).expect("a diagonal")).collect();
        let mut skyline = Skyline::new(&first);
        for (i, row) in matrix.iter().enumerate() {
            for j in 0..=i {
                if row[j] != 0.0 {
                    skyline.add(j, i, row[j]);
                }
            }
        }
        skyline.factorise();
        let wanted: Vec<f64> = (0..matrix.len()).map(|i| (i as f64).sin()).collect();
        let mut x: Vec<f64> =
            matrix.iter().map(|row| row.iter().zip(&wanted).map(|(a, x)| a * x).sum()).collect();
        skyline.solve(&mut x);
        for (x, wanted) in x.iter().zip(&wanted) {
            assert!((x - wanted).abs() < 1e-12, "{x} {wanted}");
        }
    }

    #[test]
    fn near_numbers_are_a_permutation_and_keep_rows_short() {
        // A strip of 40 by 4 whose lines run the long way, and a lone unknown.
        let (long, short) = (40, 4);
        let mut neighbours = vec![Vec::new(); long * short + 1];
        for a in 0..long * short {
            for b in 0..long * short {
                let apart = (a / long).abs_diff(b / long).max((a % long).abs_diff(b % long));
                if apart <= 1 {
                    neighbours[a].push(b as u32);
                }
            }
        }
        let numbers = near_numbers(&neighbours);
        let mut sorted = numbers.clone();
        sorted.sort_unstable();
        assert!(sorted.into_iter().eq(0..=(long * short) as u32));
        let widest = (0..long * short)
            .flat_map(|a| neighbours[a].iter().map(move |&b| (a, b)))
            .map(|(a, b)| numbers[a].abs_diff(numbers[b as usize]))
            .max();
        assert!(widest <= Some(2 * short as u32 + 2), "{widest:?}");
    }
}
