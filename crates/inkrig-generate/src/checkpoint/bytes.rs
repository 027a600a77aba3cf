//! Parts of a file, read only after it is known that they are there.

use super::CheckpointError;
use std::io::{Read, Seek, SeekFrom};

/// Bytes that are held at once while numbers are read.
const PIECE: usize = 1 << 20;

/// A file and its length.
#[derive(Debug)]
pub(super) struct Bytes<R> {
    inner: R,
    length: u64,
}

impl<R: Read + Seek> Bytes<R> {
    pub(super) fn new(mut inner: R) -> Result<Self, CheckpointError> {
        let length = inner.seek(SeekFrom::End(0))?;
        Ok(Self { inner, length })
    }

    pub(super) fn length(&self) -> u64 {
        self.length
    }

    /// All bytes of a part. `what` names it when the file has no such part.
    pub(super) fn part(&mut self, start: u64, length: u64, what: &str) -> Result<Vec<u8>, CheckpointError> {
        let mut bytes = Vec::new();
        self.pieces(start, length, what, |piece| bytes.extend_from_slice(piece))?;
        Ok(bytes)
    }

    /// A part, a piece at a time; every piece but the last has [`PIECE`] bytes, a multiple of any number's size.
    pub(super) fn pieces(
        &mut self,
        start: u64,
        length: u64,
        what: &str,
        mut each: impl FnMut(&[u8]),
    ) -> Result<(), CheckpointError> {
        let ends_early = || CheckpointError::damaged(format!("{what} reaches beyond the end of the file"));
        if start.checked_add(length).is_none_or(|end| end > self.length) {
            return Err(ends_early());
        }
        self.inner.seek(SeekFrom::Start(start))?;
        let mut left = length;
        let mut buffer = vec![0; PIECE.min(usize::try_from(length).unwrap_or(PIECE))];
        while left > 0 {
            let size = usize::try_from(left).unwrap_or(PIECE).min(buffer.len());
            let piece = buffer.get_mut(..size).ok_or_else(ends_early)?;
            self.inner.read_exact(piece)?;
            each(piece);
            left -= size as u64;
        }
        Ok(())
    }
}

/// Numbers in order out of bytes; every one of them may be the last.
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    pub(super) fn at(&self) -> usize {
        self.at
    }

    pub(super) fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let end = self.at.checked_add(length)?;
        let part = self.bytes.get(self.at..end)?;
        self.at = end;
        Some(part)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.array::<1>().map(|[byte]| byte)
    }

    pub(super) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(super) fn i32(&mut self) -> Option<i32> {
        self.array().map(i32::from_le_bytes)
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// Up to the next line feed, which is left out.
    pub(super) fn line(&mut self, most: usize) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.at..)?;
        let end = rest.iter().take(most).position(|&byte| byte == b'\n')?;
        self.at += end + 1;
        rest.get(..end)
    }
}
