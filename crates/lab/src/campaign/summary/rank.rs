//! Rank correlation.

use stormpetrel_control::real::Real;

/// Spearman's rank correlation of pairs, -1 to 1, and how many pairs there were; equal values share the
/// mean of their ranks. NaN where one of the two never changes, or where there are fewer than two pairs.
///
/// It is the correlation coefficient of the ranks: 1 where one always rises with the other, however
/// curved, 0 where the order of one says nothing of the other.
///
/// Source: C. Spearman, "The proof and measurement of association between two things", American
/// Journal of Psychology 15 (1904), 72-101.
pub fn spearman(pairs: impl Iterator<Item = (f64, f64)>) -> (f64, usize) {
    let most = pairs.size_hint().1.unwrap_or(0);
    let mut all: Vec<[f64; 2]> = Vec::with_capacity(most);
    all.extend(pairs.map(|(x, y)| [x, y]));
    rank(&mut all, 0);
    rank(&mut all, 1);
    let middle = 0.5 * (all.len() as f64 + 1.0);
    let (mut xx, mut yy, mut xy) = (0.0, 0.0, 0.0);
    for [a, b] in all.iter().map(|pair| pair.map(|rank| rank - middle)) {
        xx += a.sq();
        yy += b.sq();
        xy += a * b;
    }
    let correlation = if xx > 0.0 && yy > 0.0 { xy / (xx.sqrt() * yy.sqrt()) } else { f64::NAN };
    (correlation, all.len())
}

/// Puts the pairs in the order of their values on one side, and in place of each value its rank, from one;
/// equal values get the mean of their ranks.
fn rank(pairs: &mut [[f64; 2]], side: usize) {
    // Zeros of either sign are equal.
    for pair in &mut *pairs {
        pair[side] += 0.0;
    }
    pairs.sort_unstable_by(|a, b| a[side].total_cmp(&b[side]));
    let mut before = 0;
    for equal in pairs.chunk_by_mut(|a, b| a[side].total_cmp(&b[side]).is_eq()) {
        let count = equal.len();
        for pair in equal {
            pair[side] = before as f64 + 0.5 * (count as f64 + 1.0);
        }
        before += count;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(x: &[f64], y: &[f64]) -> f64 {
        spearman(x.iter().copied().zip(y.iter().copied())).0
    }

    #[test]
    fn equal_values_share_their_ranks() {
        let mut pairs = [[3.0, 7.0], [1.0, 8.0], [3.0, 9.0], [2.0, 0.0]];
        rank(&mut pairs, 0);
        // Those that are equal come in any order.
        pairs[2..].sort_by(|a, b| a[1].total_cmp(&b[1]));
        assert_eq!(pairs, [[1.0, 8.0], [2.0, 0.0], [3.5, 7.0], [3.5, 9.0]]);
        let mut zeros = [[5.0, 0.0], [5.0, -0.0]];
        rank(&mut zeros, 1);
        assert_eq!(zeros, [[5.0, 1.5]; 2]);
    }

    #[test]
    fn order_is_all_that_counts() {
        let x: Vec<f64> = (1..50).map(f64::from).collect();
        let cubes: Vec<f64> = x.iter().map(|v| v * v * v).collect();
        let falling: Vec<f64> = x.iter().map(|v| 1.0 / v).collect();
        assert!((of(&x, &cubes) - 1.0).abs() < 1e-15);
        assert!((of(&x, &falling) + 1.0).abs() < 1e-15);
        assert!(of(&x, &vec![2.0; x.len()]).is_nan() && of(&[1.0], &[1.0]).is_nan());
    }

    /// Without equal values it is 1 - 6 sum d^2/(n (n^2 - 1)); here sum d^2 = 194, n = 10.
    #[test]
    fn closed_form_without_ties() {
        let x = [106.0, 100.0, 86.0, 101.0, 99.0, 103.0, 97.0, 113.0, 112.0, 110.0];
        let y = [7.0, 27.0, 2.0, 50.0, 28.0, 29.0, 20.0, 12.0, 6.0, 17.0];
        assert!((of(&x, &y) - (1.0 - 6.0 * 194.0 / 990.0)).abs() < 1e-15);
    }

    /// `scipy.stats.spearmanr` of SciPy 1.17.1.
    #[test]
    fn val_scipy_with_ties() {
        let x = [1.0, 2.0, 2.0, 3.0, 5.0, 5.0, 5.0, 8.0, 9.0, 10.0];
        let y = [2.5, 1.0, 4.0, 4.0, 6.0, 3.0, 9.0, 9.0, 7.0, 12.0];
        assert!((of(&x, &y) - 0.832_853_261_514_130_1).abs() < 1e-14);
        let x = [0.1, 0.5, 0.5, 0.9, 1.3, 2.0];
        let y = [1.0, 1.0, 1.0, 0.0, 1.0, 0.0];
        assert!((of(&x, &y) + 0.630_126_037_812_604_5).abs() < 1e-14);
    }
}
