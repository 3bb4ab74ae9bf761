//! The world against closed forms: air, ground, cable, payload, energy.
// Tests take the standard library as their second opinion.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant)]

mod common;

use common::{Scene, body, named, source, step, world};
use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::record::Record;
use stormpetrel_plant::actuation::{Actuation, ActuationSettings};
use stormpetrel_plant::disturbance::{
    DisturbanceSettings, Site, SourceSettings, Window, payload, slung_mass,
};
use stormpetrel_plant::dynamics::{Push, Reciprocals};
use stormpetrel_plant::flight::Flight;
use stormpetrel_plant::sling::{Hanging, Sling, hang};
use stormpetrel_plant::state::State;
use stormpetrel_plant::vehicle::Vehicle;
use stormpetrel_plant::world::{self as whole, Conditions, Scenery, Whole};

/// A body without rotors: the ideal wrench commands nothing.
fn coasting(vehicle: &Vehicle<f64>) -> Actuation<f64> {
    named::<ActuationSettings>("wrench").build(vehicle)
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

fn airy(vehicle: &Vehicle<f64>) -> Conditions<f64> {
    Conditions { airy: true, ..Conditions::new(&Reciprocals::new(vehicle), &Push::default()) }
}

#[test]
fn a_fall_through_air_follows_its_closed_form() {
    // Reliability 1.4 no. 5: m = 1 slug, CD S rho/2 = 0.5 * 1.225 * 0.1 * 0.018241465.
    let vehicle = Vehicle {
        mass: 14.593_902_937_2,
        gravity: 9.80665,
        body_drag: 0.5 * 1.225 * 0.1 * 0.018_241_465,
        ..Vehicle::default()
    };
    let (mut actuation, held) = (coasting(&vehicle), airy(&vehicle));
    let mut state = State::default();
    for tick in 1..=30_000 {
        state = moved(state, 1e-3, &vehicle, &mut actuation, &held);
        let (v, z) = (-state.velocity.z, -state.position.z);
        if tick == 10_000 {
            assert!(
                (v - 95.683_804_666_460_3).abs() < 1e-9 && (z - 484.317_042_740_148).abs() < 1e-8
            );
        }
        if tick == 30_000 {
            assert!(
                (v - 241.999_949_652_913).abs() < 1e-9 && (z - 3_990.472_432_531_07).abs() < 1e-8
            );
        }
    }
}

#[test]
fn linear_drag_brings_the_body_to_the_speed_of_the_wind() {
    let vehicle = Vehicle { gravity: 0.0, rotor_drag: body(0.3, 0.5, 0.1), ..Vehicle::default() };
    let held = Conditions { wind: world(4.0, -2.0, 1.0), ..airy(&vehicle) };
    let mut actuation = coasting(&vehicle);
    let mut state = State::default();
    for _ in 0..1000 {
        state = moved(state, 1e-3, &vehicle, &mut actuation, &held);
    }
    // Level and not turning: each axis is a first-order lag of its own.
    let reached = |d: f64| 1.0 - (-d / 0.625f64).exp();
    let want = world(4.0 * reached(0.3), -2.0 * reached(0.5), reached(0.1));
    assert!((state.velocity - want).norm() < 1e-12, "{:?}", state.velocity);
}

#[test]
fn rate_drag_has_its_closed_forms() {
    // Equal moments: no gyroscopic torque. Linear: w0 exp(-d t/I). Quadratic: w0/(1 + d w0 t/I).
    let inertia = 3e-3;
    let plain = Vehicle { gravity: 0.0, inertia: Vec3::splat(inertia), ..Vehicle::default() };
    let spin = State { rate: body(0.0, 0.0, 20.0), ..State::default() };
    let fly = |vehicle: &Vehicle<f64>, start: State<f64>| {
        let (mut actuation, held) = (coasting(vehicle), airy(vehicle));
        (0..2000).fold(start, |state, _| moved(state, 1e-3, vehicle, &mut actuation, &held)).rate.z
    };
    let linear = Vehicle { rate_drag: Vec3::splat(2e-3), ..plain };
    assert!((fly(&linear, spin) - 20.0 * (-2e-3 * 2.0 / inertia).exp()).abs() < 1e-11);
    let quadratic = Vehicle { rate_drag_quadratic: Vec3::splat(1e-4), ..plain };
    assert!((fly(&quadratic, spin) - 20.0 / (1.0 + 1e-4 * 20.0 * 2.0 / inertia)).abs() < 1e-11);
    let by_airspeed = Vehicle { rate_drag_airspeed: Vec3::splat(1e-3), ..plain };
    let moving = State { velocity: world(3.0, 4.0, 0.0), ..spin };
    assert!((fly(&by_airspeed, moving) - 20.0 * (-5e-3 * 2.0 / inertia).exp()).abs() < 1e-10);
}

#[test]
fn a_tumbling_brick_with_rate_damping_stays_inside_the_span_of_the_published_simulators() {
    // NESC check-case 3 (reliability 1.3): M = rho V S/4 (b^2 p, c^2 q, b^2 r), dropped from 30,000 ft
    // with p, q, r = 10, 20, 30 deg/s over the equator. Slugs and feet as they come; density of the 1976
    // atmosphere. The air turns with the Earth, so the fall through it is slower by the centrifugal part.
    const FOOT: f64 = 0.3048;
    const DEGREE: f64 = std::f64::consts::PI / 180.0;
    let (s, b, c) = (0.22222, 0.33333, 0.66667);
    let mut vehicle = Vehicle {
        mass: 0.155_404_754,
        inertia: body(0.001_894_220, 0.006_211_019, 0.007_194_665),
        ..Vehicle::default()
    };
    let mut actuation = coasting(&vehicle);
    let mut state = State { rate: body(10.0, 20.0, 30.0) * DEGREE, ..State::default() };
    let density = |z: f64| {
        let t = 288.15 - 0.0065 * z;
        1.225 * (t / 288.15f64).powf(9.80665 / (287.05287 * 0.0065) - 1.0) / 515.378_818
    };
    let mut checks = [(5.0, body(-4.135, 3.189, 21.725), 0.0025)].to_vec();
    for (t, r) in [(10.0, 8.426), (15.0, 1.571), (20.0, 0.1214)] {
        checks.push((t, body(f64::NAN, f64::NAN, r), 1e-3));
    }
    for tick in 1..=20_000 {
        // Altitude above the ellipsoid to geopotential height.
        let z = (30_000.0 + state.position.z) * FOOT;
        let geopotential = 6_356_766.0 * z / (6_356_766.0 + z);
        let (radius, turning) = (20_925_646.325_5, 7.292_115e-5);
        let from_centre = radius + 30_000.0 + state.position.z;
        vehicle.gravity = 32.106_536 * ((radius + 30_000.0) / from_centre).powi(2)
            - turning * turning * from_centre;
        let damping = density(geopotential) * s / 4.0;
        vehicle.rate_drag_airspeed = body(b * b, c * c, b * b) * damping;
        let held = airy(&vehicle);
        state = moved(state, 1e-3, &vehicle, &mut actuation, &held);
        for (time, want, span) in &checks {
            if (tick as f64 * 1e-3 - time).abs() < 1e-6 {
                let got = state.rate * (1.0 / DEGREE);
                assert!((got.z - want.z).abs() < *span, "{time} s: {got:?}");
                if want.x.is_finite() {
                    assert!((got.x - want.x).abs() < *span && (got.y - want.y).abs() < *span);
                }
            }
        }
    }
}

#[test]
fn energy_changes_by_the_work_of_thrust_and_air() {
    // E' = F.v + tau.w over a tumbling flight on rotors that keep their speed, with drag and rate drag.
    let vehicle = Vehicle {
        inertia: body(2.6e-3, 2.4e-3, 4.1e-3),
        rotor_drag: body(0.05, 0.08, 0.02),
        body_drag: 0.01,
        rate_drag: Vec3::splat(1e-4),
        ..Vehicle::default()
    };
    let mut actuation = named::<ActuationSettings>("rotors").build(&vehicle);
    if let Actuation::Rotors(rotors) = &mut actuation {
        rotors.commanded = [1400.0, 1460.0, 1420.0, 1450.0];
    }
    let held = Conditions { wind: world(3.0, -1.0, 0.5), ..airy(&vehicle) };
    let mut state = State {
        rate: body(0.5, -0.3, 0.2),
        velocity: world(2.0, 1.0, -0.5),
        rotor_speed: [1400.0, 1460.0, 1420.0, 1450.0],
        ..State::default()
    };
    let energy = |s: &State<f64>| {
        let turning = s.rate.dot(s.rate.scale(vehicle.inertia));
        0.5 * vehicle.mass * s.velocity.norm_squared()
            + 0.5 * turning
            + vehicle.mass * vehicle.gravity * s.position.z
    };
    let power = |actuation: &Actuation<f64>, s: &State<f64>| {
        let scenery = Scenery { vehicle: &vehicle, actuation, conditions: &held };
        let slope = scenery.slope(&Whole { body: *s, ..Whole::default() }).body;
        // Force and torque from the motion itself, weight taken out.
        let force = (slope.velocity + Vec3::up(vehicle.gravity)) * vehicle.mass;
        let torque =
            slope.rate.scale(vehicle.inertia) + s.rate.cross(s.rate.scale(vehicle.inertia));
        force.dot(s.velocity) + torque.dot(s.rate)
    };
    let before = energy(&state);
    let (h, mut work, mut most) = (1e-3, 0.0, before.abs());
    for _ in 0..1000 {
        // Simpson's rule over two steps.
        let a = power(&actuation, &state);
        let middle = moved(state, h, &vehicle, &mut actuation, &held);
        let b = power(&actuation, &middle);
        state = moved(middle, h, &vehicle, &mut actuation, &held);
        work += h / 3.0 * (a + 4.0 * b + power(&actuation, &state));
        most = most.max(energy(&state).abs());
    }
    let error = (energy(&state) - before - work).abs() / most;
    assert!(error < 1e-9, "{error:e}");
}

/// Complete elliptic integral of the first kind by the arithmetic-geometric mean.
fn elliptic_k(m: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - m).sqrt());
    for _ in 0..12 {
        (a, b) = ((a + b) / 2.0, (a * b).sqrt());
    }
    std::f64::consts::FRAC_PI_2 / a
}

