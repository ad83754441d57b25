//! Keeping settings and session in the folder of the user's configuration while the window runs.

use std::{
    path::{Path, PathBuf},
    thread::JoinHandle,
};

use toml_edit::DocumentMut;

use super::{
    Settings,
    last_session::{LastSession, Restored},
};
use crate::{
    app::{
        editing::session::{FileId, Session},
        files::plain_file,
        picture::review::KeptReview,
    },
    host::disk,
    preset::Preset,
    preset_file::Folders,
};

/// Changes are written together this long after the first of them, seconds. Of a drag that goes on,
/// a crash takes the last second.
const REST_S: f64 = 1.0;

/// Keeps settings and session in a folder. Without a folder, as in tests, it keeps nothing.
pub struct Keeper {
    folder: Option<PathBuf>,
    /// The settings file as it was read, with the user's comments.
    document: DocumentMut,
    /// Held while the window runs. Another window has it if this one keeps no session.
    lock: Option<Lock>,
    /// The last session was read and decided about: it may be replaced.
    replaces_session: bool,
    /// What is written or about to be, and since when it waits.
    settings: Resting<Settings>,
    open: Resting<Option<(FileId, Preset, KeptReview)>>,
    /// A thread that writes files, and ends with the errors.
    writing: Option<JoinHandle<Vec<String>>>,
}

/// A file to be written: a function that does, and returns why it could not.
type Write = Box<dyn FnOnce() -> Result<(), String> + Send>;

/// A value that is written at most once in [`REST_S`].
struct Resting<T> {
    latest: T,
    /// When the first change was that is not written yet.
    changed_at_s: Option<f64>,
}

impl<T: PartialEq + Clone> Resting<T> {
    fn new(latest: T) -> Self {
        Self {
            latest,
            changed_at_s: None,
        }
    }

    /// Takes the value of this frame. True if it must be written now.
    fn follow(&mut self, now: &T, now_s: f64) -> bool {
        if self.latest != *now {
            self.latest = now.clone();
            self.changed_at_s.get_or_insert(now_s);
        }
        self.changed_at_s
            .take_if(|changed_at_s| now_s - *changed_at_s >= REST_S)
            .is_some()
    }

    fn wait_s(&self, now_s: f64) -> Option<f64> {
        self.changed_at_s
            .map(|changed_at_s| (REST_S - (now_s - changed_at_s)).max(0.0))
    }
}

/// What the last session left.
pub enum PreviousSession {
    /// No session, or it is not this window's to restore.
    None,
    /// The window closed in order.
    Closed(Box<Restored>),
    /// The program crashed, or the machine.
    Crashed(Box<Restored>),
    /// It cannot be restored: why.
    Lost(String),
}

impl Keeper {
    /// Reads the settings of `folder`. Each remark is something that could not be used.
    pub fn new(folder: Option<PathBuf>) -> (Self, Settings, Vec<String>) {
        let mut remarks = Vec::new();
        let read = folder
            .as_deref()
            .map(|folder| plain_file::read(&folder.join(SETTINGS), &mut remarks));
        let (settings, document): (Settings, _) = read.unwrap_or_default();
        let lock = folder
            .as_deref()
            .and_then(|folder| lock(folder, &mut remarks));
        let kept = Resting::new(settings.clone());
        let keeper = Self {
            folder,
            document,
            lock,
            replaces_session: false,
            settings: kept,
            open: Resting::new(None),
            writing: None,
        };
        (keeper, settings, remarks)
    }

    /// What the last session left.
    pub fn previous_session(&self, folders: &Folders) -> PreviousSession {
        let Some(folder) = self.folder.as_ref().filter(|_| self.lock.is_some()) else {
            return PreviousSession::None;
        };
        let path = folder.join(SESSION);
        let Ok(text) = disk::read_to_string(&path) else {
            return PreviousSession::None;
        };
        let session = LastSession::parse(&text, &path.display().to_string());
        // A page is left at any time, which is no crash.
        let is_running = session.as_ref().is_ok_and(|session| session.is_running)
            && cfg!(not(target_arch = "wasm32"));
        match session.and_then(|session| session.restore(folders)) {
            Ok(restored) if is_running => PreviousSession::Crashed(restored.into()),
            Ok(restored) => PreviousSession::Closed(restored.into()),
            Err(error) => PreviousSession::Lost(error),
        }
    }

    /// The review of goldens that the last session left.
    pub fn kept_review(&self) -> KeptReview {
        let folder = self.folder.as_ref().filter(|_| self.lock.is_some());
        let path = folder.map(|folder| folder.join(SESSION));
        let text = path.and_then(|path| disk::read_to_string(path.as_path()).ok());
        text.and_then(|text| LastSession::parse(&text, SESSION).ok())
            .map(|session| session.review)
            .unwrap_or_default()
    }

