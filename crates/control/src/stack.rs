//! The whole control stack: trajectory in, wrench out.

use crate::attitude::AttitudeLaw;
use crate::attitude_reference::AttitudeReference;
use crate::controller::{Guarded, GuardedObserver, finite, good_input};
use crate::math::{Vec3, World};
use crate::observer::Observer;
use crate::position::Position;
use crate::rate::RateLaw;
use crate::real::Real;
use crate::record;
use crate::signals::{Applied, Attitude, Measurement, Rate, Thrust, Trajectory, Wrench};

/// Down to which level the stack commands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Exit {
    /// Thrust and torque: the whole cascade runs.
    #[default]
    Wrench,
    /// The thrust vector: the attitude levels rest.
    Thrust,
}

record! {
    /// What every level asked for at one tick.
    pub struct Command {
        /// Thrust vector, disturbance estimate subtracted.
        thrust: Thrust<T> [];
        /// Attitude reference.
        attitude: Attitude<T> [];
        /// Angular motion.
        rate: Rate<T> [];
        /// Thrust and torque.
        wrench: Wrench<T> [];
    }
}

record! {
    /// Position law and observer, attitude reference, attitude law, rate law.
    pub struct Stack {
        /// Position law.
        position: Guarded<T, Position<T>, Thrust<T>> [];
        /// Disturbance observer.
        observer: GuardedObserver<T, Observer<T>> [];
        /// Attitude reference.
        attitude_reference: Guarded<T, AttitudeReference<T>, Attitude<T>> [];
        /// Attitude law.
        attitude: Guarded<T, AttitudeLaw<T>, Rate<T>> [];
        /// Rate law.
        rate: Guarded<T, RateLaw<T>, Wrench<T>> [];
        structure {
            /// Down to which level the stack commands.
            exit: Exit;
        }
    }
}

/// The laws of a stack, one for each block of the control diagram.
#[derive(Clone, Copy, Debug)]
pub struct Laws<T> {
    /// Position law.
    pub position: Position<T>,
    /// Disturbance observer.
    pub observer: Observer<T>,
    /// Attitude reference.
    pub attitude_reference: AttitudeReference<T>,
    /// Attitude law.
    pub attitude: AttitudeLaw<T>,
    /// Rate law.
    pub rate: RateLaw<T>,
}

impl<T: Real> Stack<T> {
    /// The stack of these laws, at rest.
    pub fn new(laws: Laws<T>, exit: Exit) -> Self {
        Self {
            position: Guarded::new(laws.position, Thrust::default()),
            observer: GuardedObserver::new(laws.observer),
            attitude_reference: Guarded::new(laws.attitude_reference, Attitude::default()),
            attitude: Guarded::new(laws.attitude, Rate::default()),
            rate: Guarded::new(laws.rate, Wrench::default()),
            exit,
        }
    }

    /// The commands of all levels at this tick. Total: see [`Guarded`].
    #[inline(always)]
    pub fn update(
        &mut self,
        measurement: &Measurement<T>,
        trajectory: &Trajectory<T>,
        dt: T,
    ) -> Command<T> {
        let input = good_input(measurement, dt);
        self.observer.correct_checked(input, measurement, dt);
        let position = input.and(finite(trajectory));
        let mut thrust = self.position.update_checked(position, measurement, trajectory, dt);
        thrust.force -= self.observer.estimate();
        if self.exit == Exit::Thrust {
            return Command { thrust, ..Command::default() };
        }
        // What a guard or the observer grants is finite: the levels below need not ask again.
        let attitude = self.attitude_reference.update_checked(input, measurement, &thrust, dt);
        let rate = self.attitude.update_checked(input, measurement, &attitude, dt);
        let wrench = self.rate.update_checked(input, measurement, &rate, dt);
        Command { thrust, attitude, rate, wrench }
    }

    /// Tells the observer what drove the vehicle in the interval just commanded.
    #[inline(always)]
    pub fn advance(&mut self, applied: &Applied<T>, dt: T) {
        self.observer.advance(applied, dt);
    }

    /// The disturbance estimate that the next command subtracts, m/s^2.
    #[inline(always)]
    pub fn estimate(&self) -> Vec3<T, World> {
        self.observer.estimate()
    }

    /// How many levels held their last good value at the last tick.
    #[inline(always)]
    pub fn flags(&self) -> T {
        self.position.flag
            + self.observer.flag
            + self.attitude_reference.flag
            + self.attitude.flag
            + self.rate.flag
    }

    /// Forgets the past, as if the flight began with this measurement.
    pub fn reset(&mut self, measurement: &Measurement<T>) {
        self.position.reset(measurement);
        self.observer.reset(measurement);
        self.attitude_reference.reset(measurement);
        self.attitude.reset(measurement);
        self.rate.reset(measurement);
    }
}
