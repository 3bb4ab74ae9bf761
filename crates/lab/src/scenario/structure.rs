//! The part of a scenario that the flights of a batch must share.

use std::fmt::Write;

use stormpetrel_control::options::{Cells, OptionVisitor, Options, Shape};
use stormpetrel_control::record::{Meta, Path, Record, VisitorMut};
use stormpetrel_control::registry::Settings;

use super::{ATTITUDE_LEVELS, BlockVisitor, Scenario};

impl Scenario {
    /// Names and choices, without numbers: equal in all flights of a batch.
    pub fn structure(&self) -> String {
        let mut structure = Structure { text: String::new(), skip: !self.has_attitude() };
        self.clone().blocks(&mut structure);
        let flight = self.flight();
        let _ = write!(
            structure.text,
            "ticks={} substeps={} every={:?} cares={:?} late={} drops={}",
            self.ticks(),
            self.run.substeps,
            flight.stack.every,
            flight.cares,
            flight.timing.late,
            flight.timing.drops,
        );
        structure.text
    }
}

struct Structure {
    text: String,
    skip: bool,
}

impl BlockVisitor for Structure {
    fn block<S: Settings>(&mut self, key: &'static str, _: &'static str, settings: &mut S) {
        if self.skip && ATTITUDE_LEVELS.contains(&key) {
            return;
        }
        // Presets of a vehicle differ in numbers and choices only.
        let name = if key == "vehicle" { "" } else { settings.name() };
        let _ = write!(self.text, "{key}: {name}");
        settings.settings(self);
        self.text.push_str("; ");
    }

    fn list<S: Settings>(&mut self, key: &'static str, _: &'static str, settings: &mut Vec<S>) {
        let _ = write!(self.text, "{key}: ");
        for one in settings {
            self.text.push_str(one.name());
            one.settings(self);
            self.text.push_str(", ");
        }
        self.text.push_str("; ");
    }

    /// How a flight starts and ends changes its numbers, not its structure.
    fn plain<R: Record<f64>, O: Options>(
        &mut self,
        _: &'static str,
        _: &'static str,
        _: &mut R,
        _: &mut O,
    ) {
    }
}

impl VisitorMut<f64> for Structure {
    fn number(&mut self, _: &Path<'_>, _: &Meta, _: &mut f64) {}
}

impl OptionVisitor for Structure {
    fn choice(
        &mut self,
        name: &'static str,
        _: &'static str,
        _: &'static [&'static str],
        _: &'static [&'static str],
        current: usize,
    ) -> usize {
        let _ = write!(self.text, " {name}={current}");
        current
    }

    fn rows(&mut self, name: &'static str, _: &'static str, _: &Shape, current: Cells) -> Cells {
        // Equal tables are kept once, so their place tells them apart.
        let _ = write!(self.text, " {name}={:p}", current.cells);
        current
    }
}
