//! Elementary functions without branches, written once for single, double and lanes of either.
//!
//! Only operations that every target rounds in the same way are used, so a result has the same
//! bits on every target and in every lane. Every function is finite for every argument. The error
//! stated with each function was measured, in units in the last place (ulp) of the precision used.
//!
//! The argument of the sine is reduced by a multiple of pi/2 in parts whose products are exact
//! (Cody and Waite, *Software Manual for the Elementary Functions*, 1980); what rounding loses is
//! carried along as a second, small number. The ways to evaluate sine, cosine, arc tangent and
//! logarithm, and their coefficients in double precision, are those of fdlibm (Sun Microsystems,
//! 1993). The other coefficients have the smallest largest relative error of the function on the
//! reduced range (Remez exchange in 60 digits, then rounded).
#![allow(clippy::unreadable_literal)] // coefficients are compared with their source, not read

use core::f64::consts::{FRAC_2_PI, FRAC_PI_2, FRAC_PI_4, LOG2_E, PI, SQRT_2};

use crate::real::{Precision, Real};

/// What pi/2 as a double lacks.
const FRAC_PI_2_REST: f64 = 6.123233995736766e-17;
/// Arc tangent of 1/2, and what that double lacks.
const ATAN_HALF: [f64; 2] = [0.4636476090008061, 2.2698777452961687e-17];

