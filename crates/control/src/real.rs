//! The scalar that every law is written in: one number, or several side by side.
//!
//! A law is generic over [`Real`]. There is no ordering on it, so a law cannot branch on data; it
//! selects. Only operations that every target rounds in the same way are offered, therefore a law
//! gives the same bits on every target and in every lane.

use core::fmt::Debug;
use core::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Not, Sub, SubAssign};

use crate::special;

/// The answer of a comparison: one truth value a lane.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// The same answer in every lane.
    fn splat(value: bool) -> Self;
    /// Whether the answer is yes in every lane. The only door from data to a branch: use it where
    /// both branches give the same bits.
    fn all(self) -> bool;
    /// The answer of lane `i`; lanes count from zero and wrap.
    fn lane(self, i: usize) -> bool;
    /// Builds the answer lane by lane.
    fn from_lanes(f: impl FnMut(usize) -> bool) -> Self;
}

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
    #[inline(always)]
    fn lane(self, _: usize) -> bool {
        self
    }
    #[inline(always)]
    fn from_lanes(mut f: impl FnMut(usize) -> bool) -> Self {
        f(0)
    }
}

/// Constants that differ between single and double precision. Cody-Waite parts are split so that
/// `n * part` is exact for every quotient `n` in the documented range.
pub trait Precision {
    /// Largest magnitude for which [`Real::sin_cos`] is accurate; beyond it the angle counts as zero.
    const ANGLE_LIMIT: f64;
    /// Four parts of pi/2, leading bits first.
    const HALF_PI: [f64; 4];
    /// Two parts of ln 2, leading bits first.
    const LN_2: [f64; 2];
    /// Range of [`Real::exp`]'s argument; beyond it the argument is clamped.
    const EXP_RANGE: [f64; 2];
    /// Smallest positive normal number.
    const TINY: f64;
    /// Adding and subtracting this rounds a smaller magnitude to the nearest integer.
    const ROUND: f64;
}

