//! What can go wrong between a file and its curves.

use crate::SoundFormat;

/// Why a sound could not be read or used. The message says what is wrong and what to do.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SoundError {
    /// There is nothing in the file.
    #[error("the sound file is empty (0 bytes); export it again")]
    EmptyFile,
    /// The first bytes belong to none of the formats that are read.
    #[error("this is no WAV, FLAC, Ogg Vorbis or MP3 file{found}; convert it to WAV or FLAC")]
    UnknownFormat {
        /// What it seems to be instead, as ` (it looks like ...)`, or nothing.
        found: String,
    },
    /// The container or codec is one of ours, but a part of it is not supported.
    #[error(
        "this {format} file uses something that is not supported: {what}; convert it to 16-bit WAV or FLAC"
    )]
    Unsupported {
        /// The container.
        format: SoundFormat,
        /// Which part.
        what: String,
    },
    /// The file breaks the rules of its own format, and no sound could be taken from it.
    #[error("this {format} file is damaged: {what}; export it again or convert it with another program")]
    Damaged {
        /// The container.
        format: SoundFormat,
        /// What was found.
        what: String,
    },
    /// The file has more of something than is allowed.
    #[error("the sound has {what}, more than the limit of {limit}; {hint}")]
    Limit {
        /// What there is too much of, with its number.
        what: String,
        /// The largest allowed value, with its unit.
        limit: String,
        /// What to do.
        hint: &'static str,
    },
    /// A sound made from samples has none.
    #[error("a sound needs at least one sample")]
    NoSamples,
    /// A sample is NaN, infinite or beyond any real level.
    #[error("sample {index} is {value}, not a sound level; full scale is -1 to 1")]
    BadSample {
        /// Which sample, from 0.
        index: usize,
        /// What it was.
        value: f32,
    },
    /// A sample rate out of range.
    #[error("a sample rate of {rate} Hz cannot be used; rates from {least} to {most} Hz can")]
    BadRate {
        /// The rate, Hz.
        rate: f64,
        /// The lowest rate, Hz.
        least: f64,
        /// The highest rate, Hz.
        most: f64,
    },
    /// An option of [`mfcc`](crate::mfcc) out of range.
    #[error("{what}; {hint}")]
    Options {
        /// Which option and its value.
        what: String,
        /// What to do.
        hint: &'static str,
    },
}
