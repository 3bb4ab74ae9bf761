//! A control stack built by the names of its laws and their choices.

use stormpetrel_control::attitude::AttitudeLawSettings;
use stormpetrel_control::attitude_reference::AttitudeReferenceSettings;
use stormpetrel_control::observer::ObserverSettings;
use stormpetrel_control::options::OptionVisitor;
use stormpetrel_control::position::PositionSettings;
use stormpetrel_control::rate::RateLawSettings;
use stormpetrel_control::record::{Meta, Path, VisitorMut};
use stormpetrel_control::registry::Settings;
use stormpetrel_control::signals::Model;
use stormpetrel_control::stack::{Exit, Laws, Rhythm, Stack};

/// Says which laws to take, block by block in the order of the control diagram.
pub trait Choose {
    /// One of these laws; `None` where it knows none of them.
    fn law(&mut self, names: &'static [&'static str]) -> Option<&'static str>;
    /// The position of one alternative among so many.
    fn option(&mut self, alternatives: usize) -> usize;
}

struct Walk<'a, C>(&'a mut C);

impl<C: Choose> VisitorMut<f64> for Walk<'_, C> {
    fn number(&mut self, _: &Path<'_>, _: &Meta, _: &mut f64) {}
}

impl<C: Choose> OptionVisitor for Walk<'_, C> {
    fn choice(
        &mut self,
        _: &'static str,
        _: &'static str,
        names: &'static [&'static str],
        _: &'static [&'static str],
        _: usize,
    ) -> usize {
        self.0.option(names.len())
    }
}

fn settings<S: Settings>(from: &mut impl Choose) -> Option<S> {
    let mut settings = S::named(from.law(S::NAMES)?)?;
    settings.settings(&mut Walk(from));
    Some(settings)
}

/// The stack of the chosen laws with their default numbers; `None` where a law is not known.
pub fn stack(from: &mut impl Choose, model: &Model<f64>, exit: Exit) -> Option<Stack<f64>> {
    let laws = Laws {
        position: settings::<PositionSettings>(from)?.build(model),
        observer: settings::<ObserverSettings>(from)?.build(model),
        attitude_reference: settings::<AttitudeReferenceSettings>(from)?.build(model),
        attitude: settings::<AttitudeLawSettings>(from)?.build(model),
        rate: settings::<RateLawSettings>(from)?.build(model),
    };
    Some(Stack::new(laws, exit, Rhythm::default()))
}
