//! The control's side of a live alignment: only what a change touches is computed anew.

use crate::coarse_to_fine::Frames;
use crate::patches::{PatchScratch, normalise, patch_distances};
use crate::prepared::{LevelTable, Prepared};
use crate::pyramid::resample_frames;
use crate::{AlignError, Control, Layout, Options};
use inkrig_transport::{Mat, MatRef, with_threads};
use std::ops::Range;
use std::sync::Arc;

/// Values that differ by less than this share of the largest are the same: what rounding leaves when a stroke's new part
/// moves the centre that all of it is measured from.
const SAME: f32 = 1e-5;

/// After so many changes all is computed anew, so that differences too small to see cannot add up.
const CHANGES: usize = 64;

#[derive(Debug)]
pub(super) struct ControlSide {
    pub(super) prepared: Prepared,
    /// The rows in the control's own domain, measured from [`Self::origin`], to compare with those that come next.
    pub(super) drawn: Arc<Mat<f32>>,
    origin: Vec<f64>,
    /// 1 row unit in the domain.
    unit: f64,
    /// Distances of every level before they were normalised, in units of the domain.
    distances: Vec<Mat<f32>>,
    changes: usize,
    scratch: PatchScratch<f32>,
}

impl ControlSide {
    pub(super) fn new(
        control: &Control,
        (table, layout): (&Mat<f32>, &Layout),
        options: &Options,
    ) -> Result<Self, AlignError> {
        let origin = control.scaling().map_or_else(Vec::new, |(centre, _)| centre.to_vec());
        let drawn = Arc::new(in_domain(control, table, &origin));
        let unit = unit(control);
        let prepared = Prepared::control(Frames { table: table.view(), layout }, options)?;
        let distances = (prepared.levels().iter())
            .map(|level| {
                let mut distances = level.distances.clone();
                let factor = (unit / f64::from(level.scale)) as f32;
                distances.as_mut_slice().iter_mut().for_each(|value| *value *= factor);
                distances
            })
            .collect();
        Ok(Self { prepared, drawn, origin, unit, distances, changes: 0, scratch: PatchScratch::new() })
    }

    /// Takes a new state of the control; returns how many of its patches at the finest level were computed anew.
    pub(super) fn update(
        &mut self,
        control: &Control,
        (table, layout): (&Mat<f32>, &Layout),
        options: &Options,
    ) -> Result<usize, AlignError> {
        let drawn = in_domain(control, table, &self.origin);
        let same_shape = layout == self.prepared.layout() && drawn.cols() == self.drawn.cols();
        let unchanged = Unchanged::between(self.drawn.view(), drawn.view());
        let changed = unchanged.first..drawn.rows() - unchanged.last;
        self.changes += 1;
        if !same_shape || layout.is_cyclic() || 2 * changed.len() > drawn.rows() || self.changes > CHANGES {
            let origin = std::mem::take(&mut self.origin);
            *self = Self::new(control, (table, layout), options)?;
            self.drawn = Arc::new(in_domain(control, table, &origin));
            self.origin = origin;
            return Ok(layout.patches());
        }
        self.unit = unit(control);
        let threads = options.threads;
        let patches = with_threads(threads, || self.replace(table, layout, &changed, options))?;
        self.drawn = Arc::new(drawn);
        Ok(patches)
    }

    fn replace(
        &mut self,
        table: &Mat<f32>,
        full: &Layout,
        changed: &Range<usize>,
        options: &Options,
    ) -> Result<usize, AlignError> {
        let mut patches = 0;
        let last = (full.frames() - 1).max(1) as f64;
        for (level, raw) in self.prepared.levels.iter_mut().zip(&mut self.distances) {
            let LevelTable { layout, frames, distances, scale, .. } = level;
            resample_frames(table.view(), full, layout, frames);
            if !changed.is_empty() {
                // A frame between two others changes with either.
                let ratio = (layout.frames() - 1) as f64 / last;
                let from = ((changed.start as f64 - 1.0) * ratio).floor().max(0.0) as usize;
                let to = ((changed.end as f64 * ratio).ceil() as usize + 1).min(layout.frames());
                let first = (from + 1).saturating_sub(layout.patch());
                let rows = first..to.min(layout.patches());
                patches = rows.len();
                change(raw, (frames, layout), rows, self.unit as f32, &mut self.scratch, options.threads)?;
                distances.clone_from(raw);
                let squares =
                    (0..frames.rows()).map(|row| frames.row(row).iter().map(|v| v * v).sum::<f32>());
                let unit = (self.unit * self.unit) as f32;
                let found = normalise(distances, options.control_norm, squares.map(|square| square * unit));
                *scale = (f64::from(found.ok_or(AlignError::StillControl)?) * self.unit) as f32;
            }
        }
        Ok(patches)
    }
}

