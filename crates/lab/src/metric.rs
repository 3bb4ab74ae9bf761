//! Numbers that sum up a flight, computed tick by tick, in any lane.
//!
//! For an error e sampled every `dt` over the time flown T:
//!   IAE = sum |e| dt,  ISE = sum e^2 dt,  ITAE = sum t |e| dt            (1)
//!   RMSE = sqrt(ISE/T)                                                   (2)
//!   max >= |e|, late maximum: the same from `run.late` on                (3)
//! so that `max * IAE >= ISE >= IAE^2/T` for every flight (theory 1.3), which is asserted.

mod distribution;
mod names;

use stormpetrel_control::attitude::euler::difference;
use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_plant::flight::Tick;

pub use distribution::Distribution;
pub use names::{About, OF_FLIGHT, OF_SIGNALS, SIGNALS, describe, names, of_attitude};

record! {
    /// Integrals and maxima of one error signal.
    pub struct Integrals {
        /// Integral of the absolute error.
        iae: T [];
        /// Integral of the squared error.
        ise: T [];
        /// Integral of time times absolute error.
        itae: T [];
        /// Largest absolute error.
        max: T [];
        /// Largest absolute error in the late window; negative while no sample lay in it.
        late_max: T [];
    }
}

impl<T: Real> Integrals<T> {
    fn new() -> Self {
        Self { late_max: -T::one(), ..Self::default() }
    }

    #[inline(always)]
    fn push(&mut self, e: T, time: T, weight: T, late: T) {
        let e = e.abs();
        self.iae += e * weight; // (1)
        self.ise += e.sq() * weight;
        self.itae += time * e * weight;
        let counted = T::select(T::zero().lt(weight), e, T::zero());
        self.max = self.max.max(counted); // (3)
        let seen = T::select(T::zero().lt(weight * late), e, -T::one());
        self.late_max = self.late_max.max(seen);
    }
}

record! {
    /// The error signals of one tick.
    pub struct Errors {
        /// Distance from the reference.
        position: T [m];
        /// Position error by axis.
        axis: Vec3<T, World> [m];
        /// Rotation angle between the law's attitude reference and the attitude.
        angle: T [rad];
        /// Norm of the Euler-angle differences, as the article has it.
        euler: T [rad];
        /// Angle between the thrust axes of vehicle and trajectory.
        tilt: T [rad];
        /// Heading error.
        yaw: T [rad];
    }
}

impl<T: Real> Errors<T> {
    /// From a tick; without attitude levels only the position counts.
    #[inline(always)]
    pub fn of(tick: &Tick<T>, gravity: T, has_attitude: bool) -> Self {
        let axis = tick.position - tick.reference.position;
        let position = axis.norm();
        if !has_attitude {
            return Self { position, axis, ..Self::default() };
        }
        let reference = tick.command.attitude.rotation;
        let force = tick.reference.acceleration + Vec3::up(gravity);
        let up = tick.attitude.z_axis();
        let forward = tick.attitude.x_axis();
        let (sin, cos) = tick.reference.yaw.sin_cos();
        let ahead = forward.x * cos + forward.y * sin;
        let aside = forward.y * cos - forward.x * sin;
        Self {
            position,
            axis,
            angle: (reference.inverse() * tick.attitude).angle(),
            euler: difference(tick.attitude, reference).norm(),
            tilt: force.cross(up).norm().atan2(force.dot(up)),
            yaw: aside.atan2(ahead),
        }
    }
}

