//! Taking along what a page knows: everything as one archive, and an archive taken in again. A page
//! keeps settings and session in the browser, and all other files only until it is left.

use std::path::{Path, PathBuf};

use super::{open, plain_file};
use crate::{
    app::{
        App,
        settings::{Settings, last_session::LastSession},
        shell::{
            log::Level,
            page::{self, KEPT},
            state::State,
        },
    },
    archive,
    host::disk,
};

/// Name of the archive.
const ARCHIVE: &str = "rasterlab.zip";

/// Downloads every file that the page has, with their paths.
pub fn export(state: &mut State) {
    let files = disk::below(Path::new(""));
    let files: Vec<_> = files
        .iter()
        .map(|(path, bytes)| (path.to_string_lossy(), bytes))
        .collect();
    let relative = files
        .iter()
        .map(|(path, bytes)| (path.trim_start_matches('/'), &***bytes));
    let packed = archive::write(relative);
    let saved = packed.and_then(|packed| page::download(Path::new(ARCHIVE), &packed));
    match saved {
        Ok(()) => state.notify(
            Level::Info,
            format!("Exported {} files as {ARCHIVE}", files.len()),
        ),
        Err(error) => state.notify(Level::Error, format!("{ARCHIVE}: {error}")),
    }
}

/// Is this what [`export`] has written?
pub fn is_export(files: &[(PathBuf, Vec<u8>)]) -> bool {
    let settings = Path::new(KEPT).join("settings.toml");
    files
        .iter()
        .any(|(path, _)| Path::new("/").join(path) == settings)
}

/// Uses the settings and opens the session of an archive whose files are in memory again.
pub fn import(app: &mut App) {
    let state = &mut app.state;
    let kept = |name: &str| disk::read_to_string(&Path::new(KEPT).join(name)).ok();
    let mut remarks = Vec::new();
    if let Some(text) = kept("settings.toml") {
        match plain_file::parse::<Settings>(&text, "settings.toml", &mut remarks) {
            Ok((settings, _)) => {
                settings.theme.choose(&app.ctx);
                app.ctx.set_zoom_factor(settings.scale);
                state.open = settings.open;
                state.settings = settings;
            }
            Err(error) => remarks.push(error),
        }
    }
    if let Some(text) = kept("session.toml") {
        let session = LastSession::parse(&text, "session.toml");
        match session.and_then(|session| session.restore(&state.files.folders)) {
            Ok(restored) => app.commands.run(|app| open::restore(app, restored)),
            Err(error) => remarks.push(error),
        }
    }
    for remark in remarks {
        state.log.add(Level::Warning, remark);
    }
    state.notify(Level::Info, "Took in everything that the archive has");
}
