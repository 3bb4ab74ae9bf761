//! Rotations: a unit Hamilton quaternion that takes coordinates in one frame to another.

use core::marker::PhantomData;
use core::ops::Mul;

use crate::math::{Body, Frame, Vec3, World};
use crate::real::{Mask as _, Real};
use crate::record;
use crate::record::{Meta, Path, Record, Visitor, VisitorMut};

record! {
    /// Roll, pitch and yaw in the order Z-Y-X: R = Rz(yaw) Ry(pitch) Rx(roll).
    pub struct Euler {
        /// About the body's forward axis, in -pi..=pi.
        roll: T [rad];
        /// About the left axis, in -pi/2..=pi/2.
        pitch: T [rad];
        /// About the world's up axis, in -pi..=pi.
        yaw: T [rad];
    }
}

/// Takes coordinates in `A` to coordinates in `B`; a unit quaternion `w + xi + yj + zk`.
#[derive(Clone, Copy, Debug)]
pub struct Rotation<T, A, B> {
    /// Scalar part.
    pub w: T,
    /// First component of the vector part.
    pub x: T,
    /// Second component of the vector part.
    pub y: T,
    /// Third component of the vector part.
    pub z: T,
    frames: PhantomData<(A, B)>,
}

impl<T: Real, A: Frame, B: Frame> Default for Rotation<T, A, B> {
    #[inline(always)]
    fn default() -> Self {
        Self::identity()
    }
}

