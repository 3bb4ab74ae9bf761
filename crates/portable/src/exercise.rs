//! Reaches every registered law in both precisions, with everything that a compiler could foresee
//! hidden from it: what the linker keeps of this is the control stack as firmware would have it.

use core::hint::black_box;

use stormpetrel_control::allocation::Allocation;
use stormpetrel_control::math::inverse4;
use stormpetrel_control::real::Real;
use stormpetrel_control::record::{Meta, Path, Record, RecordExt as _, VisitorMut};
use stormpetrel_control::signals::{Applied, Measurement, Model, Trajectory};
use stormpetrel_control::stack::{Exit, Stack};

use crate::laws::{self, Choose};

/// Takes laws and choices that the compiler cannot foresee.
struct Unforeseen;

impl Choose for Unforeseen {
    fn law(&mut self, names: &'static [&'static str]) -> Option<&'static str> {
        names.get(black_box(0)).copied()
    }
    fn option(&mut self, _: usize) -> usize {
        black_box(0)
    }
}

impl<T: Real> VisitorMut<T> for Unforeseen {
    fn number(&mut self, _: &Path<'_>, _: &Meta, value: &mut T) {
        *value = black_box(*value);
    }
}

/// The record with numbers that the compiler cannot foresee.
fn unforeseen<T: Real, R: Record<T>>(mut record: R) -> R {
    record.visit_mut(&Path::ROOT, &Meta::signal("", ""), &mut Unforeseen);
    record
}

/// Builds a stack and lets it do everything that firmware asks of it; then the allocation.
#[inline(never)]
fn stack<T: Real>() {
    let model = unforeseen(Model::<f64>::default());
    let exit = if black_box(true) { Exit::Wrench } else { Exit::Thrust };
    let Some(built) = laws::stack(&mut Unforeseen, &model, exit) else { return };
    let mut stack: Stack<T> = unforeseen(built.cast());
    let measurement = unforeseen(Measurement::default());
    stack.reset(&measurement);
    let dt = black_box(T::lit(1e-3));
    let command = stack.update(&measurement, &unforeseen(Trajectory::default()), dt);
    black_box(&command);
    stack.advance(&unforeseen(Applied::default()), dt);
    black_box((stack.estimate(), stack.flags()));

    let effect = black_box([[0.0; 4]; 4]);
    let allocation = Allocation {
        inverse: inverse4(effect).unwrap_or_default(),
        effect,
        ..Allocation::default()
    };
    let allocation = unforeseen::<T, _>(allocation.cast());
    black_box(allocation.allocate(&command.wrench));
}

/// All laws in double precision.
#[inline(never)]
pub fn double() {
    stack::<f64>();
}

/// All laws in single precision.
#[inline(never)]
pub fn single() {
    stack::<f32>();
}
