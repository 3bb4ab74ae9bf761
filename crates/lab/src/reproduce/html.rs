//! The story as one self-contained page.

use std::fmt::Write;

use super::{Flown, Story, Table, tables};
use crate::figures::Drawing;
use crate::page::{self, escape};

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
    let mut page = page::open("The article reproduced");
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
    page::close(&mut page, "<code>stormpetrel reproduce</code>");
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
    let _ = writeln!(page, "<h2>{}</h2>\n<p>{}</p>", escape(&table.title), escape(&table.lead));
    page::table(page, &table.head, &table.rows);
    for note in &table.notes {
        page::note(page, note);
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
