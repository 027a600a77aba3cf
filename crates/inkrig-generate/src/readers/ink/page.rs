//! Pictures of paper become ink.

use super::Ink;

/// Blocks of a side in which the paper's brightness is taken.
const BLOCKS: usize = 12;

impl Ink {
    /// Of brightness, 0 black to 1 white, row after row. Uneven light is taken out; lines that are a quarter darker than the paper
    /// around them are ink. Where the numbers are not `width` x `height`, the page is bare.
    pub fn of_brightness(brightness: &[f32], width: usize, height: usize) -> Self {
        let mut ink = Self::new(width, height);
        if brightness.len() != width * height || brightness.is_empty() {
            return ink;
        }
        let paper = paper(brightness, width, height);
        // How much darker the darkest lines are.
        let mut darker: Vec<f32> = brightness
            .iter()
            .enumerate()
            .map(|(at, bright)| {
                let around = between(&paper, at % width, at / width, width, height).max(0.05);
                ((around - bright) / around).clamp(0.0, 1.0)
            })
            .collect();
        let mut dark: Vec<f32> = darker.iter().copied().filter(|dark| *dark > 0.2).collect();
        dark.sort_by(f32::total_cmp);
        let full = dark.get(dark.len() * 4 / 5).copied().unwrap_or(1.0).max(0.25);
        // Grain of the paper is no ink.
        darker.iter_mut().for_each(|dark| *dark = ((*dark / full - 0.15) / 0.75).clamp(0.0, 1.0));
        ink.pixels = darker;
        ink
    }
}

/// The brightness of paper in each block: that of its brighter pixels; dark blocks take it from their neighbours.
fn paper(brightness: &[f32], width: usize, height: usize) -> Vec<f32> {
    let mut blocks = Vec::with_capacity(BLOCKS * BLOCKS);
    for block in 0..BLOCKS * BLOCKS {
        let range = |at: usize, size: usize| {
            at * size / BLOCKS..((at + 1) * size / BLOCKS).max(at * size / BLOCKS + 1).min(size)
        };
        let (rows, columns) = (range(block / BLOCKS, height), range(block % BLOCKS, width));
        let mut own: Vec<f32> = rows
            .flat_map(|y| columns.clone().map(move |x| y * width + x))
            .filter_map(|at| brightness.get(at).copied())
            .collect();
        own.sort_by(f32::total_cmp);
        blocks.push(own.get(own.len() * 17 / 20).copied().unwrap_or(1.0));
    }
    let mut sorted = blocks.clone();
    sorted.sort_by(f32::total_cmp);
    let usual = sorted.get(sorted.len() / 2).copied().unwrap_or(1.0);
    // A block full of ink says nothing of the paper.
    blocks.iter_mut().for_each(|block| *block = block.max(0.55 * usual));
    blocks
}

/// The paper's brightness at a pixel, between the middles of blocks.
fn between(blocks: &[f32], x: usize, y: usize, width: usize, height: usize) -> f32 {
    let along = |at: usize, size: usize| {
        let place = ((at as f32 + 0.5) / size as f32 * BLOCKS as f32 - 0.5).clamp(0.0, (BLOCKS - 1) as f32);
        let first = (place as usize).min(BLOCKS - 2);
        (first, place - first as f32)
    };
    let ((column, right), (row, down)) = (along(x, width), along(y, height));
    let at = |row: usize, column: usize| blocks[row * BLOCKS + column];
    let upper = at(row, column) + right * (at(row, column + 1) - at(row, column));
    let lower = at(row + 1, column) + right * (at(row + 1, column + 1) - at(row + 1, column));
    upper + down * (lower - upper)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_ink_on_paper_that_is_lit_from_one_side() {
        let (width, height) = (200, 150);
        let line = |x: usize, y: usize| (60..64).contains(&x) && y > 10 || (80..83).contains(&y) && x > 20;
        let light = |x: usize| 0.45 + 0.5 * x as f32 / width as f32;
        let brightness: Vec<f32> = (0..width * height)
            .map(|at| {
                let (x, y) = (at % width, at / width);
                light(x) * if line(x, y) { 0.4 } else { 1.0 } + 0.01 * (at % 3) as f32
            })
            .collect();
        let ink = Ink::of_brightness(&brightness, width, height);
        for at in 0..width * height {
            let (x, y) = (at % width, at / width);
            if line(x, y) {
                assert!(ink.pixels[at] > 0.8, "{x} {y}: {}", ink.pixels[at]);
            } else {
                assert!(ink.pixels[at] < 0.05, "{x} {y}: {}", ink.pixels[at]);
            }
        }
        assert!(Ink::of_brightness(&vec![0.7; 400], 20, 20).pixels.iter().all(|pixel| *pixel < 0.01));
        assert!(Ink::of_brightness(&[1.0], 5, 5).pixels.iter().all(|pixel| *pixel == 0.0));
        assert!(Ink::of_brightness(&[0.3; 6], 3, 2).pixels.iter().all(|pixel| *pixel < 0.01));
    }
}
