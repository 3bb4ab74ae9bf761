//! Flights side by side: a flight that ends makes room for the next one.
//!
//! Flights of one structure share the registers. Each lane has its own beginning, end, step and numbers;
//! what it computes has the bits of a single flight, whoever its neighbours are.

use std::collections::VecDeque;

use stormpetrel_control::real::{Mask as _, Real};
use stormpetrel_control::record::RecordExt;
use stormpetrel_plant::dispatch::{Fleet, Registers, Width, Work};
use stormpetrel_plant::flight::Flight;

use crate::fly::{Outcome, Workspace, failure, setting};
use crate::metric::{Distribution, Setting, Sums, metrics};
use crate::scenario::Scenario;

/// Flies scenarios of one structure; outcomes in their order. Without `attitude` only the metrics of
/// the position are taken.
pub fn fly_alike(
    scenarios: &[&Scenario],
    width: Width,
    attitude: bool,
    workspace: &mut Workspace,
) -> Vec<Outcome> {
    deep(|| width.fly(Alike { scenarios, attitude, workspace }))
}

/// Does the work where there is room: without optimisation every function keeps copies of eight flights,
/// more than the stack of a thread holds.
#[cfg(all(debug_assertions, not(target_family = "wasm")))]
fn deep<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    const STACK: usize = 256 << 20;
    std::thread::scope(|scope| {
        let thread = std::thread::Builder::new().stack_size(STACK).spawn_scoped(scope, work);
        #[allow(clippy::expect_used)] // development builds only
        let thread = thread.expect("a thread for eight flights");
        thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    })
}

/// Does the work.
#[cfg(not(all(debug_assertions, not(target_family = "wasm"))))]
fn deep<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// Flights of one structure.
struct Alike<'a> {
    scenarios: &'a [&'a Scenario],
    attitude: bool,
    workspace: &'a mut Workspace,
}

impl Fleet for Alike<'_> {
    type Output = Vec<Outcome>;

    fn fly<T: Real<Scalar = f64>, const N: usize>(self, registers: impl Registers) -> Vec<Outcome> {
        let Self { scenarios, attitude, workspace } = self;
        let mut outcomes = vec![None; scenarios.len()];
        let mut waiting: VecDeque<usize> = (0..scenarios.len()).collect();
        let Some(first) = scenarios.first() else { return Vec::new() };
        let mut batch = Batch::<T, N>::new(first, attitude && first.has_attitude(), workspace);
        loop {
            batch.board(scenarios, &mut waiting);
            if batch.seats.iter().all(Option::is_none) && waiting.is_empty() {
                break;
            }
            registers.run(Segment(&mut batch));
            for (row, outcome) in batch.leave() {
                outcomes[row] = Some(outcome);
            }
        }
        outcomes.into_iter().flatten().collect()
    }
}

/// Who flies in a lane.
struct Seat {
    /// Position in the list.
    row: usize,
    /// Tick of the batch at which the flight is over.
    end: u64,
    distribution: Distribution,
}

/// Flights that share the lanes of one scalar.
#[derive(Clone, Copy)]
struct Group<T> {
    flight: Flight<T>,
    sums: Sums<T>,
    /// 1 where a lane is taken.
    taken: T,
}

struct Batch<'a, T, const N: usize> {
    groups: [Group<T>; N],
    settings: [Setting<T>; N],
    /// One for each lane, group after group.
    seats: Vec<Option<Seat>>,
    /// Left behind by flights that are over.
    distributions: &'a mut Vec<Distribution>,
    /// Tick at which a waiting flight can board.
    until: u64,
}

impl<'a, T: Real<Scalar = f64>, const N: usize> Batch<'a, T, N> {
    /// Empty lanes with the structure of this flight.
    fn new(scenario: &Scenario, attitude: bool, workspace: &'a mut Workspace) -> Self {
        let empty = Flight { alive: 0.0, ..scenario.flight() };
        let group = Group { flight: empty.everywhere(), sums: Sums::new(), taken: T::zero() };
        Self {
            groups: [group; N],
            settings: [Setting { has_attitude: attitude, ..setting(scenario) }; N],
            seats: (0..N * T::LANES).map(|_| None).collect(),
            distributions: &mut workspace.distributions,
            until: u64::MAX,
        }
    }

