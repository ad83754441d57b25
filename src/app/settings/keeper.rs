//! Keeping settings and session in the folder of the user's configuration while the window runs.

use std::{
    fs::{File, TryLockError},
    path::{Path, PathBuf},
};

use toml_edit::DocumentMut;

use super::{
    Settings,
    last_session::{LastSession, Restored},
    toml,
    writer::Writer,
};
use crate::{
    app::session::{FileId, Session},
    preset::Preset,
    preset_file::Folders,
};

/// Changes are written after this long without another, seconds.
const REST_S: f64 = 1.0;

/// Keeps settings and session in a folder. Without a folder, as in tests, it keeps nothing.
pub struct Keeper {
    place: Option<Place>,
    /// What is written or about to be, and since when it waits.
    settings: Kept<Settings>,
    open: Kept<Option<(FileId, Preset)>>,
}

struct Place {
    folder: PathBuf,
    writer: Writer,
    /// The settings file as it was read, with the user's comments.
    document: DocumentMut,
    /// Held while the window runs. Another window has it if this one keeps no session.
    lock: Option<File>,
    /// The last session was read and decided about: it may be replaced.
    replaces_session: bool,
}

/// A value that is written when it has come to rest.
struct Kept<T> {
    latest: T,
    changed_at_s: Option<f64>,
}

impl<T: PartialEq + Clone> Kept<T> {
    fn new(latest: T) -> Self {
        Self { latest, changed_at_s: None }
    }

    /// Takes the value of this frame. True if it must be written now.
    fn follow(&mut self, now: &T, now_s: f64) -> bool {
        if self.latest != *now {
            (self.latest, self.changed_at_s) = (now.clone(), Some(now_s));
        }
        self.changed_at_s.take_if(|changed_at_s| now_s - *changed_at_s >= REST_S).is_some()
    }

    fn wait_s(&self, now_s: f64) -> Option<f64> {
        self.changed_at_s.map(|changed_at_s| (REST_S - (now_s - changed_at_s)).max(0.0))
    }
}

/// What the last session left.
pub enum Left {
    /// No session, or it is not this window's to restore.
    Nothing,
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
        let (mut settings, mut place) = (Settings::default(), None);
        if let Some(folder) = folder {
            let (read, document) = read_settings(&folder, &mut remarks, true);
            settings = read;
            match Writer::start() {
                Ok(writer) => place = Some(Place { lock: lock(&folder, &mut remarks), folder, writer, document, replaces_session: false }),
                Err(error) => remarks.push(format!("settings and session are not kept: no thread could be started: {error}")),
            }
        }
        (Self { place, settings: Kept::new(settings.clone()), open: Kept::new(None) }, settings, remarks)
    }

    /// What the last session left.
    pub fn left(&self, folders: &Folders) -> Left {
        let Some(Place { folder, lock: Some(_), .. }) = &self.place else { return Left::Nothing };
        let path = folder.join(SESSION);
        let Ok(text) = std::fs::read_to_string(&path) else { return Left::Nothing };
        let session = LastSession::parse(&text, &path.display().to_string());
        let is_running = session.as_ref().is_ok_and(|session| session.is_running);
        match session.and_then(|session| session.restore(folders)) {
            Ok(restored) if is_running => Left::Crashed(restored.into()),
            Ok(restored) => Left::Closed(restored.into()),
            Err(error) => Left::Lost(error),
        }
    }

    /// Does the session of this window come back at the next start?
    pub fn keeps_session(&self) -> bool {
        self.place.as_ref().is_some_and(|place| place.lock.is_some())
    }

    /// From now on the session of this window replaces the last one.
    pub fn begin_session(&mut self) {
        if let Some(place) = &mut self.place {
            place.replaces_session = true;
        }
    }

    /// Writes what has changed and come to rest. Returns an error of an earlier write, and after how many seconds to look again.
    pub fn follow(&mut self, settings: &Settings, session: &Session, now_s: f64) -> (Option<String>, Option<f64>) {
        let Some(place) = &mut self.place else { return (None, None) };
        if self.settings.follow(settings, now_s) {
            place.write_settings(settings);
        }
        if place.lock.is_some() && place.replaces_session {
            let open = Some((FileId::of(&session.preset_file), session.preset_file.preset.clone()));
            if self.open.follow(&open, now_s) {
                place.write_session(&LastSession::of(&session.preset_file, session.as_filed()));
            }
        }
        let wait_s = [self.settings.wait_s(now_s), self.open.wait_s(now_s)].into_iter().flatten().reduce(f64::min);
        (place.writer.error(), wait_s)
    }

    /// The window closes in order, with its unsaved edits or without.
    pub fn close(&mut self, settings: &Settings, session: &Session, keeps_edits: bool) {
        let Some(place) = &mut self.place else { return };
        if self.settings.changed_at_s.is_some() || self.settings.latest != *settings {
            place.write_settings(settings);
        }
        if place.lock.is_some() && place.replaces_session {
            let last = LastSession::of(&session.preset_file, session.as_filed()).closed();
            place.write_session(&if keeps_edits { last } else { last.without_edits() });
        }
    }
}

/// Names of the files.
const SETTINGS: &str = "settings.toml";
const BROKEN: &str = "settings.toml.broken";
const SESSION: &str = "session.toml";
const LOCK: &str = "session.lock";

impl Place {
    fn write_settings(&mut self, settings: &Settings) {
        toml::write(settings, &mut self.document);
        self.writer.write(self.folder.join(SETTINGS), self.document.to_string());
    }

