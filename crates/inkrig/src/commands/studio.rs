//! `inkrig studio`: the page on which one draws.

use super::settings::threads;
use super::studio_boards::Boards;
use crate::cli::StudioArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::{load, printable};
use inkrig_studio::{ServeOptions, Server, StudioError};
use serde::Serialize;
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::Arc;

/// What is said as JSON; the names are stable.
#[derive(Serialize)]
struct Record {
    address: String,
    project: String,
    page: bool,
}

pub(super) fn run(args: &StudioArgs, console: &Console) -> Result<(), CliError> {
    let studio = |cause: StudioError| CliError::Studio { cause: Box::new(cause) };
    // Before the project's folder is made: a name that is wrong leaves none.
    let files: Vec<(&Path, Vec<u8>)> = args
        .files
        .iter()
        .map(|file| Ok((file.as_path(), load::motion_bytes(file)?)))
        .collect::<Result<_, CliError>>()?;
    let server = Server::bind(ServeOptions {
        port: args.port,
        lan: args.lan,
        names: args.names.clone(),
        project: args.project.clone(),
        page: args.page.clone(),
        threads: threads(args.threads),
        storyboarder: Some(Arc::new(Boards::default())),
    })
    .map_err(studio)?;
    if args.files.is_empty() {
        server.studio().begin_with("person").map_err(studio)?;
    }
    for (file, bytes) in files {
        add(&server, file, &bytes, console)?;
    }
    console.goes_on_until_stopped();
    let address = server.address();
    console.say(format!("inkrig studio: {address}"))?;
    console
        .say(format!("project: {} (saved at every change; Ctrl+C ends)", printable::path(&args.project)))?;
    if !server.has_page() {
        console.warn("this inkrig was built without the studio's page: build it with `cargo xtask studio`");
    }
    console.result(&Record {
        address: address.clone(),
        project: printable::json_path(&args.project),
        page: server.has_page(),
    })?;
    let open = args.open;
    if open && !args.lan {
        show(&address, console);
    }
    let quiet = console.clone();
    let first = std::sync::atomic::AtomicBool::new(open);
    server
        .run(move |invitation| {
            // On this machine, too, only who has a token comes in.
            if first.swap(false, std::sync::atomic::Ordering::Relaxed) {
                show(&invitation.address, &quiet);
                return;
            }
            let _ = quiet.say(format!("\nfor one more device: {}\n{}", invitation.address, invitation.code));
        })
        .map_err(studio)
}

/// Adds a file as if it had been dropped on the page.
fn add(server: &Server, file: &Path, bytes: &[u8], console: &Console) -> Result<(), CliError> {
    let name = file.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    let warnings =
        server.add_file(&name, bytes).map_err(|cause| CliError::Studio { cause: Box::new(cause) })?;
    for warning in warnings {
        console.warn(format!("{}: {warning}", printable::path(file)));
    }
    Ok(())
}

/// Asks the system to show an address; it may have nothing to show it with.
fn show(address: &str, console: &Console) {
    let (program, first): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("cmd", &["/C", "start", ""])
    } else {
        ("xdg-open", &[])
    };
    let started = Command::new(program)
        .args(first)
        .arg(address)
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn();
    if started.is_err() {
        let _ = console.say(format!("open {address} in a browser"));
    }
}
