//! Storyboards out of drawing programs: SVG whose layers or colours say what lines are.
//!
//! Groups whose name (Inkscape's label, else the id) begins with `frame` or `panel` are the frames; without any, the page is one
//! frame. Groups or shapes whose name begins with `body`, `trajectory`, `speed`, `scene` or `word` are that; other lines are told by
//! their colour ([`kind_of_colour`]). Text is the frame's word.

use super::colours::{Kind, kind_of_colour};
use super::{Frame, Storyboard, Stroke};
use crate::SketchError;
use crate::limits::{MAX_BYTES, MAX_STORYBOARD_FRAMES, MAX_STORYBOARD_TEXT};
use crate::read::svg::style::for_each_whole_rule;
use crate::read::svg::{parse, strokes};
use crate::read::utf8;
use roxmltree::{Document, Node};
use std::collections::HashMap;

const INKSCAPE: &str = "http://www.inkscape.org/namespaces/inkscape";

/// Names that begin so say what lines are.
const LAYERS: [(&str, Option<Kind>); 12] = [
    ("body", Some(Kind::Body)),
    ("figure", Some(Kind::Body)),
    ("trajector", Some(Kind::Trajectory)),
    ("way", Some(Kind::Trajectory)),
    ("speed", Some(Kind::Speed)),
    ("scene", Some(Kind::Scene)),
    ("background", Some(Kind::Scene)),
    ("word", Some(Kind::Lettering)),
    ("lettering", Some(Kind::Lettering)),
    ("ignore", None),
    ("guide", None),
    ("note", None),
];

/// Kinds in the order of their tags.
const KINDS: [Kind; 5] = [Kind::Body, Kind::Trajectory, Kind::Speed, Kind::Scene, Kind::Lettering];
/// Tags of a frame; the first is for what belongs to no kind.
const TAGS: u32 = 8;

/// Reads a storyboard from an SVG. Every frame keeps the page's coordinates, y up.
///
/// # Errors
/// As [`crate::read_curve`] for SVG, and when there are too many frames.
pub fn read_storyboard_svg(bytes: &[u8]) -> Result<Storyboard, SketchError> {
    if bytes.len() > MAX_BYTES {
        return Err(SketchError::TooLarge { bytes: bytes.len() });
    }
    let text = utf8(bytes).map_err(|line| SketchError::NotText { line })?;
    let document = parse(text)?;
    let page = Page::of(&document);
    let count = page.frames.len().max(1);
    if count > MAX_STORYBOARD_FRAMES {
        let problem = format!("there are {count}; at most {MAX_STORYBOARD_FRAMES} are read. Split it");
        return Err(SketchError::Storyboard { place: "frames".into(), problem });
    }
    let (curve, tags) = strokes(&document, &|node| page.tag(node))?;
    let mut board = Storyboard { title: page.title(&document), frames: vec![Frame::default(); count] };
    for (stroke, tag) in curve.strokes().zip(tags) {
        let kind = (tag % TAGS).checked_sub(1).and_then(|kind| KINDS.get(kind as usize));
        let frame = board.frames.get_mut((tag / TAGS) as usize);
        if let (Some(kind), Some(frame)) = (kind, frame) {
            frame.add(*kind, Stroke::new(stroke.to_vec()));
        }
    }
    page.words(&document, &mut board);
    board.check()?;
    Ok(board)
}

/// What a page says of its lines.
struct Page<'a, 'input> {
    /// Groups that are frames, in order.
    frames: Vec<Node<'a, 'input>>,
    /// Colours that style sheets give: selector, property, value.
    rules: HashMap<String, Vec<(String, String)>>,
}

impl<'a, 'input> Page<'a, 'input> {
    fn of(document: &'a Document<'input>) -> Self {
        let groups = document.descendants().filter(|node| node.tag_name().name() == "g");
        let frames = groups.filter(is_frame).collect();
        let mut rules: HashMap<String, Vec<(String, String)>> = HashMap::new();
        for style in document.descendants().filter(|node| node.tag_name().name() == "style") {
            let all: Result<(), ()> =
                for_each_whole_rule(style.text().unwrap_or_default(), |selector, body| {
                    for (name, value) in colours(body) {
                        rules
                            .entry(selector.to_owned())
                            .or_default()
                            .push((name.to_owned(), value.to_owned()));
                    }
                    Ok(())
                });
            debug_assert!(all.is_ok(), "the closure never fails");
        }
        Self { frames, rules }
    }

