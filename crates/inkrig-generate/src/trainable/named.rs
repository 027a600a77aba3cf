//! Weights of a module by their published names.

use crate::GenerateError;
use crate::weights::{Tensor as Plain, Tensors};
use burn::module::{Module, ModuleVisitor, Param};
use burn::tensor::{Device, Tensor, TensorData};

/// All weights of a module whose name in the state dictionary is `prefix`. Fields are named as in that dictionary; what
/// burn calls and lays out otherwise is changed here.
///
/// # Errors
/// When a device gives its numbers in another form.
pub fn to_tensors<M: Module>(module: &M, prefix: &str) -> Result<Tensors, GenerateError> {
    let mut names = Names { path: vec![prefix.to_owned()], tensors: Tensors::new(), unreadable: None };
    module.visit(&mut names);
    match names.unreadable {
        Some(name) => Err(GenerateError::MissingTensor { name }),
        None => Ok(names.tensors),
    }
}

/// A parameter of the shape that a module has it in.
pub(crate) fn parameter<const D: usize>(
    weights: &Tensors,
    name: &str,
    shape: [usize; D],
    device: &Device,
) -> Result<Param<Tensor<D>>, GenerateError> {
    let data = weights.expect(name, &shape)?.to_vec();
    Ok(Param::from_data(TensorData::new(data, shape), device))
}

/// A linear layer's weight, which burn has as inputs x outputs.
pub(crate) fn turned(
    weights: &Tensors,
    name: &str,
    outputs: usize,
    inputs: usize,
    device: &Device,
) -> Result<Param<Tensor<2>>, GenerateError> {
    let data = transpose(weights.expect(name, &[outputs, inputs])?, inputs);
    Ok(Param::from_data(TensorData::new(data, [inputs, outputs]), device))
}

struct Names {
    path: Vec<String>,
    tensors: Tensors,
    unreadable: Option<String>,
}

impl ModuleVisitor for Names {
    fn enter_module(&mut self, name: &str, _container_type: &str) {
        self.path.push(name.to_owned());
    }

    fn exit_module(&mut self, _name: &str, _container_type: &str) {
        self.path.pop();
    }

    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        let path = self.path.join(".");
        let tensor = param.val();
        let mut shape = tensor.dims().to_vec();
        let name = path.replace(".in_proj.", ".in_proj_").replace("gamma", "weight").replace("beta", "bias");
        let read = tensor.into_data().try_into_vec::<f32>().ok().and_then(|mut data| {
            if let ([inputs, outputs], true) = (&shape[..], path.ends_with("weight")) {
                data = transpose(&data, *outputs);
                shape = vec![*outputs, *inputs];
            }
            Plain::new(shape, data).ok()
        });
        match read {
            Some(tensor) => {
                self.tensors.insert(name, tensor);
            }
            None => self.unreadable = Some(name),
        }
    }
}

fn transpose(rows: &[f32], width: usize) -> Vec<f32> {
    (0..width).flat_map(|column| rows.iter().skip(column).step_by(width).copied()).collect()
}