/// Coefficients of a polynomial, constant term first: for double and for single precision.
type Series = [&'static [f64]; 2];

/// `(sin x - x) / x^3` in `x^2`.
#[rustfmt::skip]
const SINE: Series = [
    &[-0.16666666666666632, 0.00833333333332249, -0.0001984126982985795, 2.7557313707070068e-06,
      -2.5050760253406863e-08, 1.58969099521155e-10],
    &[-0.16666655242443085, 0.00833215843886137, -0.00019514957966748625],
];

/// `(cos x - 1 + x^2/2) / x^4` in `x^2`.
#[rustfmt::skip]
const COSINE: Series = [
    &[0.0416666666666666, -0.001388888888887411, 2.480158728947673e-05, -2.7557314351390663e-07,
      2.087572321298175e-09, -1.1359647557788195e-11],
    &[0.04166664555668831, -0.0013887312961742282, 2.4432783902739175e-05],
];

/// `(asin x - x) / x^3` in `x^2`, for `x` up to 1/2.
#[rustfmt::skip]
const ASIN: Series = [
    &[0.1666666666666676, 0.07499999999970798, 0.04464285717461305, 0.030381942707745035,
      0.022372214988353324, 0.01735161200621463, 0.013980820589542807, 0.01139891213808733,
      0.010780252444201539, 0.0037064115398884414, 0.021707439008500622, -0.02099905128910343,
      0.03262861763143015],
    &[0.16666752099990845, 0.07495297491550446, 0.04547037556767464, 0.02417951449751854,
      0.04216630756855011],
];

/// `(atan x - x) / x^3` in `x^2`, for `x` up to 7/16.
#[rustfmt::skip]
const ATAN: Series = [
    &[-0.3333333333333293, 0.19999999999876483, -0.14285714272503466, 0.11111110405462356,
      -0.09090887133436507, 0.0769187620504483, -0.06661073137387531, 0.058335701337905735,
      -0.049768779946159324, 0.036531572744216916, -0.016285820115365782],
    &[-0.3333330452442169, 0.19997738301753998, -0.14229582250118256, 0.10490807145833969,
      -0.05819101631641388],
];

/// `(exp x - 1 - x) / x^2` in `x`, for `x` up to `ln(2) / 2` in magnitude.
#[rustfmt::skip]
const EXP: Series = [
    &[0.5000000000000009, 0.16666666666666444, 0.04166666666654159, 0.008333333333475777,
      0.001388888894126206, 0.00019841269547541673, 2.48014950555513e-05, 2.755754737290842e-06,
      2.7629691703377877e-07, 2.5013553657321798e-08],
    &[0.4999999403953552, 0.1666652113199234, 0.041668251156806946, 0.008368751034140587,
      0.0013824605848640203],
];

/// `(ln((1 + x) / (1 - x)) - 2 x) / x^3` in `x^2`, for `x` up to 0.172.
#[rustfmt::skip]
const LN: Series = [
    &[0.6666666666666735, 0.3999999999940942, 0.2857142874366239, 0.22222198432149784,
      0.1818357216161805, 0.15313837699209373, 0.14798198605116586],
    &[0.6666677594184875, 0.3997756540775299, 0.2987120747566223],
];

/// `x^(-1/3)` for `x` in 1..2, to 12 bits.
const CBRT_GUESS: Series =
    [&[1.5418870258271467, -0.8099603430615405, 0.3177571367294899, -0.049936904269566706]; 2];

/// `2^(-x/3)` for `x` = 0, 1, 2.
const CBRT_STEP: Series = [&[1.0, -0.22757921050551877, 0.02127973648961856]; 2];

/// Whether the precision is single. A property of the type, never of data.
#[inline(always)]
fn is_single<T: Real>() -> bool {
    T::Precision::ROUND < 1e9
}

/// Polynomial of `x` with the coefficients of the precision: Horner's scheme in the square of `x`, with a
/// pair of coefficients at each step, so that fewer operations wait for the one before.
#[inline(always)]
fn polynomial<T: Real>(x: T, [double, single]: Series) -> T {
    let coefficients = if is_single::<T>() { single } else { double };
    let (pairs, last) = coefficients.as_chunks::<2>();
    let square = x * x;
    let highest = last.first().map(|c| T::lit(*c));
    let sum = pairs.iter().rev().fold(highest, |sum, [even, odd]| {
        let pair = T::lit(*even) + T::lit(*odd) * x;
        Some(sum.map_or(pair, |sum| sum * square + pair))
    });
    sum.unwrap_or(T::zero())
}

/// `a - b` rounded and what the rounding lost; exact if `|a| >= |b|` or the difference is exact.
#[inline(always)]
fn less<T: Real>(a: T, b: T) -> (T, T) {
    let difference = a - b;
    (difference, (a - difference) - b)
}

/// A constant given as two doubles, as two numbers of the precision.
#[inline(always)]
fn two_parts<T: Real>(constant: f64, rest: f64) -> (T, T) {
    let leading = T::lit(constant);
    (leading, T::lit((constant - leading.to_f64()) + rest))
}

/// Largest finite number.
#[inline(always)]
fn largest<T: Real>() -> T {
    T::lit((2.0 - 1.5 / T::Precision::ROUND) * (2.0 / T::Precision::TINY))
}

/// The number itself; for an infinity the largest finite number of its sign, for NaN zero.
#[inline(always)]
fn finite<T: Real>(x: T) -> T {
    let limit = largest::<T>();
    // Only NaN is not its own equal.
    T::select(x.eq(x), x.clamp(-limit, limit), T::zero())
}

/// The largest integer not above `x`, exact for every finite number.
///
/// An infinity gives the largest finite number of its sign, NaN gives zero.
#[inline(always)]
pub fn floor<T: Real>(x: T) -> T {
    let x = finite(x);
    // From here on every number is an integer; adding it to a smaller one rounds to an integer.
    let big = T::lit(T::Precision::ROUND / 1.5);
    let nearest = ((x.abs() + big) - big).with_sign(x);
    let integer = T::select(x.lt(nearest), nearest - T::one(), nearest);
    T::select(x.abs().lt(big), integer, x)
}

/// Sine and cosine of an angle in rad.
///
/// Error at most 1 ulp up to [`Precision::ANGLE_LIMIT`] in magnitude. Beyond it, and for NaN, the
/// angle counts as zero. The sine is exactly odd, the cosine exactly even.
#[inline(always)]
pub fn sin_cos<T: Real>(x: T) -> (T, T) {
    let inside = x.abs().le(T::lit(T::Precision::ANGLE_LIMIT));
    let x = T::select(inside, x, T::zero());
    // Adding ROUND leaves the number of quarter turns in the lowest bits.
    let quarters = x * T::lit(FRAC_2_PI) + T::lit(T::Precision::ROUND);
    let n = quarters - T::lit(T::Precision::ROUND);
    let [p, q, r, s] = crate::record::each(T::Precision::HALF_PI, |part| n * T::lit(part));
    let (rest, lost_q) = less(x - p, q);
    let (hi, lost_r) = less(rest, r);
    let lo = (lost_q + lost_r) - s;

    let z = hi * hi;
    let sine = polynomial(z, SINE);
    let sine = hi - ((z * lo.half() - lo) - z * hi * sine);
    let cosine = polynomial(z, COSINE);
    let (main, lost) = less(T::one(), z.half());
    let cosine = main + (lost + (z * z * cosine - hi * lo));
    T::after_quarters(sine, cosine, quarters)
}

/// Arc sine in rad, in -pi/2..=pi/2.
///
/// Error at most 1.5 ulp on -1..=1. Arguments beyond are clamped to that range, NaN gives zero.
/// Exactly odd.
#[inline(always)]
pub fn asin<T: Real>(x: T) -> T {
    let x = T::select(x.eq(x), x, T::zero());
    let magnitude = x.abs().min(T::one());
    let small = magnitude.le(T::lit(0.5));
    // Above one half: asin(x) = pi/2 - 2 asin(sqrt((1 - x) / 2)).
    let z = T::select(small, magnitude * magnitude, (T::one() - magnitude).half());
    let base = T::select(small, x, z.sqrt());
    let beyond = base * (z * polynomial(z, ASIN));
    let (right, rest) = two_parts::<T>(FRAC_PI_2, FRAC_PI_2_REST);
    let (main, lost) = less(right, base + base);
    let large = main + (lost + (rest - (beyond + beyond)));
    T::select(small, base + beyond, large.with_sign(x))
}

/// Angle of the point `(x, y)` in rad, in -pi..=pi.
///
/// Error at most 2 ulp for all finite points. Zero at the origin and where either is NaN; an
/// infinity counts as the largest finite number. Exactly odd in `y`, but for `y` zero of either
/// sign it is zero or plus pi.
#[inline(always)]
pub fn atan2<T: Real>(y: T, x: T) -> T {
    let known = x.eq(x) & y.eq(y);
    // `min` gives its argument where it is asked of NaN: what follows stays finite, and is not used then.
    let (across, up) = (x.abs().min(largest()), y.abs().min(largest()));
    let steep = across.lt(up);
    let (long, short) = (across.max(up), across.min(up));
    // A power of two keeps what follows from overflow and from subnormal numbers; where it rounds
    // the short side, the quotient underflows.
    let two_60 = T::lit(1152921504606846976.0);
    let scale = T::select(long.lt(two_60), two_60, T::lit(0.25));
    let (long, short) = (long * scale, short * scale);

    // atan(short / long) = atan(pivot) + atan(quotient), the quotient at most 7/16 in magnitude.
    let middle = (long * T::lit(0.4375)).lt(short);
    let upper = (long * T::lit(0.6875)).lt(short);
    let (hi_1, lo_1) = two_parts::<T>(FRAC_PI_4, FRAC_PI_2_REST * 0.5);
    let (hi_h, lo_h) = two_parts::<T>(ATAN_HALF[0], ATAN_HALF[1]);
    let pick = |a, b| T::select(middle, T::select(upper, a, b), T::zero());
    let pivot = pick(T::one(), T::lit(0.5));
    let (pivot_hi, pivot_lo) = (pick(hi_1, hi_h), pick(lo_1, lo_h));
    let quotient = (short - pivot * long) / (long + pivot * short).max(T::lit(T::Precision::TINY));
    let z = quotient * quotient;
    let angle = pivot_lo + (quotient + quotient * (z * polynomial(z, ATAN)));

    // The axis nearest to the point, and the way from it.
    let (right, right_rest) = two_parts::<T>(FRAC_PI_2, FRAC_PI_2_REST);
    let (straight, straight_rest) = two_parts::<T>(PI, FRAC_PI_2_REST * 2.0);
    let left = x.lt(T::zero());
    let axis = T::select(steep, right, T::select(left, straight, T::zero()));
    let axis_rest = T::select(steep, right_rest, T::select(left, straight_rest, T::zero()));
    // Steep on the right and flat on the left the angle is taken from the axis, else added.
    let side = T::select(left, -T::one(), T::one());
    let turn = T::select(steep, side, -side);
    let (main, lost) = less(axis, turn * pivot_hi);
    let angle = (main + (lost + (axis_rest - turn * angle))).with_sign(y);
    T::select(known, angle, T::zero())
}

/// Exponential function.
///
/// Error at most 1 ulp on [`Precision::EXP_RANGE`], to which the argument is clamped; NaN counts
/// as the lower end.
#[inline(always)]
pub fn exp<T: Real>(x: T) -> T {
    let [lowest, highest] = crate::record::each(T::Precision::EXP_RANGE, T::lit);
    let x = x.clamp(lowest, highest);
    let n = (x * T::lit(LOG2_E)).round();
    let [p, q] = crate::record::each(T::Precision::LN_2, |part| n * T::lit(part));
    let (r, lost) = less(x - p, q);
    (T::one() + (r + (r * r * polynomial(r, EXP) + lost))) * n.power_of_two()
}

/// Natural logarithm.
///
/// Error at most 1 ulp for normal positive numbers. Smaller arguments and NaN count as the
/// smallest normal number, infinity as the largest finite number.
#[inline(always)]
pub fn ln<T: Real>(x: T) -> T {
    let (m, e) = x.clamp(T::lit(T::Precision::TINY), largest()).split_exponent();
    let upper = T::lit(SQRT_2).lt(m);
    let f = T::select(upper, m.half(), m) - T::one();
    let e = T::select(upper, e + T::one(), e);
    let s = f / (T::lit(2.0) + f);
    let z = s * s;
    let half_square = f * f.half();
    let [p, q] = crate::record::each(T::Precision::LN_2, |part| e * T::lit(part));
    p - ((half_square - (s * (half_square + z * polynomial(z, LN)) + q)) - f)
}

/// Cube root.
///
/// Error at most 1 ulp for all finite numbers, subnormal ones included. An infinity counts as the
/// largest finite number of its sign, NaN gives zero. Exactly odd.
#[inline(always)]
pub fn cbrt<T: Real>(x: T) -> T {
    let x = finite(x);
    let subnormal = x.abs().lt(T::lit(T::Precision::TINY));
    let scale = T::select(subnormal, T::lit(1152921504606846976.0), T::one()); // 2^60
    let (m, e) = (x.abs() * scale).split_exponent();
    let third = ((e - T::one()) * T::lit(1.0 / 3.0)).round();
    let rest = e - third * T::lit(3.0);
    let a = m * rest.power_of_two();

    // y = a^(-1/3): a guess, improved once. The guess is one for the mantissa times one for the rest
    // of the exponent.
    let guess = polynomial(m, CBRT_GUESS) * polynomial(rest, CBRT_STEP);
    let y = guess + guess * cube_root_correction(T::one() - a * (guess * guess * guess));
    // a y^2, rounded so short that its cube is exact; the same series then adds what is missing.
    let short = if is_single::<T>() { 1.0 / 128.0 } else { 1.0 / 65536.0 };
    let big = T::lit(T::Precision::ROUND * short);
    let root = (a * (y * y) + big) - big;
    let root = root + root * cube_root_correction((a - root * root * root) * (y * y * y));

    let power = third - T::select(subnormal, T::lit(20.0), T::zero());
    let root = (root * power.power_of_two()).with_sign(x);
    T::select(x.eq(T::zero()), x, root)
}

/// `|x|^(1/3)` and `|x|^(2/3)`, both with the sign of `x`.
///
/// Error at most 4.5 and 2.5 ulp for normal numbers; for smaller ones, and for NaN, both are zero. An
/// infinity counts as the largest finite number. Exactly odd, but a zero comes out positive.
#[inline(always)]
pub fn thirds<T: Real>(x: T) -> [T; 2] {
    let a = x.abs().min(largest());
    // y = a^(-1/3), improved twice by (1 - h)^(-1/3): 4 % become 2e-5 and then less than rounding.
    let mut y = a.inverse_cbrt_guess();
    for _ in 0..2 {
        let h = T::one() - (a * y) * (y * y);
        // The series of `cube_root_correction` times y, y taken into each term before they are known.
        y = (y + y * (h * T::lit(CORRECTION[0])))
            + (y * (h * h)) * (T::lit(CORRECTION[1]) + h * T::lit(CORRECTION[2]));
    }
    let normal = T::lit(T::Precision::TINY).le(a);
    let two = T::select(normal, a * y, T::zero()).with_sign(x);
    [two * y, two]
}

/// Coefficients of `(1 - h)^(-1/3) - 1`.
const CORRECTION: [f64; 3] = [1.0 / 3.0, 2.0 / 9.0, 14.0 / 81.0];

/// `(1 - h)^(-1/3) - 1` for small `h`, to its third order; in pairs, so that little waits for what is before.
#[inline(always)]
fn cube_root_correction<T: Real>(h: T) -> T {
    let square = h * h;
    h * T::lit(CORRECTION[0]) + square * (T::lit(CORRECTION[1]) + h * T::lit(CORRECTION[2]))
}
