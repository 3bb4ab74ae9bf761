//! What a law is.

use crate::math::{Vec3, World};
use crate::real::Real;
use crate::record::Record;
use crate::signals::{Applied, Measurement};

/// A record that keeps its own type when combined with others of its kind.
pub trait Plain<T: Real>: Record<T, With<T> = Self> {}
impl<T: Real, R: Record<T, With<T> = R>> Plain<T> for R {}

/// Measurement and reference in, command out, once per `dt` seconds. No heap, no clock, no I/O.
pub trait Controller<T: Real>: Plain<T> {
    /// What the law follows.
    type Reference: Plain<T>;
    /// What it asks of the next level.
    type Command: Plain<T>;
    /// Takes on what depends on `dt` alone; called before every [`Controller::update`]. The one place
    /// where a law may branch on a number, if both branches give the same bits.
    fn tune(&mut self, _dt: T) {}
    /// The command at this tick; `dt` is the time to the next one, in s.
    fn update(
        &mut self,
        measurement: &Measurement<T>,
        reference: &Self::Reference,
        dt: T,
    ) -> Self::Command;
    /// [`Controller::update`], and the sum of the command's magnitudes; that is not a number where the
    /// state or the limit is not finite.
    #[inline(always)]
    fn update_weighed(
        &mut self,
        measurement: &Measurement<T>,
        reference: &Self::Reference,
        dt: T,
    ) -> (Self::Command, T) {
        let command = self.update(measurement, reference, dt);
        let weight = command.magnitude() + (self.hidden() + self.limit()) * T::zero();
        (command, weight)
    }
    /// Sum of the state after an update, without what shows in the command anyway: numbers whose loss
    /// leaves no finite command, and those that a good input has just replaced.
    #[inline(always)]
    fn hidden(&self) -> T {
        self.sum(|x| x)
    }
    /// Forgets the past, as if the flight began with this measurement.
    fn reset(&mut self, measurement: &Measurement<T>);
    /// Bound on the magnitude of every number in the command (SI).
    fn limit(&self) -> T;
}

/// Estimates the acceleration that the model does not explain.
pub trait Observer<T: Real>: Plain<T> {
    /// The estimate, m/s^2.
    fn estimate(&self) -> Vec3<T, World>;
    /// Takes the measurement at the start of a tick.
    fn correct(&mut self, measurement: &Measurement<T>, dt: T);
    /// [`Observer::correct`], and the sum of the new state: not finite where the state is not.
    #[inline(always)]
    fn correct_summed(&mut self, measurement: &Measurement<T>, dt: T) -> T {
        self.correct(measurement, dt);
        self.sum(|x| x)
    }
    /// Moves on over the interval just commanded, after actuation.
    fn advance(&mut self, applied: &Applied<T>, dt: T);
    /// [`Observer::advance`], and the sum of the new state: not finite where the state is not.
    #[inline(always)]
    fn advance_summed(&mut self, applied: &Applied<T>, dt: T) -> T {
        self.advance(applied, dt);
        self.sum(|x| x)
    }
    /// Forgets the past, as if the flight began with this measurement.
    fn reset(&mut self, measurement: &Measurement<T>);
    /// Bound on the magnitude of each component of the estimate, m/s^2.
    fn limit(&self) -> T;
}

