//! How fast: prints the tables of `docs/benchmarks.md`. Run through `cargo xtask bench`.

use std::hint::black_box;
use std::time::Instant;

use stormpetrel_control::attitude::AttitudeLawSettings;
use stormpetrel_control::attitude_reference::AttitudeReferenceSettings;
use stormpetrel_control::controller::Controller;
use stormpetrel_control::guard::{Guarded, GuardedObserver};
use stormpetrel_control::lanes::Lanes;
use stormpetrel_control::math::Vec3;
use stormpetrel_control::observer::{Observer, ObserverSettings};
use stormpetrel_control::position::PositionSettings;
use stormpetrel_control::rate::RateLawSettings;
use stormpetrel_control::real::Real;
use stormpetrel_control::record::{Record, RecordExt};
use stormpetrel_control::registry::Settings;
use stormpetrel_control::signals::{Applied, Measurement, Model};
use stormpetrel_lab::fly::{LANES, fly, fly_batch_at};
use stormpetrel_lab::scenario::Scenario;
use stormpetrel_lab::shipped::shipped;
use stormpetrel_plant::actuation::ActuationSettings;
use stormpetrel_plant::actuation::propulsion::Supply;
use stormpetrel_plant::dispatch::{Fleet, Registers, Width, Work};
use stormpetrel_plant::disturbance::SourceSettings;
use stormpetrel_plant::dynamics::{Held, Push};
use stormpetrel_plant::flight::Flight;
use stormpetrel_plant::sensor::SensorSettings;

const TICKS: u64 = 20_000;

/// Steps without log or metrics; flights take turns.
struct Steps<'a, T, const N: usize> {
    flights: &'a [Flight<T>; N],
    ticks: u64,
}

impl<T: Real, const N: usize> Work for Steps<'_, T, N> {
    type Output = [T; N];
    #[inline(always)]
    fn run(self) -> [T; N] {
        let mut flights = *self.flights;
        for _ in 0..self.ticks {
            for k in 0..N {
                let flight = &mut flights[k];
                let tick = flight.decide();
                flight.advance(&tick);
            }
        }
        flights.map(|flight| flight.state.position.x)
    }
}

/// [`Steps`] of one vehicle; compiled once.
#[inline(never)]
fn alone(flight: &Flight<f64>, ticks: u64) -> [f64; 1] {
    Steps { flights: std::array::from_ref(flight), ticks }.run()
}

/// [`Steps`] of eight vehicles that are all like this one.
struct EightAlike<'a> {
    flight: &'a Flight<f64>,
    ticks: u64,
}

impl Fleet for EightAlike<'_> {
    type Output = ();
    fn fly<T: Real<Scalar = f64>, const N: usize>(self, registers: impl Registers) {
        let flights: [Flight<T>; N] = [self.flight.everywhere(); N];
        for _ in 0..LANES / (N * T::LANES) {
            black_box(registers.run(Steps { flights: &flights, ticks: self.ticks }));
        }
    }
}

/// [`Steps`] of eight vehicles at this width; compiled once for each.
#[inline(never)]
fn eight(width: Width, flight: &Flight<f64>, ticks: u64) {
    width.fly(EightAlike { flight, ticks });
}

/// Nanoseconds for one of `count` items: the best of at least five runs and a fifth of a second, in which
/// the processor has time to reach its speed.
fn best(count: u64, mut work: impl FnMut()) -> f64 {
    let (start, mut best, mut runs) = (Instant::now(), f64::INFINITY, 0);
    while runs < 5 || start.elapsed().as_secs_f64() < 0.5 {
        let begin = Instant::now();
        work();
        best = Real::min(best, begin.elapsed().as_secs_f64() * 1e9 / count as f64);
        runs += 1;
    }
    best
}

fn scenario(name: &str) -> Scenario {
    let (file, variant) = name.split_once(':').unwrap_or((name, ""));
    let file = shipped(file).and_then(Result::ok).unwrap_or_else(|| panic!("no scenario {name}"));
    let mut all = file.scenarios.into_iter();
    all.find(|s| variant.is_empty() || s.name == name)
        .unwrap_or_else(|| panic!("no variant {name}"))
}

