//! What both solvers take from the gradient ("MAMM (SIGGRAPH 2025), Sec. 3.2.4"; the factor 2 of symmetric distances):
//!
//! `G = 2 alpha [(Dy^2 p) 1^T + 1 (Dx^2 c)^T - 2 Dy T Dx] + (1 - alpha) C + ...`,  squares elementwise, `c = T^T 1`.
//!
//! The first term is constant along a row and vanishes in the row normalisation, so it is never computed.

use crate::kernels::{Product, SquareProduct, dispatch};
use crate::parallel::{Chunk, PerBlock, block_rows, for_blocks};
use crate::{Problem, Real, Workspace};

/// `workspace.sums = Dx^2 c`.
pub(crate) fn square_product<T: Real>(workspace: &mut Workspace<T>) {
    let Workspace { source, mass, sums, threads, isa, .. } = workspace;
    let (m, stride) = (source.rows(), source.stride());
    let (all, mass) = (source.all(), mass.all());
    let out = Chunk::new(&mut sums.all_mut()[..m], 1);
    // Smaller than that a hand-over to another thread costs more than it saves.
    let threads = if m * m >= SMALL { *threads } else { 1 };
    for_blocks(threads, m, block_rows(m), out, &|first, count, out: Chunk<'_, T>| {
        let rows = &all[first * stride..(first + count) * stride];
        dispatch(*isa, SquareProduct { rows, mass, stride, out: out.data });
    });
}

/// Elements below which a pass over a matrix stays on one thread.
pub(crate) const SMALL: usize = 1 << 18;

/// For each block of rows: `Dy T Dx` into `workspace.kernel`, then `each(piece)` while it is in the cache.
pub(crate) fn products<T: Real>(
    problem: &Problem<'_, T>,
    workspace: &mut Workspace<T>,
    each: &(impl Fn(usize, usize, &mut [T], &mut [T]) + Sync),
) {
    let n = problem.rows();
    let block = workspace.block();
    let Workspace { transport, half, kernel, source, partial, threads, isa, .. } = workspace;
    let (stride, m) = (transport.stride(), source.rows());
    let (control, transport, source) = (problem.control().as_slice(), transport.all(), source.all());
    let skip = problem.params().alpha == 0.0;
    let work = (
        Chunk::new(half.all_mut(), stride),
        Chunk::new(kernel.all_mut(), stride),
        PerBlock::new(partial.all_mut(), stride, block),
    );
    type Piece<'a, T> = (Chunk<'a, T>, Chunk<'a, T>, PerBlock<'a, T>);
    for_blocks(*threads, n, block, work, &|first, rows, (half, kernel, sums): Piece<'_, T>| {
        if skip {
            kernel.data.fill(T::ZERO);
        } else {
            let control = &control[first * n..(first + rows) * n];
            Product { a: control, a_stride: n, b: transport, k: n, out: half.data, stride }.multiply(*isa);
            Product { a: half.data, a_stride: stride, b: source, k: m, out: kernel.data, stride }
                .multiply(*isa);
        }
        each(first, rows, kernel.data, sums.first());
    });
}

/// `out = ` the sum of the blocks' rows, in their order.
pub(crate) fn reduce<T: Real>(partial: &[T], out: &mut [T]) {
    let stride = out.len();
    for (b, row) in partial.chunks_exact(stride).enumerate() {
        if b == 0 {
            out.copy_from_slice(row);
        } else {
            out.iter_mut().zip(row).for_each(|(s, &x)| *s += x);
        }
    }
}
