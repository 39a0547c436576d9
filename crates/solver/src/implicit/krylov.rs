//! Krylov solvers for A x = b with a symmetric, perhaps indefinite A, and a positive definite preconditioner P. They know nothing of what
//! a vector is: all sums are the system's, which takes them in a fixed order.

/// A linear system's operators, and the algebra of its vectors.
pub trait LinearSystem {
    /// A vector.
    type Vector: Clone;

    /// `out` = A x.
    fn apply(&mut self, x: &Self::Vector, out: &mut Self::Vector);
    /// `out` = P^-1 r.
    fn precondition(&mut self, r: &Self::Vector, out: &mut Self::Vector);
    /// a . b.
    fn dot(&mut self, a: &Self::Vector, b: &Self::Vector) -> f64;
    /// y = a x + b y; what y holds does not matter where b = 0.
    fn combine(&mut self, a: f64, x: &Self::Vector, b: f64, y: &mut Self::Vector);
}

/// Which solver.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Conjugate residuals (Stiefel 1955; S13 section 6), which can break down where A is indefinite; MINRES then goes on.
    ConjugateResiduals,
    /// Minimal residuals by Lanczos' process (Paige & Saunders 1975), which cannot.
    #[default]
    Minres,
}

/// How a solve ended.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Solution {
    /// Applications of A.
    pub iterations: u32,
    /// |b - A x| / |b| in the norm of P^-1.
    pub residual: f64,
    /// Whether that is at most the tolerance.
    pub converged: bool,
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// For |b - A x| / |b| in the norm of P^-1.
    pub tolerance: f64,
    /// Applications of A.
    pub max_iterations: u32,
}

/// Solves from x = 0. `trace` is told the residual after every iteration, as [`Solution::residual`].
pub fn solve<S: LinearSystem>(
    system: &mut S,
    method: Method,
    b: &S::Vector,
    goal: Goal,
    trace: impl FnMut(f64),
) -> (S::Vector, Solution) {
    match method {
        Method::ConjugateResiduals => conjugate_residuals(system, b, goal, trace),
        Method::Minres => minres(system, b, goal, trace),
    }
}

fn zero_like<S: LinearSystem>(system: &mut S, like: &S::Vector) -> S::Vector {
    let mut zero = like.clone();
    system.combine(0.0, like, 0.0, &mut zero);
    zero
}

/// Preconditioned conjugate residuals (Saad, Iterative Methods for Sparse Linear Systems, 2nd ed., algorithm 6.20, with the residual and
/// its image under P^-1 side by side).
fn conjugate_residuals<S: LinearSystem>(
    system: &mut S,
    b: &S::Vector,
    goal: Goal,
    mut trace: impl FnMut(f64),
) -> (S::Vector, Solution) {
    /// r . A r below this share of |r| |A r| counts as a breakdown (chosen: four digits of f32 are left above it).
    const BREAKDOWN: f64 = 1e-3;
    let mut x = zero_like(system, b);
    let (mut r, mut z) = (b.clone(), b.clone());
    system.precondition(&r, &mut z);
    let first = system.dot(&r, &z).max(0.0).sqrt();
    let mut solution = Solution { converged: first == 0.0, ..Solution::default() };
    if solution.converged {
        return (x, solution);
    }
    solution.residual = 1.0;
    let (mut az, mut mq) = (b.clone(), b.clone());
    system.apply(&z, &mut az);
    solution.iterations = 1;
    let (mut p, mut q) = (z.clone(), az.clone());
    let mut z_az = system.dot(&z, &az);
    loop {
        system.precondition(&q, &mut mq);
        let q_mq = system.dot(&q, &mq);
        let size = solution.residual * first * q_mq.max(0.0).sqrt();
        if !(z_az.abs() > BREAKDOWN * size) {
            let rest = Goal {
                tolerance: goal.tolerance / solution.residual,
                max_iterations: goal.max_iterations.saturating_sub(solution.iterations),
            };
            let share = solution.residual;
            let (correction, rest) = minres(system, &r, rest, |residual| trace(residual * share));
            system.combine(1.0, &correction, 1.0, &mut x);
            solution.iterations += rest.iterations;
            solution.residual *= rest.residual;
            solution.converged = rest.converged;
            return (x, solution);
        }
        let step = z_az / q_mq;
        system.combine(step, &p, 1.0, &mut x);
        system.combine(-step, &q, 1.0, &mut r);
        system.combine(-step, &mq, 1.0, &mut z);
        solution.residual = system.dot(&r, &z).max(0.0).sqrt() / first;
        trace(solution.residual);
        solution.converged = solution.residual <= goal.tolerance;
        if solution.converged || solution.iterations >= goal.max_iterations {
            return (x, solution);
        }
        system.apply(&z, &mut az);
        solution.iterations += 1;
        let next = system.dot(&z, &az);
        let share = next / z_az;
        z_az = next;
        system.combine(1.0, &z, share, &mut p);
        system.combine(1.0, &az, share, &mut q);
    }
}