#[test]
fn a_slung_mass_under_a_heavy_vehicle_swings_like_a_pendulum() {
    // A vehicle so heavy that it does not move, held up exactly: T = 4 sqrt(L/g) K(sin^2(a/2)).
    let vehicle = Vehicle { mass: 1e9, ..Vehicle::default() };
    let (length, angle) = (1.7f64, 1.2f64);
    let lift = Push { force: Vec3::up(vehicle.mass * vehicle.gravity), ..Push::default() };
    let sling = Sling { mass: 0.2, length, damping: 0.0 };
    let held =
        Conditions { hangs: true, sling, ..Conditions::new(&Reciprocals::new(&vehicle), &lift) };
    let mut actuation = coasting(&vehicle);
    let (sin, cos) = angle.sin_cos();
    let mut state = Whole {
        hanging: Hanging { place: world(sin, 0.0, -cos) * length, ..Hanging::default() },
        ..Whole::default()
    };
    let (mut crossings, mut last, h) = (Vec::new(), state.hanging.place.x, 1e-3);
    for tick in 1..20_000 {
        state = whole::advance(&state, h, 1, &vehicle, &mut actuation, &held);
        if state.hanging.place.x * last < 0.0 {
            let back = state.hanging.place.x / (state.hanging.place.x - last);
            crossings.push((tick as f64 - back) * h);
        }
        last = state.hanging.place.x;
    }
    let period = 2.0 * (crossings[6] - crossings[0]) / 6.0;
    let want = 4.0 * (length / vehicle.gravity).sqrt() * elliptic_k((angle / 2.0).sin().powi(2));
    assert!((period / want - 1.0).abs() < 1e-6, "{period} {want}");
}

