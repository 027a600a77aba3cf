//! What keys ask of one level: settled rows, closed columns, costs, known frames.

use super::Keys;
use super::moment::{KeyPatch, Moment};
use super::resolve::{Resolved, SoftPlace};
use crate::pyramid::close_loop;
use crate::{AlignError, Layout};
use inkrig_transport::{Mask, Mat, MatRef, Problem};

/// By how much more than its radius a row is moved away from a forbidden pose: blending brings neighbours back.
const MARGIN: f32 = 1.15;

/// What the keys ask of one level.
#[derive(Debug, Default)]
pub(crate) struct LevelKeys {
    pub(crate) mask: Mask,
    pub(super) soft: Vec<Soft>,
    /// What every column costs because of poses to keep away from; empty without them.
    pub(super) avoid: Vec<f32>,
    /// Poses that must not appear, with the normalised distance to keep from each.
    never: Vec<(KeyPatch, f32)>,
    /// Frames of the result that are known, with their coordinates.
    known: Vec<(usize, Vec<f32>)>,
}

/// One soft key at a level.
#[derive(Debug)]
pub(super) struct Soft {
    /// Normalised distance of every row to the key's place.
    pub(super) rows: Vec<f32>,
    /// Normalised distance of every column to the key's pose.
    pub(super) columns: Vec<f32>,
    pub(super) weight: f64,
}

