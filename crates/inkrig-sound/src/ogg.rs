//! Ogg pages, as far as it takes to check a file before the decoder sees it.

use crate::{SoundError, SoundFormat, vorbis_setup};

/// One page. The body is what is there of it, which at the end of a cut file is less than its lacing values say.
struct Page<'a> {
    last_of_stream: bool,
    serial: &'a [u8],
    lacing: &'a [u8],
    body: &'a [u8],
    complete: bool,
}

/// Refuses what is no Vorbis, and a Vorbis setup that would make the decoder allocate without bounds or fail.
pub(crate) fn check(bytes: &[u8]) -> Result<(), SoundError> {
    let first: Vec<u8> = pages(bytes).next().map(|page| page.body.to_vec()).unwrap_or_default();
    let other = match first.get(..8).unwrap_or_default() {
        b"OpusHead" => Some("Opus"),
        [0x7f, b'F', b'L', b'A', b'C', ..] => Some("FLAC inside Ogg"),
        b"Speex   " => Some("Speex"),
        _ => None,
    };
    if let Some(other) = other {
        return Err(SoundError::UnknownFormat { found: format!(" (it is an Ogg file with {other})") });
    }
    let damaged = |what: &str| SoundError::Damaged { format: SoundFormat::OggVorbis, what: what.into() };
    let header = |page: &Page<'_>| page.body.starts_with(b"\x01vorbis");
    let Some(serial) = pages(bytes).find(header).map(|page| page.serial) else {
        return Err(damaged("no Vorbis stream begins in it"));
    };
    let setup = packet(bytes, serial, 2).ok_or_else(|| damaged("it ends before its setup header does"))?;
    vorbis_setup::check(&setup).map_err(|what| damaged(&what))
}

/// Whether the last page is whole and closes its stream, as it does in a file that was not cut.
pub(crate) fn is_closed(bytes: &[u8]) -> bool {
    pages(bytes).last().is_some_and(|page| page.last_of_stream && page.complete)
}

/// The packet of a stream with this number, from 0.
fn packet(bytes: &[u8], serial: &[u8], number: usize) -> Option<Vec<u8>> {
    let (mut found, mut packet) = (0, Vec::new());
    for page in pages(bytes).filter(|page| page.serial == serial) {
        let mut body = page.body;
        for &length in page.lacing {
            let (part, rest) = body.split_at_checked(usize::from(length))?;
            body = rest;
            if found == number {
                packet.extend_from_slice(part);
            }
            // A lacing value below 255 ends a packet.
            if length < 255 {
                if found == number {
                    return Some(packet);
                }
                found += 1;
            }
        }
    }
    None
}

/// All pages, junk between them being stepped over.
fn pages(bytes: &[u8]) -> impl Iterator<Item = Page<'_>> {
    let mut rest = bytes;
    std::iter::from_fn(move || {
        let start = rest.windows(4).position(|four| four == b"OggS")?;
        let page = rest.get(start..)?;
        let count = usize::from(*page.get(26)?);
        let (flags, serial) = (*page.get(5)?, page.get(14..18)?);
        let lacing = page.get(27..27 + count)?;
        let length: usize = lacing.iter().map(|&length| usize::from(length)).sum();
        let body = page.get(27 + count..)?;
        let there = length.min(body.len());
        let (body, behind) = body.split_at_checked(there)?;
        rest = behind;
        Some(Page { last_of_stream: flags & 4 != 0, serial, lacing, body, complete: there == length })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page(flags: u8, serial: u8, lacing: &[u8], body: &[u8]) -> Vec<u8> {
        let mut page = b"OggS\0".to_vec();
        page.push(flags);
        page.extend([0; 8]);
        page.extend([serial, 0, 0, 0]);
        page.extend([0; 8]);
        page.push(lacing.len() as u8);
        page.extend_from_slice(lacing);
        page.extend_from_slice(body);
        page
    }

    #[test]
    fn packets_go_on_over_pages_of_their_own_stream() {
        let long = [7; 255];
        let bytes = [
            page(2, 1, &[1], b"a"),
            page(0, 1, &[255], &long),
            page(0, 9, &[2], b"zz"),
            page(4, 1, &[2, 1], b"bcd"),
        ]
        .concat();
        let second = [&long[..], b"bc"].concat();
        assert_eq!(packet(&bytes, &[1, 0, 0, 0], 1), Some(second));
        assert_eq!(packet(&bytes, &[1, 0, 0, 0], 2), Some(b"d".to_vec()));
        assert_eq!(packet(&bytes, &[1, 0, 0, 0], 3), None);
        assert!(is_closed(&bytes));
        assert!(!is_closed(&bytes[..bytes.len() - 1]));
        assert!(!is_closed(&bytes[..bytes.len() - 30]));
    }

    #[test]
    fn other_codecs_in_ogg_are_named() {
        let error = check(&page(2, 1, &[8], b"OpusHead")).unwrap_err().to_string();
        assert!(error.contains("Opus"), "{error}");
    }
}
