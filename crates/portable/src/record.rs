//! Recordings of closed-loop flights for [`crate::replay`].

use stormpetrel_control::math::Vec3;
use stormpetrel_control::record::RecordExt as _;
use stormpetrel_control::signals::{Applied, Measurement, Wrench};
use stormpetrel_lab::scenario::Scenario;
use stormpetrel_plant::actuation::Actuate as _;
use stormpetrel_plant::flight::{Flight, Tick};

use crate::bytes::{Number, put};
use crate::recipe::Recipe;
use crate::replay::{Input, Recorder};

/// Ticks of each recording.
pub const TICKS: u32 = 2000;

/// The recording of a flight, in double and in single precision.
///
/// # Errors
/// Where the flight cannot be read, or the stack answers the recorder otherwise than in flight.
pub fn recording(recipe: &Recipe) -> Result<Vec<u8>, String> {
    let mut scenario = recipe.scenario()?;
    let inputs = inputs(&scenario).map_err(|error| format!("{}: {error}", recipe.name))?;
    let mut bytes = Vec::new();
    write::<f64>(&mut scenario, &inputs, &mut bytes);
    write::<f32>(&mut scenario, &inputs, &mut bytes);
    Ok(bytes)
}

/// What the stack was told at each tick of the flight.
fn inputs(scenario: &Scenario) -> Result<Vec<Input<f64>>, String> {
    let mut flight = scenario.flight();
    let mut alone = flight.stack;
    let mut inputs = Vec::new();
    for i in 0..TICKS {
        let measurement = measurement(&flight);
        let tick = flight.decide();
        let input = Input {
            measurement,
            trajectory: tick.reference,
            dt: flight.control_step,
            applied: applied(&flight, &tick),
        };
        // The proof that the recorder tells the stack what the closed loop tells it.
        let command = alone.update(&input.measurement, &input.trajectory, input.dt);
        alone.advance(&input.applied, input.dt);
        flight.advance(&tick);
        let (mut seen, mut flown) = (Vec::new(), Vec::new());
        for (record, into) in [(&command, &mut seen), (&tick.command, &mut flown)] {
            put(record, &mut |piece| into.extend_from_slice(piece));
        }
        for (stack, into) in [(&alone, &mut seen), (&flight.stack, &mut flown)] {
            put(stack, &mut |piece| into.extend_from_slice(piece));
        }
        if seen != flown {
            return Err(format!("tick {i}: the recorder tells the stack something else"));
        }
        inputs.push(input);
    }
    Ok(inputs)
}

/// What the closed loop measures.
fn measurement(flight: &Flight<f64>) -> Measurement<f64> {
    let state = flight.state;
    Measurement {
        position: state.position,
        velocity: state.velocity,
        attitude: state.attitude,
        rate: state.rate,
        achieved: Wrench {
            thrust: flight.actuation.thrust(&state),
            torque: flight.actuation.torque(&state),
        },
        unallocated: flight.unallocated,
    }
}

/// What the closed loop tells the observer after this tick.
fn applied(flight: &Flight<f64>, tick: &Tick<f64>) -> Applied<f64> {
    let weight = Vec3::up(flight.model.gravity);
    let thrust = flight.actuation.thrust_per_mass(&flight.state, &flight.vehicle);
    Applied {
        commanded: tick.command.thrust.force - weight,
        measured: thrust * (flight.vehicle.mass / flight.model.mass) - weight,
    }
}

fn write<T: Number>(scenario: &mut Scenario, inputs: &[Input<f64>], bytes: &mut Vec<u8>) {
    let mut stack = scenario.flight().stack.cast::<T>();
    let mut recorder = Recorder(|piece: &[u8]| bytes.extend_from_slice(piece));
    recorder.begin::<T>();
    recorder.block(&mut scenario.position);
    recorder.block(&mut scenario.observer);
    recorder.block(&mut scenario.attitude_reference);
    recorder.block(&mut scenario.attitude);
    recorder.block(&mut scenario.rate);
    recorder.start(&stack, TICKS);
    for input in inputs {
        recorder.tick(&mut stack, &input.cast());
    }
    recorder.end(&stack);
}