    /// Ticks since the batch began.
    fn now(&self) -> u64 {
        self.groups[0].flight.tick
    }

    /// Fills the empty lanes, where the slower loops begin their round.
    fn board(&mut self, scenarios: &[&Scenario], waiting: &mut VecDeque<usize>) {
        let (now, period) = (self.now(), self.groups[0].flight.period());
        self.until = u64::MAX;
        if !now.is_multiple_of(period) {
            if !waiting.is_empty() && self.seats.iter().any(Option::is_none) {
                self.until = now.next_multiple_of(period);
            }
            return;
        }
        for (place, seat) in self.seats.iter_mut().enumerate() {
            if seat.is_some() {
                continue;
            }
            let Some(row) = waiting.pop_front() else { return };
            let (scenario, lane) = (scenarios[row], place % T::LANES);
            let (group, own) =
                (&mut self.groups[place / T::LANES], &mut self.settings[place / T::LANES]);
            let flight = Flight { begin: now as f64, ..scenario.flight() };
            flight.put_lane(&mut group.flight, lane);
            Sums::<f64>::new().put_lane(&mut group.sums, lane);
            let Setting { dt, late, gravity, has_attitude } = setting(scenario);
            own.dt.set_lane(lane, dt);
            own.late.set_lane(lane, late);
            own.gravity.set_lane(lane, gravity);
            group.taken.set_lane(lane, 1.0);
            let mut distribution = self.distributions.pop().unwrap_or_default();
            distribution.clear(has_attitude && own.has_attitude);
            *seat = Some(Seat { row, end: now + scenario.ticks(), distribution });
        }
    }

    /// Empties the lanes whose flight is over.
    fn leave(&mut self) -> Vec<(usize, Outcome)> {
        let (now, mut left) = (self.now(), Vec::new());
        for (place, seat) in self.seats.iter_mut().enumerate() {
            let (group, lane) = (&mut self.groups[place / T::LANES], place % T::LANES);
            let over = |seat: &Seat| group.flight.alive.lane(lane) == 0.0 || seat.end <= now;
            let Some(seat) = seat.take_if(|seat| over(seat)) else { continue };
            group.taken.set_lane(lane, 0.0);
            group.flight.alive.set_lane(lane, 0.0);
            let flight: Flight<f64> = group.flight.pick_lane(lane);
            let outcome = Outcome {
                metrics: metrics(&group.sums.pick_lane(lane), &seat.distribution),
                failure: failure(flight.cause, flight.flown, flight.control_step),
            };
            left.push((seat.row, outcome));
            self.distributions.push(seat.distribution);
        }
        left
    }
}

/// The closed loop until the first flight of the batch is over, to be compiled for each width.
struct Segment<'a, 'b, T, const N: usize>(&'a mut Batch<'b, T, N>);

impl<T: Real<Scalar = f64>, const N: usize> Work for Segment<'_, '_, T, N> {
    type Output = ();

    #[inline(always)]
    fn run(self) {
        let Batch { groups: fleet, settings, seats, until, .. } = self.0;
        // A copy of what changes at every tick: what others may reach does not stay in registers.
        let mut groups = *fleet;
        for seat in seats.iter().flatten() {
            *until = seat.end.min(*until);
        }
        let until = *until;
        let mut all = true;
        for group in &groups {
            all &= group.flight.alive.eq(group.taken).all();
        }
        while all && groups[0].flight.tick < until {
            for k in 0..N {
                let Group { flight, sums, taken } = &mut groups[k];
                let tick = flight.decide();
                let errors = sums.push(&tick, &settings[k], flight.alive);
                for lane in 0..T::LANES {
                    if let Some(Some(seat)) = seats.get_mut(k * T::LANES + lane) {
                        seat.distribution.push(&errors.pick_lane(lane));
                    }
                }
                flight.advance(&tick);
                all &= flight.alive.eq(*taken).all();
            }
        }
        *fleet = groups;
    }
}
