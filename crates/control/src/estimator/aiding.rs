//! What each kind of sensor says of the state: its rows of the measurement matrix.
//!
//! With R, p, v the state when the sample was taken, in the notation of [`past`](super::past):
//!
//!   position:   z = p + n                     g_p = e_i                                      (1)
//!   velocity:   z = v + n                     g_v = e_i                                      (2)
//!   attitude:   z = R Exp(n),  r = 2 vec(R_est' z)     g_theta = e_i                         (3)
//!   flow:       z = R'v + n,   u = R'v        g_v = R e_i,  g_theta = e_i x u                (4)
//!   height:     z = p_z + n                   g_p = e_z                                      (5)
//!   heading:    z = R'm + n,   r = -(e_z x m).R z / m_h^2,   g_theta = R'(e_z - (m_z/m_h^2) m_hor)   (6)
//!
//! Of the magnetic field m only the component across its horizontal part m_hor, of length m_h, is
//! used: the heading. The gradient has the tilt errors in it, which turn the field's vertical part
//! into the horizontal plane. (3) is a rotation vector for small errors; beyond, its length is 2 sin of
//! half the angle.

use crate::math::{Body, Frame, Rotation, Vec3, World};
use crate::real::Real;

use super::past::{Past, Row};

/// The unit vectors along the axes.
#[inline(always)]
fn axes<T: Real, F: Frame>() -> [Vec3<T, F>; 3] {
    let (one, zero) = (T::one(), T::zero());
    [Vec3::new(one, zero, zero), Vec3::new(zero, one, zero), Vec3::new(zero, zero, one)]
}

impl<T: Real> Past<T> {
    /// Measured position, with its standard deviation along each axis, m (1).
    #[inline(always)]
    pub fn position(&self, z: Vec3<T, World>, sigma: Vec3<T, World>) -> [Row<T>; 3] {
        let (r, [x, y, z]) = (z - self.position, axes());
        let still = Vec3::zero();
        [
            self.row([x, still], Vec3::zero(), r.x, sigma.x),
            self.row([y, still], Vec3::zero(), r.y, sigma.y),
            self.row([z, still], Vec3::zero(), r.z, sigma.z),
        ]
    }

    /// Measured velocity, with its standard deviation along each axis, m/s (2).
    #[inline(always)]
    pub fn velocity(&self, z: Vec3<T, World>, sigma: Vec3<T, World>) -> [Row<T>; 3] {
        let (r, [x, y, z]) = (z - self.velocity, axes());
        let here = Vec3::zero();
        [
            self.row([here, x], Vec3::zero(), r.x, sigma.x),
            self.row([here, y], Vec3::zero(), r.y, sigma.y),
            self.row([here, z], Vec3::zero(), r.z, sigma.z),
        ]
    }

    /// Measured attitude, with its standard deviation about each body axis, rad (3).
    #[inline(always)]
    pub fn attitude(&self, z: Rotation<T, Body, World>, sigma: T) -> [Row<T>; 3] {
        let error: Rotation<T, Body, Body> = self.attitude.inverse() * z;
        let (r, [x, y, z]) = (error.shortest().vector() * T::lit(2.0), axes());
        let none = [Vec3::zero(); 2];
        [
            self.row(none, x, r.x, sigma),
            self.row(none, y, r.y, sigma),
            self.row(none, z, r.z, sigma),
        ]
    }

    /// Measured forward and left velocity, with their standard deviation, m/s (4).
    #[inline(always)]
    pub fn flow(&self, [forward, left]: [T; 2], sigma: T) -> [Row<T>; 2] {
        let u = self.attitude.inverse() * self.velocity;
        let ([x, y, _], here) = (axes::<T, Body>(), Vec3::zero());
        [
            self.row([here, self.attitude.x_axis()], x.cross(u), forward - u.x, sigma),
            self.row([here, self.attitude.y_axis()], y.cross(u), left - u.y, sigma),
        ]
    }

    /// Measured height, with its standard deviation, m (5).
    #[inline(always)]
    pub fn height(&self, z: T, sigma: T) -> Row<T> {
        let up = [Vec3::up(T::one()), Vec3::zero()];
        self.row(up, Vec3::zero(), z - self.position.z, sigma)
    }

    /// Measured magnetic field, with the standard deviation of each component, where the field is
    /// `field`; all in the same unit (6). A vertical field tells nothing: its row is not finite.
    #[inline(always)]
    pub fn heading(&self, z: Vec3<T, Body>, field: Vec3<T, World>, sigma: T) -> Row<T> {
        let horizontal = Vec3::new(field.x, field.y, T::zero());
        let per_square = T::one() / horizontal.norm_squared();
        let across: Vec3<T, World> = Vec3::new(-field.y, field.x, T::zero());
        let residual = -(across.dot(self.attitude * z) * per_square);
        let gradient = Vec3::up(T::one()) - horizontal * (field.z * per_square);
        let gradient = self.attitude.inverse() * gradient;
        self.row([Vec3::zero(); 2], gradient, residual, sigma * per_square.sqrt())
    }
}