/// The tables of one level.
#[derive(Clone, Copy)]
pub(crate) struct LevelTables<'a> {
    /// Control and source at full length.
    pub(crate) full: (&'a Layout, &'a Layout),
    /// The same at this level.
    pub(crate) level: (&'a Layout, &'a Layout),
    /// Frames of the control at this level and the factor by which their distances are normalised.
    pub(crate) control: (MatRef<'a, f32>, f32),
    /// The same of the source.
    pub(crate) source: (MatRef<'a, f32>, f32),
}

impl Keys {
    /// What they ask at a level.
    pub(crate) fn at_level(&self, tables: &LevelTables<'_>) -> Result<LevelKeys, AlignError> {
        let (rows, columns) = tables.level;
        let full_columns = tables.full.1;
        let mut level = LevelKeys {
            mask: Mask { rows: Vec::new(), columns: self.closed(tables)? },
            ..LevelKeys::default()
        };
        for key in &self.list {
            match key {
                Resolved::Soft { place, moment, weight, .. } => {
                    let patch = place.patch(tables.full.0, rows, tables.control.0);
                    let to_place = patch.distances(tables.control.0, rows, tables.control.1);
                    let columns = moment.distances(tables);
                    level.soft.push(Soft { rows: to_place, columns, weight: *weight });
                }
                Resolved::Avoid { moment, distance, weight, .. } => {
                    level.avoid.resize(columns.patches(), 0.0);
                    let near = moment.distances(tables);
                    for (cost, near) in level.avoid.iter_mut().zip(near) {
                        *cost += 2.0 * *weight as f32 * (*distance as f32 - near).max(0.0).powi(2);
                    }
                }
                Resolved::Hard(hard) => {
                    let Some((row, mut column)) = hard.patches(tables.full, tables.level) else { continue };
                    if level.is_closed(column) {
                        if columns == full_columns {
                            let what = format!(
                                "frame {} is asked for at {} s, but it is like a pose that must not appear: drop one of \
                                 the two, or give a smaller radius",
                                hard.given, hard.seconds
                            );
                            return Err(AlignError::Key { what });
                        }
                        // At a coarse level a patch may hold both.
                        let open = (0..columns.patches()).filter(|&column| !level.is_closed(column));
                        column = open.min_by_key(|other| other.abs_diff(column)).unwrap_or(column);
                    }
                    level.settle(row, column);
                }
                Resolved::Never { moment, radius, .. } => {
                    let patch = moment.patch(full_columns, columns, tables.source.0);
                    level.never.push((patch, *radius as f32));
                }
                Resolved::Fixed(_) => {}
            }
        }
        // Hard keys first: at coarse levels two keys may fall on one patch, and the first holds it.
        for fixed in self.fixeds() {
            let source = (tables.source.0, columns);
            level.known.extend(fixed.known(tables.full.0, rows));
            let closed = &level.mask.columns;
            if columns == full_columns && !closed.is_empty() && fixed.forbidden(rows, source, closed)? {
                let what = "a part that stays as it is shows a pose that must not appear: keep another part, or give \
                            the pose a smaller radius";
                return Err(AlignError::Key { what: what.to_string() });
            }
            let settled = fixed.settled(tables.full.0, rows, source, closed)?;
            settled.into_iter().for_each(|(row, column)| level.settle(row % rows.patches(), column));
        }
        Ok(level)
    }

    /// The columns that no row may use, sorted. At a coarse level, where patches are long, this may be all of them
    /// though there are others at the finest; then only the nearest are closed there, or none.
    fn closed(&self, tables: &LevelTables<'_>) -> Result<Vec<usize>, AlignError> {
        let (columns, full) = (tables.level.1, tables.full.1);
        let (mut near, mut holding) = (Vec::new(), Vec::new());
        for key in &self.list {
            let Resolved::Never { moment, radius, .. } = key else { continue };
            let distances = moment.distances(tables);
            let is_near = |patch: &usize| f64::from(distances[*patch]) < *radius;
            near.extend((0..distances.len()).filter(is_near));
            // Wherever the pose itself comes up, no patch that holds it stays.
            for run in columns.runs() {
                let own = &distances[run.patch..run.patch + run.count];
                let is_least = |&place: &usize| {
                    let around = place.saturating_sub(1)..(place + 2).min(run.count);
                    is_near(&(run.patch + place)) && own[around].iter().all(|other| own[place] <= *other)
                };
                for place in (0..run.count).filter(is_least) {
                    let covering = columns.covering(run.frame + place + columns.patch() / 2);
                    holding.extend(covering.into_iter().map(|(patch, _)| patch));
                }
            }
            if let Moment::Own(frame) = moment {
                let covering = columns.covering(full.frame_in(columns, *frame));
                holding.extend(covering.into_iter().map(|(patch, _)| patch));
            }
        }
        let sorted = |mut patches: Vec<usize>| {
            patches.sort_unstable();
            patches.dedup();
            patches
        };
        let near = sorted(near);
        let both = sorted([near.as_slice(), &holding].concat());
        let leaves_some = |patches: &Vec<usize>| patches.len() < columns.patches();
        if columns == full && !leaves_some(&both) {
            let what = "the moments that must not appear are the whole clip: give a smaller radius, fewer of them, or a \
                        longer clip";
            return Err(AlignError::Key { what: what.to_string() });
        }
        Ok([both, near].into_iter().find(leaves_some).unwrap_or_default())
    }
}

impl Moment {
    /// Normalised distances of a level's columns to it.
    fn distances(&self, tables: &LevelTables<'_>) -> Vec<f32> {
        let (source, scale) = tables.source;
        self.patch(tables.full.1, tables.level.1, source).distances(source, tables.level.1, scale)
    }
}

impl SoftPlace {
    /// The patch of the control, or one that stays at the values.
    pub(super) fn patch(&self, full: &Layout, level: &Layout, control: MatRef<'_, f32>) -> KeyPatch {
        match self {
            Self::Frame(frame) => {
                KeyPatch::of(control, level, level.patch_around(full.frame_in(level, *frame)).unwrap_or(0))
            }
            Self::Row(values) => KeyPatch::still(values, level.patch()),
        }
    }
}

impl LevelKeys {
    /// The problem with what is asked.
    pub(crate) fn bind<'a>(
        &'a self,
        problem: Problem<'a, f32>,
        cost: Option<&'a Mat<f32>>,
    ) -> Result<Problem<'a, f32>, AlignError> {
        let problem = match cost {
            Some(cost) => problem.with_linear(cost.view())?,
            None => problem,
        };
        let masked = !(self.mask.rows.is_empty() && self.mask.columns.is_empty());
        Ok(if masked { problem.with_mask(&self.mask)? } else { problem })
    }

    /// The linear cost of the keys at weight alpha, N x M. `None` when there is none.
    ///
    /// Soft keys cost alpha (2 w / K) (d_Y(y_i, y_k) - d_X(x_j, x_k))^2, summed over the K keys: what the paper's
    /// block-diagonal substitution amounts to. Poses to keep away from cost alpha 2 w max(0, r - d_X(x_j, x_k))^2.
    pub(crate) fn cost(&self, rows: usize, columns: usize, alpha: f64) -> Option<Mat<f32>> {
        if !self.has_costs() {
            return None;
        }
        let mut cost = Mat::zeros(rows, columns);
        (0..rows).for_each(|row| self.add_costs(row, alpha, cost.row_mut(row)));
        Some(cost)
    }

    /// Keeps the costs of nearness, N x M, from leading back to what shall not appear. Poses to keep away from are dear
    /// here too. A row that lies near a forbidden pose though no open column does (a mean of open columns around it) is
    /// matched from where it would lie if it were moved straight away from that pose.
    pub(crate) fn steer(
        &self,
        (motion, rows): (MatRef<'_, f32>, &Layout),
        (source, columns): (MatRef<'_, f32>, &Layout),
        scale: f32,
        cost: &mut Mat<f32>,
    ) {
        for (row, moved) in self.away((motion, rows), scale) {
            cost.row_mut(row).copy_from_slice(&moved.distances(source, columns, scale));
        }
        if !self.avoid.is_empty() {
            for row in 0..cost.rows() {
                cost.row_mut(row).iter_mut().zip(&self.avoid).for_each(|(value, &avoid)| *value += avoid);
            }
        }
    }

    /// The rows of a motion that lie near a forbidden pose, each where it would lie if it were moved straight away from it.
    pub(super) fn away(
        &self,
        (motion, rows): (MatRef<'_, f32>, &Layout),
        scale: f32,
    ) -> Vec<(usize, KeyPatch)> {
        let mut moved = Vec::new();
        for (pose, radius) in &self.never {
            let near = pose.distances(motion, rows, scale).into_iter().enumerate();
            for (row, distance) in near.filter(|(_, near)| *near < MARGIN * radius) {
                let patch = KeyPatch::of(motion, rows, row);
                moved.push((row, patch.away_from(pose, distance / scale, MARGIN * radius / scale)));
            }
        }
        moved
    }

    /// Puts what is known of the result into a motion in the subspace, which has the rows of the control's layout.
    pub(crate) fn hold(&self, rows: &Layout, motion: &mut Mat<f32>) {
        if self.known.is_empty() {
            return;
        }
        for (frame, values) in &self.known {
            motion.row_mut(*frame).copy_from_slice(values);
        }
        close_loop(rows, motion);
    }

    /// Makes a plan of any weights obey the mask; rows that lose all their mass get the nearest open column.
    pub(crate) fn impose(&self, plan: &mut Mat<f32>, cost: MatRef<'_, f32>) {
        let mass = 1.0 / plan.rows() as f32;
        let untouched = if self.mask.columns.is_empty() { plan.rows() } else { 0 };
        for i in untouched..plan.rows() {
            let row = plan.row_mut(i);
            self.mask.columns.iter().for_each(|&column| row[column] = 0.0);
            let total: f32 = row.iter().sum();
            if total > 0.0 {
                row.iter_mut().for_each(|value| *value *= mass / total);
            } else {
                let open = |column: &usize| !self.is_closed(*column);
                let nearest =
                    (0..row.len()).filter(open).min_by(|&a, &b| cost.row(i)[a].total_cmp(&cost.row(i)[b]));
                if let Some(column) = nearest {
                    row[column] = mass;
                }
            }
        }
        for &(row, column) in &self.mask.rows {
            plan.row_mut(row).fill(0.0);
            plan.row_mut(row)[column] = mass;
        }
    }

    /// The frames of the source that no patch in use holds, in ascending order.
    pub(crate) fn forbidden_frames(&self, columns: &Layout) -> Vec<usize> {
        if self.mask.columns.is_empty() {
            return Vec::new();
        }
        let closed = |frame: &usize| {
            let covering = columns.covering(*frame);
            !covering.is_empty() && covering.iter().all(|(patch, _)| self.is_closed(*patch))
        };
        (0..columns.frames()).filter(closed).collect()
    }

    fn is_closed(&self, column: usize) -> bool {
        self.mask.columns.binary_search(&column).is_ok()
    }

    fn settle(&mut self, row: usize, column: usize) {
        if self.mask.rows.iter().all(|&(taken, _)| taken != row) {
            self.mask.rows.push((row, column));
        }
    }
}
