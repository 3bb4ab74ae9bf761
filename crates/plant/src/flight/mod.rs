//! The closed loop: sense, decide, move. The only one in the project.

mod surroundings;

use stormpetrel_control::guard::{Good, passing};
use stormpetrel_control::math::{Body, Rotation, Vec3, World};
use stormpetrel_control::real::{Mask, Real};
use stormpetrel_control::record;
use stormpetrel_control::record::{Record as _, RecordExt as _, blend, near, same};
use stormpetrel_control::signals::{Applied, Measurement, Model, Thrust, Trajectory, Wrench};
use stormpetrel_control::stack::{Command, Stack};

use crate::actuation::{Actuate, Actuation, Sent};
use crate::disturbance::{MOST, RotorFaults, Source};
use crate::dynamics::{Held, Push, Reciprocals, acceleration};
use crate::reference::{Refer, Reference};
use crate::sensor::Sensing;
use crate::sling::Hanging;
use crate::state::State;
use crate::timing::Timing;
use crate::vehicle::Vehicle;
use crate::world::{self, Conditions, Whole};

pub use surroundings::{Air, Cares, Surroundings};

record! {
    /// When a flight counts as failed.
    pub struct Limits {
        /// Largest distance from the reference.
        position_error: T [m] = 5.0, in 0.0 => 1e9;
        /// Largest angle between the body's up axis and the vertical; 180 allows any attitude.
        tilt_deg: T [deg] = 180.0, in 0.0 => 180.0;
        /// Height of the ground.
        ground: T [m] = -1e9, in -1e9 => 1e9;
    }
}

/// Why a flight failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// Too far from the reference.
    PositionError,
    /// Tilted too far.
    Tilt,
    /// Touched the ground.
    Ground,
    /// The state was no longer a finite number.
    NonFinite,
}

impl Cause {
    /// The cause with this number in [`Flight::cause`]; `None` while all is well.
    pub fn from_code(code: f64) -> Option<Self> {
        [(1.0, Self::PositionError), (2.0, Self::Tilt), (3.0, Self::Ground), (4.0, Self::NonFinite)]
            .into_iter()
            .find_map(|(number, cause)| code.eq(number).then_some(cause))
    }

    /// As a sentence in a report.
    pub fn describe(self) -> &'static str {
        match self {
            Self::PositionError => "position error beyond its limit",
            Self::Tilt => "tilt beyond its limit",
            Self::Ground => "ground contact",
            Self::NonFinite => "state no longer finite",
        }
    }
}

record! {
    /// The true disturbance at one tick.
    pub struct Disturbed {
        /// Force from outside.
        force: Vec3<T, World> [N];
        /// Torque from outside.
        torque: Vec3<T, Body> [N m];
        /// Everything that the law's model does not explain: m (a + g `e_z`) - T R `e_z`, all true.
        lumped: Vec3<T, World> [N];
    }
}

record! {
    /// What observer and sensors make the laws believe at one tick.
    pub struct Estimated {
        /// Its estimate of the lumped disturbance, `m d_hat`.
        force: Vec3<T, World> [N];
        /// Position that the laws are told.
        position: Vec3<T, World> [m];
        /// Velocity that the laws are told.
        velocity: Vec3<T, World> [m/s];
        /// Attitude that the laws are told.
        attitude: Rotation<T, Body, World> [1];
        /// Angular velocity that the laws are told.
        rate: Vec3<T, Body> [rad/s];
    }
}

record! {
    /// Everything about one tick, as the log has it.
    pub struct Tick {
        /// Time since the start.
        time: T [s];
        /// Centre of mass.
        position: Vec3<T, World> [m];
        /// Velocity.
        velocity: Vec3<T, World> [m/s];
        /// Body to world.
        attitude: Rotation<T, Body, World> [1];
        /// Angular velocity.
        rate: Vec3<T, Body> [rad/s];
        /// Speed of each rotor.
        rotor_speed: [T; 4] [rad/s];
        /// Where the vehicle should be.
        reference: Trajectory<T> [];
        /// What every level asked for.
        command: Command<T> [];
        /// Thrust and torque that act.
        applied: Wrench<T> [];
        /// True disturbance.
        disturbance: Disturbed<T> [];
        /// The air.
        air: Air<T> [];
        /// What hangs on a cable, from the centre of mass.
        cargo: Vec3<T, World> [m];
        /// Estimated disturbance.
        estimate: Estimated<T> [];
        /// Share of the rotors asked to run at a limit.
        saturation: T [1];
        /// Number of levels that held their last good value.
        flags: T [count];
    }
}

