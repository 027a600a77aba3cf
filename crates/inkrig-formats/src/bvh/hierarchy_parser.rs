//! Reads the HIERARCHY part, statement by statement.

use super::{
    ByAxis,
    hierarchy::{Hierarchy, RawJoint},
};
use crate::lexer::{Lexer, Word};
use crate::{Axis, Channel, FormatError, Limits};
use inkrig_motion::glam::DVec3;

/// Bytes that the names of end sites may have beyond the file's size: one long name can be the parent of many.
const FREE_END_NAMES: usize = 256 << 10;

/// Reads from HIERARCHY up to and with MOTION.
pub(super) fn parse(lexer: &mut Lexer<'_>, limits: &Limits) -> Result<Hierarchy, FormatError> {
    let first = lexer.word();
    if !first.is("HIERARCHY") {
        let what = format!("expected HIERARCHY, found {}", first.shown());
        let hint = "a BVH file begins with the word HIERARCHY; is this another format?";
        return Err(lexer.error("bvh-not-bvh", &first, None, what, hint));
    }
    let mut parser = Parser { lexer, limits, out: Hierarchy::default(), open: Vec::new(), end_name_bytes: 0 };
    while parser.statement()? {}
    Ok(parser.out)
}

struct Parser<'p, 'a> {
    lexer: &'p mut Lexer<'a>,
    limits: &'p Limits,
    out: Hierarchy,
    /// The joints whose brace is open, from root to tip: nesting costs no call stack.
    open: Vec<Open>,
    end_name_bytes: usize,
}

struct Open {
    joint: usize,
    has_offset: bool,
    has_channels: bool,
    end_sites: usize,
    /// A joint, not an end site, hangs below.
    has_child: bool,
}

impl Parser<'_, '_> {
    /// One statement; false after MOTION.
    fn statement(&mut self) -> Result<bool, FormatError> {
        let word = self.lexer.word();
        if self.open.is_empty() {
            return self.outer_statement(&word);
        }
        if word.is("OFFSET") {
            self.offset(&word)?;
        } else if word.is("CHANNELS") {
            self.channels(&word)?;
        } else if word.is("JOINT") {
            self.begin_joint(&word)?;
        } else if word.is("End") {
            self.begin_end_site(&word)?;
        } else if word.text == b"}" {
            self.close(&word)?;
        } else if Channel::from_bvh(word.text).is_some() {
            let what = format!("more channels than announced: {}", word.shown());
            return Err(self.error(
                "bvh-channels",
                &word,
                what,
                "set the number behind CHANNELS to how many follow",
            ));
        } else if word.text.is_empty() || word.is("MOTION") {
            let open = self.open.len();
            let braces =
                if open == 1 { "a closing brace is".into() } else { format!("{open} closing braces are") };
            let hint = "the file is cut off or damaged; export it again";
            return Err(self.error(
                "bvh-brace",
                &word,
                format!("{braces} missing before {}", word.shown()),
                hint,
            ));
        } else {
            let what = format!(
                "expected OFFSET, CHANNELS, JOINT, End Site or a closing brace, found {}",
                word.shown()
            );
            let hint = "a joint holds nothing else; mend the line or export the file again";
            return Err(self.error("bvh-keyword", &word, what, hint));
        }
        Ok(true)
    }

    fn outer_statement(&mut self, word: &Word<'_>) -> Result<bool, FormatError> {
        let none_yet = self.out.joints.is_empty();
        if word.is("ROOT") {
            self.begin_joint(word)?;
            return Ok(true);
        }
        if word.is("MOTION") && !none_yet {
            return Ok(false);
        }
        if none_yet {
            let hint = "after HIERARCHY comes ROOT with a name";
            return Err(self.error(
                "bvh-no-root",
                word,
                format!("expected ROOT, found {}", word.shown()),
                hint,
            ));
        }
        if word.text.is_empty() {
            let hint = "the file holds a skeleton only; export it again with its animation";
            return Err(self.error("bvh-no-motion", word, "the file has no MOTION", hint));
        }
        let hint = "after the last brace of a root comes another ROOT, or MOTION";
        Err(self.error("bvh-keyword", word, format!("expected MOTION or ROOT, found {}", word.shown()), hint))
    }