impl<T: Real, A: Frame, B: Frame> Rotation<T, A, B> {
    /// The rotation with this unit quaternion; the caller sees to the norm.
    #[inline(always)]
    pub fn from_quaternion(w: T, x: T, y: T, z: T) -> Self {
        Self { w, x, y, z, frames: PhantomData }
    }
    /// The rotation that changes nothing.
    #[inline(always)]
    pub fn identity() -> Self {
        Self::from_quaternion(T::one(), T::zero(), T::zero(), T::zero())
    }
    /// The opposite rotation.
    #[inline(always)]
    pub fn inverse(self) -> Rotation<T, B, A> {
        Rotation::from_quaternion(self.w, -self.x, -self.y, -self.z)
    }
    /// The quaternion scaled to norm one.
    #[inline(always)]
    pub fn normalised(self) -> Self {
        let norm = (self.w.sq() + self.x.sq() + self.y.sq() + self.z.sq()).sqrt();
        let k = T::one() / norm;
        Self::from_quaternion(self.w * k, self.x * k, self.y * k, self.z * k)
    }
    /// [`Rotation::normalised`] for a norm that is nearly one, as after a step of integration: a series
    /// takes the place of root and division where it has all digits.
    #[inline(always)]
    pub fn renormalised(self) -> Self {
        let lost = T::one() - ((self.w.sq() + self.x.sq()) + (self.y.sq() + self.z.sq()));
        let near = lost.abs().lt(T::lit(1e-6));
        // 1/sqrt(1 - d) = 1 + d/2 + 3 d^2/8 + ...; what is added is small, so rounding takes little of it.
        let more = lost * (T::lit(0.5) + lost * T::lit(0.375));
        let grown = |x: T| x + x * more;
        let scaled =
            Self::from_quaternion(grown(self.w), grown(self.x), grown(self.y), grown(self.z));
        if near.all() {
            return scaled;
        }
        Self::select(near, scaled, self.normalised())
    }
    /// `a` where the mask says yes, else `b`.
    #[inline(always)]
    pub fn select(mask: T::Mask, a: Self, b: Self) -> Self {
        Self::from_quaternion(
            T::select(mask, a.w, b.w),
            T::select(mask, a.x, b.x),
            T::select(mask, a.y, b.y),
            T::select(mask, a.z, b.z),
        )
    }
    /// The vector part of the quaternion.
    #[inline(always)]
    pub fn vector(self) -> Vec3<T, A> {
        Vec3::new(self.x, self.y, self.z)
    }
    /// The same rotation with non-negative scalar part.
    #[inline(always)]
    pub fn shortest(self) -> Self {
        let sign = T::one().with_sign(self.w);
        Self::from_quaternion(self.w * sign, self.x * sign, self.y * sign, self.z * sign)
    }
    /// Rotation angle in rad, in 0..=pi.
    #[inline(always)]
    pub fn angle(self) -> T {
        self.vector().norm().atan2(self.w.abs()) * T::lit(2.0)
    }
    /// The third axis of `A` in coordinates of `B`: R `e_z`.
    #[inline(always)]
    pub fn z_axis(self) -> Vec3<T, B> {
        let two = T::lit(2.0);
        Vec3::new(
            two * (self.x * self.z + self.w * self.y),
            two * (self.y * self.z - self.w * self.x),
            T::one() - two * (self.x.sq() + self.y.sq()),
        )
    }
    /// `length` along the third axis of `A` in coordinates of `B`: R (length `e_z`).
    #[inline(always)]
    pub fn up(self, length: T) -> Vec3<T, B> {
        let twice = length + length;
        Vec3::new(
            (self.x * self.z + self.w * self.y) * twice,
            (self.y * self.z - self.w * self.x) * twice,
            length - (self.x.sq() + self.y.sq()) * twice,
        )
    }
    /// The first axis of `A` in coordinates of `B`: R `e_x`.
    #[inline(always)]
    pub fn x_axis(self) -> Vec3<T, B> {
        let two = T::lit(2.0);
        Vec3::new(
            T::one() - two * (self.y.sq() + self.z.sq()),
            two * (self.x * self.y + self.w * self.z),
            two * (self.x * self.z - self.w * self.y),
        )
    }
    /// The second axis of `A` in coordinates of `B`: R `e_y`.
    #[inline(always)]
    pub fn y_axis(self) -> Vec3<T, B> {
        let two = T::lit(2.0);
        Vec3::new(
            two * (self.x * self.y - self.w * self.z),
            T::one() - two * (self.x.sq() + self.z.sq()),
            two * (self.y * self.z + self.w * self.x),
        )
    }
    /// The rotation whose matrix has these columns: the axes of `A` in coordinates of `B`, which
    /// must be orthonormal and right-handed. The largest of the four quaternion components is found
    /// first, so no digit is lost at any attitude (Shepperd 1978).
    #[inline(always)]
    pub fn from_axes(x: Vec3<T, B>, y: Vec3<T, B>, z: Vec3<T, B>) -> Self {
        Self::from_scaled_axes(x, y, z, T::one())
    }
    /// [`Rotation::from_scaled_axes`] by its scalar part w alone, and 4 w^2 times `one`: good where that is
    /// well above zero, and of the same bits where no other component is larger.
    #[inline(always)]
    pub fn from_upright_axes(x: Vec3<T, B>, y: Vec3<T, B>, z: Vec3<T, B>, one: T) -> (Self, T) {
        let w4 = (one + x.x) + (y.y + z.z);
        let k = T::lit(0.5).over_root(w4 * one);
        let (wx, wy, wz) = (y.z - z.y, z.x - x.z, x.y - y.x);
        (Self::from_quaternion(w4 * k, wx * k, wy * k, wz * k), w4)
    }
    /// [`Rotation::from_axes`] for axes that all have the length `one`.
    #[inline(always)]
    pub fn from_scaled_axes(x: Vec3<T, B>, y: Vec3<T, B>, z: Vec3<T, B>, one: T) -> Self {
        // Four times the square of each component; the largest is at least one.
        let w4 = (one + x.x) + (y.y + z.z);
        let x4 = one + x.x - y.y - z.z;
        let y4 = one - x.x + y.y - z.z;
        let z4 = one - x.x - y.y + z.z;
        // Four times the product of two components.
        let (wx, wy, wz) = (y.z - z.y, z.x - x.z, x.y - y.x);
        let (xy, xz, yz) = (x.y + y.x, z.x + x.z, y.z + z.y);
        // Each candidate is the quaternion times four times its own component.
        let larger = |a: (T, Self), b: (T, Self)| {
            let better = a.0.lt(b.0);
            (T::select(better, b.0, a.0), Self::select(better, b.1, a.1))
        };
        let of = Self::from_quaternion;
        let w = (w4, of(w4, wx, wy, wz));
        let x = (x4, of(wx, x4, xy, xz));
        let y = (y4, of(wy, xy, y4, yz));
        let z = (z4, of(wz, xz, yz, z4));
        let (largest, q) = larger(larger(larger(w, x), y), z);
        // The candidate's norm is four times its own component times `one`.
        let k = T::lit(0.5).over_root(largest * one);
        Self::from_quaternion(q.w * k, q.x * k, q.y * k, q.z * k)
    }
}

