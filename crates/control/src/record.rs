//! Declare once: a plain struct of numbers with names, units, frames and meaning.
//!
//! `record!` writes what every signal, state and set of gains needs: a walk over all numbers with
//! their dotted names (headers, logs, scenario files, sweeps), a change of scalar (`f64` file to
//! `f32` firmware), and eight vehicles side by side. All of these come from one primitive,
//! [`Record::zip`].

use core::fmt;
use core::marker::PhantomData;

use crate::lanes::Lanes;
use crate::real::Real;

/// What a declaration says of one number.
#[derive(Clone, Copy, Debug)]
pub struct Meta {
    /// SI unit, such as `m/s`; `1` without a unit; `count` for whole numbers.
    pub unit: &'static str,
    /// `world`, `body`, or empty where no frame applies.
    pub frame: &'static str,
    /// One sentence of meaning, as the declaration gives it.
    pub doc: &'static str,
    /// Smallest and largest value that a file may give.
    pub range: (f64, f64),
}

impl Meta {
    /// A signal: any finite value.
    pub const fn signal(unit: &'static str, doc: &'static str) -> Self {
        Self { unit, frame: "", doc, range: (-f64::MAX, f64::MAX) }
    }

    /// The same in a frame.
    pub const fn in_frame(self, frame: &'static str) -> Self {
        Self { frame, ..self }
    }
}

/// A dotted name, written from the root: `position.gains.kp.x`.
#[derive(Clone, Copy, Debug)]
pub struct Path<'a> {
    parent: Option<&'a Path<'a>>,
    name: &'static str,
}

impl Path<'_> {
    /// The empty name, from which all others start.
    pub const ROOT: Path<'static> = Path { parent: None, name: "" };

    /// The name one level down.
    pub const fn join(&self, name: &'static str) -> Path<'_> {
        Path { parent: Some(self), name }
    }

    /// The last part of the name.
    pub const fn name(&self) -> &'static str {
        self.name
    }

    /// The name one level up; none for a name of one part.
    pub fn parent(&self) -> Option<&Self> {
        self.parent.filter(|parent| !parent.name.is_empty())
    }

    /// The first part of the name.
    pub fn first(&self) -> &'static str {
        self.parent().map_or(self.name, Self::first)
    }
}

impl fmt::Display for Path<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(parent) = self.parent {
            parent.fmt(f)?;
            if !parent.name.is_empty() {
                f.write_str(".")?;
            }
        }
        f.write_str(self.name)
    }
}

