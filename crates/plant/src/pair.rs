//! Two doubles in one register: the scalar of two vehicles where registers are that wide.
//!
//! Registers of four and eight doubles are filled by the loop vectoriser, law by law. For two it does not
//! pay: what it stores and loads between the laws costs more than the second vehicle saves. So two vehicles
//! go through a whole tick as one does, in registers of which each holds both; their bits are those of a
//! single flight. Every operation is one instruction that all x86-64 processors have (SSE2).

use core::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, Neg, Not, Sub, SubAssign};

use safe_arch::{
    add_m128d, bitand_m128d, bitand_m128i, bitandnot_m128d, bitor_m128d, bitor_m128i, bitxor_m128d,
    cast_to_m128d_from_m128i, cast_to_m128i_from_m128d, cmp_eq_mask_m128d, cmp_le_mask_m128d,
    cmp_lt_mask_m128d, div_m128d, m128d, m128i, max_m128d, min_m128d, move_mask_m128d, mul_m128d,
    mul_widen_u32_odd_m128i, set_splat_i64_m128i, set_splat_m128d, shl_imm_u64_m128i,
    shr_imm_u64_m128i, sqrt_m128d, sub_i64_m128i, sub_m128d,
};
use stormpetrel_control::real::{Double, Mask, Precision, Real};

/// The numbers of two vehicles.
#[derive(Clone, Copy, Debug)]
pub struct Pair(m128d);

/// Two answers: each a word of ones or zeros.
#[derive(Clone, Copy, Debug)]
pub struct PairMask(m128d);

/// The bit of the sign.
const SIGN: u64 = 1 << 63;

/// These bits in both numbers.
#[inline(always)]
fn bits(both: u64) -> m128d {
    set_splat_m128d(f64::from_bits(both))
}

/// These bits in both words.
#[inline(always)]
fn words(both: u64) -> m128i {
    set_splat_i64_m128i(both.cast_signed())
}

#[inline(always)]
fn to_words(x: m128d) -> m128i {
    cast_to_m128i_from_m128d(x)
}

#[inline(always)]
fn to_numbers(x: m128i) -> m128d {
    cast_to_m128d_from_m128i(x)
}

/// A truth value as a word of ones or zeros.
#[inline(always)]
fn word(value: bool) -> f64 {
    f64::from_bits(if value { u64::MAX } else { 0 })
}

impl Default for Pair {
    #[inline(always)]
    fn default() -> Self {
        Self::zero()
    }
}

macro_rules! arithmetic {
    ($($trait:ident $method:ident $instruction:ident),*) => { $(
        impl $trait for Pair {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($instruction(self.0, other.0))
            }
        }
    )* };
}
arithmetic! { Add add add_m128d, Sub sub sub_m128d, Mul mul mul_m128d, Div div div_m128d }

impl AddAssign for Pair {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for Pair {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl Neg for Pair {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(bitxor_m128d(self.0, bits(SIGN)))
    }
}

impl BitAnd for PairMask {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(bitand_m128d(self.0, other.0))
    }
}

impl BitOr for PairMask {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(bitor_m128d(self.0, other.0))
    }
}

impl Not for PairMask {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(bitxor_m128d(self.0, bits(u64::MAX)))
    }
}

impl Mask for PairMask {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self(set_splat_m128d(word(value)))
    }
    #[inline(always)]
    fn all(self) -> bool {
        move_mask_m128d(self.0) == 3
    }
    #[inline(always)]
    fn lane(self, i: usize) -> bool {
        move_mask_m128d(self.0) >> (i % 2) & 1 != 0
    }
    #[inline(always)]
    fn from_lanes(mut f: impl FnMut(usize) -> bool) -> Self {
        let first = word(f(0));
        Self(m128d::from_array([first, word(f(1))]))
    }
}

