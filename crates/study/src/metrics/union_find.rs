//! Disjoint sets: union by size with path halving (Tarjan & van Leeuwen, J. ACM 31(2), 1984).

/// A partition of `0..n` that only ever coarsens. The same sequence of calls gives the same roots.
#[derive(Clone, Debug)]
pub struct UnionFind {
    parent: Vec<u32>,
    size: Vec<u32>,
    sets: usize,
}

impl UnionFind {
    /// `n` sets of one element each; `n` must fit 32 bits (the metrics take at most
    /// [`MAX_PARTICLES`](super::error::MAX_PARTICLES)).
    pub fn new(n: usize) -> Self {
        Self { parent: (0..n as u32).collect(), size: vec![1; n], sets: n }
    }

    /// The representative of the set that holds `element`.
    #[inline]
    pub fn find(&mut self, element: u32) -> u32 {
        let mut element = element;
        while self.parent[element as usize] != element {
            let grandparent = self.parent[self.parent[element as usize] as usize];
            self.parent[element as usize] = grandparent;
            element = grandparent;
        }
        element
    }

    /// Unites the sets of `a` and `b`. Returns the root that stays and the root that went, or `None` where
    /// they were one set before. The larger set's root stays; of two equal ones the lower root.
    #[inline]
    pub fn union(&mut self, a: u32, b: u32) -> Option<(u32, u32)> {
        let (a, b) = (self.find(a), self.find(b));
        if a == b {
            return None;
        }
        let (size_a, size_b) = (self.size[a as usize], self.size[b as usize]);
        let (stays, goes) = if (size_b, a) > (size_a, b) { (b, a) } else { (a, b) };
        self.parent[goes as usize] = stays;
        self.size[stays as usize] = size_a + size_b;
        self.sets -= 1;
        Some((stays, goes))
    }

    /// The number of sets.
    pub fn sets(&self) -> usize {
        self.sets
    }

    /// The root of every element, in order.
    pub fn roots(&mut self) -> Vec<u32> {
        (0..self.parent.len() as u32).map(|element| self.find(element)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_larger_set_stays_and_of_equals_the_lower_root() {
        let mut sets = UnionFind::new(5);
        assert_eq!(sets.union(3, 1), Some((1, 3)));
        assert_eq!(sets.union(0, 3), Some((1, 0)));
        assert_eq!(sets.union(3, 0), None);
        assert_eq!(sets.union(4, 2), Some((2, 4)));
        assert_eq!(sets.union(2, 0), Some((1, 2)));
        assert_eq!((sets.sets(), sets.roots()), (1, vec![1; 5]));
    }

    #[test]
    fn no_elements_no_sets() {
        let mut sets = UnionFind::new(0);
        assert_eq!((sets.sets(), sets.roots()), (0, vec![]));
    }
}
