//! Several numbers side by side: the same law for `N` vehicles in one pass.
//!
//! Every operation is the scalar one, lane by lane, so a lane has the bits of a single run. The
//! loops are short and of fixed length; the compiler turns them into vector instructions.

use core::ops::{
    Add, AddAssign, BitAnd, BitOr, Div, Index, IndexMut, Mul, Neg, Not, Sub, SubAssign,
};

use crate::real::{Mask, Real};

/// `N` numbers side by side, one for each vehicle of a batch.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct Lanes<T, const N: usize>(pub [T; N]);

/// `N` answers side by side.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub struct LaneMask<const N: usize>(pub [u64; N]);

impl<T: Real, const N: usize> Default for Lanes<T, N> {
    #[inline(always)]
    fn default() -> Self {
        Self([T::default(); N])
    }
}

impl<T, const N: usize> Index<usize> for Lanes<T, N> {
    type Output = T;
    #[inline(always)]
    fn index(&self, i: usize) -> &T {
        &self.0[i % N]
    }
}

impl<T, const N: usize> IndexMut<usize> for Lanes<T, N> {
    #[inline(always)]
    fn index_mut(&mut self, i: usize) -> &mut T {
        &mut self.0[i % N]
    }
}

macro_rules! arithmetic {
    ($($trait:ident $method:ident),*) => { $(
        impl<T: Real, const N: usize> $trait for Lanes<T, N> {
            type Output = Self;
            #[inline(always)]
            fn $method(mut self, other: Self) -> Self {
                for i in 0..N {
                    self.0[i] = $trait::$method(self.0[i], other.0[i]);
                }
                self
            }
        }
    )* };
}
arithmetic! { Add add, Sub sub, Mul mul, Div div }

impl<T: Real, const N: usize> AddAssign for Lanes<T, N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<T: Real, const N: usize> SubAssign for Lanes<T, N> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<T: Real, const N: usize> Neg for Lanes<T, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.each(|x| -x)
    }
}

impl<const N: usize> BitAnd for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn bitand(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] &= other.0[i];
        }
        self
    }
}

impl<const N: usize> BitOr for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn bitor(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] |= other.0[i];
        }
        self
    }
}

impl<const N: usize> Not for LaneMask<N> {
    type Output = Self;
    #[inline(always)]
    fn not(mut self) -> Self {
        for i in 0..N {
            self.0[i] = !self.0[i];
        }
        self
    }
}

impl<const N: usize> Mask for LaneMask<N> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([word(value); N])
    }
    #[inline(always)]
    fn all(self) -> bool {
        let mut all = u64::MAX;
        for i in 0..N {
            all &= self.0[i];
        }
        all != 0
    }
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        self.0[i % N] != 0
    }
    #[inline(always)]
    fn from_lanes(mut f: impl FnMut(usize) -> bool) -> Self {
        let mut mask = [0; N];
        for (i, lane) in mask.iter_mut().enumerate() {
            *lane = word(f(i));
        }
        Self(mask)
    }
}

/// A truth value as a word of ones or zeros, the form in which wide registers hold it.
#[inline(always)]
fn word(value: bool) -> u64 {
    if value { u64::MAX } else { 0 }
}

impl<T: Real, const N: usize> Lanes<T, N> {
    #[inline(always)]
    fn each(mut self, f: impl Fn(T) -> T) -> Self {
        for i in 0..N {
            self.0[i] = f(self.0[i]);
        }
        self
    }
}

impl<T: Real<Mask = bool, Scalar = T, Part = T>, const N: usize> Lanes<T, N> {
    #[inline(always)]
    fn compare(self, other: Self, f: impl Fn(T, T) -> bool) -> LaneMask<N> {
        let mut mask = [0; N];
        for i in 0..N {
            mask[i] = word(f(self.0[i], other.0[i]));
        }
        LaneMask(mask)
    }
}

impl<T: Real<Mask = bool, Scalar = T, Part = T>, const N: usize> Real for Lanes<T, N> {
    type Mask = LaneMask<N>;
    type Scalar = T;
    type Part = T;
    type Precision = T::Precision;
    const LANES: usize = N;
    const PARTS: usize = N;

    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self([T::lit(x); N])
    }
    #[inline(always)]
    fn lane(&self, i: usize) -> T {
        self.0[i % N]
    }
    #[inline(always)]
    fn set_lane(&mut self, i: usize, x: T) {
        self.0[i % N] = x;
    }
    #[inline(always)]
    fn from_lanes(mut f: impl FnMut(usize) -> T) -> Self {
        let mut lanes = [T::default(); N];
        for (i, lane) in lanes.iter_mut().enumerate() {
            *lane = f(i);
        }
        Self(lanes)
    }
    #[inline(always)]
    fn part(&self, i: usize) -> T {
        self.lane(i)
    }
    #[inline(always)]
    fn set_part(&mut self, i: usize, x: T) {
        self.set_lane(i, x);
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.lane(0).to_f64()
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.each(T::sqrt)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.each(T::abs)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> LaneMask<N> {
        self.compare(other, T::lt)
    }
    #[inline(always)]
    fn le(self, other: Self) -> LaneMask<N> {
        self.compare(other, T::le)
    }
    #[inline(always)]
    fn eq(self, other: Self) -> LaneMask<N> {
        self.compare(other, T::eq)
    }
    #[inline(always)]
    fn is_finite(self) -> LaneMask<N> {
        self.compare(self, |x, _| x.is_finite())
    }
    #[inline(always)]
    fn select(mask: LaneMask<N>, a: Self, b: Self) -> Self {
        let mut out = b;
        for i in 0..N {
            out.0[i] = T::select(mask.0[i] != 0, a.0[i], b.0[i]);
        }
        out
    }
    #[inline(always)]
    fn after_quarters(sine: Self, cosine: Self, n: Self) -> (Self, Self) {
        let (mut s, mut c) = (sine, cosine);
        for i in 0..N {
            (s.0[i], c.0[i]) = T::after_quarters(sine.0[i], cosine.0[i], n.0[i]);
        }
        (s, c)
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        let (mut m, mut e) = (self, self);
        for i in 0..N {
            (m.0[i], e.0[i]) = self.0[i].split_exponent();
        }
        (m, e)
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        self.each(T::power_of_two)
    }
    #[inline(always)]
    fn inverse_cbrt_guess(self) -> Self {
        self.each(T::inverse_cbrt_guess)
    }

    // The elementary functions are long: as a loop over the lanes, the compiler's loop vectoriser
    // takes them whole, where it would lose its way in eight copies of the body.
    #[inline(always)]
    fn floor(self) -> Self {
        self.each(T::floor)
    }
    #[inline(always)]
    fn asin(self) -> Self {
        self.each(T::asin)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        self.each(T::exp)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.each(T::ln)
    }
    #[inline(always)]
    fn cbrt(self) -> Self {
        self.each(T::cbrt)
    }
    #[inline(always)]
    fn thirds(self) -> [Self; 2] {
        let (mut one, mut two) = (self, self);
        for i in 0..N {
            [one.0[i], two.0[i]] = self.0[i].thirds();
        }
        [one, two]
    }
    #[inline(always)]
    fn atan2(mut self, x: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i].atan2(x.0[i]);
        }
        self
    }
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (mut sin, mut cos) = (self, self);
        for i in 0..N {
            (sin.0[i], cos.0[i]) = self.0[i].sin_cos();
        }
        (sin, cos)
    }
}