record! {
    /// Everything that is summed over a flight.
    pub struct Sums {
        /// Distance from the reference.
        position: Integrals<T> [];
        /// Position error along each world axis.
        axis: [Integrals<T>; 3] [];
        /// Rotation angle from the law's own reference.
        angle: Integrals<T> [];
        /// Euler-angle differences from the law's own reference.
        euler: Integrals<T> [];
        /// Tilt from the trajectory's flatness attitude.
        tilt: Integrals<T> [];
        /// Heading from the trajectory's.
        yaw: Integrals<T> [];
        /// Integral of the squared thrust.
        thrust_effort: T [N^2 s];
        /// Integral of the squared torque.
        torque_effort: T [N^2 m^2 s];
        /// Sum of the steps of the thrust command.
        thrust_variation: T [N];
        /// Sum of the steps of the torque command, all axes.
        torque_variation: T [N m];
        /// Integral of the saturation share.
        saturation: T [s];
        /// Integral of the squared error of the disturbance estimate.
        estimate_ise: T [N^2 s];
        /// Sum of estimate error times slope of the disturbance.
        lag_product: T [N^2];
        /// Sum of squared slopes of the disturbance.
        lag_square: T [N^2/s];
        /// Sum of the steps of the estimate error, all axes.
        estimate_variation: T [N];
        /// Ticks at which a law held its last good value.
        flags: T [count];
        /// Time flown.
        time: T [s];
        /// Largest thrust.
        thrust_max: T [N];
        /// Time at which the tilt first passed 90 deg; negative while it did not.
        inverted: T [s];
        /// Thrust command of the last tick.
        last_thrust: T [N];
        /// Torque command of the last tick.
        last_torque: Vec3<T, Body> [N m];
        /// Lumped disturbance of the last tick.
        last_lumped: Vec3<T, World> [N];
        /// Estimate error of the last tick.
        last_error: Vec3<T, World> [N];
        /// 0 at the first tick, then 1.
        begun: T [1];
    }
}

/// What does not change during a flight.
#[derive(Clone, Copy, Debug)]
pub struct Setting<T> {
    /// Control step, s.
    pub dt: T,
    /// Begin of the late window, s.
    pub late: T,
    /// Gravity of the flatness reference, m/s^2.
    pub gravity: T,
    /// Whether the attitude levels run.
    pub has_attitude: bool,
}

#[inline(always)]
fn sum<T: Real, F: stormpetrel_control::math::Frame>(v: Vec3<T, F>) -> T {
    v.x.abs() + v.y.abs() + v.z.abs()
}

impl<T: Real> Sums<T> {
    /// Nothing flown yet.
    pub fn new() -> Self {
        let none = Integrals::new();
        Self {
            inverted: -T::one(),
            position: none,
            axis: [none; 3],
            angle: none,
            euler: none,
            tilt: none,
            yaw: none,
            ..Self::default()
        }
    }

    /// Adds one tick; `alive` is 1 while the flight counts, else 0. Returns the errors of the tick.
    #[inline(always)]
    pub fn push(&mut self, tick: &Tick<T>, setting: &Setting<T>, alive: T) -> Errors<T> {
        let Setting { dt, late, gravity, has_attitude } = *setting;
        let errors = Errors::of(tick, gravity, has_attitude);
        let (time, weight) = (tick.time, dt * alive);
        let late = T::select(time.lt(late), T::zero(), T::one());
        self.position.push(errors.position, time, weight, late);
        let axes = [errors.axis.x, errors.axis.y, errors.axis.z];
        for (integrals, e) in self.axis.iter_mut().zip(axes) {
            integrals.push(e, time, weight, late);
        }
        if has_attitude {
            self.angle.push(errors.angle, time, weight, late);
            self.euler.push(errors.euler, time, weight, late);
            self.tilt.push(errors.tilt, time, weight, late);
            self.yaw.push(errors.yaw, time, weight, late);
            let over = tick.attitude.z_axis().z.lt(T::zero()) & self.inverted.lt(T::zero());
            self.inverted = T::select(over & T::zero().lt(alive), time, self.inverted);
        }
        self.push_commands(tick, weight);
        self.push_estimate(tick, dt, weight);
        self.time += weight;
        self.flags += T::select(T::zero().lt(tick.flags), alive, T::zero());
        self.begun = T::one();
        errors
    }

