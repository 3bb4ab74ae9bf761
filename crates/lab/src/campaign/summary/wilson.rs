//! Confidence interval of a share.

use stormpetrel_control::real::Real;

/// The 97.5 % quantile of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// Where a share lies, with 95 % confidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end, 0 to 1.
    pub low: f64,
    /// Upper end, 0 to 1.
    pub high: f64,
}

/// The 95 % interval of the success probability after that many successes in that many flights.
///
/// With p the share of successes, n the flights, z = 1.96 the normal quantile:
///   centre = (p + z^2/2n)/(1 + z^2/n)                                    (1)
///   half = z sqrt(p (1 - p)/n + z^2/4n^2)/(1 + z^2/n)                    (2)
/// It never leaves 0 to 1, and without a failure (or a success) ends there exactly. Nothing flown:
/// the whole of 0 to 1.
///
/// Source: E. B. Wilson, "Probable inference, the law of succession, and statistical inference",
/// Journal of the American Statistical Association 22 (1927), 209-212.
pub fn wilson(successes: u64, flights: u64) -> Interval {
    if flights == 0 {
        return Interval { low: 0.0, high: 1.0 };
    }
    let n = flights as f64;
    let p = successes as f64 / n;
    let whole = 1.0 + Z.sq() / n;
    let centre = (p + 0.5 * Z.sq() / n) / whole; // (1)
    let half = Z * (p * (1.0 - p) / n + 0.25 * Z.sq() / n.sq()).sqrt() / whole; // (2)
    Interval {
        low: if successes == 0 { 0.0 } else { centre - half },
        high: if successes >= flights { 1.0 } else { centre + half },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// R. G. Newcombe, "Two-sided confidence intervals for the single proportion", Statistics in
    /// Medicine 17 (1998), 857-872, table I, method 3.
    #[test]
    fn val_newcombe_1998() {
        let published = [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0000, 0.1611),
            (1, 29, 0.0061, 0.1718),
        ];
        for (successes, flights, low, high) in published {
            let found = wilson(successes, flights);
            let near = |a: f64, b: f64| (a - b).abs() <= 0.5e-4;
            assert!(near(found.low, low) && near(found.high, high), "{found:?}");
        }
    }

    #[test]
    fn the_ends_are_exact() {
        for flights in [1, 7, 1_000_000_u64] {
            let n = flights as f64;
            let none = wilson(0, flights);
            assert!(none.low.to_bits() == 0 && (none.high - Z.sq() / (n + Z.sq())).abs() < 1e-15);
            let all = wilson(flights, flights);
            assert!(all.high.to_bits() == 1.0_f64.to_bits());
            assert!((all.low - n / (n + Z.sq())).abs() < 1e-15);
        }
        assert_eq!(wilson(0, 0), Interval { low: 0.0, high: 1.0 });
    }

    /// The ends are the shares whose own standard deviation puts p just z away.
    #[test]
    fn the_ends_solve_the_score_equation() {
        let (p, n) = (0.3, 50.0);
        let Interval { low, high } = wilson(15, 50);
        for end in [low, high] {
            let score = (p - end) / (end * (1.0 - end) / n).sqrt();
            assert!((score.abs() - Z).abs() < 1e-12, "{score}");
        }
    }
}
