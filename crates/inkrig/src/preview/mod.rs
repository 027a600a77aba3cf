//! One self-contained page that shows a result: the drawn curve with a moving dot, the moving skeleton, and the
//! plan that says which part of the source clip is used when. It needs no server and loads nothing.

mod board;
mod digest;
mod encode;
mod guide;
mod payload;
pub(crate) mod track;

pub use board::{BoardFrame, BoardStroke, BoardWay, Ink};
pub use guide::{Guide, Part, Spot};
use inkrig_motion::Clip;
pub(crate) use payload::normalised;

/// Everything that the page shows.
#[derive(Debug, Clone)]
pub struct Preview<'a> {
    /// Stands at the top of the page; any text.
    pub title: &'a str,
    /// The motion that was made.
    pub result: &'a Clip,
    /// The motion it was made from.
    pub source: &'a Clip,
    /// What the result follows.
    pub control: ControlView<'a>,
    /// Control frames a second.
    pub control_rate: f64,
    /// The plan: how much of each moment of the source each moment of the control uses.
    pub heat_map: HeatMap,
    /// For every control frame (or sample of the guide) the moment of the source that is used most, seconds.
    pub best_source: &'a [f32],
    /// For each of them how sure the plan is, 0 to 1. May be empty.
    pub confidence: &'a [f32],
    /// What helps to understand the result; without it the page shows no map.
    pub guide: Option<&'a Guide>,
    /// The storyboard that the result was made of, instead of the control; empty without.
    pub board: &'a [BoardFrame],
    /// Figures of the report, in the order they are shown.
    pub figures: &'a [Figure],
    /// Warnings, one sentence each.
    pub notes: &'a [String],
}

/// What the result follows, for the eye.
#[derive(Debug, Clone, Copy)]
#[non_exhaustive]
pub enum ControlView<'a> {
    /// A drawn curve: one point for each control frame, x to the right, y up, any unit.
    Curve(&'a [[f64; 2]]),
    /// No drawing: the result is the source's motion on another character, moment by moment. Its way over the ground, as
    /// seen from above, one point a frame.
    Way(&'a [[f64; 2]]),
}

/// A plan as a picture: `height` rows, one for each step of control time from the first to the last, of `width`
/// columns, one for each step of source time. Weights from 0, any scale.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct HeatMap {
    /// Steps of source time.
    pub width: usize,
    /// Steps of control time.
    pub height: usize,
    /// Weights, row by row. A map whose length is not `width * height` is not shown.
    pub values: Vec<f32>,
}

/// One figure of the report.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Figure {
    /// What was measured.
    pub name: String,
    /// The value with its unit.
    pub value: String,
    /// What it means, in a sentence.
    pub note: String,
}

/// The page as HTML, to be written to a file as it is. Text from outside is escaped, numbers that are not finite
/// are left out, and what is too large is thinned with a note on the page. The same input gives the same page.
pub fn render(preview: &Preview<'_>) -> String {
    // Strings, numbers and lists always serialise; an empty page would say what is wrong.
    let data = encode::json_for_html(&payload::Payload::of(preview)).unwrap_or_else(|_| "null".into());
    // A browser hashes what it has read, with line ends made one; a checkout may have given the files others.
    let (style, script) = (STYLE.replace("\r\n", "\n"), SCRIPT.replace("\r\n", "\n"));
    fill(&[
        ("{{script-hash}}", &digest::policy_hash(&script)),
        ("{{style-hash}}", &digest::policy_hash(&style)),
        ("{{style}}", &style),
        ("{{data}}", &data),
        ("{{script}}", &script),
    ])
}

const PAGE: &str = include_str!("page/page.html");
const STYLE: &str = include_str!("page/page.css");
const SCRIPT: &str = concat!(
    "(() => {\n\"use strict\";\n",
    include_str!("page/data.js"),
    include_str!("page/colour.js"),
    include_str!("page/curve.js"),
    include_str!("page/board.js"),
    include_str!("page/plan.js"),
    include_str!("page/map.js"),
    include_str!("page/camera.js"),
    include_str!("page/stage.js"),
    include_str!("page/guide.js"),
    include_str!("page/player.js"),
    include_str!("page/page.js"),
    "})();\n",
);

/// Puts values into the template, in the template's order, so that no value is searched for a placeholder.
fn fill(values: &[(&str, &str)]) -> String {
    let length = values.iter().map(|(_, value)| value.len()).sum::<usize>() + PAGE.len();
    let mut page = String::with_capacity(length);
    let mut rest = PAGE;
    for (placeholder, value) in values {
        if let Some((before, after)) = rest.split_once(placeholder) {
            page.push_str(before);
            page.push_str(value);
            rest = after;
        }
    }
    page.push_str(rest);
    page
}
