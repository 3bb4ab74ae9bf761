//! The elementary functions against references of higher precision.
//!
//! For doubles `special_reference.csv` holds points as bits (hexadecimal), and the true value as
//! the sum of two doubles. It was computed with the Python library mpmath at 2000 bits: random
//! points over each documented range, and the hard ones (nearest doubles to multiples of pi/2, both
//! ends of each range, where the method changes). Dense points compare with the crate libm, whose
//! own error is below 1 ulp. Singles compare with libm in double precision.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]
#![allow(clippy::print_stdout, clippy::unwrap_used)] // the largest errors are worth seeing

use std::collections::BTreeMap;

use stormpetrel_control::lanes::Lanes;
use stormpetrel_control::real::{Precision, Real};

const NAMES: [&str; 7] = ["sin", "cos", "asin", "atan2", "exp", "ln", "cbrt"];

/// The function of that name; only atan2 looks at the second argument.
fn ours<T: Real>(name: &str, a: T, b: T) -> T {
    match name {
        "sin" => a.sin_cos().0,
        "cos" => a.sin_cos().1,
        "asin" => a.asin(),
        "atan2" => a.atan2(b),
        "exp" => a.exp(),
        "ln" => a.ln(),
        "cbrt" => a.cbrt(),
        "third" => a.thirds()[0],
        "two_thirds" => a.thirds()[1],
        _ => a.floor(),
    }
}

fn theirs(name: &str, a: f64, b: f64) -> f64 {
    match name {
        "sin" => libm::sin(a),
        "cos" => libm::cos(a),
        "asin" => libm::asin(a),
        "atan2" => libm::atan2(a, b),
        "exp" => libm::exp(a),
        "ln" => libm::log(a),
        "cbrt" => libm::cbrt(a),
        _ => libm::floor(a),
    }
}

/// The generator `SplitMix64`.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * ((self.bits() >> 11) as f64 / 9_007_199_254_740_992.0)
    }
    /// A magnitude spread evenly over the exponents `lo..hi` of two, either sign.
    fn spread(&mut self, lo: f64, hi: f64) -> f64 {
        let magnitude = self.between(lo, hi).exp2();
        if self.bits() & 1 == 0 { magnitude } else { -magnitude }
    }
    /// A point of the documented range of the function in the precision `P`.
    fn point<P: Precision>(&mut self, name: &str) -> (f64, f64) {
        let kind = self.bits() % 4;
        let top = -P::TINY.log2() + 1.0;
        match (name, kind) {
            // The neighbourhood of a multiple of pi/2.
            ("sin" | "cos", 0) => {
                let most = (P::ANGLE_LIMIT * std::f64::consts::FRAC_2_PI).floor();
                let n = self.between(-most, most).round();
                let x = n * std::f64::consts::FRAC_PI_2;
                let x = x + x * self.spread(-60.0, -10.0);
                (Real::clamp(x, -P::ANGLE_LIMIT, P::ANGLE_LIMIT), 0.0)
            }
            ("sin" | "cos", 1) => (self.between(-P::ANGLE_LIMIT, P::ANGLE_LIMIT), 0.0),
            ("sin" | "cos", 2) => (self.spread(-30.0, 3.0), 0.0),
            ("sin" | "cos", _) => (self.between(-4.0, 4.0), 0.0),
            ("asin", 0) => (1.0 - self.spread(-50.0, -1.0).abs(), 0.0),
            ("asin", 1) => (self.spread(-40.0, 0.0), 0.0),
            ("asin", _) => (self.between(-1.0, 1.0), 0.0),
            ("exp", 0) => (self.between(P::EXP_RANGE[0], P::EXP_RANGE[1]), 0.0),
            ("exp", 1) => (self.spread(-40.0, 4.0), 0.0),
            ("exp", _) => (self.between(-2.0, 2.0), 0.0),
            ("ln", 0) => (self.spread(1.0 - top, top).abs(), 0.0),
            ("ln", 1) => (1.0 + self.spread(-40.0, -3.0), 0.0),
            ("ln", _) => (self.between(0.3, 3.0), 0.0),
            ("cbrt", 0) => (self.spread(-top - 20.0, top), 0.0),
            ("cbrt", _) => (self.spread(-4.0, 4.0), 0.0),
            ("atan2", 0) => (self.spread(1.0 - top, top), self.spread(1.0 - top, top)),
            ("atan2", 1) => (self.spread(-2.0, 2.0), self.spread(-2.0, 2.0)),
            _ => (self.between(-1.0, 1.0), self.between(-1.0, 1.0)),
        }
    }
}

