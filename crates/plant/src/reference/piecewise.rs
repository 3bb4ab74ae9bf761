//! Curves made of polynomials: what `minimum-snap`, `race` and `table` have in common.
//!
//!   x(s) = sum_k c_k ((s - s_i)/l_i)^k,   k = 0 ... 7,   s_i <= s < s_i + l_i    (1)
//!
//! for x, y, z and the heading. The coefficients are made where the scenario is read (`lab`): they need
//! memory, and a flight is a plain value that has none. A curve depends on its table alone, so it is one
//! of the options, equal in all lanes. How fast it is flown is a number, `pace`, and may differ.

use stormpetrel_control::options::{Field, OptionVisitor};
use stormpetrel_control::real::Real;
use stormpetrel_control::record::{RecordExt as _, each, from_index};
use stormpetrel_control::signals::Trajectory;

use super::phase::{Jet, chain, trajectory};

/// Coefficients of one polynomial.
pub const TERMS: usize = 8;

/// One polynomial for each of x, y, z (m) and the heading (rad).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Piece {
    /// Phase at its beginning.
    pub begin: f64,
    /// Length in phase.
    pub length: f64,
    /// Coefficients (1), lowest power first: x, y, z, heading.
    pub terms: [[f64; TERMS]; 4],
}

/// A curve over its phase, which begins at zero. The phase of a recording is its time, s; else it has no
/// unit, and speeds are metres per phase.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Curve {
    /// The polynomials, each beginning where the one before ends.
    pub pieces: &'static [Piece],
    /// Largest speed, m per phase.
    pub speed: f64,
    /// Largest acceleration, m per phase squared.
    pub acceleration: f64,
    /// Largest rate of the heading, rad per phase.
    pub yaw_rate: f64,
    /// How far the heading has turned at the end of a closed curve, rad.
    pub turn: f64,
    /// Largest distance from the table's points, m.
    pub worst_fit: f64,
    /// Root mean square of the distances from the table's points, m.
    pub mean_fit: f64,
}

/// Made from the table beside it, so no visitor sees it and no file can set it.
impl Field for Curve {
    fn show(&mut self, _: &'static str, _: &'static str, _: &mut impl OptionVisitor) {}
}

/// What a flight along a curve must keep to.
#[derive(Clone, Copy, Debug)]
pub struct Limits<T> {
    /// Largest speed, m/s.
    pub speed: T,
    /// Largest acceleration, m/s^2.
    pub acceleration: T,
    /// Largest rate of the heading, rad/s.
    pub yaw_rate: T,
}

/// Stands in for a divisor of zero.
const TINY: f64 = 1e-30;

impl Curve {
    /// Phase at the end; 1 for a curve without pieces, which is a point.
    #[inline(always)]
    pub fn end(&self) -> f64 {
        self.pieces.last().map_or(1.0, |piece| piece.begin + piece.length)
    }

    /// The fastest full pace p, phase per second, that keeps to the limits where it is flown at p `share`
    /// and that changes by p `change` in a second: A (share p)^2 + V change p <= a, solved for p.
    pub fn pace<T: Real>(&self, limits: &Limits<T>, share: T, change: T) -> T {
        let (tiny, two) = (T::lit(TINY), T::lit(2.0));
        let a = T::lit(self.acceleration) * share.sq();
        let b = T::lit(self.speed) * change;
        let root = (b.sq() + T::lit(4.0) * a * limits.acceleration).sqrt();
        let by_acceleration = two * limits.acceleration / (b + root).max(tiny);
        by_acceleration
            .min(limits.speed / T::lit(self.speed).max(tiny))
            .min(limits.yaw_rate / T::lit(self.yaw_rate).max(tiny))
    }

    /// The trajectory where the phase is this function of time.
    #[inline(always)]
    pub fn at<T: Real>(&self, phase: Jet<T>) -> Trajectory<T> {
        let mut at = Trajectory::default();
        for i in 0..T::LANES {
            self.one(each(phase, |x| x.lane(i))).put_lane(&mut at, i);
        }
        at
    }

    #[inline(always)]
    fn one<T: Real>(&self, phase: Jet<T>) -> Trajectory<T> {
        let Some(piece) = self.find(phase[0].to_f64()) else { return Trajectory::default() };
        let per = T::one() / T::lit(piece.length);
        let s = (phase[0] - T::lit(piece.begin)) * per;
        let of = |axis: usize| chain(polynomial(&piece.terms[axis], s, per), phase);
        trajectory([of(0), of(1), of(2)], of(3))
    }

    /// The last piece that has begun, by bisection.
    #[inline(always)]
    fn find(&self, phase: f64) -> Option<&'static Piece> {
        let (mut low, mut high) = (0, self.pieces.len());
        while low + 1 < high {
            let middle = low.midpoint(high);
            match self.pieces.get(middle) {
                Some(piece) if piece.begin <= phase => low = middle,
                _ => high = middle,
            }
        }
        self.pieces.get(low)
    }
}

/// Value and derivatives of the polynomial at `s`, where `s` grows by `per` for each unit of the phase.
#[inline(always)]
fn polynomial<T: Real>(terms: &[f64; TERMS], s: T, per: T) -> Jet<T> {
    // Horner's scheme on the Taylor coefficients: the k-th derivative over k!.
    let mut d = [T::zero(); 5];
    for k in (0..TERMS).rev() {
        let lower = [T::lit(terms[k]), d[0], d[1], d[2], d[3]];
        d = from_index(|i| d[i] * s + lower[i]);
    }
    let (two, per2) = (T::lit(2.0), per.sq());
    [
        d[0],
        d[1] * per,
        d[2] * two * per2,
        d[3] * T::lit(6.0) * per2 * per,
        d[4] * T::lit(24.0) * per2.sq(),
    ]
}
