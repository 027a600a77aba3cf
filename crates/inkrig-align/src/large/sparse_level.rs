//! One level with a sparse plan: looking for what is missing, then rounds of matching and blending.

use super::nearest::Scores;
use super::side::Side;
use crate::blend::Window;
use crate::keys::{Keys, LevelKeys, LevelTables, Moved};
use crate::polish::POLISH_TEMPERATURE;
use crate::pyramid::close_loop;
use crate::solver::Pair;
use crate::{AlignError, FrameWeights, Frames, Layout, Norm, Options};
use inkrig_transport::{
    GradientRows, LowRank, Mat, MmSinkhorn, Params, Plan, Search, SparseProblem, SparseWorkspace, Start,
    Support, Terms,
};

/// Most source patches for one output patch.
const KEEP: usize = 128;
/// How far above a row's least gradient a source patch may be, in epsilons. With 8 the plans become much sharper than those
/// with all entries; from 16 on nothing changes.
const REACH: f64 = 16.0;
/// The same for the polish steps, in units of their temperature.
const POLISH_REACH: f64 = 10.0;
/// Cells of a plan (control patches x source patches) up to which all of them are looked at, which takes some seconds;
/// beyond, a plan stays near the coarser level's.
const MOST_SEARCHED: usize = 400_000_000;

/// Both sides of one level, and what the keys ask there.
pub(crate) struct SparseLevel<'a> {
    source: Side,
    control: Side,
    asked: LevelKeys,
    options: &'a Options,
}

/// A plan and the motion it makes.
pub(crate) struct Found {
    pub(crate) plan: Plan<f32>,
    /// With the rows of the control's layout.
    pub(crate) motion: Mat<f32>,
}

impl<'a> SparseLevel<'a> {
    pub(crate) fn new(
        source: Frames<'_>,
        control: Frames<'_>,
        (rows, columns): &Pair,
        keys: &Keys,
        options: &'a Options,
    ) -> Result<Self, AlignError> {
        let side = |frames, layout, norm| Side::new(frames, layout, norm, options.threads);
        let clip = side(source, columns, options.source_norm)?.ok_or(AlignError::StillClip)?;
        let drawn = side(control, rows, options.control_norm)?.ok_or(AlignError::StillControl)?;
        let asked = keys.at_level(&LevelTables {
            full: (control.layout, source.layout),
            level: (rows, columns),
            control: (drawn.frames.view(), drawn.scale),
            source: (clip.frames.view(), clip.scale),
        })?;
        Ok(Self { source: clip, control: drawn, asked, options })
    }

    /// Matches and blends from a plan and a motion on; `tell` hears the gradients taken after every round.
    pub(crate) fn rounds(
        &self,
        mut found: Found,
        workspace: &mut SparseWorkspace<f32>,
        mut tell: impl FnMut(usize) -> Result<(), AlignError>,
    ) -> Result<Found, AlignError> {
        let options = self.options;
        self.asked.hold(&self.control.layout, &mut found.motion);
        let mut support = self.asked.opened(found.plan.support().cloned().unwrap_or_default())?;
        let mut cost = Vec::new();
        let mut scaled: Option<LowRank<f32>> = None;
        workspace.resume(&found.plan);
        if self.is_searched() {
            self.costs(&found.motion, &support, &mut cost)?;
            let problem = self.problem(&self.control.distances, &support, &cost, None)?;
            let gradient = workspace.gradient(&problem)?;
            let (alpha, reach) = (options.alpha, REACH * options.epsilon);
            let nothing = Moved::default();
            let weight = (1.0 - alpha) as f32;
            let scores = self.scores(&found.motion, Some((&gradient, alpha)), weight, &nothing);
            support = scores.search(self.search(reach))?;
        }
        let bias = self.asked.costs_at(&support, options.alpha);
        let learned = options.control_norm == Norm::Learned;
        for round in 0..options.rounds {
            self.costs(&found.motion, &support, &mut cost)?;
            let distances = scaled.as_ref().unwrap_or(&self.control.distances);
            let problem = self.problem(distances, &support, &cost, bias.as_deref())?;
            let (iterations, start) = (options.iterations, Start::Continue);
            let trace = if learned { usize::MAX } else { 0 };
            let solver = MmSinkhorn { iterations, start, trace, ..MmSinkhorn::default() };
            let trace = solver.solve_sparse(&problem, workspace)?;
            found.plan = workspace.take_plan();
            self.blend(&found.plan, &mut found.motion)?;
            if let (true, Some(terms)) = (learned, trace.last()) {
                let factor = self.learned_factor(distances, &found.plan, terms);
                let mut copy = distances.clone();
                copy.scale(factor)?;
                scaled = Some(copy);
            }
            tell((round + 1) * options.iterations)?;
        }
        Ok(found)
    }

