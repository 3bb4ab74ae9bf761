//! Which flights are recorded: three chosen ones, and every registered law that these leave out.

use stormpetrel_control::registry::Settings;
use stormpetrel_lab::scenario::{Scenario, load_text};
use stormpetrel_lab::shipped::SHIPPED;

/// The chosen flights: name, shipped scenario, and what is changed in it.
pub const RECORDED: [(&str, &str, &[&str]); 3] = [
    // PID, HOSM on measured thrust, commanded rates, tilt priority, INDI with its filter, rotors.
    ("full", "first-flight", &["disturbance.0.torque=0.02"]),
    // arctan Euler reference, Euler error, INDI without filter, doubled HOSM on commanded thrust.
    ("article", "article/literal", &[]),
    ("rate-pid", "first-flight", &["rate={ law = \"pid\" }", "observer={ law = \"none\" }"]),
];

/// A flight to record.
#[derive(Clone, Debug)]
pub struct Recipe {
    /// Name of the recording.
    pub name: String,
    file: &'static str,
    sets: Vec<String>,
}

impl Recipe {
    /// The flight with everything set.
    ///
    /// # Errors
    /// Where the scenario is not shipped or what is set does not fit it.
    pub fn scenario(&self) -> Result<Scenario, String> {
        let (_, text) = SHIPPED
            .iter()
            .find(|(known, _)| *known == self.file)
            .ok_or_else(|| format!("{}: {} is not shipped", self.name, self.file))?;
        let file = load_text(&self.name, self.file, (*text).to_owned(), &self.sets)
            .map_err(|faults| format!("{}: {faults:?}", self.name))?;
        let mut scenarios = file.scenarios.into_iter();
        scenarios.next().ok_or_else(|| format!("{}: no flight", self.name))
    }
}

/// One block of the control diagram: its key in scenario files, its law, and all laws that it may have.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    /// Key in scenario files.
    pub key: &'static str,
    /// The law that flies.
    pub law: &'static str,
    /// All registered laws.
    pub registered: &'static [&'static str],
}

impl Block {
    fn of<S: Settings>(key: &'static str, settings: &S) -> Self {
        Self { key, law: settings.name(), registered: S::NAMES }
    }
}

/// The blocks of the control stack.
pub fn blocks(scenario: &Scenario) -> [Block; 5] {
    [
        Block::of("position", &scenario.position),
        Block::of("observer", &scenario.observer),
        Block::of("attitude_reference", &scenario.attitude_reference),
        Block::of("attitude", &scenario.attitude),
        Block::of("rate", &scenario.rate),
    ]
}

/// All flights to record: a new law is among them without a line here.
///
/// # Errors
/// As [`Recipe::scenario`].
pub fn recipes() -> Result<Vec<Recipe>, String> {
    completed(RECORDED.iter().map(chosen).collect())
}

/// Further flights for the laws that none of these has: in place of those of the first chosen one, with
/// their default numbers.
fn completed(mut recipes: Vec<Recipe>) -> Result<Vec<Recipe>, String> {
    let flown = recipes
        .iter()
        .map(|recipe| Ok(blocks(&recipe.scenario()?)))
        .collect::<Result<Vec<_>, String>>()?;
    let left_out: Vec<Vec<String>> = (0..5).map(|place| left_out(place, &flown)).collect();
    for round in 0..left_out.iter().map(Vec::len).max().unwrap_or(0) {
        recipes.push(Recipe {
            name: format!("others-{}", round + 1),
            file: RECORDED[0].1,
            sets: left_out.iter().filter_map(|sets| sets.get(round).cloned()).collect(),
        });
    }
    Ok(recipes)
}

fn chosen((name, file, sets): &(&str, &'static str, &[&str])) -> Recipe {
    let sets = sets.iter().map(|&set| set.to_owned()).collect();
    Recipe { name: (*name).to_owned(), file, sets }
}

/// What to set for each registered law that none of the flights has in this place.
fn left_out(place: usize, flown: &[[Block; 5]]) -> Vec<String> {
    let Block { key, registered, .. } = flown[0][place];
    registered
        .iter()
        .filter(|&&law| flown.iter().all(|blocks| blocks[place].law != law))
        .map(|law| format!("{key}={{ law = \"{law}\" }}"))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn laws_that_are_left_out_get_flights_of_their_own() {
        let completed = completed(vec![chosen(&RECORDED[1])]).expect("recipes");
        let names: Vec<&str> = completed.iter().map(|recipe| recipe.name.as_str()).collect();
        assert_eq!(names[..2], ["article", "others-1"]);
        let flown: Vec<_> =
            completed.iter().map(|recipe| blocks(&recipe.scenario().expect("scenario"))).collect();
        for place in 0..5 {
            assert_eq!(left_out(place, &flown), [""; 0], "{}", flown[0][place].key);
        }
    }
}
