//! The codebooks of a Vorbis setup header, checked before a decoder builds them.
//!
//! A few bytes can describe a codebook for which the decoder allocates 400 MB, and a header may hold 256 of them; some
//! values make the decoder's arithmetic fail. Codebooks are walked as in section 3.2.1 of the Vorbis I specification.

use crate::bits::Bits;

/// The most values in all codebooks together, 4 bytes each. Encoders use up to 88 000.
const MAX_VALUES: u64 = 1 << 20;
/// The most entries in all codebooks together. Encoders use up to 20 000.
const MAX_ENTRIES: u64 = 1 << 16;
/// The most blocks of the decoder's lookup tables, up to 6.5 kB each while they are built. Encoders use up to 5 800.
const MAX_BLOCKS: u64 = 1 << 14;
/// The most dimensions that the decoder accepts.
const MAX_DIMENSIONS: u32 = 32;
/// The decoder looks code words up eight bits at a time.
const BLOCK_BITS: u32 = 8;

/// What a codebook costs.
#[derive(Default)]
struct Cost {
    entries: u64,
    values: u64,
    blocks: u64,
}

/// How many code words are longer than one, two and three blocks.
#[derive(Default)]
struct Lengths([u64; 3]);

/// Says what is wrong with a setup packet, if anything is.
pub(crate) fn check(packet: &[u8]) -> Result<(), String> {
    let Some(setup) = packet.strip_prefix(b"\x05vorbis") else {
        return Err("its third packet is no setup header".into());
    };
    let mut bits = Bits::new(setup);
    let ends = || "its setup header ends inside a codebook".to_owned();
    let books = bits.read(8).ok_or_else(ends)? + 1;
    let mut all = Cost::default();
    for book in 0..books {
        let cost =
            codebook(&mut bits).ok_or_else(ends)?.map_err(|what| format!("its codebook {book} {what}"))?;
        all.entries += cost.entries;
        all.values += cost.values;
        all.blocks += cost.blocks;
        if all.entries > MAX_ENTRIES || all.values > MAX_VALUES || all.blocks > MAX_BLOCKS {
            return Err("its codebooks are larger than any encoder makes them".into());
        }
    }
    Ok(())
}

/// Steps over one codebook. `None` when the packet ends.
fn codebook(bits: &mut Bits<'_>) -> Option<Result<Cost, &'static str>> {
    if bits.read(24)? != 0x56_4342 {
        return Some(Err("does not begin as one"));
    }
    let (dimensions, entries) = (bits.read(16)?, bits.read(24)?);
    let is_usual =
        (1..=MAX_DIMENSIONS).contains(&dimensions) && (1..=MAX_ENTRIES).contains(&u64::from(entries));
    if !is_usual {
        return Some(Err("has a size that no encoder uses"));
    }
    let mut lengths = Lengths::default();
    if bits.read(1)? == 1 {
        if let Err(what) = ordered_lengths(bits, entries, &mut lengths)? {
            return Some(Err(what));
        }
    } else {
        let is_sparse = bits.read(1)? == 1;
        for _ in 0..entries {
            if !is_sparse || bits.read(1)? == 1 {
                lengths.add(bits.read(5)? + 1, 1);
            }
        }
    }
    let cost = Cost {
        entries: entries.into(),
        values: u64::from(entries) * u64::from(dimensions),
        blocks: lengths.blocks(),
    };
    let lookup = bits.read(4)?;
    if lookup == 0 {
        return Some(Ok(cost));
    }
    bits.skip(64)?;
    let width = bits.read(4)? + 1;
    bits.skip(1)?;
    let values = match lookup {
        1 => lookup1_values(entries, dimensions),
        2 => Some(entries * dimensions),
        _ => return Some(Err("has an unknown kind of lookup")),
    };
    let Some(values) = values else { return Some(Err("has a lookup that no encoder uses")) };
    bits.skip(u64::from(values) * u64::from(width))?;
    Some(Ok(cost))
}

/// Steps over code lengths that are given as counts for each length.
fn ordered_lengths(
    bits: &mut Bits<'_>,
    entries: u32,
    lengths: &mut Lengths,
) -> Option<Result<(), &'static str>> {
    let mut length = bits.read(5)? + 1;
    let mut done = 0;
    while done < entries {
        if length > 32 {
            return Some(Err("has code words longer than 32 bits"));
        }
        let count = bits.read(32 - (entries - done).leading_zeros())?;
        lengths.add(length, count.into());
        done += count;
        length += 1;
    }
    Some(if done == entries { Ok(()) } else { Err("has more code words than entries") })
}