    /// Does the session of this window come back at the next start?
    pub fn keeps_session(&self) -> bool {
        self.folder.is_some() && self.lock.is_some()
    }

    /// From now on the session of this window replaces the last one.
    pub fn begin_session(&mut self) {
        self.replaces_session = true;
    }

    /// Writes what has changed and waited. Returns an error of an earlier write, and after
    /// how many seconds to look again.
    pub fn follow(
        &mut self,
        settings: &Settings,
        (session, review): (&Session, KeptReview),
        now_s: f64,
    ) -> (Option<String>, Option<f64>) {
        if self.folder.is_none() {
            return (None, None);
        }
        if self
            .writing
            .as_ref()
            .is_some_and(|writing| !writing.is_finished())
        {
            return (None, Some(REST_S));
        }
        let mut errors = self.finish_writing();
        let mut writes: Vec<Write> = Vec::new();
        if self.settings.follow(settings, now_s) {
            writes.extend(self.write_settings(settings));
        }
        if self.keeps_session() && self.replaces_session {
            let open = Some((
                FileId::of(&session.preset_file),
                session.preset_file.preset.clone(),
                review.clone(),
            ));
            if self.open.follow(&open, now_s) {
                let last = LastSession::of(&session.preset_file, session.as_filed());
                writes.extend(self.write_session(last.with_review(review)));
            }
        }
        let mut wait_s = [self.settings.wait_s(now_s), self.open.wait_s(now_s)]
            .into_iter()
            .flatten()
            .reduce(f64::min);
        if !writes.is_empty() {
            let write = || {
                writes
                    .into_iter()
                    .filter_map(|write| write().err())
                    .collect()
            };
            if cfg!(target_arch = "wasm32") {
                // A page writes at once, and has no other thread.
                let written: Vec<String> = write();
                errors.extend(written);
            } else {
                self.writing = Some(std::thread::spawn(write));
                wait_s = Some(wait_s.unwrap_or(REST_S));
            }
        }
        ((!errors.is_empty()).then(|| errors.join("; ")), wait_s)
    }

    /// The window closes in order, with its unsaved edits or without.
    pub fn close(
        &mut self,
        settings: &Settings,
        (session, review): (&Session, KeptReview),
        keeps_edits: bool,
    ) {
        let mut errors = self.finish_writing();
        let mut writes: Vec<Write> = Vec::new();
        if self.settings.changed_at_s.is_some() || self.settings.latest != *settings {
            writes.extend(self.write_settings(settings));
        }
        if self.keeps_session() && self.replaces_session {
            let last = LastSession::of(&session.preset_file, session.as_filed())
                .with_review(review)
                .closed();
            writes.extend(self.write_session(if keeps_edits {
                last
            } else {
                last.without_edits()
            }));
        }
        errors.extend(writes.into_iter().filter_map(|write| write().err()));
        errors.iter().for_each(|error| {
            eprintln!("rasterlab: settings or session could not be kept: {error}")
        });
    }

    /// Waits until everything is written. Returns the errors.
    fn finish_writing(&mut self) -> Vec<String> {
        let ended = self.writing.take().map(JoinHandle::join);
        // A panic of the thread was printed by it.
        ended.and_then(Result::ok).unwrap_or_default()
    }

    fn write_settings(&self, settings: &Settings) -> Option<Write> {
        let (path, settings, mut document) = (
            self.folder.as_ref()?.join(SETTINGS),
            settings.clone(),
            self.document.clone(),
        );
        Some(Box::new(move || {
            plain_file::write(&settings, &mut document, &path)
        }))
    }

    fn write_session(&self, session: LastSession) -> Option<Write> {
        let path = self.folder.as_ref()?.join(SESSION);
        Some(Box::new(move || {
            plain_file::write(&session, &mut LastSession::document(), &path)
        }))
    }
}

impl Drop for Keeper {
    fn drop(&mut self) {
        self.finish_writing();
    }
}

/// Names of the files.
const SETTINGS: &str = "settings.toml";
const SESSION: &str = "session.toml";
#[cfg(not(target_arch = "wasm32"))]
const LOCK: &str = "session.lock";

/// The size that the window had, by the settings of `folder`. What is wrong with them is said by
/// [`Keeper::new`].
#[cfg(not(target_arch = "wasm32"))]
pub fn window_size(folder: &Path) -> super::WindowSize {
    let text = std::fs::read_to_string(folder.join(SETTINGS)).unwrap_or_default();
    plain_file::parse(&text, SETTINGS, &mut Vec::new()).map_or_else(
        |_| super::WindowSize::default(),
        |(settings, _): (Settings, _)| settings.window,
    )
}

