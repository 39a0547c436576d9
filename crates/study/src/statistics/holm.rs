/// Holm's step-down adjusted p values, in the order given (Holm 1979, Scand. J. Stat. 6, 65):
/// p~_(k) = max over j <= k of min(1, (m - j + 1) p_(j)), m the number of p values. A hypothesis is rejected
/// at family-wise level alpha where its adjusted value is at most alpha.
pub fn holm_adjusted(p_values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..p_values.len()).collect();
    order.sort_by(|&a, &b| p_values[a].total_cmp(&p_values[b]));
    let mut adjusted = vec![0.0; p_values.len()];
    let mut largest = 0.0_f64;
    for (rank, &index) in order.iter().enumerate() {
        let factor = (p_values.len() - rank) as f64;
        largest = largest.max((factor * p_values[index]).min(1.0));
        adjusted[index] = largest;
    }
    adjusted
}
