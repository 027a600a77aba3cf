//! NumPy's archives of tables (`numpy.savez`, `numpy.savez_compressed`).

use super::CheckpointError;
use super::bytes::Bytes;
use super::error::shown;
use super::npy::{read_number, read_table};
use super::zip::{self, Entry};
use flate2::read::DeflateDecoder;
use std::collections::BTreeMap;
use std::io::{Read, Seek};

/// Bytes of a single number with its header.
const MOST_NUMBER: usize = 1 << 12;

/// An archive, of which a table is read when it is asked for. Nothing in it is run: tables of objects are refused.
#[derive(Debug)]
pub struct Npz<R> {
    file: Bytes<R>,
    entries: BTreeMap<String, Entry>,
}

impl<R: Read + Seek> Npz<R> {
    /// Reads the list of tables.
    ///
    /// # Errors
    /// When it is no zip archive, or a damaged or encrypted one.
    pub fn open(inner: R) -> Result<Self, CheckpointError> {
        let mut file = Bytes::new(inner)?;
        let entries = zip::entries(&mut file, zip::Purpose::Tables)?;
        Ok(Self { file, entries })
    }

    /// The names of its tables.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.entries.keys().filter_map(|name| name.strip_suffix(".npy"))
    }

    /// A table: its shape, and its numbers row by row.
    ///
    /// # Errors
    /// When there is none of this name, it has more than `most` bytes, or is none that [`read_table`] reads.
    pub fn table(&mut self, name: &str, most: usize) -> Result<(Vec<usize>, Vec<f32>), CheckpointError> {
        read_table(&self.bytes(name, most)?, name)
    }

    /// A table of a single number, floating point or whole.
    ///
    /// # Errors
    /// When there is none of this name, or it is no single number.
    pub fn number(&mut self, name: &str) -> Result<f32, CheckpointError> {
        read_number(&self.bytes(name, MOST_NUMBER)?, name)
    }

    fn bytes(&mut self, name: &str, most: usize) -> Result<Vec<u8>, CheckpointError> {
        let missing = || CheckpointError::Npy { name: shown(name), what: "is not in the archive".into() };
        let entry = *self.entries.get(&format!("{name}.npy")).ok_or_else(missing)?;
        if entry.length.max(entry.packed) > most as u64 {
            let what = format!("bytes in the table {}", shown(name));
            return Err(CheckpointError::TooMuch {
                what,
                got: entry.length.max(entry.packed),
                most: most as u64,
            });
        }
        let mut bytes = self.file.part(entry.start, entry.packed, name)?;
        if entry.deflated {
            let mut out = Vec::new();
            // One byte more than it should have shows that it has more.
            DeflateDecoder::new(&bytes[..]).take(entry.length + 1).read_to_end(&mut out).map_err(|_| {
                CheckpointError::damaged(format!("the table {} cannot be unpacked", shown(name)))
            })?;
            bytes = out;
        }
        if bytes.len() as u64 != entry.length || zip::checksum(0, &bytes) != entry.checksum {
            let what = format!("the table {} is not what the archive says of it", shown(name));
            return Err(CheckpointError::damaged(what));
        }
        Ok(bytes)
    }
}