/// A number or several numbers side by side.
pub trait Real:
    'static
    + Copy
    + Default
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
{
    /// The answer of a comparison.
    type Mask: Mask;
    /// The number in one lane.
    type Scalar: Real<Scalar = Self::Scalar>;
    /// What a loop over the parts takes at once: the number in one lane, or a whole register of several.
    type Part: Real<Scalar = Self::Scalar, Part = Self::Part>;
    /// Constants of this precision.
    type Precision: Precision;
    /// How many numbers stand side by side.
    const LANES: usize;
    /// How many parts these are.
    const PARTS: usize;

    /// A literal: every constant enters here, rounded to this precision.
    fn lit(x: f64) -> Self;
    /// The number in lane `i`; lanes count from zero and wrap.
    fn lane(&self, i: usize) -> Self::Scalar;
    /// Replaces the number in lane `i`; lanes count from zero and wrap.
    fn set_lane(&mut self, i: usize, x: Self::Scalar);
    /// Builds the number lane by lane: the door for anything that depends on data.
    fn from_lanes(f: impl FnMut(usize) -> Self::Scalar) -> Self;
    /// Part `i`; parts count from zero and wrap.
    fn part(&self, i: usize) -> Self::Part;
    /// Replaces part `i`; parts count from zero and wrap.
    fn set_part(&mut self, i: usize, x: Self::Part);
    /// The value in double precision; lane zero where there are several.
    fn to_f64(self) -> f64;

    /// Correctly rounded square root; NaN below zero.
    fn sqrt(self) -> Self;
    /// Magnitude.
    fn abs(self) -> Self;
    /// Whether `self < other`; false where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Whether `self <= other`; false where either is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Whether the numbers are equal; false where either is NaN.
    fn eq(self, other: Self) -> Self::Mask;
    /// Whether the number is neither infinite nor NaN.
    fn is_finite(self) -> Self::Mask;
    /// `a` where the mask says yes, else `b`.
    fn select(mask: Self::Mask, a: Self, b: Self) -> Self;
    /// Sine and cosine of an angle from those of what is left of it after `n` quarter turns; `n` comes with
    /// [`Precision::ROUND`] added, so that it stands in the lowest bits.
    fn after_quarters(sine: Self, cosine: Self, n: Self) -> (Self, Self);
    /// Splits a positive normal number into `(m, e)` with `m * 2^e` and `1 <= m < 2`.
    fn split_exponent(self) -> (Self, Self);
    /// `2^self` for an integer value in the range of normal exponents.
    fn power_of_two(self) -> Self;
    /// `self^(-1/3)` of a positive normal number, to about 4 %.
    fn inverse_cbrt_guess(self) -> Self;

    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::lit(0.0)
    }
    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::lit(1.0)
    }
    /// The square.
    #[inline(always)]
    fn sq(self) -> Self {
        self * self
    }
    /// The number over the square root of `x`, which must be normal and positive: root and division side by
    /// side, so that neither waits for the other.
    #[inline(always)]
    fn over_root(self, x: Self) -> Self {
        x.sqrt() * (self / x)
    }
    /// Half of the number.
    #[inline(always)]
    fn half(self) -> Self {
        self * Self::lit(0.5)
    }
    /// `self` where it is less than `other`, else `other`.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// `self` where it is greater than `other`, else `other`.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
    /// Into `lo..=hi`; NaN becomes `lo`.
    #[inline(always)]
    fn clamp(self, lo: Self, hi: Self) -> Self {
        self.max(lo).min(hi)
    }
    /// -1, 0 or 1; 0 for NaN.
    #[inline(always)]
    fn sign(self) -> Self {
        let positive = Self::select(Self::zero().lt(self), Self::one(), Self::zero());
        Self::select(self.lt(Self::zero()), -Self::one(), positive)
    }
    /// The magnitude of `self` with the sign of `other`; positive where `other` is zero.
    #[inline(always)]
    fn with_sign(self, other: Self) -> Self {
        Self::select(other.lt(Self::zero()), -self.abs(), self.abs())
    }
    /// The nearest integer (ties to even) of a magnitude below 2^22 (single) or 2^51 (double).
    #[inline(always)]
    fn round(self) -> Self {
        let big = Self::lit(Self::Precision::ROUND);
        (self + big) - big
    }
    /// The largest integer not above the number; larger magnitudes are integers already.
    #[inline(always)]
    fn floor(self) -> Self {
        special::floor(self)
    }
    /// Sine and cosine of an angle in rad; see [`special`] for ranges.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        special::sin_cos(self)
    }
    /// Arc sine in rad; the argument is clamped to -1..=1.
    #[inline(always)]
    fn asin(self) -> Self {
        special::asin(self)
    }
    /// Angle of the point `(x, self)` in rad, in -pi..=pi; zero at the origin.
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        special::atan2(self, x)
    }
    /// Exponential function; finite for every argument.
    #[inline(always)]
    fn exp(self) -> Self {
        special::exp(self)
    }
    /// Natural logarithm; arguments below the smallest normal number count as that number.
    #[inline(always)]
    fn ln(self) -> Self {
        special::ln(self)
    }
    /// Cube root, odd.
    #[inline(always)]
    fn cbrt(self) -> Self {
        special::cbrt(self)
    }
    /// `|self|^(1/3)` and `|self|^(2/3)`, both with the sign of `self`.
    #[inline(always)]
    fn thirds(self) -> [Self; 2] {
        special::thirds(self)
    }
}

/// Precision of `f64`.
#[derive(Clone, Copy, Debug)]
pub struct Double;
/// Precision of `f32`.
#[derive(Clone, Copy, Debug)]
pub struct Single;

impl Precision for Double {
    const ANGLE_LIMIT: f64 = 1.6e6;
    const HALF_PI: [f64; 4] = [
        f64::from_bits(0x3FF9_21FB_5440_0000),
        f64::from_bits(0x3DD0_B461_1A60_0000),
        f64::from_bits(0x3BA3_198A_2E00_0000),
        f64::from_bits(0x397B_839A_2520_49C1),
    ];
    const LN_2: [f64; 2] =
        [f64::from_bits(0x3FE6_2E42_FEE0_0000), f64::from_bits(0x3DEA_39EF_3579_3C76)];
    const EXP_RANGE: [f64; 2] = [-708.0, 709.0];
    const TINY: f64 = f64::MIN_POSITIVE;
    const ROUND: f64 = 6_755_399_441_055_744.0; // 1.5 * 2^52
}

