//! The square root, correctly rounded with and without hardware.
//!
//! With the feature `std` it is the processor's instruction. Without it the root is found bit by
//! bit in integers, so both give the same bits (IEEE 754 prescribes the correctly rounded root).

/// Square root of a double; NaN below zero.
#[cfg(feature = "std")]
#[inline(always)]
pub fn sqrt_f64(x: f64) -> f64 {
    x.sqrt()
}

/// Square root of a single; NaN below zero.
#[cfg(feature = "std")]
#[inline(always)]
pub fn sqrt_f32(x: f32) -> f32 {
    x.sqrt()
}

#[cfg(not(feature = "std"))]
pub use self::software::{sqrt_f32, sqrt_f64};

/// The root in integer arithmetic.
#[cfg_attr(feature = "std", allow(dead_code))] // with `std` only the test below compares it
#[allow(
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    clippy::neg_cmp_op_on_partial_ord,
    reason = "exponents fit by construction; NaN must take the first branch"
)]
mod software {
    macro_rules! software_root {
        ($(#[$doc:meta])* $name:ident, $float:ident, $bits:ident, $mantissa:literal, $bias:literal) => {
            $(#[$doc])*
            pub fn $name(x: $float) -> $float {
                if !(x > 0.0) || x == $float::INFINITY {
                    // Zeros and infinity are their own roots; NaN and negative numbers give NaN.
                    return if x < 0.0 { $float::NAN } else { x };
                }
                let one: $bits = 1 << $mantissa;
                let mut bits = x.to_bits();
                let mut exponent = (bits >> $mantissa) as i32;
                bits &= one - 1;
                if exponent == 0 {
                    let shift = bits.leading_zeros() as i32 - ($bits::BITS as i32 - 1 - $mantissa);
                    bits <<= shift;
                    exponent = 1 - shift;
                }
                exponent -= $bias;
                let mut rest = (bits & (one - 1)) | one;
                if exponent & 1 != 0 {
                    rest <<= 1;
                }
                // The remainder is doubled instead of the root being halved: 2 * rest - root^2 >= 0.
                rest <<= 1;
                let (mut root, mut sum): ($bits, $bits) = (0, 0);
                let mut bit: $bits = one << 1;
                while bit != 0 {
                    let trial = sum + bit;
                    if trial <= rest {
                        sum = trial + bit;
                        rest -= trial;
                        root += bit;
                    }
                    rest <<= 1;
                    bit >>= 1;
                }
                // One bit more than the mantissa was found: round to nearest (a tie cannot occur).
                root += root & 1;
                let half_exponent = ((exponent >> 1) + $bias) as $bits;
                $float::from_bits(((half_exponent - 1) << $mantissa) + (root >> 1))
            }
        };
    }
    software_root! {
        /// Square root of a double; NaN below zero.
        sqrt_f64, f64, u64, 52, 1023
    }
    software_root! {
        /// Square root of a single; NaN below zero.
        sqrt_f32, f32, u32, 23, 127
    }
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation, reason = "the upper half is what is wanted")]
mod tests {
    use super::software;

    /// SplitMix64: every bit pattern is as likely as any other.
    fn bits(state: &mut u64) -> u64 {
        *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = *state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    #[test]
    fn software_and_processor_round_alike_over_ten_million_patterns() {
        // Debug builds take a hundredth of the patterns: the full count belongs to release.
        let count = if cfg!(debug_assertions) { 100_000 } else { 10_000_000 };
        let mut state = 1;
        for _ in 0..count {
            let pattern = bits(&mut state);
            let x = f64::from_bits(pattern);
            let (ours, theirs) = (software::sqrt_f64(x), x.sqrt());
            assert!(
                ours.to_bits() == theirs.to_bits() || (ours.is_nan() && theirs.is_nan()),
                "{x:e}"
            );
            let y = f32::from_bits((pattern >> 32) as u32);
            let (ours, theirs) = (software::sqrt_f32(y), y.sqrt());
            assert!(
                ours.to_bits() == theirs.to_bits() || (ours.is_nan() && theirs.is_nan()),
                "{y:e}"
            );
        }
    }

    #[test]
    fn special_values_are_their_own_roots() {
        for x in
            [0.0, -0.0, f64::INFINITY, f64::MIN_POSITIVE, f64::from_bits(1), f64::MAX, 1.0, 2.0]
        {
            assert_eq!(software::sqrt_f64(x).to_bits(), x.sqrt().to_bits(), "{x:e}");
        }
        assert!(software::sqrt_f64(-1.0).is_nan());
    }
}
