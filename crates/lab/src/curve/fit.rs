//! Splines of degree 5 through noisy rows, by least squares.

use stormpetrel_plant::reference::piecewise::{Piece, TERMS};

use super::banded::Banded;

/// Degree of the splines.
const DEGREE: usize = 5;
/// Coefficients at each end that equal their neighbour where the first three derivatives vanish.
const RESTING: usize = 3;
/// Distances below this are rounding and no reason for another knot, m.
const ROUNDING: f64 = 1e-9;

/// A fit: its pieces, and its largest and root mean square distance from the rows, m.
pub(super) struct Fit {
    pub pieces: Vec<Piece>,
    pub worst: f64,
    pub mean: f64,
}

/// The fit whose number of pieces makes the generalised cross-validation least. `columns`: x, y, z, yaw;
/// `times` grow from zero. With `rest` the first three derivatives vanish at both ends.
pub(super) fn fit(times: &[f64], columns: &[Vec<f64>; 4], rest: bool) -> Option<Fit> {
    let rows = times.len() as f64;
    let merged = if rest { RESTING } else { 0 };
    let mut best: Option<(f64, Spline)> = None;
    // A fit between two rests has at least its two ends.
    let mut count = if rest { 3 } else { 1 };
    // At least two rows for each piece.
    while 2 * count + DEGREE < times.len() {
        let spline = Spline::new(times, columns, count, merged)?;
        let freedom = rows - (count + DEGREE - 2 * merged) as f64;
        let sum: f64 = spline.distances(times, columns).map(|d| d * d).sum();
        let score = (sum + rows * ROUNDING * ROUNDING) * rows / (freedom * freedom);
        if best.as_ref().is_none_or(|(least, _)| score < *least) {
            best = Some((score, spline));
        }
        count += 1 + count / 3;
    }
    let (_, spline) = best?;
    let (mut worst, mut sum) = (0.0, 0.0);
    for distance in spline.distances(times, columns) {
        worst = if distance > worst { distance } else { worst };
        sum += distance * distance;
    }
    Some(Fit { pieces: spline.pieces(), worst, mean: (sum / rows).sqrt() })
}

/// Splines over common knots.
struct Spline {
    knots: Vec<f64>,
    /// Coefficients of each column.
    weights: [Vec<f64>; 4],
}

impl Spline {
    /// The least-squares splines with this number of pieces.
    /// The first coefficients, `merged` more than one, are one number, and so are the last.
    fn new(times: &[f64], columns: &[Vec<f64>; 4], count: usize, merged: usize) -> Option<Self> {
        let (last, size) = (times.len() - 1, count + DEGREE - 2 * merged);
        let unknown = |weight: usize| {
            let after = weight.saturating_sub(merged);
            if after < size { after } else { size - 1 }
        };
        let mut knots = vec![times[0]; DEGREE];
        knots.extend((0..=count).map(|i| times[i * last / count]));
        knots.extend([times[last]; DEGREE]);
        let mut normal = Banded::new(size, DEGREE);
        let mut right = [(); 4].map(|()| vec![0.0; size]);
        for (row, time) in times.iter().enumerate() {
            let span = span(&knots, *time);
            let basis = basis(&knots, span, *time);
            for (a, of_a) in basis.iter().enumerate() {
                let at = unknown(span - DEGREE + a);
                for (b, of_b) in basis.iter().enumerate() {
                    normal.add(at, unknown(span - DEGREE + b), of_a * of_b);
                }
                for (right, column) in right.iter_mut().zip(columns) {
                    right[at] += of_a * column[row];
                }
            }
        }
        let factor = normal.factor()?;
        let weights = right.map(|right| {
            let found = factor.solve(right);
            (0..count + DEGREE).map(|weight| found[unknown(weight)]).collect()
        });
        Some(Self { knots, weights })
    }

    /// Distance of each row from the fit, m.
    fn distances(&self, times: &[f64], columns: &[Vec<f64>; 4]) -> impl Iterator<Item = f64> {
        times.iter().enumerate().map(|(row, time)| {
            let span = span(&self.knots, *time);
            let basis = basis(&self.knots, span, *time);
            let square = |axis: usize| {
                let weights = &self.weights[axis][span - DEGREE..];
                let fit: f64 = basis.iter().zip(weights).map(|(b, w)| b * w).sum();
                (fit - columns[axis][row]) * (fit - columns[axis][row])
            };
            (square(0) + square(1) + square(2)).sqrt()
        })
    }

    /// The polynomial of each interval between knots.
    fn pieces(&self) -> Vec<Piece> {
        let spans = DEGREE..self.knots.len() - DEGREE - 1;
        let blank = |span: usize| {
            let begin = self.knots[span];
            Piece { begin, length: self.knots[span + 1] - begin, ..Piece::default() }
        };
        let mut pieces: Vec<Piece> = spans.map(blank).collect();
        for (axis, weights) in self.weights.iter().enumerate() {
            let (mut weights, mut factor) = (weights.clone(), 1.0);
            for k in 0..=DEGREE {
                // The k-th derivative is a spline of degree 5 - k without the k outer knots.
                let knots = &self.knots[k..self.knots.len() - k];
                for (i, piece) in pieces.iter_mut().enumerate() {
                    let value = value(knots, &weights, DEGREE - k, i + DEGREE - k, piece.begin);
                    let scale = (0..k).fold(factor, |scale, _| scale * piece.length);
                    piece.terms[axis][k] = value * scale;
                }
                weights = differences(knots, &weights, DEGREE - k);
                factor /= (k + 1) as f64;
            }
        }
        const { assert!(DEGREE < TERMS) };
        pieces
    }
}

/// The interval between knots in which a time lies.
fn span(knots: &[f64], time: f64) -> usize {
    let last = knots.len() - DEGREE - 2;
    let after = knots[DEGREE..=last].partition_point(|knot| *knot <= time) + DEGREE;
    if after > DEGREE { after - 1 } else { DEGREE }
}

/// The six B-splines that do not vanish there (Cox and de Boor).
fn basis(knots: &[f64], span: usize, time: f64) -> [f64; DEGREE + 1] {
    let mut basis = [0.0; DEGREE + 1];
    basis[0] = 1.0;
    for degree in 1..=DEGREE {
        let mut carried = 0.0;
        for r in 0..degree {
            let (left, right) = (knots[span + 1 + r - degree], knots[span + 1 + r]);
            let share = basis[r] / (right - left);
            basis[r] = carried + (right - time) * share;
            carried = (time - left) * share;
        }
        basis[degree] = carried;
    }
    basis
}

/// Coefficients of the derivative of a spline.
fn differences(knots: &[f64], weights: &[f64], degree: usize) -> Vec<f64> {
    let slope = |(i, pair): (usize, &[f64])| {
        degree as f64 * (pair[1] - pair[0]) / (knots[i + degree + 1] - knots[i + 1])
    };
    weights.windows(2).enumerate().map(slope).collect()
}

/// Value of a spline in an interval, by de Boor's scheme.
fn value(knots: &[f64], weights: &[f64], degree: usize, span: usize, time: f64) -> f64 {
    let mut part = [0.0; DEGREE + 1];
    part[..=degree].copy_from_slice(&weights[span - degree..=span]);
    for level in 1..=degree {
        for j in (level..=degree).rev() {
            let at = span - degree + j;
            let (left, right) = (knots[at], knots[at + degree + 1 - level]);
            let share = (time - left) / (right - left);
            part[j] = part[j - 1] + share * (part[j] - part[j - 1]);
        }
    }
    part[degree]
}
