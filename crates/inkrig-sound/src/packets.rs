//! Packet by packet through a file, under limits.

use crate::{
    MAX_CHANNELS, MAX_SAMPLES, MAX_SAMPLES_PER_BYTE, MAX_SECONDS, SoundError, SoundFormat,
    sound::{MAX_RATE, is_level},
    wav,
};
use std::io::Cursor;
use symphonia::{
    core::{
        audio::{Channels, GenericAudioBufferRef},
        codecs::audio::{AudioDecoder, AudioDecoderOptions},
        errors::Error,
        formats::{FormatOptions, FormatReader, TrackType},
        io::MediaSourceStream,
        packet::Packet,
    },
    default::{
        formats::{FlacReader, MpaReader, OggReader, WavReader},
        get_codecs,
    },
};

/// The longest packet that can be lost and replaced by silence: FLAC's largest block.
const MAX_LOST_SAMPLES: u64 = 65_535;
/// The longest hole that is believed and filled in a file that does not say how long it is.
const MAX_GAP_SECONDS: u64 = 10;

/// A file that was opened and whose header was found to be within the limits.
pub(crate) struct Packets<'a> {
    format: SoundFormat,
    reader: Box<dyn FormatReader + 'a>,
    decoder: Box<dyn AudioDecoder>,
    track: u32,
    most: usize,
    /// When the first packet begins, samples.
    first: Option<u64>,
    interleaved: Vec<f32>,
    read: Read,
}

/// What was taken from a file.
#[derive(Default)]
pub(crate) struct Read {
    pub(crate) samples: Vec<f32>,
    pub(crate) rate: u32,
    pub(crate) channels: usize,
    /// Samples that the header promises, where it is a promise and no estimate.
    pub(crate) announced: Option<u64>,
    /// Packets that were damaged.
    pub(crate) lost: usize,
    /// Samples that were no levels.
    pub(crate) bad: usize,
    /// Why reading ended before the file's end.
    pub(crate) stopped: Option<String>,
    pub(crate) chained: bool,
    /// Whether the file's own checksum is right, where it has one.
    pub(crate) checksum: Option<bool>,
}

impl<'a> Packets<'a> {
    pub(crate) fn open(format: SoundFormat, bytes: &'a [u8]) -> Result<Self, SoundError> {
        if format == SoundFormat::Wav {
            wav::check(bytes)?;
        }
        let error = |error| because(format, &error);
        let source = MediaSourceStream::new(Box::new(Cursor::new(bytes)), Default::default());
        let options = FormatOptions::default();
        let reader: Box<dyn FormatReader + 'a> = match format {
            SoundFormat::Wav => Box::new(WavReader::try_new(source, options).map_err(error)?),
            SoundFormat::Flac => Box::new(FlacReader::try_new(source, options).map_err(error)?),
            SoundFormat::OggVorbis => Box::new(OggReader::try_new(source, options).map_err(error)?),
            SoundFormat::Mp3 => Box::new(MpaReader::try_new(source, options).map_err(error)?),
        };
        let damaged = |what: &str| SoundError::Damaged { format, what: what.into() };
        let track = reader.default_track(TrackType::Audio).ok_or_else(|| damaged("no sound is in it"))?;
        let parameters = track.codec_params.as_ref().and_then(|parameters| parameters.audio());
        let parameters = parameters.ok_or_else(|| damaged("its sound is not described"))?;
        let channels = parameters.channels.as_ref().map_or(0, Channels::count);
        let rate = parameters.sample_rate.unwrap_or(0);
        check_channels(format, channels)?;
        if !(1..=MAX_RATE).contains(&rate) {
            return Err(SoundError::BadRate { rate: rate.into(), least: 1.0, most: MAX_RATE.into() });
        }
        // An MP3 without the encoder's tag has a length that is guessed from its bit rate.
        let is_promise = format != SoundFormat::Mp3 || track.delay.is_some();
        let announced = track.num_frames.filter(|_| is_promise);
        // Trimming to a guess would cut real sound from files of varying bit rate.
        let options = AudioDecoderOptions::default().verify(true).gapless(is_promise);
        let decoder = get_codecs().make_audio_decoder(parameters, &options).map_err(error)?;
        let track = track.id;
        let most = MAX_SAMPLES
            .min(MAX_SAMPLES_PER_BYTE.saturating_mul(bytes.len()))
            .min(usize::try_from(u64::from(rate) * u64::from(MAX_SECONDS)).unwrap_or(usize::MAX));
        if format == SoundFormat::Flac {
            // Only here a length is counted by the encoder and never a guess; a stream without one says 0.
            let announced = usize::try_from(announced.unwrap_or(0)).unwrap_or(usize::MAX);
            let longest = usize::try_from(u64::from(rate) * u64::from(MAX_SECONDS)).unwrap_or(usize::MAX);
            check_length(announced, MAX_SAMPLES.min(longest), rate)?;
        }
        let read = Read { rate, channels, announced, ..Read::default() };
        Ok(Self { format, reader, decoder, track, most, first: None, interleaved: Vec::new(), read })
    }

    pub(crate) fn read_all(mut self) -> Result<Read, SoundError> {
        let mut decoded = false;
        loop {
            let packet = match self.reader.next_packet() {
                Ok(Some(packet)) => packet,
                Ok(None) => break,
                Err(Error::ResetRequired) => {
                    self.read.chained = true;
                    break;
                }
                Err(error) => {
                    self.stop(&error);
                    break;
                }
            };
            if packet.track_id != self.track {
                continue;
            }
            self.fill_gap(&packet)?;
            match self.decoder.decode(&packet) {
                Ok(audio) => {
                    if audio.spec().rate() != self.read.rate {
                        let (before, after) = (self.read.rate, audio.spec().rate());
                        self.read.stopped = Some(format!("its rate changes from {before} to {after} Hz"));
                        break;
                    }
                    check_channels(self.format, audio.spec().channels().count())?;
                    mix(&audio, &mut self.interleaved, &mut self.read, self.most)?;
                    decoded = true;
                }
                Err(Error::DecodeError(_) | Error::IoError(_)) => {
                    self.silence(packet.dur.get().min(MAX_LOST_SAMPLES))?;
                    self.read.lost += 1;
                }
                Err(error) => {
                    self.stop(&error);
                    break;
                }
            }
        }
        if !decoded || self.read.samples.is_empty() {
            let what = self.read.stopped.unwrap_or_else(|| "no sound could be decoded from it".into());
            return Err(SoundError::Damaged { format: self.format, what });
        }
        self.read.checksum = self.decoder.finalize().verify_ok;
        Ok(self.read)
    }

    /// Readers step over frames and pages whose header or checksum is damaged. Packets say when they begin, so the hole is
    /// known.
    fn fill_gap(&mut self, packet: &Packet) -> Result<(), SoundError> {
        // MP3 frames do not know their time.
        if self.format == SoundFormat::Mp3 {
            return Ok(());
        }
        let trimmed = i64::try_from(packet.trim_start.get()).unwrap_or(i64::MAX);
        let begin = u64::try_from(packet.pts.get().saturating_add(trimmed)).unwrap_or(0);
        // Ogg cut from a longer stream may begin at any time.
        let first = if self.format == SoundFormat::OggVorbis { begin } else { 0 };
        let begin = begin.saturating_sub(*self.first.get_or_insert(first));
        let gap = begin.saturating_sub(self.read.samples.len() as u64);
        let is_likely = match self.read.announced {
            Some(announced) => begin.saturating_add(packet.dur.get()) <= announced,
            None => gap <= MAX_GAP_SECONDS * u64::from(self.read.rate),
        };
        if gap == 0 {
            return Ok(());
        }
        self.read.lost += 1;
        if is_likely { self.silence(gap) } else { Ok(()) }
    }

    fn silence(&mut self, length: u64) -> Result<(), SoundError> {
        let end = usize::try_from(length).unwrap_or(usize::MAX).saturating_add(self.read.samples.len());
        check_length(end, self.most, self.read.rate)?;
        self.read.samples.resize(end, 0.0);
        Ok(())
    }

    /// Remembers why reading ended. MP3 and WAV readers report the plain end of a file as an error.
    fn stop(&mut self, error: &Error) {
        if !is_end(error) {
            self.read.stopped = Some(error.to_string());
        }
    }
}

