//! The channel count of a WAV, checked before the reader multiplies with it.

use crate::SoundError;

/// The most channels of a WAV that the decoder has places for.
const MAX_WAV_CHANNELS: u16 = 26;

/// Refuses a `fmt ` chunk with more channels than can be read. What else is wrong is for the reader to say.
pub(crate) fn check(bytes: &[u8]) -> Result<(), SoundError> {
    match channels(bytes) {
        Some(channels) if channels > MAX_WAV_CHANNELS => Err(SoundError::Limit {
            what: format!("{channels} channels"),
            limit: format!("{MAX_WAV_CHANNELS} in a WAV file"),
            hint: "mix it down first",
        }),
        _ => Ok(()),
    }
}

/// Channels as the first `fmt ` chunk has them.
fn channels(bytes: &[u8]) -> Option<u16> {
    // Behind `RIFF`, a length and `WAVE` come chunks: a name, a length, contents padded to an even length.
    let mut rest = bytes.get(12..)?;
    loop {
        let length = u32::from_le_bytes(rest.get(4..8)?.try_into().ok()?) as usize;
        if rest.starts_with(b"fmt ") {
            return Some(u16::from_le_bytes(rest.get(10..12)?.try_into().ok()?));
        }
        rest = rest.get(8_usize.checked_add(length.checked_add(length % 2)?)?..)?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wav(chunks: &[(&[u8; 4], &[u8])]) -> Vec<u8> {
        let mut bytes = b"RIFF\0\0\0\0WAVE".to_vec();
        for (name, contents) in chunks {
            bytes.extend_from_slice(*name);
            bytes.extend((contents.len() as u32).to_le_bytes());
            bytes.extend_from_slice(contents);
            bytes.extend(vec![0; contents.len() % 2]);
        }
        bytes
    }

    #[test]
    fn the_format_may_stand_behind_other_chunks() {
        let bytes = wav(&[(b"LIST", b"odd"), (b"fmt ", &[1, 0, 27, 0])]);
        assert_eq!(channels(&bytes), Some(27));
        assert!(matches!(check(&bytes), Err(SoundError::Limit { .. })));
        assert_eq!(check(&wav(&[(b"fmt ", &[1, 0, 26, 0])])), Ok(()));
    }

    #[test]
    fn a_chunk_longer_than_the_file_ends_the_search() {
        assert_eq!(channels(b"RIFF\0\0\0\0WAVELIST\xff\xff\xff\xffabc"), None);
        assert_eq!(channels(b"RIFF"), None);
    }
}
