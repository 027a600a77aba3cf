//! Rows in fixed blocks. A block's bounds depend on the number of rows alone, and sums over blocks are taken in
//! their order, so that the number of threads never shows in a result.

use std::cell::Cell;
use std::sync::atomic::{AtomicBool, Ordering};

/// Rows of one block: a multiple of 8, the height of the product's tiles. Few, so that two threads get as much each;
/// more for a large matrix, where a product shall read its right side from the cache often enough.
pub(crate) fn block_rows(rows: usize) -> usize {
    match rows {
        0..=384 => 16,
        385..=1024 => 48,
        _ => rows.div_ceil(16).next_multiple_of(8).clamp(80, 192),
    }
}

/// Number of blocks.
pub(crate) fn blocks(rows: usize) -> usize {
    rows.div_ceil(block_rows(rows))
}

/// Something that is cut between rows.
pub(crate) trait Rows: Sized + Send {
    /// The rows before `row`, and those from it on.
    fn cut(self, row: usize) -> (Self, Self);
}

/// Mutable rows of a fixed length.
pub(crate) struct Chunk<'a, T> {
    pub(crate) data: &'a mut [T],
    pub(crate) stride: usize,
}

impl<'a, T> Chunk<'a, T> {
    pub(crate) fn new(data: &'a mut [T], stride: usize) -> Self {
        Self { data, stride }
    }
}

impl<T: Send> Rows for Chunk<'_, T> {
    fn cut(self, row: usize) -> (Self, Self) {
        let at = (row * self.stride).min(self.data.len());
        let (a, b) = self.data.split_at_mut(at);
        (Self::new(a, self.stride), Self::new(b, self.stride))
    }
}

/// Mutable rows of lengths of their own: row i is `starts[i] - starts[0] .. starts[i + 1] - starts[0]`.
pub(crate) struct Ragged<'a, T> {
    pub(crate) data: &'a mut [T],
    pub(crate) starts: &'a [usize],
}

impl<T: Send> Rows for Ragged<'_, T> {
    fn cut(self, row: usize) -> (Self, Self) {
        let (a, b) = self.data.split_at_mut(self.starts[row] - self.starts[0]);
        (Self { data: a, starts: &self.starts[..=row] }, Self { data: b, starts: &self.starts[row..] })
    }
}

impl<A: Rows, B: Rows> Rows for (A, B) {
    fn cut(self, row: usize) -> (Self, Self) {
        let ((a, x), (b, y)) = (self.0.cut(row), self.1.cut(row));
        ((a, b), (x, y))
    }
}

impl<A: Rows, B: Rows, C: Rows> Rows for (A, B, C) {
    fn cut(self, row: usize) -> (Self, Self) {
        let ((a, x), (b, y), (c, z)) = (self.0.cut(row), self.1.cut(row), self.2.cut(row));
        ((a, b, c), (x, y, z))
    }
}

/// One value, or one row of sums, per block rather than per row.
pub(crate) struct PerBlock<'a, T> {
    data: &'a mut [T],
    width: usize,
    block: usize,
}

impl<'a, T> PerBlock<'a, T> {
    /// `width` values for each block of `block` rows.
    pub(crate) fn new(data: &'a mut [T], width: usize, block: usize) -> Self {
        Self { data, width, block }
    }

    /// The values of this piece's first block.
    pub(crate) fn first(self) -> &'a mut [T] {
        let width = self.width.min(self.data.len());
        &mut self.data[..width]
    }
}

impl<T: Send> Rows for PerBlock<'_, T> {
    fn cut(self, row: usize) -> (Self, Self) {
        // Rounded up: a short last block has its sums too.
        let at = (row.div_ceil(self.block) * self.width).min(self.data.len());
        let (a, b) = self.data.split_at_mut(at);
        (Self::new(a, self.width, self.block), Self::new(b, self.width, self.block))
    }
}

/// Calls `each(first row, rows, piece)` for every block of `block` rows, on up to `threads` threads.
pub(crate) fn for_blocks<W: Rows>(
    threads: usize,
    rows: usize,
    block: usize,
    work: W,
    each: &(impl Fn(usize, usize, W) + Sync),
) {
    split(threads, 0, rows, block, work, each);
}

fn split<W: Rows>(
    threads: usize,
    start: usize,
    rows: usize,
    block: usize,
    mut work: W,
    each: &(impl Fn(usize, usize, W) + Sync),
) {
    let count = rows.div_ceil(block);
    if threads > 1 && count > 1 {
        let (left, right) = (threads / 2, threads - threads / 2);
        // Whole blocks, in the proportion of the threads on either side.
        let at = ((rows * left).div_ceil(threads * block)).clamp(1, count - 1) * block;
        let (a, b) = work.cut(at);
        rayon::join(
            || split(left, start, at, block, a, each),
            || split(right, start + at, rows - at, block, b, each),
        );
        return;
    }
    let mut done = 0;
    while done < rows {
        let take = block.min(rows - done);
        let (piece, rest) = work.cut(take);
        each(start + done, take, piece);
        work = rest;
        done += take;
    }
}

