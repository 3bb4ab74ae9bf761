//! When a sensor samples, and how its samples travel.
//!
//!   N = max(1, round(1/(rate dt))),   sampled where floor(tick/N) N = tick                   (1)
//!   lost where U < dropout,   ready at tick + round((latency + jitter U)/dt)                 (2)
//!
//! Samples arrive in the order in which they were taken, one a tick. U are uniform random numbers of
//! the sensor's own stream at the tick of sampling, so neither rate, loss nor delay of one sensor
//! touches the numbers of another.

use stormpetrel_control::real::{Mask, Real};
use stormpetrel_control::record;

use super::Moment;
use crate::random::Stream;

/// How many samples may be under way.
pub const SLOTS: usize = 8;

// The draws of a sensor's stream at a tick: two uniform numbers for the way, then pairs of normal ones;
// at tick zero other pairs for what is drawn once a flight.
const LOST: u64 = 0;
const LATE: u64 = 1;
const NOISE: u64 = 1;
const ONCE: u64 = 16;

record! {
    /// When a sensor samples, how long a sample is under way, how many get lost.
    pub struct Timing {
        /// Samples a second.
        rate_hz: T [Hz];
        /// Time from sampling to arrival.
        latency: T [s];
        /// Largest additional time, evenly distributed.
        jitter: T [s];
        /// Share of samples that never arrive.
        dropout: T [1];
    }
}

record! {
    /// The way of a sensor's samples.
    pub struct Link {
        /// When and how long.
        timing: Timing<T> [];
        /// The sensor's random numbers.
        stream: Stream<T> [];
        /// Time between two ticks for which the period holds; zero before the first.
        step: T [s];
        /// Ticks between two samples, N.
        period: T [count];
        /// Tick of the next sample.
        next: T [count];
        /// Samples under way, oldest first.
        waiting: T [count];
        /// Ticks at which they arrive.
        ready: [T; SLOTS] [count];
        /// Ticks at which they were taken.
        taken: [T; SLOTS] [count];
        /// Their numbers.
        queue: [[T; 7]; SLOTS] [];
    }
}

/// What arrives at one tick.
#[derive(Clone, Copy, Debug)]
pub struct Sample<T: Real> {
    /// Where there is a sample.
    pub fresh: T::Mask,
    /// Time since it was taken, s.
    pub age: T,
    /// Its numbers in the order of the sensor's documentation; zeros after those.
    pub values: [T; 7],
}

impl<T: Real> Sample<T> {
    /// No sample.
    #[inline(always)]
    pub fn none() -> Self {
        Self { fresh: T::Mask::splat(false), age: T::zero(), values: [T::zero(); 7] }
    }
}

/// Ticks between two samples (1).
#[inline(always)]
pub fn period<T: Real>(rate_hz: T, dt: T) -> T {
    (T::one() / (rate_hz * dt)).round().max(T::one())
}

impl<T: Real> Link<T> {
    /// The way with this timing; a stream is given to it later.
    pub fn new(timing: Timing<T>) -> Self {
        Self { timing, ..Self::default() }
    }

    /// The flight begins: nothing is under way.
    pub fn begin(&mut self) {
        *self = Self { stream: self.stream, ..Self::new(self.timing) };
    }

    /// Time from sampling to arrival on average, s.
    #[inline(always)]
    pub fn mean_delay(&self) -> T {
        self.timing.latency + self.timing.jitter.half()
    }

    /// Where a sample is taken at this tick (1).
    #[inline(always)]
    pub fn due(&mut self, moment: &Moment<T>) -> T::Mask {
        if !self.step.eq(moment.dt).all() {
            self.step = moment.dt;
            self.period = period(self.timing.rate_hz, moment.dt);
        }
        let due = self.next.le(moment.tick);
        if !(!due).all() {
            let next = ((moment.tick / self.period).floor() + T::one()) * self.period;
            self.next = T::select(due, next, self.next);
        }
        due & moment.good
    }

