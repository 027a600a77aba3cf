//! The gradient at the entries of a sparse plan. With `D = A B^T - diag(excess)` on both sides,
//!
//! `Dy T Dx = By (Dx T^T Ay)^T - excess_y T Dx`,  `T Dx = (T Ax) Bx^T - T excess_x`,
//!
//! so that each entry is an inner product of 2 k values and no array is larger than the support or (N + M) k.

use crate::factor_product::GATHER_ROWS;
use crate::gradient::reduce;
use crate::kernels::{Block, EntryDots, Gather, LessRows, Product, dispatch};
use crate::objective::divergence;
use crate::parallel::{self, Chunk, PerBlock, Ragged, for_blocks};
use crate::sparse_workspace::block_rows;
use crate::{Real, SparseProblem, SparseWorkspace, Terms};

/// For each block of rows: `Dy T Dx` at its entries into `workspace.kernel`, then `each(block, first entry, values, sums)`.
pub(crate) fn products<T: Real>(
    problem: &SparseProblem<'_, T>,
    workspace: &mut SparseWorkspace<T>,
    each: &(impl Fn(Block<'_>, usize, &mut [T], &mut [T]) + Sync),
) {
    let skip = problem.params.alpha == 0.0;
    if !skip {
        thin_products(problem, workspace);
    }
    let n = problem.rows();
    let block = block_rows(n);
    let SparseWorkspace { entries, transport, kernel, left, right, partial, threads, isa, .. } = workspace;
    let (starts, columns) = (entries.starts(), entries.columns());
    let (stride, wide) = (left.stride(), partial.stride());
    let (left, right, plan) = (left.all(), right.all(), &transport[..]);
    let (row_excess, column_excess) = (problem.control.excess.row(0), problem.source.excess.row(0));
    let work = (Ragged { data: kernel, starts }, PerBlock::new(partial.all_mut(), wide, block));
    type Piece<'a, T> = (Ragged<'a, T>, PerBlock<'a, T>);
    for_blocks(*threads, n, block, work, &|first, rows, (values, sums): Piece<'_, T>| {
        let at = starts[first]..starts[first + rows];
        let block = Block { starts: &starts[first..=first + rows], columns: &columns[at.clone()] };
        if skip {
            values.data.fill(T::ZERO);
        } else {
            let (plan, left) = (&plan[at.clone()], &left[first * stride..(first + rows) * stride]);
            let (row_excess, out) = (&row_excess[first..], &mut *values.data);
            dispatch(*isa, EntryDots { block, plan, left, right, stride, row_excess, column_excess, out });
        }
        each(block, at.start, values.data, sums.first());
    });
}

/// `T Ax` into `workspace.left`, `Dx T^T Ay` into `workspace.right`.
pub(crate) fn thin_products<T: Real>(problem: &SparseProblem<'_, T>, workspace: &mut SparseWorkspace<T>) {
    let (n, m, block) = (problem.rows(), problem.cols(), block_rows(problem.rows()));
    let (control, source) = (problem.control, problem.source);
    let (ky, kx) = (control.left.cols(), source.left.cols());
    let SparseWorkspace {
        entries,
        transport,
        left,
        right,
        gathered,
        gathered_parts,
        core,
        spread,
        tall,
        threads,
        isa,
        ..
    } = workspace;
    let (starts, columns) = (entries.starts(), entries.columns());
    let (stride, wide, narrow) = (left.stride(), gathered.stride(), tall.stride());
    let work = (
        Chunk::new(left.all_mut(), stride),
        PerBlock::new(&mut gathered_parts[..], m * wide, block),
        PerBlock::new(tall.all_mut(), narrow, block),
    );
    type Piece<'a, T> = (Chunk<'a, T>, PerBlock<'a, T>, PerBlock<'a, T>);
    for_blocks(*threads, n, block, work, &|first, rows, (left, sums, tall): Piece<'_, T>| {
        let at = starts[first]..starts[first + rows];
        let block = Block { starts: &starts[first..=first + rows], columns: &columns[at.clone()] };
        let gather = Gather {
            block,
            plan: &transport[at],
            control: &control.left.all()[first * wide..(first + rows) * wide],
            rows_stride: wide,
            source: source.left.all(),
            columns_stride: narrow,
            excess: &control.excess.row(0)[first..],
            tall: tall.first(),
            left: left.data,
            left_stride: stride,
            place: ky..ky + kx,
            gathered: sums.first(),
        };
        dispatch(*isa, gather);
    });
    reduce(gathered_parts, gathered.all_mut());
    let (gathered, bt, a) = (gathered.all(), &source.right, &source.left);
    let out = Chunk::new(core.all_mut(), wide);
    for_blocks(*threads, kx, GATHER_ROWS, out, &|first, _, out: Chunk<'_, T>| {
        let rows = &bt.all()[first * bt.stride()..];
        Product { a: rows, a_stride: bt.stride(), b: gathered, k: m, out: out.data, stride: wide }
            .multiply(*isa);
    });
    let (core, right_stride) = (core.all(), right.stride());
    let out = (Chunk::new(spread.all_mut(), wide), Chunk::new(right.all_mut(), right_stride));
    type Rows<'a, T> = (Chunk<'a, T>, Chunk<'a, T>);
    for_blocks(*threads, m, parallel::block_rows(m), out, &|first, _, (spread, right): Rows<'_, T>| {
        let rows = &a.all()[first * narrow..];
        Product { a: rows, a_stride: narrow, b: core, k: kx, out: &mut *spread.data, stride: wide }
            .multiply(*isa);
        let (x, weights) = (&gathered[first * wide..], &source.excess.row(0)[first..]);
        dispatch(*isa, LessRows { out: &mut *spread.data, x, weights, stride: wide });
        let rows = right.data.chunks_exact_mut(right_stride).zip(spread.data.chunks_exact(wide));
        rows.for_each(|(right, spread)| right[..ky].copy_from_slice(&spread[..ky]));
    });
}

/// The terms of the current plan; costs a gradient.
pub(crate) fn terms<T: Real>(problem: &SparseProblem<'_, T>, workspace: &mut SparseWorkspace<T>) -> Terms {
    products(problem, workspace, &|_, _, _, _| ());
    let SparseWorkspace { entries, transport, kernel, linear, .. } = workspace;
    let (mut row_mass, mut column_mass) = (vec![0.0f64; problem.rows()], vec![0.0f64; problem.cols()]);
    let (mut cross, mut total, mut bias, mut entropy) = (0.0, 0.0, 0.0, 0.0);
    for (i, row_mass) in row_mass.iter_mut().enumerate() {
        let (from, columns) = (problem.support.range(i).start, problem.support.row(i));
        for (e, j) in entries.range(i).zip(entries.row(i)) {
            let t = transport[e].to_f64();
            *row_mass += t;
            column_mass[*j as usize] += t;
            cross += t * kernel[e].to_f64();
            total += t * linear[e].to_f64();
            if t > 0.0 {
                entropy -= t * t.ln();
            }
            if let (Some(values), Ok(at)) = (problem.linear, columns.binary_search(j)) {
                bias += t * values[from + at].to_f64();
            }
        }
    }
    let squares = problem.control.square_form(&row_mass) + problem.source.square_form(&column_mass);
    let share = 1.0 - problem.params.alpha;
    let parts = Terms {
        objective: 0.0,
        gw: squares - 2.0 * cross,
        w: if share > 0.0 { (total - bias) / share } else { 0.0 },
        linear: bias,
        kl: divergence(&mut column_mass, problem.mask, problem.allowed),
        entropy,
    };
    parts.weighed(problem.params)
}
