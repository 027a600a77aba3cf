//! Weights of a module by their published names, and their gradients.

use crate::GenerateError;
use crate::weights::{Tensor as Plain, Tensors};
use burn::module::{Module, ModuleVisitor, Param};
use burn::tensor::{Device, Gradients, Tensor, TensorData, Transaction};

/// All weights of a module whose name in the state dictionary is `prefix`. Fields are named as in that dictionary; what
/// burn calls and lays out otherwise is changed here.
///
/// # Errors
/// When a device gives its numbers in another form.
pub fn to_tensors<M: Module>(module: &M, prefix: &str) -> Result<Tensors, GenerateError> {
    named(module, prefix, None)
}

/// Gradients of a module's weights, added to those of `weights`, which may hold those of other modules too: a row in the order of
/// [`Tensors::row`]. What has none is left as it is.
pub(crate) fn add_gradients<M: Module>(
    module: &M,
    prefix: &str,
    gradients: &Gradients,
    weights: &Tensors,
    row: &mut [f32],
) -> Result<(), GenerateError> {
    for (name, own) in named(module, prefix, Some(gradients))?.iter() {
        weights.expect(name, own.shape())?;
        let place = row.iter_mut().skip(weights.place(name));
        place.zip(own.data()).for_each(|(sum, part)| *sum += part);
    }
    Ok(())
}

/// A tensor of one number.
pub(crate) fn number(tensor: Tensor<1>) -> Result<f64, GenerateError> {
    let failed = |reason: String| GenerateError::Device { reason };
    tensor.try_into_scalar::<f32>().map(f64::from).map_err(|error| failed(error.to_string()))
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

/// The weights, or those gradients that there are; read all at once, as every reading waits for the device.
fn named<M: Module>(
    module: &M,
    prefix: &str,
    gradients: Option<&Gradients>,
) -> Result<Tensors, GenerateError> {
    let mut names = Names { path: vec![prefix.to_owned()], gradients, found: Vec::new(), reading: None };
    module.visit(&mut names);
    let failed = |reason: String| GenerateError::Device { reason };
    let numbers =
        names.reading.unwrap_or_default().try_execute().map_err(|error| failed(error.to_string()))?;
    let plain = |((path, mut shape), numbers): ((String, Vec<usize>), TensorData)| {
        let mut data = numbers.try_into_vec::<f32>().map_err(|error| failed(format!("{error:?}")))?;
        if let ([inputs, outputs], true) = (&shape[..], path.ends_with("weight")) {
            data = transpose(&data, *outputs);
            shape = vec![*outputs, *inputs];
        }
        let name = path.replace(".in_proj.", ".in_proj_").replace("gamma", "weight").replace("beta", "bias");
        Ok((name, Plain::new(shape, data)?))
    };
    names.found.into_iter().zip(numbers).map(plain).collect()
}

struct Names<'a> {
    path: Vec<String>,
    gradients: Option<&'a Gradients>,
    /// Paths and shapes of what is to be read.
    found: Vec<(String, Vec<usize>)>,
    reading: Option<Transaction>,
}

impl ModuleVisitor for Names<'_> {
    fn enter_module(&mut self, name: &str, _container_type: &str) {
        self.path.push(name.to_owned());
    }

    fn exit_module(&mut self, _name: &str, _container_type: &str) {
        self.path.pop();
    }

    fn visit_float<const D: usize>(&mut self, param: &Param<Tensor<D>>) {
        let tensor = match self.gradients {
            None => Some(param.val()),
            Some(gradients) => param.val().grad(gradients),
        };
        if let Some(tensor) = tensor {
            self.found.push((self.path.join("."), tensor.dims().to_vec()));
            self.reading = Some(self.reading.take().unwrap_or_default().register(tensor));
        }
    }
}

fn transpose(rows: &[f32], width: usize) -> Vec<f32> {
    (0..width).flat_map(|column| rows.iter().skip(column).step_by(width).copied()).collect()
}
