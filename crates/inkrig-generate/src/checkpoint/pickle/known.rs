//! The names that a pickle may use.

use crate::checkpoint::number::NumberKind;

/// Something of Python or PyTorch that describes data.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::checkpoint) enum Known {
    /// `collections.OrderedDict`
    OrderedDict,
    /// Lists, sets and `torch.Size`: made of a list.
    List,
    /// `torch._utils._rebuild_tensor` and `_rebuild_tensor_v2`
    Tensor,
    /// `torch._utils._rebuild_parameter` and the like: a tensor comes first.
    Parameter,
    /// A class such as `torch.FloatStorage`; `None` for one that says its kind elsewhere.
    Storage(NumberKind),
    /// A constant without meaning here, such as `torch.float32`.
    Constant,
}

impl Known {
    /// By module and name, if it is one of these.
    pub(super) fn find(module: &str, name: &str) -> Option<Self> {
        Some(match (module, name) {
            ("collections", "OrderedDict") => Self::OrderedDict,
            ("builtins" | "__builtin__", "list" | "tuple" | "set" | "frozenset") | ("torch", "Size") => {
                Self::List
            }
            ("torch._utils", "_rebuild_tensor" | "_rebuild_tensor_v2") => Self::Tensor,
            ("torch._utils", "_rebuild_parameter" | "_rebuild_parameter_with_state") => Self::Parameter,
            ("torch" | "torch.cuda", name) if name.ends_with("Storage") => {
                Self::Storage(NumberKind::of_storage(name)?)
            }
            (
                "torch",
                "float32" | "float16" | "bfloat16" | "float64" | "int64" | "int32" | "int16" | "int8"
                | "uint8" | "bool",
            ) => Self::Constant,
            _ => return None,
        })
    }
}