    /// Steps that look only at nearness to the clip: see [`polish`](crate::polish).
    pub(crate) fn polish(
        &self,
        mut found: Found,
        mut go_on: impl FnMut() -> Result<(), AlignError>,
    ) -> Result<Found, AlignError> {
        let mut cost = Vec::new();
        for _ in 0..self.options.polish {
            go_on()?;
            let moved = self.asked.moved((found.motion.view(), &self.control.layout), self.source.scale);
            let support = if self.is_searched() {
                let search = self.search(POLISH_REACH * POLISH_TEMPERATURE);
                self.scores(&found.motion, None, 1.0, &moved).search(search)?
            } else {
                self.asked.opened(found.plan.support().cloned().unwrap_or_default())?
            };
            self.costs(&found.motion, &support, &mut cost)?;
            self.steer(&moved, &support, &mut cost);
            let mass = 1.0 / support.rows() as f32;
            for row in 0..support.rows() {
                soften(&mut cost[support.range(row)], POLISH_TEMPERATURE as f32, mass);
            }
            found.plan = Plan::from_support(support, std::mem::take(&mut cost))?;
            self.blend(&found.plan, &mut found.motion)?;
        }
        Ok(found)
    }

    /// Of the control and of the source.
    pub(crate) fn layouts(&self) -> (&Layout, &Layout) {
        (&self.control.layout, &self.source.layout)
    }

    /// Factors of a control patch and of a source patch.
    pub(crate) fn ranks(&self) -> [usize; 2] {
        [self.control.distances.rank(), self.source.distances.rank()]
    }

    /// Best sources of a coarse row to begin with: fewer where the support stays what they make of it.
    pub(crate) fn taken_over(&self) -> usize {
        if self.is_searched() { 48 } else { 16 }
    }

    fn is_searched(&self) -> bool {
        self.control.layout.patches().saturating_mul(self.source.layout.patches()) <= MOST_SEARCHED
    }

    fn scores<'b>(
        &'b self,
        motion: &'b Mat<f32>,
        gradient: Option<(&'b GradientRows<'b, f32>, f64)>,
        weight: f32,
        moved: &'b Moved,
    ) -> Scores<'b> {
        Scores {
            motion,
            rows: &self.control.layout,
            source: &self.source,
            weight,
            gradient,
            asked: &self.asked,
            moved,
        }
    }

    fn search(&self, reach: f64) -> Search {
        Search { keep: KEEP, reach, threads: self.options.threads }
    }

    fn problem<'b>(
        &'b self,
        control: &'b LowRank<f32>,
        support: &'b Support,
        cost: &'b [f32],
        bias: Option<&'b [f32]>,
    ) -> Result<SparseProblem<'b, f32>, AlignError> {
        let Options { alpha, lambda, epsilon, .. } = *self.options;
        let params = Params { alpha, lambda, epsilon };
        let problem = SparseProblem::new(control, &self.source.distances, support, Some(cost), params)?;
        self.asked.bind_sparse(problem, bias)
    }

    fn costs(&self, motion: &Mat<f32>, support: &Support, out: &mut Vec<f32>) -> Result<(), AlignError> {
        let (own, clip) = (self.control.windows(motion)?, self.source.patches()?);
        Ok(own.distances_at(&clip, support, self.source.scale, self.options.threads, out)?)
    }

    /// Brings the costs of polish at the entries to those of [`LevelKeys::steer`].
    fn steer(&self, moved: &Moved, support: &Support, cost: &mut [f32]) {
        let clip = (self.source.frames.view(), &self.source.layout);
        for row in moved.rows() {
            if let Some(distances) = moved.distances(row, clip, self.source.scale) {
                let entries = cost[support.range(row)].iter_mut().zip(support.row(row));
                entries.for_each(|(cost, &column)| *cost = distances[column as usize]);
            }
        }
        let avoided = self.asked.avoided();
        for row in (0..support.rows()).filter(|_| !avoided.is_empty()) {
            let entries = cost[support.range(row)].iter_mut().zip(support.row(row));
            entries.for_each(|(cost, &column)| *cost += avoided[column as usize]);
        }
    }

    /// Source frames that may not appear.
    pub(crate) fn forbidden_frames(&self) -> Vec<usize> {
        self.asked.forbidden_frames(&self.source.layout)
    }

    fn blend(&self, plan: &Plan<f32>, motion: &mut Mat<f32>) -> Result<(), AlignError> {
        let weights = FrameWeights::of_plan(plan, self.layouts(), Window::Box)?;
        weights.blend(self.source.frames.view(), self.options.threads, motion)?;
        close_loop(&self.control.layout, motion);
        self.asked.hold(&self.control.layout, motion);
        Ok(())
    }

    /// The factor of the control's distances that minimises the Gromov-Wasserstein term at a plan whose terms are known, as
    /// for [`Norm::Learned`] elsewhere.
    fn learned_factor(&self, control: &LowRank<f32>, plan: &Plan<f32>, terms: Terms) -> f64 {
        let own = control.square_form(&vec![1.0 / plan.rows() as f64; plan.rows()]);
        let mass: Vec<f64> = plan.column_mass().iter().map(|&mass| f64::from(mass)).collect();
        let both = 0.5 * (own + self.source.distances.square_form(&mass) - terms.gw);
        let factor = (both / own).clamp(0.25, 4.0);
        if factor.is_finite() { factor } else { 1.0 }
    }
}

/// Costs of a row to its plan: `softmax(-cost / temperature)`, of sum `mass`.
fn soften(row: &mut [f32], temperature: f32, mass: f32) {
    let least = row.iter().copied().fold(f32::INFINITY, f32::min);
    row.iter_mut().for_each(|cost| *cost = (-(*cost - least) / temperature).exp());
    let scale = mass / row.iter().sum::<f32>();
    row.iter_mut().for_each(|share| *share *= scale);
}
