//! Structure and nearness of long motions, on patches spread evenly instead of on all.

use crate::measures::{Nearness, Structure, structure};
use crate::patches::{PatchScratch, patch_distances};
use crate::{AlignError, Layout};
use inkrig_transport::{Mat, MatRef, Support, Windows, matmul_transposed};

/// Patches above which one side is sampled: tables of all distances would be too large.
const MOST_MEASURED: usize = 2000;
/// Patches between which structure is measured.
const STRUCTURE: usize = 1000;
/// Patches whose nearest one on the other side, out of all there, is looked for.
const NEAREST: usize = 500;
/// Of them, those that are looked at together.
const TOGETHER: usize = 16;

/// A table of frames and where its patches stand.
type Table<'a> = (MatRef<'a, f32>, &'a Layout);

/// Whether a motion of such a layout is measured on a sample, and on how many of its patches structure then is.
pub(crate) fn sample(rows: &Layout, columns: &Layout) -> Option<usize> {
    let (control, source) = (rows.patches(), columns.patches());
    (control.max(source) > MOST_MEASURED).then(|| control.min(STRUCTURE))
}

/// Structure of a motion and of the time-warped clip, and nearness of the motion to the clip: the arguments are frames of
/// the control, the motion, the warped clip (all three with as many patches) and the clip.
pub(crate) fn measure(
    control: Table<'_>,
    motion: Table<'_>,
    warped: Table<'_>,
    clip: Table<'_>,
    threads: usize,
) -> Result<(Structure, Structure, Nearness), AlignError> {
    let count = control.1.patches();
    let some = spread(count, STRUCTURE);
    let of_control = among(control, &some, threads)?;
    if mean(&of_control) <= noise(control) {
        return Err(AlignError::StillControl);
    }
    // Only pairs that share no frame count: those are fewer numbers apart in the sample.
    let apart = (control.1.patch() * some.len()).div_ceil(count);
    let follows = |table| Ok::<_, AlignError>(structure(&of_control, &among(table, &some, threads)?, apart));
    let unit = unit(clip, threads)?;
    let near = nearness(motion, clip, unit, threads)?;
    Ok((follows(motion)?, follows(warped)?, near))
}

/// The mean distance of a clip's patches, of all or of some that are spread evenly.
pub(crate) fn unit(clip: Table<'_>, threads: usize) -> Result<f64, AlignError> {
    let unit = mean(&among(clip, &spread(clip.1.patches(), STRUCTURE), threads)?);
    if unit > noise(clip) { Ok(unit) } else { Err(AlignError::StillClip) }
}

/// At most `most` of `count` patches.
fn spread(count: usize, most: usize) -> Vec<usize> {
    let some = count.min(most).max(1);
    (0..some).map(|k| (2 * k + 1) * count / (2 * some)).collect()
}

/// Distances among some patches.
fn among(table: Table<'_>, some: &[usize], threads: usize) -> Result<Mat<f32>, AlignError> {
    let patches = gathered(table, some)?;
    let norms: Vec<f32> =
        (0..some.len()).map(|row| patches.row(row).iter().map(|x| x * x).sum::<f32>()).collect();
    let mut out = Mat::default();
    matmul_transposed(patches.view(), patches.view(), &mut out, threads)?;
    for (row, own) in norms.iter().enumerate() {
        for (product, other) in out.row_mut(row).iter_mut().zip(&norms) {
            *product = (own + other - 2.0 * *product).max(0.0).sqrt();
        }
        out.row_mut(row)[row] = 0.0;
    }
    Ok(out)
}

/// Some patches, a long row each.
fn gathered((table, layout): Table<'_>, some: &[usize]) -> Result<Mat<f32>, AlignError> {
    let (first, width) = (layout.first_frames(), table.cols());
    let long = layout.patch() * width;
    let values = some.iter().flat_map(|&patch| &table.as_slice()[first[patch] * width..][..long]);
    Ok(Mat::from_vec(some.len(), long, values.copied().collect())?)
}

fn mean(distances: &Mat<f32>) -> f64 {
    distances.as_slice().iter().map(|&d| f64::from(d)).sum::<f64>() / distances.as_slice().len().max(1) as f64
}

/// What rounding may leave between equal patches.
fn noise((table, _): Table<'_>) -> f64 {
    let square = |row: usize| table.row(row).iter().map(|x| x * x).sum::<f32>();
    1e-6 * (1.0 + f64::from((0..table.rows()).map(square).fold(0.0, f32::max).sqrt()))
}

