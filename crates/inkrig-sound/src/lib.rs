//! Sounds as curves over time: what a motion is matched with, and what a report compares it with.
//!
//! [`decode`] turns the bytes of a WAV, FLAC, Ogg Vorbis or MP3 file into a mono [`Sound`]. [`mfcc`] describes its
//! timbre the way librosa does by default, [`loudness`] its level, [`onset_strength`] its beats, all at
//! [`FRAME_RATE_HZ`]. [`waveform`] gives the plain wave at the rate of a control. The crate opens no files and
//! depends on no other crate of the workspace.
//!
//! ```
//! use inkrig_sound::{FRAME_RATE_HZ, MfccOptions, Sound, mfcc};
//!
//! let tone = (0..44_100).map(|i| (i as f32 * 0.05).sin()).collect();
//! let sound = Sound::new(tone, 44_100)?;
//! let mfcc = mfcc(&sound, &MfccOptions::default())?;
//! assert_eq!((mfcc.frames, mfcc.coefficients), (44, 40));
//! assert_eq!(mfcc.rate_hz, FRAME_RATE_HZ);
//! # Ok::<(), inkrig_sound::SoundError>(())
//! ```
#![cfg_attr(not(test), deny(clippy::indexing_slicing))]

mod bits;
mod decode;
mod envelope;
mod error;
mod finding;
mod format;
mod loudness;
mod mel_filters;
mod mel_spectrogram;
mod mfcc;
mod ogg;
mod onset;
mod packets;
mod resample;
mod sound;
mod vorbis_setup;
mod wav;
mod waveform;

pub use decode::{Decoded, MAX_BYTES, MAX_CHANNELS, MAX_SAMPLES, MAX_SAMPLES_PER_BYTE, MAX_SECONDS, decode};
pub use envelope::Envelope;
pub use error::SoundError;
pub use finding::Finding;
pub use format::SoundFormat;
pub use loudness::{LOUDNESS_FLOOR_DB, LoudnessScale, loudness};
pub use mel_spectrogram::{ANALYSIS_RATE, FRAME_RATE_HZ, HOP, MEL_BANDS, MelSpectrogram, WINDOW};
pub use mfcc::{Mfcc, MfccOptions, mfcc};
pub use onset::onset_strength;
pub use resample::{MIN_TARGET_RATE, resample};
pub use sound::{MAX_RATE, SILENCE_PEAK, Sound};
pub use waveform::{WaveformKind, waveform};
