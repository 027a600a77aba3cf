//! Zip archives as `torch.save` and NumPy write them: entries lie side by side; those of weights are not compressed.
//!
//! A list of what is where is made first, from the directory at the end, and checked: all entries lie within the file, none
//! over another, no name twice. Nothing of weights can grow while it is read, as nothing is packed.

use super::CheckpointError;
use super::bytes::{Bytes, Cursor};
use super::error::shown;
use std::collections::BTreeMap;
use std::io::{Read, Seek};

/// Entries of an archive. A model with its optimiser's state has some thousand.
const MOST_ENTRIES: u64 = 100_000;
/// Bytes of the directory.
const MOST_DIRECTORY: u64 = 32 << 20;

const END: u32 = 0x0605_4b50;
const END_LENGTH: u64 = 22;
const END_64: u32 = 0x0606_4b50;
const END_64_LENGTH: u64 = 56;
const LOCATOR: u32 = 0x0706_4b50;
const LOCATOR_LENGTH: u64 = 20;
const DIRECTORY_ENTRY: u32 = 0x0201_4b50;
const LOCAL_HEADER: u32 = 0x0403_4b50;
const LOCAL_LENGTH: u64 = 30;

/// Where an entry's bytes are.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub(super) start: u64,
    /// Bytes as they are meant.
    pub(super) length: u64,
    /// Bytes as they lie there: fewer where they are [`deflated`](Self::deflated).
    pub(super) packed: u64,
    pub(super) deflated: bool,
    pub(super) checksum: u32,
}

/// What an archive is for, and so what may be in it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Weights, which nobody compresses.
    Weights,
    /// Tables of NumPy, compressed or not.
    Tables,
}

/// Where the directory is.
struct Directory {
    start: u64,
    length: u64,
    entries: u64,
}

/// Finds all entries by name.
pub(super) fn entries<R: Read + Seek>(
    file: &mut Bytes<R>,
    purpose: Purpose,
) -> Result<BTreeMap<String, Entry>, CheckpointError> {
    let directory = directory(file)?;
    let too_much = |what: &str, got, most| Err(CheckpointError::TooMuch { what: what.into(), got, most });
    if directory.entries > MOST_ENTRIES {
        return too_much("entries in the zip archive", directory.entries, MOST_ENTRIES);
    }
    if directory.length > MOST_DIRECTORY {
        return too_much("bytes in the zip directory", directory.length, MOST_DIRECTORY);
    }
    let bytes = file.part(directory.start, directory.length, "the zip directory")?;
    let mut cursor = Cursor::new(&bytes);
    let mut found = BTreeMap::new();
    let mut places = Vec::new();
    for _ in 0..directory.entries {
        let short = || CheckpointError::damaged("the zip directory ends within an entry");
        let listed = listed(&mut cursor, purpose).ok_or_else(short)??;
        let entry = locate(file, &listed, directory.start)?;
        places.push((listed.header, entry.start + entry.packed, listed.name.clone()));
        if found.insert(listed.name.clone(), entry).is_some() {
            return Err(CheckpointError::Twice { what: "the zip entry", name: shown(&listed.name) });
        }
    }
    places.sort_unstable();
    for pair in places.windows(2) {
        if let [(_, end, first), (start, _, second)] = pair
            && end > start
        {
            let (first, second) = (shown(first), shown(second));
            return Err(CheckpointError::damaged(format!("the zip entries {first} and {second} overlap")));
        }
    }
    Ok(found)
}

/// Looks for the end of the directory, which a comment may follow.
fn directory<R: Read + Seek>(file: &mut Bytes<R>) -> Result<Directory, CheckpointError> {
    let no_end = || CheckpointError::damaged("the zip archive has no directory at its end");
    let tail = file.length().min(END_LENGTH + u64::from(u16::MAX));
    let start = file.length() - tail;
    let bytes = file.part(start, tail, "the end of the zip archive")?;
    let at = bytes
        .windows(END_LENGTH as usize)
        .rposition(|window| window.starts_with(&END.to_le_bytes()))
        .ok_or_else(no_end)?;
    let mut cursor = Cursor::new(bytes.get(at + 4..).unwrap_or_default());
    let mut fields = || {
        cursor.take(6)?; // numbers of disks
        let entries = cursor.u16()?;
        let length = cursor.u32()?;
        Some((entries, length, cursor.u32()?))
    };
    let (entries, length, offset) = fields().ok_or_else(no_end)?;
    let end = start + at as u64;
    if entries < u16::MAX && length < u32::MAX && offset < u32::MAX {
        return Ok(Directory { start: offset.into(), length: length.into(), entries: entries.into() });
    }
    let locator = end.checked_sub(LOCATOR_LENGTH).ok_or_else(no_end)?;
    let bytes = file.part(locator, LOCATOR_LENGTH, "the end of the zip archive")?;
    let mut cursor = Cursor::new(&bytes);
    let mut fields = || (cursor.u32()? == LOCATOR).then(|| cursor.take(4).and_then(|_| cursor.u64()))?;
    let place = fields().ok_or_else(no_end)?;
    let bytes = file.part(place, END_64_LENGTH, "the end of the zip archive")?;
    let mut cursor = Cursor::new(&bytes);
    let mut fields = || {
        (cursor.u32()? == END_64).then_some(())?;
        cursor.take(28)?; // sizes, versions, numbers of disks, entries on this disk
        Some(Directory { entries: cursor.u64()?, length: cursor.u64()?, start: cursor.u64()? })
    };
    fields().ok_or_else(no_end)
}