    fn begin_joint(&mut self, keyword: &Word<'_>) -> Result<(), FormatError> {
        if self.in_end_site() {
            return Err(self.end_site_error(keyword));
        }
        let word = self.lexer.name();
        if word.text.len() > self.limits.name_bytes {
            return Err(FormatError::Limit {
                what: format!("a joint name has {} bytes", word.text.len()),
                limit: self.limits.name_bytes,
                place: Some(self.lexer.place(&word, None)),
                hint: "give the joint a shorter name".into(),
            });
        }
        let name = String::from_utf8_lossy(word.text).into_owned();
        if name.as_bytes() != word.text && self.out.first_broken_name.is_none() {
            self.out.first_broken_name = Some(self.lexer.place(&word, None));
        }
        if name.is_empty() && self.out.first_empty_name.is_none() {
            self.out.first_empty_name = Some(self.lexer.place(&word, None));
        }
        if let Some(open) = self.open.last_mut() {
            open.has_child = true;
        }
        self.begin(keyword, name, false)
    }

    fn begin_end_site(&mut self, keyword: &Word<'_>) -> Result<(), FormatError> {
        if self.in_end_site() {
            return Err(self.end_site_error(keyword));
        }
        // `Site`, and whatever a program writes behind it.
        self.lexer.name();
        let Some(open) = self.open.last_mut() else { return Ok(()) };
        open.end_sites += 1;
        let parent = self.out.joints.get(open.joint).map_or("", |joint| joint.name.as_str());
        let number = if open.end_sites == 1 { String::new() } else { open.end_sites.to_string() };
        let name = [parent, "_end", &number].concat();
        self.end_name_bytes += name.len();
        let limit = self.lexer.len() + FREE_END_NAMES;
        if self.end_name_bytes > limit {
            return Err(FormatError::Limit {
                what: format!(
                    "the names of end sites, made from their joints', have {} bytes",
                    self.end_name_bytes
                ),
                limit,
                place: Some(self.lexer.place(keyword, Some(&name))),
                hint: "give joints with many end sites a shorter name".into(),
            });
        }
        self.begin(keyword, name, true)
    }

    fn begin(&mut self, keyword: &Word<'_>, name: String, end_site: bool) -> Result<(), FormatError> {
        let joint = self.out.joints.len();
        if joint >= self.limits.joints {
            return Err(FormatError::Limit {
                what: format!("the skeleton has {} joints or more", joint + 1),
                limit: self.limits.joints,
                place: Some(self.lexer.place(keyword, Some(&name))),
                hint: "leave some out where the file is made, such as those of fingers, hair and cloth"
                    .into(),
            });
        }
        let brace = self.lexer.word();
        if brace.text != b"{" {
            let what = format!("expected an opening brace, found {}", brace.shown());
            let hint = "after the name of a joint comes `{`";
            return Err(self.lexer.error("bvh-brace", &brace, Some(&name), what, hint));
        }
        let parent = self.open.last().map(|open| open.joint);
        self.out.joints.push(RawJoint { name, parent, offset: DVec3::ZERO, end_site, channels: Vec::new() });
        self.open.push(Open {
            joint,
            has_offset: false,
            has_channels: false,
            end_sites: 0,
            has_child: false,
        });
        Ok(())
    }

    fn offset(&mut self, keyword: &Word<'_>) -> Result<(), FormatError> {
        if self.open.last().is_some_and(|open| open.has_offset) {
            return Err(self.error(
                "bvh-twice",
                keyword,
                "a second OFFSET in one joint",
                "leave one of them out",
            ));
        }
        let mut offset = DVec3::ZERO;
        for axis in Axis::ALL {
            let word = self.lexer.word();
            let value = word.number().map_err(|error| {
                let what = format!("expected the {axis:?} of OFFSET, found {}", word.shown());
                self.error("bvh-number", &word, what, error.hint())
            })?;
            offset.set(axis, value);
        }
        if let Some(open) = self.open.last_mut() {
            open.has_offset = true;
            if let Some(joint) = self.out.joints.get_mut(open.joint) {
                joint.offset = offset;
            }
        }
        Ok(())
    }

