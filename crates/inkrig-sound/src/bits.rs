//! Bits of a Vorbis packet, least significant first.

/// A reader that returns `None` at the end.
pub(crate) struct Bits<'a> {
    bytes: &'a [u8],
    next: usize,
}

impl<'a> Bits<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, next: 0 }
    }

    /// The next `count` bits as a number; at most 32.
    pub(crate) fn read(&mut self, count: u32) -> Option<u32> {
        let mut value = 0_u32;
        for place in 0..count {
            let byte = self.bytes.get(self.next / 8)?;
            value |= u32::from(byte >> (self.next % 8) & 1) << place;
            self.next += 1;
        }
        Some(value)
    }

    /// Steps over bits that must be there.
    pub(crate) fn skip(&mut self, count: u64) -> Option<()> {
        let next = u64::try_from(self.next).ok()?.checked_add(count)?;
        self.next = usize::try_from(next).ok()?;
        (self.next.div_ceil(8) <= self.bytes.len()).then_some(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bits_come_least_significant_first() {
        let mut bits = Bits::new(&[0b1010_0110, 0b0000_0001]);
        assert_eq!(bits.read(3), Some(0b110));
        assert_eq!(bits.read(6), Some(0b1_10100));
        assert_eq!(bits.skip(7), Some(()));
        assert_eq!(bits.read(1), None);
        assert_eq!(Bits::new(&[0]).skip(9), None);
    }
}
