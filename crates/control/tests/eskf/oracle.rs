//! What the filter is measured against.

use nalgebra::{DMatrix, DVector, Quaternion, UnitQuaternion, Vector3};
use stormpetrel_control::estimator::covariance::{Covariance, ErrorState, Parts};
use stormpetrel_control::estimator::{Eskf, Gains, Nominal};
use stormpetrel_control::math::{Frame, Rotation, Vec3};
use stormpetrel_control::signals::Model;

pub type V = Vector3<f64>;
pub const G: f64 = 9.8;

pub fn vec3<F: Frame>(v: V) -> Vec3<f64, F> {
    Vec3::new(v.x, v.y, v.z)
}

pub fn vector<F: Frame>(v: Vec3<f64, F>) -> V {
    V::new(v.x, v.y, v.z)
}

pub fn quaternion<A: Frame, B: Frame>(q: Rotation<f64, A, B>) -> UnitQuaternion<f64> {
    UnitQuaternion::new_unchecked(Quaternion::new(q.w, q.x, q.y, q.z))
}

/// Uniform numbers in -1..1 from a counter; nothing of the program is used.
pub struct Dice(pub u64);

impl Dice {
    pub fn next(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64) / 4_503_599_627_370_496.0 - 1.0
    }
    pub fn vector(&mut self) -> V {
        V::new(self.next(), self.next(), self.next())
    }
}

/// The exact state.
#[derive(Clone, Copy)]
pub struct Exact {
    pub p: V,
    pub v: V,
    pub q: UnitQuaternion<f64>,
    pub bg: V,
    pub ba: V,
}

impl Exact {
    pub fn start() -> Self {
        Self {
            p: V::new(1.0, -2.0, 3.0),
            v: V::new(0.5, 1.5, -0.7),
            q: UnitQuaternion::from_euler_angles(0.3, -0.5, 1.1),
            bg: V::new(0.01, -0.02, 0.03),
            ba: V::new(0.1, 0.2, -0.15),
        }
    }

    /// p' = v, v' = R (f - b_a) - g, R' = R [w - b_g]x by Runge-Kutta on the rotation vector's short way.
    pub fn flow(
        mut self,
        f: impl Fn(f64) -> V,
        w: impl Fn(f64) -> V,
        from: f64,
        span: f64,
        n: usize,
    ) -> Self {
        let h = span / n as f64;
        for k in 0..n {
            let t = from + k as f64 * h;
            // Magnus to fourth order for the rotation, Simpson for the rest: error of h^4.
            let rate = |s: f64| w(t + s * h) - self.bg;
            let (w0, w1, w2) = (rate(0.0), rate(0.5), rate(1.0));
            let half = (w0 * 5.0 + w1 * 8.0 - w2) * (h / 24.0);
            let whole = (w0 + w1 * 4.0 + w2) * (h / 6.0) + w0.cross(&w2) * (h * h / 12.0);
            let middle = self.q * UnitQuaternion::from_scaled_axis(half);
            let end = self.q * UnitQuaternion::from_scaled_axis(whole);
            let a = |q: UnitQuaternion<f64>, s: f64| q * (f(t + s * h) - self.ba) - V::z() * G;
            let (a0, a1, a2) = (a(self.q, 0.0), a(middle, 0.5), a(end, 1.0));
            self.p += self.v * h + (a0 + a1 * 2.0) * (h * h / 6.0);
            self.v += (a0 + a1 * 4.0 + a2) * (h / 6.0);
            self.q = end;
        }
        self
    }

    pub fn plus(self, e: &DVector<f64>) -> Self {
        let part = |i: usize| V::new(e[i], e[i + 1], e[i + 2]);
        Self {
            p: self.p + part(0),
            v: self.v + part(3),
            q: self.q * UnitQuaternion::from_scaled_axis(part(6)),
            bg: self.bg + part(9),
            ba: self.ba + part(12),
        }
    }

    pub fn minus(self, other: Self) -> DVector<f64> {
        let theta = (other.q.inverse() * self.q).scaled_axis();
        let parts =
            [self.p - other.p, self.v - other.v, theta, self.bg - other.bg, self.ba - other.ba];
        DVector::from_iterator(15, parts.iter().flat_map(|v| [v.x, v.y, v.z]))
    }

    pub fn nominal(self) -> Nominal<f64> {
        Nominal {
            position: vec3(self.p),
            velocity: vec3(self.v),
            attitude: Rotation::from_quaternion(self.q.w, self.q.i, self.q.j, self.q.k),
            gyro_bias: vec3(self.bg),
            accelerometer_bias: vec3(self.ba),
        }
    }

    pub fn of(n: &Nominal<f64>) -> Self {
        Self {
            p: vector(n.position),
            v: vector(n.velocity),
            q: quaternion(n.attitude),
            bg: vector(n.gyro_bias),
            ba: vector(n.accelerometer_bias),
        }
    }
}

pub fn filter(gains: Gains<f64>) -> Eskf<f64> {
    let mut filter = Eskf::new(gains, &Model { gravity: G, ..Model::default() });
    filter.nominal = Exact::start().nominal();
    filter
}

pub fn force(t: f64) -> V {
    V::new((3.0 * t).sin(), 0.7 * (2.0 * t).cos(), 9.5 + 2.0 * (4.0 * t).sin())
}

pub fn rate(t: f64) -> V {
    V::new(1.5 * (5.0 * t).cos(), -0.8 * (3.0 * t).sin(), 0.6 + 0.4 * (2.0 * t).cos())
}

pub fn dense(p: &Covariance<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(15, 15, |i, j| p.get(i / 3, j / 3)[i % 3][j % 3])
}

pub fn parts(v: &DVector<f64>) -> Parts<f64> {
    core::array::from_fn(|i| core::array::from_fn(|a| v[3 * i + a]))
}

pub fn flat(e: &ErrorState<f64>) -> DVector<f64> {
    DVector::from_iterator(15, e.parts().into_iter().flatten())
}

/// A dense covariance with errors of very different sizes.
pub fn scattered(dice: &mut Dice) -> Covariance<f64> {
    let size = [0.5, 0.2, 0.05, 0.004, 0.03];
    let mut p = Covariance::diagonal(&ErrorState::from_parts(size.map(|s| [s; 3])));
    // Shears between all parts fill the matrix; it stays positive.
    for i in 0..5 {
        for j in (0..5).filter(|j| *j != i) {
            let k = 0.5 * size[i] / size[j] * dice.next();
            let mixed = core::array::from_fn(|a| {
                core::array::from_fn(|b| [k, 0.3 * k, 0.0][(b + 3 - a) % 3])
            });
            p.shear(i, j, &mixed);
        }
    }
    p
}

pub fn far(a: &DMatrix<f64>, b: &DMatrix<f64>) -> f64 {
    // Each number against the deviations of its row and column.
    (0..15)
        .flat_map(|i| (0..15).map(move |j| (i, j)))
        .map(|(i, j)| (a[(i, j)] - b[(i, j)]).abs() / (b[(i, i)] * b[(j, j)]).sqrt())
        .fold(0.0, f64::max)
}
