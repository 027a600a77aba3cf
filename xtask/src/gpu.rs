//! `cargo xtask gpu-check`: whether the second engine's training form builds for graphics processors, and finds the gradient there that
//! it has to.

use anyhow::{Result, bail};
use std::time::Instant;

use crate::process;
use crate::tools::{self, Context};

/// The test that compares gradients; it says in one line what it ran on, or that there is nothing.
const TEST: &str = "device_gradients";

/// A feature of `inkrig-generate`, and what it needs.
struct Api {
    feature: &'static str,
    /// The program that a build needs, where it needs one, and what that comes with.
    tool: Option<(&'static str, &'static str)>,
    /// Whether this system can have such a device at all.
    possible: bool,
    /// What to do where no device is.
    driver: &'static str,
}

const APIS: [Api; 4] = [
    Api {
        feature: "wgpu",
        tool: None,
        possible: true,
        driver: "the driver of a graphics processor; without one, Mesa's lavapipe stands in (Debian: mesa-vulkan-drivers)",
    },
    Api {
        feature: "vulkan",
        tool: None,
        possible: true,
        driver: "the Vulkan driver of a graphics processor",
    },
    Api {
        feature: "cuda",
        tool: Some(("nvcc", "the CUDA toolkit")),
        possible: cfg!(not(target_os = "macos")),
        driver: "NVIDIA's driver",
    },
    Api { feature: "metal", tool: None, possible: cfg!(target_os = "macos"), driver: "a Mac with Metal" },
];

/// What became of one of them.
#[derive(Debug, PartialEq)]
enum Outcome {
    /// Not built: something is missing.
    Skipped(String),
    /// Built, but no device is there.
    NoDevice(String),
    /// Built, and gradients agree on this device.
    Compared(String),
}

/// Builds each and compares gradients, or says what is missing. Takes long: burn's compilers of shaders are large.
pub(crate) fn run(context: &Context) -> Result<()> {
    let mut said = Vec::new();
    for api in APIS.iter().filter(|api| api.possible) {
        let began = Instant::now();
        let outcome = match missing_tool(api, |program| tools::find_program(&[program]).is_some()) {
            Some(missing) => Outcome::Skipped(missing),
            None => compare(context, api)?,
        };
        said.push(format!("{} ({:.0} s)", line(api, &outcome), began.elapsed().as_secs_f64()));
        println!("{}", said.last().map_or("", |line| line));
    }
    println!("\ngpu-check:\n  {}", said.join("\n  "));
    Ok(())
}

fn missing_tool(api: &Api, found: impl Fn(&str) -> bool) -> Option<String> {
    let (program, from) = api.tool.filter(|(program, _)| !found(program))?;
    Some(format!("{program} is not in PATH: install {from}"))
}

fn compare(context: &Context, api: &Api) -> Result<Outcome> {
    let mut command = context.cargo(&["test"]);
    command.args(["--profile", "quick-build", "--package", "inkrig-generate", "--features", api.feature]);
    command.args(["--test", TEST, "--", "--nocapture"]);
    let (status, text) = process::tee(&mut command)?;
    if !status.success() {
        bail!("--features {} does not build, or finds other gradients: see above", api.feature);
    }
    outcome(api, &text)
}

/// By what the test said.
fn outcome(api: &Api, text: &str) -> Result<Outcome> {
    let ran = format!("{} (", api.feature);
    // A test's name may stand before what it says.
    let said = |start: &str| text.lines().find_map(|line| line.split_once(start).map(|(_, rest)| rest));
    if let Some((device, _)) = said(&ran).and_then(|rest| rest.split_once("), ")) {
        return Ok(Outcome::Compared(device.into()));
    }
    if said("skipped: ").is_some() {
        return Ok(Outcome::NoDevice(format!("install {}", api.driver)));
    }
    bail!("the test {TEST} did not say what it ran on with --features {}", api.feature);
}

fn line(api: &Api, outcome: &Outcome) -> String {
    let feature = api.feature;
    match outcome {
        Outcome::Skipped(missing) => format!("skipped: {feature}: {missing}"),
        Outcome::NoDevice(missing) => {
            format!("{feature}: builds; skipped: gradients, as no device is there: {missing}")
        }
        Outcome::Compared(device) => format!("{feature}: builds; gradients agree on {device}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_tool_is_named_with_what_it_comes_with() {
        let [_, vulkan, cuda, _] = &APIS;
        assert_eq!(missing_tool(vulkan, |_| false), None);
        assert_eq!(missing_tool(cuda, |program| program == "nvcc"), None);
        let missing = missing_tool(cuda, |_| false).unwrap();
        assert!(missing.contains("nvcc") && missing.contains("CUDA toolkit"), "{missing}");
        let said = line(cuda, &Outcome::Skipped(missing));
        assert!(said.starts_with("skipped: cuda: nvcc is not in PATH"), "{said}");
    }

    #[test]
    fn what_the_test_says_decides() {
        let [wgpu, ..] = &APIS;
        let cpu = "cpu (burn on the processor), small: 5 tensors\n";
        let on_device = format!("{cpu}test a ... wgpu (llvmpipe (LLVM 15, 256 bits)), small: 5 tensors\n");
        let compared = outcome(wgpu, &on_device).unwrap();
        assert_eq!(compared, Outcome::Compared("llvmpipe (LLVM 15, 256 bits)".into()));
        let without = outcome(wgpu, &format!("{cpu}skipped: no wgpu device is there\n")).unwrap();
        let said = line(wgpu, &without);
        assert!(said.contains("builds") && said.contains("mesa-vulkan-drivers"), "{said}");
        assert!(outcome(wgpu, cpu).is_err(), "a test that did not run is no pass");
    }
}
