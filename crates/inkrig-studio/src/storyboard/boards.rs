//! The thread on which animations are made, one at a time, beside the one that solves: a pen never waits for it.

use super::{BoardAsked, BoardProgress, MadeBoard, MadeFrame, MadeTransition, NotMade, Storyboarder};
use crate::events::{Event, JobState, JobStatus};
use crate::studio::Studio;
use crate::{StudioError, studio};
use inkrig_sketch::storyboard::{Frame, Storyboard};
use serde::{Deserialize, Serialize};
use std::collections::VecDeque;
use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};
use utoipa::ToSchema;

/// Jobs that are remembered.
const MOST_JOBS: usize = 50;
/// Between two lines of somebody who draws a storyboard there is not more.
const DRAWING: Duration = Duration::from_secs(6);

/// What makes animations, and what came of it.
#[derive(Debug, Default)]
pub(crate) struct Boards {
    maker: Option<Arc<dyn Storyboarder>>,
    threads: usize,
    work: Mutex<Work>,
    /// Held by the thread that makes one.
    turn: Mutex<()>,
}

#[derive(Debug, Default)]
struct Work {
    next: u64,
    states: VecDeque<JobState>,
    /// The job whose result is put into the project just now: it can no longer be stopped.
    finishing: Option<String>,
    /// When somebody drew last.
    drawn: Option<Instant>,
    made: Arc<KeptBoard>,
}

/// The newest animation.
#[derive(Debug, Clone, Default, Serialize, Deserialize, ToSchema)]
pub(crate) struct BoardMade {
    /// The job.
    job: String,
    /// Id of the clip.
    clip: String,
    /// What is told of each frame.
    frames: Vec<MadeFrame>,
    /// How frames become the next.
    transitions: Vec<MadeTransition>,
    /// What the user should know of the whole.
    notes: Vec<String>,
}

/// The newest animation with what was drawn, as it is kept with the project: it is no part of the document and knows no undo.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub(crate) struct KeptBoard {
    made: BoardMade,
    /// The drawings that `made.frames` tell of.
    drawn: Vec<Frame>,
}

impl KeptBoard {
    /// Id of the animation's clip, where there is one.
    pub(crate) fn shown(&self) -> Option<&str> {
        self.newest().map(|made| made.clip.as_str())
    }

    /// The animation, where there is one.
    pub(crate) fn newest(&self) -> Option<&BoardMade> {
        Some(&self.made).filter(|made| !made.clip.is_empty())
    }

    /// For each frame that something is told of, which frame of the board (from 0) it is, and whether that is drawn as it was then:
    /// where it is not, the figure at least is the same, so that its joints are still where they were read. Each is used once.
    pub(crate) fn known(&self, board: &Storyboard) -> Vec<Option<(usize, bool)>> {
        let frames = numbered(board);
        let mut free: Vec<&Frame> = frames.iter().collect();
        let mut take = |fits: &dyn Fn(&Frame) -> bool| {
            let at = free.iter().position(|frame| fits(frame))?;
            let found = free.remove(at);
            frames.iter().position(|frame| std::ptr::eq(frame, found))
        };
        let mut known: Vec<Option<(usize, bool)>> =
            self.drawn.iter().map(|drawn| take(&|frame| frame == drawn).map(|at| (at, true))).collect();
        for (drawn, known) in self.drawn.iter().zip(&mut known).filter(|(_, known)| known.is_none()) {
            let alike = |frame: &Frame| frame.number == drawn.number && frame.body == drawn.body;
            *known = take(&alike).map(|at| (at, false));
        }
        known
    }