    #[inline(always)]
    fn push_commands(&mut self, tick: &Tick<T>, weight: T) {
        let (thrust, torque) = (tick.applied.thrust, tick.command.wrench.torque);
        let counts = T::select(T::zero().lt(weight), self.begun, T::zero());
        self.thrust_effort += thrust.sq() * weight;
        self.torque_effort += torque.norm_squared() * weight;
        self.thrust_variation += (thrust - self.last_thrust).abs() * counts;
        self.torque_variation += sum(torque - self.last_torque) * counts;
        self.saturation += tick.saturation * weight;
        self.thrust_max = self
            .thrust_max
            .max(thrust.abs() * T::select(T::zero().lt(weight), T::one(), T::zero()));
        self.last_thrust = thrust;
        self.last_torque = torque;
    }

    #[inline(always)]
    fn push_estimate(&mut self, tick: &Tick<T>, dt: T, weight: T) {
        let error = tick.estimate.force - tick.disturbance.lumped;
        let counts = T::select(T::zero().lt(weight), self.begun, T::zero());
        let slope = (tick.disturbance.lumped - self.last_lumped) * (counts / dt);
        self.estimate_ise += error.norm_squared() * weight;
        self.lag_product += error.dot(slope) * weight;
        self.lag_square += slope.norm_squared() * weight;
        self.estimate_variation += sum(error - self.last_error) * counts;
        self.last_lumped = tick.disturbance.lumped;
        self.last_error = error;
    }
}

/// All metrics of a flight under their flat names, in the order of [`names`].
pub fn metrics(sums: &Sums<f64>, distribution: &Distribution) -> Vec<(&'static str, f64)> {
    let mut names = names().iter();
    let mut all = Vec::with_capacity(names.len());
    let time = sums.time;
    let signals = [
        sums.position,
        sums.axis[0],
        sums.axis[1],
        sums.axis[2],
        sums.angle,
        sums.euler,
        sums.tilt,
        sums.yaw,
    ];
    for ((about, integrals), histogram) in SIGNALS.iter().zip(signals).zip(&distribution.0) {
        let Integrals { iae, ise, itae, max, late_max } = integrals;
        assert_possible(about.name, &integrals, time);
        let rmse = if time > 0.0 { (ise / time).sqrt() } else { 0.0 };
        let values = [iae, ise, itae, rmse, max, late_max, histogram.p95()];
        for ((of, value), name) in OF_SIGNALS.iter().zip(values).zip(names.by_ref()) {
            if !(of.name == "*.late_max" && value < 0.0) {
                all.push((name.as_str(), value));
            }
        }
    }
    let per_time = if time > 0.0 { 1.0 / time } else { 0.0 };
    let lag = if sums.lag_square > 0.0 { -sums.lag_product / sums.lag_square } else { 0.0 };
    let values = [
        time,
        sums.thrust_effort,
        sums.thrust_variation,
        sums.thrust_max,
        sums.torque_effort,
        sums.torque_variation,
        sums.saturation * per_time,
        (sums.estimate_ise * per_time).sqrt(),
        lag,
        sums.estimate_variation,
        sums.flags,
        sums.inverted,
    ];
    for (about, value) in OF_FLIGHT.iter().zip(values) {
        if !(about.name == "tilt.inverted_at" && value < 0.0) {
            all.push((about.name, value));
        }
    }
    all
}

/// `max * IAE >= ISE >= IAE^2/T`: true of every signal, so a violation is a defect of this program.
///
/// # Panics
/// Where the inequality is broken.
fn assert_possible(name: &str, integrals: &Integrals<f64>, time: f64) {
    let Integrals { iae, ise, max, .. } = *integrals;
    let slack = 1e-12;
    // Rounding of the sums grows with their number of terms; below the smallest normal squares vanish.
    let tiny = 1e-280;
    assert!(max * iae * (1.0 + slack) + tiny >= ise, "{name}: max {max} * IAE {iae} < ISE {ise}");
    assert!(
        ise * (1.0 + slack) * time + tiny >= iae * iae,
        "{name}: ISE {ise} * T {time} < IAE^2, IAE {iae}"
    );
}
