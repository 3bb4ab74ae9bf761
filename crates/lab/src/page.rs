//! What the HTML pages have in common: frame, style, tables, numbers. A page needs no network and no
//! script.

use std::fmt::Write;

use crate::output::{REVISION, VERSION};

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:1000px;margin:2em auto;padding:0 1em;color:#1a1a1a;background:#fff}\
h1{font-size:1.7em}h2{margin-top:2.2em;border-bottom:2px solid #0072b2;padding-bottom:.2em}\
.table{overflow-x:auto}table{border-collapse:collapse;font-size:14px;margin:1em 0}\
th,td{padding:.3em .7em;text-align:right;border-bottom:1px solid #ddd;font-variant-numeric:tabular-nums;white-space:nowrap}\
th:first-child,td:first-child{text-align:left;white-space:normal}thead th{border-bottom:2px solid #555;vertical-align:bottom}\
.note{color:#444;font-size:14px}svg{max-width:100%;height:auto;display:block;margin:1em 0}\
details{margin:.4em 0}summary{cursor:pointer}code{background:#f2f2f2;padding:0 .25em}";

/// Text with the characters that HTML reserves replaced.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The page up to its heading, which is its title too.
pub fn open(title: &str) -> String {
    let mut page = String::with_capacity(1 << 20);
    let title = escape(title);
    let _ = write!(
        page,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
<title>{title} - Stormpetrel</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>{title}</h1>\n"
    );
    page
}

/// Foot and end of the page; `made_by` is HTML that names the command.
pub fn close(page: &mut String, made_by: &str) {
    let _ = writeln!(
        page,
        "<p class=\"note\">Stormpetrel {VERSION}, revision {}. Made by {made_by}; the same numbers on every machine.</p>\n</body>\n</html>",
        escape(REVISION)
    );
}

/// A table of plain text; the first column holds the labels.
pub fn table(page: &mut String, head: &[String], rows: &[Vec<String>]) {
    let safe = |row: &[String]| row.iter().map(|cell| escape(cell)).collect::<Vec<_>>();
    let rows: Vec<_> = rows.iter().map(|row| safe(row)).collect();
    html_table(page, &safe(head), &rows);
}

/// A table whose cells are HTML already.
pub fn html_table(page: &mut String, head: &[String], rows: &[Vec<String>]) {
    let cells = |tag: &str, row: &[String]| {
        row.iter().fold(String::new(), |mut line, cell| {
            let _ = write!(line, "<{tag}>{cell}</{tag}>");
            line
        })
    };
    page.push_str("<div class=\"table\"><table>\n");
    let _ = writeln!(page, "<thead><tr>{}</tr></thead>\n<tbody>", cells("th", head));
    for row in rows {
        let _ = writeln!(page, "<tr>{}</tr>", cells("td", row));
    }
    page.push_str("</tbody></table></div>\n");
}

/// A remark in small print.
pub fn note(page: &mut String, text: &str) {
    let _ = writeln!(page, "<p class=\"note\">{}</p>", escape(text));
}

/// Three significant digits, plain where that is readable.
pub fn number(x: f64) -> String {
    if x == 0.0 {
        return "0".into();
    }
    let magnitude = x.abs();
    if !(1e-3..1e4).contains(&magnitude) {
        return format!("{x:.2e}");
    }
    let digits = if magnitude >= 100.0 {
        0
    } else if magnitude >= 10.0 {
        1
    } else if magnitude >= 1.0 {
        2
    } else if magnitude >= 0.1 {
        3
    } else if magnitude >= 0.01 {
        4
    } else {
        5
    };
    format!("{x:.digits$}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits() {
        let shown = [0.0, 1234.5, 12345.6, 12.34, 0.001_234, 0.000_123_4].map(number);
        assert_eq!(shown, ["0", "1234", "1.23e4", "12.3", "0.00123", "1.23e-4"]);
    }

    #[test]
    fn markup_in_a_cell_is_text() {
        let mut page = open("a < b");
        table(&mut page, &["<i>".into()], &[vec!["&".into()]]);
        close(&mut page, "<code>x</code>");
        assert!(page.contains("<th>&lt;i&gt;</th>") && page.contains("<td>&amp;</td>"));
        assert!(page.contains("<h1>a &lt; b</h1>") && page.ends_with("</html>\n"));
    }
}