impl<T: Real> Rotation<T, Body, World> {
    /// The attitude with these Euler angles.
    #[inline(always)]
    pub fn from_euler(angles: Euler<T>) -> Self {
        let (sr, cr) = angles.roll.half().sin_cos();
        let (sp, cp) = angles.pitch.half().sin_cos();
        let (sy, cy) = angles.yaw.half().sin_cos();
        Self::from_quaternion(
            cr * cp * cy + sr * sp * sy,
            sr * cp * cy - cr * sp * sy,
            cr * sp * cy + sr * cp * sy,
            cr * cp * sy - sr * sp * cy,
        )
    }
    /// Euler angles of the attitude; roll and yaw are not unique at a pitch of 90 deg.
    #[inline(always)]
    pub fn euler(self) -> Euler<T> {
        let (x, z) = (self.x_axis(), self.z_axis());
        let y_up = T::lit(2.0) * (self.y * self.z + self.w * self.x);
        Euler { roll: y_up.atan2(z.z), pitch: -x.z.asin(), yaw: x.y.atan2(x.x) }
    }
}

impl<T: Real, A: Frame, B: Frame> Mul<Vec3<T, A>> for Rotation<T, A, B> {
    type Output = Vec3<T, B>;
    #[inline(always)]
    fn mul(self, v: Vec3<T, A>) -> Vec3<T, B> {
        let q = self.vector();
        let t = q.cross(v) * T::lit(2.0);
        (v + t * self.w + q.cross(t)).assume_frame()
    }
}

#[allow(clippy::mismatching_type_param_order)] // from A through B to C: the order is the meaning
impl<T: Real, A: Frame, B: Frame, C: Frame> Mul<Rotation<T, A, B>> for Rotation<T, B, C> {
    type Output = Rotation<T, A, C>;
    #[inline(always)]
    fn mul(self, r: Rotation<T, A, B>) -> Rotation<T, A, C> {
        Rotation::from_quaternion(
            (self.w * r.w - self.x * r.x) - (self.y * r.y + self.z * r.z),
            (self.w * r.x + self.x * r.w) + (self.y * r.z - self.z * r.y),
            (self.w * r.y + self.y * r.w) + (self.z * r.x - self.x * r.z),
            (self.w * r.z + self.z * r.w) + (self.x * r.y - self.y * r.x),
        )
    }
}

impl<T: Real, A: Frame, B: Frame> Record<T> for Rotation<T, A, B> {
    type With<U: Real> = Rotation<U, A, B>;
    #[inline(always)]
    fn visit(&self, path: &Path<'_>, meta: &Meta, v: &mut impl Visitor<T>) {
        v.number(&path.join("w"), meta, self.w);
        v.number(&path.join("x"), meta, self.x);
        v.number(&path.join("y"), meta, self.y);
        v.number(&path.join("z"), meta, self.z);
    }
    #[inline(always)]
    fn visit_mut(&mut self, path: &Path<'_>, meta: &Meta, v: &mut impl VisitorMut<T>) {
        v.number(&path.join("w"), meta, &mut self.w);
        v.number(&path.join("x"), meta, &mut self.x);
        v.number(&path.join("y"), meta, &mut self.y);
        v.number(&path.join("z"), meta, &mut self.z);
    }
    #[inline(always)]
    fn zip<const M: usize, U: Real>(
        rows: [&Self; M],
        f: &mut impl FnMut([T; M]) -> U,
    ) -> Rotation<U, A, B> {
        Rotation {
            w: f(crate::record::each(rows, |row| row.w)),
            x: f(crate::record::each(rows, |row| row.x)),
            y: f(crate::record::each(rows, |row| row.y)),
            z: f(crate::record::each(rows, |row| row.z)),
            frames: PhantomData,
        }
    }
    #[inline(always)]
    fn pick_part(&self, i: usize) -> Rotation<T::Part, A, B> {
        Rotation {
            w: self.w.part(i),
            x: self.x.part(i),
            y: self.y.part(i),
            z: self.z.part(i),
            frames: PhantomData,
        }
    }
    #[inline(always)]
    fn onto<U: Real>(&self, batch: &mut Rotation<U, A, B>, f: &mut impl FnMut(&mut U, T)) {
        f(&mut batch.w, self.w);
        f(&mut batch.x, self.x);
        f(&mut batch.y, self.y);
        f(&mut batch.z, self.z);
    }
    #[inline(always)]
    fn each_variable(&self, f: &mut impl FnMut(T)) {
        f(self.w);
        f(self.x);
        f(self.y);
        f(self.z);
    }
}
