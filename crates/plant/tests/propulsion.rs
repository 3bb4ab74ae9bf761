//! Real rotors against closed forms: lags, ground, gyroscopes, battery, faults.
// Tests take the standard library as their second opinion.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::float_cmp)]

mod common;

use common::{Scene, body, named, source, step, world};
use stormpetrel_control::math::Vec3;
use stormpetrel_control::options::Cells;
use stormpetrel_control::signals::Wrench;
use stormpetrel_plant::actuation::Sent;
use stormpetrel_plant::actuation::propulsion::{self, Options, Supply};
use stormpetrel_plant::actuation::{Actuate, Actuation, ActuationSettings};
use stormpetrel_plant::disturbance::{DisturbanceSettings, RotorFaults, rotor_lost};
use stormpetrel_plant::dynamics::{Push, Reciprocals};
use stormpetrel_plant::state::State;
use stormpetrel_plant::vehicle::{Arms, Layout, Vehicle};
use stormpetrel_plant::world::{self as whole, Conditions, Whole};

fn vehicle() -> Vehicle<f64> {
    Scene::default().vehicle
}

fn built(
    vehicle: &Vehicle<f64>,
    gains: propulsion::Gains<f64>,
    options: Options,
) -> Actuation<f64> {
    ActuationSettings::Propulsion(gains, options).build(vehicle)
}

fn plain(vehicle: &Vehicle<f64>) -> Actuation<f64> {
    built(vehicle, Default::default(), Options::default())
}

fn calm(vehicle: &Vehicle<f64>) -> Conditions<f64> {
    Conditions::new(&Reciprocals::new(vehicle), &Push::default())
}

/// The state `h` seconds on.
fn moved(
    body: State<f64>,
    h: f64,
    vehicle: &Vehicle<f64>,
    actuation: &mut Actuation<f64>,
    conditions: &Conditions<f64>,
) -> State<f64> {
    let whole = Whole { body, ..Whole::default() };
    whole::advance(&whole, h, 1, vehicle, actuation, conditions).body
}

fn asking(thrust: f64) -> Sent<f64> {
    Sent { wrench: Wrench { thrust, torque: Vec3::zero() }, ..Sent::default() }
}

fn at_speed(speed: f64) -> State<f64> {
    State { rotor_speed: [speed; 4], ..State::default() }
}

#[test]
fn a_rotor_rises_and_falls_with_its_own_time_constant() {
    let vehicle = Vehicle { motor_lag: 0.02, motor_lag_fall: 0.05, ..vehicle() };
    for (from, thrust, lag) in [(1000.0, 8.0, 0.02), (2000.0, 4.0, 0.05)] {
        let mut actuation = plain(&vehicle);
        let mut state = at_speed(from);
        let to = (thrust / 4.0 / vehicle.thrust_coefficient).sqrt();
        for tick in 1..=100 {
            actuation.command(&asking(thrust), &vehicle);
            actuation.suffer(&RotorFaults::none(), &state, 1e-3);
            state = moved(state, 1e-3, &vehicle, &mut actuation, &calm(&vehicle));
            let want = to + (from - to) * (-f64::from(tick) * 1e-3 / lag).exp();
            assert!((state.rotor_speed[2] / want - 1.0).abs() < 1e-12, "tick {tick}");
        }
    }
}

#[test]
fn in_still_air_and_without_inertia_it_is_the_article_s_rotors() {
    let (vehicle, state) =
        (vehicle(), State { rotor_speed: [1400.0, 1500.0, 1450.0, 1300.0], ..State::default() });
    let (rotors, propulsion) =
        (named::<ActuationSettings>("rotors").build(&vehicle), plain(&vehicle));
    let held = calm(&vehicle);
    let (a, b) = (rotors.load(&state, &vehicle, &held), propulsion.load(&state, &vehicle, &held));
    assert!((a.thrust_per_mass - b.thrust_per_mass).norm() < 1e-12);
    assert!((a.torque - b.torque).norm() < 1e-15);
}

