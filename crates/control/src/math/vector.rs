//! A vector with three components and a frame in its type.

use core::fmt::Debug;
use core::marker::PhantomData;
use core::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

use crate::real::Real;
use crate::record::{Meta, Path, Record, Uniform, Visitor, VisitorMut};

/// A coordinate frame, as a tag in types.
pub trait Frame: Copy + Debug + Default + 'static {
    /// Name in headers.
    const NAME: &'static str;
}

/// East, north, up; fixed to the ground.
#[derive(Clone, Copy, Debug, Default)]
pub struct World;

/// Forward, left, up; fixed to the vehicle, origin in the centre of mass.
#[derive(Clone, Copy, Debug, Default)]
pub struct Body;

impl Frame for World {
    const NAME: &'static str = "world";
}

impl Frame for Body {
    const NAME: &'static str = "body";
}

/// Three components in frame `F`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Vec3<T, F> {
    /// World: east. Body: forward.
    pub x: T,
    /// World: north. Body: left.
    pub y: T,
    /// Up.
    pub z: T,
    frame: PhantomData<F>,
}

impl<T: Real, F: Frame> Vec3<T, F> {
    /// The vector with these components.
    #[inline(always)]
    pub fn new(x: T, y: T, z: T) -> Self {
        Self { x, y, z, frame: PhantomData }
    }
    /// The zero vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::splat(T::zero())
    }
    /// Equal components.
    #[inline(always)]
    pub fn splat(c: T) -> Self {
        Self::new(c, c, c)
    }
    /// `length` times the unit vector upwards, e_z.
    #[inline(always)]
    pub fn up(length: T) -> Self {
        Self::new(T::zero(), T::zero(), length)
    }
    /// Scalar product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        self.x * other.x + self.y * other.y + self.z * other.z
    }
    /// Vector product, right-handed.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }
    /// Vector product with `e_z`.
    #[inline(always)]
    pub fn cross_up(self) -> Self {
        Self::new(self.y, -self.x, T::zero())
    }
    /// Square of the Euclidean length.
    #[inline(always)]
    pub fn norm_squared(self) -> T {
        self.dot(self)
    }
    /// Euclidean length.
    #[inline(always)]
    pub fn norm(self) -> T {
        self.norm_squared().sqrt()
    }
    /// The vector of length one; not finite for the zero vector.
    #[inline(always)]
    pub fn unit(self) -> Self {
        self * (T::one() / self.norm())
    }
    /// A function of each component.
    #[inline(always)]
    pub fn map(self, f: impl Fn(T) -> T) -> Self {
        Self::new(f(self.x), f(self.y), f(self.z))
    }
    /// Component by component: a diagonal matrix times the vector.
    #[inline(always)]
    pub fn scale(self, diagonal: Self) -> Self {
        Self::new(self.x * diagonal.x, self.y * diagonal.y, self.z * diagonal.z)
    }
    /// `a` where the mask says yes, else `b`.
    #[inline(always)]
    pub fn select(mask: T::Mask, a: Self, b: Self) -> Self {
        Self::new(T::select(mask, a.x, b.x), T::select(mask, a.y, b.y), T::select(mask, a.z, b.z))
    }
    /// The same components in another frame: the one loud way round the frame check.
    #[inline(always)]
    pub fn assume_frame<G: Frame>(self) -> Vec3<T, G> {
        Vec3::new(self.x, self.y, self.z)
    }
}

impl<T: Real, F: Frame> Add for Vec3<T, F> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<T: Real, F: Frame> Sub for Vec3<T, F> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<T: Real, F: Frame> Neg for Vec3<T, F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<T: Real, F: Frame> Mul<T> for Vec3<T, F> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, k: T) -> Self {
        Self::new(self.x * k, self.y * k, self.z * k)
    }
}

impl<T: Real, F: Frame> AddAssign for Vec3<T, F> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real, F: Frame> SubAssign for Vec3<T, F> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Real, F: Frame> Uniform for Vec3<T, F> {
    #[inline(always)]
    fn uniform(x: f64) -> Self {
        Self::splat(T::lit(x))
    }
}

impl<T: Real, F: Frame> Record<T> for Vec3<T, F> {
    type With<U: Real> = Vec3<U, F>;
    #[inline(always)]
    fn visit(&self, path: &Path<'_>, meta: &Meta, v: &mut impl Visitor<T>) {
        let meta = meta.in_frame(F::NAME);
        v.number(&path.join("x"), &meta, self.x);
        v.number(&path.join("y"), &meta, self.y);
        v.number(&path.join("z"), &meta, self.z);
    }
    #[inline(always)]
    fn visit_mut(&mut self, path: &Path<'_>, meta: &Meta, v: &mut impl VisitorMut<T>) {
        let meta = meta.in_frame(F::NAME);
        v.vector(path, &meta, &["x", "y", "z"]);
        v.number(&path.join("x"), &meta, &mut self.x);
        v.number(&path.join("y"), &meta, &mut self.y);
        v.number(&path.join("z"), &meta, &mut self.z);
    }
    #[inline(always)]
    fn zip<const M: usize, U: Real>(
        rows: [&Self; M],
        f: &mut impl FnMut([T; M]) -> U,
    ) -> Vec3<U, F> {
        Vec3 {
            x: f(crate::record::each(rows, |row| row.x)),
            y: f(crate::record::each(rows, |row| row.y)),
            z: f(crate::record::each(rows, |row| row.z)),
            frame: PhantomData,
        }
    }
    #[inline(always)]
    fn pick_part(&self, i: usize) -> Vec3<T::Part, F> {
        Vec3 { x: self.x.part(i), y: self.y.part(i), z: self.z.part(i), frame: PhantomData }
    }
    #[inline(always)]
    fn onto<U: Real>(&self, batch: &mut Vec3<U, F>, f: &mut impl FnMut(&mut U, T)) {
        f(&mut batch.x, self.x);
        f(&mut batch.y, self.y);
        f(&mut batch.z, self.z);
    }
    #[inline(always)]
    fn each_variable(&self, f: &mut impl FnMut(T)) {
        f(self.x);
        f(self.y);
        f(self.z);
    }
}
