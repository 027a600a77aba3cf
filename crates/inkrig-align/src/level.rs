//! One level: rounds of matching and blending.

use crate::blend::{Window, frame_weights};
use crate::coarse_to_fine::Buffers;
use crate::explain::{Reflection, mirrored, others};
use crate::keys::{Keys, LevelKeys, LevelTables};
use crate::patches::patch_distances;
use crate::prepared::{LevelTable, Prepared};
use crate::pyramid::close_loop;
use crate::scouting::first_plan;
use crate::{AlignError, Layout, Norm, Options};
use inkrig_transport::{
    Distances, Mat, MatRef, MmSinkhorn, Params, Problem, Start, Workspace, matmul, matmul_transposed,
};
use std::borrow::Cow;

/// Both sides of one level, and what the keys ask there.
#[derive(Debug)]
pub(crate) struct Level<'a> {
    pub(crate) source: &'a LevelTable,
    pub(crate) control: &'a LevelTable,
    pub(crate) asked: LevelKeys,
}

impl<'a> Level<'a> {
    /// Level `index` of both sides, 0 is the coarsest.
    pub(crate) fn new(
        source: &'a Prepared,
        control: &'a Prepared,
        index: usize,
        keys: &Keys,
    ) -> Result<Self, AlignError> {
        let full = (control.layout(), source.layout());
        let (source, control) = (&source.levels()[index], &control.levels()[index]);
        let asked = keys.at_level(&LevelTables {
            full,
            level: (&control.layout, &source.layout),
            control: (control.frames.view(), control.scale),
            source: (source.frames.view(), source.scale),
        })?;
        Ok(Self { source, control, asked })
    }

    /// The first plan, from structure alone, and its motion; returns the gradients taken.
    pub(crate) fn begin(
        &self,
        options: &Options,
        b: &mut Buffers,
        tell: impl FnMut(usize) -> Result<(), AlignError>,
    ) -> Result<usize, AlignError> {
        let bias = self.bias(1.0);
        let problem = self.problem(&self.control.distances, None, bias.as_ref(), 1.0, options)?;
        let mut gradients = 0;
        if b.first.measure {
            b.first.symmetry = Some(Reflection::symmetry(&self.control.distances));
        }
        if let Some(plan) = b.first.given.take() {
            b.transport.resume(&plan);
        } else {
            gradients += first_plan(&problem, options, b, tell)?;
            if options.mirror {
                gradients += mirrored(self, &problem, options, b)?;
            }
            if b.first.wanted > 0 {
                others(self, &problem, options, b)?;
            }
        }
        self.blend(b.transport.plan().dense(), &mut b.weights, &mut b.blended, options.threads)?;
        Ok(gradients)
    }

    /// Matches and blends from the motion in the buffers, and leaves the new one there. The first round begins with
    /// `start`, every other with the plan before it. Returns the gradients taken; `tell` hears them after every round.
    pub(crate) fn rounds(
        &self,
        start: Start,
        options: &Options,
        b: &mut Buffers,
        mut tell: impl FnMut(usize) -> Result<(), AlignError>,
    ) -> Result<usize, AlignError> {
        self.asked.hold(&self.control.layout, &mut b.blended);
        let bias = self.bias(options.alpha);
        let mut distances = Cow::Borrowed(&self.control.distances);
        for round in 0..options.rounds {
            let (motion, clip) = self.tables(&b.blended);
            patch_distances(motion, clip, self.source.scale, &mut b.scratch, &mut b.cost, options.threads)?;
            let problem =
                self.problem(&distances, Some(b.cost.view()), bias.as_ref(), options.alpha, options)?;
            let start = if round == 0 { start } else { Start::Continue };
            let solver = MmSinkhorn { iterations: options.iterations, start, ..MmSinkhorn::default() };
            solver.solve(&problem, &mut b.transport)?;
            self.blend(b.transport.plan().dense(), &mut b.weights, &mut b.blended, options.threads)?;
            if options.control_norm == Norm::Learned {
                learn_scale(&b.transport, &self.source.distances, distances.to_mut(), options.threads)?;
            }
            tell((round + 1) * options.iterations)?;
        }
        Ok(options.rounds * options.iterations)
    }

    /// The motion that a plan makes of the source's frames, with the rows of the control's layout.
    pub(crate) fn blend(
        &self,
        plan: MatRef<'_, f32>,
        weights: &mut Mat<f32>,
        blended: &mut Mat<f32>,
        threads: usize,
    ) -> Result<(), AlignError> {
        frame_weights(plan, self.layouts(), Window::Box, weights, threads);
        matmul(weights.view(), self.source.frames.view(), blended, threads)?;
        close_loop(&self.control.layout, blended);
        self.asked.hold(&self.control.layout, blended);
        Ok(())
    }

    /// Of the control and of the source.
    pub(crate) fn layouts(&self) -> (&Layout, &Layout) {
        (&self.control.layout, &self.source.layout)
    }

    /// A motion of the control's layout, and the source's frames.
    pub(crate) fn tables<'b>(&'b self, motion: &'b Mat<f32>) -> (Table<'b>, Table<'b>) {
        let (rows, columns) = self.layouts();
        ((motion.view(), rows), (self.source.frames.view(), columns))
    }

    pub(crate) fn bias(&self, alpha: f64) -> Option<Mat<f32>> {
        let (rows, columns) = self.layouts();
        self.asked.cost(rows.patches(), columns.patches(), alpha)
    }

    pub(crate) fn problem<'b>(
        &'b self,
        distances: &'b Mat<f32>,
        cost: Option<MatRef<'b, f32>>,
        bias: Option<&'b Mat<f32>>,
        alpha: f64,
        options: &Options,
    ) -> Result<Problem<'b, f32>, AlignError> {
        let params = Params { alpha, lambda: options.lambda, epsilon: options.epsilon };
        let source = &self.source.distances;
        let (control, factors) = (&self.control.factors, &self.source.factors);
        let problem = Problem::with_distances(
            control.as_deref().map_or(distances.view().into(), Distances::from),
            factors.as_deref().map_or(source.view().into(), Distances::from),
            cost,
            params,
        )?;
        self.asked.bind(problem, bias)
    }
}

/// Frames and where their patches stand.
type Table<'a> = (MatRef<'a, f32>, &'a Layout);

/// Scales the control's distances by the factor that minimises the Gromov-Wasserstein term at the plan in the
/// workspace: sum of Dy (T Dx T^T) over sum of Dy^2 p p^T. Held within a factor of 4 of where it was, since a bad
/// plan can ask for anything.
fn learn_scale(
    transport: &Workspace<f32>,
    source: &Mat<f32>,
    control: &mut Mat<f32>,
    threads: usize,
) -> Result<(), AlignError> {
    let plan = transport.plan().dense();
    let (mut moved, mut carried) = (Mat::default(), Mat::default());
    matmul(plan, source.view(), &mut moved, threads)?;
    matmul_transposed(moved.view(), plan, &mut carried, threads)?;
    let mass = 1.0 / (plan.rows() as f64).powi(2);
    let (mut both, mut own) = (0.0, 0.0);
    for (&control, &carried) in control.as_slice().iter().zip(carried.as_slice()) {
        both += f64::from(control) * f64::from(carried);
        own += f64::from(control).powi(2) * mass;
    }
    let factor = (both / own).clamp(0.25, 4.0) as f32;
    if factor.is_finite() {
        control.as_mut_slice().iter_mut().for_each(|distance| *distance *= factor);
    }
    Ok(())
}
