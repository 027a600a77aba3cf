//! Where the panels of a page are.

use super::around;
use inkrig_sketch::storyboard::Kind;

/// A box is at least this share of the page wide and high.
const BOX: f32 = 0.15;
/// Share of a box's pixels that lie along its sides, and how near, as a share of its size.
const ALONG: f32 = 0.93;
const NEAR: f32 = 0.04;
/// Empty columns of this share of the page part panels.
const GUTTER: f32 = 0.06;
/// A panel without a box has a body of at least this share of the tallest one's height.
const TALL: f32 = 0.5;

/// Left, top, right and bottom (exclusive) of each panel, in reading order; the whole page where there are none.
pub(super) fn panels(kinds: &[Option<Kind>], width: usize) -> Vec<[usize; 4]> {
    let height = kinds.len() / width;
    let mut found = boxes(kinds, width);
    if found.is_empty() {
        found = columns(kinds, width);
    }
    if found.is_empty() {
        return vec![[0, 0, width, height]];
    }
    // Rows of panels, each from left to right.
    found.sort_by_key(|[_, top, _, _]| *top);
    let mut rows: Vec<Vec<[usize; 4]>> = Vec::new();
    for panel in found {
        match rows
            .last_mut()
            .filter(|row| row.first().is_some_and(|first| panel[1] < (first[1] + first[3]) / 2))
        {
            Some(row) => row.push(panel),
            None => rows.push(vec![panel]),
        }
    }
    rows.iter_mut().for_each(|row| row.sort_by_key(|[left, ..]| *left));
    rows.concat()
}

/// The insides of drawn boxes.
fn boxes(kinds: &[Option<Kind>], width: usize) -> Vec<[usize; 4]> {
    let height = kinds.len() / width;
    let dark = |at: usize| matches!(kinds.get(at), Some(Some(Kind::Body | Kind::Scene)));
    let mut seen = vec![false; kinds.len()];
    let mut found = Vec::new();
    for start in 0..kinds.len() {
        if seen[start] || !dark(start) {
            continue;
        }
        let mut piece = vec![start];
        seen[start] = true;
        let mut next = 0;
        let mut bounds = [usize::MAX, usize::MAX, 0, 0];
        while let Some(&at) = piece.get(next) {
            next += 1;
            let (x, y) = (at % width, at / width);
            bounds = [bounds[0].min(x), bounds[1].min(y), bounds[2].max(x + 1), bounds[3].max(y + 1)];
            for other in around(at, width, kinds.len()) {
                if !seen[other] && dark(other) {
                    seen[other] = true;
                    piece.push(other);
                }
            }
        }
        let [left, top, right, bottom] = bounds;
        let size = [right - left, bottom - top];
        if (size[0] as f32) < BOX * width as f32 || (size[1] as f32) < BOX * height as f32 {
            continue;
        }
        let near = [(NEAR * size[0] as f32) as usize + 2, (NEAR * size[1] as f32) as usize + 2];
        let along = piece.iter().filter(|at| {
            let (x, y) = (*at % width, *at / width);
            x < left + near[0] || x + near[0] >= right || y < top + near[1] || y + near[1] >= bottom
        });
        // A line along all four sides, not along two.
        let sides = [false, true].map(|far| {
            let rows = piece.iter().filter(|at| {
                let y = **at / width;
                if far { y + near[1] >= bottom } else { y < top + near[1] }
            });
            rows.count() >= size[0] / 2
        });
        if along.count() as f32 > ALONG * piece.len() as f32 && sides == [true; 2] {
            found.push([left + near[0], top + near[1], right - near[0], bottom - near[1]]);
        }
    }
    found.retain(|[left, top, right, bottom]| left < right && top < bottom);
    found
}

/// Parts between empty columns, where each has a body about as tall as the others'.
fn columns(kinds: &[Option<Kind>], width: usize) -> Vec<[usize; 4]> {
    let height = kinds.len() / width;
    let used: Vec<bool> = (0..width).map(|x| (0..height).any(|y| kinds[y * width + x].is_some())).collect();
    let least = (GUTTER * width as f32) as usize;
    let mut parts: Vec<[usize; 2]> = Vec::new();
    for x in (0..width).filter(|x| used[*x]) {
        match parts.last_mut().filter(|[_, end]| x - *end < least.max(1)) {
            Some(part) => part[1] = x + 1,
            None => parts.push([x, x + 1]),
        }
    }
    let tall = |[left, right]: &[usize; 2]| {
        let rows: Vec<usize> = (0..height)
            .filter(|y| (*left..*right).any(|x| kinds[y * width + x] == Some(Kind::Body)))
            .collect();
        rows.last().zip(rows.first()).map_or(0, |(last, first)| last - first)
    };
    let heights: Vec<usize> = parts.iter().map(tall).collect();
    let most = heights.iter().copied().max().unwrap_or(0) as f32;
    if parts.len() < 2 || heights.iter().any(|own| (*own as f32) < TALL * most) {
        return Vec::new();
    }
    parts.into_iter().map(|[left, right]| [left, 0, right, height]).collect()
}