impl Real for Pair {
    type Mask = PairMask;
    type Scalar = f64;
    type Part = Self;
    type Precision = Double;
    const LANES: usize = 2;
    const PARTS: usize = 1;

    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self(set_splat_m128d(x))
    }
    #[inline(always)]
    fn lane(&self, i: usize) -> f64 {
        self.0.to_array()[i % 2]
    }
    #[inline(always)]
    fn set_lane(&mut self, i: usize, x: f64) {
        let mut both = self.0.to_array();
        both[i % 2] = x;
        self.0 = m128d::from_array(both);
    }
    #[inline(always)]
    fn from_lanes(mut f: impl FnMut(usize) -> f64) -> Self {
        let first = f(0);
        Self(m128d::from_array([first, f(1)]))
    }
    #[inline(always)]
    fn part(&self, _: usize) -> Self {
        *self
    }
    #[inline(always)]
    fn set_part(&mut self, _: usize, x: Self) {
        *self = x;
    }
    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.lane(0)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(sqrt_m128d(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(bitand_m128d(self.0, bits(!SIGN)))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> PairMask {
        PairMask(cmp_lt_mask_m128d(self.0, other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> PairMask {
        PairMask(cmp_le_mask_m128d(self.0, other.0))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> PairMask {
        PairMask(cmp_eq_mask_m128d(self.0, other.0))
    }
    #[inline(always)]
    fn is_finite(self) -> PairMask {
        self.abs().lt(Self::lit(f64::INFINITY))
    }
    #[inline(always)]
    fn select(mask: PairMask, a: Self, b: Self) -> Self {
        // What tells them apart is known beforehand where both are constants.
        let apart = bitxor_m128d(a.0, b.0);
        Self(bitxor_m128d(bitand_m128d(mask.0, apart), b.0))
    }
    // The two instructions answer as a comparison and a selection do: the second number where either is NaN
    // or both are zero.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(min_m128d(self.0, other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(max_m128d(self.0, other.0))
    }
    #[inline(always)]
    fn sign(self) -> Self {
        let (positive, negative) = (Self::zero().lt(self), self.lt(Self::zero()));
        Self(bitor_m128d(
            bitand_m128d(positive.0, set_splat_m128d(1.0)),
            bitand_m128d(negative.0, set_splat_m128d(-1.0)),
        ))
    }
    #[inline(always)]
    fn with_sign(self, other: Self) -> Self {
        let negative = other.lt(Self::zero());
        Self(bitor_m128d(self.abs().0, bitand_m128d(negative.0, bits(SIGN))))
    }
    #[inline(always)]
    fn after_quarters(sine: Self, cosine: Self, n: Self) -> (Self, Self) {
        let (n, one) = (to_words(n.0), words(1));
        // Where n is even, zero less one: all ones.
        let even = to_numbers(sub_i64_m128i(bitand_m128i(n, one), one));
        let swap = bitandnot_m128d(even, bitxor_m128d(sine.0, cosine.0));
        let sign = |n| bitand_m128d(to_numbers(shl_imm_u64_m128i::<62>(n)), bits(SIGN));
        let next = sub_i64_m128i(n, words(u64::MAX));
        (
            Self(bitxor_m128d(bitxor_m128d(sine.0, swap), sign(n))),
            Self(bitxor_m128d(bitxor_m128d(cosine.0, swap), sign(next))),
        )
    }
    #[inline(always)]
    fn split_exponent(self) -> (Self, Self) {
        // As for one number: the exponent field is written into the low bits of ROUND.
        let field = bitand_m128i(shr_imm_u64_m128i::<52>(to_words(self.0)), words(0x7FF));
        let exponent = to_numbers(bitor_m128i(field, words(Double::ROUND.to_bits())));
        let mantissa = bitand_m128d(self.0, bits((1 << 52) - 1));
        (
            Self(bitor_m128d(mantissa, set_splat_m128d(1.0))),
            Self(exponent) - Self::lit(Double::ROUND + 1023.0),
        )
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        let shifted = self + Self::lit(Double::ROUND + 1023.0);
        Self(to_numbers(shl_imm_u64_m128i::<52>(to_words(shifted.0))))
    }
    #[inline(always)]
    fn inverse_cbrt_guess(self) -> Self {
        // As for one number.
        let upper = shr_imm_u64_m128i::<32>(to_words(self.0));
        let third = shr_imm_u64_m128i::<33>(mul_widen_u32_odd_m128i(upper, words(0xAAAA_AAAB)));
        Self(to_numbers(shl_imm_u64_m128i::<32>(sub_i64_m128i(words(0x553E_F100), third))))
    }
}