/// Debug builds take a fiftieth of the points.
const COUNT: u64 = if cfg!(debug_assertions) { 20_000 } else { 1_000_000 };

fn ulp(x: f64) -> f64 {
    let x = Real::max(x.abs(), f64::MIN_POSITIVE);
    f64::from_bits(x.to_bits() + 1) - x
}

#[allow(clippy::cast_possible_truncation)] // the unit of the single is asked
fn ulp_single(x: f64) -> f64 {
    let x = Real::max(x.abs(), f64::from(f32::MIN_POSITIVE));
    let nearest = x as f32;
    // Just below a power of two the nearest single is that power, with the larger unit.
    let bits = nearest.to_bits() - u32::from(f64::from(nearest) > x);
    f64::from(f32::from_bits(bits + 1)) - f64::from(f32::from_bits(bits))
}

fn parse(field: &str) -> f64 {
    f64::from_bits(u64::from_str_radix(field, 16).unwrap())
}

#[test]
fn doubles_are_within_two_ulp_of_the_table() {
    let mut worst = BTreeMap::new();
    for line in include_str!("special_reference.csv").lines().skip(1) {
        let fields: Vec<&str> = line.split(',').collect();
        let (a, b, hi, lo) =
            (parse(fields[1]), parse(fields[2]), parse(fields[3]), parse(fields[4]));
        let got = ours(fields[0], a, b);
        let error = ((got - hi) - lo).abs() / ulp(hi);
        assert!(error <= 2.0, "{}({a:e}, {b:e}) = {got:e}, off by {error} ulp", fields[0]);
        let entry = worst.entry(fields[0]).or_insert((0.0, 0));
        *entry = (Real::max(error, entry.0), entry.1 + 1);
    }
    assert_eq!(worst.len(), NAMES.len());
    println!("double, table: largest error in ulp and points: {worst:?}");
}

#[test]
fn doubles_agree_with_libm() {
    for name in NAMES {
        let (mut random, mut worst) = (Random(1), (0.0, 0.0, 0.0));
        for _ in 0..COUNT {
            let (a, b) = random.point::<<f64 as Real>::Precision>(name);
            let want = theirs(name, a, b);
            let error = (ours(name, a, b) - want).abs() / ulp(want);
            if error > worst.0 {
                worst = (error, a, b);
            }
        }
        println!("double {name} against libm: {worst:?}");
        // Two of ours and one of libm's.
        assert!(worst.0 <= 3.0, "{name}: {worst:?}");
    }
}

#[test]
#[allow(clippy::cast_possible_truncation)] // the points are singles
fn singles_are_within_two_ulp() {
    for name in NAMES {
        let (mut random, mut worst) = (Random(2), (0.0, 0.0, 0.0));
        for _ in 0..COUNT {
            let (a, b) = random.point::<<f32 as Real>::Precision>(name);
            let (mut a, b) = (a as f32, b as f32);
            if name == "ln" || name == "cbrt" {
                a = a.clamp(if name == "ln" { f32::MIN_POSITIVE } else { f32::MIN }, f32::MAX);
            }
            let (a, b) = if name == "atan2" {
                (a.clamp(f32::MIN, f32::MAX), b.clamp(f32::MIN, f32::MAX))
            } else {
                (a, b)
            };
            let (wide_a, wide_b) = (f64::from(a), f64::from(b));
            let want = theirs(name, wide_a, wide_b);
            let error = (f64::from(ours(name, a, b)) - want).abs() / ulp_single(want);
            if error > worst.0 {
                worst = (error, wide_a, wide_b);
            }
        }
        println!("single {name}: {worst:?}");
        assert!(worst.0 <= 2.0, "{name}: {worst:?}");
    }
}

#[test]
#[allow(clippy::cast_possible_truncation)]
fn single_sines_hold_next_to_every_multiple_of_a_right_angle() {
    for n in -6366_i32..=6366 {
        let nearest = f64::from(n) * std::f64::consts::FRAC_PI_2;
        for step in 0..5 {
            let x = f32::from_bits(((nearest as f32).to_bits() + step).saturating_sub(2));
            if x.abs() > 1.0e4 {
                continue;
            }
            for name in ["sin", "cos"] {
                let want = theirs(name, f64::from(x), 0.0);
                let error = (f64::from(ours(name, x, 0.0)) - want).abs() / ulp_single(want);
                assert!(error <= 1.0, "{name}({x:e}) off by {error} ulp");
            }
        }
    }
}