/// Computes the distances of some patches to all, in both directions.
fn change(
    distances: &mut Mat<f32>,
    (frames, layout): (&Mat<f32>, &Layout),
    patches: Range<usize>,
    unit: f32,
    scratch: &mut PatchScratch<f32>,
    threads: usize,
) -> Result<(), AlignError> {
    let (patch, width) = (layout.patch(), frames.cols());
    let rows = patches.start..patches.end + patch - 1;
    let part = MatRef::new(&frames.as_slice()[rows.start * width..rows.end * width], rows.len(), width)?;
    let mut fresh = Mat::default();
    let own = Layout::open(rows.len(), patch);
    patch_distances((part, &own), (frames.view(), layout), unit, scratch, &mut fresh, threads)?;
    for (at, patch) in patches.enumerate() {
        fresh.row_mut(at)[patch] = 0.0;
        distances.row_mut(patch).copy_from_slice(fresh.row(at));
        for other in 0..distances.rows() {
            distances.row_mut(other)[patch] = fresh.row(at)[other];
        }
    }
    Ok(())
}

/// What a change left as it was.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Unchanged {
    /// Rows at the beginning.
    pub(super) first: usize,
    /// Rows at the end, none of the first ones.
    pub(super) last: usize,
}

impl Unchanged {
    pub(super) fn between(old: MatRef<'_, f32>, new: MatRef<'_, f32>) -> Self {
        if old.cols() != new.cols() {
            return Self { first: 0, last: 0 };
        }
        let size = new.as_slice().iter().fold(0.0_f32, |size, value| size.max(value.abs()));
        let same =
            |a: usize, b: usize| old.row(a).iter().zip(new.row(b)).all(|(a, b)| (a - b).abs() <= SAME * size);
        let shorter = old.rows().min(new.rows());
        let first = (0..shorter).take_while(|&row| same(row, row)).count();
        let last = (1..=shorter - first).take_while(|&row| same(old.rows() - row, new.rows() - row)).count();
        Self { first, last }
    }
}

/// 1 unit of a row, in the control's domain.
fn unit(control: &Control) -> f64 {
    control.scaling().map_or(1.0, |(_, scale)| 1.0 / scale)
}

/// Rows in the domain's units, from a place that does not move.
fn in_domain(control: &Control, table: &Mat<f32>, origin: &[f64]) -> Mat<f32> {
    let Some((centre, scale)) = control.scaling() else { return table.clone() };
    Mat::from_fn(table.rows(), table.cols(), |row, column| {
        let shift =
            centre.get(column).zip(origin.get(column)).map_or(0.0, |(centre, origin)| centre - origin);
        (f64::from(table.row(row)[column]) / scale + shift) as f32
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::CurveOptions;
    use crate::alignment::at_rate;
    use inkrig_sketch::{Curve, Timing};

    fn control(points: impl Iterator<Item = [f64; 2]>) -> Control {
        let curve = Curve::new(points.collect()).unwrap();
        let options =
            CurveOptions { smooth: 0.0, timing: Some(Timing::AsSampled), ..CurveOptions::default() };
        Control::from_curve(&curve, &options).unwrap()
    }

    #[test]
    fn a_partial_change_gives_what_a_fresh_start_gives() {
        let at = |i: usize| [(i as f64 * 0.11).sin() * (1.0 + i as f64 * 0.01), (i as f64 * 0.07).cos()];
        let bent = |i: usize| if (80..100).contains(&i) { [at(i)[0] + 2.5, at(i)[1] - 0.4] } else { at(i) };
        let (before, after) = (control((0..200).map(at)), control((0..200).map(bent)));
        let options = Options::default();
        let table = |control: &Control| at_rate(control, &options);
        let (old, layout) = table(&before);
        let (new, _) = table(&after);
        let mut side = ControlSide::new(&before, (&old, &layout), &options).unwrap();
        let patches = side.update(&after, (&new, &layout), &options).unwrap();
        assert!((30..=36).contains(&patches), "{patches} patches hold what changed");
        let fresh = ControlSide::new(&after, (&new, &layout), &options).unwrap();
        for (a, b) in side.prepared.levels().iter().zip(fresh.prepared.levels()) {
            assert_eq!(a.frames, b.frames);
            assert!((a.scale / b.scale - 1.0).abs() < 1e-5, "{} {}", a.scale, b.scale);
            for (x, y) in a.distances.as_slice().iter().zip(b.distances.as_slice()) {
                assert!((x - y).abs() < 1e-3, "{x} {y}");
            }
        }
        assert_eq!(side.update(&after, (&new, &layout), &options).unwrap(), 0, "nothing changed");
    }

    #[test]
    fn what_stays_is_found_at_both_ends() {
        let row = |values: &[f32]| Mat::from_vec(values.len(), 1, values.to_vec()).unwrap();
        let (old, longer) = (row(&[1.0, 2.0, 3.0, 4.0]), row(&[1.0, 2.0, 7.0, 8.0, 4.0]));
        let found = Unchanged::between(old.view(), longer.view());
        assert_eq!((found.first, found.last), (2, 1));
        let all = Unchanged::between(old.view(), old.view());
        assert_eq!((all.first, all.last), (4, 0));
    }
}