record! {
    /// A flight: vehicle, laws, world, and how far it has come.
    pub struct Flight {
        /// The vehicle.
        vehicle: Vehicle<T> [];
        /// What the laws believe of it.
        model: Model<T> [];
        /// The laws.
        stack: Stack<T> [];
        /// Between laws and body.
        actuation: Actuation<T> [];
        /// Where to fly.
        reference: Reference<T> [];
        /// What pushes.
        disturbance: [Source<T>; MOST] [];
        /// When commands reach the rotors.
        timing: Timing<T> [];
        /// Sensors and filter.
        sensing: Sensing<T> [];
        /// When the flight counts as failed.
        limits: Limits<T> [];
        /// Time between two commands.
        control_step: T [s];
        /// State of the vehicle.
        state: State<T> [];
        /// One over mass and inertia of the vehicle.
        per: Reciprocals<T> [];
        /// The vehicle with its payload.
        laden: Vehicle<T> [];
        /// What hangs on a cable.
        hanging: Hanging<T> [];
        /// What stays constant over the tick, where more than pushes disturbs.
        conditions: Conditions<T> [];
        /// Broken rotors.
        faults: RotorFaults<T> [];
        /// Thrust that the laws expect over the true one.
        belief: T [1];
        /// True mass over the mass that the laws believe.
        mass_ratio: T [1];
        /// The rotors' thrust per mass at the start of the tick.
        thrust_per_mass: Vec3<T, World> [m/s^2];
        /// The rotors' torque in this state, in still air, before the next command.
        rotor_torque: Vec3<T, Body> [N m];
        /// What the laws decided at the last tick, where commands may be late.
        decided: Command<T> [];
        /// Thrust per mass that was sent to the rotors at the last tick.
        pull: Vec3<T, World> [m/s^2];
        /// What the allocation refused at the last tick.
        unallocated: Wrench<T> [];
        /// 1 while flying, 0 once failed.
        alive: T [1];
        /// Cause of failure, see [`Cause`]; 0 while all is well.
        cause: T [1];
        /// Ticks flown.
        flown: T [count];
        /// Tick of the batch at which the flight began; 0 where it flies alone.
        begin: T [count];
        structure {
            /// Integration steps in one control step.
            substeps: u32;
            /// Ticks since the batch began, common to all lanes.
            tick: u64;
            /// What there is to look after beside pushes.
            cares: Cares;
        }
    }
}

impl Flight<f64> {
    /// Puts the vehicle at `state` and lets every law begin there.
    pub fn start(&mut self, state: State<f64>) {
        self.state = state;
        self.cares = self.cares();
        self.laden = self.vehicle;
        self.hanging = Hanging::default();
        self.per = Reciprocals::new(&self.vehicle);
        self.belief = self.actuation.belief();
        self.mass_ratio = self.vehicle.mass / self.model.mass;
        self.actuation.reset();
        self.timing.reset(self.model.mass, self.model.gravity);
        self.unallocated = Wrench::default();
        self.conditions = Conditions::new(&self.per, &Push::default());
        self.faults = RotorFaults::none();
        (self.alive, self.cause, self.flown) = (1.0, 0.0, 0.0);
        self.tick = 0;
        self.rotor_torque = self.actuation.torque(&self.state);
        self.stack.reset(&self.measure());
        if self.sensing.estimate {
            let truth = self.truth();
            self.sensing.begin(&truth);
        }
    }
}

impl<T: Real> Flight<T> {
    /// What the laws see: the true state, and the rotors as their model has them.
    #[inline(always)]
    fn measure(&self) -> Measurement<T> {
        let (thrust, torque) = (self.actuation.thrust(&self.state), self.rotor_torque);
        let achieved = Wrench { thrust: thrust * self.belief, torque: torque * self.belief };
        let State { position, velocity, attitude, rate, .. } = &self.state;
        Measurement {
            position: near(position),
            velocity: near(velocity),
            attitude: near(attitude),
            rate: near(rate),
            achieved,
            unallocated: near(&self.unallocated),
        }
    }

    /// What the laws are told: the truth, or what sensors and filter make of it.
    #[inline(always)]
    fn measurement(&mut self) -> Measurement<T> {
        if self.sensing.estimate { same(&self.sense()) } else { self.measure() }
    }

