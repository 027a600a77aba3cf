//! Shapes of letters: outlines out of TrueType and OpenType files, single lines out of SVG fonts.

use crate::TrainError;
use crate::corpus::read_text;
use kurbo::{BezPath, PathEl};
use std::collections::BTreeMap;
use std::path::Path;

/// Flattened curves stay within this share of the letters' height.
const FLAT: f64 = 0.004;
/// A font file of more bytes is none of letters alone.
const MOST_BYTES: u64 = 32 << 20;

/// The letters of a font. Lengths are shares of the height of a small x.
#[derive(Debug, Clone, PartialEq)]
pub struct Font {
    /// The file's name without its ending.
    pub name: String,
    /// Whether its lines are where the pen goes; else they are outlines.
    pub single_line: bool,
    glyphs: BTreeMap<char, Glyph>,
}

/// A letter.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Glyph {
    pub lines: Vec<Vec<[f32; 2]>>,
    pub advance: f32,
}

impl Font {
    /// A letter, and the space.
    pub(super) fn glyph(&self, letter: char) -> Option<&Glyph> {
        self.glyphs.get(&letter)
    }

    fn of(name: &str, single_line: bool, glyphs: &BTreeMap<char, (BezPath, f64)>) -> Option<Self> {
        let top = |letter: char| {
            let (path, _) = glyphs.get(&letter)?;
            Some(kurbo::Shape::bounding_box(path).y1)
        };
        let height = top('x').filter(|height| *height > 0.0)?;
        // A font without small letters has large ones in their place, or nothing at all.
        let complete = ('a'..='z').chain('A'..='Z').all(|letter| glyphs.contains_key(&letter));
        let scaled = |(letter, (path, advance)): (&char, &(BezPath, f64))| {
            let mut path = path.clone();
            path.apply_affine(kurbo::Affine::scale(1.0 / height));
            (*letter, Glyph { lines: flatten(&path), advance: (advance / height) as f32 })
        };
        complete.then(|| Self { name: name.into(), single_line, glyphs: glyphs.iter().map(scaled).collect() })
    }
}

/// Reads every font of a folder, in the order of their names. What is no font of Latin letters is passed over.
///
/// # Errors
/// When the folder or a file cannot be read, or no font is there.
pub fn read_fonts(folder: &Path) -> Result<Vec<Font>, TrainError> {
    let failed = |cause| TrainError::File { path: folder.to_path_buf(), cause };
    let mut paths: Vec<_> =
        std::fs::read_dir(folder).map_err(failed)?.filter_map(|entry| Some(entry.ok()?.path())).collect();
    paths.sort();
    let mut fonts = Vec::new();
    for path in paths {
        let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_lowercase);
        let name = path.file_stem().and_then(|name| name.to_str()).unwrap_or_default();
        fonts.extend(match ending.as_deref() {
            Some("ttf" | "otf") => {
                let failed = |cause| TrainError::File { path: path.clone(), cause };
                if std::fs::metadata(&path).map_err(failed)?.len() > MOST_BYTES {
                    continue;
                }
                outlines(name, &std::fs::read(&path).map_err(failed)?)
            }
            Some("svg") => single_lines(name, &read_text(&path)?),
            _ => None,
        });
    }
    if fonts.is_empty() {
        let what = "holds no font of Latin letters (.ttf, .otf, or .svg with <glyph>)".to_string();
        return Err(TrainError::Content { path: folder.to_path_buf(), what });
    }
    Ok(fonts)
}

fn needed() -> impl Iterator<Item = char> {
    ('a'..='z').chain('A'..='Z').chain([' '])
}

fn outlines(name: &str, bytes: &[u8]) -> Option<Font> {
    let face = ttf_parser::Face::parse(bytes, 0).ok()?;
    let glyph = |letter: char| {
        let id = face.glyph_index(letter)?;
        let mut path = Path2(BezPath::new());
        // A space has no outline.
        face.outline_glyph(id, &mut path);
        Some((letter, (path.0, f64::from(face.glyph_hor_advance(id)?))))
    };
    Font::of(name, false, &needed().filter_map(glyph).collect())
}

fn single_lines(name: &str, text: &str) -> Option<Font> {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    let document = roxmltree::Document::parse_with_options(text, options).ok()?;
    let glyphs = document.descendants().filter(|node| node.has_tag_name("glyph"));
    let glyphs = glyphs.filter_map(|node| {
        let mut letters = node.attribute("unicode")?.chars();
        let letter =
            letters.next().filter(|letter| letters.next().is_none() && needed().any(|own| own == *letter))?;
        let path = BezPath::from_svg(node.attribute("d").unwrap_or("")).ok()?;
        let advance = node.attribute("horiz-adv-x")?.parse().ok()?;
        Some((letter, (path, advance)))
    });
    Font::of(name, true, &glyphs.collect())
}

/// Lines of points; curves become a few.
fn flatten(path: &BezPath) -> Vec<Vec<[f32; 2]>> {
    let mut lines: Vec<Vec<[f32; 2]>> = Vec::new();
    kurbo::flatten(path.iter(), FLAT, |element| match element {
        PathEl::MoveTo(to) => lines.push(vec![[to.x as f32, to.y as f32]]),
        PathEl::LineTo(to) => {
            if let Some(line) = lines.last_mut() {
                line.push([to.x as f32, to.y as f32]);
            }
        }
        PathEl::ClosePath => {
            if let Some(line) = lines.last_mut() {
                line.extend(line.first().copied());
            }
        }
        PathEl::QuadTo(..) | PathEl::CurveTo(..) => {}
    });
    lines.retain(|line| line.len() > 1);
    lines
}

/// Collects an outline.
struct Path2(BezPath);

impl ttf_parser::OutlineBuilder for Path2 {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to((f64::from(x), f64::from(y)));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to((f64::from(x), f64::from(y)));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.0.quad_to((f64::from(x1), f64::from(y1)), (f64::from(x), f64::from(y)));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.0.curve_to(
            (f64::from(x1), f64::from(y1)),
            (f64::from(x2), f64::from(y2)),
            (f64::from(x), f64::from(y)),
        );
    }

    fn close(&mut self) {
        self.0.close_path();
    }
}
