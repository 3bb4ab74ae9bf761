//! Curves for the references that follow a table: waypoints, gates, a recording.
//!
//! A reference is a plain value without memory, so its polynomials are computed once where the scenario is
//! read, and kept as long as the program lives. They depend on the table alone: a campaign that varies
//! limits flies all its flights along one copy.

mod banded;
mod fit;
mod snap;

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use stormpetrel_control::options::Cells;
use stormpetrel_control::real::Real;
use stormpetrel_plant::reference::ReferenceSettings;
use stormpetrel_plant::reference::piecewise::{Curve, Piece};
use stormpetrel_plant::reference::table::Ends;

use snap::Course;

/// Why there is no curve through a table: the table's name in the block, what is wrong, what to do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unfit {
    /// Key of the table.
    pub key: &'static str,
    /// What is wrong, without the table's name.
    pub message: String,
    /// What to do.
    pub help: &'static str,
}

/// How well a fit follows its table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FitError {
    /// Largest distance from a row, m.
    pub worst: f64,
    /// Root mean square of the distances, m.
    pub rms: f64,
    /// Polynomials in the fit.
    pub pieces: usize,
}

/// How well the reference follows its table; `None` where it has none to fit.
pub fn fit_error(reference: &ReferenceSettings) -> Option<FitError> {
    let ReferenceSettings::Table(_, options) = reference else { return None };
    let Curve { worst_fit, mean_fit, pieces, .. } = options.curve;
    Some(FitError { worst: worst_fit, rms: mean_fit, pieces: pieces.len() })
}

/// Gives the reference the curve through its table, where it has one.
///
/// # Errors
/// Where there is no such curve.
pub fn prepare(reference: &mut ReferenceSettings) -> Result<(), Unfit> {
    match reference {
        ReferenceSettings::MinimumSnap(_, options) => {
            options.curve = once("waypoints", options.waypoints.table, through)?;
        }
        ReferenceSettings::Race(_, options) => {
            options.curve = once("gates", options.gates.table, round)?;
        }
        ReferenceSettings::Table(_, options) => {
            options.curve = match options.ends {
                Ends::Free => once("rows", options.rows.table, |cells| along(cells, false))?,
                Ends::Rest => once("rows at rest", options.rows.table, |cells| along(cells, true))?,
            };
        }
        _ => {}
    }
    Ok(())
}

