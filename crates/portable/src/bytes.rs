//! Numbers of records as bytes, little end first: written, read back, compared.

use core::fmt::{Arguments, Display};

use stormpetrel_control::real::Real;
use stormpetrel_control::record::{Meta, Path, Record, Visitor, VisitorMut};

/// A scalar that a recording may hold.
pub trait Number: Real<Scalar = Self> + Display {
    /// Bytes of one number.
    const BYTES: u8;
    /// Hands the bytes of the number to `out`.
    fn put(self, out: &mut impl FnMut(&[u8]));
    /// Takes a number off the front; `None` at the end.
    fn take(bytes: &mut &[u8]) -> Option<Self>;
    /// The bits, widened with zeros.
    fn bits(self) -> u64;
}

macro_rules! number {
    ($float:ident, $bytes:literal) => {
        impl Number for $float {
            const BYTES: u8 = $bytes;
            fn put(self, out: &mut impl FnMut(&[u8])) {
                out(&self.to_le_bytes());
            }
            fn take(bytes: &mut &[u8]) -> Option<Self> {
                array(bytes).map(Self::from_le_bytes)
            }
            fn bits(self) -> u64 {
                self.to_bits().into()
            }
        }
    };
}
number!(f64, 8);
number!(f32, 4);

/// Takes `N` bytes off the front; `None` where there are fewer.
pub fn array<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (first, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(*first)
}

const PLAIN: Meta = Meta::signal("", "");

struct Put<'a, F>(&'a mut F);

impl<T: Number, F: FnMut(&[u8])> Visitor<T> for Put<'_, F> {
    fn number(&mut self, _: &Path<'_>, _: &Meta, value: T) {
        value.put(self.0);
    }
}

/// Hands the bytes of every number of the record to `out`.
pub fn put<T: Number>(record: &impl Record<T>, out: &mut impl FnMut(&[u8])) {
    record.visit(&Path::ROOT, &PLAIN, &mut Put(out));
}

struct Take<'a, 'b> {
    bytes: &'a mut &'b [u8],
    whole: bool,
}

impl<T: Number> VisitorMut<T> for Take<'_, '_> {
    fn number(&mut self, _: &Path<'_>, _: &Meta, value: &mut T) {
        match T::take(self.bytes) {
            Some(read) => *value = read,
            None => self.whole = false,
        }
    }
}

/// Overwrites every number of the record from the bytes; `None` where these end before.
pub fn take<T: Number>(record: &mut impl Record<T>, bytes: &mut &[u8]) -> Option<()> {
    let mut reader = Take { bytes, whole: true };
    record.visit_mut(&Path::ROOT, &PLAIN, &mut reader);
    reader.whole.then_some(())
}

struct Compare<'a, 'b, F> {
    bytes: &'a mut &'b [u8],
    say: &'a mut F,
    different: u32,
}

impl<T: Number, F: FnMut(Arguments<'_>)> Visitor<T> for Compare<'_, '_, F> {
    fn number(&mut self, path: &Path<'_>, _: &Meta, value: T) {
        let recorded = T::take(self.bytes);
        if recorded.is_some_and(|recorded| recorded.bits() == value.bits()) {
            return;
        }
        self.different += 1;
        if self.different > 1 {
            return;
        }
        match recorded {
            Some(old) => (self.say)(format_args!(
                "{path}: {value} ({:#x}), recorded {old} ({:#x})",
                value.bits(),
                old.bits()
            )),
            None => (self.say)(format_args!("{path}: the recording ends")),
        }
    }
}

/// How many numbers of the record have other bits than those on the front of `bytes`; the first one
/// is told to `say`.
pub fn compare<T: Number>(
    record: &impl Record<T>,
    bytes: &mut &[u8],
    say: &mut impl FnMut(Arguments<'_>),
) -> u32 {
    let mut compare = Compare { bytes, say, different: 0 };
    record.visit(&Path::ROOT, &PLAIN, &mut compare);
    compare.different
}
