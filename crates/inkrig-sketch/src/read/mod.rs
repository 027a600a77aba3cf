//! Drawings as files: bytes in, [`Curve`] out.

pub(crate) mod csv;
mod drawing;
pub(crate) mod json;
pub(crate) mod svg;

pub use drawing::{Drawing, read_drawing};

use std::path::Path;

use crate::limits::MAX_BYTES;
use crate::{Curve, SketchError};

/// The kinds of file a curve is read from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Format {
    /// `[[x, y], ...]`, `[[x, y, t], ...]`, `[{"x": 0, "y": 0, "t": 0, "pressure": 1}, ...]`, `{"points": [...]}` or
    /// `{"strokes": [[...], ...]}`. x and y are taken as they are, y up; t is in seconds. Other keys are ignored.
    Json,
    /// Rows `x,y[,t[,pressure]]` with comma, semicolon or tab; a header may name the columns in any order; `#` begins a
    /// comment line. x and y are taken as they are, y up; t is in seconds. One stroke. For more dimensions: [`read_drawing`].
    Csv,
    /// All visible paths and shapes in document order, as they appear on the page, with y **turned to point up**.
    /// Every subpath is a stroke. Nothing outside the file is read; text and images are left out.
    Svg,
}

impl Format {
    /// The format that a file's name says, or `None`.
    ///
    /// Compressed SVG (`.svgz`) counts as SVG, whose reader says that it has to be unpacked.
    pub fn from_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_str()?.to_ascii_lowercase();
        match extension.as_str() {
            "json" => Some(Self::Json),
            "csv" | "tsv" | "txt" => Some(Self::Csv),
            "svg" | "svgz" => Some(Self::Svg),
            _ => None,
        }
    }

    /// The format that the content looks like: the first character tells JSON and SVG; anything else is taken for CSV.
    pub fn sniff(bytes: &[u8]) -> Self {
        let first = bytes.strip_prefix(BOM).unwrap_or(bytes).iter().find(|byte| !byte.is_ascii_whitespace());
        match first {
            Some(b'[' | b'{') => Self::Json,
            Some(b'<') => Self::Svg,
            _ => Self::Csv,
        }
    }
}

const BOM: &[u8] = b"\xEF\xBB\xBF";
const GZIP: &[u8] = b"\x1F\x8B";

/// Reads a curve from the bytes of a file. A byte order mark is skipped.
///
/// # Errors
/// Any [`SketchError`] that says what the file holds and where: too large, compressed, not UTF-8, malformed, no point, too
/// many points, values that are not finite, times that go back.
pub fn read_curve(bytes: &[u8], format: Format) -> Result<Curve, SketchError> {
    if bytes.len() > MAX_BYTES {
        return Err(SketchError::TooLarge { bytes: bytes.len() });
    }
    if bytes.starts_with(GZIP) {
        return Err(SketchError::Compressed);
    }
    let text = utf8(bytes).map_err(|line| SketchError::NotText { line })?;
    match format {
        Format::Json => json::read(text),
        Format::Csv => csv::read(text),
        Format::Svg => svg::read(text),
    }
}

/// The text without its byte order mark, or the line of the first byte that is not UTF-8.
pub(crate) fn utf8(bytes: &[u8]) -> Result<&str, usize> {
    std::str::from_utf8(bytes.strip_prefix(BOM).unwrap_or(bytes)).map_err(|error| {
        let good = bytes.iter().take(error.valid_up_to());
        1 + good.filter(|&&byte| byte == b'\n').count()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_first_characters_tell_the_format() {
        for (name, format) in [
            ("a.json", Some(Format::Json)),
            ("a.b.TSV", Some(Format::Csv)),
            ("x.svgz", Some(Format::Svg)),
            ("x", None),
        ] {
            assert_eq!(Format::from_path(Path::new(name)), format, "{name}");
        }
        for (text, format) in [
            ("\u{feff} [[0,0]]", Format::Json),
            ("{}", Format::Json),
            ("\n<svg/>", Format::Svg),
            ("x,y\n", Format::Csv),
            ("", Format::Csv),
        ] {
            assert_eq!(Format::sniff(text.as_bytes()), format, "{text}");
        }
    }

    #[test]
    fn what_is_no_text_is_refused() {
        assert_eq!(read_curve(b"\x1F\x8B\x08\x00", Format::Svg), Err(SketchError::Compressed));
        assert_eq!(read_curve(b"0,0\n1,\xFF\n", Format::Csv), Err(SketchError::NotText { line: 2 }));
        let large = vec![b' '; MAX_BYTES + 1];
        assert_eq!(read_curve(&large, Format::Json), Err(SketchError::TooLarge { bytes: MAX_BYTES + 1 }));
    }
}
