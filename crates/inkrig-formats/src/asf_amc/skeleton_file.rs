//! The skeleton file: sections that begin with a colon, bones in blocks, then who hangs on whom.

use super::angles::Order;
use super::bone::{Bone, Dof, Root};
use super::error;
use super::tree::{Block, Edge, tree};
use crate::lexer::{Lexer, Word};
use crate::{Finding, FormatError, Limits};
use inkrig_motion::glam::DVec3;

/// A skeleton file, bones sorted so that parents stand before children.
#[derive(Debug, Clone)]
pub(super) struct Asf {
    pub(super) root: Root,
    pub(super) bones: Vec<Bone>,
    /// What lengths are divided by to be inches, where the file says it.
    pub(super) length_factor: Option<f64>,
    children: Vec<usize>,
}

impl Asf {
    /// Whether nothing hangs on a bone.
    pub(super) fn is_leaf(&self, bone: usize) -> bool {
        self.children.get(bone).is_none_or(|&count| count == 0)
    }
}

/// Reads all of it.
pub(super) fn parse(
    lexer: &mut Lexer<'_>,
    limits: &Limits,
    findings: &mut Vec<Finding>,
) -> Result<Asf, FormatError> {
    let mut file =
        Reader { lexer, limits, degrees_per_unit: 1.0, length_factor: None, root: RootWords::default() };
    let (mut blocks, mut edges) = (Vec::new(), Vec::new());
    let mut seen_hierarchy = false;
    while file.lexer.skip_space() {
        let word = file.lexer.word_in_line();
        match word.text.to_ascii_lowercase().as_slice() {
            b":units" => file.units()?,
            b":root" => file.root()?,
            b":bonedata" => blocks = file.bones()?,
            b":hierarchy" => {
                seen_hierarchy = true;
                edges = file.hierarchy()?;
            }
            // The version, the name, comments, free text and skins say nothing of bones.
            _ => drop(file.lexer.line()),
        }
    }
    if !seen_hierarchy || blocks.is_empty() {
        let end = file.lexer.word();
        let what =
            if blocks.is_empty() { "there is no :bonedata with bones" } else { "there is no :hierarchy" };
        let hint = "give the .asf file that came with the motion";
        return Err(error("asf-section", file.lexer.place(&end, None), what, hint));
    }
    let root = file.root.finish(file.degrees_per_unit);
    let length_factor = file.length_factor;
    let frames = file.degrees_per_unit;
    let (bones, children) = tree(file.lexer, blocks, &edges, frames, findings)?;
    Ok(Asf { root, bones, length_factor, children })
}

#[derive(Default)]
struct RootWords {
    dofs: Vec<Dof>,
    order: Order,
    position: DVec3,
    orientation: DVec3,
}

impl RootWords {
    fn finish(self, degrees_per_unit: f64) -> Root {
        let frame = self.order.rotation(self.orientation * degrees_per_unit);
        // A root that says nothing has the six numbers that all files have.
        let usual = [Dof::Translation(0), Dof::Translation(1), Dof::Translation(2)].into_iter().chain([
            Dof::Rotation(0),
            Dof::Rotation(1),
            Dof::Rotation(2),
        ]);
        let dofs = if self.dofs.is_empty() { usual.collect() } else { self.dofs };
        Root { position: self.position, frame, order: self.order, dofs }
    }
}

struct Reader<'l, 'a> {
    lexer: &'l mut Lexer<'a>,
    limits: &'l Limits,
    degrees_per_unit: f64,
    length_factor: Option<f64>,
    root: RootWords,
}

