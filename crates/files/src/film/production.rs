//! Drawing a film: the frames that are not there yet, into all files that were asked for.

use std::{path::PathBuf, sync::Arc};

use rayon::prelude::*;

use super::{
    error::FilmError,
    frames::{FrameJob, find_finished, jobs},
    story::Film,
    video::{Video, VideoOptions, VideoTarget},
};
use crate::{
    frame::Frame,
    preset::Preset,
    preset_file::{
        self, AnimatedPng, AnimationOptions, Existing, Fnv, FrameStatus, Provenance, hex, is_taken,
        png_of_frame, png_pixels, write_atomically,
    },
    scene::Scene,
};

/// Bytes of drawn pictures that may wait to be written.
const BATCH_BYTES: u64 = 1 << 30;

/// Draws pictures.
pub trait Painter {
    type Error: From<FilmError>;

    /// What saved pictures say about who drew them.
    fn provenance(&self) -> Provenance;

    /// The picture of `preset`, at its time and of its size.
    fn paint(
        &mut self,
        preset: &Preset,
        scene: &Arc<Scene>,
    ) -> impl Future<Output = Result<Frame, Self::Error>>;
}

/// Watches a film being drawn.
pub trait Observer {
    /// A frame is drawn next, or kept.
    fn begins(&self, job: &FrameJob);

    /// The frame is drawn, or kept.
    fn ended(&self, job: &FrameJob);

    /// Has the person stopped the film?
    fn is_stopped(&self) -> bool {
        false
    }
}

/// The files of a film; any of them may be absent.
#[derive(Clone, Debug, Default)]
pub struct Outputs {
    /// A file for each frame that is drawn, in order; empty: none.
    pub frames: Vec<PathBuf>,
    /// One animated PNG.
    pub apng: Option<PathBuf>,
    pub video: Option<VideoTarget>,
}

/// A file that all frames go into.
enum Reel {
    Apng(Box<AnimatedPng>),
    Video(Box<Video>),
}

/// A film that is ready to be drawn.
pub struct Production {
    film: Film,
    pub jobs: Vec<FrameJob>,
    reels: Vec<Reel>,
    provenance: Provenance,
    /// Names of other adapters that drew some of the kept frames.
    pub other_adapters: Vec<String>,
}

impl Production {
    /// Looks for finished frames and begins the files. Files that are not of this film are
    /// overwritten only if `overwrites`.
    pub fn begin(
        film: Film,
        outputs: Outputs,
        provenance: Provenance,
        overwrites: bool,
    ) -> Result<Self, FilmError> {
        let Outputs {
            frames,
            apng,
            video,
        } = outputs;
        let mut jobs = jobs(&film, frames);
        let other_adapters =
            find_finished(&mut jobs, film.size(), &provenance.adapter, overwrites)?;
        let mut reels = Vec::new();
        if let Some(path) = apng {
            reels
                .extend(animated_png(&film, &jobs, path, &provenance, overwrites)?.map(Reel::Apng));
        }
        if let Some(target) = video {
            let existing = if overwrites && is_taken(&target.path) {
                Existing::Replace
            } else {
                Existing::Keep
            };
            let options = VideoOptions {
                size: film.size(),
                frames: jobs.len(),
                duration_s: film.schedule.video_frame_duration_s(),
                is_looping: film.is_looping(),
            };
            reels.push(Reel::Video(
                Video::begin(&target, &options, existing)?.into(),
            ));
        }
        if reels.is_empty() {
            // The animation is finished already, so frames without a file are not needed.
            jobs.iter_mut()
                .filter(|job| job.path.is_none())
                .for_each(|job| job.is_kept = true);
        }
        Ok(Self {
            film,
            jobs,
            reels,
            provenance,
            other_adapters,
        })
    }

    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Number of frames that are there already.
    pub fn kept(&self) -> usize {
        self.jobs.iter().filter(|job| job.is_kept).count()
    }

