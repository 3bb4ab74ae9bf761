//! What the test files share: reproducible numbers, smooth signals, and the walk over all laws.
#![allow(dead_code)] // no test file needs all of it

use stormpetrel_control::controller::Plain;
use stormpetrel_control::math::Vec3;
use stormpetrel_control::options::OptionVisitor;
use stormpetrel_control::record::{Meta, Path, Record, Visitor, VisitorMut};
use stormpetrel_control::registry::Settings;
use stormpetrel_control::signals::{
    Applied, Attitude, Measurement, Model, Rate, Thrust, Trajectory, Wrench,
};

/// Principal moments of inertia of the article's vehicle, kg m^2.
pub const INERTIA: [f64; 3] = [2.6e-3, 2.4e-3, 2.6e-3];

/// What the laws are told: the article's vehicle.
pub fn model() -> Model<f64> {
    let [x, y, z] = INERTIA;
    Model { inertia: Vec3::new(x, y, z), ..Model::default() }
}

/// The generator `SplitMix64`.
pub struct Random(pub u64);

impl Random {
    /// The next 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
    /// A number evenly distributed between the two.
    pub fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * ((self.bits() >> 11) as f64 / 9_007_199_254_740_992.0)
    }
}

struct Write<F>(F);

impl<F: FnMut(&str, &Meta, &mut f64)> VisitorMut<f64> for Write<F> {
    fn number(&mut self, path: &Path<'_>, meta: &Meta, value: &mut f64) {
        (self.0)(&path.to_string(), meta, value);
    }
}

/// Shows every number of the record with its dotted name; each may be changed.
pub fn each<R: Record<f64>>(record: &mut R, f: impl FnMut(&str, &Meta, &mut f64)) {
    record.visit_mut(&Path::ROOT, &Meta::signal("", ""), &mut Write(f));
}

struct Read(Vec<f64>);

impl Visitor<f64> for Read {
    fn number(&mut self, _: &Path<'_>, _: &Meta, value: f64) {
        self.0.push(value);
    }
}

/// All numbers of the record, in the order of declaration.
pub fn numbers(record: &impl Record<f64>) -> Vec<f64> {
    let mut all = Read(Vec::new());
    record.visit(&Path::ROOT, &Meta::signal("", ""), &mut all);
    all.0
}

/// The bits of all numbers of the record.
pub fn bits(record: &impl Record<f64>) -> Vec<u64> {
    numbers(record).into_iter().map(f64::to_bits).collect()
}

/// A signal that a test can invent: `plausible` turns arbitrary waves into one that may occur.
pub trait Signal: Plain<f64> + Default {
    /// Makes quaternions unit ones and the thrust point upwards.
    fn plausible(self) -> Self {
        self
    }
}

impl Signal for Trajectory<f64> {}
impl Signal for Applied<f64> {}
impl Signal for Rate<f64> {}
impl Signal for Wrench<f64> {}
impl Signal for Thrust<f64> {
    fn plausible(mut self) -> Self {
        self.force.z += 9.8;
        self
    }
}
impl Signal for Attitude<f64> {
    fn plausible(mut self) -> Self {
        self.rotation.w += 2.0;
        self.rotation = self.rotation.normalised();
        self
    }
}
impl Signal for Measurement<f64> {
    fn plausible(mut self) -> Self {
        self.attitude.w += 2.0;
        self.attitude = self.attitude.normalised();
        self
    }
}

/// A smooth signal at time `t`: every number is a sine wave, chosen by the seed.
pub fn smooth<S: Signal>(seed: u64, t: f64) -> S {
    let (mut random, mut signal) = (Random(seed), S::default());
    each(&mut signal, |_, _, value| {
        let (a, w) = (random.between(-1.0, 1.0), random.between(0.5, 4.0));
        *value = a * libm::sin(w * t + random.between(0.0, 6.0));
    });
    signal.plausible()
}

/// Takes one option of every choice, counting through all combinations like an odometer.
#[derive(Default)]
struct Odometer {
    wheels: Vec<(usize, usize)>,
    place: usize,
    label: String,
}

impl Odometer {
    /// On to the next combination; false after the last.
    fn step(&mut self) -> bool {
        (self.place, self.label) = (0, String::new());
        for (position, size) in &mut self.wheels {
            *position += 1;
            if *position < *size {
                return true;
            }
            *position = 0;
        }
        false
    }
}

impl VisitorMut<f64> for Odometer {
    fn number(&mut self, _: &Path<'_>, _: &Meta, _: &mut f64) {}
}

impl OptionVisitor for Odometer {
    fn choice(
        &mut self,
        name: &'static str,
        _: &'static str,
        names: &'static [&'static str],
        _: &'static [&'static str],
        _: usize,
    ) -> usize {
        if self.place == self.wheels.len() {
            self.wheels.push((0, names.len()));
        }
        let (position, _) = self.wheels[self.place];
        self.place += 1;
        self.label += &format!(", {name} = {}", names[position]);
        position
    }
}

/// Every law of a registry with every combination of its options, and a label for messages.
pub fn every<S: Settings>() -> Vec<(String, S)> {
    let mut all = Vec::new();
    for name in S::NAMES {
        let mut odometer = Odometer::default();
        loop {
            let mut settings = S::named(name).expect("a listed name");
            settings.settings(&mut odometer);
            all.push((format!("{name}{}", odometer.label), settings));
            if !odometer.step() {
                break;
            }
        }
    }
    all
}

struct Scatter(Random);

impl VisitorMut<f64> for Scatter {
    fn number(&mut self, path: &Path<'_>, meta: &Meta, value: &mut f64) {
        // Limits stay, as a tight one would hide what is to be compared.
        if !path.name().contains("limit") {
            let by = self.0.between(0.5, 1.5);
            *value = if *value == 0.0 { by.min(meta.range.1) } else { *value * by };
        }
    }
}

impl OptionVisitor for Scatter {}

/// The settings with every gain changed by up to a half; gains that were zero come alive.
pub fn scattered<S: Settings>(mut settings: S, seed: u64) -> S {
    settings.settings(&mut Scatter(Random(seed)));
    settings
}