/// As [`nearness`](crate::measures::nearness), where `unit` is the mean distance within the clip.
fn nearness(motion: Table<'_>, clip: Table<'_>, unit: f64, threads: usize) -> Result<Nearness, AlignError> {
    let nearest = nearest(motion, clip, threads)?;
    let first = clip.1.first_frames();
    let windows = Windows::new(clip.0, &first, clip.1.patch())?;
    let followed = clip.1.followed();
    let mut adjacent = Vec::new();
    if !followed.is_empty() {
        let follow = Support::from_rows(followed.len(), first.len(), |i, out| out.push(followed[i] + 1))?;
        let starts: Vec<usize> = followed.iter().map(|&patch| first[patch]).collect();
        let before = Windows::new(clip.0, &starts, clip.1.patch())?;
        before.distances_at(&windows, &follow, 1.0, threads, &mut adjacent)?;
    }
    let steps = followed.len().max(1) as f64;
    let adjacent = adjacent.iter().map(|&d| f64::from(d)).sum::<f64>() / (steps * unit);
    let reach = (2.0 * adjacent).max(0.1);
    let used = self::nearest(clip, motion, threads)?;
    let covered = used.iter().filter(|&&distance| f64::from(distance) / unit < reach).count();
    Ok(Nearness {
        nearest_patch: nearest.iter().map(|&d| f64::from(d)).sum::<f64>() / (nearest.len() as f64 * unit),
        coverage: covered as f64 / used.len() as f64,
    })
}

/// For some patches of `a` the distance to the nearest of all patches of `b`.
fn nearest((a, rows): Table<'_>, b: Table<'_>, threads: usize) -> Result<Vec<f32>, AlignError> {
    let (patch, count) = (rows.patch(), rows.patches());
    let mut nearest = Vec::with_capacity(NEAREST);
    let (mut scratch, mut out) = (PatchScratch::new(), Mat::default());
    for some in spread(count, NEAREST).chunks(TOGETHER) {
        // Each patch a clip of its own: products of frames do for their distances.
        let frames = gathered((a, rows), some)?.into_vec();
        let table = Mat::from_vec(some.len() * patch, a.cols(), frames)?;
        let own = Layout::clips(&vec![patch; some.len()], patch);
        patch_distances((table.view(), &own), b, 1.0, &mut scratch, &mut out, threads)?;
        nearest.extend((0..some.len()).map(|row| out.row(row).iter().copied().fold(f32::INFINITY, f32::min)));
    }
    Ok(nearest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measures;

    fn table(frames: usize, speed: f32) -> Mat<f32> {
        Mat::from_fn(frames, 4, |row, column| {
            let t = row as f32 * speed + column as f32;
            t.sin() * (1.0 + (0.13 * t).cos()) + 0.3 * (2.7 * t + 1.0).sin()
        })
    }

    #[test]
    fn a_sample_says_what_all_patches_say() {
        let (patch, frames) = (11, 2600);
        let (control, motion, warped, clip) =
            (table(frames, 0.05), table(frames, 0.06), table(frames, 0.02), table(1700, 0.11));
        let (rows, columns) = (Layout::open(frames, patch), Layout::clips(&[900, 800], patch));
        assert_eq!(sample(&rows, &columns), Some(STRUCTURE));
        assert_eq!(sample(&columns, &columns), None);
        let side = |table: &Mat<f32>, layout| {
            among((table.view(), layout), &(0..layout.patches()).collect::<Vec<_>>(), 2).unwrap()
        };
        let all = side(&control, &rows);
        let (want, warp) =
            (structure(&all, &side(&motion, &rows), patch), structure(&all, &side(&warped, &rows), patch));
        let mut of_clip = side(&clip, &columns);
        let unit = mean(&of_clip);
        let mut cross = Mat::default();
        let tables = ((motion.view(), &rows), (clip.view(), &columns));
        patch_distances(tables.0, tables.1, 1.0, &mut PatchScratch::new(), &mut cross, 2).unwrap();
        [&mut of_clip, &mut cross].into_iter().for_each(|mat| {
            mat.as_mut_slice().iter_mut().for_each(|d| *d /= unit as f32);
        });
        let near = measures::nearness(&cross, &of_clip, &columns);
        let (own, other, got) =
            measure((control.view(), &rows), tables.0, (warped.view(), &rows), tables.1, 2).unwrap();
        println!("{want:?} {own:?}, {warp:?} {other:?}, {near:?} {got:?}");
        assert!((own.pearson - want.pearson).abs() < 0.01 && (own.spearman - want.spearman).abs() < 0.01);
        assert!((other.pearson - warp.pearson).abs() < 0.01);
        assert!((got.nearest_patch / near.nearest_patch - 1.0).abs() < 0.03);
        assert!((got.coverage - near.coverage).abs() < 0.03);
    }

    #[test]
    fn what_stands_still_is_said() {
        let (moving, still) = (table(2500, 0.1), Mat::from_fn(2500, 4, |_, column| 3.0 + column as f32));
        let layout = Layout::open(2500, 11);
        let run = |control: &Mat<f32>, clip: &Mat<f32>| {
            let table = |mat| (MatRef::new(Mat::as_slice(mat), 2500, 4).unwrap(), &layout);
            measure(table(control), table(&moving), table(&moving), table(clip), 1).map(|_| ())
        };
        assert!(matches!(run(&still, &moving), Err(AlignError::StillControl)));
        assert!(matches!(run(&moving, &still), Err(AlignError::StillClip)));
        assert!(run(&moving, &moving).is_ok());
    }
}