#[test]
fn every_layout_gives_the_wrench_that_is_asked() {
    let free =
        [0.1, -0.2, 0.0, 1.0, -0.15, 0.1, 0.0, 1.0, 0.1, 0.12, 0.0, -1.0, -0.1, -0.15, 0.0, -1.0];
    let free: &'static [f64] = Vec::leak(free.to_vec());
    for arms in [Arms::ArticlePlus, Arms::Px4Plus, Arms::Px4X, Arms::Free] {
        let layout = Layout { arms, rotors: Cells { cells: free, file: "" }.into() };
        let vehicle = Vehicle { layout, rotor_speed_min: 0.0, ..vehicle() };
        let mut actuation = plain(&vehicle);
        let torque = body(0.02, -0.03, 0.004);
        let command = Sent { wrench: Wrench { thrust: 7.0, torque }, ..Sent::default() };
        let refused = actuation.command(&command, &vehicle);
        let Actuation::Propulsion(rotors) = &actuation else { panic!("propulsion") };
        let state = State { rotor_speed: rotors.commanded, ..State::default() };
        let load = actuation.load(&state, &vehicle, &calm(&vehicle));
        assert!(refused.thrust.abs() + refused.torque.norm() < 1e-13, "{arms:?}");
        assert!((load.thrust_per_mass.z * vehicle.mass - 7.0).abs() < 1e-12, "{arms:?}");
        assert!((load.torque - torque).norm() < 1e-14, "{arms:?}: {:?}", load.torque);
    }
}

#[test]
fn the_ground_effect_is_the_published_curve() {
    // Cheeseman and Bennett: T/T0 = 1/(1 - (R/4h)^2): 1.0667 at h = R, 1.0159 at 2 R.
    let vehicle = Vehicle { rotor_radius: 0.1, ..vehicle() };
    let gains = propulsion::Gains { ground: 2.0, ..Default::default() };
    let actuation = built(&vehicle, gains, Options::default());
    let thrust = |height: f64| {
        let state = State { position: world(0.0, 0.0, 2.0 + height), ..at_speed(1458.0) };
        actuation.load(&state, &vehicle, &calm(&vehicle)).thrust_per_mass.z
    };
    let far = thrust(1e6);
    for (h, want) in [(0.1, 16.0 / 15.0), (0.2, 64.0 / 63.0), (0.05, 4.0 / 3.0), (0.0, 4.0 / 3.0)] {
        assert!((thrust(h) / far / want - 1.0).abs() < 1e-9, "{h} m: {}", thrust(h) / far);
    }
}

#[test]
fn spinning_rotors_precess() {
    // All four rotors the same way round: h = 4 J w. With I omega' = -omega x (I omega + h) and equal moments
    // the rate turns about the axis with h/I.
    let spins: &'static [f64] = Vec::leak(vec![
        0.1, 0.0, 0.0, 1.0, 0.0, -0.1, 0.0, 1.0, -0.1, 0.0, 0.0, 1.0, 0.0, 0.1, 0.0, 1.0,
    ]);
    let vehicle = Vehicle {
        inertia: Vec3::splat(3e-3),
        rotor_inertia: 2e-5,
        drag_coefficient: 1e-14,
        gravity: 0.0,
        layout: Layout { arms: Arms::Free, rotors: Cells { cells: spins, file: "" }.into() },
        ..vehicle()
    };
    let mut actuation = plain(&vehicle);
    if let Actuation::Propulsion(rotors) = &mut actuation {
        rotors.commanded = [1000.0; 4];
    }
    let mut state = State { rate: body(0.4, 0.0, 0.0), ..at_speed(1000.0) };
    for _ in 0..1000 {
        state = moved(state, 1e-4, &vehicle, &mut actuation, &calm(&vehicle));
    }
    let angle: f64 = 4.0 * 2e-5 * 1000.0 / 3e-3 * 0.1;
    let want = body(angle.cos(), angle.sin(), 0.0) * 0.4;
    // The least drag torque that a vehicle may have turns it by 1.3e-6 rad/s.
    let level = body(state.rate.x, state.rate.y, 0.0);
    assert!(
        (level - want).norm() < 1e-11 && state.rate.z.abs() < 2e-6,
        "{:?} {want:?}",
        state.rate
    );
}

#[test]
fn a_rotor_that_speeds_up_turns_the_body_the_other_way() {
    // Angular momentum about the axis is kept: I r + sum s J w constant without drag torque.
    let vehicle =
        Vehicle { rotor_inertia: 2e-5, drag_coefficient: 1e-14, gravity: 0.0, ..vehicle() };
    let mut actuation = plain(&vehicle);
    let mut state = at_speed(1000.0);
    if let Actuation::Propulsion(rotors) = &mut actuation {
        rotors.commanded = [1500.0, 1000.0, 1500.0, 1000.0];
        rotors.rising = [1.0, 0.0, 1.0, 0.0];
    }
    for _ in 0..200 {
        state = moved(state, 1e-3, &vehicle, &mut actuation, &calm(&vehicle));
    }
    let gained = 2e-5 * 2.0 * (state.rotor_speed[0] - 1000.0);
    assert!((state.rate.z * 2.6e-3 / -gained - 1.0).abs() < 1e-6, "{:?}", state.rate);
}

