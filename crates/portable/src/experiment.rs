//! One number for everything that the project computes: the hash of all shipped flights.
//!
//! Every flight of every shipped scenario file counts with the first [`TICKS`] ticks, those in
//! [`WHOLE`] with all; of each tick every number that the log has, bit by bit. Each flight has a hash of
//! its own, so that a change shows where it acts. The same flights side by side, in eight lanes or in pairs,
//! with different numbers in the lanes where a structure has several flights, must give the same.

use stormpetrel_control::real::Real;
use stormpetrel_control::record::RecordExt;
use stormpetrel_lab::fly::fly;
use stormpetrel_lab::log::Hash;
use stormpetrel_lab::scenario::Scenario;
use stormpetrel_lab::shipped::{SHIPPED, shipped};
use stormpetrel_plant::dispatch::{Fleet, Registers, Width, Work};
use stormpetrel_plant::flight::Flight;

/// Ticks that count of a flight.
pub const TICKS: u32 = 2000;

/// Flights that count whole: a tame one, and one that amplifies every rounding error.
pub const WHOLE: [&str; 2] = ["article/consistent:single-measured", "article/literal:printed"];

/// A flight and the hash of its ticks.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Flown {
    /// Name of the flight.
    pub name: String,
    /// Ticks flown.
    pub ticks: u64,
    /// Hash of every number of every tick.
    pub hash: u64,
}

/// The flights that count, shortened.
///
/// # Errors
/// Where a shipped scenario cannot be read.
pub fn flights() -> Result<Vec<Scenario>, String> {
    let mut flights = Vec::new();
    for (name, _) in SHIPPED {
        let file = shipped(name).ok_or_else(|| format!("{name}: not shipped"))?;
        flights.extend(file.map_err(|faults| format!("{name}: {faults:?}"))?.scenarios);
    }
    for whole in WHOLE {
        if !flights.iter().any(|scenario| scenario.name == whole) {
            return Err(format!("no shipped flight is called {whole}"));
        }
    }
    for Scenario { name, run, .. } in &mut flights {
        let longest = f64::from(TICKS) * run.control_step;
        if !WHOLE.contains(&name.as_str()) && run.duration > longest {
            run.duration = longest;
        }
    }
    Ok(flights)
}

/// Flies one after the other.
pub fn alone(flights: &[Scenario]) -> Vec<Flown> {
    let one = |scenario: &Scenario| {
        let (mut hash, mut ticks) = (Hash::default(), 0);
        fly(scenario, |tick, _| {
            hash.push(tick);
            ticks += 1;
        });
        Flown { name: scenario.name.clone(), ticks, hash: hash.value() }
    };
    flights.iter().map(one).collect()
}

/// Flies flights of one structure side by side in registers of this width. Where there are fewer than lanes,
/// doubles of the last fill them.
pub fn side_by_side(flights: &[Scenario], width: Width) -> Vec<Flown> {
    let mut flown = width.fly(SideBySide(flights));
    let place = |done: &Flown| flights.iter().position(|scenario| scenario.name == done.name);
    flown.sort_by_key(place);
    flown
}

struct SideBySide<'a>(&'a [Scenario]);

impl Fleet for SideBySide<'_> {
    type Output = Vec<Flown>;

    fn fly<T: Real<Scalar = f64>, const N: usize>(self, registers: impl Registers) -> Vec<Flown> {
        let mut waiting: Vec<&Scenario> = self.0.iter().collect();
        let mut flown = Vec::new();
        while let Some(first) = waiting.first() {
            let structure = first.structure();
            let (mut group, mut others): (Vec<&Scenario>, Vec<&Scenario>) =
                waiting.iter().partition(|scenario| scenario.structure() == structure);
            others.splice(0..0, group.split_off(group.len().min(T::LANES)));
            flown.extend(registers.run(Batch::<T>::new(&group)));
            waiting = others;
        }
        flown
    }
}

#[derive(Default)]
struct Hashed {
    name: String,
    ticks: u64,
    hash: Hash,
}

/// The closed loop over a batch, to be compiled for each width.
struct Batch<T> {
    flight: Flight<T>,
    ticks: u64,
    hashed: Vec<Hashed>,
}

impl<T: Real<Scalar = f64>> Batch<T> {
    /// These flights, and doubles of the last in the lanes that are left.
    fn new(group: &[&Scenario]) -> Self {
        let row = |lane: usize| group[if lane < group.len() { lane } else { group.len() - 1 }];
        let blank =
            |scenario: &&Scenario| Hashed { name: scenario.name.clone(), ..Hashed::default() };
        let mut flight: Flight<T> = row(0).flight().everywhere();
        for lane in 1..T::LANES {
            row(lane).flight().put_lane(&mut flight, lane);
        }
        Self { flight, ticks: row(0).ticks(), hashed: group.iter().map(blank).collect() }
    }
}

impl<T: Real<Scalar = f64>> Work for Batch<T> {
    type Output = Vec<Flown>;

    #[inline(always)]
    fn run(mut self) -> Vec<Flown> {
        for _ in 0..self.ticks {
            let tick = self.flight.decide();
            let mut any = false;
            for (lane, hashed) in self.hashed.iter_mut().enumerate() {
                if self.flight.alive.lane(lane) > 0.0 {
                    hashed.hash.push(&tick.pick_lane(lane));
                    hashed.ticks += 1;
                    any = true;
                }
            }
            if !any {
                break;
            }
            self.flight.advance(&tick);
        }
        let done = |Hashed { name, ticks, hash }| Flown { name, ticks, hash: hash.value() };
        self.hashed.into_iter().map(done).collect()
    }
}

/// One hash of all: FNV-1a over names, ticks and hashes.
pub fn total(flown: &[Flown]) -> u64 {
    let mut state: u64 = 0xCBF2_9CE4_8422_2325;
    let mut take = |word: u64| state = (state ^ word).wrapping_mul(0x0100_0000_01B3);
    for Flown { name, ticks, hash } in flown {
        name.bytes().for_each(|byte| take(byte.into()));
        take(*ticks);
        take(*hash);
    }
    state
}

/// The hash of all shipped flights.
///
/// # Errors
/// As [`flights`].
pub fn experiment_hash() -> Result<u64, String> {
    Ok(total(&alone(&flights()?)))
}

/// The text of `scenarios/experiment.hash`: the hash of all, then each flight with its ticks.
pub fn text(flown: &[Flown]) -> String {
    let lines: String = flown.iter().map(line).collect();
    format!("{:016x} all\n{lines}", total(flown))
}

fn line(Flown { name, ticks, hash }: &Flown) -> String {
    format!("{hash:016x} {name} {ticks}\n")
}

/// The flights that such a text does not have with the same hash, in words; `None` where there is none.
pub fn changed(expected: &str, flown: &[Flown]) -> Option<String> {
    let known = |flown: &Flown| expected.lines().any(|old| old == line(flown).trim_end());
    let changed: Vec<String> = flown.iter().filter(|flown| !known(flown)).map(line).collect();
    let first = changed.first()?;
    Some(format!("{} of {} flights differ, the first: {first}", changed.len(), flown.len()))
}
