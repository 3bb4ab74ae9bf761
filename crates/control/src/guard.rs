//! What keeps a law total: guards around controllers and observers.

use crate::controller::{Controller, Observer, Plain};
use crate::math::{Vec3, World};
use crate::real::{Mask, Real};
use crate::record::{Meta, Path, Record, Visitor, VisitorMut, blend, clamp, each, same, shown};
use crate::signals::{Applied, Measurement};

/// Makes a law total: whatever comes in, a finite command within the limit goes out.
///
/// Non-finite input, state or output gives the last good command and raises the flag; the state
/// from before a bad input is kept, and what of it is not finite is reset.
#[derive(Clone, Copy, Debug, Default)]
pub struct Guarded<T, Law, Command> {
    /// The law inside.
    pub law: Law,
    last: Command,
    /// 1 where the last tick's command was held, else 0.
    pub flag: T,
}

impl<T: Real, L: Controller<T>> Guarded<T, L, L::Command> {
    /// Guards the law; `command` is held until the first good one.
    pub fn new(law: L, command: L::Command) -> Self {
        Self { law, last: command, flag: T::zero() }
    }

    /// [`Controller::update`], total.
    #[inline(always)]
    pub fn update(
        &mut self,
        measurement: &Measurement<T>,
        reference: &L::Reference,
        dt: T,
    ) -> L::Command {
        let input = passing(measurement, dt).and(finite(reference));
        self.update_checked(input, measurement, reference, dt)
    }

    /// [`Guarded::update`] where the caller knows already in which lanes the `input` is good.
    #[inline(always)]
    pub fn update_checked(
        &mut self,
        input: Good<T>,
        measurement: &Measurement<T>,
        reference: &L::Reference,
        dt: T,
    ) -> L::Command {
        // Whether all is well decides only what need not be computed: the results are the same.
        let before = if input.all { None } else { Some(self.law) };
        self.law.tune(dt);
        let (command, weight) = self.law.update_weighed(measurement, reference, dt);
        let limit = self.law.limit();
        // Numbers whose magnitudes together are within the limit are finite, and within it one by one.
        if input.all && weight.le(limit).all() {
            (self.last, self.flag) = (same(&command), T::zero());
            command
        } else {
            // Copies: what a call may look at does not stay in registers.
            self.settle(&same(&command), limit, input.lanes, before, &same(measurement));
            same(&self.last)
        }
    }

    /// What was `granted` just now, for the level below: as it is for one vehicle, where it stays in registers; as
    /// it is kept for many, who live in memory anyway.
    #[inline(always)]
    pub fn handed<'a>(&'a self, granted: &'a L::Command) -> &'a L::Command {
        if T::PARTS == 1 { granted } else { &self.last }
    }

    /// The last command that was granted.
    #[inline(always)]
    pub fn held(&self) -> &L::Command {
        &self.last
    }

    /// Grants what is good of the command, within the limit, and mends the rest.
    #[cold]
    #[inline(never)]
    fn settle(
        &mut self,
        command: &L::Command,
        limit: T,
        input: T::Mask,
        before: Option<L>,
        measurement: &Measurement<T>,
    ) {
        let good = input & command.finite() & self.law.finite() & limit.is_finite();
        self.last = blend(good, &clamp(command, limit), &bounded(&self.last, limit));
        self.flag = T::select(good, T::zero(), T::one());
        if !good.all() {
            self.mend(input, before, measurement);
        }
    }

    /// Takes the state from before a bad input, and resets what of it is not finite.
    fn mend(&mut self, input: T::Mask, before: Option<L>, measurement: &Measurement<T>) {
        if let Some(before) = before {
            self.law = blend(input, &self.law, &before);
        }
        let mut fresh = self.law;
        fresh.reset(&mended(measurement, &Measurement::default()));
        self.law = mended(&self.law, &fresh);
    }

    /// [`Controller::reset`]; the default command is held until the first good one.
    pub fn reset(&mut self, measurement: &Measurement<T>)
    where
        L::Command: Default,
    {
        self.law.reset(&mended(measurement, &Measurement::default()));
        self.last = L::Command::default();
        self.flag = T::zero();
    }
}