#[test]
fn a_cable_only_exchanges_momentum_and_keeps_energy() {
    // Vehicle and load in free fall, without drag: the common centre falls like a stone.
    let vehicle = Vehicle::default();
    let sling = Sling { mass: 0.3, length: 1.0, damping: 0.0 };
    let held = Conditions {
        hangs: true,
        sling,
        ..Conditions::new(&Reciprocals::new(&vehicle), &Push::default())
    };
    let mut actuation = coasting(&vehicle);
    let mut state = Whole {
        hanging: Hanging { place: world(0.6, 0.0, -0.8), velocity: world(0.8, 2.0, 0.6) },
        ..Whole::default()
    };
    let centre = |s: &Whole<f64>| s.body.position + s.hanging.place * (0.3 / 0.925);
    let energy = |s: &Whole<f64>| {
        let Whole { body, hanging } = s;
        let cargo = body.velocity + hanging.velocity;
        let height = body.position.z * vehicle.mass + (body.position.z + hanging.place.z) * 0.3;
        0.5 * (vehicle.mass * body.velocity.norm_squared() + 0.3 * cargo.norm_squared())
            + vehicle.gravity * height
    };
    let drift = (state.hanging.velocity * (0.3 / 0.925), centre(&state), energy(&state));
    for _ in 0..1000 {
        state = whole::advance(&state, 1e-3, 1, &vehicle, &mut actuation, &held);
    }
    let want = drift.1 + drift.0 - Vec3::<f64, World>::up(0.5 * vehicle.gravity);
    assert!((centre(&state) - want).norm() < 1e-9, "{:?} {want:?}", centre(&state));
    assert!((energy(&state) / drift.2 - 1.0).abs() < 1e-9);
}

