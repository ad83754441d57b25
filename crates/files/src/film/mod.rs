//! Films: the frames of an animated preset as PNG files, an animated PNG, or a video that `ffmpeg`
//! writes. The command line and the window both draw them with this.
//!
//! Every frame carries a fingerprint of its inputs. A complete picture with the right fingerprint
//! is not drawn again, so an interrupted film continues where it stopped, and several machines can
//! each draw a range into a shared folder.

mod error;
mod ffmpeg;
mod frames;
mod production;
mod schedule;
mod story;
mod turntable;
mod video;

pub use error::FilmError;
pub use ffmpeg::{Container, find_ffmpeg};
pub use frames::{FrameJob, frame_paths};
pub use production::{Observer, Outputs, Painter, Production};
pub use schedule::{Schedule, Times, read_rate};
pub use story::Film;
pub use turntable::Turntable;
pub use video::VideoTarget;
