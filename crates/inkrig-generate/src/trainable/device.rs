//! What burn trains on.

use crate::GenerateError;
use burn::tensor::{Device, DeviceType};
use std::fmt;
#[cfg(any(feature = "wgpu", feature = "vulkan", feature = "cuda", feature = "metal"))]
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Kinds of devices that a build can train on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TrainingDeviceKind {
    /// burn's own arithmetic on the processor: for comparisons. [`crate::learning`] is quicker there.
    Cpu,
    /// A graphics processor through whatever driver there is, by shaders in WGSL.
    #[cfg(feature = "wgpu")]
    Wgpu,
    /// A graphics processor through Vulkan.
    #[cfg(feature = "vulkan")]
    Vulkan,
    /// One of NVIDIA through CUDA.
    #[cfg(feature = "cuda")]
    Cuda,
    /// One of Apple through Metal.
    #[cfg(feature = "metal")]
    Metal,
}

impl TrainingDeviceKind {
    /// Those of this build.
    pub const ALL: &'static [Self] = &[
        Self::Cpu,
        #[cfg(feature = "wgpu")]
        Self::Wgpu,
        #[cfg(feature = "vulkan")]
        Self::Vulkan,
        #[cfg(feature = "cuda")]
        Self::Cuda,
        #[cfg(feature = "metal")]
        Self::Metal,
    ];

    /// Whether a program may stand in for a device of this kind: burn's own SPIR-V makes Mesa's lavapipe crash (22.3 and 25.0), WGSL does not.
    fn may_stand_in(self) -> bool {
        #[cfg(feature = "vulkan")]
        if self == Self::Vulkan {
            return false;
        }
        true
    }

    fn listed(self) -> Vec<Device> {
        let kind = match self {
            Self::Cpu => DeviceType::Flex,
            #[cfg(feature = "wgpu")]
            Self::Wgpu => DeviceType::Wgpu,
            #[cfg(feature = "vulkan")]
            Self::Vulkan => DeviceType::Vulkan,
            #[cfg(feature = "cuda")]
            Self::Cuda => DeviceType::Cuda,
            #[cfg(feature = "metal")]
            Self::Metal => DeviceType::Metal,
        };
        Device::enumerate(kind).into_iter().collect()
    }
}

impl fmt::Display for TrainingDeviceKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Cpu => "cpu",
            #[cfg(feature = "wgpu")]
            Self::Wgpu => "wgpu",
            #[cfg(feature = "vulkan")]
            Self::Vulkan => "vulkan",
            #[cfg(feature = "cuda")]
            Self::Cuda => "cuda",
            #[cfg(feature = "metal")]
            Self::Metal => "metal",
        })
    }
}

/// A device that is there.
#[derive(Debug, Clone)]
pub struct TrainingDevice {
    device: Device,
    name: String,
}

impl TrainingDevice {
    /// The first of its kind, graphics processors before programs that stand in for one. What a driver says of itself counts; no work is
    /// done yet.
    ///
    /// # Errors
    /// [`GenerateError::NoDevice`] when there is none.
    pub fn open(kind: TrainingDeviceKind) -> Result<Self, GenerateError> {
        let found = kind.listed().into_iter().filter_map(|device| {
            let (stands_in, name) = identity(&device)?;
            Some((stands_in, Self { device, name }))
        });
        let found = found.filter(|(stands_in, _)| !stands_in || kind.may_stand_in());
        let first = found.min_by_key(|(stands_in, _)| *stands_in);
        first.map(|(_, device)| device).ok_or_else(|| GenerateError::NoDevice { kind: kind.to_string() })
    }

    /// As the driver says it.
    pub fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn burn(&self) -> &Device {
        &self.device
    }
}

/// Whether it is a program that stands in for a graphics processor, and its name. None of what a driver lists but cannot open, which
/// makes burn panic.
#[cfg(any(feature = "wgpu", feature = "vulkan", feature = "cuda", feature = "metal"))]
fn identity(device: &Device) -> Option<(bool, String)> {
    let identity = catch_unwind(AssertUnwindSafe(|| device.identity())).ok()?;
    Some(identity.map_or_else(on_processor, |identity| (identity.physical.is_none(), identity.name)))
}

#[cfg(not(any(feature = "wgpu", feature = "vulkan", feature = "cuda", feature = "metal")))]
#[allow(clippy::unnecessary_wraps, reason = "as where there are others")]
fn identity(_: &Device) -> Option<(bool, String)> {
    Some(on_processor())
}

fn on_processor() -> (bool, String) {
    (true, "burn on the processor".into())
}
