//! Triangles in a tree of boxes, halved by number along the longest side of their middles.

use snowlab_solver::geometry::{Aabb, Vector};

use super::Point;
use super::triangle::Triangle;

/// Triangles in a leaf. Chosen: boxes then take less than half the memory of the triangles.
const LEAF: usize = 4;
/// Boxes that wait on the way down. Each halving adds one, and 2^32 triangles take 32.
const WAITING: usize = 40;

/// A tree, its nodes in depth-first order: the first child of a node follows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Tree {
    triangles: Vec<Triangle>,
    nodes: Vec<Node>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    min: Point,
    max: Point,
    /// The first triangle of a leaf, the second child of another node.
    first: u32,
    /// Triangles of a leaf, 0 of another node.
    count: u32,
}

impl Tree {
    /// Of one triangle or more.
    pub fn new(mut triangles: Vec<Triangle>) -> Self {
        let mut nodes = Vec::with_capacity(triangles.len());
        grow(&mut triangles, 0, &mut nodes);
        Self { triangles, nodes }
    }

    /// All of them.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// The smallest box about all of them.
    pub fn bounds(&self) -> Aabb<3> {
        Aabb { min: self.nodes[0].min, max: self.nodes[0].max }
    }

    /// How often the surface winds round the shifted `point`.
    pub fn winding(&self, point: &Point) -> i32 {
        let mut winding = 0;
        let reaches = |node: &Node| node.is_over(point) && point.z <= node.max.z;
        self.visit(reaches, |triangle| {
            let own = triangle.winding(point);
            if own != 0 && triangle.is_above(point, own) {
                winding += own;
            }
        });
        winding
    }

    /// Heights at which the vertical line through `point` crosses the surface, with how it faces there (1 up, -1 down).
    pub fn crossings(&self, point: &Point, found: &mut Vec<(f64, i32)>) {
        self.visit(
            |node| node.is_over(point),
            |triangle| match triangle.winding(point) {
                0 => {}
                winding => found.push((triangle.height(point), winding)),
            },
        );
    }

    /// Hands over the triangles in all leaves whose boxes, and those about them, are `wanted`.
    fn visit(&self, wanted: impl Fn(&Node) -> bool, mut take: impl FnMut(&Triangle)) {
        let (mut waiting, mut count) = ([0_u32; WAITING], 1);
        while count > 0 {
            count -= 1;
            let number = waiting[count];
            let node = &self.nodes[number as usize];
            if !wanted(node) {
                continue;
            }
            match node.leaf(&self.triangles) {
                Some(leaf) => leaf.iter().for_each(&mut take),
                None => {
                    waiting[count] = node.first;
                    waiting[count + 1] = number + 1;
                    count += 2;
                }
            }
        }
    }

    /// Squared distance from `point` to the nearest triangle; boxes that are farther are passed over.
    pub fn squared_distance(&self, point: &Point) -> f64 {
        let mut least = f64::INFINITY;
        let (mut waiting, mut count) = ([(0_u32, 0.0); WAITING], 1);
        while count > 0 {
            count -= 1;
            let (number, distance) = waiting[count];
            if distance >= least {
                continue;
            }
            let node = &self.nodes[number as usize];
            if let Some(leaf) = node.leaf(&self.triangles) {
                least = leaf.iter().map(|triangle| triangle.squared_distance(point)).fold(least, f64::min);
                continue;
            }
            let mut children = [number + 1, node.first]
                .map(|child| (child, self.nodes[child as usize].squared_distance(point)));
            // The nearer one comes last, and is taken first.
            if children[0].1 < children[1].1 {
                children.swap(0, 1);
            }
            waiting[count..count + 2].copy_from_slice(&children);
            count += 2;
        }
        least
    }
}

impl Node {
    fn leaf<'a>(&self, triangles: &'a [Triangle]) -> Option<&'a [Triangle]> {
        (self.count > 0).then(|| &triangles[self.first as usize..(self.first + self.count) as usize])
    }

    /// Whether a vertical line through `point` passes it.
    fn is_over(&self, point: &Point) -> bool {
        let within = |axis: usize| self.min[axis] <= point[axis] && point[axis] <= self.max[axis];
        within(0) && within(1)
    }

    fn squared_distance(&self, point: &Point) -> f64 {
        let outside = (self.min - point).sup(&(point - self.max)).map(|beyond| beyond.max(0.0));
        outside.norm_squared()
    }
}

/// Adds the node of `triangles`, whose first is number `first` of all, and those below it.
fn grow(triangles: &mut [Triangle], first: u32, nodes: &mut Vec<Node>) {
    let corners = || triangles.iter().flat_map(|triangle| triangle.0);
    let (min, max) = hull(corners());
    let number = nodes.len();
    let count = triangles.len();
    nodes.push(Node { min, max, first, count: count as u32 });
    if count <= LEAF {
        return;
    }
    // Three times the middle does as well.
    let middle = |triangle: &Triangle, axis: usize| triangle.0.iter().map(|corner| corner[axis]).sum::<f64>();
    let middles = triangles.iter().map(|t| Vector::<f64, 3>::from_fn(|axis, _| middle(t, axis)));
    let (least, greatest) = hull(middles);
    let axis = (greatest - least).imax();
    triangles.select_nth_unstable_by(count / 2, |s, t| middle(s, axis).total_cmp(&middle(t, axis)));
    let (one, other) = triangles.split_at_mut(count / 2);
    grow(one, first, nodes);
    nodes[number].first = nodes.len() as u32;
    nodes[number].count = 0;
    grow(other, first + (count / 2) as u32, nodes);
}

/// The smallest box about `points`.
pub fn hull(points: impl Iterator<Item = Point>) -> (Point, Point) {
    let nothing = (Point::repeat(f64::INFINITY), Point::repeat(f64::NEG_INFINITY));
    points.fold(nothing, |(min, max), point| (min.inf(&point), max.sup(&point)))
}
