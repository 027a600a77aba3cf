//! Which format a file has, told by its first bytes and never by its name.

use crate::{SoundError, ogg};
use std::fmt;

/// The file formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SoundFormat {
    /// RIFF WAVE: PCM of 8 to 32 bits, float, A-law, mu-law.
    Wav,
    /// Native FLAC.
    Flac,
    /// Vorbis in Ogg.
    OggVorbis,
    /// MPEG layer 3.
    Mp3,
}

impl fmt::Display for SoundFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Wav => "WAV",
            Self::Flac => "FLAC",
            Self::OggVorbis => "Ogg Vorbis",
            Self::Mp3 => "MP3",
        })
    }
}

impl SoundFormat {
    /// Whether a file name of this format ends so. `extension` comes without its dot, in any case.
    pub(crate) fn has_extension(self, extension: &str) -> bool {
        let usual: &[&str] = match self {
            Self::Wav => &["wav", "wave"],
            Self::Flac => &["flac"],
            Self::OggVorbis => &["ogg", "oga"],
            Self::Mp3 => &["mp3"],
        };
        usual.iter().any(|usual| usual.eq_ignore_ascii_case(extension))
    }

    /// The format of a file, and its bytes without a leading ID3v2 tag. `extension` only decides whether frames of MP3
    /// are looked for behind bytes that nobody knows.
    pub(crate) fn of<'a>(bytes: &'a [u8], extension: &str) -> Result<(Self, &'a [u8]), SoundError> {
        let body = without_id3(bytes);
        let tagged = body.len() < bytes.len();
        let format = match body {
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'A', b'V', b'E', ..] => Self::Wav,
            [b'f', b'L', b'a', b'C', ..] => Self::Flac,
            [b'O', b'g', b'g', b'S', ..] => {
                ogg::check(body)?;
                Self::OggVorbis
            }
            [0xff, second, ..] if second & 0xe0 == 0xe0 => Self::Mp3,
            _ => match known(body) {
                Some(name) => {
                    return Err(SoundError::UnknownFormat { found: format!(" (it looks like {name})") });
                }
                None if tagged || Self::Mp3.has_extension(extension) => Self::Mp3,
                None => return Err(SoundError::UnknownFormat { found: String::new() }),
            },
        };
        Ok((format, body))
    }
}

/// The bytes behind ID3v2 tags: they hold titles and pictures, which nobody needs here. A tag that claims to be longer
/// than the file is left in place.
fn without_id3(bytes: &[u8]) -> &[u8] {
    let mut rest = bytes;
    while let [b'I', b'D', b'3', _, _, flags, a, b, c, d, ..] = rest {
        let size = [a, b, c, d].into_iter().fold(0_usize, |size, byte| size << 7 | usize::from(byte & 0x7f));
        let footer = if flags & 0x10 != 0 { 10 } else { 0 };
        match rest.get(10 + size + footer..) {
            Some(behind) if !behind.is_empty() => rest = behind,
            _ => break,
        }
    }
    rest
}

/// What people also call a sound file, to be named in the error.
fn known(bytes: &[u8]) -> Option<&'static str> {
    Some(match bytes {
        [_, _, _, _, b'f', b't', b'y', b'p', ..] => "MP4 or M4A",
        [b'F', b'O', b'R', b'M', ..] => "AIFF",
        [b'R', b'F', b'6', b'4', ..] | [b'R', b'I', b'F', b'X', ..] => "a WAV of another kind, RF64 or RIFX",
        [b'R', b'I', b'F', b'F', ..] => "a RIFF file without sound, such as AVI",
        [0x1a, 0x45, 0xdf, 0xa3, ..] => "Matroska or WebM",
        [b'c', b'a', b'f', b'f', ..] => "CAF",
        [0x30, 0x26, 0xb2, 0x75, ..] => "WMA",
        [b'M', b'T', b'h', b'd', ..] => "MIDI, which holds notes and no sound",
        [b'P', b'K', 3, 4, ..] => "a ZIP archive",
        [b'<', ..] => "a web page",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_content_decides_and_not_the_name() {
        let (format, _) = SoundFormat::of(b"RIFF\0\0\0\0WAVEfmt ", "mp3").unwrap();
        assert_eq!(format, SoundFormat::Wav);
        assert!(SoundFormat::of(b"hello world", "wav").is_err());
        assert_eq!(SoundFormat::of(b"\0\0\0\0hello", "MP3").unwrap().0, SoundFormat::Mp3);
    }

    #[test]
    fn tags_in_front_are_stepped_over() {
        let mut bytes = b"ID3\x04\0\0\0\0\x01\x02".to_vec();
        bytes.extend([0; 130]);
        bytes.extend(b"fLaC");
        let (format, body) = SoundFormat::of(&bytes, "").unwrap();
        assert_eq!((format, body), (SoundFormat::Flac, &b"fLaC"[..]));
    }

    #[test]
    fn a_tag_longer_than_the_file_is_left_alone() {
        let bytes = b"ID3\x04\0\0\x7f\x7f\x7f\x7fxyz";
        assert_eq!(without_id3(bytes), bytes);
    }

    #[test]
    fn other_formats_are_named() {
        let error = SoundFormat::of(b"\0\0\0\x20ftypM4A ", "m4a").unwrap_err().to_string();
        assert!(error.contains("MP4 or M4A") && error.contains("convert"), "{error}");
    }
}
