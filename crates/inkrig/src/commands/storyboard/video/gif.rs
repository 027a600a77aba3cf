//! Moving pictures as GIF: one palette for all, and of each picture only the part that has changed.

use super::{Pictures, RATE, SIZE};
use crate::console::Console;
use crate::error::CliError;
use gif::{DisposalMethod, Encoder, Frame, Repeat};

/// How long a picture is seen: hundredths of a second are what a GIF counts.
const HUNDREDTHS: u16 = (100 / RATE) as u16;
/// Colours are told apart by so many bits of each of red, green and blue.
const BITS: usize = 5;
const COLOURS: usize = 1 << (3 * BITS);
/// Colours of a picture that may be used.
const PALETTE: usize = 256;
/// The palette is made of every so many pictures.
const LOOKED_AT: usize = 10;

/// All pictures as one file.
///
/// # Errors
/// When it was stopped, or a picture cannot be made.
pub(super) fn write(pictures: &Pictures<'_>, console: &Console) -> Result<Vec<u8>, CliError> {
    let mut seen = vec![0_u32; COLOURS];
    for number in (0..pictures.count).step_by(LOOKED_AT) {
        few(pictures, number)?.iter().for_each(|colour| seen[usize::from(*colour)] += 1);
    }
    let (palette, nearest) = palette(&seen);
    let [width, height] = SIZE.map(|side| side as u16);
    let mut bytes = Vec::new();
    let wrong = |cause: gif::EncodingError| CliError::Video { cause: cause.to_string() };
    {
        let mut encoder = Encoder::new(&mut bytes, width, height, &palette).map_err(wrong)?;
        encoder.set_repeat(Repeat::Infinite).map_err(wrong)?;
        let bar = console.bar("drawing the moving picture");
        let mut before: Option<Vec<u8>> = None;
        for number in 0..pictures.count {
            if bar.at(number, pictures.count).is_break() {
                break;
            }
            let now: Vec<u8> =
                few(pictures, number)?.iter().map(|colour| nearest[usize::from(*colour)]).collect();
            encoder.write_frame(&changed(before.as_deref(), &now, width, height)).map_err(wrong)?;
            before = Some(now);
        }
        bar.finish()?;
    }
    Ok(bytes)
}

/// A picture in few bits a pixel.
fn few(pictures: &Pictures<'_>, number: usize) -> Result<Vec<u16>, CliError> {
    let few = |part: u8| u16::from(part >> (8 - BITS));
    let page = pictures.draw(number)?;
    let pixels = page.pixels.pixels().iter();
    Ok(pixels
        .map(|pixel| few(pixel.red()) << (2 * BITS) | few(pixel.green()) << BITS | few(pixel.blue()))
        .collect())
}

/// The colours that are most there, and for each colour the nearest of them.
fn palette(seen: &[u32]) -> (Vec<u8>, Vec<u8>) {
    let parts = |colour: usize| [2, 1, 0].map(|place| (colour >> (place * BITS)) & ((1 << BITS) - 1));
    let mut common: Vec<usize> = (0..seen.len()).filter(|colour| seen[*colour] > 0).collect();
    common.sort_by_key(|colour| (std::cmp::Reverse(seen[*colour]), *colour));
    common.truncate(PALETTE);
    let full = |part: usize| (part * 255 / ((1 << BITS) - 1)) as u8;
    let palette = common.iter().flat_map(|colour| parts(*colour).map(full)).collect();
    let nearest = (0..seen.len()).map(|colour| {
        let own = parts(colour);
        let away = |other: &usize| -> usize {
            parts(*other).iter().zip(own).map(|(a, b)| a.abs_diff(b).pow(2)).sum()
        };
        let best = common.iter().enumerate().min_by_key(|(_, other)| away(other));
        best.map_or(0, |(place, _)| place as u8)
    });
    (palette, nearest.collect())
}

/// The part of a picture in which it differs from the one before.
fn changed(before: Option<&[u8]>, now: &[u8], width: u16, height: u16) -> Frame<'static> {
    let wide = usize::from(width);
    let differs = |at: usize| before.is_none_or(|before| before.get(at) != now.get(at));
    let (mut left, mut right, mut top, mut bottom) = (wide, 0, usize::from(height), 0);
    for at in (0..now.len()).filter(|at| differs(*at)) {
        let (x, y) = (at % wide, at / wide);
        (left, right, top, bottom) = (left.min(x), right.max(x + 1), top.min(y), bottom.max(y + 1));
    }
    if left >= right {
        // Nothing has changed: a frame has at least a pixel.
        (left, right, top, bottom) = (0, 1, 0, 1);
    }
    let rows = (top..bottom).flat_map(|y| now[y * wide + left..y * wide + right].iter().copied());
    Frame {
        delay: HUNDREDTHS,
        dispose: DisposalMethod::Keep,
        left: left as u16,
        top: top as u16,
        width: (right - left) as u16,
        height: (bottom - top) as u16,
        buffer: rows.collect::<Vec<u8>>().into(),
        ..Frame::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_has_changed_is_written() {
        let mut now = vec![0; 12];
        let before = now.clone();
        now[6] = 3;
        let frame = changed(Some(&before), &now, 4, 3);
        assert_eq!(
            (frame.left, frame.top, frame.width, frame.height, &frame.buffer[..]),
            (2, 1, 1, 1, &[3][..])
        );
        assert_eq!(changed(None, &now, 4, 3).buffer.len(), 12);
        assert_eq!(changed(Some(&now), &now, 4, 3).buffer.len(), 1);
    }

    #[test]
    fn colours_that_are_not_in_the_palette_become_the_nearest() {
        let mut seen = vec![0; COLOURS];
        (seen[0], seen[COLOURS - 1]) = (5, 9);
        let (palette, nearest) = palette(&seen);
        assert_eq!(palette, [255, 255, 255, 0, 0, 0]);
        assert_eq!((nearest[1], nearest[COLOURS - 2]), (1, 0));
    }
}