impl Lengths {
    fn add(&mut self, length: u32, count: u64) {
        for (longer, blocks) in self.0.iter_mut().zip(1..) {
            *longer += if length > BLOCK_BITS * blocks { count } else { 0 };
        }
    }

    /// An upper bound of the blocks in the decoder's table: one for each beginning of one, two or three blocks that
    /// longer words have.
    fn blocks(&self) -> u64 {
        let most: [u64; 3] = [1 << BLOCK_BITS, 1 << (2 * BLOCK_BITS), 1 << (3 * BLOCK_BITS)];
        1 + self.0.iter().zip(most).map(|(longer, most)| most.min(*longer)).sum::<u64>()
    }
}

/// The largest number whose power of `dimensions` is at most `entries`, where the decoder's own single precision finds
/// the same; elsewhere it would stop with a failed assertion.
fn lookup1_values(entries: u32, dimensions: u32) -> Option<u32> {
    let value = (entries as f32).powf(1.0 / dimensions as f32).floor() as u32;
    let fits = value.checked_pow(dimensions)? <= entries;
    let next = (value + 1).checked_pow(dimensions)?;
    (fits && next > entries).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes numbers of given widths, least significant bit first, behind the packet's signature.
    fn packet(fields: &[(u32, u32)]) -> Vec<u8> {
        let mut bits = Vec::new();
        for &(value, width) in fields {
            bits.extend((0..width).map(|place| value >> place & 1));
        }
        let byte =
            |eight: &[u32]| eight.iter().enumerate().map(|(place, bit)| (bit << place) as u8).sum::<u8>();
        let mut packet = b"\x05vorbis".to_vec();
        packet.extend(bits.chunks(8).map(byte));
        packet
    }

    /// A codebook whose words all have so many bits, with a lookup of one value.
    fn book(dimensions: u32, length: u32) -> Vec<(u32, u32)> {
        let entries = 1 << length;
        let mut fields = vec![(0x56_4342, 24), (dimensions, 16), (entries, 24), (1, 1), (length - 1, 5)];
        fields.extend([(entries, length + 1), (1, 4), (0, 32), (0, 32), (0, 4), (0, 1), (1, 1)]);
        fields
    }

    fn header(book: &[(u32, u32)], count: u32) -> Vec<u8> {
        let books = (0..count).flat_map(|_| book.iter().copied());
        packet(&[(count - 1, 8)].into_iter().chain(books).collect::<Vec<_>>())
    }

    #[test]
    fn codebooks_may_not_grow_without_bounds() {
        assert_eq!(check(&header(&book(16, 12), 1)), Ok(()));
        // Each goes over another bound: values, entries, blocks.
        for (book, count) in [(book(30, 11), 18), (book(13, 12), 17), (book(12, 9), 64)] {
            assert_eq!(check(&header(&book, count - 1)), Ok(()), "{count}");
            assert!(check(&header(&book, count)).unwrap_err().contains("larger"), "{count}");
        }
        assert!(check(&header(&book(30, 17), 1)).unwrap_err().contains("size"));
    }

    #[test]
    fn long_code_words_are_counted_by_their_blocks() {
        let mut lengths = Lengths::default();
        lengths.add(8, 100);
        assert_eq!(lengths.blocks(), 1);
        lengths.add(17, 300);
        lengths.add(25, 5);
        // The root, 256 at most behind it, then 305 and 5.
        assert_eq!(lengths.blocks(), 1 + 256 + 305 + 5);
    }

    #[test]
    fn code_words_longer_than_32_bits_are_refused() {
        let fields =
            [(0, 8), (0x56_4342, 24), (1, 16), (4, 24), (1, 1), (31, 5), (0, 3), (0, 3), (4, 3), (0, 4)];
        assert!(check(&packet(&fields)).unwrap_err().contains("32 bits"));
    }

    #[test]
    fn a_lookup_that_overflows_is_refused() {
        assert_eq!(lookup1_values(6561, 8), Some(3));
        assert_eq!(lookup1_values(2, 32), None);
    }

    #[test]
    fn short_headers_are_refused() {
        let whole = header(&book(16, 12), 1);
        for length in 0..whole.len() - 1 {
            assert!(check(&whole[..length]).is_err(), "{length} bytes");
        }
    }
}