/// A hover on the ideal wrench with one disturbance from 0.5 s on.
fn hover_with(what: DisturbanceSettings, end: f64) -> Flight<f64> {
    hover_on("wrench", what, end)
}

/// The same on an actuation of this kind.
fn hover_on(actuation: &str, what: DisturbanceSettings, end: f64) -> Flight<f64> {
    let actuation = named(actuation);
    let scene = Scene { actuation, reference: named("hover"), ..Scene::default() };
    let mut flight = scene.calm().flight();
    let site = Site { vehicle: flight.vehicle, step: 1e-3, key: 1 };
    let window = Window { start: 0.5, end };
    flight.disturbance[1] = SourceSettings { window, what }.build(&site);
    flight.start(flight.state);
    flight
}

#[test]
fn a_cable_goes_slack_and_never_pushes() {
    let (sling, per_mass) = (Sling { mass: 0.5, length: 2.0, damping: 0.0 }, 1.0 / 1.5);
    let below = Hanging { place: world(0.0, 0.0, -2.0), velocity: Vec3::zero() };
    // Thrust accelerates the vehicle upwards by 12 m/s^2: T = (12 m/s^2)/(1/m + 1/m_c) = 4.5 N pulls it down.
    let pulled = hang(&below, world(0.0, 0.0, 12.0), per_mass, &sling);
    assert!((pulled.tension - 4.5).abs() < 1e-12 && (pulled.pull.z + 3.0).abs() < 1e-12);
    assert!(pulled.acceleration.norm() < 1e-12);
    // Pushed downwards it falls faster than the cargo, which is left to itself.
    let slack = hang(&below, world(0.0, 0.0, -3.0), per_mass, &sling);
    assert_eq!((slack.tension, slack.pull.norm()), (0.0, 0.0));
    assert!((slack.acceleration.z - 3.0).abs() < 1e-12);
}

