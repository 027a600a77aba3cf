//! What can be said about the file that tells how a result was made, for every command that writes a motion.

use clap::Args;

/// The record beside a result.
#[derive(Debug, Clone, Args)]
pub struct SidecarArgs {
    /// Do not write OUT.inkrig.json beside the result, which says how it was made (see inkrig redo)
    #[arg(long, help_heading = "More results")]
    pub no_sidecar: bool,
    /// Under which licence you use the inputs, where they do not say it themselves; kept in OUT.inkrig.json
    #[arg(long, value_name = "TEXT", help_heading = "More results", conflicts_with = "no_sidecar")]
    pub licence_note: Option<String>,
}
