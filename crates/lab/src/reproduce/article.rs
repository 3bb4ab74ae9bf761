//! The article's results table, and why no flight can have it.
//!
//! For any signal ISE = int e^2 <= max|e| int |e| = max * IAE                (1)

/// One column of the article's table for one signal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Printed {
    /// Controller and condition.
    pub column: &'static str,
    /// `position` (m) or `attitude` (rad).
    pub signal: &'static str,
    /// Integral of the absolute error.
    pub iae: f64,
    /// Integral of the squared error.
    pub ise: f64,
    /// Largest error.
    pub max: f64,
}

impl Printed {
    /// ISE/(max * IAE): at most 1 for any signal (1).
    pub fn factor(&self) -> f64 {
        self.ise / (self.max * self.iae)
    }

    /// The least maximum that IAE and ISE allow.
    pub fn implied_max(&self) -> f64 {
        self.ise / self.iae
    }
}

const fn printed(
    column: &'static str,
    signal: &'static str,
    iae: f64,
    ise: f64,
    max: f64,
) -> Printed {
    Printed { column, signal, iae, ise, max }
}

/// The article's table 4, as printed.
pub const TABLE: [Printed; 6] = [
    printed("proposed", "position", 0.125, 0.018, 0.05),
    printed("standard PID", "position", 1.842, 0.956, 0.35),
    printed("proposed, no disturbance", "position", 0.032, 0.001, 0.01),
    printed("proposed", "attitude", 0.041, 0.003, 0.02),
    printed("standard PID", "attitude", 0.253, 0.128, 0.15),
    printed("proposed, no disturbance", "attitude", 0.015, 0.0004, 0.005),
];

#[cfg(test)]
mod tests {
    use super::TABLE;

    #[test]
    fn val_every_column_breaks_the_inequality_by_the_factor_of_theory_1_3() {
        let factors = [2.88, 1.48, 3.13, 3.66, 3.37, 5.33];
        let implied = [0.144, 0.519, 0.031, 0.073, 0.506, 0.027];
        for ((column, factor), max) in TABLE.iter().zip(factors).zip(implied) {
            assert!((column.factor() - factor).abs() < 0.006, "{column:?}");
            assert!((column.implied_max() - max).abs() < 0.0006, "{column:?}");
        }
    }
}
