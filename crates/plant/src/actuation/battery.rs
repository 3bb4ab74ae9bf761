//! A battery that sags: what is drawn lowers the voltage, and the voltage limits the rotors.
//!
//!   V = (V_oc + sqrt(V_oc^2 - 4 R P))/2,   I = P/V                       (1)
//!   charge' = -I/Q                                                       (2)
//!   `V_oc` = `V_empty` + (`V_full` - `V_empty`) charge, or the table         (3)
//!   Omega <= K V                                                         (4)
//!   `P_max` = `V_oc`^2/(4 R), zero once the charge is                        (5)
//!   Omega+ <= Omega (`P_max`/P)^(1/3) where P > `P_max`                      (6)
//!
//! | symbol | meaning |
//! |---|---|
//! | P | electrical power, the rotors' drag torque times speed over the efficiency |
//! | R, Q | internal resistance, capacity |
//! | K | rotor speed for each volt at the rotor |
//!
//! P is held over a control tick. More power than `P_max` is not drawn: the rotors, whose power goes with the
//! cube of their speed, slow down until they live on it (6). Source: the equivalent circuit of a resistance behind a voltage, as in Plett, Battery Management Systems I,
//! 2015, chapter 2.

use stormpetrel_control::options::Rows;
use stormpetrel_control::real::Real;
use stormpetrel_control::record;

use super::curve::{OpenCircuit, look_up_lanes};

record! {
    /// A battery.
    pub struct Battery {
        /// Capacity, Q.
        capacity: T [A s];
        /// Voltage when full and when empty, without load.
        full: T [V];
        /// Voltage when empty, without load.
        empty: T [V];
        /// Internal resistance, R.
        resistance: T [ohm];
        /// Mechanical over electrical power.
        efficiency: T [1];
        /// Rotor speed for each volt, K.
        speed_per_volt: T [rad/(s V)];
        /// Share of charge that is left.
        charge: T [1];
        /// Voltage at the rotors.
        voltage: T [V];
        /// Current.
        current: T [A];
        /// Share of their speed that the power lets the rotors keep (6).
        share: T [1];
        structure {
            /// Voltage without load by charge; empty for the straight line (3).
            open_circuit: Rows<OpenCircuit>;
        }
    }
}

record! {
    /// What a gauge at the battery shows.
    pub struct Gauge {
        /// Share of charge that is left.
        charge: T [1];
        /// Voltage at the rotors.
        voltage: T [V];
        /// Current.
        current: T [A];
    }
}

impl<T: Real> Battery<T> {
    /// What a gauge shows.
    pub fn gauge(&self) -> Gauge<T> {
        Gauge { charge: self.charge, voltage: self.voltage, current: self.current }
    }

    /// Gives this mechanical power (W) for `dt` seconds.
    #[inline(always)]
    pub fn draw(&mut self, power: T, dt: T) {
        let idle = if self.open_circuit.is_empty() {
            self.empty + (self.full - self.empty) * self.charge
        } else {
            let [voltage] = look_up_lanes(&self.open_circuit, self.charge);
            voltage
        }; // (3)
        let asked = power / self.efficiency;
        let most = idle.sq() / (T::lit(4.0) * self.resistance).max(T::lit(1e-30));
        let most = T::select(T::zero().lt(self.charge), most, T::zero()); // (5)
        let drawn = asked.min(most);
        let short = most.lt(asked);
        self.share = T::select(short, (most / asked).cbrt(), T::one()); // (6)
        let root = (idle.sq() - T::lit(4.0) * self.resistance * drawn).max(T::zero()).sqrt();
        self.voltage = (idle + root).half(); // (1)
        self.current = drawn / self.voltage.max(T::lit(1e-9));
        self.charge = (self.charge - self.current * dt / self.capacity).max(T::zero()); // (2)
    }

    /// Highest rotor speed (4), rad/s.
    #[inline(always)]
    pub fn limit(&self) -> T {
        self.speed_per_volt * self.voltage
    }
}
