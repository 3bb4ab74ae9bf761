//! The curve of least snap through points, and its special case of a closed track.
//!
//! Between two points stands the polynomial of degree 7 with given value and first three derivatives at
//! both ends; its snap squared, integrated, is a quadratic form in those eight numbers. The sum over the
//! pieces is least where its gradient by the free derivatives vanishes: banded equations.

use stormpetrel_plant::reference::piecewise::{Piece, TERMS};

use super::banded::Banded;

/// Value and first three derivatives at a joint, by the phase.
type Joint = [f64; 4];

/// What is asked of one coordinate.
pub(super) struct Course {
    /// Values at the joints, one more than there are pieces.
    pub values: Vec<f64>,
    /// First three derivatives at the joints, where they are given.
    pub given: Vec<[Option<f64>; 3]>,
    /// Whether the last joint has the derivatives of the first.
    pub closed: bool,
}

/// The pieces, one for each length, with the least snap in each coordinate; `None` where the equations
/// cannot be solved.
pub(super) fn pieces(lengths: &[f64], courses: &[Course; 4]) -> Option<Vec<Piece>> {
    let mut begin = 0.0;
    let mut pieces: Vec<Piece> = Vec::new();
    for length in lengths {
        pieces.push(Piece { begin, length: *length, ..Piece::default() });
        begin += length;
    }
    for (axis, course) in courses.iter().enumerate() {
        let joints = joints(lengths, course)?;
        for (piece, pair) in pieces.iter_mut().zip(joints.windows(2)) {
            let [from, to] = [scaled(pair[0], piece.length), scaled(pair[1], piece.length)];
            piece.terms[axis] = hermite(from, to);
        }
    }
    Some(pieces)
}

/// Derivatives by the share of a piece of this length.
fn scaled(joint: Joint, length: f64) -> Joint {
    let squared = length * length;
    [joint[0], joint[1] * length, joint[2] * squared, joint[3] * squared * length]
}

/// Coefficients of the polynomial over 0..=1 with these values and derivatives at its ends.
fn hermite(from: Joint, to: Joint) -> [f64; TERMS] {
    let [c0, c1, c2, c3] = [from[0], from[1], from[2] / 2.0, from[3] / 6.0];
    // What the powers four to seven must add at the end.
    let d0 = to[0] - c0 - c1 - c2 - c3;
    let d1 = to[1] - c1 - 2.0 * c2 - 3.0 * c3;
    let d2 = to[2] - 2.0 * c2 - 6.0 * c3;
    let d3 = to[3] - 6.0 * c3;
    [
        c0,
        c1,
        c2,
        c3,
        35.0 * d0 - 15.0 * d1 + 2.5 * d2 - d3 / 6.0,
        -84.0 * d0 + 39.0 * d1 - 7.0 * d2 + d3 / 2.0,
        70.0 * d0 - 34.0 * d1 + 6.5 * d2 - d3 / 2.0,
        -20.0 * d0 + 10.0 * d1 - 2.0 * d2 + d3 / 6.0,
    ]
}

/// The quadratic form: integral of the squared fourth derivative over 0..=1 for the ends' eight numbers.
fn form() -> [[f64; 8]; 8] {
    let unit = |k: usize, end: usize| {
        let mut ends = [[0.0; 4]; 2];
        ends[end][k] = 1.0;
        hermite(ends[0], ends[1])
    };
    let basis: [[f64; TERMS]; 8] = std::array::from_fn(|a| unit(a % 4, a / 4));
    let fourth = |k: usize| (k * (k - 1) * (k - 2) * (k - 3)) as f64;
    let product = |a: &[f64; TERMS], b: &[f64; TERMS]| {
        let mut sum = 0.0;
        for i in 4..TERMS {
            for j in 4..TERMS {
                sum += a[i] * b[j] * fourth(i) * fourth(j) / (i + j - 7) as f64;
            }
        }
        sum
    };
    std::array::from_fn(|a| std::array::from_fn(|b| product(&basis[a], &basis[b])))
}

/// Where each derivative of each joint stands among the unknowns; `None` where it is given. Also how many
/// unknowns there are.
fn unknowns(course: &Course) -> (Vec<[Option<usize>; 3]>, usize) {
    let own = course.given.len() - usize::from(course.closed);
    let mut count = 0;
    let mut places: Vec<[Option<usize>; 3]> = course.given[..own]
        .iter()
        .map(|given| {
            given.map(|given| {
                count += usize::from(given.is_none());
                given.is_none().then(|| count - 1)
            })
        })
        .collect();
    if course.closed {
        places.push(places[0]);
    }
    (places, count)
}

/// Values and derivatives at all joints, with the least snap.
fn joints(lengths: &[f64], course: &Course) -> Option<Vec<Joint>> {
    let (places, count) = unknowns(course);
    // Two neighbours have at most six unknowns; a closed course joins the last to the first.
    let half = if course.closed { count.saturating_sub(1) } else { 5 };
    let mut matrix = Banded::new(count, half);
    let mut right = vec![0.0; count];
    let form = form();
    for (i, length) in lengths.iter().enumerate() {
        let squared = length * length;
        let powers = [1.0, *length, squared, squared * length];
        let per = 1.0 / (squared * squared * squared * length);
        let place = |a: usize| (a % 4).checked_sub(1).and_then(|k| places[i + a / 4][k]);
        let given = |a: usize| match a % 4 {
            0 => course.values[i + a / 4],
            k => course.given[i + a / 4][k - 1].unwrap_or(0.0),
        };
        for a in 0..8 {
            let Some(row) = place(a) else { continue };
            for b in 0..8 {
                let entry = form[a][b] * powers[a % 4] * powers[b % 4] * per;
                match place(b) {
                    Some(column) => matrix.add(row, column, entry),
                    None => right[row] -= entry * given(b),
                }
            }
        }
    }
    let free = matrix.factor()?.solve(right);
    let joint = |i: usize| {
        let k = |k: usize| places[i][k].map_or(course.given[i][k].unwrap_or(0.0), |at| free[at]);
        [course.values[i], k(0), k(1), k(2)]
    };
    Some((0..course.values.len()).map(joint).collect())
}
