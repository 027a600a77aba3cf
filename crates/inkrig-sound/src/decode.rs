//! Bytes of a file to a mono sound.

use crate::{
    Finding, Sound, SoundError, SoundFormat, ogg,
    packets::{Packets, Read},
};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// The largest file that is read, bytes: 256 MiB.
pub const MAX_BYTES: usize = 256 << 20;
/// The longest sound that is read, seconds: what can be matched, 100,000 frames of 30 a second, and a little more.
pub const MAX_SECONDS: u32 = 3334;
/// The most channels that are read.
pub const MAX_CHANNELS: usize = 64;
/// The most mono samples that are kept: [`MAX_SECONDS`] at 48 kHz, 640 MB.
pub const MAX_SAMPLES: usize = MAX_SECONDS as usize * 48_000;
/// The most samples that one byte of a file may stand for. Digital silence in FLAC and Vorbis reaches 300 to 1300.
pub const MAX_SAMPLES_PER_BYTE: usize = 2048;

/// A sound and what is known of its file.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoded {
    /// The mean of all channels, at the file's own rate.
    pub sound: Sound,
    /// What the file was, told by its content.
    pub format: SoundFormat,
    /// Channels in the file.
    pub channels: usize,
    /// What was not as it should be. Empty for a good file.
    pub findings: Vec<Finding>,
}

/// Decodes a WAV, FLAC, Ogg Vorbis or MP3 file from its bytes.
///
/// The format is told by the content. `hint_extension` is the file name's ending without dot, or empty; it is compared
/// with the content, and lets MP3 frames be looked for behind unknown bytes. A file whose end is missing or whose packets
/// are partly damaged gives what could be decoded and a [`Finding`]; a lost packet becomes as much silence, so that
/// what follows keeps its time. Encoder delay and padding are cut where the file states them.
///
/// # Errors
/// [`SoundError`] for an empty or unknown file, one that goes over a limit ([`MAX_BYTES`], [`MAX_SECONDS`],
/// [`MAX_CHANNELS`], [`MAX_SAMPLES`], [`MAX_SAMPLES_PER_BYTE`]), or one of which nothing could be decoded.
pub fn decode(bytes: &[u8], hint_extension: &str) -> Result<Decoded, SoundError> {
    if bytes.is_empty() {
        return Err(SoundError::EmptyFile);
    }
    if bytes.len() > MAX_BYTES {
        return Err(SoundError::Limit {
            what: format!("{} bytes", bytes.len()),
            limit: format!("{MAX_BYTES} bytes"),
            hint: "cut the part that is needed, or convert it to FLAC",
        });
    }
    let (format, body) = SoundFormat::of(bytes, hint_extension)?;
    // The decoders are tested, but they are not ours, and some hostile headers are known to make them panic.
    let read = contained(format, || Packets::open(format, body)?.read_all())?;
    let mut findings = Vec::new();
    if !hint_extension.is_empty() && !format.has_extension(hint_extension) {
        let message =
            format!("the file's name says otherwise, but its content is {format} and was read as that");
        findings.push(Finding::new("sound-extension", message));
    }
    note(&mut findings, format, body, &read);
    let sound = Sound::new(read.samples, read.rate)?;
    if sound.is_silent() {
        findings.push(Finding::new(
            "sound-silent",
            "the sound is silent: no sample reaches -80 dB of full scale",
        ));
    }
    Ok(Decoded { sound, format, channels: read.channels, findings })
}

fn note(findings: &mut Vec<Finding>, format: SoundFormat, body: &[u8], read: &Read) {
    let seconds = |samples: u64| samples as f64 / f64::from(read.rate);
    let there = read.samples.len() as u64;
    let cut = match read.announced {
        Some(announced) if there < announced => {
            Some(format!("{:.3} of {:.3} seconds are there", seconds(there), seconds(announced)))
        }
        _ if format == SoundFormat::OggVorbis && !ogg::is_closed(body) => {
            Some(format!("its last page is missing; {:.3} seconds were read", seconds(there)))
        }
        _ => read.stopped.as_ref().map(|why| format!("{why}; {:.3} seconds were read", seconds(there))),
    };
    let whole = cut.is_none() && read.lost == 0;
    if let Some(what) = cut {
        findings.push(Finding::new("sound-cut-short", format!("the file is cut short or damaged: {what}")));
    }
    if read.lost > 0 {
        let message = format!("{} damaged parts were replaced by silence", read.lost);
        findings.push(Finding::new("sound-packets-lost", message));
    }
    if read.bad > 0 {
        let message =
            format!("{} samples were not finite or far beyond full scale and were set to 0", read.bad);
        findings.push(Finding::new("sound-bad-samples", message));
    }
    if read.chained {
        let message = "several streams are chained in the file; only the first was read";
        findings.push(Finding::new("sound-chained", message));
    }
    if whole && read.checksum == Some(false) {
        let message = "the checksum in the file is that of another sound; some of it may be damaged";
        findings.push(Finding::new("sound-checksum", message));
    }
}

/// Runs a decoder; a panic in it is an error of the file.
fn contained<T>(format: SoundFormat, run: impl FnOnce() -> Result<T, SoundError>) -> Result<T, SoundError> {
    // Nothing that the closure touched is looked at after a panic.
    catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| {
        Err(SoundError::Damaged { format, what: "the decoder could not make sense of it and gave up".into() })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_in_a_decoder_is_an_error() {
        let result: Result<(), _> = contained(SoundFormat::Mp3, || panic!("on purpose"));
        assert!(matches!(result, Err(SoundError::Damaged { format: SoundFormat::Mp3, .. })));
    }

    #[test]
    fn size_is_checked_first() {
        // Zero pages that are never touched: no memory is really used.
        let error = decode(&vec![0; MAX_BYTES + 1], "wav").unwrap_err();
        assert!(matches!(error, SoundError::Limit { .. }), "{error}");
    }
}