/// Makes an observer total, as [`Guarded`] does for a law.
#[derive(Clone, Copy, Debug)]
pub struct GuardedObserver<T, Law> {
    /// The observer inside.
    pub law: Law,
    /// 1 where the observer begins anew at the next good measurement.
    lost: T,
    /// 1 where the last tick was ignored or mended, else 0.
    pub flag: T,
}

impl<T: Real, L: Default> Default for GuardedObserver<T, L> {
    fn default() -> Self {
        Self { law: L::default(), lost: T::zero(), flag: T::zero() }
    }
}

impl<T: Real, O: Observer<T>> GuardedObserver<T, O> {
    /// Guards the observer.
    pub fn new(law: O) -> Self {
        Self { law, lost: T::zero(), flag: T::zero() }
    }

    /// [`Observer::estimate`], finite and within the limit.
    #[inline(always)]
    pub fn estimate(&self) -> Vec3<T, World> {
        let limit = self.law.limit();
        self.law.estimate().map(|x| x.clamp(-limit, limit))
    }

    /// [`Observer::correct`], total.
    #[inline(always)]
    pub fn correct(&mut self, measurement: &Measurement<T>, dt: T) {
        self.correct_checked(passing(measurement, dt), measurement, dt);
    }

    /// [`GuardedObserver::correct`] where the caller knows already in which lanes the `input` is
    /// good.
    #[inline(always)]
    pub fn correct_checked(&mut self, input: Good<T>, measurement: &Measurement<T>, dt: T) {
        self.flag = T::zero();
        if !self.lost.eq(T::zero()).all() {
            self.restart(input.lanes, &same(measurement));
        }
        let before = if input.all { None } else { Some(self.law) };
        let sum = self.law.correct_summed(measurement, dt);
        self.check(input, sum, before);
    }

    /// [`Observer::advance`], total.
    #[inline(always)]
    pub fn advance(&mut self, applied: &Applied<T>, dt: T) {
        let input = passing(applied, dt);
        let before = if input.all { None } else { Some(self.law) };
        let sum = self.law.advance_summed(applied, dt);
        self.check(input, sum, before);
    }

    /// [`Observer::reset`].
    pub fn reset(&mut self, measurement: &Measurement<T>) {
        self.law.reset(&mended(measurement, &Measurement::default()));
        (self.lost, self.flag) = (T::zero(), T::zero());
    }

    /// Begins anew where the observer was lost and the measurement is good; where it was lost, this tick is
    /// mended and says so.
    #[cold]
    #[inline(never)]
    fn restart(&mut self, good: T::Mask, measurement: &Measurement<T>) {
        let sound = self.lost.eq(T::zero());
        self.flag = T::select(sound, T::zero(), T::one());
        let mut fresh = self.law;
        fresh.reset(&mended(measurement, &Measurement::default()));
        self.law = blend(good & !sound, &fresh, &self.law);
        self.lost = T::select(sound | good, T::zero(), T::one());
    }

    #[inline(always)]
    fn check(&mut self, input: Good<T>, sum: T, before: Option<O>) {
        if !(input.all && sum.is_finite().all()) {
            self.mend(input.lanes & self.law.finite(), input.lanes, before);
        }
    }

    /// Takes the state from before a bad input. What of it is not finite rests until the next good
    /// measurement, with which the observer begins anew.
    #[cold]
    #[inline(never)]
    fn mend(&mut self, good: T::Mask, input: T::Mask, before: Option<O>) {
        self.flag = T::select(good, self.flag, T::one());
        if let Some(before) = before {
            self.law = blend(input, &self.law, &before);
        }
        self.lost = T::select(self.law.finite(), self.lost, T::one());
        let mut rest = self.law;
        rest.reset(&Measurement::default());
        self.law = mended(&self.law, &rest);
    }
}

/// In which lanes something is good, and whether it is in all of them: asked once, used often.
#[derive(Clone, Copy, Debug)]
pub struct Good<T: Real> {
    lanes: T::Mask,
    all: bool,
}

impl<T: Real> Good<T> {
    #[inline(always)]
    fn new(lanes: T::Mask) -> Self {
        Self { lanes, all: lanes.all() }
    }

    /// Good in every lane: for what is finite by the way it was made, so that none need ask.
    #[inline(always)]
    pub fn everywhere() -> Self {
        Self { lanes: T::Mask::splat(true), all: true }
    }

    /// Where both are good.
    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        if self.all && other.all { self } else { Self::new(self.lanes & other.lanes) }
    }
}