/// Result of making a curve: what is wrong and what to do otherwise.
type Made = Result<Curve, (String, &'static str)>;

/// The curve of this kind through this table, made the first time. The kind begins with the table's key.
/// Equal tables are kept once, so their place is their name.
fn once(kind: &'static str, table: Cells, make: fn(&[f64]) -> Made) -> Result<Curve, Unfit> {
    static CURVES: Mutex<BTreeMap<(&str, usize), Made>> = Mutex::new(BTreeMap::new());
    let mut curves = CURVES.lock().unwrap_or_else(PoisonError::into_inner);
    let place = (kind, table.cells.as_ptr().addr());
    let made = curves.entry(place).or_insert_with(|| make(table.cells)).clone();
    let key = kind.split(' ').next().unwrap_or(kind);
    made.map_err(|(message, help)| Unfit { key, message, help })
}

const NO_SOLUTION: &str = "bring the points to distances that differ less";

/// Minimum snap through waypoints, from rest to rest.
fn through(cells: &[f64]) -> Made {
    let [x, y, z, yaw] = columns(cells);
    let yaw = unwrapped(&yaw);
    let (rows, all) = (x.len(), [x, y, z, yaw]);
    let lengths = lengths(&all, ("waypoint", rows))?;
    let last = lengths.len();
    let given = |i: usize| if i == 0 || i == last { [Some(0.0); 3] } else { [None; 3] };
    let courses = all.map(|values| {
        let given = (0..=last).map(given).collect();
        Course { values, given, closed: false }
    });
    finished(&lengths, &courses, 0.0)
}

/// Minimum snap round a track through the centres of gates, along their headings.
fn round(cells: &[f64]) -> Made {
    let [mut x, mut y, mut z, mut yaw] = columns(cells);
    let rows = x.len();
    for column in [&mut x, &mut y, &mut z, &mut yaw] {
        column.push(column[0]);
    }
    let lengths = lengths(&[x.clone(), y.clone(), z.clone()], ("gate", rows))?;
    let directions: Vec<(f64, f64)> = yaw.iter().map(|yaw| Real::sin_cos(*yaw)).collect();
    let yaw = unwrapped(&yaw);
    let turn = yaw[yaw.len() - 1] - yaw[0];
    let given = |speed: &dyn Fn(&(f64, f64)) -> Option<f64>| {
        directions.iter().map(|direction| [speed(direction), None, None]).collect()
    };
    let courses = [
        Course { values: x, given: given(&|(_, cos)| Some(*cos)), closed: true },
        Course { values: y, given: given(&|(sin, _)| Some(*sin)), closed: true },
        Course { values: z, given: given(&|_| Some(0.0)), closed: true },
        Course { values: yaw, given: given(&|_| None), closed: true },
    ];
    finished(&lengths, &courses, turn)
}

/// A fit of a recording; with `rest` between two rests.
fn along(cells: &[f64], rest: bool) -> Made {
    let [t, x, y, z, yaw] = columns(cells);
    let times: Vec<f64> = t.iter().map(|time| time - t[0]).collect();
    let Some(fit) = fit::fit(&times, &[x, y, z, unwrapped(&yaw)], rest) else {
        return Err(("has no fit".into(), "give at least 12 rows, evenly spaced in time"));
    };
    let pieces = Vec::leak(fit.pieces);
    Ok(Curve { pieces, worst_fit: fit.worst, mean_fit: fit.mean, ..Curve::default() })
}

/// The columns of a table.
fn columns<const N: usize>(cells: &[f64]) -> [Vec<f64>; N] {
    std::array::from_fn(|column| cells.iter().skip(column).step_by(N).copied().collect())
}

/// Angles in rad without jumps: each within half a turn of the one before.
fn unwrapped(angles: &[f64]) -> Vec<f64> {
    let turn = std::f64::consts::TAU;
    let mut last = angles.first().copied().unwrap_or(0.0);
    let near = |angle: &f64| {
        last = angle + Real::round((last - angle) / turn) * turn;
        last
    };
    angles.iter().map(near).collect()
}

/// Distances between neighbours, headings counted in. After the last of the `rows` may stand the first.
fn lengths<const N: usize>(
    columns: &[Vec<f64>; N],
    (what, rows): (&str, usize),
) -> Result<Vec<f64>, (String, &'static str)> {
    let count = columns.first().map_or(0, Vec::len);
    let step = |i: usize| {
        let square = |column: &Vec<f64>| (column[i + 1] - column[i]) * (column[i + 1] - column[i]);
        columns.iter().map(square).sum::<f64>().sqrt()
    };
    let lengths: Vec<f64> = (0..count - 1).map(step).collect();
    match lengths.iter().position(|length| *length < CLOSEST) {
        None => Ok(lengths),
        Some(i) => {
            let message = format!("has {what} {} where {what} {i} is", (i + 1) % rows);
            Err((message, "take one of them out; rows count from zero"))
        }
    }
}

/// Points closer than this are one point, m.
const CLOSEST: f64 = 1e-3;

/// The curve of least snap with its largest derivatives.
fn finished(lengths: &[f64], courses: &[Course; 4], turn: f64) -> Made {
    let pieces = snap::pieces(lengths, courses).map(Vec::leak);
    let none = || ("has no curve of least snap".to_owned(), NO_SOLUTION);
    let curve = Curve { pieces: pieces.ok_or_else(none)?, turn, ..Curve::default() };
    Ok(with_extremes(curve))
}

/// Points of a piece at which the largest derivatives are looked for.
const POINTS: u32 = 256;
/// The largest value between two such points is higher by less than this share.
const BETWEEN: f64 = 1e-3;

fn with_extremes(mut curve: Curve) -> Curve {
    let greater = |a: f64, b: f64| if b > a { b } else { a };
    for Piece { begin, length, .. } in curve.pieces {
        for i in 0..=POINTS {
            let phase = begin + length * f64::from(i) / f64::from(POINTS);
            let at = curve.at([phase, 1.0, 0.0, 0.0, 0.0]);
            curve.speed = greater(curve.speed, at.velocity.norm());
            curve.acceleration = greater(curve.acceleration, at.acceleration.norm());
            curve.yaw_rate = greater(curve.yaw_rate, at.yaw_rate.abs());
        }
    }
    for largest in [&mut curve.speed, &mut curve.acceleration, &mut curve.yaw_rate] {
        *largest *= 1.0 + BETWEEN;
    }
    curve
}
