//! Dryden turbulence at low altitude, as a field that the mean wind carries past.
//!
//!   `L_w` = h,   `L_u` = `L_v` = h/(0.177 + 0.000823 h)^1.2                    (1)
//!   `s_w` = 0.1 W20,   `s_u` = `s_v` = `s_w`/(0.177 + 0.000823 h)^0.4            (2)
//!   u: x' = -a x + s sqrt(2 a) n                                         (3)
//!   v, w: x1' = x2,  x2' = -a^2 x1 - 2 a x2 + n,  y = s (a^1.5 x1 + sqrt3 a^0.5 x2)   (4)
//!
//! | symbol | meaning |
//! |---|---|
//! | h | height in feet, 10 to 1000, held during a flight |
//! | W20 | wind at 20 ft |
//! | a | V/L with the mean wind speed V, at least 1 m/s |
//! | n | white noise with unit intensity |
//!
//! u lies along the mean wind, w points up. (3) and (4) are stepped by their exact transition and
//! covariance and begun in their stationary law, so the variance is `s^2` at every time and for every
//! step. Source: MIL-F-8785C, 3.7.3 and 3.7.1.2.

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::from_index;

use super::{Disturb, Reach, Scene, Site};
use crate::random::Stream;

record! {
    /// Numbers of the turbulence.
    pub struct Gains {
        /// Mean wind, to which the turbulence is added.
        mean: Vec3<T, World> [m/s] = 0.0, in -100.0 => 100.0;
        /// Height h above the ground, clipped to 3 to 305 m.
        height: T [m] = 10.0, in 0.0 => 1e4;
        /// Wind W20 at 6.1 m (20 ft); 0 takes the speed of the mean wind.
        wind_at_20ft: T [m/s] = 0.0, in 0.0 => 100.0;
    }
}

/// No choices.
pub type Options = ();

record! {
    /// One exact step of (3).
    pub struct Longitudinal {
        /// exp(-a dt).
        keep: T [1];
        /// s sqrt(1 - exp(-2 a dt)).
        fresh: T [m/s];
        /// Standard deviation s.
        deviation: T [m/s];
        /// x, the velocity.
        x: T [m/s];
    }
}

record! {
    /// One exact step of (4), in coordinates s a^1.5 x1 and s a^0.5 x2, both m/s.
    pub struct Lateral {
        /// Transition matrix, row by row.
        transition: [[T; 2]; 2] [1];
        /// Lower Cholesky factor of the covariance of a step: 11, 21, 22.
        factor: [T; 3] [m/s];
        /// Standard deviation s.
        deviation: T [m/s];
        /// The two coordinates.
        x: [T; 2] [m/s];
    }
}

record! {
    /// Dryden turbulence.
    pub struct Dryden {
        /// Mean wind.
        mean: Vec3<T, World> [m/s];
        /// Along the mean wind.
        along: Vec3<T, World> [1];
        /// Velocity along the mean wind.
        u: Longitudinal<T> [];
        /// Across.
        v: Lateral<T> [];
        /// Up.
        w: Lateral<T> [];
        /// Random numbers.
        stream: Stream<T> [];
    }
}

/// exp(-x) sum x^k/k! from k = n: the regularised incomplete gamma function P(n, x), without the
/// cancellation of its complement at small x.
pub fn gamma_p(n: u32, x: f64) -> f64 {
    let (mut term, mut tail, mut head) = (1.0, 0.0, 0.0);
    for k in 0..60 {
        if k < n {
            head += term;
        } else {
            tail += term;
        }
        term *= x / f64::from(k + 1);
    }
    let e = Real::exp(-x);
    if x < 10.0 { e * tail } else { 1.0 - e * head }
}

impl Longitudinal<f64> {
    /// For a = V/L (1/s), standard deviation (m/s) and step (s).
    pub fn new(a: f64, deviation: f64, step: f64) -> Self {
        let fresh = deviation * gamma_p(1, 2.0 * a * step).sqrt();
        Self { keep: Real::exp(-a * step), fresh, deviation, x: 0.0 }
    }
}