impl<'a> Reader<'_, 'a> {
    fn units(&mut self) -> Result<(), FormatError> {
        while let Some(key) = self.key() {
            let value = self.lexer.word_in_line();
            if key.is("length") {
                let factor = self.number(&value, None)?;
                if !(1e-6..=1e6).contains(&factor) {
                    let what = format!("a length factor of {}", value.shown());
                    let hint = "the CMU library has 0.45; give the unit with --unit";
                    return Err(error("asf-length", self.lexer.place(&value, None), what, hint));
                }
                self.length_factor = Some(factor);
            } else if key.is("angle") {
                self.degrees_per_unit = if value.text.to_ascii_lowercase().starts_with(b"rad") {
                    1.0_f64.to_degrees()
                } else {
                    1.0
                };
            }
            self.lexer.line();
        }
        Ok(())
    }

    fn root(&mut self) -> Result<(), FormatError> {
        while let Some(key) = self.key() {
            if key.is("order") {
                self.root.dofs = self.dofs()?;
            } else if key.is("axis") {
                self.root.order = self.order(None)?;
            } else if key.is("position") {
                self.root.position = self.vector(None)?;
            } else if key.is("orientation") {
                self.root.orientation = self.vector(None)?;
            }
            self.lexer.line();
        }
        Ok(())
    }

    fn bones(&mut self) -> Result<Vec<Block<'a>>, FormatError> {
        let mut blocks = Vec::new();
        while let Some(begin) = self.key() {
            if !begin.is("begin") {
                let what = format!("expected `begin` of a bone, found {}", begin.shown());
                let hint = "the file may be damaged; export it again";
                return Err(error("asf-begin", self.lexer.place(&begin, None), what, hint));
            }
            // A leaf brings an end site along.
            if 2 * (blocks.len() + 1) >= self.limits.joints {
                return Err(FormatError::Limit {
                    what: "the skeleton has too many bones".into(),
                    limit: self.limits.joints / 2,
                    place: Some(self.lexer.place(&begin, None)),
                    hint: "remove bones that do not matter".into(),
                });
            }
            blocks.push(self.bone(begin)?);
        }
        Ok(blocks)
    }

    fn bone(&mut self, begin: Word<'a>) -> Result<Block<'a>, FormatError> {
        let mut block = Block {
            begin,
            name: String::new(),
            direction: DVec3::ZERO,
            length: 0.0,
            axis: DVec3::ZERO,
            order: Order::default(),
            dofs: Vec::new(),
        };
        loop {
            if !self.lexer.skip_space() {
                let hint = "the file is cut off; copy it again";
                let place = self.lexer.place(&begin, Some(&block.name));
                return Err(error("asf-end", place, "this bone has no `end`", hint));
            }
            let key = self.lexer.word_in_line();
            let name = block.name.clone();
            let bone = Some(name.as_str());
            if key.is("end") {
                break;
            } else if key.is("name") {
                block.name = self.name()?;
            } else if key.is("direction") {
                block.direction = self.vector(bone)?.normalize_or_zero();
            } else if key.is("length") {
                let word = self.lexer.word_in_line();
                block.length = self.number(&word, bone)?;
            } else if key.is("axis") {
                block.axis = self.vector(bone)?;
                block.order = self.order(bone)?;
            } else if key.is("dof") {
                block.dofs = self.dofs()?;
            }
            // Limits, masses and numbers of bones are of no use here.
            self.lexer.line();
        }
        if block.name.is_empty() {
            let hint = "give each bone a name";
            return Err(error("asf-name", self.lexer.place(&begin, None), "this bone has no name", hint));
        }
        Ok(block)
    }

    fn hierarchy(&mut self) -> Result<Vec<Edge<'a>>, FormatError> {
        let mut edges = Vec::new();
        while let Some(parent) = self.key() {
            if parent.is("begin") || parent.is("end") {
                self.lexer.line();
                continue;
            }
            loop {
                let child = self.lexer.word_in_line();
                if child.text.is_empty() {
                    break;
                }
                edges.push(Edge { parent, child });
            }
        }
        Ok(edges)
    }

    /// The first word of the next line of this section that is no comment; `None` where the next section begins.
    fn key(&mut self) -> Option<Word<'a>> {
        while self.lexer.skip_space() {
            match self.lexer.rest().first() {
                Some(b':') => return None,
                Some(b'#') => drop(self.lexer.line()),
                _ => return Some(self.lexer.word_in_line()),
            }
        }
        None
    }

    fn name(&mut self) -> Result<String, FormatError> {
        let word = self.lexer.word_in_line();
        if word.text.len() > self.limits.name_bytes {
            return Err(FormatError::Limit {
                what: format!("the bone name {} has {} bytes", word.shown(), word.text.len()),
                limit: self.limits.name_bytes,
                place: Some(self.lexer.place(&word, None)),
                hint: "give the bone a shorter name".into(),
            });
        }
        Ok(String::from_utf8_lossy(word.text).into_owned())
    }

    fn dofs(&mut self) -> Result<Vec<Dof>, FormatError> {
        let mut dofs = Vec::new();
        loop {
            let word = self.lexer.word_in_line();
            if word.text.is_empty() {
                return Ok(dofs);
            }
            match Dof::of(word.text).filter(|dof| !dofs.contains(dof)) {
                Some(dof) => dofs.push(dof),
                None => {
                    let what =
                        format!("expected each of tx ty tz rx ry rz l once at most, found {}", word.shown());
                    let hint = "export the skeleton again";
                    return Err(error("asf-dof", self.lexer.place(&word, None), what, hint));
                }
            }
        }
    }

    /// The word that orders axes; the usual one where there is none.
    fn order(&mut self, bone: Option<&str>) -> Result<Order, FormatError> {
        let word = self.lexer.word_in_line();
        if word.text.is_empty() {
            return Ok(Order::default());
        }
        Order::of(word.text).ok_or_else(|| {
            let what = format!("expected an order of axes such as XYZ, found {}", word.shown());
            error("asf-axis", self.lexer.place(&word, bone), what, "write each of X, Y and Z once")
        })
    }

    fn vector(&mut self, bone: Option<&str>) -> Result<DVec3, FormatError> {
        let mut values = [0.0; 3];
        for value in &mut values {
            let word = self.lexer.word_in_line();
            *value = self.number(&word, bone)?;
        }
        Ok(DVec3::from_array(values))
    }

    fn number(&self, word: &Word<'a>, bone: Option<&str>) -> Result<f64, FormatError> {
        word.number().map_err(|problem| {
            let what = format!("expected a number, found {}", word.shown_value());
            error("asf-number", self.lexer.place(word, bone), what, problem.hint())
        })
    }
}
