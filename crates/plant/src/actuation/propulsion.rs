//! Propulsion: rotors with two lags, real curves, air, inertia, battery and faults.
//!
//!   Omega_c = sqrt(u_i/k), zero below the dead zone, at most K V         (1)
//!   Omega' = (Omega_c - Omega)/tau,  tau up or down                      (2)
//!   T_i = e_i g(h_i) (k Omega^2 - b Omega v_z)                           (3)
//!   Q_i = e_i c Omega^2 + J Omega'                                       (4)
//!   tau = sum r_i x T_i e_z - s_i Q_i e_z - s_i J Omega_i (omega x e_z) - f Omega_i e_z x v_i   (5)
//!   g(h) = 1/(1 - (R/(4 h))^2)                                           (6)
//!
//! | symbol | meaning |
//! |---|---|
//! | `r_i`, `s_i` | place, spin |
//! | `e_i` | efficiency, 0 for a lost rotor |
//! | `v_i` | velocity of the rotor through the air, body axes |
//! | b, f | inflow loss, flapping |
//! | J, R | moment of inertia and radius of a rotor |
//! | `h_i` | height of the rotor above the ground, at least R/2 |
//!
//! A table of thrust and torque by speed takes the place of k Omega^2 and c Omega^2. Between two commands
//! each rotor only rises or only falls, so (2) has a closed form. The laws know k, c and the layout and
//! nothing else: (3) to (6), the battery and the faults are the difference that they have to live with.
//!
//! Source: Mahony, Kumar and Corke, IEEE RAM 2012 (3) to (5); Cheeseman and Bennett, ARC R&M 3021, 1955
//! (6).

use stormpetrel_control::allocation::Allocation;
use stormpetrel_control::math::{Body, Vec3, World};
use stormpetrel_control::options::Rows;
use stormpetrel_control::real::{Mask as _, Real};
use stormpetrel_control::record::{RecordExt as _, each, from_index};
use stormpetrel_control::signals::Wrench;
use stormpetrel_control::stack::Exit;
use stormpetrel_control::{choice, options, record};

use super::battery::{Battery, Gauge};
use super::curve::{OpenCircuit, RotorCurve, look_up_lanes};
use super::{Actuate, Load, Sent};
use crate::aerodynamics::through_air;
use crate::dispatch::rarely;
use crate::disturbance::RotorFaults;
use crate::state::State;
use crate::vehicle::{Mount, Vehicle};
use crate::world::Conditions;

record! {
    /// Numbers of the propulsion beside the vehicle's.
    pub struct Gains {
        /// True thrust and drag torque over what the laws and the allocation expect at the same speed.
        efficiency: T [1] = 1.0, in 1e-3 => 10.0;
        /// Height of the ground under the ground effect.
        ground: T [m] = -1e6, in -1e6 => 1e6;
        /// Voltage of the full battery without load.
        battery_full: T [V] = 16.8, in 0.1 => 1e3;
        /// Voltage of the empty battery without load.
        battery_empty: T [V] = 13.2, in 0.1 => 1e3;
        /// Internal resistance of the battery.
        battery_resistance: T [ohm] = 0.03, in 0.0 => 10.0;
        /// Capacity of the battery.
        battery_capacity: T [A s] = 5400.0, in 1.0 => 1e7;
        /// Share of charge at the start.
        battery_charge: T [1] = 1.0, in 0.0 => 1.0;
        /// Mechanical over electrical power.
        motor_efficiency: T [1] = 0.75, in 0.01 => 1.0;
        /// Highest rotor speed for each volt at the rotor; 0 takes the vehicle's highest speed when full.
        speed_per_volt: T [rad/(s V)] = 0.0, in 0.0 => 1e4;
    }
}

choice! {
    /// What feeds the rotors.
    pub enum Supply {
        /// A source that never sags.
        "ideal" => Ideal,
        /// The battery.
        "battery" => Battery,
    }
}

options! {
    /// Choices of the propulsion.
    pub struct Options {
        /// What feeds the rotors.
        supply: Supply;
        /// Thrust and torque of a rotor by speed, in the place of k and c.
        curve: Rows<RotorCurve>;
        /// Voltage of the battery without load by charge.
        open_circuit: Rows<OpenCircuit>;
    }
}