/// Receives every number of a record.
pub trait Visitor<T> {
    /// One number: its dotted name, its declaration, its value.
    fn number(&mut self, path: &Path<'_>, meta: &Meta, value: T);
}

/// Receives every number of a record and may change it.
pub trait VisitorMut<T> {
    /// One number: its dotted name, its declaration, its place.
    fn number(&mut self, path: &Path<'_>, meta: &Meta, value: &mut T);
    /// Announces the components of a vector: a file may give one number for all of them.
    fn vector(&mut self, _path: &Path<'_>, _meta: &Meta, _components: &'static [&'static str]) {}
}

/// A plain value made of numbers, all of the scalar `T`.
pub trait Record<T: Real>: Copy {
    /// The same structure with another scalar.
    type With<U: Real>: Record<U, With<T> = Self>;

    /// Walks over all numbers in the order of declaration.
    fn visit(&self, path: &Path<'_>, meta: &Meta, v: &mut impl Visitor<T>);

    /// Walks over all numbers, each of which may be changed.
    fn visit_mut(&mut self, path: &Path<'_>, meta: &Meta, v: &mut impl VisitorMut<T>);

    /// Combines `N` records of one structure number by number. What is not a number (an option,
    /// the choice of a law) is taken from the first.
    fn zip<const N: usize, U: Real>(
        rows: [&Self; N],
        f: &mut impl FnMut([T; N]) -> U,
    ) -> Self::With<U>;

    /// Part `i` of a batch: what a loop over the parts takes at once.
    fn pick_part(&self, i: usize) -> Self::With<T::Part>;

    /// Shows every number of a batch of the same structure to `f`, beside this record's.
    fn onto<U: Real>(&self, batch: &mut Self::With<U>, f: &mut impl FnMut(&mut U, T));

    /// Shows every number that may change in flight: all but those declared with a default, which
    /// are settings.
    fn each_variable(&self, f: &mut impl FnMut(T));

    /// Whether every number that may change in flight is finite, lane by lane. For the rare case: asking
    /// whether [`Record::sum`] is finite is quicker, and mostly enough.
    #[cold]
    #[inline(never)]
    fn finite(&self) -> T::Mask {
        // Zero times a number is zero; zero times an infinity or NaN is NaN, and the sum stays it.
        self.sum(|x| x * T::Part::zero()).eq(T::zero())
    }

    /// Sum of the magnitudes of every number that may change in flight; not finite where one is not.
    #[inline(always)]
    fn magnitude(&self) -> T {
        self.sum(Real::abs)
    }

    /// Sum of `f` of every number that may change in flight, lane by lane.
    #[inline(always)]
    fn sum(&self, f: impl Fn(T::Part) -> T::Part) -> T {
        let mut sums = T::zero();
        for i in 0..T::PARTS {
            // Four sums in turn: an addition need not wait for the one before it.
            let (mut part, mut turn) = ([T::Part::zero(); 4], 0);
            self.pick_part(i).each_variable(&mut |x| {
                part[turn % 4] += f(x);
                turn += 1;
            });
            sums.set_part(i, (part[0] + part[1]) + (part[2] + part[3]));
        }
        sums
    }
}

/// A step for each index from one up, the first ones written out: the compiler keeps an array that a loop
/// walks in memory until it is too late to put it in registers.
macro_rules! from_one {
    ($count:ident, $i:ident => $step:expr) => {
        if $count > 1 {
            let $i = 1;
            $step;
        }
        if $count > 2 {
            let $i = 2;
            $step;
        }
        if $count > 3 {
            let $i = 3;
            $step;
        }
        for $i in 4..$count {
            $step;
        }
    };
}

/// A function of each item. The standard `map` on arrays is an iterator inside, which the compiler does
/// not always inline; a call in the middle of the loop costs the wide registers.
#[inline(always)]
pub fn each<const N: usize, A: Copy, B: Copy>(items: [A; N], mut f: impl FnMut(A) -> B) -> [B; N] {
    let mut out = [f(items[0]); N];
    from_one!(N, i => out[i] = f(items[i]));
    out
}

/// An array from its indices, for the same reason.
#[inline(always)]
pub fn from_index<const N: usize, B: Copy>(mut f: impl FnMut(usize) -> B) -> [B; N] {
    let mut out = [f(0); N];
    from_one!(N, i => out[i] = f(i));
    out
}

/// What follows from [`Record::zip`] for every record.
pub trait RecordExt<T: Real>: Record<T> {
    /// The same record in another precision; lane zero where there are several.
    #[inline(always)]
    fn cast<U: Real>(&self) -> Self::With<U> {
        Self::zip([self], &mut |[x]| U::lit(x.to_f64()))
    }

    /// `N` vehicles side by side, one lane each.
    #[inline(always)]
    fn gather<const N: usize>(rows: [&Self; N]) -> Self::With<Lanes<T, N>>
    where
        Lanes<T, N>: Real,
    {
        Self::zip(rows, &mut |x| Lanes(x))
    }

    /// The same record for every lane of a batch.
    #[inline(always)]
    fn everywhere<U: Real<Scalar = T>>(&self) -> Self::With<U> {
        Self::zip([self], &mut |[x]| U::from_lanes(|_| x))
    }

    /// Part `i` of a batch: what a loop over the parts takes at once.
    #[inline(always)]
    fn pick(&self, i: usize) -> Self::With<T::Part> {
        self.pick_part(i)
    }

    /// Writes this record into part `i` of a batch of the same structure.
    #[inline(always)]
    fn put<U: Real<Part = T>>(&self, batch: &mut Self::With<U>, i: usize) {
        self.onto(batch, &mut |place, x| place.set_part(i, x));
    }

    /// Vehicle `i` of a batch.
    #[inline(always)]
    fn pick_lane(&self, i: usize) -> Self::With<T::Scalar> {
        Self::zip([self], &mut |[x]| x.lane(i))
    }

    /// Writes this vehicle's record into lane `i` of a batch of the same structure.
    #[inline(always)]
    fn put_lane<U: Real<Scalar = T>>(&self, batch: &mut Self::With<U>, i: usize) {
        self.onto(batch, &mut |place, x| place.set_lane(i, x));
    }
}

impl<T: Real, R: Record<T>> RecordExt<T> for R {}

/// The same record, copied number by number: a copy in wider pieces would wait until the numbers just
/// written have left the store buffer, and one of many vehicles would be a call. As a whole where a part is a
/// register of several numbers: then the pieces are as wide as what was written.
#[inline(always)]
pub fn same<T: Real, R: Record<T, With<T> = R>>(record: &R) -> R {
    if T::LANES > T::PARTS { *record } else { R::zip([record], &mut |[x]| x) }
}

/// The same record, copied as [`same`] does for one vehicle; as a whole for many, who live in memory anyway.
#[inline(always)]
pub fn near<T: Real, R: Record<T, With<T> = R> + Copy>(record: &R) -> R {
    if T::LANES == 1 { same(record) } else { *record }
}

/// What `look` answers about the record. A call may look at it: then one vehicle's record is copied for it,
/// since what a call looks at does not stay in registers; those of many vehicles live in memory anyway.
#[inline(always)]
pub fn shown<T: Real, R: Record<T, With<T> = R>, A>(record: &R, look: impl FnOnce(&R) -> A) -> A {
    if T::PARTS == 1 { look(&same(record)) } else { look(record) }
}

/// `new` where the mask says yes, else `old`.
#[inline(always)]
pub fn blend<T: Real, R: Record<T, With<T> = R>>(mask: T::Mask, new: &R, old: &R) -> R {
    R::zip([new, old], &mut |[a, b]| T::select(mask, a, b))
}

/// Every number clamped to `-limit..=limit`.
#[inline(always)]
pub fn clamp<T: Real, R: Record<T>>(record: &R, limit: T) -> R {
    let mut clamped = *record;
    for i in 0..T::PARTS {
        let limit = limit.part(i);
        record
            .pick_part(i)
            .onto::<T>(&mut clamped, &mut |place, x| place.set_part(i, x.clamp(-limit, limit)));
    }
    clamped
}

/// The number is the smallest record.
impl<T: Real> Record<T> for T {
    type With<U: Real> = U;
    #[inline(always)]
    fn visit(&self, path: &Path<'_>, meta: &Meta, v: &mut impl Visitor<T>) {
        v.number(path, meta, *self);
    }
    #[inline(always)]
    fn visit_mut(&mut self, path: &Path<'_>, meta: &Meta, v: &mut impl VisitorMut<T>) {
        v.number(path, meta, self);
    }
    #[inline(always)]
    fn zip<const M: usize, U: Real>(rows: [&Self; M], f: &mut impl FnMut([T; M]) -> U) -> U {
        f(each(rows, |x| *x))
    }
    #[inline(always)]
    fn pick_part(&self, i: usize) -> T::Part {
        self.part(i)
    }
    #[inline(always)]
    fn onto<U: Real>(&self, batch: &mut U, f: &mut impl FnMut(&mut U, T)) {
        f(batch, *self);
    }
    #[inline(always)]
    fn each_variable(&self, f: &mut impl FnMut(T)) {
        f(*self);
    }
}

/// A value that one number can fill: a number itself, or a vector with equal components.
pub trait Uniform {
    /// The value with `x` in every place.
    fn uniform(x: f64) -> Self;
}

impl<T: Real> Uniform for T {
    #[inline(always)]
    fn uniform(x: f64) -> Self {
        T::lit(x)
    }
}

/// Array positions as names; a longer list in a record does not compile.
const INDEX: [&str; 16] =
    ["0", "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13", "14", "15"];

impl<T: Real, R: Record<T>, const K: usize> Record<T> for [R; K] {
    type With<U: Real> = [R::With<U>; K];
    #[inline(always)]
    fn visit(&self, path: &Path<'_>, meta: &Meta, v: &mut impl Visitor<T>) {
        const { assert!(K <= INDEX.len(), "a list this long has no names") };
        for (item, name) in self.iter().zip(INDEX) {
            item.visit(&path.join(name), meta, v);
        }
    }
    #[inline(always)]
    fn visit_mut(&mut self, path: &Path<'_>, meta: &Meta, v: &mut impl VisitorMut<T>) {
        const { assert!(K <= INDEX.len(), "a list this long has no names") };
        for (item, name) in self.iter_mut().zip(INDEX) {
            item.visit_mut(&path.join(name), meta, v);
        }
    }
    #[inline(always)]
    fn zip<const M: usize, U: Real>(
        rows: [&Self; M],
        f: &mut impl FnMut([T; M]) -> U,
    ) -> Self::With<U> {
        // No closure round the items: the compiler would not inline it where they are large.
        let mut out = [R::zip(each(rows, |row| &row[0]), f); K];
        from_one!(K, k => out[k] = R::zip(each(rows, |row| &row[k]), f));
        out
    }
    #[inline(always)]
    fn pick_part(&self, i: usize) -> Self::With<T::Part> {
        let mut out = [self[0].pick_part(i); K];
        from_one!(K, k => out[k] = self[k].pick_part(i));
        out
    }
    #[inline(always)]
    fn onto<U: Real>(&self, batch: &mut Self::With<U>, f: &mut impl FnMut(&mut U, T)) {
        self[0].onto(&mut batch[0], f);
        from_one!(K, k => self[k].onto(&mut batch[k], f));
    }
    #[inline(always)]
    fn each_variable(&self, f: &mut impl FnMut(T)) {
        self[0].each_variable(f);
        from_one!(K, k => self[k].each_variable(f));
    }
}

/// The record without numbers.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nothing<T>(PhantomData<T>);

impl<T: Real> Record<T> for Nothing<T> {
    type With<U: Real> = Nothing<U>;
    #[inline(always)]
    fn visit(&self, _: &Path<'_>, _: &Meta, _: &mut impl Visitor<T>) {}
    #[inline(always)]
    fn visit_mut(&mut self, _: &Path<'_>, _: &Meta, _: &mut impl VisitorMut<T>) {}
    #[inline(always)]
    fn zip<const M: usize, U: Real>(
        _: [&Self; M],
        _: &mut impl FnMut([T; M]) -> U,
    ) -> Self::With<U> {
        Nothing(PhantomData)
    }
    #[inline(always)]
    fn pick_part(&self, _: usize) -> Nothing<T::Part> {
        Nothing(PhantomData)
    }
    #[inline(always)]
    fn onto<U: Real>(&self, _: &mut Nothing<U>, _: &mut impl FnMut(&mut U, T)) {}
    #[inline(always)]
    fn each_variable(&self, _: &mut impl FnMut(T)) {}
}

/// Declares a record.
///
/// ```
/// use stormpetrel_control::record;
/// record! {
///     /// Gains of a law.
///     pub struct Gains {
///         /// Proportional gain.
///         kp: T [1/s^2] = 6.0, in 0.0 => 1e6;
///     }
/// }
/// assert_eq!(Gains::<f64>::default().kp, 6.0);
/// ```
///
/// A field is `name: Type [unit]`, for gains followed by `= default, in lowest => highest`, then `;`.
/// After the numbers may stand `structure { name: Type; }`: options, equal in all lanes of a batch.
/// `Default` gives the declared defaults; a number without one is zero.
#[macro_export]
macro_rules! record {
    (
        $(#[$m:meta])* $vis:vis struct $name:ident {
            $( $(#[doc = $doc:literal])+ $f:ident : $ty:ty [$($unit:tt)*] $(= $default:literal, in $lo:literal => $hi:literal)? ; )*
            $( structure { $( $(#[$om:meta])* $o:ident : $oty:ty; )* } )?
        }
    ) => {
        $(#[$m])*
        #[derive(Clone, Copy, Debug)]
        $vis struct $name<T> {
            $( $(#[doc = $doc])+ pub $f: $ty, )*
            $( $( $(#[$om])* pub $o: $oty, )* )?
        }

        impl<T: $crate::real::Real> Default for $name<T> {
            #[inline]
            fn default() -> Self {
                Self {
                    $( $f: $crate::record!(@default $ty, $($default)?), )*
                    $( $( $o: Default::default(), )* )?
                }
            }
        }

        impl<T: $crate::real::Real> $crate::record::Record<T> for $name<T>
        {
            type With<U: $crate::real::Real> = $name<U>;

            #[inline(always)]
            #[allow(unused_variables)] // a record without such numbers uses none
            fn visit(&self, path: &$crate::record::Path<'_>, _: &$crate::record::Meta, v: &mut impl $crate::record::Visitor<T>) {
                $( $crate::record::Record::visit(&self.$f, &path.join(stringify!($f)), &$crate::record!(@meta [$($unit)*] [$($doc)+] $($lo, $hi)?), v); )*
            }
            #[inline(always)]
            #[allow(unused_variables)] // a record without such numbers uses none
            fn visit_mut(&mut self, path: &$crate::record::Path<'_>, _: &$crate::record::Meta, v: &mut impl $crate::record::VisitorMut<T>) {
                $( $crate::record::Record::visit_mut(&mut self.$f, &path.join(stringify!($f)), &$crate::record!(@meta [$($unit)*] [$($doc)+] $($lo, $hi)?), v); )*
            }
            #[inline(always)]
            #[allow(unused_variables)] // a record without such numbers uses none
            fn zip<const M: usize, U: $crate::real::Real>(rows: [&Self; M], f: &mut impl FnMut([T; M]) -> U) -> $name<U> {
                $name {
                    $( $f: $crate::record::Record::zip($crate::record::each(rows, |row| &row.$f), f), )*
                    $( $( $o: rows[0].$o, )* )?
                }
            }
            #[inline(always)]
            #[allow(unused_variables)] // a record without such numbers uses none
            fn pick_part(&self, i: usize) -> $name<T::Part> {
                $name {
                    $( $f: $crate::record::Record::pick_part(&self.$f, i), )*
                    $( $( $o: self.$o, )* )?
                }
            }
            #[inline(always)]
            #[allow(unused_variables)] // a record without such numbers uses none
            fn onto<U: $crate::real::Real>(&self, batch: &mut $name<U>, f: &mut impl FnMut(&mut U, T)) {
                $( $crate::record::Record::onto(&self.$f, &mut batch.$f, f); )*
            }
            #[inline(always)]
            #[allow(unused_variables)] // a record without such numbers uses none
            fn each_variable(&self, f: &mut impl FnMut(T)) {
                $( $crate::record!(@variable (&self.$f) f $($default)?); )*
            }
        }
    };
    (@default $ty:ty,) => { <$ty as Default>::default() };
    (@default $ty:ty, $default:literal) => { <$ty as $crate::record::Uniform>::uniform($default) };
    (@variable ($field:expr) $visit:ident) => { $crate::record::Record::each_variable($field, $visit) };
    (@variable ($field:expr) $visit:ident $default:literal) => {};
    (@meta [$($unit:tt)*] [$($doc:literal)+]) => {
        $crate::record::Meta::signal(stringify!($($unit)*), concat!($($doc),+))
    };
    (@meta [$($unit:tt)*] [$($doc:literal)+] $lo:literal, $hi:literal) => {
        $crate::record::Meta { unit: stringify!($($unit)*), frame: "", doc: concat!($($doc),+), range: ($lo, $hi) }
    };
}
