//! What a reference needs, against closed forms and against a flight along it.
// Tests compare bits, take the standard library as their second opinion, and print figures as their
// source prints them.
#![allow(clippy::pedantic, clippy::disallowed_methods, clippy::approx_constant, clippy::float_cmp)]

use std::f64::consts::PI;

use stormpetrel_control::math::Vec3;
use stormpetrel_control::signals::Trajectory;
use stormpetrel_lab::feasible::{Demand, Feasibility, course, feasible};
use stormpetrel_lab::fly::fly;
use stormpetrel_lab::preview::{drawings, html};
use stormpetrel_lab::scenario::{Scenario, load_text};
use stormpetrel_lab::shipped::shipped;

fn scenario(reference: &str, actuation: &str) -> Scenario {
    let text = format!(
        "run = {{ duration = 10.0, control_step = 0.001 }}
vehicle = {{ model = \"article-corrected\" }}
reference = {{ {reference} }}
position = {{ law = \"pid\", kp = 6.0, ki = 2.0, kd = 4.0 }}
attitude_reference = {{ law = \"rotation\" }}
attitude = {{ law = \"tilt-priority\" }}
rate = {{ law = \"indi\" }}
actuation = {{ kind = \"{actuation}\" }}"
    );
    let file = load_text("test", "test.toml", text, &[]).unwrap_or_else(|f| panic!("{f}"));
    file.scenarios.into_iter().next().expect("a flight")
}

fn worst(judged: &Feasibility, name: &str) -> f64 {
    judged.get(name).unwrap_or_else(|| panic!("no {name}")).worst
}

#[test]
fn hovering_needs_the_weight_and_nothing_else() {
    let scenario = scenario("shape = \"hover\"", "rotors");
    let vehicle = &scenario.vehicle.vehicle;
    let judged = feasible(&scenario);
    assert!((worst(&judged, "thrust") - vehicle.mass * vehicle.gravity).abs() < 1e-12);
    assert!((worst(&judged, "rotor speed") - vehicle.hover_speed()).abs() < 1e-9);
    assert!((worst(&judged, "rotor speed, least") - vehicle.hover_speed()).abs() < 1e-9);
    for name in ["tilt", "body rate", "torque"] {
        assert_eq!(worst(&judged, name), 0.0, "{name}");
    }
    assert_eq!(judged.broken().count(), 0);
    // Half way between 150 and 2917 rad/s, nearly.
    let margin = judged.get("rotor speed").and_then(|q| q.margin).expect("a limit");
    assert!((margin - (2917.0 - vehicle.hover_speed()) / (2917.0 - 150.0)).abs() < 1e-12);
}

#[test]
fn a_circle_needs_the_tilt_of_its_speed_and_radius() {
    let circle = |speed: f64| {
        let text = format!("shape = \"circle\", radius = 2.0, speed = {speed}, ramp = 0");
        feasible(&scenario(&text, "rotors"))
    };
    for speed in [1.0, 3.0, 5.0] {
        let judged = circle(speed);
        let inwards = speed * speed / 2.0;
        assert!((worst(&judged, "tilt") - (inwards / 9.8).atan()).abs() < 1e-12);
        assert!((worst(&judged, "thrust") - 0.625 * inwards.hypot(9.8)).abs() < 1e-12);
        // The thrust axis goes round a cone once a lap, the heading is held.
        let tilt = (inwards / 9.8).atan();
        let turning = speed / 2.0 * tilt.sin();
        assert!(worst(&judged, "body rate") >= turning * (1.0 - 1e-9));
        assert_eq!(judged.broken().count(), 0, "{speed} m/s");
    }
}

#[test]
fn a_turn_with_the_nose_ahead_needs_the_torque_that_turns_the_spin() {
    // The body turns about the vertical at w, which stands still in it: tau = omega x I omega, about the
    // forward axis (I_z - I_y) w^2 sin(tilt) cos(tilt).
    let text = "shape = \"circle\", radius = 2.0, speed = 5.0, heading = \"along\", ramp = 0";
    let scenario = scenario(text, "rotors");
    let (w, tilt) = (2.5f64, (12.5f64 / 9.8).atan());
    let inertia = scenario.vehicle.vehicle.inertia;
    let want = (inertia.z - inertia.y) * w * w * tilt.sin() * tilt.cos();
    let judged = feasible(&scenario);
    assert!((worst(&judged, "torque") - want).abs() < 1e-12, "{want}");
    assert!((worst(&judged, "body rate") - w).abs() < 1e-12);
    assert!(worst(&judged, "ang. accel.") < 1e-12);
}

#[test]
fn a_rotor_that_would_have_to_pull_has_a_negative_speed() {
    let vehicle = scenario("shape = \"hover\"", "rotors").vehicle.vehicle;
    let snap = Vec3::new(5000.0, 0.0, 0.0);
    let demand = Demand::new(&vehicle, 0.0, Trajectory { snap, ..Trajectory::default() });
    // Pitching forwards at snap/g: the front rotor (1) pulls, the rear one (3) pushes, u = m g/4 -+ tau/(2 l).
    let torque = vehicle.inertia.y * 5000.0 / 9.8;
    let share = torque / (2.0 * vehicle.arm);
    let [front, _, rear, _] = demand.rotor_thrust;
    assert!((front - (0.625 * 9.8 / 4.0 - share)).abs() < 1e-12 && front < 0.0);
    assert!((rear - (0.625 * 9.8 / 4.0 + share)).abs() < 1e-12);
    let [front_speed, _, rear_speed, _] = demand.rotor_speed;
    assert!((front_speed + (-front / 7.2e-7).sqrt()).abs() < 1e-9);
    assert!((rear_speed - (rear / 7.2e-7).sqrt()).abs() < 1e-9);
}

#[test]
fn an_impossible_circle_is_reported_from_the_moment_that_it_is() {
    let text = "shape = \"circle\", radius = 2.0, speed = 12.0, ramp = 4.0";
    let judged = feasible(&scenario(text, "rotors"));
    let thrust = judged.get("thrust").expect("a thrust");
    let highest: f64 = 4.0 * 7.2e-7 * 2917.0 * 2917.0;
    assert!((thrust.limit.expect("a limit") - highest).abs() < 1e-9);
    assert!(thrust.margin.expect("a margin") < 0.0);
    let (from, to) = thrust.beyond[0];
    assert_eq!((thrust.beyond.len(), to), (1, 10.0));
    // Inside the ramp: where the acceleration of the circle, tangent and normal, is too much.
    let needed = |t: f64| {
        let u: f64 = (t / 4.0).min(1.0);
        let speed =
            12.0 * (35.0 * u.powi(4) - 84.0 * u.powi(5) + 70.0 * u.powi(6) - 20.0 * u.powi(7));
        let along = 12.0 * 140.0 * (u * (1.0 - u)).powi(3) / 4.0;
        0.625 * (along.hypot(speed * speed / 2.0)).hypot(9.8)
    };
    assert!(needed(from) > highest && needed(from - 1e-3) <= highest, "{from}");
    let warnings = judged.warnings();
    assert!(
        warnings[0].starts_with("thrust ") && warnings[0].contains("to 10.00 s"),
        "{warnings:?}"
    );
    assert_eq!(warnings.len(), judged.broken().count());
}

#[test]
fn falling_faster_than_gravity_asks_for_thrust_that_is_not_there() {
    // z'' down to -2 g and back: the thrust passes through zero, twice each swing.
    let text = "shape = \"lissajous\", amplitude = [0, 0, 4.9], frequency = 2.0, ramp = 0";
    let judged = feasible(&scenario(text, "rotors"));
    let least = judged.get("thrust, least").expect("a least thrust");
    assert!(least.worst < 0.0648 && least.beyond.len() > 5, "{least:?}");
    assert!((worst(&judged, "tilt") - PI).abs() < 1e-9, "upside down in between");
    assert!(judged.get("rotor speed, least").is_some_and(|q| !q.beyond.is_empty()));
}

#[test]
fn without_rotors_nothing_is_limited() {
    let text = "shape = \"circle\", radius = 2.0, speed = 20.0";
    let judged = feasible(&scenario(text, "wrench"));
    assert!(judged.quantities.iter().all(|q| q.limit.is_none() && q.beyond.is_empty()));
    let judged = feasible(&scenario(text, "lagged-wrench"));
    assert!((worst(&judged, "tilt") - (200.0f64 / 9.8).atan()).abs() < 0.01);
}

#[test]
fn a_flight_along_the_reference_uses_what_was_foretold() {
    let file = shipped("references/lemniscate").expect("shipped").expect("good");
    let mut scenario = file.scenarios.into_iter().next().expect("a flight");
    scenario.run.duration = 6.0;
    let needed = course(&scenario, 6001);
    let (mut i, mut furthest, mut span) = (0, 0.0f64, 0.0f64);
    fly(&scenario, |tick, _| {
        assert!((needed[i].time - tick.time).abs() < 1e-12);
        for (flown, foretold) in tick.rotor_speed.iter().zip(needed[i].rotor_speed) {
            furthest = furthest.max((flown - foretold).abs());
            span = span.max((foretold - 1458.0).abs());
        }
        i += 1;
    });
    assert_eq!(i, 6000);
    assert!(span > 60.0, "the rotors are asked for something: {span}");
    assert!(furthest < 0.15 * span, "{furthest} of {span}");
}

#[test]
fn a_long_flight_is_looked_at_from_start_to_end_in_a_bounded_number_of_moments() {
    let mut scenario = scenario("shape = \"helix\"", "rotors");
    for (duration, count) in [(10.0, 10_001), (25.0, 12_501), (1234.567, 20_000)] {
        scenario.run.duration = duration;
        let course = course(&scenario, 20_000);
        assert!(course.len() <= 20_000 && course.len() + 500 >= count, "{}", course.len());
        assert_eq!(course[0].time, 0.0);
        assert!((course[course.len() - 1].time - duration).abs() < 1e-9);
    }
}

#[test]
fn a_preview_has_every_figure_and_one_page() {
    let file = shipped("references/race").expect("shipped").expect("good");
    let scenario = &file.scenarios[0];
    let drawings = drawings(scenario);
    let names: Vec<&str> = drawings.iter().map(|drawing| drawing.name).collect();
    assert_eq!(names, ["preview-path", "preview-motion", "preview-demand", "preview-rotors"]);
    assert!(drawings.iter().all(|d| d.svg.ends_with("</svg>\n") && !d.svg.contains("NaN")));
    let judged = feasible(scenario);
    let page = html("a < b", &[(scenario, &judged, drawings)]);
    assert_eq!(page.matches("<svg").count(), 4);
    assert!(page.contains("a &lt; b") && page.ends_with("</html>\n") && !page.contains("src="));
}

#[test]
fn a_preview_shows_of_a_disturbance_what_lies_in_the_flight() {
    let steps = |windows: &str| {
        let text = format!(
            "run = {{ duration = 10.0 }}
vehicle = {{ model = \"article-corrected\" }}
reference = {{ shape = \"hover\" }}
position = {{ law = \"pid\" }}
actuation = {{ kind = \"thrust-vector\" }}
{windows}"
        );
        let file = load_text("test", "test.toml", text, &[]).unwrap_or_else(|f| panic!("{f}"));
        file.scenarios.into_iter().next().expect("a flight")
    };
    let late = "[[disturbance]]\nkind = \"step\"\nforce = 1.0\nstart = 50.0\n";
    let long = "[[disturbance]]\nkind = \"step\"\nforce = 1.0\nstart = 4.0\nend = 90.0\n";
    let both = steps(&format!("{late}{long}"));
    let idle = "`disturbance.0` (step) never acts: it starts at 50 s, the flight ends at 10 s";
    assert_eq!(both.idle(), [idle]);
    let drawn = drawings(&both);
    let drawn = drawn.iter().find(|d| d.name == "preview-disturbance").expect("a figure");
    assert!(drawn.svg.contains(">0 step (not in this flight)<") && drawn.svg.contains(">1 step<"));
    assert!(drawn.svg.contains(">10<") && !drawn.svg.contains(">20<"), "the flight ends at 10 s");
    assert!(drawn.svg.contains(">disturbance<") && !drawn.svg.contains(">number<"));
    assert!(steps(long).idle().is_empty());
}