record! {
    /// Four rotors.
    pub struct Propulsion {
        /// The layout as the laws know it, inverted.
        allocation: Allocation<T> [];
        /// Places and spins.
        mounts: [Mount<T>; 4] [];
        /// True over expected thrust and torque.
        efficiency: T [1];
        /// The same now, of each rotor.
        health: [T; 4] [1];
        /// Height of the ground.
        ground: T [m];
        /// Expected thrust coefficient k.
        thrust_coefficient: T [N s^2/rad^2];
        /// Expected drag coefficient c.
        drag_coefficient: T [N m s^2/rad^2];
        /// Below this the rotor stands still.
        dead_zone: T [rad/s];
        /// One over the time constants, rising and falling.
        per_lags: [T; 2] [1/s];
        /// One over the mass of the vehicle without a payload.
        per_mass: T [1/kg];
        /// Integration step for which the decays hold; zero before the first.
        step: T [s];
        /// exp(-h/(2 tau)), rising and falling.
        half_decays: [T; 2] [1];
        /// Speed asked of each rotor.
        commanded: [T; 4] [rad/s];
        /// 1 where the rotor rises to it.
        rising: [T; 4] [1];
        /// Share of the rotors asked to run at a limit.
        saturation: T [1];
        /// What feeds them.
        battery: Battery<T> [];
        /// Speed that the battery's power lets each rotor keep.
        ceiling: [T; 4] [rad/s];
        structure {
            /// Whether the battery does.
            sags: bool;
            /// Thrust and torque by speed; empty for k and c.
            curve: Rows<RotorCurve>;
        }
    }
}

/// More than any rotor reaches, rad/s.
const NO_LIMIT: f64 = 1e9;

impl Propulsion<f64> {
    /// At rest.
    pub fn new(gains: Gains<f64>, options: Options, vehicle: &Vehicle<f64>) -> Self {
        let fall = vehicle.motor_lag_fall;
        let fall = if fall > 0.0 { fall } else { vehicle.motor_lag };
        let per_volt = gains.speed_per_volt;
        let full = gains.battery_full;
        Self {
            allocation: vehicle.allocation(),
            mounts: vehicle.mounts(),
            efficiency: gains.efficiency,
            health: [gains.efficiency; 4],
            ground: gains.ground,
            thrust_coefficient: vehicle.thrust_coefficient,
            drag_coefficient: vehicle.drag_coefficient,
            dead_zone: vehicle.rotor_dead_zone,
            per_lags: [1.0 / vehicle.motor_lag, 1.0 / fall],
            per_mass: 1.0 / vehicle.mass,
            commanded: [vehicle.hover_speed(); 4],
            ceiling: [NO_LIMIT; 4],
            battery: Battery {
                capacity: gains.battery_capacity,
                full,
                empty: gains.battery_empty,
                resistance: gains.battery_resistance,
                efficiency: gains.motor_efficiency,
                speed_per_volt: if per_volt > 0.0 { per_volt } else { vehicle.rotor_speed_max / full },
                charge: gains.battery_charge,
                voltage: full,
                open_circuit: options.open_circuit,
                ..Battery::default()
            },
            sags: options.supply == Supply::Battery,
            curve: options.curve,
            ..Self::default()
        }
    }
}

impl<T: Real> Propulsion<T> {
    /// Thrust (N) and drag torque (N m) of a rotor at this speed in still air, before its health.
    #[inline(always)]
    fn rotor(&self, speed: T) -> [T; 2] {
        if self.curve.is_empty() {
            let square = speed.sq();
            return [self.thrust_coefficient * square, self.drag_coefficient * square];
        }
        look_up_lanes(&self.curve, speed)
    }

    /// The rotor of this index at this speed.
    #[inline(always)]
    fn turning(&self, index: usize, speed: T) -> Turning<T> {
        let [thrust, drag] = self.rotor(speed);
        let [rise, fall] = self.per_lags;
        let rate = T::select(T::zero().lt(self.rising[index]), rise, fall);
        Turning {
            mount: self.mounts[index],
            speed,
            spin_up: (self.commanded[index] - speed) * rate, // (2)
            thrust,
            drag,
            health: self.health[index],
            ground: self.ground,
        }
    }

