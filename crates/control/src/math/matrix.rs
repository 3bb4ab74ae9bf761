//! The one matrix operation that laws need: the inverse of a rotor layout's effect.

/// Inverse of a 4 x 4 matrix by Gauss-Jordan elimination with row pivoting; `None` where the matrix
/// is singular to working precision or not finite.
pub fn inverse4(mut a: [[f64; 4]; 4]) -> Option<[[f64; 4]; 4]> {
    let mut inverse = [[0.0; 4]; 4];
    for (i, row) in inverse.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    let magnitude = |x: f64| if x < 0.0 { -x } else { x };
    let mut largest = 0.0;
    for entry in a.iter().flatten() {
        largest = if magnitude(*entry) > largest { magnitude(*entry) } else { largest };
    }
    for column in 0..4 {
        let mut pivot = column;
        for row in column + 1..4 {
            if magnitude(a[row][column]) > magnitude(a[pivot][column]) {
                pivot = row;
            }
        }
        let scale = a[pivot][column];
        if !(magnitude(scale) > largest * 1e-14 && magnitude(scale) < f64::INFINITY) {
            return None;
        }
        a.swap(column, pivot);
        inverse.swap(column, pivot);
        for k in 0..4 {
            a[column][k] /= scale;
            inverse[column][k] /= scale;
        }
        for row in 0..4 {
            if row != column {
                let factor = a[row][column];
                for k in 0..4 {
                    a[row][k] -= factor * a[column][k];
                    inverse[row][k] -= factor * inverse[column][k];
                }
            }
        }
    }
    Some(inverse)
}