/// Numbers at which something may go wrong, and random patterns.
fn patterns(random: &mut Random, i: u64) -> f64 {
    const SPECIAL: [f64; 22] = [
        0.0,
        f64::INFINITY,
        f64::NAN,
        f64::MAX,
        f64::MIN_POSITIVE,
        5e-324,
        1e-310,
        1.0,
        2.0,
        0.5,
        1.6e6,
        1.0e4,
        709.0,
        710.0,
        88.0,
        89.0,
        3.0e38,
        1.0e-40,
        1.0e-45,
        4_503_599_627_370_495.5,
        2_251_799_813_685_248.5,
        8_388_607.5,
    ];
    match SPECIAL.get(usize::try_from(i / 2).unwrap()) {
        Some(x) if i.is_multiple_of(2) => *x,
        Some(x) => -x,
        None => f64::from_bits(random.bits()),
    }
}

/// Cubes of small integers and powers of eight have exact thirds.
#[test]
#[allow(clippy::cast_possible_truncation)]
fn powers_of_thirds_are_within_their_ulp() {
    let (mut worst, mut worst_single) = ([0.0; 2], [0.0; 2]);
    let mut random = Random(7);
    for _ in 0..COUNT / 4 {
        let root = (random.bits() >> 47) as f64 + 1.0;
        let exponent = (random.bits() % 640) as i32 - 330;
        let x = root.powi(3) * 8f64.powi(exponent);
        let exact = [root * 2f64.powi(exponent), root * root * 4f64.powi(exponent)];
        let single = random.spread(-125.0, 127.0) as f32;
        let (double, of_single) = (x.thirds(), single.abs().thirds());
        for (k, power) in [1.0 / 3.0, 2.0 / 3.0].into_iter().enumerate() {
            worst[k] = Real::max(worst[k], (double[k] - exact[k]).abs() / ulp(exact[k]));
            let exact = f64::from(single.abs()).powf(power);
            let off = (f64::from(of_single[k]) - exact).abs();
            worst_single[k] = Real::max(worst_single[k], off / ulp_single(exact));
        }
    }
    println!("thirds: {worst:?} ulp, single {worst_single:?} ulp");
    for worst in [worst, worst_single] {
        assert!(worst[0] < 4.5 && worst[1] < 2.5, "{worst:?} ulp");
        assert!(worst[0] > 0.5 && worst[1] > 0.5, "no rounding at all is not credible");
    }
}

#[test]
#[allow(clippy::cast_possible_truncation)]
fn every_pattern_gives_a_finite_result() {
    let mut random = Random(3);
    for i in 0..COUNT {
        let a = patterns(&mut random, i % COUNT.min(10_000));
        let j = random.bits() % 64;
        let b = patterns(&mut random, j);
        let bits = random.bits();
        let singles = if i % 10_000 < 44 {
            (a as f32, b as f32)
        } else {
            (f32::from_bits(bits as u32), f32::from_bits((bits >> 32) as u32))
        };
        for name in NAMES.into_iter().chain(["floor", "third", "two_thirds"]) {
            assert!(ours(name, a, b).is_finite(), "{name}({a:e}, {b:e})");
            let (a, b) = singles;
            assert!(ours(name, a, b).is_finite(), "{name}({a:e}, {b:e}) single");
        }
    }
}

#[test]
#[allow(clippy::cast_possible_truncation)]
fn odd_functions_are_odd_bit_for_bit() {
    let mut random = Random(4);
    let check = |a: f64, b: f64| {
        for name in ["sin", "asin", "cbrt", "third", "two_thirds", "atan2"] {
            let outside = name == "sin" && a.abs() > 1.0e4;
            // A number that is nothing in single precision has a result without a sign.
            let nothing = (a as f32).abs() < f32::MIN_POSITIVE;
            let outside = outside || (name.contains("third") && nothing);
            if outside || a.is_nan() || b.is_nan() || (name == "atan2" && a as f32 == 0.0) {
                continue;
            }
            let (plus, minus) = (ours(name, a, b), ours(name, -a, b));
            assert_eq!(plus.to_bits(), (-minus).to_bits(), "{name}({a:e}, {b:e})");
            let (a, b) = (a as f32, b as f32);
            let (plus, minus) = (ours(name, a, b), ours(name, -a, b));
            assert_eq!(plus.to_bits(), (-minus).to_bits(), "{name}({a:e}, {b:e}) single");
        }
    };
    for i in 0..COUNT / 4 {
        let a = patterns(&mut random, i);
        let b = patterns(&mut random, i / 2);
        check(a, b);
        check(random.spread(-20.0, 13.0), random.spread(-20.0, 13.0));
    }
}

