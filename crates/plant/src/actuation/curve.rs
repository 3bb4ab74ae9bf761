//! Curves of measured points, straight between them.

use stormpetrel_control::columns;
use stormpetrel_control::options::{Columns, Rows};
use stormpetrel_control::real::Real;

columns! {
    /// A measured rotor: thrust and drag torque by speed.
    pub struct RotorCurve, 0 => 200 rows, first grows {
        speed [rad/s] in 0.0 => 2e4;
        thrust [N] in 0.0 => 1e4;
        torque [N m] in 0.0 => 1e3;
    }
}

columns! {
    /// A battery without load: voltage by the share of charge that is left.
    pub struct OpenCircuit, 0 => 200 rows, first grows {
        charge [1] in 0.0 => 1.0;
        voltage [V] in 0.0 => 1e3;
    }
}

/// The columns after the first at `x`, straight between the rows, constant outside; column zero of the
/// answer is the table's second. Zero where the table is empty.
#[inline(always)]
pub fn look_up<C: Columns, const N: usize>(rows: &Rows<C>, x: f64) -> [f64; N] {
    let (mut low, mut high) = (0, rows.len().saturating_sub(1));
    while high > low + 1 {
        let middle = usize::midpoint(low, high);
        if rows.cell(middle, 0) <= x {
            low = middle;
        } else {
            high = middle;
        }
    }
    let (a, b) = (rows.cell(low, 0), rows.cell(high, 0));
    let along = if b > a { Real::clamp((x - a) / (b - a), 0.0, 1.0) } else { 0.0 };
    core::array::from_fn(|column| {
        let (from, to) = (rows.cell(low, column + 1), rows.cell(high, column + 1));
        from + (to - from) * along
    })
}

/// [`look_up`] for every lane.
#[inline(always)]
pub fn look_up_lanes<T: Real, C: Columns, const N: usize>(rows: &Rows<C>, x: T) -> [T; N] {
    let mut found = [T::zero(); N];
    for i in 0..T::LANES {
        let one: [f64; N] = look_up(rows, x.lane(i).to_f64());
        for column in 0..N {
            found[column].set_lane(i, T::Scalar::lit(one[column]));
        }
    }
    found
}
