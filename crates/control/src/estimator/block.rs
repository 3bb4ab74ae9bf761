//! Three by three numbers: what [`covariance`](super::covariance) is made of.

use crate::math::{Frame, Vec3};
use crate::real::Real;

/// Three by three numbers, row by row.
pub type Block<T> = [[T; 3]; 3];

// Plain loops in place of closures over indices: the compiler does not inline those where they nest, and
// a call in the middle of the loop costs the wide registers.

/// Matrix product.
#[inline(always)]
pub fn product<T: Real>(a: &Block<T>, b: &Block<T>) -> Block<T> {
    let mut out = *a;
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
        }
    }
    out
}

/// Rows and columns exchanged.
#[inline(always)]
pub fn transposed<T: Real>(a: &Block<T>) -> Block<T> {
    let [[a, b, c], [d, e, f], [g, h, i]] = *a;
    [[a, d, g], [b, e, h], [c, f, i]]
}

/// Number by number.
#[inline(always)]
pub fn plus<T: Real>(a: &Block<T>, b: &Block<T>) -> Block<T> {
    let mut out = *a;
    for i in 0..3 {
        for j in 0..3 {
            out[i][j] += b[i][j];
        }
    }
    out
}

/// What multiplies a block from the left.
pub trait Factor<T: Real> {
    /// The product.
    fn of(&self, block: &Block<T>) -> Block<T>;
}

impl<T: Real> Factor<T> for Block<T> {
    #[inline(always)]
    fn of(&self, block: &Block<T>) -> Block<T> {
        product(self, block)
    }
}

/// A multiple of the identity.
#[derive(Clone, Copy, Debug)]
pub struct Multiple<T>(pub T);

impl<T: Real> Factor<T> for Multiple<T> {
    #[inline(always)]
    fn of(&self, block: &Block<T>) -> Block<T> {
        let mut out = *block;
        for row in &mut out {
            for x in row {
                *x = self.0 * *x;
            }
        }
        out
    }
}

/// The matrix with these columns.
#[inline(always)]
pub fn columns<T: Real, F: Frame>(x: Vec3<T, F>, y: Vec3<T, F>, z: Vec3<T, F>) -> Block<T> {
    [[x.x, y.x, z.x], [x.y, y.y, z.y], [x.z, y.z, z.z]]
}