    /// Pairs of standard normal numbers for the sample of this tick.
    #[inline(always)]
    pub fn normals(&self, tick: T, pairs: u64) -> [T; 6] {
        self.draw(tick, NOISE, pairs)
    }

    /// Standard normal numbers for what is drawn once a flight.
    pub fn once(&self) -> [T; 6] {
        self.draw(T::zero(), ONCE, 3)
    }

    #[inline(always)]
    fn draw(&self, tick: T, first: u64, pairs: u64) -> [T; 6] {
        let mut all = [[T::zero(); 2]; 3];
        // A loop and not three copies: the body is long.
        for (pair, two) in (first..first + pairs).zip(&mut all) {
            *two = self.stream.normals(tick, pair);
        }
        let [[a, b], [c, d], [e, f]] = all;
        [a, b, c, d, e, f]
    }

    /// Time between two samples, s.
    #[inline(always)]
    pub fn interval(&self) -> T {
        self.period * self.step
    }

    /// Sends the sample where one is `due`; what arrives at this tick comes back (2).
    #[inline(always)]
    pub fn pass(&mut self, due: T::Mask, values: [T; 7], moment: &Moment<T>) -> Sample<T> {
        // The usual tick; what follows changes nothing then.
        if (!due & self.waiting.eq(T::zero())).all() {
            return Sample::none();
        }
        let Moment { tick, dt, .. } = *moment;
        let kept = due & !self.lost(tick);
        let ready = tick + (self.delay(tick) / dt).round();
        let direct = kept & ready.le(tick) & self.waiting.eq(T::zero());
        self.push(kept & !direct, values, [tick, ready]);
        let pop = !direct & T::zero().lt(self.waiting) & self.ready[0].le(tick);
        let mut sample = Sample {
            fresh: direct | pop,
            age: T::select(pop, tick - self.taken[0], T::zero()) * dt,
            ..Sample::none()
        };
        for k in 0..7 {
            sample.values[k] = T::select(pop, self.queue[0][k], values[k]);
        }
        self.pop(pop);
        sample
    }

    #[inline(always)]
    fn lost(&self, tick: T) -> T::Mask {
        let dropout = self.timing.dropout;
        // No random number is below zero.
        if dropout.eq(T::zero()).all() {
            return T::Mask::splat(false);
        }
        self.stream.unit(tick, LOST).lt(dropout)
    }

    #[inline(always)]
    fn delay(&self, tick: T) -> T {
        let Timing { latency, jitter, .. } = self.timing;
        if jitter.eq(T::zero()).all() {
            return latency;
        }
        latency + jitter * self.stream.unit(tick, LATE)
    }

    /// A sample sets out; it is lost where the queue is full.
    #[inline(always)]
    fn push(&mut self, push: T::Mask, values: [T; 7], [taken, ready]: [T; 2]) {
        if (!push).all() {
            return;
        }
        for slot in 0..SLOTS {
            let here = push & self.waiting.eq(T::lit(slot as f64));
            for k in 0..7 {
                self.queue[slot][k] = T::select(here, values[k], self.queue[slot][k]);
            }
            self.taken[slot] = T::select(here, taken, self.taken[slot]);
            self.ready[slot] = T::select(here, ready, self.ready[slot]);
        }
        let room = push & self.waiting.lt(T::lit(SLOTS as f64));
        self.waiting += T::select(room, T::one(), T::zero());
    }

    /// The oldest sample has arrived; the others move up.
    #[inline(always)]
    fn pop(&mut self, pop: T::Mask) {
        if (!pop).all() {
            return;
        }
        for slot in 1..SLOTS {
            for k in 0..7 {
                self.queue[slot - 1][k] =
                    T::select(pop, self.queue[slot][k], self.queue[slot - 1][k]);
            }
            self.taken[slot - 1] = T::select(pop, self.taken[slot], self.taken[slot - 1]);
            self.ready[slot - 1] = T::select(pop, self.ready[slot], self.ready[slot - 1]);
        }
        self.waiting -= T::select(pop, T::one(), T::zero());
    }
}