impl Precision for Single {
    const ANGLE_LIMIT: f64 = 1.0e4;
    const HALF_PI: [f64; 4] = [
        1.570_312_5,
        4.837_512_969_970_703e-4,
        7.549_533_620_476_723e-8,
        2.563_344_068_257_089_6e-12,
    ];
    const LN_2: [f64; 2] = [0.693_359_375, -2.121_944_400_546_905_8e-4];
    const EXP_RANGE: [f64; 2] = [-87.0, 88.0];
    const TINY: f64 = 1.175_494_350_822_287_5e-38;
    const ROUND: f64 = 12_582_912.0; // 1.5 * 2^23
}

macro_rules! float {
    (
        $float:ident, $bits:ident, $precision:ident, $mantissa:literal, $bias:literal, $sqrt:path,
        guess $guess:literal - $third:literal >> $shift:literal
    ) => {
        impl Real for $float {
            type Mask = bool;
            type Scalar = $float;
            type Part = $float;
            type Precision = $precision;
            const LANES: usize = 1;
            const PARTS: usize = 1;
            #[inline(always)]
            #[allow(clippy::cast_possible_truncation)] // rounding a literal to single is the point
            fn lit(x: f64) -> Self {
                x as $float
            }
            #[inline(always)]
            fn lane(&self, _: usize) -> $float {
                *self
            }
            #[inline(always)]
            fn set_lane(&mut self, _: usize, x: $float) {
                *self = x;
            }
            #[inline(always)]
            fn from_lanes(mut f: impl FnMut(usize) -> $float) -> Self {
                f(0)
            }
            #[inline(always)]
            fn part(&self, _: usize) -> $float {
                *self
            }
            #[inline(always)]
            fn set_part(&mut self, _: usize, x: $float) {
                *self = x;
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                f64::from(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $float::from_bits(self.to_bits() & ($bits::MAX >> 1))
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            #[allow(clippy::float_cmp)] // exact equality is what is asked
            fn eq(self, other: Self) -> bool {
                self == other
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                Real::abs(self) < $float::INFINITY
            }
            #[inline(always)]
            fn select(mask: bool, a: Self, b: Self) -> Self {
                if mask { a } else { b }
            }
            #[inline(always)]
            fn after_quarters(sine: Self, cosine: Self, n: Self) -> (Self, Self) {
                // An odd n swaps the two. The sine's sign is the second bit of n, the cosine's that of n + 1.
                let n = n.to_bits();
                let (s, c) = if n & 1 == 0 { (sine, cosine) } else { (cosine, sine) };
                let sign = |n: $bits| (n >> 1) << ($bits::BITS - 1);
                let (s, c) = (s.to_bits() ^ sign(n), c.to_bits() ^ sign(n.wrapping_add(1)));
                (<$float>::from_bits(s), <$float>::from_bits(c))
            }
            #[inline(always)]
            fn split_exponent(self) -> (Self, Self) {
                // The exponent field is written into the low bits of ROUND: an integer becomes a
                // number without a conversion instruction, which wide registers lack.
                let magic: $float = Self::lit($precision::ROUND);
                let bits = self.to_bits();
                let field = (bits >> $mantissa) & ($bits::MAX >> ($mantissa + 1));
                let exponent = $float::from_bits(magic.to_bits() | field) - (magic + $bias);
                let one: $float = 1.0;
                let low = ((1 as $bits) << $mantissa) - 1;
                (<$float>::from_bits((bits & low) | one.to_bits()), exponent)
            }
            #[inline(always)]
            fn power_of_two(self) -> Self {
                let magic: $float = Self::lit($precision::ROUND);
                <$float>::from_bits((self + (magic + $bias)).to_bits() << $mantissa)
            }
            #[inline(always)]
            fn inverse_cbrt_guess(self) -> Self {
                // The bits of a number are nearly its logarithm, so a third of them is taken from a
                // constant. Only their upper half is divided: wide registers multiply no more.
                let third = ((self.to_bits() >> ($bits::BITS / 2)) * $third) >> $shift;
                <$float>::from_bits($bits::wrapping_sub($guess, third) << ($bits::BITS / 2))
            }
        }
    };
}

// The constants of the guess make its largest relative errors to both sides equal.
float!(f64, u64, Double, 52, 1023.0, crate::root::sqrt_f64, guess 0x553E_F100 - 0xAAAA_AAAB >> 33);
float!(f32, u32, Single, 23, 127.0, crate::root::sqrt_f32, guess 0x54A2 - 0xAAAB >> 17);