#[test]
fn lanes_have_the_bits_of_a_single_run() {
    let mut random = Random(5);
    for i in 0..COUNT / 8 {
        let mut point = |k| match i % 3 {
            0 => patterns(&mut random, 8 * (i / 3) + k),
            1 => random.between(-10.0, 10.0),
            _ => random.spread(-40.0, 40.0),
        };
        let a: [f64; 8] = std::array::from_fn(|k| point(k as u64));
        let b: [f64; 8] = std::array::from_fn(|k| point(k as u64));
        for name in NAMES.into_iter().chain(["floor", "third", "two_thirds"]) {
            let wide = ours(name, Lanes(a), Lanes(b));
            for k in 0..8 {
                let narrow = ours(name, a[k], b[k]);
                assert_eq!(wide[k].to_bits(), narrow.to_bits(), "{name}({:e}, {:e})", a[k], b[k]);
            }
        }
    }
}

#[test]
fn outside_their_ranges_the_functions_do_as_documented() {
    for x in [f64::NAN, f64::INFINITY, -f64::INFINITY, 1.600_001e6, -1e300] {
        assert_eq!(Real::sin_cos(x), (0.0, 1.0));
    }
    assert_eq!(ours("sin", f32::NAN, 0.0), 0.0);
    assert_eq!(ours("sin", 1.1e4_f32, 0.0), 0.0);
    assert_eq!(ours("asin", 2.0, 0.0), std::f64::consts::FRAC_PI_2);
    assert_eq!(ours("asin", -f64::INFINITY, 0.0), -std::f64::consts::FRAC_PI_2);
    assert_eq!(ours("asin", f64::NAN, 0.0), 0.0);
    for (y, x) in [(0.0, 0.0), (-0.0, -0.0), (f64::NAN, -1.0), (1.0, f64::NAN)] {
        assert_eq!(ours("atan2", y, x), 0.0);
    }
    assert_eq!(ours("atan2", -0.0, -1.0), std::f64::consts::PI);
    assert_eq!(ours("atan2", 1.0, 0.0), std::f64::consts::FRAC_PI_2);
    assert_eq!(ours("atan2", f64::INFINITY, f64::INFINITY), std::f64::consts::FRAC_PI_4);
    assert_eq!(ours("exp", 0.0, 0.0), 1.0);
    assert_eq!(ours("exp", f64::INFINITY, 0.0), ours("exp", 709.0, 0.0));
    assert_eq!(ours("exp", f64::NAN, 0.0), ours("exp", -708.0, 0.0));
    assert_eq!(ours("ln", 1.0, 0.0), 0.0);
    for x in [f64::NAN, -1.0, 0.0, 1e-320] {
        assert_eq!(ours("ln", x, 0.0), ours("ln", f64::MIN_POSITIVE, 0.0));
    }
    assert_eq!(ours("ln", f64::INFINITY, 0.0), ours("ln", f64::MAX, 0.0));
    assert_eq!(ours("cbrt", f64::NAN, 0.0), 0.0);
    assert_eq!(ours("cbrt", f64::INFINITY, 0.0), ours("cbrt", f64::MAX, 0.0));
    for n in -100_i32..=100 {
        let n = f64::from(n);
        assert_eq!(ours("cbrt", n * n * n, 0.0), n);
    }
}

#[test]
#[allow(clippy::cast_possible_truncation)]
fn floor_is_exact() {
    let mut random = Random(6);
    for i in 0..COUNT {
        let x = if i % 2 == 0 { patterns(&mut random, i) } else { random.spread(-3.0, 56.0) };
        if x.is_finite() {
            assert_eq!(ours("floor", x, 0.0), libm::floor(x), "{x:e}");
        }
        let x = x as f32;
        if x.is_finite() {
            assert_eq!(ours("floor", x, 0.0), libm::floorf(x), "{x:e} single");
        }
    }
    assert_eq!(ours("floor", f64::NAN, 0.0), 0.0);
    assert_eq!(ours("floor", f64::NEG_INFINITY, 0.0), f64::MIN);
}
