//! How many cells there are, where they stand, and at which times.

use super::{MOST_PIXELS, SheetError, SheetOptions};
use inkrig_motion::Clip;

/// The cells of a sheet, row by row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Grid {
    pub(super) poses: usize,
    pub(super) columns: usize,
    pub(super) cell: [u32; 2],
}

impl Grid {
    /// Checks the options, before anything is allocated.
    pub(super) fn of(clip: &Clip, options: &SheetOptions<'_>) -> Result<Self, SheetError> {
        let within = |what, got: f64, low: f64, high: f64| {
            let inside = (low..=high).contains(&got);
            if inside { Ok(()) } else { Err(SheetError::Option { what, low, high, got }) }
        };
        within("the number of poses", options.poses as f64, 1.0, 10_000.0)?;
        within("the number of columns", options.columns as f64, 1.0, 1000.0)?;
        within("the width of a cell", f64::from(options.cell[0]), 48.0, 4096.0)?;
        within("the height of a cell", f64::from(options.cell[1]), 48.0, 4096.0)?;
        within("the yaw", f64::from(options.yaw), -100.0, 100.0)?;
        within("the pitch", f64::from(options.pitch), -1.5, 1.5)?;
        let poses =
            options.frames.map_or(options.poses.min(clip.frames()), |frames| frames.len().clamp(1, 10_000));
        Self { poses, columns: options.columns.min(poses), cell: options.cell }.small()
    }

    /// With two cells for every pose, beside each other.
    pub(super) fn doubled(self) -> Result<Self, SheetError> {
        let poses = 2 * self.poses;
        let columns = self.columns.next_multiple_of(2).min(poses);
        Self { poses, columns, ..self }.small()
    }

    fn small(self) -> Result<Self, SheetError> {
        let [width, height] = self.size().map(u64::from);
        if width * height > MOST_PIXELS {
            return Err(SheetError::TooLarge { width, height, limit: MOST_PIXELS });
        }
        Ok(self)
    }

    /// Width and height of the sheet in pixels.
    pub(super) fn size(&self) -> [u32; 2] {
        let rows = self.poses.div_ceil(self.columns);
        [self.columns as u32 * self.cell[0], rows as u32 * self.cell[1]]
    }

    /// Upper left corner of a cell in pixels.
    pub(super) fn corner(&self, index: usize) -> [f32; 2] {
        let (row, column) = (index / self.columns, index % self.columns);
        [column as f32 * self.cell[0] as f32, row as f32 * self.cell[1] as f32]
    }

    /// The frame of each cell.
    pub(super) fn frames(&self, clip: &Clip, options: &SheetOptions<'_>) -> Vec<usize> {
        match options.frames {
            Some(frames) if !frames.is_empty() => {
                frames.iter().take(self.poses).map(|&frame| frame.min(clip.frames() - 1)).collect()
            }
            _ => self.times(clip),
        }
    }

    /// The frame of each cell: equal times, the first and the last frame among them.
    fn times(&self, clip: &Clip) -> Vec<usize> {
        let (last, steps) = (clip.frames() - 1, (self.poses - 1).max(1));
        (0..self.poses).map(|index| (index * last + steps / 2) / steps).collect()
    }
}
