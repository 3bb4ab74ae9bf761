//! Symmetric positive definite equations with a narrow band.
//!
//! Plain sums and square roots in a fixed order: a library that picks fused instructions by machine would
//! make a reference, and so every flight along it, differ in the last bits from machine to machine.

/// The lower half of a symmetric matrix whose entries vanish further than `half` from the diagonal.
pub(super) struct Banded {
    half: usize,
    size: usize,
    cells: Vec<f64>,
}

impl Banded {
    /// Zeros.
    pub fn new(size: usize, half: usize) -> Self {
        Self { half, size, cells: vec![0.0; size * (half + 1)] }
    }

    /// Place of row `i`, column `j <= i`.
    fn place(&self, i: usize, j: usize) -> usize {
        i * (self.half + 1) + j + self.half - i
    }

    /// Adds to the entry in row `i`, column `j`; one half of the matrix is enough, the other is passed over.
    pub fn add(&mut self, i: usize, j: usize, x: f64) {
        if j <= i {
            let place = self.place(i, j);
            self.cells[place] += x;
        }
    }

    /// First column of row `i` inside the band.
    fn first(&self, i: usize) -> usize {
        i.saturating_sub(self.half)
    }

    /// The factor L of L L^T (Cholesky); `None` where the matrix is not positive definite.
    pub fn factor(mut self) -> Option<Factor> {
        for i in 0..self.size {
            for j in self.first(i)..=i {
                let from = self.first(i);
                let from = if self.first(j) > from { self.first(j) } else { from };
                let product = |k| self.cells[self.place(i, k)] * self.cells[self.place(j, k)];
                let rest = self.cells[self.place(i, j)] - (from..j).map(product).sum::<f64>();
                let place = self.place(i, j);
                self.cells[place] = if i > j {
                    rest / self.cells[self.place(j, j)]
                } else if rest > 0.0 && rest.is_finite() {
                    rest.sqrt()
                } else {
                    return None;
                };
            }
        }
        Some(Factor(self))
    }
}

/// A factorised matrix.
pub(super) struct Factor(Banded);

impl Factor {
    /// The solution for this right-hand side.
    pub fn solve(&self, mut x: Vec<f64>) -> Vec<f64> {
        let l = &self.0;
        for i in 0..l.size {
            let known: f64 = (l.first(i)..i).map(|k| l.cells[l.place(i, k)] * x[k]).sum();
            x[i] = (x[i] - known) / l.cells[l.place(i, i)];
        }
        for i in (0..l.size).rev() {
            x[i] /= l.cells[l.place(i, i)];
            for k in l.first(i)..i {
                x[k] -= l.cells[l.place(i, k)] * x[i];
            }
        }
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solution_solves_and_an_indefinite_matrix_is_refused() {
        let full = [[4.0, 1.0, 0.0], [1.0, 3.0, -1.0], [0.0, -1.0, 2.0]];
        let mut matrix = Banded::new(3, 1);
        for (i, row) in full.iter().enumerate() {
            for j in i.saturating_sub(1)..=i {
                matrix.add(i, j, row[j]);
            }
        }
        let want = [1.0, -2.0, 0.5];
        let right = full.map(|row| row.iter().zip(want).map(|(a, x)| a * x).sum());
        let got = matrix.factor().map(|factor| factor.solve(right.to_vec())).unwrap_or_default();
        assert!(got.iter().zip(want).all(|(a, b)| (a - b).abs() < 1e-14), "{got:?}");
        let mut bad = Banded::new(2, 1);
        bad.add(0, 0, 1.0);
        bad.add(1, 0, 2.0);
        bad.add(1, 1, 1.0);
        assert!(bad.factor().is_none());
    }
}