/// Preconditioned MINRES: Lanczos' process makes A tridiagonal, plane rotations make that triangular (Paige & Saunders, SIAM J. Numer.
/// Anal. 12(4), 1975; with a preconditioner: Elman, Silvester & Wathen, Finite Elements and Fast Iterative Solvers, algorithm 2.4).
fn minres<S: LinearSystem>(
    system: &mut S,
    b: &S::Vector,
    goal: Goal,
    mut trace: impl FnMut(f64),
) -> (S::Vector, Solution) {
    let mut x = zero_like(system, b);
    // Lanczos vectors before division by their lengths, u_k = P z_k; z is the image of the latest under P^-1.
    let (mut u_before, mut u, mut z) = (zero_like(system, b), b.clone(), b.clone());
    system.precondition(&u, &mut z);
    let first = system.dot(&u, &z).max(0.0).sqrt();
    let mut solution = Solution { converged: first == 0.0, ..Solution::default() };
    if solution.converged {
        return (x, solution);
    }
    let (mut w_before, mut w) = (zero_like(system, b), zero_like(system, b));
    let mut az = b.clone();
    let (mut length_before, mut length, mut rest) = (1.0, first, first);
    // Cosine and sine of the latest rotation and of the one before.
    let ([mut cos_before, mut sin_before], [mut cos, mut sin]) = ([1.0, 0.0], [1.0, 0.0]);
    solution.residual = 1.0;
    while solution.iterations < goal.max_iterations {
        // u_k+1 = A v_k - (v_k . A v_k) u_k / |u_k| - (|u_k| / |u_k-1|) u_k-1, where v_k = z_k / |u_k|.
        system.apply(&z, &mut az);
        solution.iterations += 1;
        let alpha = system.dot(&az, &z) / (length * length);
        system.combine(1.0 / length, &az, -length / length_before, &mut u_before);
        system.combine(-alpha / length, &u, 1.0, &mut u_before);
        std::mem::swap(&mut u, &mut u_before);
        // Column k of the tridiagonal matrix, (|u_k|, alpha, |u_k+1|), turned by the two rotations before.
        let (second_above, turned) = (sin_before * length, cos_before * length);
        let (above, pivot) = (cos * turned + sin * alpha, cos * alpha - sin * turned);
        system.combine(1.0 / length, &z, -second_above, &mut w_before);
        system.combine(-above, &w, 1.0, &mut w_before);
        std::mem::swap(&mut w, &mut w_before);
        system.precondition(&u, &mut z);
        length_before = length;
        length = system.dot(&u, &z).max(0.0).sqrt();
        let diagonal = pivot.hypot(length);
        if !(diagonal > 0.0) {
            break;
        }
        (cos_before, sin_before) = (cos, sin);
        (cos, sin) = (pivot / diagonal, length / diagonal);
        system.combine(0.0, &z, 1.0 / diagonal, &mut w);
        system.combine(cos * rest, &w, 1.0, &mut x);
        rest *= -sin;
        solution.residual = rest.abs() / first;
        trace(solution.residual);
        solution.converged = solution.residual <= goal.tolerance;
        if solution.converged || length == 0.0 {
            break;
        }
    }
    (x, solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A dense system with a diagonal preconditioner.
    struct Dense {
        a: Vec<Vec<f64>>,
        p: Vec<f64>,
    }

    impl LinearSystem for Dense {
        type Vector = Vec<f64>;
        fn apply(&mut self, x: &Vec<f64>, out: &mut Vec<f64>) {
            *out = self.a.iter().map(|row| row.iter().zip(x).map(|(a, x)| a * x).sum()).collect();
        }
        fn precondition(&mut self, r: &Vec<f64>, out: &mut Vec<f64>) {
            *out = r.iter().zip(&self.p).map(|(r, p)| r / p).collect();
        }
        fn dot(&mut self, a: &Vec<f64>, b: &Vec<f64>) -> f64 {
            a.iter().zip(b).map(|(a, b)| a * b).sum()
        }
        fn combine(&mut self, a: f64, x: &Vec<f64>, b: f64, y: &mut Vec<f64>) {
            for (y, x) in y.iter_mut().zip(x) {
                *y = a * x + if b == 0.0 { 0.0 } else { b * *y };
            }
        }
    }

    /// Symmetric, with eigenvalues of both signs: a second difference less a shift that falls between them.
    fn indefinite(n: usize) -> Dense {
        let entry = |i: usize, j: usize| match i.abs_diff(j) {
            0 => 2.0 - 0.9 + 0.1 * i as f64,
            1 => -1.0,
            _ => 0.0,
        };
        let a = (0..n).map(|i| (0..n).map(|j| entry(i, j)).collect()).collect();
        Dense { a, p: (0..n).map(|i| 1.0 + 0.3 * i as f64).collect() }
    }

    fn right_side(n: usize) -> Vec<f64> {
        (0..n).map(|i| 1.0 + (i as f64 * 1.7).sin()).collect()
    }

    /// |b - A x| / |b| in the norm of P^-1, from the definition.
    fn true_residual(system: &mut Dense, b: &Vec<f64>, x: &Vec<f64>) -> f64 {
        let mut r = b.clone();
        system.apply(x, &mut r);
        system.combine(1.0, b, -1.0, &mut r);
        let norm = |r: &Vec<f64>, p: &[f64]| r.iter().zip(p).map(|(r, p)| r * r / p).sum::<f64>().sqrt();
        norm(&r, &system.p) / norm(b, &system.p)
    }

    #[test]
    fn both_solvers_end_in_n_steps_on_an_indefinite_system() {
        for method in [Method::ConjugateResiduals, Method::Minres] {
            for n in [1, 2, 5, 12] {
                let (mut system, b) = (indefinite(n), right_side(n));
                let goal = Goal { tolerance: 1e-10, max_iterations: n as u32 + 1 };
                let mut trace = Vec::new();
                let (x, solution) = solve(&mut system, method, &b, goal, |residual| trace.push(residual));
                assert!(solution.converged && trace.len() <= n, "{method:?}, {n}: {solution:?} {trace:?}");
                let residual = true_residual(&mut system, &b, &x);
                assert!(residual < 1e-9, "{method:?}, {n}: says {}, is {residual}", solution.residual);
                assert!((residual - solution.residual).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_residual_never_rises_and_is_the_true_one() {
        let n = 40;
        for method in [Method::ConjugateResiduals, Method::Minres] {
            let (mut system, b) = (indefinite(n), right_side(n));
            let mut before = 1.0;
            for steps in 1..=n as u32 {
                let goal = Goal { tolerance: 1e-12, max_iterations: steps };
                let (x, solution) = solve(&mut system, method, &b, goal, |_| ());
                let residual = true_residual(&mut system, &b, &x);
                assert!(solution.residual <= before * (1.0 + 1e-12), "{method:?} rises at {steps}");
                assert!((residual - solution.residual).abs() < 1e-9, "{method:?}: {residual} {solution:?}");
                before = solution.residual;
            }
            assert!(before < 1e-12, "{method:?}: {before}");
        }
    }

    /// r . A r = 0 at the first step: conjugate residuals have nowhere to go.
    #[test]
    fn a_breakdown_is_survived() {
        let mut system = Dense { a: vec![vec![0.0, 1.0], vec![1.0, 0.0]], p: vec![1.0, 1.0] };
        let b = vec![1.0, 0.0];
        let goal = Goal { tolerance: 1e-12, max_iterations: 10 };
        let (x, solution) = solve(&mut system, Method::ConjugateResiduals, &b, goal, |_| ());
        assert!(solution.converged, "{solution:?}");
        assert!((x[0]).abs() < 1e-12 && (x[1] - 1.0).abs() < 1e-12, "{x:?}");
    }

    #[test]
    fn a_solve_that_is_cut_short_says_so() {
        let (mut system, b) = (indefinite(30), right_side(30));
        let goal = Goal { tolerance: 1e-10, max_iterations: 3 };
        for method in [Method::ConjugateResiduals, Method::Minres] {
            let (x, solution) = solve(&mut system, method, &b, goal, |_| ());
            assert!(
                !solution.converged && solution.iterations == 3 && solution.residual > 1e-3,
                "{solution:?}"
            );
            assert!((true_residual(&mut system, &b, &x) - solution.residual).abs() < 1e-12);
        }
    }

    #[test]
    fn nothing_is_solved_at_once() {
        let mut system = indefinite(3);
        let goal = Goal { tolerance: 1e-10, max_iterations: 3 };
        for method in [Method::ConjugateResiduals, Method::Minres] {
            let (x, solution) = solve(&mut system, method, &vec![0.0; 3], goal, |_| ());
            assert_eq!((x, solution.converged, solution.iterations), (vec![0.0; 3], true, 0));
        }
    }

    /// Masses from 1e-12 to 1 on the diagonal, far from a scale that any single number would fit.
    #[test]
    fn masses_over_twelve_decades_converge() {
        let n = 25;
        let mass: Vec<f64> = (0..n).map(|i| 10_f64.powf(-12.0 + 0.5 * i as f64)).collect();
        let mut system = indefinite(n);
        for i in 0..n {
            for j in 0..n {
                // Springs as stiff as what they hold is heavy.
                system.a[i][j] *= (mass[i] * mass[j]).sqrt();
            }
        }
        system.p = mass.clone();
        let b: Vec<f64> = mass.iter().map(|m| m * 2.0).collect();
        for method in [Method::ConjugateResiduals, Method::Minres] {
            let goal = Goal { tolerance: 1e-10, max_iterations: 2 * n as u32 };
            let (x, solution) = solve(&mut system, method, &b, goal, |_| ());
            assert!(solution.converged, "{method:?}: {solution:?}");
            assert!(true_residual(&mut system, &b, &x) < 1e-9);
        }
    }
}