/// Calls `each(first row, rows)` for blocks of whole rows of a row-major table, on up to `threads` threads: a pass over a
/// table in which every row is made on its own.
pub fn for_rows<T: Send>(
    threads: usize,
    table: &mut [T],
    width: usize,
    each: &(impl Fn(usize, &mut [T]) + Sync),
) {
    let rows = table.len().checked_div(width).unwrap_or(0);
    let threads = if table.len() < SMALL { 1 } else { threads };
    let work = Chunk::new(table, width);
    with_threads(threads, || {
        for_blocks(threads, rows, 16, work, &|first, _, piece: Chunk<'_, T>| each(first, piece.data));
    });
}

/// Calls `each(index, item)` for every item, on up to `threads` threads: for a few long jobs.
pub fn for_each<T: Send>(threads: usize, items: &mut [T], each: &(impl Fn(usize, &mut T) + Sync)) {
    let (count, work) = (items.len(), Chunk::new(items, 1));
    with_threads(threads.min(count), || {
        for_blocks(threads, count, 1, work, &|first, _, piece: Chunk<'_, T>| {
            piece.data.iter_mut().for_each(|item| each(first, item));
        });
    });
}

/// Values below which a pass over a matrix stays on one thread.
pub(crate) const SMALL: usize = 1 << 13;

/// Runs `work` inside the current rayon pool and keeps up to `threads - 1` of its other threads awake until it is done:
/// the pieces of a small problem take less time than waking a thread that sleeps. For work of many short solves and
/// products, which do the same for themselves otherwise; with `threads` 0 or 1, or inside of such work, it is a plain
/// call. What stands by yields to every other thread that has something to do.
pub fn with_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    if threads <= 1 || ENGAGED.get() {
        return work();
    }
    let done = AtomicBool::new(false);
    rayon::scope(|scope| {
        for _ in 1..threads.min(rayon::current_num_threads()) {
            scope.spawn(|_| stand_by(&done));
        }
        let _end = End(&done);
        let _engaged = Engaged::new();
        work()
    })
}

thread_local! {
    /// Whether this thread is inside of `with_threads` or `stand_by`. One that is must not stand by for others: two
    /// runs that wait for each other's threads would wait for ever.
    static ENGAGED: Cell<bool> = const { Cell::new(false) };
}

/// Does pieces of work as they come, until all is done.
fn stand_by(done: &AtomicBool) {
    if ENGAGED.get() {
        return;
    }
    let _engaged = Engaged::new();
    while !done.load(Ordering::Acquire) {
        if rayon::yield_now() != Some(rayon::Yield::Executed) {
            (0..4).for_each(|_| std::hint::spin_loop());
            std::thread::yield_now();
        }
    }
}

/// Sets its flag when it goes, also when that is by a panic.
struct End<'a>(&'a AtomicBool);

impl Drop for End<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

struct Engaged;

impl Engaged {
    fn new() -> Self {
        ENGAGED.set(true);
        Self
    }
}

impl Drop for Engaged {
    fn drop(&mut self) {
        ENGAGED.set(false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_need_each_others_threads_end() {
        // More runs at once, and more threads each, than the pool has; some begin inside of others.
        let run = |seed: usize| {
            with_threads(4, || {
                let mut table = vec![0_usize; 400 * 64];
                for round in 0..50 {
                    for_rows(4, &mut table, 64, &|first, rows| {
                        rows.iter_mut().for_each(|value| *value += first * round + seed);
                    });
                    for_each(3, &mut table[..5], &|index, value| *value += index);
                }
                table.iter().sum::<usize>()
            })
        };
        let alone: Vec<usize> = (0..8).map(run).collect();
        let mut together = [0; 8];
        std::thread::scope(|scope| {
            for (seed, sum) in together.iter_mut().enumerate() {
                scope.spawn(move || *sum = run(seed));
            }
        });
        assert_eq!(alone, together);
        for_each(4, &mut together, &|seed, sum| *sum = run(seed));
        assert_eq!(alone, together);
    }

    #[test]
    fn every_row_and_item_is_met_once() {
        for rows in [1, 15, 16, 17, 290, 1500] {
            let mut table = vec![0.0; rows * 40];
            for_rows(3, &mut table, 40, &|first, block| {
                for (i, row) in block.chunks_exact_mut(40).enumerate() {
                    row.iter_mut().for_each(|value| *value += (first + i) as f32);
                }
            });
            assert!(table.iter().enumerate().all(|(at, &value)| value == (at / 40) as f32));
        }
        for_rows(2, &mut [0.0; 0], 0, &|_, _| unreachable!());
        let mut items = [0; 7];
        for_each(2, &mut items, &|index, item| *item = index + 1);
        assert_eq!(items, [1, 2, 3, 4, 5, 6, 7]);
        for_each(2, &mut [0; 0], &|_, _| unreachable!());
    }
}
