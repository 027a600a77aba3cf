//! Moving pictures as WebM, which browsers play: AV1, in parts of two seconds that are encoded side by side and that a player can jump to.

use super::matroska::{self, Picture, Track};
use super::{Pictures, RATE, SIZE};
use crate::commands::storyboard::sheet::Page;
use crate::console::{Bar, Console};
use crate::error::CliError;
use rav1e::color::{ColorDescription, ColorPrimaries, MatrixCoefficients, TransferCharacteristics};
use rav1e::config::SpeedSettings;
use rav1e::prelude::{
    ChromaSampling, Config, Context, EncoderConfig, EncoderStatus, FrameType, PixelRange, Rational,
    SceneDetectionSpeed, Tune,
};
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Pictures of a part.
const PART: usize = 2 * RATE;
/// From 0 (as it is) to 255.
const QUANTIZER: usize = 90;
/// From 0 to 10, the quickest.
const SPEED: u8 = 10;
/// Level 3.0: up to 665 856 pixels, more than [`SIZE`] has.
const LEVEL: u8 = 4;
/// What each packet begins with in AV1, but not in WebM.
const TEMPORAL_DELIMITER: [u8; 2] = [0x12, 0];
/// The kind of unit that says what a stream is.
const SEQUENCE_HEADER: u8 = 1;

/// All pictures as one file.
///
/// # Errors
/// When it was stopped, or a picture cannot be made.
pub(super) fn write(pictures: &Pictures<'_>, console: &Console) -> Result<Vec<u8>, CliError> {
    let bar = console.bar("encoding the moving picture");
    let done = AtomicUsize::new(0);
    let ranges: Vec<Range<usize>> =
        (0..pictures.count).step_by(PART).map(|at| at..(at + PART).min(pictures.count)).collect();
    let parts: Result<Vec<Vec<Picture>>, CliError> =
        ranges.into_par_iter().map(|range| encoded(pictures, range, &bar, &done)).collect();
    // Who stopped it is not told that a picture is missing.
    bar.finish()?;
    let parts = parts?;
    let mut description = context()?.container_sequence_header();
    // The encoder says there that it does not know the level, which the stream itself does.
    if let Some(own) = description.get_mut(1) {
        *own = own.wrapping_shr(5) << 5 | LEVEL;
    }
    let first = parts.first().and_then(|part| part.first());
    description.extend_from_slice(first.and_then(|first| sequence_header(&first.bytes)).unwrap_or_default());
    let track = Track { codec: "V_AV1", description: &description, size: SIZE, rate: RATE };
    Ok(matroska::file(&track, &parts))
}

/// What is the same of all parts, so that one description holds for them.
fn context() -> Result<Context<u8>, CliError> {
    let mut settings = SpeedSettings::from_preset(SPEED);
    // Only a part's first picture is whole.
    settings.scene_detection_mode = SceneDetectionSpeed::None;
    // What repairs photographs costs a tenth of the time and does nothing for lines.
    settings.cdef = false;
    let encoder = EncoderConfig {
        width: SIZE[0],
        height: SIZE[1],
        time_base: Rational::new(1, RATE as u64),
        chroma_sampling: ChromaSampling::Cs420,
        pixel_range: PixelRange::Limited,
        color_description: Some(ColorDescription {
            color_primaries: ColorPrimaries::BT709,
            transfer_characteristics: TransferCharacteristics::BT709,
            matrix_coefficients: MatrixCoefficients::BT709,
        }),
        level_idx: Some(LEVEL),
        min_key_frame_interval: PART as u64,
        max_key_frame_interval: PART as u64,
        low_latency: true,
        quantizer: QUANTIZER,
        tune: Tune::Psnr,
        speed_settings: settings,
        ..EncoderConfig::with_speed_preset(SPEED)
    };
    Config::new().with_encoder_config(encoder).new_context().map_err(|cause| wrong(&cause))
}

/// Pictures of a part; fewer where it was stopped.
fn encoded(
    pictures: &Pictures<'_>,
    range: Range<usize>,
    bar: &Bar,
    done: &AtomicUsize,
) -> Result<Vec<Picture>, CliError> {
    let mut context = context()?;
    let mut found = Vec::with_capacity(range.len());
    for number in range {
        if bar.at(done.fetch_add(1, Relaxed), pictures.count).is_break() {
            return Ok(found);
        }
        let mut frame = context.new_frame();
        let planes = planes(&pictures.draw(number)?);
        for (plane, (bytes, width)) in frame.planes.iter_mut().zip(&planes) {
            plane.copy_from_raw_u8(bytes, *width, 1);
        }
        context.send_frame(frame).map_err(|cause| wrong(&cause))?;
        receive(&mut context, &mut found)?;
    }
    context.flush();
    receive(&mut context, &mut found)?;
    Ok(found)
}

