//! Patches of a table as rows, and back.

use super::plan::Shape;

/// How patches lie.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    pub kernel: [usize; 2],
    pub stride: [usize; 2],
    pub pad: [usize; 2],
    pub inner: Shape,
    pub outer: Shape,
}

impl Grid {
    /// Numbers of a patch.
    pub(super) fn depth(&self) -> usize {
        self.kernel[0] * self.kernel[1] * self.inner.channels
    }

    /// Every patch as a row; zeros beyond the border.
    pub(super) fn gather(&self, table: &[f32], rows: &mut [f32]) {
        rows.fill(0.0);
        self.each(|place, own| rows[own..][..place.1].copy_from_slice(&table[place.0..][..place.1]));
    }

    /// Adds every row to where it was taken from.
    pub(super) fn scatter(&self, rows: &[f32], table: &mut [f32]) {
        self.each(|place, own| {
            for (sum, part) in table[place.0..][..place.1].iter_mut().zip(&rows[own..]) {
                *sum += part;
            }
        });
    }

    /// Runs of numbers: (first of the table, how many), first of the rows.
    fn each(&self, mut run: impl FnMut((usize, usize), usize)) {
        let (channels, depth) = (self.inner.channels, self.depth());
        for place in 0..self.outer.places() {
            let (row, column) = (place / self.outer.width, place % self.outer.width);
            let left = column * self.stride[1];
            let skipped = self.pad[1].saturating_sub(left);
            let first = (left + skipped).saturating_sub(self.pad[1]);
            let end = (left + self.kernel[1]).saturating_sub(self.pad[1]).min(self.inner.width);
            let Some(count) = end.checked_sub(first) else { continue };
            for line in 0..self.kernel[0] {
                let Some(y) = (row * self.stride[0] + line).checked_sub(self.pad[0]) else { continue };
                if y < self.inner.height {
                    let from = (y * self.inner.width + first) * channels;
                    let own = place * depth + (line * self.kernel[1] + skipped) * channels;
                    run((from, count * channels), own);
                }
            }
        }
    }
}
