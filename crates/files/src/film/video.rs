//! Videos that `ffmpeg` writes: frames go to its stdin, and the file takes its name when it is
//! whole.

use std::{
    io::{self, Read as _, Write as _},
    path::{Path, PathBuf},
    process::{Child, ChildStderr, ChildStdin, Command, Stdio},
    sync::mpsc::{self, Receiver, SyncSender, TrySendError},
    thread::{self, JoinHandle},
    time::{Duration, Instant},
};

use super::{
    error::FilmError,
    ffmpeg::{Container, find_ffmpeg, first_line},
};
use crate::preset_file::{AtomicFile, Existing};

/// Frames that wait for ffmpeg while the next one is drawn.
const WAITING_FRAMES: usize = 2;

/// How often a wait for ffmpeg looks whether the person stopped the film.
const PAUSE: Duration = Duration::from_millis(5);

/// How long ffmpeg may take to end after it stopped reading, and to say why.
const PATIENCE: Duration = Duration::from_secs(2);

/// Longest text of ffmpeg that is kept, bytes.
const MAX_SAID: u64 = 1 << 16;

/// Row-major RGBA.
type Pixels = Vec<[u8; 4]>;

/// A video that can be written: its kind is known, its size fits, and ffmpeg is there.
#[derive(Clone, Debug)]
pub struct VideoTarget {
    pub path: PathBuf,
    container: Container,
    ffmpeg: PathBuf,
}

impl VideoTarget {
    /// A video of `size` pixels (width, height) at `path`, whose extension says the kind.
    pub fn new(path: &Path, size: [u32; 2]) -> Result<Self, FilmError> {
        let file = path.display().to_string();
        let Some(container) = Container::of(path) else {
            return Err(FilmError::NoContainer { file });
        };
        if container.has_even_sides() && size.iter().any(|side| !side.is_multiple_of(2)) {
            return Err(FilmError::OddSize { file, size });
        }
        let Some(ffmpeg) = find_ffmpeg() else {
            return Err(FilmError::NoFfmpeg { file });
        };
        Ok(Self {
            path: path.to_owned(),
            container,
            ffmpeg,
        })
    }
}

/// Size and timing of a video.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VideoOptions {
    /// Width and height, pixels.
    pub size: [u32; 2],
    pub frames: usize,
    /// How long each frame stays: a fraction of seconds, numerator and denominator.
    pub duration_s: [u32; 2],
    /// Starts again after its end, where the kind can say so.
    pub is_looping: bool,
}

/// A video that is being written. The file appears when it is finished, and otherwise not at all.
pub struct Video {
    /// The path for error messages.
    name: String,
    ffmpeg: Child,
    /// None when the last frame is on its way.
    frames: Option<SyncSender<Pixels>>,
    feeder: Option<JoinHandle<io::Result<()>>>,
    said: Receiver<String>,
    /// The file that ffmpeg writes; dropped after ffmpeg has ended.
    file: Option<AtomicFile>,
}

impl Video {
    /// Starts ffmpeg.
    pub fn begin(
        target: &VideoTarget,
        options: &VideoOptions,
        existing: Existing,
    ) -> Result<Self, FilmError> {
        let name = target.path.display().to_string();
        let file = AtomicFile::create(&target.path, existing)?;
        // With the protocol, a name that begins with a dash or has a colon is a name still.
        let mut url = std::ffi::OsString::from("file:");
        url.push(file.path());
        let arguments = target.container.arguments(
            options.size,
            options.duration_s,
            options.frames,
            options.is_looping,
        );
        let mut command = Command::new(&target.ffmpeg);
        command
            .args(arguments)
            .arg(url)
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let failed = |error: io::Error| FilmError::Ffmpeg {
            file: name.clone(),
            reason: error.to_string(),
        };
        let mut ffmpeg = command.spawn().map_err(failed)?;
        let (sender, frames) = mpsc::sync_channel(WAITING_FRAMES);
        let feeder = ffmpeg
            .stdin
            .take()
            .map(|stdin| thread::spawn(move || feed(stdin, &frames)));
        let (teller, said) = mpsc::channel();
        if let Some(stderr) = ffmpeg.stderr.take() {
            // The film may have been stopped by the time that ffmpeg says something.
            thread::spawn(move || drop(teller.send(listen(stderr))));
        }
        Ok(Self {
            name,
            ffmpeg,
            frames: Some(sender),
            feeder,
            said,
            file: Some(file),
        })
    }

