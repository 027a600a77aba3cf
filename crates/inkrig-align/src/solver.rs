//! Which solver takes which size.

use crate::prepared::level_layouts;
use crate::{AlignError, Layout, Options};
use serde::Serialize;

/// Frames at the matching rate that a clip or a control may have.
pub const MOST_FRAMES: usize = 100_000;

/// Frames for the solvers that hold tables of control x source: each then takes 64 MB.
pub const MOST_TABLE_FRAMES: usize = 4000;

/// Cells (control patches x source patches) up to which `auto` gives a plan all entries.
const MOST_FULL: usize = 4_000_000;
/// Patches of one side up to which its distances to itself are held in full: 64 MB.
const MOST_SIDE: usize = MOST_TABLE_FRAMES;
/// Patches of one side from which on `auto` takes its distances by factors in the solver.
const MOST_EXACT: usize = 1000;
/// Growth from one level to the next, at most, where the coarsest level has to be coarser than the options say.
const GROWTH: f64 = 1.6;

/// How the transport problems are solved.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Solver {
    /// By size: as [`Dense`](Self::Dense) up to about a thousand patches on each side, then as
    /// [`LowRank`](Self::LowRank), and beyond 4 million pairs of patches as [`Sparse`](Self::Sparse).
    #[default]
    Auto,
    /// All distances and all entries of the plan: exact; up to 4,000 frames, time grows with the cube.
    Dense,
    /// All entries of the plan, but distances by factors; up to 4,000 frames, time grows with the square.
    LowRank,
    /// Few entries in every row of the plan, at all levels but the coarsest: up to 100,000 frames.
    Sparse,
}

/// The layouts of control and source at one level.
pub(crate) type Pair = (Layout, Layout);

/// The levels of a run, coarsest first.
#[derive(Debug)]
pub(crate) struct Levels {
    /// Those whose plans have all entries.
    pub(crate) full: Vec<Pair>,
    /// Those with sparse plans.
    pub(crate) sparse: Vec<Pair>,
}

impl Solver {
    /// The most frames of a clip or a control.
    pub(crate) fn most_frames(self) -> usize {
        match self {
            Self::Auto | Self::Sparse => MOST_FRAMES,
            Self::Dense | Self::LowRank => MOST_TABLE_FRAMES,
        }
    }

    /// Whether a side of that many patches has its distances by factors.
    pub(crate) fn takes_factors(self, patches: usize) -> bool {
        match self {
            Self::Auto | Self::Sparse => patches > MOST_EXACT,
            Self::Dense => false,
            Self::LowRank => true,
        }
    }
}

impl Levels {
    /// The levels for a control and a source of these layouts.
    pub(crate) fn new((rows, columns): (&Layout, &Layout), options: &Options) -> Result<Self, AlignError> {
        let (mut ratio, mut count) = (options.ratio, options.levels);
        let mut all = loop {
            let of = |layout: &Layout| level_layouts(layout, count, ratio, options.patch());
            let all: Vec<Pair> = of(rows).into_iter().zip(of(columns)).collect();
            let limited = matches!(options.solver, Solver::Auto | Solver::Sparse);
            if !limited || all.first().is_none_or(is_full) {
                break all;
            }
            if ratio > 1e4 {
                // A patch as long as everything, or thousands of clips: no level is coarse enough.
                return Err(AlignError::NoCoarseLevel);
            }
            ratio *= 1.1;
            count = count.max(1 + (ratio.ln() / GROWTH.ln()).ceil() as usize);
        };
        let full = match options.solver {
            Solver::Dense | Solver::LowRank => all.len(),
            Solver::Auto => all.partition_point(is_full),
            Solver::Sparse => 1,
        };
        let sparse = all.split_off(full.min(all.len()));
        Ok(Self { full: all, sparse })
    }

    /// How many there are.
    pub(crate) fn count(&self) -> usize {
        self.full.len() + self.sparse.len()
    }

    /// Gradients that the whole run takes.
    pub(crate) fn gradients(&self, options: &Options) -> usize {
        options.gradients()
            + self.count().saturating_sub(options.levels) * options.rounds * options.iterations
    }
}

/// Whether a level's tables may be there as a whole: control x source, and each side with itself.
fn is_full((rows, columns): &Pair) -> bool {
    let (rows, columns) = (rows.patches(), columns.patches());
    rows.saturating_mul(columns) <= MOST_FULL && rows.max(columns) <= MOST_SIDE
}

/// What solved the finest level.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SolverRow {
    /// `"dense"`, `"low_rank"` or `"sparse"`.
    pub name: &'static str,
    /// Factors of each control patch, of each source patch; none where all distances were there.
    pub ranks: [Option<usize>; 2],
    /// Entries kept in a row of the plan before polish, on average.
    pub entries_per_row: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn levels(frames: [usize; 2], solver: Solver) -> (Vec<[usize; 2]>, usize) {
        let [rows, columns] = frames.map(|frames| Layout::open(frames, 11));
        let options = Options { solver, ..Options::default() };
        let levels = Levels::new((&rows, &columns), &options).unwrap();
        let all = levels.full.iter().chain(&levels.sparse);
        (all.map(|(rows, columns)| [rows.frames(), columns.frames()]).collect(), levels.full.len())
    }

    #[test]
    fn short_inputs_are_full_at_every_level_and_long_ones_at_the_coarse_ones() {
        let (lengths, full) = levels([300, 600], Solver::Auto);
        assert_eq!((lengths[0], lengths[5], full), ([75, 150], [300, 600], 6));
        let (lengths, full) = levels([10_000, 6000], Solver::Auto);
        assert_eq!((lengths[0], lengths[5], full), ([2500, 1500], [10_000, 6000], 1));
        let (lengths, full) = levels([4000, 3000], Solver::Auto);
        assert_eq!((lengths.len(), full), (6, 4), "1740 x 1305 and less are full");
        assert_eq!(levels([300, 600], Solver::Sparse).1, 1);
        assert_eq!(levels([4000, 4000], Solver::LowRank).1, 6);
    }

    #[test]
    fn the_longest_begin_coarser_and_take_more_levels() {
        let (lengths, full) = levels([100_000, 100_000], Solver::Auto);
        assert!(lengths[0][0] * lengths[0][1] <= 4_100_000 && full == 1, "{lengths:?}");
        assert!(lengths.windows(2).all(|pair| pair[1][0] as f64 <= 1.61 * pair[0][0] as f64), "{lengths:?}");
        let (lengths, _) = levels([100, 100_000], Solver::Auto);
        assert_eq!(lengths.last(), Some(&[100, 100_000]));
        // However short the other side is, none is held as a table of its own.
        for frames in [[20_000, 500], [500, 20_000], [100_000, 40], [8000, 450]] {
            for solver in [Solver::Auto, Solver::Sparse] {
                let (lengths, full) = levels(frames, solver);
                let longest = lengths[..full].iter().flatten().max();
                assert!(longest <= Some(&(MOST_SIDE + 10)) && full >= 1, "{frames:?}: {lengths:?}");
            }
        }
    }
}