/// Where the record is finite.
#[inline(always)]
pub fn finite<T: Real, R: Plain<T>>(record: &R) -> Good<T> {
    // A finite sum has finite terms. Terms so large that their sum is not are looked at one by one.
    let quick = Good::new(record.sum(|x| x).is_finite());
    if quick.all { quick } else { Good::new(shown(record, R::finite)) }
}

/// Where the record is finite and `dt` a time that can pass.
#[inline(always)]
pub fn passing<T: Real, R: Plain<T>>(record: &R, dt: T) -> Good<T> {
    let quick = Good::new(record.sum(|x| x).is_finite() & good_step(dt));
    if quick.all { quick } else { Good::new(shown(record, R::finite) & good_step(dt)) }
}

/// Whether the step is a time that can pass. More than a second is a gap and not a step: an
/// observer would slide through it at its full slope.
#[inline(always)]
fn good_step<T: Real>(dt: T) -> T::Mask {
    T::zero().lt(dt) & dt.le(T::one())
}

/// Number by number: the record's own within the limit; zero where even that is not finite.
#[inline(always)]
fn bounded<T: Real, R: Plain<T>>(record: &R, limit: T) -> R {
    R::zip([record], &mut |[x]| {
        let within = x.clamp(-limit, limit);
        T::select(x.is_finite() & within.is_finite(), within, T::zero())
    })
}

/// Number by number: the record's own where finite, else that of `spare`.
#[inline(always)]
pub fn mended<T: Real, R: Plain<T>>(record: &R, spare: &R) -> R {
    R::zip([record, spare], &mut |[x, y]| T::select(x.is_finite(), x, y))
}

/// A guard is a record like any other; what it remembers shows beside its `flag`.
macro_rules! guard_record {
    ($guard:ident, $law:ident $($command:ident)?, $kept:ident: $type:ty as $name:literal, $about:literal) => {
        impl<T: Real, $law: Record<T> $(, $command: Record<T>)?> Record<T> for $guard<T, $law $(, $command)?> {
            type With<U: Real> = $guard<U, $law::With<U> $(, $command::With<U>)?>;
            #[inline(always)]
            fn visit(&self, path: &Path<'_>, meta: &Meta, v: &mut impl Visitor<T>) {
                self.law.visit(path, meta, v);
                self.$kept.visit(&path.join($name), &Meta::signal("1", $about), v);
                v.number(&path.join("flag"), &FLAG, self.flag);
            }
            #[inline(always)]
            fn visit_mut(&mut self, path: &Path<'_>, meta: &Meta, v: &mut impl VisitorMut<T>) {
                self.law.visit_mut(path, meta, v);
                self.$kept.visit_mut(&path.join($name), &Meta::signal("1", $about), v);
                v.number(&path.join("flag"), &FLAG, &mut self.flag);
            }
            #[inline(always)]
            fn zip<const M: usize, U: Real>(
                rows: [&Self; M],
                f: &mut impl FnMut([T; M]) -> U,
            ) -> Self::With<U> {
                $guard {
                    law: $law::zip(each(rows, |row| &row.law), f),
                    $kept: <$type>::zip(each(rows, |row| &row.$kept), f),
                    flag: f(each(rows, |row| row.flag)),
                }
            }
            #[inline(always)]
            fn pick_part(&self, i: usize) -> Self::With<T::Part> {
                $guard {
                    law: self.law.pick_part(i),
                    $kept: self.$kept.pick_part(i),
                    flag: self.flag.part(i),
                }
            }
            #[inline(always)]
            fn onto<U: Real>(&self, batch: &mut Self::With<U>, f: &mut impl FnMut(&mut U, T)) {
                self.law.onto(&mut batch.law, f);
                self.$kept.onto(&mut batch.$kept, f);
                f(&mut batch.flag, self.flag);
            }
            #[inline(always)]
            fn each_variable(&self, f: &mut impl FnMut(T)) {
                self.law.each_variable(f);
                self.$kept.each_variable(f);
                f(self.flag);
            }
        }
    };
}
guard_record! { Guarded, L C, last: C as "held", "The last command that was granted." }
guard_record! {
    GuardedObserver, L,
    lost: T as "lost", "1 where the observer begins anew at the next good measurement."
}

const FLAG: Meta = Meta::signal("1", "1 where the law held its last good value.");