#[allow(clippy::print_stdout)] // the tables are what this program makes
fn say(line: &str) {
    println!("{line}");
}

/// A guarded law, asked again and again. Lanes take a `COPY` of what comes in, as a flight has its own:
/// numbers that another pointer could reach, no compiler takes eight at a time.
struct Updates<'a, T: Real, L: Controller<T>, const COPY: bool> {
    law: L,
    reference: &'a L::Reference,
    dt: T,
}

impl<T: Real, L: Controller<T>, const COPY: bool> Work for Updates<'_, T, L, COPY>
where
    L::Command: Default,
{
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let mut law = Guarded::new(self.law, L::Command::default());
        let measurement = Measurement::<T>::default();
        law.reset(&measurement);
        for _ in 0..TICKS {
            let (measurement, reference) = (black_box(&measurement), black_box(self.reference));
            black_box(if COPY {
                let (measurement, reference) = (*measurement, *reference);
                law.update(&measurement, &reference, self.dt)
            } else {
                law.update(measurement, reference, self.dt)
            });
        }
    }
}

/// An observer, told and asked again and again; `COPY` as for [`Updates`].
struct Corrections<T, const COPY: bool>(Observer<T>, T);

impl<T: Real, const COPY: bool> Work for Corrections<T, COPY> {
    type Output = ();
    #[inline(always)]
    fn run(self) {
        let (mut observer, dt) = (GuardedObserver::new(self.0), self.1);
        let measurement = Measurement::<T>::default();
        let mut applied = Applied::<T>::default();
        applied.measured.x = T::lit(0.1);
        for _ in 0..TICKS {
            let (measurement, applied) = (black_box(&measurement), black_box(&applied));
            if COPY {
                let (measurement, applied) = (*measurement, *applied);
                observer.correct(&measurement, dt);
                observer.advance(&applied, dt);
            } else {
                observer.correct(measurement, dt);
                observer.advance(applied, dt);
            }
            black_box(observer.estimate());
        }
    }
}

/// The row of a block: one vehicle, and eight lanes on the widest registers.
fn block(kind: &str, name: &str, alone: impl FnMut(), lanes: impl FnMut()) {
    let (single, wide) = (best(TICKS, alone), best(TICKS * LANES as u64, lanes));
    say(&format!("| {kind} `{name}` | {single:.1} | {wide:.1} | {:.1} times |", single / wide));
}

fn law<L, W>(kind: &str, name: &str, law: L, reference: L::Reference)
where
    L: Controller<f64> + Record<f64, With<Eight> = W>,
    L::Command: Default,
    L::Reference: Record<f64, With<Eight> = W::Reference>,
    W: Controller<Eight>,
    W::Command: Default,
{
    let (laws, references): (W, _) =
        (RecordExt::gather([&law; LANES]), RecordExt::gather([&reference; LANES]));
    block(
        kind,
        name,
        || Updates::<_, _, false> { law, reference: &reference, dt: 1e-3 }.run(),
        || {
            Width::widest().run(Updates::<_, _, true> {
                law: laws,
                reference: &references,
                dt: Eight::lit(1e-3),
            });
        },
    );
}

fn laws() {
    let widest = Width::widest().name();
    say(&format!(
        "| law (guarded) | ns per update alone | in eight lanes, {widest}, with a copy of the inputs | against alone |\n|---|---|---|---|"
    ));
    let model = Model::default();
    let mut thrust = stormpetrel_control::signals::Thrust::<f64>::default();
    thrust.force.z = 9.8;
    for name in PositionSettings::NAMES {
        let made = PositionSettings::named(name).map(|s| s.build(&model));
        law("position", name, made.unwrap_or_default(), Default::default());
    }
    for name in AttitudeReferenceSettings::NAMES {
        let made = AttitudeReferenceSettings::named(name).map(|s| s.build(&model));
        law("attitude_reference", name, made.unwrap_or_default(), thrust);
    }
    for name in AttitudeLawSettings::NAMES {
        let made = AttitudeLawSettings::named(name).map(|s| s.build(&model));
        law("attitude", name, made.unwrap_or_default(), Default::default());
    }
    for name in RateLawSettings::NAMES {
        let made = RateLawSettings::named(name).map(|s| s.build(&model));
        law("rate", name, made.unwrap_or_default(), Default::default());
    }
    for name in ObserverSettings::NAMES {
        let made = ObserverSettings::named(name).map(|s| s.build(&model)).unwrap_or_default();
        let all: Observer<Eight> = RecordExt::<f64>::gather([&made; LANES]);
        block(
            "observer",
            name,
            || Corrections::<_, false>(made, 1e-3).run(),
            || Width::widest().run(Corrections::<_, true>(all, Eight::lit(1e-3))),
        );
    }
}

