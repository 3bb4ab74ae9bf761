//! When what the laws decide reaches the rotors.
//!
//!   age = round((t_c + t_a)/dt) + floor(u (1 + t_j/dt))                  (1)
//!   age at most one more than at the tick before                         (2)
//!
//! | symbol | meaning |
//! |---|---|
//! | `t_c`, `t_a` | computation and actuator delay |
//! | `t_j` | largest jitter |
//! | u | uniform random number, one a tick |
//!
//! A command holds until the next one arrives; what was decided earlier never overtakes (2). At a
//! dropped tick no law runs, and the command before it is sent again. Delays are whole control steps: a
//! finer grain takes a shorter step with slower loops.

use stormpetrel_control::math::Vec3;
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::RecordExt as _;
use stormpetrel_control::signals::Wrench;

use crate::actuation::Sent;
use crate::random::Stream;

/// Control steps that a command may be late, jitter included.
pub const LATEST: usize = 31;

record! {
    /// How late commands are.
    pub struct Delays {
        /// Time that the laws take to compute.
        computation_delay: T [s] = 0.0, in 0.0 => 1.0;
        /// Time from the command to the rotors.
        actuator_delay: T [s] = 0.0, in 0.0 => 1.0;
        /// Largest random addition to both.
        jitter: T [s] = 0.0, in 0.0 => 1.0;
        /// Share of the ticks at which no law runs.
        dropped: T [1] = 0.0, in 0.0 => 1.0;
    }
}

record! {
    /// Commands under way.
    pub struct Timing {
        /// How late they are.
        delays: Delays<T> [];
        /// The newest commands; the one of tick k stands at k modulo 32.
        ring: [[Sent<T>; 8]; 4] [];
        /// Age of the command that acts.
        age: T [count];
        /// Random numbers.
        stream: Stream<T> [];
        structure {
            /// Whether anything is late or dropped.
            late: bool;
            /// Whether ticks are dropped.
            drops: bool;
        }
    }
}

impl Timing<f64> {
    /// With these delays; the random stream comes from `key`.
    pub fn new(delays: Delays<f64>, key: u64) -> Self {
        let Delays { computation_delay, actuator_delay, jitter, dropped } = delays;
        let (drops, stream) = (dropped > 0.0, Stream::new(key, "timing"));
        let late = computation_delay + actuator_delay + jitter + dropped > 0.0;
        Self { delays, stream, late, drops, ..Self::default() }
    }
}

impl<T: Real> Timing<T> {
    /// Fills the line with the command that carries the weight.
    pub fn reset(&mut self, mass: T, gravity: T) {
        let rest = Sent {
            force: Vec3::up(gravity),
            wrench: Wrench { thrust: mass * gravity, torque: Vec3::zero() },
        };
        self.ring = [[rest; 8]; 4];
        self.age = T::zero();
    }

    /// Where no law runs at this tick.
    #[inline(always)]
    pub fn dropped(&self, tick: T) -> T::Mask {
        self.stream.unit(tick, 0).lt(self.delays.dropped)
    }

    /// Sends this at the `slot`-th tick of the batch; gives what reaches the rotors now.
    #[inline(never)]
    pub fn pass(&mut self, sent: &Sent<T>, tick: T, slot: u64, dt: T) -> Sent<T> {
        let at = |slot: u64| ((slot / 8 % 4) as usize, (slot % 8) as usize);
        let (row, column) = at(slot);
        self.ring[row][column] = *sent;
        let Delays { computation_delay, actuator_delay, jitter, .. } = self.delays;
        let steps = ((computation_delay + actuator_delay) / dt).round();
        let room = T::one() + jitter / dt;
        let age = steps + (self.stream.unit(tick, 1) * room).floor(); // (1)
        self.age = age.min(self.age + T::one()).min(T::lit(LATEST as f64)); // (2)
        let mut acting = *sent;
        // Each lane looks back as far as its own command is old.
        for i in 0..T::LANES {
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
            // a whole number from 0 to LATEST
            let back = self.age.lane(i).to_f64() as u64;
            let (row, column) = at(slot.wrapping_sub(back));
            self.ring[row][column].pick_lane(i).put_lane(&mut acting, i);
        }
        acting
    }
}
