//! What is wrong with one row of a free layout.

use stormpetrel_control::options::Cells;
use stormpetrel_plant::vehicle::{Arms, Vehicle};

use super::document::{Node, Table, Value};
use super::fault::{Fault, Place};

/// Columns of a row: x, y, z, spin.
const COLUMNS: usize = 4;

/// Refuses a rotor of a free layout that turns neither way, and remembers the vehicle as broken.
pub(super) fn check(
    vehicle: &Vehicle<f64>,
    tree: &Table,
    broken: &mut Vec<&'static str>,
    faults: &mut Vec<Fault>,
) {
    if let Some(fault) = idle(vehicle, tree).filter(|_| !broken.contains(&"vehicle")) {
        faults.push(fault);
        broken.push("vehicle");
    }
}

/// The first rotor that turns neither way.
fn idle(vehicle: &Vehicle<f64>, tree: &Table) -> Option<Fault> {
    let rows = vehicle.layout.rotors;
    if vehicle.layout.arms != Arms::Free {
        return None;
    }
    let turns = |row: &usize| [-1.0, 1.0].contains(&rows.cell(*row, COLUMNS - 1));
    let row = (0..rows.len()).find(|row| !turns(row))?;
    let spin = rows.cell(row, COLUMNS - 1);
    let Cells { file, .. } = rows.table;
    let of = if file.is_empty() { String::new() } else { format!(" of {file}") };
    let message = format!("`vehicle.rotors.{row}.spin`{of} = {spin}: must be 1 or -1");
    let help = format!("rotor {} turns counter-clockwise (1) or clockwise (-1)", row + 1);
    Some(Fault { place: place(tree, row), message, help: Some(help) })
}

/// Where the spin of a row stands; the name of the file where the rows stand in one.
fn place(tree: &Table, row: usize) -> Option<Place> {
    let Value::Table(vehicle) = &tree.get("vehicle")?.value else { return None };
    let node = vehicle.get("rotors")?;
    let cell = item(node, row).and_then(|row| item(row, COLUMNS - 1));
    Some(cell.unwrap_or(node).place.clone())
}

fn item(node: &Node, at: usize) -> Option<&Node> {
    match &node.value {
        Value::List(items) => items.get(at),
        _ => None,
    }
}
