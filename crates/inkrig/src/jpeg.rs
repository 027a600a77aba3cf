//! JPEG pictures, as cameras and scanners make them.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// The orientation tag of Exif.
const ORIENTATION: u16 = 0x0112;
/// A picture that is sent in more passes than this was made to be slow.
const MOST_SCANS: usize = 64;

/// Pixels, red, green and blue, rows from the top as the camera was held.
pub(crate) struct Picture {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) pixels: Vec<u8>,
}

/// Reads a picture of at most so many pixels; the size is looked at before room is made.
///
/// # Errors
/// What is wrong, in words.
pub(crate) fn decode(bytes: &[u8], most: usize) -> Result<Picture, String> {
    let wrong = |cause: &dyn std::fmt::Display| format!("is no JPEG that can be read ({cause})");
    let options = DecoderOptions::default()
        .jpeg_set_out_colorspace(ColorSpace::RGB)
        .jpeg_set_max_scans(MOST_SCANS)
        .set_max_width(1 << 16)
        .set_max_height(1 << 16);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|cause| wrong(&cause))?;
    let (width, height) = decoder.dimensions().ok_or_else(|| wrong(&"it has no size"))?;
    if width.saturating_mul(height) > most {
        return Err(format!("has more than {most} pixels; save it smaller"));
    }
    // A picture of one colour has some hundred pixels a byte: what says it has far more is cut short, and gets no room.
    if width.saturating_mul(height) > bytes.len().saturating_mul(1024).saturating_add(1 << 20) {
        return Err(wrong(&"it is cut short"));
    }
    let turned = decoder.exif().map_or(1, |exif| orientation(exif));
    let pixels = decoder.decode().map_err(|cause| wrong(&cause))?;
    if width * height * 3 != pixels.len() || pixels.is_empty() {
        return Err(wrong(&"its colours are of a kind that is not known"));
    }
    Ok(upright(Picture { width, height, pixels }, turned))
}

/// How the camera was held, 1 to 8; 1 where nothing is said.
fn orientation(exif: &[u8]) -> u16 {
    let exif = exif.strip_prefix(b"Exif\0\0").unwrap_or(exif);
    let little = exif.starts_with(b"II");
    let short = |at: usize| -> Option<u16> {
        let two = exif.get(at..at.checked_add(2)?)?.first_chunk::<2>().copied()?;
        Some(if little { u16::from_le_bytes(two) } else { u16::from_be_bytes(two) })
    };
    let long = |at: usize| -> Option<usize> {
        let four = exif.get(at..at.checked_add(4)?)?.first_chunk::<4>().copied()?;
        Some(if little { u32::from_le_bytes(four) } else { u32::from_be_bytes(four) } as usize)
    };
    let found = || {
        let table = long(4)?;
        (0..usize::from(short(table)?)).find_map(|entry| {
            let at = table.checked_add(2 + 12 * entry)?;
            (short(at)? == ORIENTATION).then(|| short(at + 8))?
        })
    };
    found().filter(|turned| (1..=8).contains(turned)).unwrap_or(1)
}