#[test]
fn damping_across_a_cable_takes_the_swing_and_nothing_else() {
    let sling = Sling { mass: 0.5, length: 2.0, damping: 0.25 };
    let swinging = Hanging { place: world(0.0, 0.0, -2.0), velocity: world(3.0, 0.0, 0.0) };
    let hung = hang(&swinging, Vec3::zero(), 1.0 / 1.5, &sling);
    // c/m_c = 0.5 1/s against the swing; the centripetal acceleration v^2/L towards the vehicle.
    assert!((hung.acceleration - world(-1.5, 0.0, 4.5)).norm() < 1e-12, "{:?}", hung.acceleration);
}

#[test]
fn a_payload_weighs_what_it_weighs_and_leaves_no_trace() {
    for kind in ["wrench", "lagged-wrench", "rotors", "propulsion"] {
        let gains = payload::Gains { mass: 0.125, place: Vec3::zero() };
        let mut flight = hover_on(kind, DisturbanceSettings::Payload(gains, ()), 1.0);
        for tick in 0..1500 {
            let before = flight.disturbance;
            let decided = flight.decide();
            let a = flight.acceleration();
            let pushes = flight.attributed(before);
            let attached = (500..1000).contains(&tick);
            if tick == 500 {
                // Thrust still carries m g: (m + mp) a = -mp g.
                assert!((a.z + 9.8 * 0.125 / 0.75).abs() < 1e-12, "{kind}: {a:?}");
            }
            let want = if attached { -(a.z + 9.8) * 0.125 } else { 0.0 };
            assert!((pushes[1].force.z - want).abs() < 1e-12, "{kind}: tick {tick}");
            // The lumped disturbance is what the law's model misses, whoever made it.
            let missed = decided.disturbance.lumped - pushes[1].force;
            assert!(missed.norm() < 1e-9, "{kind}: tick {tick}, {missed:?}");
            flight.advance(&decided);
        }
        assert!((flight.body().mass - 0.625).abs() < 1e-15);
    }
}

#[test]
fn a_payload_beside_the_centre_tips_the_vehicle_and_adds_its_inertia() {
    let (mass, x) = (0.2, 0.05);
    let gains = payload::Gains { mass, place: body(x, 0.0, 0.0) };
    let mut flight = hover_with(DisturbanceSettings::Payload(gains, ()), 1e9);
    for _ in 0..500 {
        step(&mut flight);
    }
    let _ = flight.decide();
    let reduced = 0.625 * mass / (0.625 + mass);
    let inertia = flight.body().inertia;
    assert!((inertia.x - 2.6e-3).abs() < 1e-15);
    assert!((inertia.y - 2.4e-3 - reduced * x * x).abs() < 1e-15);
    assert!((inertia.z - 2.6e-3 - reduced * x * x).abs() < 1e-15);
    // Thrust m g through the rotors' centre, which lies behind the common centre by x mp/m'.
    let scenery = Scenery {
        vehicle: flight.body(),
        actuation: &flight.actuation,
        conditions: &flight.conditions,
    };
    let slope = scenery.slope(&Whole { body: flight.state, hanging: flight.hanging }).body;
    let want = 0.625 * 9.8 * x * mass / (0.625 + mass) / inertia.y;
    assert!((slope.rate.y / want - 1.0).abs() < 1e-9, "{} {want}", slope.rate.y);
}

