//! What a plan draws: on top of the plant's counters, a permutation and the normal quantile.
//!
//! A permutation of 0..n is a Feistel network of four rounds on the next power of four, walked until the
//! result lies below n: no table, whatever n is.
//!
//! Source: Black and Rogaway, "Ciphers with arbitrary finite domains" (2002); normal quantile: Wichura,
//! AS 241 (1988).

use stormpetrel_control::real::Real;
pub use stormpetrel_plant::random::{key, named, unit};

/// Where a permutation of 0..n, chosen by `key`, sends `i`.
pub fn permuted(i: u64, n: u64, permutation: u64) -> u64 {
    let bits = (u64::BITS - n.saturating_sub(1).leading_zeros()).div_ceil(2);
    let low = (1u64 << bits) - 1;
    let mut place = i;
    loop {
        let (mut left, mut right) = (place >> bits, place & low);
        for round in 0..4 {
            (left, right) = (right, left ^ (key(permutation ^ round, right) & low));
        }
        place = (left << bits) | right;
        if place < n {
            return place;
        }
    }
}

/// Quantile of the standard normal distribution at 0 < p < 1 (PPND16, relative error about 1e-16).
pub fn normal_quantile(p: f64) -> f64 {
    const A: [f64; 8] = [
        3.387_132_872_796_366_5,
        1.331_416_678_917_843_8e2,
        1.971_590_950_306_551_3e3,
        1.373_169_376_550_946e4,
        4.592_195_393_154_987e4,
        6.726_577_092_700_87e4,
        3.343_057_558_358_813e4,
        2.509_080_928_730_122_7e3,
    ];
    const B: [f64; 8] = [
        1.0,
        4.231_333_070_160_091e1,
        6.871_870_074_920_579e2,
        5.394_196_021_424_751e3,
        2.121_379_430_158_659_7e4,
        3.930_789_580_009_271e4,
        2.872_908_573_572_194_3e4,
        5.226_495_278_852_545e3,
    ];
    const C: [f64; 8] = [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        2.417_807_251_774_506e-1,
        2.272_384_498_926_918_4e-2,
        7.745_450_142_783_414e-4,
    ];
    const D: [f64; 8] = [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        6.897_673_349_851e-1,
        1.481_039_764_274_800_8e-1,
        1.519_866_656_361_645_7e-2,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ];
    const E: [f64; 8] = [
        6.657_904_643_501_103,
        5.463_784_911_164_114,
        1.784_826_539_917_291_3,
        2.965_605_718_285_048_7e-1,
        2.653_218_952_657_612_4e-2,
        1.242_660_947_388_078_4e-3,
        2.711_555_568_743_487_6e-5,
        2.010_334_399_292_288_1e-7,
    ];
    const F: [f64; 8] = [
        1.0,
        5.998_322_065_558_88e-1,
        1.369_298_809_227_358e-1,
        1.487_536_129_085_061_5e-2,
        7.868_691_311_456_133e-4,
        1.846_318_317_510_054_8e-5,
        1.421_511_758_316_446e-7,
        2.044_263_103_389_939_8e-15,
    ];
    let polynomial =
        |c: &[f64; 8], x: f64| c.iter().rev().fold(0.0, |sum, coefficient| sum * x + coefficient);
    let q = p - 0.5;
    if q.abs() <= 0.425 {
        let r = 0.180_625 - q * q;
        return q * polynomial(&A, r) / polynomial(&B, r);
    }
    let tail = if q < 0.0 { p } else { 1.0 - p };
    let r = Real::sqrt(-Real::ln(tail));
    let x = if r <= 5.0 {
        polynomial(&C, r - 1.6) / polynomial(&D, r - 1.6)
    } else {
        polynomial(&E, r - 5.0) / polynomial(&F, r - 5.0)
    };
    if q < 0.0 { -x } else { x }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_permutation_meets_every_place_once() {
        for n in [1, 2, 3, 7, 64, 100, 1000, 4097] {
            for permutation in [1, 77] {
                let mut seen: Vec<u64> = (0..n).map(|i| permuted(i, n, permutation)).collect();
                seen.sort_unstable();
                assert_eq!(seen, (0..n).collect::<Vec<_>>(), "{n}");
            }
        }
    }

    #[test]
    fn draws_are_uniform_and_their_streams_independent() {
        const N: u64 = 200_000;
        let draw = |i, name: &str| unit(named(key(5, i), name));
        let (mut sums, mut product, mut last) = ([0.0; 2], 0.0, 0.0);
        let mut cells = [0.0; 100];
        for i in 0..N {
            let (a, b) = (draw(i, "mass"), draw(i, "inertia"));
            sums[0] += a - 0.5;
            sums[1] += (a - 0.5) * last;
            product += (a - 0.5) * (b - 0.5);
            last = a - 0.5;
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            let cell = (a * 100.0) as usize;
            cells[cell] += 1.0;
        }
        let n = N as f64;
        // 99.99 % bounds of sums of independent draws: variance 1/12 and 1/144.
        assert!(sums[0].abs() < 3.9 * (n / 12.0).sqrt());
        assert!(sums[1].abs() < 3.9 * n.sqrt() / 12.0 && product.abs() < 3.9 * n.sqrt() / 12.0);
        let expected = n / 100.0;
        let chi_square: f64 =
            cells.iter().map(|c| (c - expected) * (c - expected) / expected).sum();
        // 99 degrees of freedom: 99.99 % quantile 161.3 (tables).
        assert!(chi_square < 161.3, "{chi_square}");
    }

    #[test]
    fn the_normal_quantile_has_its_published_values() {
        // Wichura's own check values, and common quantiles.
        for (p, x) in [
            (0.25, -0.674_489_750_196_081_7),
            (0.001, -3.090_232_306_167_813_6),
            (1e-20, -9.262_340_089_798_408),
            (0.975, 1.959_963_984_540_054),
            (0.5, 0.0),
        ] {
            let off: f64 = normal_quantile(p) - x;
            assert!(off.abs() < 2e-15 * (1.0 + f64::abs(x)), "{p}: {off:e}");
        }
    }
}
