//! Figures as pure functions: values in, SVG text out, PNG bytes when wanted.
//!
//! Nothing here needs a display, a system font or the clock: the same input gives the same bytes.
//! Series are told apart by colour (Okabe-Ito) and dash pattern together, so that a colour-blind
//! reader or a black-and-white print loses nothing.

mod axis;
mod bars;
mod decimate;
mod extent;
mod figure;
mod legend;
mod page;
mod path3d;
#[cfg(feature = "png")]
mod png;
mod style;
mod text;
mod ticks;

pub use bars::{Bars, Group};
pub use figure::{Column, Figure, Limit, Mark, Panel, Series};
pub use path3d::{Path, Scene};
#[cfg(feature = "png")]
pub use png::{PngError, png};

/// How an axis maps values to length.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps for equal differences.
    #[default]
    Linear,
    /// Equal steps for equal ratios; values of zero and below cannot be drawn and break the line.
    Log,
}
