//! The story as one self-contained page.

use std::fmt::Write;

use super::{Flown, Story, Table, tables};
use crate::figures::Drawing;
use crate::output::{REVISION, VERSION};

const STYLE: &str = "body{font:16px/1.5 system-ui,sans-serif;max-width:1000px;margin:2em auto;padding:0 1em;color:#1a1a1a;background:#fff}\
h1{font-size:1.7em}h2{margin-top:2.2em;border-bottom:2px solid #0072b2;padding-bottom:.2em}\
.table{overflow-x:auto}table{border-collapse:collapse;font-size:14px;margin:1em 0}\
th,td{padding:.3em .7em;text-align:right;border-bottom:1px solid #ddd;font-variant-numeric:tabular-nums;white-space:nowrap}\
th:first-child,td:first-child{text-align:left;white-space:normal}thead th{border-bottom:2px solid #555;vertical-align:bottom}\
.note{color:#444;font-size:14px}svg{max-width:100%;height:auto;display:block;margin:1em 0}\
details{margin:.4em 0}summary{cursor:pointer}code{background:#f2f2f2;padding:0 .25em}";

/// Text with the characters that HTML reserves replaced.
fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The flights whose pictures stand in the story: name, and what the reader should see.
pub const HEADLINES: [(&str, &str); 4] = [
    (
        "article/literal:printed",
        "As printed: the reference asks for thrust downwards, the arctangent answers with the wrong branch, and the vehicle tumbles. This is one of many possible flights: it is sensitive.",
    ),
    (
        "article/literal:ladder-4",
        "The same disturbance with four repairs: the flight holds, after a start of almost two metres while the observer finds a disturbance that begins at full size.",
    ),
    (
        "article/consistent:rate-commanded",
        "The consistent reading with all repairs: the estimate follows the true disturbance (the article's figure 1, now with units), the error falls to millimetres.",
    ),
    (
        "article/rotors:rate-commanded",
        "The same on rotors with lag and limits: what remains when nothing is ideal.",
    ),
];

/// The page. `figures` gives the pictures of a flight by its name.
pub fn html(story: &Story, figures: impl Fn(&Flown) -> Vec<Drawing>) -> String {
    let mut page = String::with_capacity(4 << 20);
    let _ = write!(
        page,
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" content=\"width=device-width\">\n\
<title>The article reproduced - Stormpetrel</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<h1>The article reproduced</h1>\n"
    );
    page.push_str(INTRODUCTION);
    let tables = tables(story);
    for table in &tables {
        write_table(&mut page, table);
        if table.title.starts_with("(b) Ours, the literal") {
            headline(&mut page, story, HEADLINES[0], &figures);
        }
        if table.title.starts_with("(c) The repair ladder") {
            headline(&mut page, story, HEADLINES[2], &figures);
            headline(&mut page, story, HEADLINES[3], &figures);
        }
        if table.title.starts_with("(c) The literal reading") {
            headline(&mut page, story, HEADLINES[1], &figures);
        }
    }
    page.push_str(
        "<h2>Every flight</h2>\n<p>Errors of each flight; open the ones that interest you.</p>\n",
    );
    for group in &story.groups {
        let _ = writeln!(
            page,
            "<h3>{}: {}</h3>\n<p>{}</p>",
            escape(group.name),
            escape(&group.title),
            escape(&group.about)
        );
        for flown in &group.flights {
            let _ = writeln!(
                page,
                "<details><summary><code>{}</code> {}</summary>",
                escape(flown.variant()),
                escape(&flown.scenario.title)
            );
            for drawing in figures(flown).iter().filter(|d| d.name == "errors") {
                page.push_str(&drawing.svg);
            }
            page.push_str("</details>\n");
        }
    }
    let _ = writeln!(
        page,
        "<p class=\"note\">Stormpetrel {VERSION}, revision {}. Made by <code>stormpetrel reproduce</code>; the same numbers on every machine.</p>\n</body>\n</html>",
        escape(REVISION)
    );
    page
}

const INTRODUCTION: &str = "<p>An article proposes a quadrotor controller: a PID position loop with a sliding-mode observer that \
estimates the disturbance, and an incremental dynamic inversion (INDI) of the attitude. It flies a helix under forces and torques \
and prints a table in which the proposal beats a plain PID. This page flies what the article writes, and what it must have meant.</p>\n\
<p>Four things to know beforehand:</p>\n<ul>\n\
<li>The printed table cannot belong to any flight: its six columns break an inequality that holds for every signal (a).</li>\n\
<li>Flown to the letter, the equations tumble; the result then depends on the twelfth digit of the start, so it is shown as a spread (b).</li>\n\
<li>With a force a hundredth as large and eight defects repaired one by one, the method works, and each repair can be read off a line (c).</li>\n\
<li>How much force each variant withstands, beside what physics allows (d).</li>\n</ul>\n\
<p class=\"note\">IAE: integral of the absolute error (m s or rad s). ISE: integral of its square. max: largest error. late max: the same after 10 s. \
Lumped disturbance: everything that the law's model does not explain, in newtons.</p>\n";

fn write_table(page: &mut String, table: &Table) {
    let _ = writeln!(
        page,
        "<h2>{}</h2>\n<p>{}</p>\n<div class=\"table\"><table>",
        escape(&table.title),
        escape(&table.lead)
    );
    let cells = |tag: &str, row: &[String]| {
        row.iter().fold(String::new(), |mut line, cell| {
            let _ = write!(line, "<{tag}>{}</{tag}>", escape(cell));
            line
        })
    };
    let _ = writeln!(page, "<thead><tr>{}</tr></thead>\n<tbody>", cells("th", &table.head));
    for row in &table.rows {
        let _ = writeln!(page, "<tr>{}</tr>", cells("td", row));
    }
    page.push_str("</tbody></table></div>\n");
    for note in &table.notes {
        let _ = writeln!(page, "<p class=\"note\">{}</p>", escape(note));
    }
}

fn headline(
    page: &mut String,
    story: &Story,
    (name, text): (&str, &str),
    figures: &impl Fn(&Flown) -> Vec<Drawing>,
) {
    let Some(flown) = story.flights().find(|flown| flown.scenario.name == name) else { return };
    let _ = writeln!(page, "<h3>{}</h3>\n<p>{}</p>", escape(name), escape(text));
    for drawing in figures(flown) {
        page.push_str(&drawing.svg);
        page.push('\n');
    }
}