    /// Ticks since the start.
    #[inline(always)]
    pub fn ticks(&self) -> T {
        T::lit(self.tick as f64) - self.begin
    }

    /// Time since the start, s: a count times the step, never a sum.
    #[inline(always)]
    pub fn time(&self) -> T {
        self.ticks() * self.control_step
    }

    /// Control steps after which a flight may begin beside others.
    pub fn period(&self) -> u64 {
        self.stack.every.period()
    }

    /// Reference, laws, actuation: everything that happens at the start of a tick.
    #[inline(always)]
    pub fn decide(&mut self) -> Tick<T> {
        let time = self.time();
        let reference = self.reference.at(time);
        let push = self.surroundings();
        let estimate = self.stack.estimate() * self.model.mass;
        let told = self.measurement();
        let sent = self.command(&told, &reference);
        self.unallocated = self.actuation.command(&sent, &self.vehicle);
        self.pull = sent.force;
        if self.cares.propulsion {
            self.actuation.suffer(&self.faults, &self.state, self.control_step);
        }
        self.thrust_per_mass = self.actuation.thrust_per_mass(&self.state, &self.vehicle);
        let wind = self.conditions.wind;
        let (applied, air, lumped, cargo) = if self.cares.any() {
            let seen = self.look();
            let Push { force, torque } = seen.air;
            let lumped = self.unexplained(seen.slope.body.velocity);
            (seen.rotors, Air { wind, force, torque }, lumped, self.hanging.place)
        } else {
            let still = Air { wind, ..Air::default() };
            (self.actuation.wrench(&self.state), still, self.lumped(&push), Vec3::zero())
        };
        let State { position, velocity, attitude, rate, rotor_speed } = self.state;
        let Push { force, torque } = push;
        Tick {
            time,
            position,
            velocity,
            attitude,
            rate,
            rotor_speed,
            reference,
            command: self.commanded(&sent),
            applied,
            disturbance: Disturbed { force, torque, lumped },
            air,
            cargo,
            estimate: Estimated {
                force: estimate,
                position: told.position,
                velocity: told.velocity,
                attitude: told.attitude,
                rate: told.rate,
            },
            saturation: self.actuation.saturation(),
            flags: self.stack.flags(),
        }
    }

    /// The laws decide; gives what is sent to the rotors at this tick.
    #[inline(always)]
    fn command(&mut self, told: &Measurement<T>, reference: &Trajectory<T>) -> Sent<T> {
        let before = if self.timing.drops { Some(self.stack) } else { None };
        let (dt, input) = (self.control_step, self.known(told));
        let (force, wrench) = self.stack.act_checked([input, input], told, reference, dt);
        let mut sent = Sent { force, wrench };
        if self.timing.late {
            sent = same(&self.late(before));
        }
        sent
    }

    /// Where the laws' input is good: a reference is finite at any time, and so is the state of a vehicle
    /// that flies. What a filter makes of sensors may not be.
    #[inline(always)]
    fn known(&self, told: &Measurement<T>) -> Good<T> {
        if self.sensing.estimate { passing(told, self.control_step) } else { Good::everywhere() }
    }

    /// What every level asked for at this tick, and what of it was `sent`. Only who looks on needs all of
    /// this; the loop itself is content with what is sent.
    #[inline(always)]
    fn commanded(&self, sent: &Sent<T>) -> Command<T> {
        if self.timing.late {
            let thrust = Thrust { force: sent.force, ..self.decided.thrust };
            Command { thrust, wrench: sent.wrench, ..self.decided }
        } else {
            self.stack.command()
        }
    }

    /// [`Flight::command`] where commands may be late: the laws were as `before` where ticks may be dropped.
    #[inline(never)]
    fn late(&mut self, before: Option<Stack<T>>) -> Sent<T> {
        let (mut decided, tick) = (self.stack.command(), self.ticks());
        if let Some(before) = before {
            // Where the tick is dropped, the laws have not run: they and their command are as before.
            let dropped = self.timing.dropped(tick);
            self.stack = blend(dropped, &before, &self.stack);
            decided = blend(dropped, &self.decided, &decided);
        }
        self.decided = decided;
        let sent = Sent { force: decided.thrust.force, wrench: decided.wrench };
        self.timing.pass(&sent, tick, self.tick, self.control_step)
    }