/// One block of the closed loop: single, and eight vehicles at each width.
fn closed_loop(name: &str) {
    let one = scenario(name);
    let flight = one.flight();
    let single = best(TICKS, || {
        black_box(alone(&flight, TICKS));
    });
    let with_metrics = best(TICKS, || {
        black_box(fly(&one, |_, _| {}));
    });
    say(&format!("\n`{name}`: ns per closed-loop step of one vehicle\n"));
    say("| how | loop | against single | with metrics | against single |\n|---|---|---|---|---|");
    say(&format!("| single | {single:.1} | 1 | {with_metrics:.1} | 1 |"));
    let batch: Vec<Scenario> = (0..LANES).map(|_| one.clone()).collect();
    for width in Width::available() {
        let lanes = best(TICKS * LANES as u64, || {
            eight(width, &flight, TICKS);
        });
        let measured = best(TICKS * LANES as u64, || {
            black_box(fly_batch_at(&batch, width));
        });
        say(&format!(
            "| {} | {lanes:.1} | {:.2} times | {measured:.1} | {:.2} times |",
            eight_at(width),
            single / lanes,
            with_metrics / measured
        ));
    }
    let flight = single * TICKS as f64 * 1e-6;
    let metrics = with_metrics * TICKS as f64 * 1e-6;
    say(&format!(
        "\nOne flight of 20 s at 1 kHz on one core: {flight:.1} ms, with all metrics {metrics:.1} ms.\n"
    ));
}

/// How eight vehicles fly at this width.
fn eight_at(width: Width) -> String {
    let pairs = width == Width::Baseline && cfg!(target_arch = "x86_64");
    let how = if pairs { "pairs" } else { "eight lanes" };
    format!("{how}, {}", width.name())
}

/// Integration steps of the body alone: Runge-Kutta and rotor lag, without drag.
struct Plant<'a, T, const N: usize> {
    flights: &'a [Flight<T>; N],
    steps: u64,
}

impl<T: Real, const N: usize> Work for Plant<'_, T, N> {
    type Output = [Flight<T>; N];
    #[inline(always)]
    fn run(self) -> [Flight<T>; N] {
        let mut flights = *self.flights;
        let held = Held::new(&flights[0].per, &Push::default());
        let h = flights[0].control_step;
        for _ in 0..self.steps {
            for k in 0..N {
                let flight = &mut flights[k];
                let Flight { state, rotor_torque, vehicle, actuation, .. } = flight;
                (*state, *rotor_torque) = actuation.step(state, *rotor_torque, h, vehicle, &held);
            }
        }
        flights
    }
}

/// [`Plant`] of eight vehicles that are all like this one.
struct EightPlants<'a>(&'a Flight<f64>);

impl Fleet for EightPlants<'_> {
    type Output = ();
    fn fly<T: Real<Scalar = f64>, const N: usize>(self, registers: impl Registers) {
        let flights: [Flight<T>; N] = [self.0.everywhere(); N];
        for _ in 0..LANES / (N * T::LANES) {
            black_box(registers.run(Plant { flights: &flights, steps: TICKS }));
        }
    }
}

/// Multiplications and additions in so many chains that wait for nothing but themselves: without contracting
/// them, the machine does no more than with the best number of chains.
struct Peak<T, const CHAINS: usize>(T);

