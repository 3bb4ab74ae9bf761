//! A disturbance with its onset and its end.
//!
//!   on(t) = 1 where start <= t < end, else 0                             (1)
//!
//! Time inside a disturbance begins at its onset; random fields run from the start of the flight, so
//! the onset does not change what they draw.

use stormpetrel_control::math::{Vec3, World};
use stormpetrel_control::real::Real;
use stormpetrel_control::record;
use stormpetrel_control::record::{Meta, Path, Record as _, RecordExt as _};
use stormpetrel_control::registry::{Settings, SettingsVisitor};

use super::{
    Cargo, Disturb as _, Disturbance, DisturbanceSettings, Reach, RotorFaults, Scene, Site,
};
use crate::dynamics::Push;
use crate::sling::Sling;

record! {
    /// When a disturbance acts.
    pub struct Window {
        /// Onset, from the start of the flight.
        start: T [s] = 0.0, in 0.0 => 1e12;
        /// End.
        end: T [s] = 1e12, in 0.0 => 1e12;
    }
}

impl Window<f64> {
    /// Whether any of it lies in a flight of this duration, s.
    pub fn meets(&self, duration: f64) -> bool {
        self.start < duration && self.start < self.end
    }
}

record! {
    /// A disturbance and when it acts.
    pub struct Source {
        /// When.
        window: Window<T> [];
        /// What.
        what: Disturbance<T> [];
    }
}

impl<T: Real> Source<T> {
    /// Whether it acts at this time (1).
    #[inline(always)]
    fn on(&self, time: T) -> T::Mask {
        self.window.start.le(time) & time.lt(self.window.end)
    }

    #[inline(always)]
    fn since_onset(&self, scene: &Scene<T>) -> Scene<T> {
        Scene { time: scene.time - self.window.start, ..*scene }
    }

    /// What it touches.
    #[inline(always)]
    pub fn reach(&self) -> Reach {
        self.what.reach()
    }

    /// Force and torque at this moment of the flight.
    #[inline(always)]
    pub fn push(&mut self, scene: &Scene<T>) -> Push<T> {
        let on = self.on(scene.time);
        let Push { force, torque } = self.what.push(&self.since_onset(scene));
        Push {
            force: Vec3::select(on, force, Vec3::zero()),
            torque: Vec3::select(on, torque, Vec3::zero()),
        }
    }

    /// [`Source::push`] of a harmonic one, which knows the time (s) and the mass (kg) only: the one that a
    /// plain flight asks in its loop.
    #[inline(always)]
    pub fn harmonic(&self, time: T, mass: T) -> Option<Push<T>> {
        let Disturbance::Harmonic(all) = &self.what else { return None };
        let mut push = Push::default();
        for i in 0..T::PARTS {
            let (time, window) = (time.part(i), self.window.pick(i));
            let Push { force, torque } = all.pick(i).at(time - window.start, mass.part(i));
            let on = window.start.le(time) & time.lt(window.end);
            let force = Vec3::select(on, force, Vec3::zero());
            Push { force, torque: Vec3::select(on, torque, Vec3::zero()) }.put(&mut push, i);
        }
        Some(push)
    }

    /// Velocity of the air, m/s.
    #[inline(always)]
    pub fn wind(&mut self, scene: &Scene<T>) -> Vec3<T, World> {
        let wind = self.what.wind(&self.since_onset(scene));
        Vec3::select(self.on(scene.time), wind, Vec3::zero())
    }

    /// Rigid load.
    #[inline(always)]
    pub fn cargo(&self, scene: &Scene<T>) -> Cargo<T> {
        let cargo = self.what.cargo();
        Cargo { mass: T::select(self.on(scene.time), cargo.mass, T::zero()), ..cargo }
    }

    /// Mass on a cable.
    #[inline(always)]
    pub fn sling(&self, scene: &Scene<T>) -> Sling<T> {
        let sling = self.what.sling();
        Sling { mass: T::select(self.on(scene.time), sling.mass, T::zero()), ..sling }
    }

    /// Broken rotors.
    #[inline(always)]
    pub fn rotors(&self, scene: &Scene<T>) -> RotorFaults<T> {
        let faults = self.what.rotors(&self.since_onset(scene));
        record::blend(self.on(scene.time), &faults, &RotorFaults::none())
    }
}

/// A disturbance as a scenario file gives it.
#[derive(Clone, Copy, Debug)]
pub struct SourceSettings {
    /// When it acts.
    pub window: Window<f64>,
    /// What it is.
    pub what: DisturbanceSettings,
}

impl SourceSettings {
    /// The disturbance; its random streams come from the key of `site`.
    pub fn build(&self, site: &Site<f64>) -> Source<f64> {
        Source { window: self.window, what: self.what.build(site) }
    }
}

impl Settings for SourceSettings {
    const KEY: &'static str = DisturbanceSettings::KEY;
    const NAMES: &'static [&'static str] = DisturbanceSettings::NAMES;
    const SOURCES: &'static [&'static str] = DisturbanceSettings::SOURCES;

    fn named(name: &str) -> Option<Self> {
        Some(Self { window: Window::default(), what: DisturbanceSettings::named(name)? })
    }

    fn name(&self) -> &'static str {
        self.what.name()
    }

    fn settings(&mut self, v: &mut impl SettingsVisitor) {
        self.what.settings(v);
        self.window.visit_mut(&Path::ROOT, &Meta::signal("", ""), v);
    }
}