/// The picture as it was seen.
fn upright(picture: Picture, turned: u16) -> Picture {
    if turned == 1 {
        return picture;
    }
    let Picture { width, height, pixels } = picture;
    let on_its_side = turned >= 5;
    let (wide, high) = if on_its_side { (height, width) } else { (width, height) };
    let mut out = Vec::with_capacity(pixels.len());
    for y in 0..high {
        for x in 0..wide {
            let (column, row) = match turned {
                2 => (width - 1 - x, y),
                3 => (width - 1 - x, height - 1 - y),
                4 => (x, height - 1 - y),
                5 => (y, x),
                6 => (y, height - 1 - x),
                7 => (width - 1 - y, height - 1 - x),
                _ => (width - 1 - y, x),
            };
            let at = 3 * (row * width + column);
            out.extend_from_slice(pixels.get(at..at + 3).unwrap_or(&[255; 3]));
        }
    }
    Picture { width: wide, height: high, pixels: out }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::ExtendedColorType;
    use image::codecs::jpeg::JpegEncoder;
    use inkrig_sketch::storyboard::{Storyboard, read_storyboard};
    use inkrig_storyboard::storyboard_of_picture;

    fn encoded(pixels: &[u8], width: usize, height: usize, quality: u8) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = JpegEncoder::new_with_quality(&mut bytes, quality);
        encoder.encode(pixels, width as u32, height as u32, ExtendedColorType::Rgb8).unwrap();
        bytes
    }

    /// One colour for each four pixels, which keep their brightness, as cameras save.
    fn coarse_colours(pixels: &[u8], width: usize, height: usize) -> Vec<u8> {
        let at = |x: usize, y: usize| 3 * (y.min(height - 1) * width + x.min(width - 1));
        let bright = |start: usize| {
            [0.299, 0.587, 0.114]
                .iter()
                .zip(&pixels[start..start + 3])
                .map(|(share, part)| share * f32::from(*part))
                .sum::<f32>()
        };
        let mut out = pixels.to_vec();
        for y in 0..height {
            for x in 0..width {
                let (left, top) = (x / 2 * 2, y / 2 * 2);
                let four = [at(left, top), at(left + 1, top), at(left, top + 1), at(left + 1, top + 1)];
                for part in 0..3 {
                    let beside = four
                        .iter()
                        .map(|start| f32::from(pixels[start + part]) - bright(*start))
                        .sum::<f32>()
                        / 4.0;
                    out[at(x, y) + part] = (bright(at(x, y)) + beside).clamp(0.0, 255.0) as u8;
                }
            }
        }
        out
    }

    fn board(width: usize, height: usize, pixels: &[u8]) -> Storyboard {
        storyboard_of_picture(&inkrig_storyboard::Picture { width, height, pixels }).unwrap()
    }

    /// JPEG keeps colours of four pixels together and adds waves beside lines: neither may become strokes.
    #[test]
    fn a_page_reads_the_same_as_jpeg() {
        for sample in inkrig_samples::storyboards() {
            let page = inkrig_samples::make::storyboards::Page::of(&read_storyboard(sample.bytes).unwrap());
            let pixels = page.colours();
            let plain = board(page.width, page.height, &pixels);
            let coarse = coarse_colours(&pixels, page.width, page.height);
            for quality in [85, 60] {
                let read = decode(&encoded(&coarse, page.width, page.height, quality), 1 << 26).unwrap();
                assert_eq!((read.width, read.height), (page.width, page.height));
                let lossy = board(read.width, read.height, &read.pixels);
                assert_eq!(plain.frames.len(), lossy.frames.len(), "{} {quality}", sample.name);
                for (own, other) in plain.frames.iter().zip(&lossy.frames) {
                    // The kick's way goes back over its own line beside dashes: coarse colours cut it where they meet.
                    let cut = usize::from(sample.name == "kick");
                    let ways = own.trajectories.len();
                    let said = format!("{} {quality}", sample.name);
                    assert!((ways..=ways + cut).contains(&other.trajectories.len()), "{said}");
                    assert_eq!(own.scene.is_empty(), other.scene.is_empty(), "{said}");
                    let length = |strokes: &[inkrig_sketch::storyboard::Stroke]| -> f64 {
                        let lines = strokes.iter().flat_map(|stroke| stroke.points.windows(2));
                        lines.map(|pair| (pair[0][0] - pair[1][0]).hypot(pair[0][1] - pair[1][1])).sum()
                    };
                    let (one, two) = (length(&own.body), length(&other.body));
                    assert!(
                        (one - two).abs() < 0.1 * one + 12.0,
                        "{} {quality}: body {one:.0} {two:.0}",
                        sample.name
                    );
                    let way = |frame: &inkrig_sketch::storyboard::Frame| {
                        frame
                            .trajectories
                            .iter()
                            .map(|way| length(std::slice::from_ref(&way.points)))
                            .sum::<f64>()
                    };
                    let (one, two) = (way(own), way(other));
                    assert!(
                        other.trajectories.len() > ways || (one - two).abs() < 0.15 * one + 8.0,
                        "{} {quality}: ways {one:.0} {two:.0}",
                        sample.name
                    );
                }
            }
        }
    }

    #[test]
    fn pictures_come_as_the_camera_was_held() {
        // Two rows of three: the red and the blue channel say where a pixel was.
        let pixels: Vec<u8> = (0..2_u8).flat_map(|y| (0..3_u8).flat_map(move |x| [x, 9, y])).collect();
        let at = |turned: u16, x: usize, y: usize| {
            let own = upright(Picture { width: 3, height: 2, pixels: pixels.clone() }, turned);
            let start = 3 * (y * own.width + x);
            (own.width, own.height, own.pixels[start], own.pixels[start + 2])
        };
        assert_eq!(at(1, 2, 1), (3, 2, 2, 1));
        assert_eq!(at(3, 0, 0), (3, 2, 2, 1));
        // Held with its right side down: the upper left corner was the lower left one.
        assert_eq!(at(6, 0, 0), (2, 3, 0, 1));
        assert_eq!(at(8, 0, 0), (2, 3, 2, 0));
        let tag = [&b"MM\0\x2a\0\0\0\x08\0\x01\x01\x12\0\x03\0\0\0\x01\0\x06\0\0\0\0\0\0"[..]].concat();
        assert_eq!(orientation(&tag), 6);
        assert_eq!(orientation(&tag[..19]), 1);
        assert_eq!(orientation(b"II*\0\xff\xff\xff\xff"), 1);
    }

    #[test]
    fn broken_and_huge_pictures_are_said_and_take_no_room() {
        let pixels: Vec<u8> = (0..3 * 64 * 48).map(|at| (at * 7 % 251) as u8).collect();
        let good = encoded(&pixels, 64, 48, 85);
        assert!(decode(&good, 64 * 48).is_ok());
        let said = decode(&good, 64 * 48 - 1).err().unwrap();
        assert!(said.contains("more than 3071 pixels"), "{said}");
        for end in (0..good.len()).step_by(7) {
            let _ = decode(&good[..end], 1 << 20);
        }
        let mut state = 1_u64;
        for _ in 0..2000 {
            let mut bytes = good.clone();
            for _ in 0..3 {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                let at = (state >> 33) as usize % bytes.len();
                bytes[at] = (state >> 20) as u8;
            }
            if let Ok(picture) = decode(&bytes, 1 << 20) {
                assert_eq!(picture.pixels.len(), 3 * picture.width * picture.height);
            }
        }
        assert!(decode(b"", 1 << 20).is_err() && decode(b"\xff\xd8\xff", 1 << 20).is_err());
    }
}