/// What the directory says of an entry.
struct Listed {
    name: String,
    length: u64,
    packed: u64,
    deflated: bool,
    checksum: u32,
    header: u64,
}

/// The next entry of the directory; `None` where it ends early.
fn listed(cursor: &mut Cursor<'_>, purpose: Purpose) -> Option<Result<Listed, CheckpointError>> {
    if cursor.u32()? != DIRECTORY_ENTRY {
        return Some(Err(CheckpointError::damaged("the zip directory holds something that is no entry")));
    }
    cursor.take(4)?; // versions
    let flags = cursor.u16()?;
    let method = cursor.u16()?;
    cursor.take(4)?; // time
    let checksum = cursor.u32()?;
    let mut packed = u64::from(cursor.u32()?);
    let mut length = u64::from(cursor.u32()?);
    let (name, extra, comment) = (cursor.u16()?, cursor.u16()?, cursor.u16()?);
    cursor.take(8)?; // disk, attributes
    let mut header = u64::from(cursor.u32()?);
    let name = String::from_utf8_lossy(cursor.take(name.into())?).into_owned();
    let mut extra = Cursor::new(cursor.take(extra.into())?);
    cursor.take(comment.into())?;
    while let (Some(kind), Some(size)) = (extra.u16(), extra.u16()) {
        let mut field = Cursor::new(extra.take(size.into())?);
        if kind == 1 {
            // Only fields that did not fit are here, in this order.
            for value in [&mut length, &mut packed, &mut header] {
                if *value == u64::from(u32::MAX) {
                    *value = field.u64()?;
                }
            }
        }
    }
    let deflated = method == 8 && purpose == Purpose::Tables;
    if flags & 1 != 0 || (!deflated && (method != 0 || packed != length)) {
        let how = if flags & 1 != 0 { "encrypted" } else { "compressed" };
        return Some(Err(CheckpointError::Unsupported {
            what: format!("the zip entry {} is {how}", shown(&name)),
            todo: match purpose {
                Purpose::Weights => {
                    "weights are stored as they are; unpack them with PyTorch and save them again"
                }
                Purpose::Tables => "save the tables once more with numpy.savez",
            },
        }));
    }
    Some(Ok(Listed { name, length, packed, deflated, checksum, header }))
}

/// Reads the header before an entry's bytes, whose length only it knows.
fn locate<R: Read + Seek>(file: &mut Bytes<R>, listed: &Listed, most: u64) -> Result<Entry, CheckpointError> {
    let name = || shown(&listed.name);
    let bytes = file.part(listed.header, LOCAL_LENGTH, &format!("the zip entry {}", name()))?;
    let mut cursor = Cursor::new(&bytes);
    let mut fields = || {
        (cursor.u32()? == LOCAL_HEADER).then_some(())?;
        cursor.take(22)?;
        Some(u64::from(cursor.u16()?) + u64::from(cursor.u16()?))
    };
    let no_header =
        || CheckpointError::damaged(format!("the zip entry {} is not where it should be", name()));
    let start = listed.header + LOCAL_LENGTH + fields().ok_or_else(no_header)?;
    if start.checked_add(listed.packed).is_none_or(|end| end > most) {
        let what = format!("the zip entry {} reaches beyond the end of the data", name());
        return Err(CheckpointError::damaged(what));
    }
    let Listed { length, packed, deflated, checksum, .. } = *listed;
    Ok(Entry { start, length, packed, deflated, checksum })
}

/// The checksum of zip archives (CRC-32), piece by piece: 0 before the first.
pub(super) fn checksum(mut so_far: u32, bytes: &[u8]) -> u32 {
    so_far = !so_far;
    for &byte in bytes {
        so_far = TABLE[usize::from((so_far as u8) ^ byte)] ^ (so_far >> 8);
    }
    !so_far
}

const TABLE: [u32; 256] = {
    let mut table = [0; 256];
    let mut at = 0;
    while at < table.len() {
        let mut value = at as u32;
        let mut bit = 0;
        while bit < 8 {
            value = if value & 1 == 1 { 0xedb8_8320 ^ (value >> 1) } else { value >> 1 };
            bit += 1;
        }
        table[at] = value;
        at += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checksums_are_those_of_zip() {
        assert_eq!(checksum(0, b"123456789"), 0xcbf4_3926);
        assert_eq!(checksum(checksum(0, b"1234"), b"56789"), 0xcbf4_3926);
    }
}
