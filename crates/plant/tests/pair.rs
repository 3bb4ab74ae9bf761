//! What two numbers in one register come to, against each of them alone: bit for bit, for every operation and
//! every pattern of bits.
#![cfg(all(feature = "std", target_arch = "x86_64"))]
#![allow(clippy::pedantic, clippy::float_cmp)] // tests compare bits

use stormpetrel_control::real::{Double, Mask, Precision, Real};
use stormpetrel_plant::pair::Pair;

const COUNT: u64 = if cfg!(debug_assertions) { 20_000 } else { 400_000 };

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

    /// Special values, numbers of ordinary size, and patterns of any kind.
    fn number(&mut self) -> f64 {
        const SPECIAL: [f64; 10] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NAN,
            f64::MIN_POSITIVE,
            5e-324,
            f64::MAX,
        ];
        let bits = self.bits();
        match bits % 4 {
            0 => SPECIAL[(bits >> 8) as usize % SPECIAL.len()],
            1 => f64::from_bits(bits),
            _ => ((bits >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * 20.0,
        }
    }

    fn two(&mut self) -> [f64; 2] {
        [self.number(), self.number()]
    }
}

fn pair(two: [f64; 2]) -> Pair {
    Pair::from_lanes(|i| two[i])
}

/// Two NaN are alike whatever bits they carry.
fn alike(a: f64, b: f64) -> bool {
    a.to_bits() == b.to_bits() || a.is_nan() && b.is_nan()
}

/// Everything that a scalar can do with three numbers.
fn all<T: Real>([a, b, c]: [T; 3]) -> Vec<(&'static str, T)> {
    let mut sum = a;
    sum += b;
    let mut difference = a;
    difference -= b;
    let (sin, cos) = a.sin_cos();
    let [third, two_thirds] = a.thirds();
    let n = (a.clamp(T::lit(-1e6), T::lit(1e6))).round() + T::lit(T::Precision::ROUND);
    let (sine, cosine) = T::after_quarters(b, c, n);
    let normal = a.abs().clamp(T::lit(1e-300), T::lit(1e300));
    let (mantissa, exponent) = normal.split_exponent();
    let mask = (a.lt(b) & !b.le(c)) | c.eq(a);
    vec![
        ("add", a + b),
        ("sub", a - b),
        ("mul", a * b),
        ("div", a / b),
        ("neg", -a),
        ("add_assign", sum),
        ("sub_assign", difference),
        ("sqrt", a.sqrt()),
        ("abs", a.abs()),
        ("min", a.min(b)),
        ("max", a.max(b)),
        ("clamp", a.clamp(b, c)),
        ("lt", T::select(a.lt(b), T::one(), T::zero())),
        ("le", T::select(a.le(b), T::one(), T::zero())),
        ("eq", T::select(a.eq(b), T::one(), T::zero())),
        ("is_finite", T::select(a.is_finite(), T::one(), T::zero())),
        ("select", T::select(mask, b, c)),
        ("sign", a.sign()),
        ("with_sign", a.with_sign(b)),
        ("over_root", a.over_root(normal)),
        ("sine after quarters", sine),
        ("cosine after quarters", cosine),
        ("mantissa", mantissa),
        ("exponent", exponent),
        ("power_of_two", exponent.power_of_two()),
        ("inverse_cbrt_guess", normal.inverse_cbrt_guess()),
        ("round", a.round()),
        ("floor", a.floor()),
        ("sin", sin),
        ("cos", cos),
        ("asin", a.asin()),
        ("atan2", a.atan2(b)),
        ("exp", a.exp()),
        ("ln", a.ln()),
        ("cbrt", a.cbrt()),
        ("third", third),
        ("two thirds", two_thirds),
    ]
}

#[test]
fn every_operation_has_the_bits_of_single_numbers() {
    let mut random = Random(11);
    for _ in 0..COUNT {
        let three = [random.two(), random.two(), random.two()];
        let both = all(three.map(pair));
        for lane in 0..2 {
            let one = all(three.map(|two| two[lane]));
            for ((name, both), (_, one)) in both.iter().zip(one) {
                assert!(
                    alike(both.lane(lane), one),
                    "{name}, lane {lane} of {three:?}: {:e}, {one:e}",
                    both.lane(lane)
                );
            }
        }
    }
}

#[test]
fn lanes_and_parts_are_where_they_belong() {
    let mut two = pair([1.0, 2.0]);
    assert_eq!((Pair::LANES, Pair::PARTS), (2, 1));
    assert_eq!([two.lane(0), two.lane(1), two.lane(2), two.to_f64()], [1.0, 2.0, 1.0, 1.0]);
    two.set_lane(1, 3.0);
    assert_eq!([two.lane(0), two.lane(1)], [1.0, 3.0]);
    let part = two.part(0);
    two.set_part(0, part + Pair::lit(0.5));
    assert_eq!([two.lane(0), two.lane(1)], [1.5, 3.5]);
    assert_eq!(Pair::default().lane(1), 0.0);
    assert_eq!(Pair::lit(Double::ROUND).lane(1), Double::ROUND);
}

#[test]
fn answers_are_told_apart() {
    type Answer = <Pair as Real>::Mask;
    let (two, three) = (pair([1.0, 5.0]), Pair::lit(3.0));
    let less = two.lt(three);
    assert_eq!([less.lane(0), less.lane(1), less.all()], [true, false, false]);
    assert!((less | !less).all() && !(less & !less).lane(0));
    assert!(Answer::splat(true).all() && !Answer::splat(false).lane(1));
    let second = Answer::from_lanes(|i| i == 1);
    assert_eq!([second.lane(0), second.lane(1), second.all()], [false, true, false]);
}
