//! The whole control stack: trajectory in, wrench out.

use crate::attitude::AttitudeLaw;
use crate::attitude_reference::AttitudeReference;
use crate::guard::{Good, Guarded, GuardedObserver, finite, passing};
use crate::math::{Vec3, World};
use crate::observer::Observer;
use crate::position::Position;
use crate::rate::RateLaw;
use crate::real::Real;
use crate::record;
use crate::record::same;
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

/// After how many control steps each level acts again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rhythm {
    /// Position law and observer.
    pub position: u32,
    /// Attitude reference and attitude law.
    pub attitude: u32,
    /// Rate law.
    pub rate: u32,
}

impl Default for Rhythm {
    /// Every level at every step.
    fn default() -> Self {
        Self { position: 1, attitude: 1, rate: 1 }
    }
}

impl Rhythm {
    /// After how many control steps the pattern begins again.
    pub fn period(self) -> u64 {
        [self.position, self.attitude, self.rate]
            .into_iter()
            .fold(1, |period, every| lcm(period, u64::from(every.max(1))))
    }
}

/// Least common multiple.
fn lcm(a: u64, b: u64) -> u64 {
    let (mut x, mut y) = (a, b);
    while y != 0 {
        (x, y) = (y, x % y);
    }
    a / x.max(1) * b
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
        /// What drove the vehicle since the position law acted, summed.
        applied: Applied<T> [];
        structure {
            /// Down to which level the stack commands.
            exit: Exit;
            /// How often each level acts.
            every: Rhythm;
            /// Control steps since the start.
            step: u64;
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
    pub fn new(laws: Laws<T>, exit: Exit, every: Rhythm) -> Self {
        Self {
            position: Guarded::new(laws.position, Thrust::default()),
            observer: GuardedObserver::new(laws.observer),
            attitude_reference: Guarded::new(laws.attitude_reference, Attitude::default()),
            attitude: Guarded::new(laws.attitude, Rate::default()),
            rate: Guarded::new(laws.rate, Wrench::default()),
            applied: Applied::default(),
            exit,
            every,
            step: 0,
        }
    }

    /// Whether a level acts at this step.
    #[inline(always)]
    fn due(&self, every: u32) -> bool {
        every == 1 || self.step.is_multiple_of(u64::from(every))
    }

    /// The commands of all levels at this tick. Total: see [`Guarded`].
    #[inline(always)]
    pub fn update(
        &mut self,
        measurement: &Measurement<T>,
        trajectory: &Trajectory<T>,
        dt: T,
    ) -> Command<T> {
        self.act(measurement, trajectory, dt);
        self.command()
    }

    /// [`Stack::update`] that gives only the thrust per mass and the wrench; [`Stack::command`] tells the rest.
    #[inline(always)]
    pub fn act(
        &mut self,
        measurement: &Measurement<T>,
        trajectory: &Trajectory<T>,
        dt: T,
    ) -> (Vec3<T, World>, Wrench<T>) {
        let input = passing(measurement, dt);
        self.act_checked([input, input.and(finite(trajectory))], measurement, trajectory, dt)
    }

    /// [`Stack::act`] where the caller knows already in which lanes the measurement, and measurement and
    /// trajectory, are good.
    #[inline(always)]
    pub fn act_checked(
        &mut self,
        [input, both]: [Good<T>; 2],
        measurement: &Measurement<T>,
        trajectory: &Trajectory<T>,
        dt: T,
    ) -> (Vec3<T, World>, Wrench<T>) {
        let Rhythm { position: slow, attitude: middle, rate: fast } = self.every;
        let longer = |every: u32| if every == 1 { dt } else { dt * T::lit(f64::from(every)) };
        if self.due(slow) {
            let dt = longer(slow);
            self.observer.correct_checked(input, measurement, dt);
            self.position.update_checked(both, measurement, trajectory, dt);
        }
        let thrust = self.thrust();
        if self.exit == Exit::Thrust {
            return (thrust.force, self.wrench());
        }
        let (mut rate, mut wrench) = (same(self.attitude.held()), self.wrench());
        // What a guard or the observer grants is finite: the levels below need not ask again.
        if self.due(middle) {
            let dt = longer(middle);
            let attitude = self.attitude_reference.update_checked(input, measurement, &thrust, dt);
            let attitude = self.attitude_reference.handed(&attitude);
            rate = self.attitude.update_checked(input, measurement, attitude, dt);
        }
        if self.due(fast) {
            let (rate, dt) = (self.attitude.handed(&rate), longer(fast));
            wrench = self.rate.update_checked(input, measurement, rate, dt);
        }
        let wrench = same(self.rate.handed(&wrench));
        (thrust.force, wrench)
    }

    /// What every level asks for.
    #[inline(always)]
    pub fn command(&self) -> Command<T> {
        let thrust = self.thrust();
        if self.exit == Exit::Thrust {
            return Command { thrust, ..Command::default() };
        }
        Command {
            thrust,
            attitude: *self.attitude_reference.held(),
            rate: *self.attitude.held(),
            wrench: *self.rate.held(),
        }
    }

    /// The thrust vector that the position law asks for, disturbance estimate subtracted.
    #[inline(always)]
    pub fn thrust(&self) -> Thrust<T> {
        let mut thrust = same(self.position.held());
        thrust.force -= self.observer.estimate();
        thrust
    }

    /// Thrust and torque that the lowest level asks for; zero where it rests.
    #[inline(always)]
    pub fn wrench(&self) -> Wrench<T> {
        same(self.rate.held())
    }

    /// Tells the observer what drove the vehicle in the interval just commanded.
    #[inline(always)]
    pub fn advance(&mut self, applied: &Applied<T>, dt: T) {
        self.step += 1;
        let slow = self.every.position;
        let (mut mean, mut interval) = (*applied, dt);
        if slow > 1 {
            self.applied.commanded += applied.commanded;
            self.applied.measured += applied.measured;
            if !self.due(slow) {
                return;
            }
            let share = T::lit(1.0 / f64::from(slow));
            let Applied { commanded, measured } = self.applied;
            mean = Applied { commanded: commanded * share, measured: measured * share };
            interval = dt * T::lit(f64::from(slow));
            self.applied = Applied::default();
        }
        self.observer.advance(&mean, interval);
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
        self.applied = Applied::default();
        self.step = 0;
    }
}
