//! A program that may panic: `cargo xtask symbols` must see it here, or it sees nothing anywhere.

#![no_std]
#![no_main]

use core::hint::black_box;

use cortex_m_rt::entry;
use stormpetrel_firmware::leave;

#[entry]
fn main() -> ! {
    let places = black_box([true, false]);
    leave(places[black_box(0)])
}
