//! The weights of a module as one row of numbers, and back.

use crate::TrainError;
use burn::module::{Module, ModuleMapper, ModuleVisitor, Param};
use burn::tensor::{Gradients, Tensor, TensorData};

/// All weights, in the order in which the module visits them.
pub(super) fn numbers<M: Module>(module: &M) -> Result<Vec<f32>, TrainError> {
    let mut reader = Reader { gradients: None, row: Vec::new(), unreadable: false };
    module.visit(&mut reader);
    reader.finish()
}

/// The gradients of all weights in the same order; zeros where there is none.
pub(super) fn gradient<M: Module>(module: &M, gradients: &Gradients) -> Result<Vec<f32>, TrainError> {
    let mut reader = Reader { gradients: Some(gradients), row: Vec::new(), unreadable: false };
    module.visit(&mut reader);
    reader.finish()
}

/// The module with other weights.
pub(super) fn with_numbers<M: Module>(module: M, row: &[f32]) -> Result<M, TrainError> {
    let mut writer = Writer { row, short: false };
    let module = module.map(&mut writer);
    if writer.short || !writer.row.is_empty() {
        return Err(TrainError::Device(
            "a checkpoint holds another number of weights than the network".into(),
        ));
    }
    Ok(module)
}

struct Reader<'a> {
    gradients: Option<&'a Gradients>,
    row: Vec<f32>,
    unreadable: bool,
}

impl Reader<'_> {
    fn finish(self) -> Result<Vec<f32>, TrainError> {
        if self.unreadable {
            return Err(TrainError::Device("the device gives its numbers in another form than f32".into()));
        }
        Ok(self.row)
    }
}

impl ModuleVisitor for Reader<'_> {
    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        let tensor = param.val();
        let tensor = match self.gradients {
            None => Some(tensor),
            Some(gradients) => match tensor.grad(gradients) {
                Some(gradient) => Some(gradient),
                None => {
                    self.row.extend(std::iter::repeat_n(0.0, tensor.dims().iter().product()));
                    None
                }
            },
        };
        match tensor.map(|tensor| tensor.into_data().try_into_vec::<f32>()) {
            None => {}
            Some(Ok(numbers)) => self.row.extend(numbers),
            Some(Err(_)) => self.unreadable = true,
        }
    }
}

struct Writer<'a> {
    row: &'a [f32],
    short: bool,
}

impl ModuleMapper for Writer<'_> {
    fn map_float<const D: usize>(&mut self, param: Param<Tensor<D>>) -> Param<Tensor<D>> {
        param.map(|tensor| {
            let shape = tensor.dims();
            let Some((own, rest)) = self.row.split_at_checked(shape.iter().product()) else {
                self.short = true;
                return tensor;
            };
            self.row = rest;
            let data = TensorData::new(own.to_vec(), shape);
            Tensor::from_data(data, &tensor.device()).require_grad()
        })
    }
}