/// The lock of a page: the newest that writes wins.
#[cfg(target_arch = "wasm32")]
type Lock = ();
#[cfg(not(target_arch = "wasm32"))]
type Lock = std::fs::File;

#[cfg(target_arch = "wasm32")]
fn lock(_: &Path, _: &mut Vec<String>) -> Option<Lock> {
    Some(())
}

/// The lock of the session; none if another window has it.
#[cfg(not(target_arch = "wasm32"))]
fn lock(folder: &Path, remarks: &mut Vec<String>) -> Option<Lock> {
    use std::fs::{File, TryLockError};
    let opened = std::fs::create_dir_all(folder).and_then(|()| {
        File::options()
            .create(true)
            .write(true)
            .truncate(false)
            .open(folder.join(LOCK))
    });
    match opened {
        Ok(file) => {
            match file.try_lock() {
                // A file system without locks: two windows at once replace each other's session.
                Ok(()) | Err(TryLockError::Error(_)) => Some(file),
                Err(TryLockError::WouldBlock) => {
                    remarks.push("another window of rasterlab is open, so the session of this one is not kept".into());
                    None
                }
            }
        }
        Err(error) => {
            remarks.push(format!(
                "{}: it cannot be written, so the session is not kept: {error}",
                folder.join(LOCK).display()
            ));
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset_file;

    fn session_of(id: &str) -> Session {
        Session::new(preset_file::open(id, &Folders::default()).expect("a built-in preset"))
    }

    fn edit(session: &mut Session) {
        session.preset_file.preset.spin_deg_per_s = 12.5;
    }

    fn without_review(session: &Session) -> (&Session, KeptReview) {
        (session, KeptReview::default())
    }

    fn keeper(folder: &Path) -> (Keeper, Settings, Vec<String>) {
        Keeper::new(Some(folder.to_owned()))
    }

    #[test]
    fn settings_are_written_a_second_after_a_change_and_read_at_the_next_start() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let session = session_of("teapot");
        let (mut first, mut settings, _) = keeper(folder.path());
        settings.scale = 1.5;
        let (_, wait_s) = first.follow(&settings, without_review(&session), 10.0);
        assert_eq!(wait_s, Some(REST_S));
        settings.scale = 1.25;
        let (_, wait_s) = first.follow(&settings, without_review(&session), 10.75);
        assert_eq!(wait_s, Some(0.25));
        first.follow(&settings, without_review(&session), 11.1);
        drop(first);
        assert_eq!(keeper(folder.path()).1, settings);
    }

    #[test]
    fn a_session_that_closed_comes_back_and_one_that_crashed_says_so() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut session = session_of("facet-sweep");
        edit(&mut session);
        let folders = Folders::default();
        let (mut first, settings, _) = keeper(folder.path());
        assert!(matches!(
            first.previous_session(&folders),
            PreviousSession::None
        ));
        first.begin_session();
        first.follow(&settings, without_review(&session), 0.0);
        first.follow(&settings, without_review(&session), REST_S);
        drop(first); // As if killed: the file says that the window runs.
        let (mut second, ..) = keeper(folder.path());
        let PreviousSession::Crashed(restored) = second.previous_session(&folders) else {
            panic!("the crash was not noticed")
        };
        assert_eq!(restored.preset_file.preset, session.preset_file.preset);
        second.begin_session();
        second.close(&settings, without_review(&session), true);
        drop(second);
        let (mut third, ..) = keeper(folder.path());
        let PreviousSession::Closed(restored) = third.previous_session(&folders) else {
            panic!("the session was not closed")
        };
        assert!(restored.has_edits());
        third.begin_session();
        third.close(&settings, without_review(&session), false);
        drop(third);
        let PreviousSession::Closed(restored) = keeper(folder.path()).0.previous_session(&folders)
        else {
            panic!("the session was not closed")
        };
        assert!(!restored.has_edits());
    }

    #[test]
    fn a_second_window_leaves_the_session_of_the_first() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (mut first, settings, _) = keeper(folder.path());
        first.begin_session();
        let (mut second, _, remarks) = keeper(folder.path());
        assert!(
            remarks
                .iter()
                .any(|remark| remark.contains("another window")),
            "{remarks:?}"
        );
        assert!(matches!(
            second.previous_session(&Folders::default()),
            PreviousSession::None
        ));
        second.begin_session();
        second.close(&settings, without_review(&session_of("lambert")), true);
        drop(second);
        first.close(&settings, without_review(&session_of("facet-sweep")), true);
        drop(first);
        let PreviousSession::Closed(restored) = keeper(folder.path())
            .0
            .previous_session(&Folders::default())
        else {
            panic!("no session")
        };
        assert_eq!(restored.preset_file.id, "facet-sweep");
    }
}