#[test]
fn inflow_and_flapping_act_as_their_equations_say() {
    let vehicle = Vehicle { inflow_loss: 1e-5, flapping: 2e-6, ..vehicle() };
    let actuation = plain(&vehicle);
    let state = State { velocity: world(3.0, -2.0, 1.5), ..at_speed(1400.0) };
    let load = actuation.load(&state, &vehicle, &calm(&vehicle));
    let thrust = 4.0 * (vehicle.thrust_coefficient * 1400.0 * 1400.0 - 1e-5 * 1400.0 * 1.5);
    assert!((load.thrust_per_mass.z * vehicle.mass - thrust).abs() < 1e-12);
    // Forward flight raises the nose: a torque about -y; to the right (-y) it lifts the right side.
    let want = body(-2.0, -3.0, 0.0) * (4.0 * 2e-6 * 1400.0);
    assert!((load.torque - want).norm() < 1e-12, "{:?}", load.torque);
}

#[test]
fn a_battery_discharges_and_sags_as_its_equations_say() {
    // Without resistance and with one voltage, I = P/V: the charge falls along a straight line.
    let vehicle = vehicle();
    let gains = propulsion::Gains {
        battery_full: 12.0,
        battery_empty: 12.0,
        battery_resistance: 0.0,
        battery_capacity: 5000.0,
        motor_efficiency: 0.5,
        ..Default::default()
    };
    let options = Options { supply: Supply::Battery, ..Options::default() };
    let mut actuation = built(&vehicle, gains, options);
    let (speed, state) = (1458.0f64, at_speed(1458.0));
    for _ in 0..10_000 {
        actuation.command(&asking(6.0), &vehicle);
        actuation.suffer(&RotorFaults::none(), &state, 1e-3);
    }
    let power = 4.0 * vehicle.drag_coefficient * speed.powi(3) / 0.5;
    let Actuation::Propulsion(rotors) = &actuation else { panic!("propulsion") };
    assert!((rotors.battery.current / (power / 12.0) - 1.0).abs() < 1e-12);
    assert!((rotors.battery.charge - (1.0 - power / 12.0 * 10.0 / 5000.0)).abs() < 1e-12);

    // With resistance: V I = P and V = V_oc - R I.
    let gains = propulsion::Gains { battery_resistance: 0.05, ..gains };
    let mut actuation = built(&vehicle, gains, options);
    actuation.suffer(&RotorFaults::none(), &state, 1e-3);
    let Actuation::Propulsion(rotors) = &actuation else { panic!("propulsion") };
    let (v, i) = (rotors.battery.voltage, rotors.battery.current);
    assert!((v * i / power - 1.0).abs() < 1e-12 && (v - (12.0 - 0.05 * i)).abs() < 1e-12);
    assert!((rotors.battery.limit() - 2917.0 / 12.0 * v).abs() < 1e-9);
}

#[test]
fn a_nearly_empty_battery_limits_the_rotors_and_says_so() {
    let vehicle = vehicle();
    let gains =
        propulsion::Gains { battery_charge: 1e-3, battery_empty: 8.0, ..Default::default() };
    let options = Options { supply: Supply::Battery, ..Options::default() };
    let mut actuation = built(&vehicle, gains, options);
    let state = at_speed(1458.0);
    actuation.suffer(&RotorFaults::none(), &state, 1e-3);
    let refused = actuation.command(&asking(20.0), &vehicle);
    let Actuation::Propulsion(rotors) = &actuation else { panic!("propulsion") };
    let limit = rotors.battery.limit();
    assert!(limit < 1390.0 && rotors.commanded.iter().all(|w| *w == limit));
    let granted = 4.0 * vehicle.thrust_coefficient * limit * limit;
    assert!((refused.thrust - (20.0 - granted)).abs() < 1e-12);
    assert_eq!(actuation.saturation(), 1.0);
}

#[test]
fn a_battery_gives_its_charge_and_then_nothing() {
    let vehicle = vehicle();
    let gains = propulsion::Gains {
        battery_full: 12.0,
        battery_empty: 12.0,
        battery_resistance: 0.0,
        battery_capacity: 5.0,
        motor_efficiency: 0.5,
        ..Default::default()
    };
    let options = Options { supply: Supply::Battery, ..Options::default() };
    let mut actuation = built(&vehicle, gains, options);
    let power = 4.0 * vehicle.drag_coefficient * 1458.0f64.powi(3) / 0.5;
    let lasts = 5.0 * 12.0 / power;
    let mut seconds = 0.0;
    loop {
        let refused = actuation.command(&asking(6.0), &vehicle);
        let Actuation::Propulsion(rotors) = &actuation else { panic!("propulsion") };
        if rotors.commanded == [0.0; 4] {
            assert!((refused.thrust - 6.0).abs() < 1e-12);
            break;
        }
        actuation.suffer(&RotorFaults::none(), &at_speed(1458.0), 1e-3);
        seconds += 1e-3;
        assert!(seconds < 2.0 * lasts, "it gives more than it holds");
    }
    assert!((seconds - lasts).abs() < 3e-3, "{seconds} s in the place of {lasts} s");
}