/// Appends the mean of the channels.
fn mix(
    audio: &GenericAudioBufferRef<'_>,
    interleaved: &mut Vec<f32>,
    read: &mut Read,
    most: usize,
) -> Result<(), SoundError> {
    check_length(read.samples.len() + audio.frames(), most, read.rate)?;
    audio.copy_to_vec_interleaved(interleaved);
    let channels = audio.spec().channels().count();
    let share = 1.0 / channels as f64;
    for frame in interleaved.chunks_exact(channels) {
        let mean = (frame.iter().map(|&sample| f64::from(sample)).sum::<f64>() * share) as f32;
        let good = is_level(mean);
        read.bad += usize::from(!good);
        read.samples.push(if good { mean } else { 0.0 });
    }
    Ok(())
}

fn check_channels(format: SoundFormat, channels: usize) -> Result<(), SoundError> {
    match channels {
        0 => Err(SoundError::Damaged { format, what: "it has no channels".into() }),
        1..=MAX_CHANNELS => Ok(()),
        _ => Err(SoundError::Limit {
            what: format!("{channels} channels"),
            limit: MAX_CHANNELS.to_string(),
            hint: "mix it down first",
        }),
    }
}

fn check_length(samples: usize, most: usize, rate: u32) -> Result<(), SoundError> {
    if samples <= most {
        return Ok(());
    }
    Err(SoundError::Limit {
        what: format!("more than {most} samples at {rate} Hz"),
        limit: format!(
            "{MAX_SECONDS} seconds, {MAX_SAMPLES} samples, and {MAX_SAMPLES_PER_BYTE} samples for each byte of the file"
        ),
        hint: "cut the part that is needed",
    })
}

fn is_end(error: &Error) -> bool {
    matches!(error, Error::IoError(error) if error.kind() == std::io::ErrorKind::UnexpectedEof)
}

fn because(format: SoundFormat, error: &Error) -> SoundError {
    match error {
        Error::Unsupported(what) => SoundError::Unsupported { format, what: (*what).into() },
        error if is_end(error) => {
            SoundError::Damaged { format, what: "it ends before its sound begins".into() }
        }
        error => SoundError::Damaged { format, what: error.to_string() },
    }
}
