//! What is wrong with a scenario, said so that the reader can mend it.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use annotate_snippets::{AnnotationKind, Level, Renderer, Snippet};

/// A text that settings came from: a file or a `--set` argument.
#[derive(Debug)]
pub struct Source {
    /// File name as the user gave it, or `--set`.
    pub name: String,
    /// The whole text.
    pub text: String,
}

/// A place in a source.
#[derive(Clone, Debug)]
pub struct Place {
    /// The source.
    pub source: Arc<Source>,
    /// Bytes from, to.
    pub span: Range<usize>,
}

impl Place {
    /// Whether both are the same letters of the same text.
    pub fn is(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.source, &other.source) && self.span == other.span
    }
}

/// One thing that is wrong.
#[derive(Clone, Debug)]
pub struct Fault {
    /// Where; `None` for a whole file.
    pub place: Option<Place>,
    /// Field, value and rule in one sentence.
    pub message: String,
    /// What to do.
    pub help: Option<String>,
}

impl Fault {
    /// A fault at a place.
    pub fn new(place: &Place, message: impl Into<String>) -> Self {
        Self { place: Some(place.clone()), message: message.into(), help: None }
    }

    /// A fault of a whole file or command.
    pub fn general(message: impl Into<String>) -> Self {
        Self { place: None, message: message.into(), help: None }
    }

    /// Line and column, from 1, in letters.
    pub fn position(&self) -> Option<(usize, usize)> {
        let Place { source, span } = self.place.as_ref()?;
        let before = source.text.get(..span.start)?;
        let line = before.rsplit('\n').next().unwrap_or_default();
        Some((before.matches('\n').count() + 1, line.chars().count() + 1))
    }

    /// The same with advice.
    pub fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}

/// Faults that are shown; more of them hide the first.
const SHOWN: usize = 20;

/// All that is wrong, in the order of the file.
#[derive(Clone, Debug, Default)]
pub struct Faults(pub Vec<Fault>);

impl Faults {
    /// The faults as a failure, or nothing where there are none.
    ///
    /// # Errors
    /// The faults themselves where there are any.
    pub fn check(self) -> Result<(), Self> {
        if self.0.is_empty() { Ok(()) } else { Err(self) }
    }
}

impl FromIterator<Fault> for Faults {
    fn from_iter<I: IntoIterator<Item = Fault>>(faults: I) -> Self {
        Self(faults.into_iter().collect())
    }
}

impl From<Fault> for Faults {
    fn from(fault: Fault) -> Self {
        Self(vec![fault])
    }
}

impl std::error::Error for Faults {}

impl fmt::Display for Faults {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, fault) in self.0.iter().take(SHOWN).enumerate() {
            if i > 0 {
                f.write_str("\n\n")?;
            }
            f.write_str(&render(fault))?;
        }
        match self.0.len().saturating_sub(SHOWN) {
            0 => Ok(()),
            more => write!(f, "\n\nand {more} more"),
        }
    }
}

/// The text without letters that would steer a terminal.
pub fn printable(text: &str) -> String {
    let steers = |c: char| c.is_control() && c != '\n';
    text.chars().map(|c| if steers(c) { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

fn render(fault: &Fault) -> String {
    let message = printable(&fault.message);
    let help = fault.help.as_deref().map(printable);
    let title = Level::ERROR.primary_title(message.as_str());
    let mut group = match &fault.place {
        Some(Place { source, span }) => title.element(
            Snippet::source(source.text.as_str())
                .path(source.name.as_str())
                .annotation(AnnotationKind::Primary.span(span.clone())),
        ),
        None => title.elements(Vec::<annotate_snippets::Message<'_>>::new()),
    };
    if let Some(help) = &help {
        group = group.element(Level::HELP.message(help.as_str()));
    }
    Renderer::plain().render(&[group])
}
