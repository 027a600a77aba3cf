//! What both solvers take from the gradient ("MAMM (SIGGRAPH 2025), Sec. 3.2.4"; the factor 2 of symmetric distances):
//!
//! `G = 2 alpha [(Dy^2 p) 1^T + 1 (Dx^2 c)^T - 2 Dy T Dx] + (1 - alpha) C + ...`,  squares elementwise, `c = T^T 1`.
//!
//! The first term is constant along a row and vanishes in the row normalisation, so it is never computed.

use crate::factor_product::FactorBuffers;
use crate::kernels::{Product, SquareProduct, dispatch};
use crate::parallel::{Chunk, PerBlock, SMALL, block_rows, for_blocks};
use crate::{Distances, Problem, Real, Workspace};

/// `workspace.sums = Dx^2 c`.
pub(crate) fn square_product<T: Real>(problem: &Problem<'_, T>, workspace: &mut Workspace<T>) {
    let Workspace { source, mass, sums, factors, threads, isa, .. } = workspace;
    let m = problem.cols();
    if let Distances::LowRank(low) = problem.source() {
        return low.square_product(*isa, mass.row(0), factors, sums.row_mut(0));
    }
    let stride = source.stride();
    let (all, mass) = (source.all(), mass.all());
    let out = Chunk::new(&mut sums.all_mut()[..m], 1);
    // Smaller than that a hand-over to another thread costs more than it saves.
    let threads = if m * m >= SMALL { *threads } else { 1 };
    for_blocks(threads, m, block_rows(m), out, &|first, count, out: Chunk<'_, T>| {
        let rows = &all[first * stride..(first + count) * stride];
        dispatch(*isa, SquareProduct { rows, mass, stride, out: out.data });
    });
}

/// For each block of rows: `Dy T Dx` into `workspace.kernel`, then `each(piece)` while it is in the cache.
pub(crate) fn products<T: Real>(
    problem: &Problem<'_, T>,
    workspace: &mut Workspace<T>,
    each: &(impl Fn(usize, usize, &mut [T], &mut [T]) + Sync),
) {
    let n = problem.rows();
    let block = workspace.block();
    let Workspace { transport, half, kernel, source, factors, partial, threads, isa, .. } = workspace;
    let (stride, m) = (transport.stride(), problem.cols());
    let skip = problem.params().alpha == 0.0;
    let FactorBuffers { gathered, tall, .. } = factors;
    if let Distances::LowRank(low) = problem.control()
        && !skip
    {
        low.gather(*isa, *threads, transport, gathered);
    }
    let (transport, source, gathered) = (transport.all(), source.all(), gathered.all());
    let narrow = if let Distances::LowRank(_) = problem.source() { tall.stride() } else { 0 };
    let work = (
        (Chunk::new(half.all_mut(), stride), Chunk::new(tall.all_mut(), narrow)),
        Chunk::new(kernel.all_mut(), stride),
        PerBlock::new(partial.all_mut(), stride, block),
    );
    type Piece<'a, T> = ((Chunk<'a, T>, Chunk<'a, T>), Chunk<'a, T>, PerBlock<'a, T>);
    for_blocks(*threads, n, block, work, &|first, rows, ((half, tall), kernel, sums): Piece<'_, T>| {
        if skip {
            kernel.data.fill(T::ZERO);
        } else {
            match problem.control() {
                Distances::Dense(control) => {
                    let a = &control.as_slice()[first * n..(first + rows) * n];
                    Product { a, a_stride: n, b: transport, k: n, out: &mut *half.data, stride }
                        .multiply(*isa);
                }
                Distances::LowRank(low) => {
                    let plan = &transport[first * stride..];
                    low.rows_of_product(*isa, first, gathered, plan, half.data, stride);
                }
            }
            match problem.source() {
                Distances::Dense(_) => {
                    Product {
                        a: half.data,
                        a_stride: stride,
                        b: source,
                        k: m,
                        out: &mut *kernel.data,
                        stride,
                    }
                    .multiply(*isa);
                }
                Distances::LowRank(low) => {
                    low.product_of_rows(*isa, half.data, tall.data, kernel.data, stride);
                }
            }
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
