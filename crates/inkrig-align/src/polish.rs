//! The last steps: nearness to the clip alone.

use crate::coarse_to_fine::Buffers;
use crate::level::Level;
use crate::patches::patch_distances;
use crate::{AlignError, Options};
use inkrig_transport::{Plan, row_softmax};

/// Temperature of the polish steps, in units of the mean patch distance.
pub(crate) const POLISH_TEMPERATURE: f64 = 0.02;

/// Match-and-blend steps that look only at nearness: every output patch is drawn to the source patches that it is
/// most like, which takes out what averaging has blurred. Starts from, and takes, what is in the buffers.
pub(crate) fn polish(
    level: &Level<'_>,
    options: &Options,
    b: &mut Buffers,
    mut go_on: impl FnMut() -> Result<(), AlignError>,
) -> Result<Plan<f32>, AlignError> {
    let mut plan = b.transport.take_plan();
    for _ in 0..options.polish {
        go_on()?;
        let (motion, clip) = level.tables(&b.blended);
        patch_distances(motion, clip, level.source.scale, &mut b.scratch, &mut b.cost, options.threads)?;
        level.asked.steer(motion, clip, level.source.scale, &mut b.cost);
        let mut nearest = plan.into_mat();
        row_softmax(b.cost.view(), POLISH_TEMPERATURE, &mut nearest)?;
        let mass = 1.0 / nearest.rows() as f32;
        nearest.as_mut_slice().iter_mut().for_each(|value| *value *= mass);
        level.asked.impose(&mut nearest, b.cost.view());
        plan = Plan::from_mat(nearest);
        level.blend(plan.dense(), &mut b.weights, &mut b.blended, options.threads)?;
    }
    Ok(plan)
}
