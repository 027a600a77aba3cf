//! `cargo xtask lan-test`: the studio drawn on from another device, both in network namespaces of this machine.

use std::process::{Command, Stdio, id};

use anyhow::Result;

use crate::step::Verdict;
use crate::tools::{Context, find_program};
use crate::{browser, demo, process, test, web};

/// Addresses that nobody else has on the wire between the two.
const STUDIO: &str = "10.77.13.1";
const TABLET: &str = "10.77.13.2";

/// Builds page and program, and drives them by a name of another machine: there the browser gives less to a page.
///
/// # Errors
/// When a build or the test fails.
pub(crate) fn check(context: &Context) -> Result<Verdict> {
    let (Some(node), Some(chromium)) = (browser::node(), browser::chromium()) else {
        return Ok(Verdict::Skipped(format!("not installed: {}", browser::missing_packages().join(", "))));
    };
    let Some(ip) = find_program(&["ip", "/usr/sbin/ip"]) else {
        return Ok(Verdict::Skipped("not installed: iproute2, whose `ip` makes network namespaces".into()));
    };
    let wire = match Wire::lay(&ip.to_string_lossy()) {
        Ok(wire) => wire,
        Err(why) => return Ok(Verdict::Skipped(format!("no network namespaces here: {why}"))),
    };
    let folder = web::build(context)?;
    process::run(context.cargo(&["build"]).args(["--release", "-p", "inkrig", "--bin", "inkrig"]))?;
    let target = context.target()?;
    let pictures = target.join("studio-lan");
    demo::empty(&pictures)?;
    let mut command = Command::new(&wire.ip);
    command.args(["netns", "exec", &wire.tablet]).arg(node).arg(folder.join("tests/lan.mjs"));
    command.arg(chromium).arg(&pictures).arg(STUDIO);
    command.arg(&wire.ip).args(["netns", "exec", &wire.studio]).arg(test::built_program(&target)?);
    process::run(&mut command)?;
    Ok(Verdict::Passed)
}

/// Two network namespaces and what joins them; gone when dropped.
struct Wire {
    ip: String,
    studio: String,
    tablet: String,
}

impl Wire {
    /// Needs root. Says what the system refused.
    fn lay(ip: &str) -> Result<Self, String> {
        let (studio, tablet) = (format!("inkrig-studio-{}", id()), format!("inkrig-tablet-{}", id()));
        // Made first, so that what was made is taken away whatever follows.
        let wire = Self { ip: ip.into(), studio, tablet };
        let (near, far) = (&wire.studio, &wire.tablet);
        wire.run(&["netns", "add", near])?;
        wire.run(&["netns", "add", far])?;
        let (a, b) = ("inkrig0", "inkrig1");
        wire.run(&["-n", near, "link", "add", a, "type", "veth", "peer", "name", b, "netns", far])?;
        for (space, link, address) in [(near, a, STUDIO), (far, b, TABLET)] {
            wire.run(&["-n", space, "address", "add", &format!("{address}/24"), "dev", link])?;
            wire.run(&["-n", space, "link", "set", link, "up"])?;
            wire.run(&["-n", space, "link", "set", "lo", "up"])?;
        }
        Ok(wire)
    }

    fn run(&self, arguments: &[&str]) -> Result<(), String> {
        let done = Command::new(&self.ip).args(arguments).stdin(Stdio::null()).output();
        let done = done.map_err(|error| error.to_string())?;
        if done.status.success() {
            return Ok(());
        }
        let said = String::from_utf8_lossy(&done.stderr);
        Err(format!("`ip {}` says: {}", arguments.join(" "), said.lines().next().unwrap_or("nothing")))
    }
}

impl Drop for Wire {
    fn drop(&mut self) {
        for space in [&self.studio, &self.tablet] {
            // One that was never made is not there to be deleted.
            let _ = self.run(&["netns", "delete", space]);
        }
    }
}
