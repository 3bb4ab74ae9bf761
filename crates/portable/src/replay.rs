//! Replay: a control stack is told again what it was told when it was recorded, and must answer with
//! the same bits. [`Recorder`] writes what [`replay`] reads.
//!
//! A recording holds, little end first: the mark; the bytes of one number; for each of the five
//! blocks the name of its law (length, text) and the positions of its choices, one byte each; all
//! numbers of the stack in the order of `visit_mut`; the number of ticks; for each tick measurement,
//! trajectory, dt, what was applied, and the answers: command, and estimate afterwards; at last all
//! numbers of the stack again.

use core::fmt::Arguments;

use stormpetrel_control::options::OptionVisitor;
use stormpetrel_control::record;
use stormpetrel_control::record::{Meta, Path, RecordExt as _, VisitorMut};
use stormpetrel_control::registry::Settings;
use stormpetrel_control::signals::{Applied, Measurement, Model, Trajectory};
use stormpetrel_control::stack::{Exit, Stack};

use crate::bytes::{Number, array, compare, put, take};
use crate::laws::{self, Choose};

/// The first bytes of a recording, its format included.
const MARK: [u8; 8] = *b"storm\0v1";

record! {
    /// What a stack is told at one tick.
    pub struct Input {
        /// What the laws know of the vehicle.
        measurement: Measurement<T> [];
        /// Where to be.
        trajectory: Trajectory<T> [];
        /// Time to the next tick.
        dt: T [s];
        /// What drove the vehicle until then.
        applied: Applied<T> [];
    }
}

/// Writes a recording piece by piece to `out`.
#[derive(Debug)]
pub struct Recorder<F>(pub F);

impl<F: FnMut(&[u8])> Recorder<F> {
    /// The mark and the precision; the five blocks follow.
    pub fn begin<T: Number>(&mut self) {
        (self.0)(&MARK);
        (self.0)(&[T::BYTES]);
    }

    /// One block: its law and choices.
    pub fn block<S: Settings>(&mut self, settings: &mut S) {
        let name = settings.name();
        (self.0)(&[u8::try_from(name.len()).unwrap_or(u8::MAX)]);
        (self.0)(name.as_bytes());
        settings.settings(&mut Choices(&mut self.0));
    }

    /// All numbers of the stack, and how many ticks will follow.
    pub fn start<T: Number>(&mut self, stack: &Stack<T>, ticks: u32) {
        put(stack, &mut self.0);
        (self.0)(&ticks.to_le_bytes());
    }

    /// Lets the stack live one tick and writes down what it is told and what it answers.
    pub fn tick<T: Number>(&mut self, stack: &mut Stack<T>, input: &Input<T>) {
        put(input, &mut self.0);
        let command = stack.update(&input.measurement, &input.trajectory, input.dt);
        put(&command, &mut self.0);
        stack.advance(&input.applied, input.dt);
        put(&stack.estimate(), &mut self.0);
    }

    /// All numbers of the stack after the last tick.
    pub fn end<T: Number>(&mut self, stack: &Stack<T>) {
        put(stack, &mut self.0);
    }
}

/// Writes the positions of a law's choices.
struct Choices<'a, F>(&'a mut F);

impl<F> VisitorMut<f64> for Choices<'_, F> {
    fn number(&mut self, _: &Path<'_>, _: &Meta, _: &mut f64) {}
}

impl<F: FnMut(&[u8])> OptionVisitor for Choices<'_, F> {
    fn choice(
        &mut self,
        _: &'static str,
        _: &'static str,
        _: &'static [&'static str],
        _: &'static [&'static str],
        current: usize,
    ) -> usize {
        (self.0)(&[u8::try_from(current).unwrap_or(u8::MAX)]);
        current
    }
}

/// Reads the laws off the front of a recording.
struct Laws<'a, 'b>(&'a mut &'b [u8]);

impl Choose for Laws<'_, '_> {
    fn law(&mut self, names: &'static [&'static str]) -> Option<&'static str> {
        let [length] = array(self.0)?;
        let (name, rest) = self.0.split_at_checked(length.into())?;
        *self.0 = rest;
        names.iter().copied().find(|known| known.as_bytes() == name)
    }

    fn option(&mut self, _: usize) -> usize {
        array(self.0).map_or(0, |[position]| position.into())
    }
}

/// Why a replay failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Failure {
    /// The recording is cut, of another precision, or names laws that do not exist.
    Unreadable,
    /// So many numbers of this tick have other bits; the tick after the last is the final state.
    Differs {
        /// Ticks before it.
        tick: u32,
        /// Numbers with other bits.
        numbers: u32,
    },
}

/// Takes a recording of this precision off the front of `bytes` and replays it; gives the number of
/// ticks. The first number with other bits is told to `say`.
///
/// # Errors
/// Where the recording cannot be read or an answer differs in one bit.
pub fn replay<T: Number>(
    bytes: &mut &[u8],
    say: &mut impl FnMut(Arguments<'_>),
) -> Result<u32, Failure> {
    let (mut stack, ticks) = opened::<T>(bytes).ok_or(Failure::Unreadable)?;
    for tick in 0..ticks {
        let mut input = Input::<T>::default();
        take(&mut input, bytes).ok_or(Failure::Unreadable)?;
        let command = stack.update(&input.measurement, &input.trajectory, input.dt);
        stack.advance(&input.applied, input.dt);
        let numbers = compare(&command, bytes, say) + compare(&stack.estimate(), bytes, say);
        same(numbers, tick)?;
    }
    same(compare(&stack, bytes, say), ticks)?;
    Ok(ticks)
}

/// [`replay`] of a recording in double and then one in single precision: what [`crate::record`]
/// makes. Gives the ticks of both.
///
/// # Errors
/// As [`replay`].
pub fn replay_both(
    mut bytes: &[u8],
    say: &mut dyn FnMut(Arguments<'_>),
) -> Result<[u32; 2], Failure> {
    let double = replay::<f64>(&mut bytes, &mut |text| say(format_args!("f64 {text}")))?;
    let single = replay::<f32>(&mut bytes, &mut |text| say(format_args!("f32 {text}")))?;
    if bytes.is_empty() { Ok([double, single]) } else { Err(Failure::Unreadable) }
}

fn same(numbers: u32, tick: u32) -> Result<(), Failure> {
    if numbers == 0 { Ok(()) } else { Err(Failure::Differs { tick, numbers }) }
}

fn opened<T: Number>(bytes: &mut &[u8]) -> Option<(Stack<T>, u32)> {
    if array(bytes)? != MARK || array(bytes)? != [T::BYTES] {
        return None;
    }
    let stack = laws::stack(&mut Laws(bytes), &Model::default(), Exit::Wrench)?;
    let mut stack: Stack<T> = stack.cast();
    take(&mut stack, bytes)?;
    Some((stack, u32::from_le_bytes(array(bytes)?)))
}