    /// Thrusts that the laws expect at these speeds.
    #[inline(always)]
    fn expected(&self, state: &State<T>) -> [T; 4] {
        each(state.rotor_speed, |speed| self.thrust_coefficient * speed.sq())
    }

    /// Mechanical power of the rotors, W.
    #[inline(always)]
    fn power(&self, state: &State<T>) -> T {
        let mut power = T::zero();
        for i in 0..4 {
            let [_, torque] = self.rotor(state.rotor_speed[i]);
            power += self.health[i] * torque * state.rotor_speed[i];
        }
        power
    }
}

impl<T: Real> Actuate<T> for Propulsion<T> {
    fn exit(&self) -> Exit {
        Exit::Wrench
    }
    #[inline(always)]
    fn command(&mut self, sent: &Sent<T>, _: &Vehicle<T>) -> Wrench<T> {
        let allocated = self.allocation.allocate(&sent.wrench);
        let limit = if self.sags { self.battery.limit() } else { T::lit(NO_LIMIT) };
        let (mut short, mut limited) = ([T::zero(); 4], T::zero());
        for i in 0..4 {
            let asked = allocated.thrusts[i];
            let speed = (asked / self.thrust_coefficient).sqrt();
            let limit = limit.min(self.ceiling[i]);
            let over = limit.lt(speed);
            let speed = T::select(over, limit, speed);
            let still = speed.lt(self.dead_zone);
            self.commanded[i] = T::select(still, T::zero(), speed); // (1)
            let cut = over | still;
            short[i] = T::select(cut, asked - self.thrust_coefficient * self.commanded[i].sq(), T::zero());
            limited += T::select(cut, T::lit(0.25), T::zero());
        }
        self.saturation = (allocated.saturation + limited).min(T::one());
        let [thrust, roll, pitch, yaw] =
            each(self.allocation.effect, |row| dot(row, short));
        let refused = allocated.refused;
        Wrench {
            thrust: refused.thrust + thrust,
            torque: refused.torque + Vec3::new(roll, pitch, yaw),
        }
    }
    #[inline(always)]
    fn suffer(&mut self, faults: &RotorFaults<T>, state: &State<T>, dt: T) {
        for i in 0..4 {
            let present = T::zero().lt(faults.health[i]);
            self.health[i] = self.efficiency * faults.health[i];
            let stuck = T::select(T::zero().lt(faults.stuck[i]), state.rotor_speed[i], self.commanded[i]);
            self.commanded[i] = T::select(present, stuck, T::zero());
            let rises = state.rotor_speed[i].lt(self.commanded[i]);
            self.rising[i] = T::select(rises, T::one(), T::zero());
        }
        if self.sags {
            self.battery.draw(self.power(state), dt);
            let (share, none) = (self.battery.share, T::lit(NO_LIMIT));
            let short = share.lt(T::one());
            self.ceiling = each(state.rotor_speed, |speed| T::select(short, speed * share, none));
        }
    }
    #[inline(always)]
    fn pass(&mut self, h: T) {
        if !self.step.eq(h).all() {
            let decays = || each(self.per_lags, |rate| (-h.half() * rate).exp());
            (self.step, self.half_decays) = (h, rarely(decays));
        }
    }
    #[inline(always)]
    fn load(
        &self,
        state: &State<T>,
        vehicle: &Vehicle<T>,
        around: &Conditions<T>,
    ) -> Option<Load<T>> {
        let mut through: Vec3<T, Body> = Vec3::zero();
        for i in 0..T::PARTS {
            through_air(&state.pick(i), around.wind.pick(i)).put(&mut through, i);
        }
        let mut sum: Wrench<T> = Wrench::default();
        for index in 0..4 {
            let rotor = self.turning(index, state.rotor_speed[index]);
            for i in 0..T::PARTS {
                let (state, vehicle) = (state.pick(i), vehicle.pick(i));
                let flow = through.pick(i) - state.rate.cross(around.shift.pick(i));
                let one = rotor.pick(i).wrench(&state, &vehicle, flow);
                let so_far = sum.pick(i);
                let (thrust, torque) = (so_far.thrust + one.thrust, so_far.torque + one.torque);
                Wrench { thrust, torque }.put(&mut sum, i);
            }
        }
        let mut load: Load<T> = Load::default();
        for i in 0..T::PARTS {
            let Wrench { thrust, torque } = sum.pick(i);
            let up = state.attitude.pick(i).z_axis();
            Load { thrust_per_mass: up * (thrust * self.per_mass.part(i)), torque }.put(&mut load, i);
        }
        Some(load)
    }
    #[inline(always)]
    fn thrust_per_mass(&self, state: &State<T>, _: &Vehicle<T>) -> Vec3<T, World> {
        state.attitude.up(self.thrust(state) * self.per_mass)
    }
    #[inline(always)]
    fn torque(&self, state: &State<T>) -> Vec3<T, Body> {
        let [_, roll, pitch, yaw] = self.allocation.effect;
        let thrusts = self.expected(state);
        Vec3::new(dot(roll, thrusts), dot(pitch, thrusts), dot(yaw, thrusts))
    }
    #[inline(always)]
    fn thrust(&self, state: &State<T>) -> T {
        dot([T::one(); 4], self.expected(state))
    }
    #[inline(always)]
    fn rotor_speeds(&self, state: &State<T>) -> [[T; 4]; 2] {
        let [rise, fall] = self.half_decays;
        let decay: [T; 4] =
            each(self.rising, |rising| T::select(T::zero().lt(rising), rise, fall));
        let away: [T; 4] =
            from_index(|i| (state.rotor_speed[i] - self.commanded[i]) * decay[i]);
        [
            from_index(|i| self.commanded[i] + away[i]),
            from_index(|i| self.commanded[i] + away[i] * decay[i]),
        ] // (2)
    }
    #[inline(always)]
    fn saturation(&self) -> T {
        self.saturation
    }
    fn battery(&self) -> Option<Gauge<T>> {
        self.sags.then(|| self.battery.gauge())
    }
}