    /// m_law (a + g_law e_z) - T_law R e_z from the true acceleration, N.
    #[inline(always)]
    fn lumped(&self, push: &Push<T>) -> Vec3<T, World> {
        let mut lumped = Vec3::zero();
        for i in 0..T::PARTS {
            let (thrust, per_mass) = (self.thrust_per_mass.pick(i), self.per.mass.part(i));
            let (vehicle, model) = (self.vehicle.pick(i), self.model.pick(i));
            let a = acceleration(thrust, push.force.pick(i) * per_mass, vehicle.gravity);
            let expected = thrust * (vehicle.mass * self.belief.part(i));
            let lump = (a + Vec3::up(model.gravity)) * model.mass - expected;
            lump.put(&mut lumped, i);
        }
        lumped
    }

    /// What drove the vehicle, as an observer may know it: the law's own mass and gravity.
    #[inline(always)]
    fn applied(&self) -> Applied<T> {
        let (weight, ratio) = (Vec3::up(self.model.gravity), self.mass_ratio * self.belief);
        let (commanded, measured) = (self.pull - weight, self.thrust_per_mass * ratio - weight);
        Applied { commanded, measured }
    }

    /// Observer and plant over the tick that `decide` began. A failed flight stands still.
    #[inline(always)]
    pub fn advance(&mut self, tick: &Tick<T>) {
        let dt = self.control_step;
        self.judge(tick);
        let applied = self.applied();
        self.stack.advance(&applied, dt);

        let h = dt * T::lit(1.0 / f64::from(self.substeps));
        let state = if self.cares.any() {
            let vehicle = if self.cares.laden { &self.laden } else { &self.vehicle };
            let whole = Whole { body: self.state, hanging: self.hanging };
            let (conditions, steps) = (&self.conditions, self.substeps);
            let whole = world::advance(&whole, h, steps, vehicle, &mut self.actuation, conditions);
            self.hanging = whole.hanging;
            self.rotor_torque = self.actuation.torque(&whole.body);
            same(&whole.body)
        } else {
            self.glide(h, &Push { force: tick.disturbance.force, torque: tick.disturbance.torque })
        };
        let steady = state.sum(|x| x).is_finite() & T::zero().lt(self.alive);
        if steady.all() {
            self.state = same(&state);
        } else {
            self.settle(&same(&state));
        }
        self.flown += self.alive;
        self.tick += 1;
    }

    /// The state after the tick where nothing but this push disturbs, in steps of `h`.
    #[inline(always)]
    fn glide(&mut self, h: T, push: &Push<T>) -> State<T> {
        let held = Held::new(&self.per, push);
        let mut state = self.state;
        let mut torque = self.rotor_torque;
        for _ in 0..self.substeps {
            (state, torque) = self.actuation.step(&state, torque, h, &self.vehicle, &held);
        }
        self.rotor_torque = torque;
        state
    }

    /// Moves only the flights that go on and whose state is finite.
    #[cold]
    #[inline(never)]
    fn settle(&mut self, state: &State<T>) {
        let finite = state.finite();
        self.state = blend(finite & T::zero().lt(self.alive), state, &self.state);
        self.rotor_torque = self.actuation.torque(&self.state);
        self.fail(!finite, 4.0);
    }

    /// Ends the flight where a limit is passed.
    #[inline(always)]
    fn judge(&mut self, tick: &Tick<T>) {
        let Limits { position_error, tilt_deg, ground } = self.limits;
        let mut error = T::zero();
        for i in 0..T::PARTS {
            let e = tick.position.pick(i) - tick.reference.position.pick(i);
            error.set_part(i, e.norm_squared());
        }
        let far = position_error.sq().lt(error);
        let low = tick.position.z.lt(ground);
        // Only where a tilt limit is set; 180 deg allows any attitude.
        let tilts = !T::lit(180.0).le(tilt_deg).all();
        // The usual case; what follows changes nothing then.
        if !tilts && (!(far | low)).all() {
            return;
        }
        self.fail(far, 1.0);
        if tilts {
            let (_, lowest) = (tilt_deg * T::lit(core::f64::consts::PI / 180.0)).sin_cos();
            self.fail(tick.attitude.z_axis().z.lt(lowest) & tilt_deg.lt(T::lit(180.0)), 2.0);
        }
        self.fail(low, 3.0);
    }

    #[inline(always)]
    fn fail(&mut self, failed: T::Mask, code: f64) {
        // The usual case; what follows changes nothing then.
        if (!failed).all() {
            return;
        }
        let now = failed & T::zero().lt(self.alive);
        self.alive = T::select(now, T::zero(), self.alive);
        self.cause = T::select(now, T::lit(code), self.cause);
    }
}
