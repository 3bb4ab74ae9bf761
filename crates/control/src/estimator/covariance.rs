//! Covariance of the fifteen state errors, in blocks of three by three.
//!
//! The state is x = (p, v, theta, b_g, b_a); of the symmetric P the blocks on and above the diagonal
//! are kept. Every operation has the form of a congruence, so no rounding can break the symmetry:
//!
//!   x_i += M x_j:  P_ik += M P_jk (k != i),  P_ii += Y + Y',  Y = M (P_ij + P_ij_new)'/2     (1)
//!   x_i := E x_i:  P_ik := E P_ik (k != i),  P_ii := E P_ii E'                               (2)
//!   y = h'x + n:   c = P h,  s = h'c + r,  u = c/sqrt(s),  P -= u u',  gain = u/sqrt(s)      (3)
//!
//! (3) leaves of any variance at least the share r/s. Where r is below [`Covariance::SHARPEST`] of
//! h'P h it counts as that, so what is left stays far above what rounding takes away.
//!
//! Source: Bierman, Factorization Methods for Discrete Sequential Estimation (1977), for the scalar
//! update; the rest is linear algebra.

use crate::math::{Body, Vec3, World};
use crate::real::{Mask, Precision as _, Real};
use crate::record;
use crate::record::{Record as _, blend, from_index};

use super::block::{Block, Factor, Multiple, plus, product, transposed};

/// Fifteen numbers, three for each part of the state error.
pub type Parts<T> = [[T; 3]; 5];

/// Place of the position error among the parts.
pub const POSITION: usize = 0;
/// Place of the velocity error.
pub const VELOCITY: usize = 1;
/// Place of the attitude error.
pub const ATTITUDE: usize = 2;
/// Place of the gyro bias error.
pub const GYRO_BIAS: usize = 3;
/// Place of the accelerometer bias error.
pub const ACCELEROMETER_BIAS: usize = 4;

record! {
    /// One number for each of the fifteen state errors, true less estimated.
    pub struct ErrorState {
        /// Of the position.
        position: Vec3<T, World> [m];
        /// Of the velocity.
        velocity: Vec3<T, World> [m/s];
        /// Of the attitude, a rotation vector in the estimated body axes: R = R_est Exp(theta).
        attitude: Vec3<T, Body> [rad];
        /// Of the gyro bias.
        gyro_bias: Vec3<T, Body> [rad/s];
        /// Of the accelerometer bias.
        accelerometer_bias: Vec3<T, Body> [m/s^2];
    }
}

impl<T: Real> ErrorState<T> {
    /// The fifteen numbers in order.
    #[inline(always)]
    pub fn parts(&self) -> Parts<T> {
        let Self { position: p, velocity: v, attitude: a, gyro_bias: g, accelerometer_bias: b } =
            *self;
        [[p.x, p.y, p.z], [v.x, v.y, v.z], [a.x, a.y, a.z], [g.x, g.y, g.z], [b.x, b.y, b.z]]
    }

    /// From the fifteen numbers in order.
    #[inline(always)]
    pub fn from_parts([p, v, a, g, b]: Parts<T>) -> Self {
        Self {
            position: Vec3::new(p[0], p[1], p[2]),
            velocity: Vec3::new(v[0], v[1], v[2]),
            attitude: Vec3::new(a[0], a[1], a[2]),
            gyro_bias: Vec3::new(g[0], g[1], g[2]),
            accelerometer_bias: Vec3::new(b[0], b[1], b[2]),
        }
    }
}

record! {
    /// Covariance of the fifteen state errors.
    pub struct Covariance {
        /// Blocks on and above the diagonal, row by row; those on it are symmetric.
        block: [Block<T>; 15] [];
    }
}

/// Place of the block of row `i` and column `j`, `i <= j < 5`.
#[inline(always)]
const fn place(i: usize, j: usize) -> usize {
    i * (9 - i) / 2 + j
}

/// Whether the block at a place is on the diagonal.
const ON_DIAGONAL: [bool; 15] = {
    let mut on = [false; 15];
    let mut i = 0;
    while i < 5 {
        on[place(i, i)] = true;
        i += 1;
    }
    on
};

impl<T: Real> Covariance<T> {
    /// Smallest variance of a measurement, over that of its prediction: its correction takes no more
    /// digits than this leaves, in either precision.
    pub const SHARPEST: f64 = if T::Precision::ROUND < 1e9 { 1e-4 } else { 1e-8 };

    /// Independent errors with these standard deviations.
    pub fn diagonal(deviations: &ErrorState<T>) -> Self {
        let mut all = Self::default();
        let deviations = deviations.parts();
        let mut variances = deviations;
        for i in 0..5 {
            for a in 0..3 {
                variances[i][a] = deviations[i][a].sq();
            }
        }
        all.add(&ErrorState::from_parts(variances));
        all
    }

    /// The block of row `i` and column `j`, both below five.
    #[inline(always)]
    pub fn get(&self, i: usize, j: usize) -> Block<T> {
        if i <= j { self.block[place(i, j)] } else { transposed(&self.block[place(j, i)]) }
    }