#[test]
fn rotors_settle_at_the_power_that_the_resistance_lets_through() {
    let vehicle = vehicle();
    let gains = propulsion::Gains {
        battery_full: 12.0,
        battery_empty: 12.0,
        battery_resistance: 1.0,
        motor_efficiency: 0.5,
        // The voltage alone would let them turn.
        speed_per_volt: 1e4,
        ..Default::default()
    };
    let options = Options { supply: Supply::Battery, ..Options::default() };
    let mut actuation = built(&vehicle, gains, options);
    let mut state = at_speed(1458.0);
    let most = 12.0 * 12.0 / 4.0;
    let asked = 4.0 * vehicle.drag_coefficient * 1458.0f64.powi(3) / 0.5;
    actuation.suffer(&RotorFaults::none(), &state, 1e-3);
    actuation.command(&asking(6.0), &vehicle);
    let Actuation::Propulsion(rotors) = &actuation else { panic!("propulsion") };
    let want = 1458.0 * (most / asked).powf(1.0 / 3.0);
    assert!(
        (rotors.commanded[1] / want - 1.0).abs() < 1e-12,
        "power goes with the cube of the speed"
    );
    for _ in 0..2000 {
        actuation.command(&asking(6.0), &vehicle);
        actuation.suffer(&RotorFaults::none(), &state, 1e-3);
        state = moved(state, 1e-3, &vehicle, &mut actuation, &calm(&vehicle));
    }
    let power = 4.0 * vehicle.drag_coefficient * state.rotor_speed[0].powi(3) / 0.5;
    assert!(asked > 1.2 * most && (power / most - 1.0).abs() < 0.03, "{power} of {most} W");
    let Actuation::Propulsion(rotors) = &actuation else { panic!("propulsion") };
    assert!(rotors.battery.voltage * rotors.battery.current <= most * (1.0 + 1e-12));
}

#[test]
fn a_table_takes_the_place_of_the_coefficients() {
    let rows: &'static [f64] = Vec::leak(vec![0.0, 0.0, 0.0, 1000.0, 1.0, 0.02, 2000.0, 3.0, 0.08]);
    let options = Options { curve: Cells { cells: rows, file: "" }.into(), ..Options::default() };
    let vehicle = vehicle();
    let actuation = built(&vehicle, Default::default(), options);
    for (speed, thrust) in [(500.0, 0.5), (1000.0, 1.0), (1500.0, 2.0), (2500.0, 3.0)] {
        let load = actuation.load(&at_speed(speed), &vehicle, &calm(&vehicle));
        assert!((load.thrust_per_mass.z * vehicle.mass - 4.0 * thrust).abs() < 1e-12, "{speed}");
    }
}

#[test]
fn a_lost_rotor_gives_nothing_and_runs_down() {
    let scene =
        Scene { actuation: named("propulsion"), reference: named("hover"), ..Scene::default() };
    let mut flight = scene.calm().flight();
    let lost = rotor_lost::Gains { rotor: 3.0 };
    flight.disturbance[0] = source(DisturbanceSettings::RotorLost(lost, ()), &flight.vehicle);
    flight.start(flight.state);
    let hover = flight.vehicle.hover_speed();
    for tick in 1..=20 {
        step(&mut flight);
        let want = hover * (-f64::from(tick) * 1e-3 / 0.02).exp();
        assert!((flight.state.rotor_speed[2] / want - 1.0).abs() < 1e-12);
    }
    let load = flight.actuation.load(&flight.state, &flight.vehicle, &flight.conditions);
    let [a, b, _, d] = flight.state.rotor_speed.map(|w| 7.2e-7 * w * w);
    let thrust = load.thrust_per_mass.norm() * flight.vehicle.mass;
    assert!((thrust / (a + b + d) - 1.0).abs() < 1e-12);
}

#[test]
fn a_stuck_rotor_keeps_its_speed() {
    let scene =
        Scene { actuation: named("propulsion"), reference: named("hover"), ..Scene::default() };
    let mut flight = scene.calm().flight();
    flight.disturbance[0] = source(named("rotor-stuck"), &flight.vehicle);
    let start = State { rotor_speed: [1600.0, 1400.0, 1300.0, 1500.0], ..flight.state };
    flight.start(start);
    for _ in 0..50 {
        step(&mut flight);
        assert_eq!(flight.state.rotor_speed[0], 1600.0);
    }
    assert_ne!(flight.state.rotor_speed[1], 1400.0);
}