    /// Draws the frames that are not kept, in batches: the device draws one at a time, and a batch
    /// is compressed in parallel. After a stop the frames that were drawn are there, and no
    /// file of the whole film.
    pub async fn draw<P: Painter>(
        &mut self,
        painter: &mut P,
        observer: &dyn Observer,
    ) -> Result<(), P::Error> {
        let [width, height] = self.film.size().map(u64::from);
        let batch = (BATCH_BYTES / (4 * width * height).max(1))
            .clamp(1, rayon::current_num_threads() as u64) as usize;
        let Self {
            film,
            jobs,
            reels,
            provenance,
            ..
        } = self;
        for reel in &mut *reels {
            if let (Reel::Apng(animation), Some(still)) = (reel, film.still()) {
                let frame = painter.paint(&still.preset, &film.scene).await?;
                animation.push(&frame.color).map_err(FilmError::from)?;
            }
        }
        for jobs in jobs.chunks(batch) {
            let mut drawn: Vec<Option<Frame>> = Vec::new();
            for job in jobs {
                if observer.is_stopped() {
                    break;
                }
                observer.begins(job);
                drawn.push(if job.is_kept {
                    None
                } else {
                    let preset = film.at(job.frame).preset;
                    Some(painter.paint(&preset, &film.scene).await?)
                });
                observer.ended(job);
            }
            jobs.par_iter()
                .zip(&drawn)
                .try_for_each(|(job, frame)| write_frame(film, job, frame.as_ref(), provenance))?;
            for (job, frame) in jobs.iter().zip(drawn) {
                push(reels, job, frame, observer)?;
            }
            if observer.is_stopped() {
                return Err(FilmError::Stopped.into());
            }
        }
        for reel in reels.drain(..) {
            match reel {
                Reel::Apng(animation) => animation.finish().map_err(FilmError::from)?,
                Reel::Video(video) => video.finish(&|| observer.is_stopped())?,
            }
        }
        Ok(())
    }
}

/// Begins the animated PNG, unless it is finished already.
fn animated_png(
    film: &Film,
    jobs: &[FrameJob],
    path: PathBuf,
    provenance: &Provenance,
    overwrites: bool,
) -> Result<Option<Box<AnimatedPng>>, FilmError> {
    let delay_s = film.schedule.frame_duration_s();
    let options = AnimationOptions {
        size: film.size(),
        frames: jobs.len() as u32,
        delay_s,
        is_looping: film.is_looping(),
        has_still: film.still().is_some(),
    };
    let all = jobs.iter().fold(Fnv::new(), |hash, job| {
        hash.bytes(job.fingerprint.as_bytes())
    });
    let fingerprint = hex(all.words(&[
        delay_s[0].into(),
        delay_s[1].into(),
        options.is_looping.into(),
    ]));
    let found = preset_file::frame_status(&path, options.size, &fingerprint)?;
    match &found {
        FrameStatus::Finished { adapter } if *adapter == provenance.adapter => return Ok(None),
        FrameStatus::Finished { .. } | FrameStatus::Other if !overwrites => {
            return Err(FilmError::Exists {
                file: path.display().to_string(),
            });
        }
        _ => {}
    }
    let existing = if found == FrameStatus::Absent {
        Existing::Keep
    } else {
        Existing::Replace
    };
    let saved = film.preset_file().for_picture(&path);
    Ok(Some(
        AnimatedPng::begin(&path, &options, &saved, provenance, &fingerprint, existing)?.into(),
    ))
}

/// Writes the file of a frame, if it has one and was drawn.
fn write_frame(
    film: &Film,
    job: &FrameJob,
    frame: Option<&Frame>,
    provenance: &Provenance,
) -> Result<(), FilmError> {
    let (Some(path), Some(frame)) = (&job.path, frame) else {
        return Ok(());
    };
    let png = png_of_frame(
        frame,
        &film.at(job.frame).for_picture(path),
        provenance,
        &job.fingerprint,
    )?;
    Ok(write_atomically(path, &png, job.existing)?)
}

/// Adds a frame to the files of the whole film; one that was not drawn is read from its file.
fn push(
    reels: &mut [Reel],
    job: &FrameJob,
    frame: Option<Frame>,
    observer: &dyn Observer,
) -> Result<(), FilmError> {
    if reels.is_empty() {
        return Ok(());
    }
    let pixels = match (frame, &job.path) {
        (Some(frame), _) => frame.color,
        (None, Some(path)) => png_pixels(path)?.0,
        (None, None) => unreachable!("a frame without a file is drawn for the animation"),
    };
    for reel in reels {
        match reel {
            Reel::Apng(animation) => animation.push(&pixels)?,
            Reel::Video(video) => video.push(pixels.clone(), &|| observer.is_stopped())?,
        }
    }
    Ok(())
}
