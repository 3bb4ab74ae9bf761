//! What the tables of a scenario hold: a file may change and keep its name.

use stormpetrel_control::options::{Cells, OptionVisitor, Options, Shape};
use stormpetrel_control::record::{Meta, Path, Record, VisitorMut};
use stormpetrel_control::registry::Settings;

use super::random::key;
use crate::scenario::{BlockVisitor, Scenario};

/// Every file that the tables of this scenario came from, with a hash of its numbers.
pub(super) fn contents(scenario: &Scenario) -> Vec<(String, u64)> {
    let mut files = Files(Vec::new());
    scenario.clone().blocks(&mut files);
    files.0
}

struct Files(Vec<(String, u64)>);

impl BlockVisitor for Files {
    fn block<S: Settings>(&mut self, _: &'static str, _: &'static str, settings: &mut S) {
        settings.settings(self);
    }

    fn list<S: Settings>(&mut self, _: &'static str, _: &'static str, settings: &mut Vec<S>) {
        for one in settings {
            one.settings(self);
        }
    }

    fn plain<R: Record<f64>, O: Options>(
        &mut self,
        _: &'static str,
        _: &'static str,
        _: &mut R,
        options: &mut O,
    ) {
        options.visit(self);
    }
}

impl VisitorMut<f64> for Files {
    fn number(&mut self, _: &Path<'_>, _: &Meta, _: &mut f64) {}
}

impl OptionVisitor for Files {
    fn choice(
        &mut self,
        _: &'static str,
        _: &'static str,
        _: &'static [&'static str],
        _: &'static [&'static str],
        current: usize,
    ) -> usize {
        current
    }

    fn rows(&mut self, _: &'static str, _: &'static str, _: &Shape, current: Cells) -> Cells {
        if !current.file.is_empty() {
            let hash = current.cells.iter().fold(0, |state, x| key(state, x.to_bits()));
            self.0.push((current.file.to_owned(), hash));
        }
        current
    }
}