    /// Frame and kind of a shape, as one number above 0.
    fn tag(&self, node: Node<'_, '_>) -> u32 {
        let Some(frame) = self.frame(node) else { return TAGS * u32::from(u16::MAX) };
        let kind = self.kind(node).and_then(|kind| KINDS.iter().position(|known| *known == kind));
        // A frame's own tag is never 0, which would say nothing at all.
        let kind = kind.map_or(7, |kind| kind as u32 + 1);
        TAGS * frame + kind
    }

    /// The frame that a node lies in.
    fn frame(&self, node: Node<'_, '_>) -> Option<u32> {
        if self.frames.is_empty() {
            return Some(0);
        }
        let own = node.ancestors().find(is_frame)?;
        let place = self.frames.binary_search_by_key(&own.range().start, |frame| frame.range().start);
        place.ok().and_then(|at| u32::try_from(at).ok())
    }

    fn kind(&self, node: Node<'_, '_>) -> Option<Kind> {
        for own in node.ancestors().take_while(|own| !is_frame(own)) {
            let name = name(own).to_lowercase();
            if let Some((_, kind)) = LAYERS.iter().find(|(begins, _)| name.starts_with(begins)) {
                return *kind;
            }
        }
        let paint = |property: &str| {
            node.ancestors().find_map(|own| self.property(own, property)).filter(|value| *value != "none")
        };
        kind_of_colour(paint("stroke").or_else(|| paint("fill")).and_then(colour).unwrap_or([0; 3]))
    }

    /// What a node itself says of a property: style, then classes, then its attribute.
    fn property<'s>(&'s self, node: Node<'s, '_>, property: &str) -> Option<&'s str> {
        let of = |all: &mut dyn Iterator<Item = (&'s str, &'s str)>| {
            all.filter(|(name, _)| *name == property).last().map(|(_, value)| value)
        };
        let own = node.attribute("style").and_then(|style| of(&mut colours(style)));
        let by_rule = || {
            let classes = node.attribute("class").unwrap_or_default().split_ascii_whitespace().take(16);
            let selectors =
                classes.map(|class| format!(".{class}")).chain([node.tag_name().name().to_owned()]);
            selectors
                .filter_map(|selector| self.rules.get(&selector))
                .find_map(|rule| of(&mut rule.iter().map(|(name, value)| (name.as_str(), value.as_str()))))
        };
        own.or_else(by_rule).or_else(|| node.attribute(property)).filter(|value| *value != "inherit")
    }

    /// Text inside of frames is their word, or a note where its name says so.
    fn words(&self, document: &Document<'_>, board: &mut Storyboard) {
        for node in document.descendants().filter(|node| node.tag_name().name() == "text") {
            let frame = self.frame(node).and_then(|at| board.frames.get_mut(at as usize));
            let Some(frame) = frame else { continue };
            let text = words_of(node);
            let note = node.ancestors().any(|own| name(own).to_lowercase().starts_with("note"));
            let place = if note { &mut frame.notes } else { &mut frame.word };
            if !place.is_empty() && !text.is_empty() {
                place.push(' ');
            }
            if place.len() + text.len() <= MAX_STORYBOARD_TEXT {
                place.push_str(&text);
            }
        }
    }

    fn title(&self, document: &Document<'_>) -> String {
        let root = document.root_element();
        let title = root.children().find(|node| node.tag_name().name() == "title").map(words_of);
        title.filter(|title| title.len() <= MAX_STORYBOARD_TEXT).unwrap_or_default()
    }
}

fn is_frame(node: &Node<'_, '_>) -> bool {
    let name = name(*node).to_lowercase();
    node.tag_name().name() == "g" && (name.starts_with("frame") || name.starts_with("panel"))
}

/// What a drawing program calls a node.
fn name<'a>(node: Node<'a, '_>) -> &'a str {
    node.attribute((INKSCAPE, "label")).or_else(|| node.attribute("id")).unwrap_or_default()
}

fn words_of(node: Node<'_, '_>) -> String {
    let all: Vec<&str> = node
        .descendants()
        .filter(Node::is_text)
        .flat_map(|text| text.text().unwrap_or_default().split_ascii_whitespace())
        .collect();
    all.join(" ")
}

/// The colours among declarations.
fn colours(declarations: &str) -> impl Iterator<Item = (&str, &str)> {
    declarations
        .split(';')
        .filter_map(|declaration| declaration.split_once(':'))
        .map(|(name, value)| (name.trim(), value.trim().trim_end_matches("!important").trim()))
        .filter(|(name, _)| ["stroke", "fill"].contains(name))
}