impl Lateral<f64> {
    /// For a = V/L (1/s), standard deviation s (m/s) and step T (s). With z = 2 a T:
    ///
    ///   exp(A T) = e^(-a T) [[1 + a T, a T], [-a T, 1 - a T]]
    ///   Q = s^2/4 [[P(3, z), z^2 e^-z/2], [., P(3, z) + 2 z e^-z]]
    pub fn new(a: f64, deviation: f64, step: f64) -> Self {
        let (at, z) = (a * step, 2.0 * a * step);
        let (decay, e) = (Real::exp(-at), Real::exp(-z));
        let transition =
            [[decay * (1.0 + at), decay * at], [-decay * at, decay * (1.0 - at)]];
        let quarter = deviation * deviation / 4.0;
        let p = gamma_p(3, z);
        let q = [quarter * p, quarter * z * z * e / 2.0, quarter * (p + 2.0 * z * e)];
        let l11 = q[0].sqrt();
        let l21 = if l11 > 0.0 { q[1] / l11 } else { 0.0 };
        let l22 = Real::max(q[2] - l21 * l21, 0.0).sqrt();
        Self { transition, factor: [l11, l21, l22], deviation, x: [0.0; 2] }
    }
}

impl<T: Real> Longitudinal<T> {
    #[inline(always)]
    fn step(&mut self, n: T, first: T::Mask) -> T {
        let next = self.x * self.keep + n * self.fresh;
        self.x = T::select(first, n * self.deviation, next);
        self.x
    }
}

impl<T: Real> Lateral<T> {
    #[inline(always)]
    fn step(&mut self, n: [T; 2], first: T::Mask) -> T {
        let [x1, x2] = self.x;
        let [row1, row2] = self.transition;
        let [l11, l21, l22] = self.factor;
        let next = [
            row1[0] * x1 + row1[1] * x2 + l11 * n[0],
            row2[0] * x1 + row2[1] * x2 + l21 * n[0] + l22 * n[1],
        ];
        // Stationary: both coordinates have the variance s^2/4 and no correlation.
        let half = self.deviation.half();
        self.x = from_index(|i| T::select(first, n[i] * half, next[i]));
        self.x[0] + self.x[1] * T::lit(SQRT_3)
    }
}

const SQRT_3: f64 = 1.732_050_807_568_877_2;

/// Scales and intensities in the units of MIL-F-8785C, feet: (`L_u`, `L_w`) in m and (`s_u`, `s_w`) for
/// a height in m and W20 in m/s, (1) and (2).
pub fn scales(height: f64, wind_at_20ft: f64) -> ([f64; 2], [f64; 2]) {
    const FOOT: f64 = 0.3048;
    let h = Real::clamp(height, 3.0, 305.0) / FOOT;
    let ln = Real::ln(0.177 + 0.000_823 * h);
    let (lu, sw) = (h * Real::exp(-1.2 * ln), 0.1 * wind_at_20ft);
    ([lu * FOOT, h * FOOT], [sw * Real::exp(-0.4 * ln), sw])
}

impl Dryden<f64> {
    /// The disturbance.
    pub fn new(gains: Gains<f64>, _: Options, site: &Site<f64>) -> Self {
        let Gains { mean, height, wind_at_20ft } = gains;
        let level = Vec3::new(mean.x, mean.y, 0.0);
        let speed = level.norm();
        let w20 = if wind_at_20ft > 0.0 { wind_at_20ft } else { speed };
        let ([lu, lw], [su, sw]) = scales(height, w20);
        let v = Real::max(speed, 1.0);
        Self {
            mean,
            along: if speed > 0.0 { level.unit() } else { Vec3::new(1.0, 0.0, 0.0) },
            u: Longitudinal::new(v / lu, su, site.step),
            v: Lateral::new(v / lu, su, site.step),
            w: Lateral::new(v / lw, sw, site.step),
            stream: Stream::new(site.key, "gusts"),
        }
    }
}

impl<T: Real> Disturb<T> for Dryden<T> {
    fn reach(&self) -> Reach {
        Reach::Air
    }
    fn remembers(&self) -> bool {
        true
    }
    #[inline(always)]
    fn wind(&mut self, scene: &Scene<T>) -> Vec3<T, World> {
        let first = scene.tick.eq(T::zero());
        let (tick, stream) = (scene.tick, &self.stream);
        let (a, b, c) = (stream.normals(tick, 0), stream.normals(tick, 1), stream.normals(tick, 2));
        let u = self.u.step(c[0], first);
        let v = self.v.step(a, first);
        let w = self.w.step(b, first);
        let across = Vec3::up(T::one()).cross(self.along);
        self.mean + self.along * u + across * v + Vec3::up(w)
    }
}
