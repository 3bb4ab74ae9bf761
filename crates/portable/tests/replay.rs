//! Recordings hold every registered law, give the same bits when replayed, and betray a single bit.
// Tests take the shortest way to a number.
#![allow(clippy::pedantic)]
#![cfg(feature = "experiment")]

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::record::Record;
use stormpetrel_control::stack::Command;
use stormpetrel_portable::bytes::put;
use stormpetrel_portable::recipe::{RECORDED, Recipe, blocks, recipes};
use stormpetrel_portable::record::{TICKS, recording};
use stormpetrel_portable::replay::{Failure, Input, replay_both};

/// The replay of a recording, and what it says about the first difference.
fn replayed(bytes: &[u8]) -> (Result<[u32; 2], Failure>, String) {
    let mut said = String::new();
    let result = replay_both(bytes, &mut |text| said += &text.to_string());
    (result, said)
}

#[test]
fn every_registered_law_is_recorded() {
    let recipes = recipes().expect("recipes");
    assert!(recipes.len() >= RECORDED.len());
    let flown: Vec<_> = recipes.iter().map(|r| blocks(&r.scenario().expect("scenario"))).collect();
    for place in 0..5 {
        for law in flown[0][place].registered {
            let key = flown[0][place].key;
            assert!(flown.iter().any(|blocks| blocks[place].law == *law), "{key}: {law}");
        }
    }
}

#[test]
fn every_recording_replays_with_the_same_bits() {
    for recipe in recipes().expect("recipes") {
        let bytes = recording(&recipe).expect("recording");
        assert_eq!(replayed(&bytes), (Ok([TICKS; 2]), String::new()), "{}", recipe.name);
    }
}

/// A recording, and where the parts of its first half begin, the one in double precision.
struct Parts {
    bytes: Vec<u8>,
    /// The first tick, and each other one so many bytes later.
    ticks: usize,
    tick: usize,
    /// The answers, counted from the beginning of a tick.
    answers: usize,
    /// The final state.
    end: usize,
}

impl Parts {
    fn of(recipe: &Recipe) -> Self {
        let bytes = recording(recipe).expect("recording");
        let half = 1 + bytes[1..].windows(8).position(|w| w == &bytes[..8]).expect("second half");
        let stack = size(&recipe.scenario().expect("scenario").flight().stack);
        let answers = size(&Input::<f64>::default());
        let tick =
            answers + size(&Command::<f64>::default()) + size(&Vec3::<f64, World>::default());
        let end = half - stack;
        Self { bytes, ticks: end - TICKS as usize * tick, tick, answers, end }
    }

    /// What the replay says once this bit is another; afterwards it is as it was.
    fn flipped(&mut self, byte: usize, bit: u8) -> (Result<[u32; 2], Failure>, String) {
        self.bytes[byte] ^= 1 << bit;
        let result = replayed(&self.bytes);
        self.bytes[byte] ^= 1 << bit;
        result
    }
}

fn size(record: &impl Record<f64>) -> usize {
    let mut size = 0;
    put(record, &mut |piece| size += piece.len());
    size
}

#[test]
fn every_bit_of_an_answer_counts() {
    let mut parts = Parts::of(&recipes().expect("recipes")[0]);
    for byte in parts.ticks + parts.answers..parts.ticks + parts.tick {
        for bit in 0..8 {
            let (result, said) = parts.flipped(byte, bit);
            assert_eq!(result, Err(Failure::Differs { tick: 0, numbers: 1 }), "{byte}, {bit}");
            assert!(said.starts_with("f64 ") && said.contains("recorded"), "{said}");
        }
    }
}

#[test]
fn a_flipped_bit_is_noticed_in_its_tick() {
    let mut parts = Parts::of(&recipes().expect("recipes")[0]);
    let differs = |tick| Err(Failure::Differs { tick, numbers: 1 });
    for tick in [1, 1000, TICKS - 1] {
        let place = parts.ticks + tick as usize * parts.tick + parts.answers;
        let (result, said) = parts.flipped(place, 0);
        assert_eq!(result, differs(tick));
        assert!(said.starts_with("f64 thrust.force.x: "), "{said}");
    }
    assert_eq!(parts.flipped(parts.end, 0).0, differs(TICKS));
    let (result, said) = parts.flipped(parts.bytes.len() - 1, 7);
    assert_eq!(result, differs(TICKS));
    assert!(said.starts_with("f32 "), "{said}");
}

#[test]
fn a_bit_of_what_the_laws_are_told_is_noticed() {
    let mut parts = Parts::of(&recipes().expect("recipes")[0]);
    // The height, in the measurement of a tick: its last bit moves the thrust.
    let place = parts.ticks + 700 * parts.tick + 2 * 8;
    let (result, _) = parts.flipped(place, 3);
    assert!(matches!(result, Err(Failure::Differs { tick: 700, .. })), "{result:?}");
}

#[test]
fn a_damaged_recording_is_refused() {
    let mut parts = Parts::of(&recipes().expect("recipes")[0]);
    // The mark, the precision, the name of a law.
    for byte in [0, 8, 10] {
        assert_eq!(parts.flipped(byte, 0).0, Err(Failure::Unreadable), "{byte}");
    }
    let whole = parts.bytes.len();
    for cut in [0, 9, parts.ticks, parts.ticks + 1, parts.end] {
        assert!(replayed(&parts.bytes[..cut]).0.is_err(), "{cut}");
    }
    assert!(replayed(&parts.bytes[..whole - 1]).0.is_err());
    parts.bytes.push(0);
    assert_eq!(replayed(&parts.bytes).0, Err(Failure::Unreadable));
}