    /// What was made now, and what earlier times tell of frames that are drawn as they were.
    fn renewed(&self, job: &str, clip: String, board: &Storyboard, made: MadeBoard) -> Self {
        let MadeBoard { frames, transitions, notes, .. } = made;
        let mut told: Vec<Option<MadeFrame>> = vec![None; board.frames.len()];
        for (frame, known) in self.made.frames.iter().zip(self.known(board)) {
            if let Some((at, true)) = known
                && let Some(place) = told.get_mut(at)
            {
                let number = at + 1;
                *place = Some(MadeFrame { number, begins: None, pose: Vec::new(), ..frame.clone() });
            }
        }
        for frame in frames {
            if let Some(place) = frame.number.checked_sub(1).and_then(|at| told.get_mut(at)) {
                *place = Some(frame);
            }
        }
        let (frames, drawn) =
            told.into_iter().zip(numbered(board)).filter_map(|(told, frame)| Some((told?, frame))).unzip();
        Self { made: BoardMade { job: job.to_string(), clip, frames, transitions, notes }, drawn }
    }
}

/// The frames, each with the number that its motions are made with: the same drawing at another place gets others.
fn numbered(board: &Storyboard) -> Vec<Frame> {
    let number =
        |(place, frame): (u32, &Frame)| Frame { number: frame.number.or(Some(place)), ..frame.clone() };
    (1..).zip(&board.frames).map(number).collect()
}

impl Boards {
    /// `threads` may be used; `kept` was made by an earlier run of the program.
    pub(crate) fn new(maker: Option<Arc<dyn Storyboarder>>, threads: usize, kept: Option<KeptBoard>) -> Self {
        let work = Work { made: Arc::new(kept.unwrap_or_default()), ..Work::default() };
        Self { maker, threads, work: Mutex::new(work), ..Self::default() }
    }

    /// Somebody draws: for a while one core is left to them.
    pub(crate) fn drawn_on(&self) {
        self.lock().drawn = Some(Instant::now());
    }

    /// Words to suggest; `None` where this program makes no animations.
    pub(crate) fn words(&self) -> Option<Vec<String>> {
        self.maker.as_ref().map(|maker| maker.words())
    }

    pub(crate) fn job(&self, id: &str) -> Option<JobState> {
        self.lock().states.iter().find(|state| state.id == id).cloned()
    }

    /// The job that runs.
    pub(crate) fn current(&self) -> Option<JobState> {
        self.lock().running().cloned()
    }

    /// The newest animation; its clip has no id where there is none.
    pub(crate) fn made(&self) -> Arc<KeptBoard> {
        self.lock().made.clone()
    }

    /// Stops a job; `None` when there is none. What it makes from now on is thrown away.
    pub(crate) fn cancel(&self, id: &str) -> Option<JobState> {
        let mut work = self.lock();
        let finishing = work.finishing.as_deref() == Some(id);
        let state = work.states.iter_mut().find(|state| state.id == id)?;
        if state.state == JobStatus::Running && !finishing {
            state.state = JobStatus::Cancelled;
        }
        Some(state.clone())
    }

    /// Begins to make an animation, which becomes a clip of the project.
    pub(crate) fn begin(
        studio: &Arc<Studio>,
        board: Storyboard,
        asked: BoardAsked,
    ) -> Result<JobState, StudioError> {
        let boards = &studio.boards;
        let maker = boards.maker.clone().ok_or_else(|| {
            StudioError::invalid(
                "this program makes no animations of storyboards: it was built without a model",
            )
        })?;
        if let Some(number) = asked.frame
            && !(1..=board.frames.len()).contains(&number)
        {
            let count = board.frames.len();
            return Err(StudioError::invalid(format!("there is no frame {number}: the last is {count}")));
        }
        let mut work = boards.lock();
        if work.running().is_some() {
            return Err(StudioError::invalid("a storyboard is being made already: stop it first"));
        }
        work.next += 1;
        let state = JobState::named(format!("b{}", work.next), "storyboard");
        work.states.push_back(state.clone());
        while work.states.len() > MOST_JOBS {
            work.states.pop_front();
        }
        drop(work);
        let (studio, id) = (studio.clone(), state.id.clone());
        let spawned = std::thread::Builder::new().name("storyboard".into()).spawn(move || {
            let boards = &studio.boards;
            // One that was stopped may not have come to where it looks.
            let _turn = boards.turn.lock().unwrap_or_else(PoisonError::into_inner);
            let making = AssertUnwindSafe(|| {
                maker.make(&board, asked, &mut |progress| boards.progress(&studio, &id, progress))
            });
            let done = catch_unwind(making)
                .unwrap_or_else(|_| Err(NotMade::Failed("the model failed: this should not happen".into())));
            boards.finish(&studio, &id, &board, done);
        });
        if let Err(cause) = spawned {
            boards.cancel(&state.id);
            return Err(StudioError::Internal(cause.to_string()));
        }
        Ok(state)
    }