#[test]
fn a_mass_that_hangs_at_rest_pulls_with_its_weight() {
    let gains = slung_mass::Gains { mass: 0.1, length: 1.0, damping: 0.2 };
    let mut flight = hover_with(DisturbanceSettings::SlungMass(gains, ()), 6.0);
    for tick in 0..8000 {
        let before = flight.disturbance;
        let decided = flight.decide();
        let pull = flight.attributed(before)[1].force;
        if tick == 5900 {
            assert!((pull - world(0.0, 0.0, -0.98)).norm() < 1e-3, "{pull:?}");
            assert!((decided.cargo - world(0.0, 0.0, -1.0)).norm() < 1e-3);
        }
        if tick >= 6000 {
            assert_eq!(pull.norm() + decided.cargo.norm(), 0.0, "dropped at 6 s");
        }
        assert!((decided.disturbance.lumped - pull).norm() < 1e-9, "tick {tick}");
        flight.advance(&decided);
    }
}

#[test]
fn nothing_in_the_world_costs_the_integrator_its_order() {
    // Everything at once, inputs held over one control tick; the substep is halved.
    let mut vehicle = Scene::default().vehicle;
    vehicle.rotor_drag = body(0.1, 0.15, 0.05);
    vehicle.body_drag = 0.02;
    vehicle.rate_drag_quadratic = Vec3::splat(1e-4);
    vehicle.rotor_inertia = 5e-6;
    vehicle.rotor_radius = 0.06;
    vehicle.inflow_loss = 1e-6;
    vehicle.flapping = 1e-7;
    vehicle.motor_lag_fall = 0.035;
    let mut base = named::<ActuationSettings>("propulsion").build(&vehicle);
    if let Actuation::Propulsion(rotors) = &mut base {
        rotors.commanded = [1500.0, 1400.0, 1450.0, 1600.0];
        rotors.rising = [1.0, 0.0, 0.0, 1.0];
        rotors.ground = -0.3;
    }
    let push = Push { force: world(0.3, -0.2, 0.1), torque: body(0.01, -0.02, 0.005) };
    let held = Conditions {
        airy: true,
        hangs: true,
        laden: true,
        wind: world(4.0, -2.0, 1.0),
        sling: Sling { mass: 0.1, length: 0.5, damping: 0.05 },
        share: 0.9,
        shift: body(0.005, -0.003, 0.01),
        ..Conditions::new(&Reciprocals::new(&vehicle), &push)
    };
    let start = Whole {
        body: State {
            velocity: world(1.0, 2.0, -0.5),
            rate: body(2.0, -3.0, 1.0),
            rotor_speed: [1450.0, 1500.0, 1480.0, 1440.0],
            ..State::default()
        },
        hanging: Hanging { place: world(0.3, 0.0, -0.4), velocity: world(0.4, 0.5, 0.3) },
    };
    let fly = |steps: u32| {
        let (mut actuation, h) = (base, 0.1 / f64::from(steps));
        (0..steps)
            .fold(start, |state, _| whole::advance(&state, h, 1, &vehicle, &mut actuation, &held))
    };
    let exact = fly(2048);
    let error = |steps: u32| {
        let state = fly(steps);
        let mut sum = 0.0;
        <Whole<f64> as Record<f64>>::zip([&state, &exact], &mut |[a, b]: [f64; 2]| {
            sum += (a - b) * (a - b);
            0.0
        });
        sum.sqrt()
    };
    let errors: Vec<f64> = [8, 16, 32, 64].into_iter().map(error).collect();
    let slope = (errors[0] / errors[3]).log2() / 3.0;
    assert!((slope - 4.0).abs() < 0.2, "order {slope}: {errors:?}");
}

#[test]
fn a_wind_that_meets_no_drag_is_still_recorded() {
    let mut flight = Scene::default().calm().flight();
    let wind = stormpetrel_plant::disturbance::wind::Gains { velocity: world(3.0, 0.0, 0.0) };
    flight.disturbance[0] = source(DisturbanceSettings::Wind(wind, ()), &flight.vehicle);
    flight.start(flight.state);
    let tick = flight.decide();
    assert_eq!((tick.air.wind.x, tick.air.force.norm()), (3.0, 0.0));
}
