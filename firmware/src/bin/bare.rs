//! The control stack and nothing else: `cargo xtask symbols` looks for panics and heap in it.

#![no_std]
#![no_main]

use cortex_m_rt::entry;
use stormpetrel_firmware::leave;
use stormpetrel_portable::exercise;

#[entry]
fn main() -> ! {
    exercise::double();
    exercise::single();
    leave(true)
}
