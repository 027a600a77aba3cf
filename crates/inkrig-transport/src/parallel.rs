//! Rows in fixed blocks. A block's bounds depend on the number of rows alone, and sums over blocks are taken in
//! their order, so that the number of threads never shows in a result.

/// Rows of one block.
pub(crate) fn block_rows(rows: usize) -> usize {
    // A multiple of 8, the height of the product's tiles; at least 80 so that a product reads its right side from the cache often enough.
    (rows.div_ceil(16).next_multiple_of(8)).clamp(80, 192)
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
        let at = ((count * left).div_ceil(threads)).clamp(1, count - 1) * block;
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

/// Runs `work` inside the thread pool when it will split itself, so that each split costs no wake-up from outside.
pub(crate) fn enter<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    if threads > 1 && rayon::current_thread_index().is_none() { rayon::join(work, || ()).0 } else { work() }
}