    fn write_session(&self, session: &LastSession) {
        self.writer.write(self.folder.join(SESSION), session.to_toml());
    }
}

/// The settings of a folder; the default ones where there are none. If `puts_aside`, a broken file gets another name, so that the next write
/// does not replace what the user has typed into it.
pub fn read_settings(folder: &Path, remarks: &mut Vec<String>, puts_aside: bool) -> (Settings, DocumentMut) {
    let path = folder.join(SETTINGS);
    let name = path.display().to_string();
    let text = match std::fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) => {
            if error.kind() != std::io::ErrorKind::NotFound {
                remarks.push(format!("{name}: it cannot be read, so the default settings are used: {error}"));
            }
            return Default::default();
        }
    };
    match toml::read(&text, &name) {
        Ok((settings, document, refused)) => {
            remarks.extend(refused);
            (settings, document)
        }
        Err(_) if !puts_aside => Default::default(),
        Err(error) => {
            let aside = folder.join(BROKEN);
            let kept = match std::fs::rename(&path, &aside) {
                Ok(()) => format!("it is kept as {}", aside.display()),
                Err(error) => format!("it could not be put aside: {error}"),
            };
            remarks.push(format!("{error}; the default settings are used, and {kept}"));
            Default::default()
        }
    }
}

/// The lock of the session; none if another window has it.
fn lock(folder: &Path, remarks: &mut Vec<String>) -> Option<File> {
    let opened =
        std::fs::create_dir_all(folder).and_then(|()| File::options().create(true).write(true).truncate(false).open(folder.join(LOCK)));
    match opened {
        Ok(file) => match file.try_lock() {
            // A file system without locks: two windows at once replace each other's session.
            Ok(()) | Err(TryLockError::Error(_)) => Some(file),
            Err(TryLockError::WouldBlock) => {
                remarks.push("another window of rasterlab is open, so the session of this one is not kept".into());
                None
            }
        },
        Err(error) => {
            remarks.push(format!("{}: it cannot be written, so the session is not kept: {error}", folder.join(LOCK).display()));
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset_file::{self, PresetFile};

    fn session_of(id: &str) -> Session {
        Session::new(preset_file::open(id, &Folders::default()).expect("a built-in preset"))
    }

    fn edit(session: &mut Session) {
        session.preset_file.preset.spin_deg_per_s = 12.5;
    }

    fn keeper(folder: &Path) -> (Keeper, Settings, Vec<String>) {
        Keeper::new(Some(folder.to_owned()))
    }

    #[test]
    fn settings_are_written_when_they_rest_and_read_at_the_next_start() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let session = session_of("teapot");
        let (mut first, mut settings, _) = keeper(folder.path());
        settings.scale = 1.5;
        let (_, wait_s) = first.follow(&settings, &session, 10.0);
        assert_eq!(wait_s, Some(REST_S));
        first.follow(&settings, &session, 10.5);
        first.follow(&settings, &session, 11.1);
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
        assert!(matches!(first.left(&folders), Left::Nothing));
        first.begin_session();
        first.follow(&settings, &session, 0.0);
        first.follow(&settings, &session, REST_S);
        drop(first); // As if killed: the file says that the window runs.
        let (mut second, ..) = keeper(folder.path());
        let Left::Crashed(restored) = second.left(&folders) else { panic!("the crash was not noticed") };
        assert_eq!(restored.preset_file.preset, session.preset_file.preset);
        second.begin_session();
        second.close(&settings, &session, true);
        drop(second);
        let (mut third, ..) = keeper(folder.path());
        let Left::Closed(restored) = third.left(&folders) else { panic!("the session was not closed") };
        assert!(restored.has_edits());
        third.begin_session();
        third.close(&settings, &session, false);
        drop(third);
        let Left::Closed(restored) = keeper(folder.path()).0.left(&folders) else { panic!("the session was not closed") };
        assert!(!restored.has_edits());
    }

    #[test]
    fn a_second_window_leaves_the_session_of_the_first() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (mut first, settings, _) = keeper(folder.path());
        first.begin_session();
        let (mut second, _, remarks) = keeper(folder.path());
        assert!(remarks.iter().any(|remark| remark.contains("another window")), "{remarks:?}");
        assert!(matches!(second.left(&Folders::default()), Left::Nothing));
        second.begin_session();
        second.close(&settings, &session_of("lambert"), true);
        drop(second);
        first.close(&settings, &session_of("facet-sweep"), true);
        drop(first);
        let Left::Closed(restored) = keeper(folder.path()).0.left(&Folders::default()) else { panic!("no session") };
        assert_eq!(restored.preset_file.id, "facet-sweep");
    }

    #[test]
    fn broken_settings_are_one_line_and_put_aside() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        std::fs::write(folder.path().join(SETTINGS), "theme = = 1").expect("a file");
        let (_, settings, remarks) = keeper(folder.path());
        assert_eq!((settings, remarks.len()), (Settings::default(), 1), "{remarks:?}");
        assert_eq!(std::fs::read_to_string(folder.path().join(BROKEN)).expect("it is kept"), "theme = = 1");
    }

    #[test]
    fn without_a_folder_nothing_is_kept() {
        let (mut keeper, mut settings, remarks) = Keeper::new(None);
        assert_eq!(remarks, [""; 0]);
        settings.scale = 2.0;
        let session = Session::new(PresetFile::new("x", Preset::default()));
        keeper.begin_session();
        assert_eq!(keeper.follow(&settings, &session, 5.0), (None, None));
        keeper.close(&settings, &session, true);
        assert!(matches!(keeper.left(&Folders::default()), Left::Nothing));
    }
}
