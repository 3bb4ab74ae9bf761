//! Colours, dashes and text sizes shared by all figures.

/// Width of every figure in pixels.
pub(super) const WIDTH: f64 = 860.0;
/// The fonts of a figure; the first is the one embedded for PNG.
pub(super) const FONTS: &str = "DejaVu Sans, Verdana, sans-serif";
/// Colour of frames and of the title.
pub(super) const INK: &str = "#222";
/// Colour of notes and limits; dark enough to be read on white.
pub(super) const GREY: &str = "#666";
/// Colour of the lines at the ticks.
pub(super) const GRID: &str = "#ddd";
/// Colour of the lines between the decades.
pub(super) const FAINT: &str = "#ececec";
/// Dashes of a limit.
pub(super) const LIMIT_DASH: &str = "6 4";

/// Colours of Okabe and Ito without the yellow, which is lost on white, each with its own dashes.
const PALETTE: [(&str, &str); 7] = [
    ("#0072B2", ""),
    ("#D55E00", "8 3"),
    ("#009E73", "3 2"),
    ("#CC79A7", "9 3 2 3"),
    ("#56B4E9", "14 4"),
    ("#E69F00", "5 2 1.5 2 1.5 2"),
    ("#000000", "1.5 2.5"),
];

/// Colour and dash pattern of a style. The colours wrap round, each time with the dashes of a neighbour,
/// so that 49 styles differ.
pub(super) fn look(style: usize) -> (&'static str, &'static str) {
    let pick = |at: usize| PALETTE.get(at % PALETTE.len()).copied().unwrap_or(("#000000", ""));
    (pick(style).0, pick(style + style / PALETTE.len()).1)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn styles_wrap_round_and_differ() {
        assert!((1..7).all(|i| look(i).0 != look(0).0 && look(i).1 != look(0).1));
        assert_eq!(look(0).0, look(7).0);
        assert_eq!((0..49).map(look).collect::<BTreeSet<_>>().len(), 49);
        assert_eq!(look(0), look(49));
    }
}
