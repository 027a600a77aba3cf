//! Rows of a BVH file as they stand there, to be written again byte for byte.

use super::{hierarchy_parser, motion, rows};
use crate::{FormatError, KeptRow, Limits, lexer::Lexer};
use std::ops::Range;

/// The rows of some frames of a BVH file, without their line ends.
///
/// # Errors
/// As for [`read_bvh`](crate::read_bvh); and when a frame is not there, or frames do not end with their lines.
pub fn bvh_rows(bytes: &[u8], frames: Range<usize>) -> Result<Vec<KeptRow>, FormatError> {
    let mut lexer = Lexer::new(bytes);
    let hierarchy = hierarchy_parser::parse(&mut lexer, &Limits::default())?;
    let announced = motion::frame_count_of_header(&mut lexer)?;
    let width = hierarchy.width();
    let is_blank = |line: &&[u8]| line.iter().all(u8::is_ascii_whitespace);
    let lines = lexer.rest().split(|&byte| byte == b'\n' || byte == b'\r').filter(|line| !is_blank(line));
    let kept: Vec<KeptRow> = (lines.enumerate().skip(frames.start).take(frames.len()))
        .map(|(frame, text)| KeptRow { frame, text: text.to_vec() })
        .collect();
    let mut at_rows = lexer.clone();
    at_rows.skip_space();
    let wrapped = rows::shape(&at_rows, width, announced).wrapped;
    let whole = |row: &KeptRow| row.numbers().count() == width;
    if width == 0 || kept.len() < frames.len() || wrapped || !kept.iter().all(whole) {
        return Err(FormatError::Write {
            what: format!(
                "frames {} to {} cannot be kept as they stand in the file",
                frames.start, frames.end
            ),
            hint:
                "keep frames that are there, of a file with one frame a line; write it anew first if need be"
                    .into(),
        });
    }
    Ok(kept)
}

impl KeptRow {
    /// Its words that are numbers.
    pub(super) fn numbers(&self) -> impl Iterator<Item = f64> + '_ {
        let words = self.text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        words.filter_map(|word| std::str::from_utf8(word).ok()?.parse::<f64>().ok())
    }
}