fn receive(context: &mut Context<u8>, found: &mut Vec<Picture>) -> Result<(), CliError> {
    loop {
        match context.receive_packet() {
            Ok(packet) => {
                let bytes = packet.data.strip_prefix(&TEMPORAL_DELIMITER).unwrap_or(&packet.data);
                found.push(Picture { whole: packet.frame_type == FrameType::KEY, bytes: bytes.to_vec() });
            }
            Err(EncoderStatus::Encoded) => {}
            Err(EncoderStatus::NeedMoreData | EncoderStatus::LimitReached) => return Ok(()),
            Err(cause) => return Err(wrong(&cause)),
        }
    }
}

/// Brightness of each pixel, and both differences of colour of each four, by BT.709 in whole numbers, with their widths.
fn planes(page: &Page) -> [(Vec<u8>, usize); 3] {
    let width = page.pixels.width() as usize;
    let pixels: Vec<[i32; 3]> = page
        .pixels
        .pixels()
        .iter()
        .map(|pixel| [pixel.red(), pixel.green(), pixel.blue()].map(i32::from))
        .collect();
    let bright =
        pixels.iter().map(|[r, g, b]| (16 + ((47 * r + 157 * g + 16 * b + 128) >> 8)) as u8).collect();
    let four: Vec<[i32; 3]> = pixels
        .chunks_exact(2 * width)
        .flat_map(|rows| {
            let (above, below) = rows.split_at(width);
            let pairs = above.chunks_exact(2).zip(below.chunks_exact(2));
            pairs.map(|(above, below)| [0, 1, 2].map(|k| above.iter().chain(below).map(|rgb| rgb[k]).sum()))
        })
        .collect();
    let colour = |weights: [i32; 3]| -> Vec<u8> {
        let of = |rgb: &[i32; 3]| rgb.iter().zip(weights).map(|(part, weight)| part * weight).sum::<i32>();
        four.iter().map(|rgb| (128 + ((of(rgb) + 512) >> 10)) as u8).collect()
    };
    [(bright, width), (colour([-26, -86, 112]), width / 2), (colour([112, -102, -10]), width / 2)]
}

/// The unit of a packet that says what the stream is, where it has one: a head of a byte, its length in sevens of bits, its bytes.
fn sequence_header(packet: &[u8]) -> Option<&[u8]> {
    let mut rest = packet;
    loop {
        let (head, after) = rest.split_first()?;
        let ends = after.iter().position(|byte| byte & 0x80 == 0)?;
        let length = after
            .iter()
            .take(ends + 1)
            .rev()
            .try_fold(0_usize, |sum, byte| sum.checked_mul(128)?.checked_add(usize::from(byte & 0x7f)))?;
        let whole = length.checked_add(ends + 2)?;
        let unit = rest.get(..whole)?;
        if head >> 3 & 0xf == SEQUENCE_HEADER {
            return Some(unit);
        }
        rest = rest.get(whole..)?;
    }
}

fn wrong(cause: &impl ToString) -> CliError {
    CliError::Video { cause: cause.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_those_of_the_standard() {
        let mut page = Page::new(4, 2).unwrap();
        page.clear([0.0, 0.0], [4.0, 2.0]);
        let [(bright, wide), (blue, half), (red, _)] = planes(&page);
        assert_eq!(
            (wide, half, &bright[..], &blue[..], &red[..]),
            (4, 2, &[235; 8][..], &[128; 2][..], &[128; 2][..])
        );
        // BT.709's own numbers for full red: 63, 102, 240.
        page.pixels.fill(tiny_skia::Color::from_rgba8(255, 0, 0, 255));
        let [(bright, _), (blue, _), (red, _)] = planes(&page);
        assert_eq!((bright[0], blue[0], red[0]), (63, 102, 240));
    }

    #[test]
    fn the_unit_that_says_what_the_stream_is_is_found() {
        // A delimiter, a long unit of another kind, and the header.
        let mut packet = vec![0x12, 0, 0x32, 0x80, 0x01];
        packet.extend([7; 128]);
        packet.extend([0x0a, 3, 1, 2, 3, 0x32, 1, 9]);
        assert_eq!(sequence_header(&packet), Some(&[0x0a, 3, 1, 2, 3][..]));
        for short in 0..packet.len() - 4 {
            assert!(sequence_header(&packet[..short]).is_none(), "{short}");
        }
    }
}