impl<T: Real, const CHAINS: usize> Work for Peak<T, CHAINS> {
    type Output = T;
    #[inline(always)]
    fn run(self) -> T {
        let (scale, shift) = (self.0, self.0 * T::lit(1e-9));
        let mut chains = [self.0; CHAINS];
        for _ in 0..TICKS {
            for chain in &mut chains {
                *chain = *chain * scale + shift;
            }
        }
        chains.into_iter().fold(T::zero(), |sum, chain| sum + chain)
    }
}

/// 10^9 operations a second in this many chains, on each of so many threads.
fn peak<const CHAINS: usize>(width: Width, threads: usize) -> f64 {
    let ns = on_all(threads, TICKS * (2 * CHAINS * LANES) as u64, &|| {
        black_box(width.run(Peak::<_, CHAINS>(black_box(Eight::lit(1.000_000_1)))));
    });
    1.0 / (ns * threads as f64)
}

/// Nanoseconds for one of the `count` items of this work, done on so many threads at once; over and over, so
/// that the start of the threads does not show.
fn on_all(threads: usize, count: u64, work: &(dyn Fn() + Sync)) -> f64 {
    const TIMES: usize = 20;
    best(count * (threads * TIMES) as u64, || {
        std::thread::scope(|scope| {
            for _ in 0..threads {
                scope.spawn(|| (0..TIMES).for_each(|_| work()));
            }
        });
    })
}

type Eight = Lanes<f64, LANES>;

/// Million vehicle-steps per second: single, in lanes at each width, and in lanes on every core.
fn throughput() {
    let mut one = scenario("article/rotors:rate-commanded");
    one.run.substeps = 1.0;
    let flight = one.flight();
    let widest = Width::widest();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    say(
        "\n## Throughput\n\nMillion vehicle-steps per second: one Runge-Kutta step of 1 ms each; the closed loop is PID, HOSM, attitude,\nINDI, allocation and rotors at 1 kHz, without metrics.\n",
    );
    say("| how | plant alone | closed loop |\n|---|---|---|");
    let rate = |ns: f64| format!("{:.1}", 1e3 / ns);
    let row = |how: &str, plant: f64, closed: f64| {
        say(&format!("| {how} | {} | {} |", rate(plant), rate(closed)));
    };
    let plant = best(TICKS, || {
        black_box(Plant { flights: std::array::from_ref(&flight), steps: TICKS }.run());
    });
    let closed = best(TICKS, || {
        black_box(alone(&flight, TICKS));
    });
    row("single", plant, closed);
    let ms = closed * TICKS as f64 * 1e-6;
    let lanes = |width: Width| {
        let plant = best(TICKS * LANES as u64, || {
            width.fly(EightPlants(&flight));
        });
        let closed = best(TICKS * LANES as u64, || {
            eight(width, &flight, TICKS);
        });
        (plant, closed)
    };
    for width in Width::available() {
        let (plant, closed) = lanes(width);
        row(&eight_at(width), plant, closed);
    }
    let flights = TICKS * LANES as u64;
    let plant = on_all(threads, flights, &|| {
        widest.fly(EightPlants(&flight));
    });
    let closed = on_all(threads, flights, &|| {
        eight(widest, &flight, TICKS);
    });
    row(&format!("{}, {threads} threads", eight_at(widest)), plant, closed);
    say(&format!(
        "\nOne flight of 20 s at 1 kHz with one Runge-Kutta step each, on one core: {ms:.1} ms."
    ));
    say(
        "\nThe machine's own peak, measured: multiplications and additions of doubles without contraction, per core.\n",
    );
    say(&format!("| width | 10^9 operations/s | on {threads} threads at once |\n|---|---|---|"));
    for width in Width::available() {
        let [one, all] = [1, threads].map(|threads| {
            // Few registers hold few chains: eight lanes are one register or four.
            let few = [peak::<2>(width, threads), peak::<3>(width, threads)];
            let many = [peak::<5>(width, threads), peak::<10>(width, threads)];
            few.into_iter().chain(many).fold(0.0, Real::max)
        });
        say(&format!("| {} | {one:.1} | {all:.1} |", width.name()));
    }
}