/// `#rgb`, `#rrggbb`, `rgb(1, 2, 3)` and the names that are used most.
fn colour(text: &str) -> Option<[u8; 3]> {
    let text = text.trim().to_ascii_lowercase();
    if let Some(digits) = text.strip_prefix('#') {
        let number = u32::from_str_radix(digits.get(..6).unwrap_or(digits), 16).ok()?;
        let [_, red, green, blue] = number.to_be_bytes();
        return match digits.len() {
            3 | 4 => {
                let short = u32::from_str_radix(digits.get(..3)?, 16).ok()?;
                Some([8, 4, 0].map(|shift| 17 * ((short >> shift) & 15) as u8))
            }
            6 | 8 => Some([red, green, blue]),
            _ => None,
        };
    }
    if let Some(inside) = text.strip_prefix("rgb").and_then(|rest| rest.split_once('(')) {
        let parts: Vec<f32> = inside
            .1
            .split([',', ' ', ')', '/'])
            .filter(|part| !part.is_empty())
            .map_while(|part| match part.strip_suffix('%') {
                Some(share) => share.parse::<f32>().ok().map(|share| 2.55 * share),
                None => part.parse().ok(),
            })
            .collect();
        return parts.first_chunk::<3>().map(|parts| parts.map(|part| part.clamp(0.0, 255.0) as u8));
    }
    let names = [
        ("black", [0, 0, 0]),
        ("white", [255, 255, 255]),
        ("cyan", [0, 255, 255]),
        ("aqua", [0, 255, 255]),
        ("turquoise", [64, 224, 208]),
        ("deepskyblue", [0, 191, 255]),
        ("blue", [0, 0, 255]),
        ("red", [255, 0, 0]),
        ("orange", [255, 165, 0]),
        ("green", [0, 128, 0]),
        ("lime", [0, 255, 0]),
        ("gray", [150, 150, 150]),
        ("grey", [150, 150, 150]),
        ("silver", [192, 192, 192]),
        ("brown", [140, 90, 40]),
        ("magenta", [255, 0, 255]),
        ("fuchsia", [255, 0, 255]),
        ("purple", [128, 0, 128]),
        ("violet", [238, 130, 238]),
    ];
    names.iter().find(|(name, _)| *name == text).map(|(_, colour)| *colour)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn svg(body: &str) -> Storyboard {
        let text = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' xmlns:inkscape='{INKSCAPE}' viewBox='0 0 100 100'>{body}</svg>"
        );
        read_storyboard_svg(text.as_bytes()).unwrap()
    }

    /// Strokes of each kind of a frame.
    fn counts(frame: &Frame) -> [usize; 5] {
        let ways = frame.trajectories.len();
        [frame.body.len(), ways, frame.speed_lines.len(), frame.scene.len(), frame.lettering.len()]
    }

    #[test]
    fn colours_say_what_lines_are() {
        let board = svg("<title>Two</title><style>.a{fill:none;stroke:#0ff} line{stroke:orange}</style>
            <circle cx='5' cy='5' r='3' fill='none' stroke='black'/><path d='M0 0L1 1' style='stroke:#111'/>
            <path class='a' d='M0 0L1 1M2 2L3 3'/><line x1='0' y1='0' x2='5' y2='9'/>
            <g stroke='rgb(30, 160, 60)'><rect width='9' height='9'/></g><path d='M0 0L1 1' stroke='magenta'/>
            <path d='M0 0L9 9' stroke='white'/><text>kick</text>");
        assert_eq!(board.frames.len(), 1);
        assert_eq!(counts(&board.frames[0]), [2, 2, 1, 1, 1]);
        assert_eq!((board.title.as_str(), board.frames[0].word.as_str()), ("Two", "kick"));
        assert_eq!(board.frames[0].body[1].points, [[0.0, 0.0], [1.0, -1.0]], "y is up");
    }

    #[test]
    fn layers_win_over_colours_and_groups_are_frames() {
        let board = svg("<path d='M0 0h9' stroke='black'/>
            <g id='frame-1'><g id='body' stroke='red'><path d='M0 0h1'/></g><g inkscape:label='Trajectories'><path d='M0 0h2'/></g>
              <g id='ignored'><g id='ignore'><path d='M0 0h1'/></g></g><text><tspan>walk</tspan> <tspan>and wave</tspan></text></g>
            <g inkscape:label='Panel 2'><path d='M0 0h1' stroke='blue'/><text id='note-1'>slow</text></g>");
        assert_eq!(board.frames.iter().map(counts).collect::<Vec<_>>(), [[1, 1, 0, 0, 0], [0, 1, 0, 0, 0]]);
        assert_eq!(
            (board.frames[0].word.as_str(), board.frames[1].notes.as_str()),
            ("walk and wave", "slow")
        );
    }
}