    #[inline(always)]
    fn put(&mut self, i: usize, j: usize, block: Block<T>) {
        if i <= j {
            self.block[place(i, j)] = block;
        } else {
            self.block[place(j, i)] = transposed(&block);
        }
    }

    /// Variances.
    #[inline(always)]
    pub fn variances(&self) -> ErrorState<T> {
        let mut variances = [[T::zero(); 3]; 5];
        for i in 0..5 {
            for a in 0..3 {
                variances[i][a] = self.block[place(i, i)][a][a];
            }
        }
        ErrorState::from_parts(variances)
    }

    /// Adds to the variances.
    #[inline(always)]
    pub fn add(&mut self, variances: &ErrorState<T>) {
        let more = variances.parts();
        for i in 0..5 {
            for a in 0..3 {
                self.block[place(i, i)][a][a] += more[i][a];
            }
        }
    }

    /// Raises standard deviations that are lower, one bound for each part.
    #[inline(always)]
    pub fn raise(&mut self, lowest: [f64; 5]) {
        for i in 0..5 {
            for a in 0..3 {
                let variance = &mut self.block[place(i, i)][a][a];
                *variance = variance.max(T::lit(lowest[i] * lowest[i]));
            }
        }
    }

    /// Error `i` gains M times error `j` (1).
    #[inline(always)]
    pub fn shear(&mut self, i: usize, j: usize, m: &impl Factor<T>) {
        let (old, half) = (self.get(i, j), Multiple(T::lit(0.5)));
        for k in 0..5 {
            if k != i {
                self.put(i, k, plus(&self.get(i, k), &m.of(&self.get(j, k))));
            }
        }
        let mean = half.of(&plus(&old, &self.get(i, j)));
        let y = m.of(&transposed(&mean));
        self.put(i, i, plus(&self.get(i, i), &plus(&y, &transposed(&y))));
    }

    /// Error `i` is multiplied by E (2).
    #[inline(always)]
    pub fn turn(&mut self, i: usize, e: &Block<T>) {
        for k in 0..5 {
            if k != i {
                self.put(i, k, product(e, &self.get(i, k)));
            }
        }
        let half = product(e, &self.get(i, i));
        let whole = product(e, &transposed(&half));
        self.put(i, i, Multiple(T::lit(0.5)).of(&plus(&whole, &transposed(&whole))));
    }

    /// c = P h.
    #[inline(always)]
    pub fn apply(&self, h: &Parts<T>) -> Parts<T> {
        let mut c = [[T::zero(); 3]; 5];
        for i in 0..5 {
            for j in i..5 {
                let block = &self.block[place(i, j)];
                for a in 0..3 {
                    for b in 0..3 {
                        c[i][a] += block[a][b] * h[j][b];
                        if i != j {
                            c[j][b] += block[a][b] * h[i][a];
                        }
                    }
                }
            }
        }
        c
    }

    /// P -= u u', the second half of (3).
    #[inline(always)]
    pub fn deflate(&mut self, u: &Parts<T>) {
        for i in 0..5 {
            for j in i..5 {
                let block = &mut self.block[place(i, j)];
                for a in 0..3 {
                    for b in 0..3 {
                        block[a][b] -= u[i][a] * u[j][b];
                    }
                }
            }
        }
    }

    /// Brings variances above `highest` back to it and keeps the correlations; lanes that are not
    /// finite begin anew with these deviations. The answer tells where it did so.
    #[inline(always)]
    pub fn bound(&mut self, highest: T, deviations: &ErrorState<T>) -> T::Mask {
        let (mut largest, mut sum) = (T::zero(), [[T::zero(); 3]; 3]);
        for (k, block) in self.block.iter().enumerate() {
            sum = plus(&sum, block);
            for a in 0..3 {
                if ON_DIAGONAL[k] {
                    largest = largest.max(block[a][a].abs());
                }
            }
        }
        let sum = sum[0][0]
            + sum[0][1]
            + sum[0][2]
            + sum[1][0]
            + sum[1][1]
            + sum[1][2]
            + sum[2][0]
            + sum[2][1]
            + sum[2][2];
        let good = largest.le(highest) & sum.is_finite();
        if !good.all() {
            self.mend(highest, deviations);
        }
        !good
    }

    #[cold]
    #[inline(never)]
    fn mend(&mut self, highest: T, deviations: &ErrorState<T>) {
        *self = blend(self.finite(), self, &Self::diagonal(deviations));
        let scale: Parts<T> = from_index(|i| {
            from_index(|a| {
                let variance = self.block[place(i, i)][a][a];
                T::select(highest.lt(variance), (highest / variance).sqrt(), T::one())
            })
        });
        for i in 0..5 {
            for j in i..5 {
                let block = self.block[place(i, j)];
                self.block[place(i, j)] =
                    from_index(|a| from_index(|b| block[a][b] * scale[i][a] * scale[j][b]));
            }
        }
    }
}
