//! A plan of one level as the beginning of the next.

use crate::{AlignError, Layout};
use inkrig_transport::{Plan, Support};

/// Coarse columns to either side of them that are opened too.
const SPREAD: usize = 1;

/// Brings a plan to finer layouts: every row takes the `most` best sources of the three coarse rows around it, those of the middle
/// one twice, each spread evenly over the fine columns that it stands for.
pub(crate) fn refine(
    plan: &Plan<f32>,
    (coarse_rows, coarse_columns): (&Layout, &Layout),
    (rows, columns): (&Layout, &Layout),
    most: usize,
) -> Result<Plan<f32>, AlignError> {
    let row_of = coarse_patches(rows, coarse_rows);
    let column_of = coarse_patches(columns, coarse_columns);
    // The fine columns of every coarse one.
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); plan.cols()];
    column_of.iter().enumerate().for_each(|(fine, &coarse)| groups[coarse].push(fine));
    let best: Vec<Vec<(usize, f32)>> = (0..plan.rows()).map(|row| best(plan, row, most)).collect();
    let (mut line, mut values) = (Vec::new(), Vec::new());
    let mass = 1.0 / row_of.len() as f32;
    let support = Support::from_rows(row_of.len(), column_of.len(), |i, out| {
        line.clear();
        let middle = row_of[i];
        for (row, share) in [(middle.wrapping_sub(1), 0.25), (middle, 0.5), (middle + 1, 0.25)] {
            for &(coarse, weight) in best.get(row).into_iter().flatten() {
                let around = coarse.saturating_sub(SPREAD)..(coarse + SPREAD + 1).min(groups.len());
                for (near, group) in around.clone().zip(&groups[around]) {
                    let share = if near == coarse { share * weight / group.len() as f32 } else { 0.0 };
                    line.extend(group.iter().map(|&fine| (fine, share)));
                }
            }
        }
        line.sort_by_key(|(fine, _)| *fine);
        let begin = values.len();
        for &(fine, share) in &line {
            if out.last() == Some(&fine) {
                if let Some(last) = values.last_mut() {
                    *last += share;
                }
            } else {
                out.push(fine);
                values.push(share);
            }
        }
        let total: f32 = values[begin..].iter().sum();
        let even = 1.0 / (values.len() - begin).max(1) as f32;
        values[begin..]
            .iter_mut()
            .for_each(|value| *value = mass * if total > 0.0 { *value / total } else { even });
    })?;
    Ok(Plan::from_support(support, values)?)
}

/// For every patch the coarse one whose middle is nearest.
fn coarse_patches(fine: &Layout, coarse: &Layout) -> Vec<usize> {
    let middle = |first: &usize| (first + fine.patch() / 2) % fine.frames();
    let first = fine.first_frames();
    first
        .iter()
        .map(|first| coarse.nearest_patch(fine.frame_in(coarse, middle(first))).unwrap_or(0))
        .collect()
}

fn best(plan: &Plan<f32>, row: usize, most: usize) -> Vec<(usize, f32)> {
    let mut entries: Vec<(usize, f32)> = plan.entries(row).filter(|(_, mass)| *mass > 0.0).collect();
    if entries.len() > most {
        entries.select_nth_unstable_by(most - 1, |a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        entries.truncate(most);
    }
    entries
}