/// a . b
#[inline(always)]
fn dot<T: Real>(a: [T; 4], b: [T; 4]) -> T {
    a[0] * b[0] + a[1] * b[1] + (a[2] * b[2] + a[3] * b[3])
}

record! {
    /// One rotor at one moment.
    struct Turning {
        /// Place and spin.
        mount: Mount<T> [];
        /// Speed.
        speed: T [rad/s];
        /// Rate of change of the speed (2).
        spin_up: T [rad/s^2];
        /// Thrust in still air, before its health.
        thrust: T [N];
        /// Drag torque, before its health.
        drag: T [N m];
        /// True over expected thrust and torque.
        health: T [1];
        /// Height of the ground.
        ground: T [m];
    }
}

impl<T: Real> Turning<T> {
    /// Thrust and torque about the centre of mass, (3) to (5); `flow` is the velocity of the rotors' centre
    /// through the air, m/s.
    #[inline(always)]
    fn wrench(&self, state: &State<T>, vehicle: &Vehicle<T>, flow: Vec3<T, Body>) -> Wrench<T> {
        let (Mount { place, spin }, speed, omega) = (self.mount, self.speed, state.rate);
        let flow = flow + omega.cross(place);
        let height = state.position.z + (state.attitude * place).z - self.ground;
        let gain = self.health * cushion(height, vehicle.rotor_radius);
        let thrust = gain * (self.thrust - vehicle.inflow_loss * speed * flow.z); // (3)
        let yaw = self.health * self.drag + vehicle.rotor_inertia * self.spin_up; // (4)
        let torque = place.cross_up() * thrust
            - Vec3::up(spin * yaw)
            - omega.cross_up() * (spin * vehicle.rotor_inertia * speed)
            + flow.cross_up() * (vehicle.flapping * self.health * speed); // (5)
        Wrench { thrust, torque }
    }
}

/// More thrust near the ground (6).
#[inline(always)]
fn cushion<T: Real>(height: T, radius: T) -> T {
    let square = (T::lit(4.0) * height.max(radius.half()).max(T::lit(1e-9))).sq();
    square / (square - radius.sq())
}
