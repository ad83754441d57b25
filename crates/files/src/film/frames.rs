//! The frames of a film, and which of them are there already.

use std::path::{Path, PathBuf};

use rayon::prelude::*;

use super::{error::FilmError, story::Film};
use crate::{
    host::disk,
    preset_file::{self, Existing, FrameStatus, PresetError},
};

/// A frame to draw or to keep.
pub struct FrameJob {
    pub frame: u32,
    pub fingerprint: String,
    pub path: Option<PathBuf>,
    /// Its file is finished and stays.
    pub is_kept: bool,
    /// What happens to a file that is there when the frame is written.
    pub existing: Existing,
}

/// The frames of a film; `paths` names their files in the same order, or is empty.
pub fn jobs(film: &Film, paths: Vec<PathBuf>) -> Vec<FrameJob> {
    let has_paths = !paths.is_empty();
    let paths: Vec<Option<PathBuf>> = if has_paths {
        paths.into_iter().map(Some).collect()
    } else {
        vec![None; film.schedule.frames.len()]
    };
    let frames: Vec<_> = film.schedule.frames.clone().zip(paths).collect();
    let job = |(frame, path)| FrameJob {
        frame,
        fingerprint: film.fingerprint(frame),
        path,
        is_kept: false,
        existing: Existing::Keep,
    };
    frames.into_par_iter().map(job).collect()
}

/// Finds the finished frames, and makes their folder. Any other file is overwritten only if
/// `overwrites`; then also frames that another adapter drew. Returns the names of other adapters
/// whose frames are kept.
pub fn find_finished(
    jobs: &mut [FrameJob],
    size: [u32; 2],
    adapter: &str,
    overwrites: bool,
) -> Result<Vec<String>, FilmError> {
    if let Some(folder) = jobs
        .first()
        .and_then(|job| job.path.as_deref())
        .and_then(Path::parent)
        .filter(|f| !f.as_os_str().is_empty())
    {
        disk::create_folder(folder).map_err(|e| FilmError::Folder {
            folder: folder.display().to_string(),
            reason: e.to_string(),
        })?;
    }
    let status = |job: &FrameJob| match &job.path {
        Some(path) => preset_file::frame_status(path, size, &job.fingerprint),
        None => Ok(FrameStatus::Absent),
    };
    let found: Vec<FrameStatus> = jobs
        .par_iter()
        .map(status)
        .collect::<Result<_, PresetError>>()?;
    let others: Vec<&Path> = jobs
        .iter()
        .zip(&found)
        .filter(|(_, found)| **found == FrameStatus::Other)
        .filter_map(|(job, _)| job.path.as_deref())
        .collect();
    if let ([first, rest @ ..], false) = (&others[..], overwrites) {
        return Err(FilmError::NotOurs {
            first: first.display().to_string(),
            more: rest.len(),
        });
    }
    let mut other_adapters: Vec<String> = Vec::new();
    for (job, found) in jobs.iter_mut().zip(found) {
        job.existing = if found == FrameStatus::Absent {
            Existing::Keep
        } else {
            Existing::Replace
        };
        let FrameStatus::Finished { adapter: drawn_by } = found else {
            continue;
        };
        let is_ours = drawn_by == adapter;
        job.is_kept = is_ours || !overwrites;
        if !is_ours && job.is_kept && !other_adapters.contains(&drawn_by) {
            other_adapters.push(drawn_by);
        }
    }
    Ok(other_adapters)
}

/// A file for every frame of a film: `walk.png` becomes `walk_0000.png`, `walk_0001.png` and so on,
/// with digits for `total` frames.
pub fn frame_paths(base: &Path, frames: std::ops::Range<u32>, total: u32) -> Vec<PathBuf> {
    let digits = total.saturating_sub(1).to_string().len().max(4);
    let stem = base.file_stem().unwrap_or_default().to_string_lossy();
    frames
        .map(|frame| base.with_file_name(format!("{stem}_{frame:0digits$}.png")))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_frames_sort_as_the_film_runs() {
        let names = |total| frame_paths(Path::new("out/walk.v2.png"), total - 1..total, total);
        assert_eq!(names(8), [Path::new("out/walk.v2_0007.png")]);
        assert_eq!(names(20_000), [Path::new("out/walk.v2_19999.png")]);
    }
}
