//! Replays a recorded flight on the microcontroller: every bit of every command, double and single.

#![no_std]
#![no_main]

use cortex_m_rt::entry;
use cortex_m_semihosting::hprintln;
use stormpetrel_firmware::leave;
use stormpetrel_portable::replay::{Failure, replay_both};

static RECORDING: &[u8] = include_bytes!(env!("STORMPETREL_RECORDING"));

#[entry]
fn main() -> ! {
    let result = replay_both(RECORDING, &mut |text| hprintln!("{}", text));
    match result {
        Ok([double, single]) => {
            hprintln!("f64 {} ticks, f32 {} ticks: the same bits", double, single);
        }
        Err(Failure::Unreadable) => hprintln!("the recording cannot be read"),
        Err(Failure::Differs { tick, numbers }) => {
            hprintln!("after {} equal ticks {} numbers differ", tick, numbers);
        }
    }
    leave(result.is_ok())
}
