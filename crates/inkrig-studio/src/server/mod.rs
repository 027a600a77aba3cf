//! The server: where it listens, and what it tells of it.

mod address;
mod connections;
mod qr;

pub(crate) use connections::Connection;

use crate::api::ApiError;
use crate::guard::{Guard, Tokens};
use crate::storyboard::Storyboarder;
use crate::{Studio, StudioError, api, page};
use axum::Router;
use axum::middleware::from_fn_with_state;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::path::PathBuf;
use std::sync::Arc;
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Uploads that are held at once: each may have 64 MiB.
const UPLOADS: usize = 4;

/// Where and how to serve.
#[derive(Debug, Clone)]
pub struct ServeOptions {
    /// Port; 0 takes any that is free.
    pub port: u16,
    /// Serve the local network too, to devices that show a token.
    pub lan: bool,
    /// Further names under which the page may be opened.
    pub names: Vec<String>,
    /// Folder of the project; made if it is not there.
    pub project: PathBuf,
    /// Folder of the page, instead of the one that is built in.
    pub page: Option<PathBuf>,
    /// Threads that solve, at least 1.
    pub threads: usize,
    /// What makes animations of storyboards, where the program can.
    pub storyboarder: Option<Arc<dyn Storyboarder>>,
}

/// What every request can reach.
#[derive(Debug)]
pub(crate) struct App {
    pub(crate) studio: Arc<Studio>,
    pub(crate) guard: Guard,
    pub(crate) page: Option<PathBuf>,
    pub(crate) live_places: Arc<Semaphore>,
    uploads: Arc<Semaphore>,
}

impl App {
    /// Waits until there is room for an upload.
    pub(crate) async fn upload_turn(&self) -> Result<OwnedSemaphorePermit, ApiError> {
        let turn = self.uploads.clone().acquire_owned().await;
        turn.map_err(|error| StudioError::Internal(error.to_string()).into())
    }
}

/// A server that listens.
#[derive(Debug)]
pub struct Server {
    listener: std::net::TcpListener,
    address: SocketAddr,
    studio: Arc<Studio>,
    options: ServeOptions,
}

/// An address for a device, and its code for a camera.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Invitation {
    /// With a token that is good once.
    pub address: String,
    /// As blocks of text, dark on light; empty when it is too long.
    pub code: String,
}

impl Server {
    /// Opens the project and the port.
    ///
    /// # Errors
    /// When one of them cannot be opened.
    pub fn bind(options: ServeOptions) -> Result<Self, StudioError> {
        let ip = if options.lan { Ipv4Addr::UNSPECIFIED } else { Ipv4Addr::LOCALHOST };
        let failed = |cause| StudioError::Listen { port: options.port, cause };
        let listener =
            std::net::TcpListener::bind(SocketAddr::new(IpAddr::V4(ip), options.port)).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        let studio = Studio::open(&options.project, options.threads.max(1), options.storyboarder.clone())?;
        Ok(Self { listener, address, studio, options })
    }

    /// The studio, for what shall be in it before anybody opens it.
    pub fn studio(&self) -> &Arc<Studio> {
        &self.studio
    }

    /// Adds a file as if it had been dropped on the page: a motion, a sound, or a drawing, which is followed then. Returns what
    /// is odd in it.
    ///
    /// # Errors
    /// When its name says no known kind, or it is not understood.
    pub fn add_file(&self, name: &str, bytes: &[u8]) -> Result<Vec<String>, StudioError> {
        self.studio.add_file(name, bytes)
    }

    /// The address on this machine; with `lan` it has to be opened by an invitation.
    pub fn address(&self) -> String {
        format!("http://127.0.0.1:{}/", self.address.port())
    }

    /// Whether the program has its page.
    pub fn has_page(&self) -> bool {
        self.options.page.is_some() || page::is_there()
    }

    /// Serves until the program ends. `invite` is called with an invitation whenever there is a new one, with `lan` only: at
    /// once, and after each was used.
    ///
    /// # Errors
    /// When the system gives no threads, no randomness or no connection.
    pub fn run(self, invite: impl Fn(Invitation) + Send + Sync + 'static) -> Result<(), StudioError> {
        let Self { listener, address, studio, options } = self;
        let port = address.port();
        let internal = |what: String| StudioError::Internal(what);
        let mut names = options.names;
        let tokens = if options.lan {
            let host = names.first().cloned().unwrap_or_else(address::of_this_machine);
            names.extend(address::names());
            let announce = move |token: &str| {
                let address = format!("http://{host}:{port}/?token={token}");
                let code = qr::code(&address);
                invite(Invitation { address, code });
            };
            Some(Tokens::new(announce).map_err(internal)?)
        } else {
            None
        };
        let app = Arc::new(App {
            studio,
            guard: Guard::new(port, names, tokens),
            page: options.page,
            live_places: api::live_places(),
            uploads: Arc::new(Semaphore::new(UPLOADS)),
        });
        let runtime = tokio::runtime::Builder::new_multi_thread()
            .worker_threads(2)
            .max_blocking_threads(16)
            .thread_name("studio")
            .enable_all()
            .build()
            .map_err(|error| internal(error.to_string()))?;
        runtime.block_on(async move {
            let listener =
                tokio::net::TcpListener::from_std(listener).map_err(|error| internal(error.to_string()))?;
            connections::serve(listener, router(app)).await
        })
    }
}

fn router(app: Arc<App>) -> Router {
    let (routes, _) = api::routes();
    routes.fallback(page::page).layer(from_fn_with_state(app.clone(), crate::guard::guard)).with_state(app)
}