/// A block of the world that is switched on.
type Switch = (&'static str, fn(&mut Scenario));

fn disturbed(scenario: &mut Scenario, kind: &str) {
    scenario.disturbance.extend(SourceSettings::named(kind));
}

fn seeing(scenario: &mut Scenario, kinds: &[&str]) {
    scenario.sensor.extend(kinds.iter().filter_map(|kind| SensorSettings::named(kind)));
}

fn dragging(scenario: &mut Scenario) {
    let vehicle = &mut scenario.vehicle.vehicle;
    (vehicle.rotor_drag, vehicle.body_drag) = (Vec3::splat(0.05), 0.01);
    (vehicle.rotor_radius, vehicle.inflow_loss, vehicle.flapping) = (0.05, 1e-6, 1e-7);
    vehicle.rotor_inertia = 1e-6;
}

fn propelled(scenario: &mut Scenario) {
    if let Some(kind) = ActuationSettings::named("propulsion") {
        scenario.actuation = kind;
    }
    if let ActuationSettings::Propulsion(_, options) = &mut scenario.actuation {
        options.supply = Supply::Battery;
    }
}

/// Everything but the filter.
fn everything(scenario: &mut Scenario) {
    dragging(scenario);
    propelled(scenario);
    for kind in ["dryden", "noise", "jet", "gust", "payload", "slung-mass", "rotor-efficiency"] {
        disturbed(scenario, kind);
    }
    scenario.timing.computation_delay = 0.002;
}

const BLOCKS: [Switch; 12] = [
    ("nothing", |_| {}),
    ("drag of body and rotors", |s| dragging(s)),
    ("propulsion with battery", |s| propelled(s)),
    ("`noise`", |s| disturbed(s, "noise")),
    ("drag and `jet`", |s| {
        dragging(s);
        disturbed(s, "jet");
    }),
    ("drag and `dryden`", |s| {
        dragging(s);
        disturbed(s, "dryden");
    }),
    ("`payload`", |s| disturbed(s, "payload")),
    ("`slung-mass`", |s| disturbed(s, "slung-mass")),
    ("delay of two ticks", |s| s.timing.computation_delay = 0.002),
    ("filter: gyro, accelerometer, GNSS, magnetometer, barometer", |s| {
        seeing(s, &["gyro", "accelerometer", "gnss", "magnetometer", "barometer"]);
    }),
    ("the whole world without the filter", everything),
    ("the whole world with the filter", |s| {
        everything(s);
        seeing(s, &["gyro", "accelerometer", "gnss", "magnetometer", "barometer"]);
    }),
];

/// What each block of the world adds to the closed loop on rotors.
fn world() {
    let plain = scenario("article/rotors:rate-commanded");
    let widest = Width::widest();
    say(&format!(
        "\n## The world\n\nns per closed-loop step of one vehicle, `article/rotors:rate-commanded` with this block switched on.\n\n\
         | block | single | against nothing | {} | against nothing |\n|---|---|---|---|---|",
        eight_at(widest)
    ));
    let mut nothing = None;
    for (name, switch) in BLOCKS {
        let mut one = plain.clone();
        switch(&mut one);
        let flight = one.flight();
        let ticks = TICKS / 4;
        let single = best(ticks, || {
            black_box(alone(&flight, ticks));
        });
        let lanes = best(ticks * LANES as u64, || {
            eight(widest, &flight, ticks);
        });
        let (one, eight) = *nothing.get_or_insert((single, lanes));
        say(&format!(
            "| {name} | {single:.0} | {:.1} times | {lanes:.0} | {:.1} times |",
            single / one,
            lanes / eight
        ));
    }
}

fn main() {
    if std::env::args().any(|argument| argument == "world") {
        return world();
    }
    say("## Laws and closed loop\n");
    laws();
    for name in [
        "article/consistent:rate-commanded",
        "article/rotors:rate-commanded",
        "article/literal:printed",
    ] {
        closed_loop(name);
    }
    throughput();
    world();
}
