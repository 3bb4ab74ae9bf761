//! A path given by a phase, and the phase as a function of time that starts from rest.
//!
//!   phi' = S(t/r),   S(u) = 35 u^4 - 84 u^5 + 70 u^6 - 20 u^7,   0 <= u <= 1    (1)
//!   phi  = r (7 u^5 - 14 u^6 + 10 u^7 - 5/2 u^8) + max(t - r, 0)                 (2)
//!
//! The first three derivatives of S are zero at both ends, so the snap of a path p(phi(t)) is continuous
//! there. The chain rule up to the fourth derivative is that of Faa di Bruno:
//!   x'    = p' phi'                                                              (3)
//!   x''   = p'' phi'^2 + p' phi''                                                (4)
//!   x'''  = p''' phi'^3 + 3 p'' phi' phi'' + p' phi'''                           (5)
//!   x'''' = p'''' phi'^4 + 6 p''' phi'^2 phi'' + p'' (3 phi''^2 + 4 phi' phi''')
//!           + p' phi''''                                                         (6)

use stormpetrel_control::math::Vec3;
use stormpetrel_control::real::Real;
use stormpetrel_control::record::from_index;
use stormpetrel_control::signals::Trajectory;

/// A quantity and its first four derivatives.
pub type Jet<T> = [T; 5];

/// A ramp shorter than this counts as none, s.
const SHORTEST: f64 = 1e-3;

/// The phase (2), s, and its derivatives by time; `ramp` is r, s. At once where r is zero.
#[inline(always)]
pub fn from_rest<T: Real>(time: T, ramp: T) -> Jet<T> {
    let (zero, one) = (T::zero(), T::one());
    let at_once = ramp.lt(T::lit(SHORTEST));
    let r = T::select(at_once, one, ramp);
    let u = (time / r).clamp(zero, one);
    let (v, per) = (one - u, one / r);
    let polynomial = T::lit(7.0) + u * (T::lit(-14.0) + u * (T::lit(10.0) - u * T::lit(2.5)));
    let step = T::lit(35.0) + u * (T::lit(-84.0) + u * (T::lit(70.0) - u * T::lit(20.0)));
    let (u4, uv) = (u.sq().sq(), u * v);
    let ramped = [
        r * u4 * u * polynomial + (time - r).max(zero), // (2)
        u4 * step,                                      // (1)
        T::lit(140.0) * uv.sq() * uv * per,
        T::lit(420.0) * uv.sq() * (v - u) * per.sq(),
        T::lit(840.0) * uv * (one - T::lit(5.0) * uv) * per.sq() * per,
    ];
    let plain = [time, one, zero, zero, zero];
    from_index(|k| T::select(at_once, plain[k], ramped[k]))
}

/// The phase that goes on at `rate` per second until `end`, and stays there; before the start at zero.
#[inline(always)]
pub fn until<T: Real>(time: T, rate: T, end: T) -> Jet<T> {
    let phase = (time * rate).max(T::zero());
    let zero = T::zero();
    [phase.min(end), T::select(end.le(phase), zero, rate), zero, zero, zero]
}

/// A function p of the phase, with its derivatives by the phase, as a function of time (3-6).
#[inline(always)]
pub fn chain<T: Real>(p: Jet<T>, phase: Jet<T>) -> Jet<T> {
    let [_, w, w1, w2, w3] = phase;
    let lit = T::lit;
    let sq = w.sq();
    [
        p[0],
        p[1] * w,
        p[2] * sq + p[1] * w1,
        p[3] * sq * w + lit(3.0) * p[2] * w * w1 + p[1] * w2,
        p[4] * sq.sq()
            + lit(6.0) * p[3] * sq * w1
            + p[2] * (lit(3.0) * w1.sq() + lit(4.0) * w * w2)
            + p[1] * w3,
    ]
}

/// `amplitude sin(angle)` where the angle grows by `frequency` for each unit of the phase.
#[inline(always)]
pub fn sine<T: Real>(amplitude: T, frequency: T, (sin, cos): (T, T)) -> Jet<T> {
    let (s, c, w2) = (amplitude * sin, amplitude * cos * frequency, frequency.sq());
    [s, c, -(s * w2), -(c * w2), s * w2.sq()]
}

/// The trajectory with these coordinates and this heading, all functions of time.
#[inline(always)]
pub fn trajectory<T: Real>([x, y, z]: [Jet<T>; 3], yaw: Jet<T>) -> Trajectory<T> {
    Trajectory {
        position: Vec3::new(x[0], y[0], z[0]),
        velocity: Vec3::new(x[1], y[1], z[1]),
        acceleration: Vec3::new(x[2], y[2], z[2]),
        jerk: Vec3::new(x[3], y[3], z[3]),
        snap: Vec3::new(x[4], y[4], z[4]),
        yaw: yaw[0],
        yaw_rate: yaw[1],
        yaw_acceleration: yaw[2],
    }
}

/// A quantity that does not change.
#[inline(always)]
pub fn constant<T: Real>(x: T) -> Jet<T> {
    let zero = T::zero();
    [x, zero, zero, zero, zero]
}