/// Implements [`Controller`] for a registry.
///
/// A law is run part by part: the loop vectoriser takes it as a whole, and only its scalar form is ever
/// compiled. Where there is one part, it is run in its place. A law with larger parts that depend on an
/// option loops over the parts itself, inside its match; its registry says `whole`.
#[macro_export]
macro_rules! dispatch_controller {
    (@update each $laws:ident $measurement:ident $reference:ident $dt:ident) => {{
        use $crate::record::RecordExt as _;
        if T::PARTS == 1 {
            return $laws.update_weighed($measurement, $reference, $dt);
        }
        let (mut commands, mut weights) = (Self::Command::default(), T::zero());
        for i in 0..T::PARTS {
            let mut law = $laws.pick(i);
            let (command, weight) =
                law.update_weighed(&$measurement.pick(i), &$reference.pick(i), $dt.part(i));
            command.put(&mut commands, i);
            weights.set_part(i, weight);
            law.put($laws, i);
        }
        (commands, weights)
    }};
    (@update whole $laws:ident $measurement:ident $reference:ident $dt:ident) => {
        $laws.update_weighed($measurement, $reference, $dt)
    };
    ($name:ident [$($variant:ident)+] ($reference:ident => $command:ident, $how:ident)) => {
        impl<T: $crate::real::Real> $crate::controller::Controller<T> for $name<T> {
            type Reference = $crate::signals::$reference<T>;
            type Command = $crate::signals::$command<T>;
            #[inline(always)]
            fn update(&mut self, measurement: &$crate::signals::Measurement<T>, reference: &Self::Reference, dt: T) -> Self::Command {
                self.update_weighed(measurement, reference, dt).0
            }
            #[inline(always)]
            fn update_weighed(&mut self, measurement: &$crate::signals::Measurement<T>, reference: &Self::Reference, dt: T) -> (Self::Command, T) {
                match self { $( Self::$variant(laws) => {
                    laws.tune(dt);
                    $crate::dispatch_controller!(@update $how laws measurement reference dt)
                } )+ }
            }
            #[inline(always)]
            fn reset(&mut self, measurement: &$crate::signals::Measurement<T>) {
                match self { $( Self::$variant(law) => law.reset(measurement), )+ }
            }
            #[inline(always)]
            fn limit(&self) -> T {
                match self { $( Self::$variant(law) => law.limit(), )+ }
            }
        }
    };
}

/// Implements [`Observer`] for a registry, part by part as [`dispatch_controller`] does.
#[macro_export]
macro_rules! dispatch_observer {
    (@each [$($variant:ident)+] $all:ident $step:ident $with:ident $dt:ident) => {{
        use $crate::record::RecordExt as _;
        let mut sums = T::zero();
        match $all { $( Self::$variant(laws) => {
            if T::PARTS == 1 {
                return laws.$step($with, $dt);
            }
            for i in 0..T::PARTS {
                let mut law = laws.pick(i);
                sums.set_part(i, law.$step(&$with.pick(i), $dt.part(i)));
                law.put(laws, i);
            }
        } )+ }
        sums
    }};
    ($name:ident [$($variant:ident)+] ()) => {
        impl<T: $crate::real::Real> $crate::controller::Observer<T> for $name<T> {
            #[inline(always)]
            fn estimate(&self) -> $crate::math::Vec3<T, $crate::math::World> {
                match self { $( Self::$variant(law) => law.estimate(), )+ }
            }
            #[inline(always)]
            fn correct(&mut self, measurement: &$crate::signals::Measurement<T>, dt: T) {
                self.correct_summed(measurement, dt);
            }
            #[inline(always)]
            fn correct_summed(&mut self, measurement: &$crate::signals::Measurement<T>, dt: T) -> T {
                $crate::dispatch_observer!(@each [$($variant)+] self correct_summed measurement dt)
            }
            #[inline(always)]
            fn advance(&mut self, applied: &$crate::signals::Applied<T>, dt: T) {
                self.advance_summed(applied, dt);
            }
            #[inline(always)]
            fn advance_summed(&mut self, applied: &$crate::signals::Applied<T>, dt: T) -> T {
                $crate::dispatch_observer!(@each [$($variant)+] self advance_summed applied dt)
            }
            #[inline(always)]
            fn reset(&mut self, measurement: &$crate::signals::Measurement<T>) {
                match self { $( Self::$variant(law) => law.reset(measurement), )+ }
            }
            #[inline(always)]
            fn limit(&self) -> T {
                match self { $( Self::$variant(law) => law.limit(), )+ }
            }
        }
    };
}
