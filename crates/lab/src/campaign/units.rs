//! The unit of a setting, by its dotted path.

use stormpetrel_control::options::{OptionVisitor, Options};
use stormpetrel_control::record::{Meta, Path, Record, VisitorMut};
use stormpetrel_control::registry::Settings;

use crate::scenario::{BlockVisitor, Scenario};

/// The unit of the number at `path`, such as `vehicle.inertia` or `disturbance.0.force.x`; `1` where it
/// has none or is a name.
pub fn unit(scenario: &Scenario, path: &str) -> &'static str {
    let mut search = Search { path, block: String::new(), unit: "1" };
    scenario.clone().blocks(&mut search);
    search.unit
}

struct Search<'a> {
    path: &'a str,
    block: String,
    unit: &'static str,
}

impl VisitorMut<f64> for Search<'_> {
    fn number(&mut self, path: &Path<'_>, meta: &Meta, _: &mut f64) {
        let full = format!("{}.{path}", self.block);
        let whole = full.strip_prefix(self.path);
        if whole.is_some_and(|rest| rest.is_empty() || rest.starts_with('.')) {
            self.unit = meta.unit;
        }
    }
}

impl OptionVisitor for Search<'_> {}

impl BlockVisitor for Search<'_> {
    fn block<S: Settings>(&mut self, key: &'static str, _: &'static str, settings: &mut S) {
        key.clone_into(&mut self.block);
        settings.settings(self);
    }

    fn list<S: Settings>(&mut self, key: &'static str, _: &'static str, settings: &mut Vec<S>) {
        for (i, item) in settings.iter_mut().enumerate() {
            self.block = format!("{key}.{i}");
            item.settings(self);
        }
    }

    fn plain<R: Record<f64>, O: Options>(
        &mut self,
        key: &'static str,
        _: &'static str,
        numbers: &mut R,
        _: &mut O,
    ) {
        key.clone_into(&mut self.block);
        numbers.visit_mut(&Path::ROOT, &Meta::signal("", ""), self);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_found_by_path() {
        let scenario = Scenario::defaults();
        for (path, expected) in [
            ("vehicle.mass", "kg"),
            ("vehicle.inertia", "kg m^2"),
            ("vehicle.inertia.y", "kg m^2"),
            ("run.duration", "s"),
            ("observer.law", "1"),
            ("vehicle.mas", "1"),
        ] {
            assert_eq!(unit(&scenario, path), expected, "{path}");
        }
    }
}