    /// Adds the next frame.
    pub fn push(&mut self, pixels: Pixels, is_stopped: &dyn Fn() -> bool) -> Result<(), FilmError> {
        let mut waiting = pixels;
        while let Some(frames) = &self.frames {
            match frames.try_send(waiting) {
                Ok(()) => return Ok(()),
                Err(TrySendError::Full(pixels)) => waiting = pixels,
                Err(TrySendError::Disconnected(_)) => break,
            }
            if is_stopped() {
                return Err(FilmError::Stopped);
            }
            thread::sleep(PAUSE);
        }
        Err(self.failure())
    }

    /// Ends the video after its last frame.
    pub fn finish(mut self, is_stopped: &dyn Fn() -> bool) -> Result<(), FilmError> {
        self.frames = None;
        let status = loop {
            match self.ffmpeg.try_wait() {
                Ok(Some(status)) => break status,
                Ok(None) if is_stopped() => return Err(FilmError::Stopped),
                Ok(None) => thread::sleep(PAUSE),
                Err(error) => return Err(self.failed(error.to_string())),
            }
        };
        let is_fed = self
            .feeder
            .take()
            .is_some_and(|feeder| feeder.join().is_ok_and(|fed| fed.is_ok()));
        let Some(file) = self.file.take().filter(|_| status.success() && is_fed) else {
            return Err(self.failure());
        };
        if file.path().metadata().is_ok_and(|about| about.len() == 0) {
            return Err(self.failed("it wrote nothing".into()));
        }
        Ok(file.commit()?)
    }

    /// Why ffmpeg stopped reading, in its own words if it has any.
    fn failure(&mut self) -> FilmError {
        self.frames = None;
        let since = Instant::now();
        let mut ended = self.ffmpeg.try_wait();
        while matches!(ended, Ok(None)) && since.elapsed() < PATIENCE {
            thread::sleep(PAUSE);
            ended = self.ffmpeg.try_wait();
        }
        let said = self.said.recv_timeout(PATIENCE).ok();
        let how = match ended {
            Ok(Some(status)) => {
                format!("it ended with {status} before the film did, and said nothing")
            }
            _ => "it stopped reading before the end of the film, and said nothing".into(),
        };
        self.failed(said.as_deref().and_then(first_line).unwrap_or(how))
    }

    fn failed(&self, reason: String) -> FilmError {
        FilmError::Ffmpeg {
            file: self.name.clone(),
            reason,
        }
    }
}

impl Drop for Video {
    fn drop(&mut self) {
        // Ends ffmpeg after a stop or an error; after a finished film ffmpeg has exited already.
        drop(self.ffmpeg.kill());
        drop(self.ffmpeg.wait());
    }
}

/// Hands frames to ffmpeg until there are no more, and closes its stdin.
fn feed(mut stdin: ChildStdin, frames: &Receiver<Pixels>) -> io::Result<()> {
    frames
        .iter()
        .try_for_each(|pixels| stdin.write_all(bytemuck::cast_slice(&pixels)))
}

/// What ffmpeg writes to stderr until it ends.
fn listen(mut stderr: ChildStderr) -> String {
    let mut said = Vec::new();
    // What was read before an error is all there is to say.
    drop(stderr.by_ref().take(MAX_SAID).read_to_end(&mut said));
    drop(io::copy(&mut stderr, &mut io::sink()));
    String::from_utf8_lossy(&said).into_owned()
}