    fn progress(&self, studio: &Studio, id: &str, progress: BoardProgress) -> ControlFlow<(), usize> {
        let mut work = self.lock();
        let Some(state) = work.states.iter_mut().find(|state| state.id == id) else {
            return ControlFlow::Break(());
        };
        if state.state != JobStatus::Running {
            return ControlFlow::Break(());
        }
        (state.done, state.total) = (progress.done, progress.total);
        (state.level, state.levels) = (progress.frame, progress.frames);
        let state = state.clone();
        let drawn = work.drawn.is_some_and(|at| at.elapsed() < DRAWING);
        drop(work);
        studio.events.send(Event::Job(state));
        // A pen never waits: the page, the solver and the browser share these cores.
        let fewer = usize::from(drawn || studio.is_drawn_on());
        ControlFlow::Continue(self.threads.saturating_sub(fewer).max(1))
    }

    fn finish(&self, studio: &Studio, id: &str, board: &Storyboard, done: Result<MadeBoard, NotMade>) {
        let mut work = self.lock();
        let before = work.made.clone();
        // One that is no longer remembered was stopped long ago.
        let going = work.states.iter().any(|state| state.id == id && state.state == JobStatus::Running);
        let done = if going { done } else { Err(NotMade::Stopped) };
        if done.is_ok() {
            work.finishing = Some(id.to_string());
        }
        drop(work);
        let done = done.and_then(|made| {
            let failed = |error: StudioError| NotMade::Failed(error.to_string());
            // A frame that is shown alone does not take the place of the whole.
            let shown = before.made.frames.iter().filter(|frame| frame.begins.is_some()).count();
            let part = made.frames.len() < shown.min(board.frames.len());
            let old = if part { "" } else { before.made.clip.as_str() };
            let clip = studio.add_made(&board.title, &made.bvh, old).map_err(failed)?;
            let mut kept = before.renewed(id, clip, board, made);
            // The project stays free while it is written.
            let folder = studio.project().folder().clone();
            if let Err(error) = folder.keep_made(&kept) {
                kept.made.notes.push(format!("This animation will not be known after a restart: {error}"));
            }
            Ok(kept)
        });
        let mut work = self.lock();
        work.finishing = None;
        let Some(state) = work.states.iter_mut().find(|state| state.id == id) else { return };
        let made = match done {
            Ok(kept) => {
                state.state = JobStatus::Done;
                state.done = state.total;
                state.result = Some(kept.made.clip.clone());
                state.results = vec![kept.made.clip.clone()];
                Some(Arc::new(kept))
            }
            Err(NotMade::Stopped) => {
                state.state = JobStatus::Cancelled;
                None
            }
            Err(NotMade::Failed(why)) => {
                state.state = JobStatus::Failed;
                state.error = Some(why);
                None
            }
        };
        let state = state.clone();
        if let Some(made) = made {
            work.made = made;
        }
        drop(work);
        studio.events.send(Event::Job(state));
    }

    fn lock(&self) -> MutexGuard<'_, Work> {
        studio::lock(&self.work)
    }
}

impl Work {
    fn running(&self) -> Option<&JobState> {
        self.states.iter().rev().find(|state| state.state == JobStatus::Running)
    }
}
