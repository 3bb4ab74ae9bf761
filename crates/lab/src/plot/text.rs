//! Text that is safe inside SVG: escaping, numbers, and how wide a line will be.

/// Advance widths of the printable ASCII characters of the font, in thousandths of its size.
const WIDTHS: [u16; 95] = [
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337, 636, 636, 636,
    636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 531, 1000, 684, 686, 698, 770, 632,
    575, 775, 752, 295, 295, 656, 557, 863, 748, 787, 603, 787, 695, 635, 611, 732, 684, 989, 685,
    611, 685, 390, 337, 390, 838, 500, 500, 613, 635, 550, 635, 615, 352, 635, 634, 278, 278, 579,
    278, 974, 634, 612, 635, 635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838,
];

/// Width of a line of text in pixels at a font size in pixels.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let advance = |c: char| {
        let index = (c as usize).checked_sub(32);
        // Wider than the average, so that unknown characters never make a label too long.
        f64::from(index.and_then(|i| WIDTHS.get(i)).copied().unwrap_or(700))
    };
    text.chars().map(advance).sum::<f64>() * size / 1000.0
}

/// The text, or its beginning and an ellipsis when it is wider than `room` pixels.
pub(super) fn fit(text: &str, size: f64, room: f64) -> String {
    if width(text, size) <= room {
        return text.to_owned();
    }
    let mut kept = String::new();
    let mut used = width("\u{2026}", size);
    for c in text.chars() {
        used += width(c.encode_utf8(&mut [0; 4]), size);
        if used > room {
            break;
        }
        kept.push(c);
    }
    format!("{}\u{2026}", kept.trim_end())
}

/// Breaks the text at spaces into lines no wider than `room` pixels.
pub(super) fn wrap(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(line, size) + width(word, size) + 0.4 * size <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines.iter().map(|line| fit(line, size, room)).collect()
}

/// The text with the characters of markup replaced and those XML forbids left out.
pub(super) fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c if c.is_whitespace() => out.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => out.push(c),
        }
    }
    out
}

/// A coordinate with at most two decimals and no trailing zeros.
pub(super) fn num(v: f64) -> String {
    trimmed(format!("{:.2}", if v.is_finite() { v } else { 0.0 }))
}

/// A coordinate with at most one decimal: enough for the points of a curve, and shorter.
pub(super) fn coarse(v: f64) -> String {
    trimmed(format!("{:.1}", if v.is_finite() { v } else { 0.0 }))
}

fn trimmed(mut text: String) -> String {
    if text.contains('.') {
        let kept = text.trim_end_matches('0').trim_end_matches('.').len();
        text.truncate(kept);
    }
    if text == "-0" { "0".to_owned() } else { text }
}

/// An integer times a power of ten, written out exactly: `decimal(-25, -1)` is "−2.5".
pub(super) fn decimal(mantissa: i64, exponent: i32) -> String {
    let sign = if mantissa < 0 { "\u{2212}" } else { "" };
    let digits = mantissa.unsigned_abs().to_string();
    let places = exponent.unsigned_abs() as usize;
    if exponent >= 0 {
        let zeros = if mantissa == 0 { 0 } else { places };
        return format!("{sign}{digits}{}", "0".repeat(zeros));
    }
    let padded = format!("{digits:0>width$}", width = places + 1);
    let (whole, fraction) = padded.split_at(padded.len() - places);
    format!("{sign}{whole}.{fraction}")
}

/// A power of ten with a raised exponent: "10⁻³".
pub(super) fn power(exponent: i32) -> String {
    let plain = exponent.to_string();
    let raised = plain.chars().map(|c| match c {
        '-' => '\u{207b}',
        '1' => '\u{b9}',
        '2' => '\u{b2}',
        '3' => '\u{b3}',
        digit => char::from_u32(0x2070 + digit.to_digit(10).unwrap_or(0)).unwrap_or(digit),
    });
    format!("10{}", raised.collect::<String>())
}

/// Splits a finite number into digits and the exponent of its first digit: 0.012 is ("1.2", -2).
pub(super) fn scientific(v: f64) -> (String, i32) {
    let text = format!("{v:e}");
    let (digits, exponent) = text.split_once('e').unwrap_or((&text, "0"));
    (digits.to_owned(), exponent.parse().unwrap_or(0))
}

/// A value to be read, with about four significant digits.
pub(super) fn value(v: f64) -> String {
    if v.is_nan() {
        return "no value".to_owned();
    }
    if v.is_infinite() {
        return if v > 0.0 { "\u{221e}" } else { "\u{2212}\u{221e}" }.to_owned();
    }
    if (1000.0..1e6).contains(&v.abs()) {
        return format!("{v:.0}").replace('-', "\u{2212}");
    }
    // Rounding first, because 0.99999 has another exponent afterwards.
    let (digits, exponent) = scientific(format!("{v:.3e}").parse().unwrap_or(v));
    let places = digits.split_once('.').map_or(0, |(_, fraction)| fraction.len());
    let mantissa = digits.replace('.', "").parse().unwrap_or(0);
    let shift = i32::try_from(places).unwrap_or(0);
    if (-4..6).contains(&exponent) {
        decimal(mantissa, exponent - shift)
    } else {
        format!("{}\u{b7}{}", decimal(mantissa, -shift), power(exponent))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markup_and_control_characters_cannot_get_through() {
        assert_eq!(escape("a<b> & \"c\"\u{0}\n'"), "a&lt;b&gt; &amp; &quot;c&quot; &#39;");
    }

    #[test]
    fn coordinates_are_short() {
        assert_eq!(num(12.0), "12");
        assert_eq!(num(-0.001), "0");
        assert_eq!(num(1.005_1), "1.01");
        assert_eq!(num(f64::NAN), "0");
        assert_eq!(coarse(100.04), "100");
    }

    #[test]
    fn decimals_are_exact() {
        assert_eq!(decimal(-25, -1), "\u{2212}2.5");
        assert_eq!(decimal(5, -3), "0.005");
        assert_eq!(decimal(3, 2), "300");
        assert_eq!(decimal(0, 4), "0");
    }

    #[test]
    fn values_read_well() {
        assert_eq!(value(0.0), "0");
        assert_eq!(value(0.1 + 0.2), "0.3");
        assert_eq!(value(0.999_99), "1");
        assert_eq!(value(-1.234_56), "\u{2212}1.235");
        assert_eq!(value(123_456.0), "123456");
        assert_eq!(value(1.25e-7), "1.25\u{b7}10\u{207b}\u{2077}");
        assert_eq!(value(f64::INFINITY), "\u{221e}");
        assert_eq!(value(f64::NAN), "no value");
    }

    #[test]
    fn long_text_is_cut_or_wrapped() {
        let cut = fit("a rather long label", 10.0, 50.0);
        assert!(cut.ends_with('\u{2026}') && width(&cut, 10.0) <= 50.0);
        assert_eq!(wrap("one two three", 10.0, 50.0), ["one two", "three"]);
    }
}