    fn channels(&mut self, keyword: &Word<'_>) -> Result<(), FormatError> {
        if self.open.last().is_some_and(|open| open.has_channels) {
            return Err(self.error(
                "bvh-twice",
                keyword,
                "a second CHANNELS in one joint",
                "leave one of them out",
            ));
        }
        if self.open.last().is_some_and(|open| open.has_child) {
            let hint = "put CHANNELS right after OFFSET: the order of the columns hangs on it";
            return Err(self.error("bvh-channels", keyword, "CHANNELS after a child joint", hint));
        }
        let count_word = self.lexer.word();
        let count = count_word.number().ok().filter(|&count| count >= 0.0 && count.fract() == 0.0);
        let Some(count) = count else {
            let what = format!("expected the number of channels, found {}", count_word.shown());
            let hint = "write how many channels follow, such as `CHANNELS 3 Zrotation Xrotation Yrotation`";
            return Err(self.error("bvh-channels", &count_word, what, hint));
        };
        if count > 0.0 && self.in_end_site() {
            let hint = "an end site cannot move; make it a JOINT";
            return Err(self.error("bvh-end-site", keyword, "an end site with channels", hint));
        }
        let mut channels = Vec::new();
        while (channels.len() as f64) < count {
            let word = self.lexer.word();
            channels.push(self.channel(&word, &channels, count)?);
        }
        channels.shrink_to_fit();
        if let Some(open) = self.open.last_mut() {
            open.has_channels = true;
            if let Some(joint) = self.out.joints.get_mut(open.joint) {
                joint.channels = channels;
            }
        }
        Ok(())
    }

    fn channel(&self, word: &Word<'_>, before: &[Channel], count: f64) -> Result<Channel, FormatError> {
        let Some(channel) = Channel::from_bvh(word.text) else {
            let what = format!("expected channel {} of {count}, found {}", before.len() + 1, word.shown());
            let hint = "channels are Xposition, Yposition, Zposition, Xrotation, Yrotation, Zrotation";
            return Err(self.error("bvh-channels", word, what, hint));
        };
        if matches!(channel, Channel::Position(_)) && before.contains(&channel) {
            let hint = "a joint has one position along each axis; leave one out, with its column";
            return Err(self.error("bvh-channels", word, format!("a second {}", word.shown()), hint));
        }
        Ok(channel)
    }

    fn close(&mut self, brace: &Word<'_>) -> Result<(), FormatError> {
        if self.open.last().is_some_and(|open| !open.has_offset) {
            let hint = "every joint says its place as `OFFSET x y z`";
            return Err(self.error("bvh-no-offset", brace, "a joint without OFFSET", hint));
        }
        self.open.pop();
        Ok(())
    }

    fn in_end_site(&self) -> bool {
        let joint = self.open.last().and_then(|open| self.out.joints.get(open.joint));
        joint.is_some_and(|joint| joint.end_site)
    }

    fn end_site_error(&self, word: &Word<'_>) -> FormatError {
        let hint = "an end site is the tip of a chain; make it a JOINT";
        self.error("bvh-end-site", word, format!("{} inside an end site", word.shown()), hint)
    }

    /// An error at a word, in the joint that is open.
    fn error(
        &self,
        code: &'static str,
        word: &Word<'_>,
        what: impl Into<String>,
        hint: impl Into<String>,
    ) -> FormatError {
        let joint = self.open.last().and_then(|open| self.out.joints.get(open.joint));
        self.lexer.error(code, word, joint.map(|joint| joint.name.as_str()), what, hint)
    }
}
