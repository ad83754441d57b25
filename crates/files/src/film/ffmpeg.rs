//! What `ffmpeg` is told: where the program is, and its arguments for each kind of video.

use std::path::{Path, PathBuf};

/// The kinds of video.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Container {
    /// H.264.
    Mp4,
    /// VP9.
    Webm,
    Gif,
}

/// A GIF has one palette for the whole film, for which ffmpeg holds every frame in memory; above
/// this many bytes each frame gets its own.
const PALETTE_BYTES: u64 = 1 << 30;

impl Container {
    pub const ALL: [Self; 3] = [Self::Mp4, Self::Webm, Self::Gif];

    pub const fn extension(self) -> &'static str {
        match self {
            Self::Mp4 => "mp4",
            Self::Webm => "webm",
            Self::Gif => "gif",
        }
    }

    /// The kind that the name of a file says.
    pub fn of(path: &Path) -> Option<Self> {
        let extension = path.extension()?;
        Self::ALL
            .into_iter()
            .find(|container| extension.eq_ignore_ascii_case(container.extension()))
    }

    /// Must both sides be even? H.264 halves the resolution of colors.
    pub const fn has_even_sides(self) -> bool {
        matches!(self, Self::Mp4)
    }

    /// The rate at which a film of `fps` frames a second is drawn. A GIF counts hundredths of a
    /// second, and players slow down a frame that stays for fewer than two.
    pub const fn fps(self, fps: f64) -> f64 {
        match self {
            Self::Gif if fps > 50.0 => 50.0,
            _ => fps,
        }
    }

    /// What to say of a film of `fps` frames a second that has another rate as this kind.
    pub fn fps_note(self, fps: f64) -> Option<String> {
        (self.fps(fps) < fps).then(|| {
            format!("A GIF shows at most 50 frames a second, so the film has 50 instead of {fps}.")
        })
    }

    /// Everything in front of the name of the file. Frames come from stdin as rows of RGBA bytes.
    pub fn arguments(
        self,
        [width, height]: [u32; 2],
        duration_s: [u32; 2],
        frames: usize,
        is_looping: bool,
    ) -> Vec<String> {
        let [numerator, denominator] = duration_s;
        let input = format!(
            "-hide_banner -nostats -loglevel error -y -f rawvideo -pixel_format rgba -video_size {width}x{height} \
             -framerate {denominator}/{numerator} -i pipe:0 -an -map_metadata -1 -fflags +bitexact -flags:v +bitexact"
        );
        // Rec. 709 is what players assume; without the filter ffmpeg would convert with the matrix
        // of standard television. The frames are tagged and not the encoder, because newer
        // versions of ffmpeg let an encoder take its tags from the first frame.
        let colors = "-vf scale=out_color_matrix=bt709:out_range=tv:flags=accurate_rnd+full_chroma_int,format=yuv420p,\
                      setparams=color_primaries=bt709:color_trc=bt709:colorspace=bt709:range=tv";
        let bytes = 4 * u64::from(width) * u64::from(height) * frames as u64;
        let output = match self {
            Self::Mp4 => {
                format!("{colors} -c:v libx264 -preset medium -crf 16 -movflags +faststart -f mp4")
            }
            Self::Webm => format!("{colors} -c:v libvpx-vp9 -crf 22 -b:v 0 -row-mt 1 -f webm"),
            Self::Gif => {
                let (statistics, palette) = if bytes <= PALETTE_BYTES {
                    ("diff", "")
                } else {
                    ("single", ":new=1")
                };
                let filter = format!(
                    "[0:v]format=rgb24,split[a][b];[a]palettegen=stats_mode={statistics}[p];[b][p]paletteuse=dither=sierra2_4a{palette}"
                );
                format!(
                    "-filter_complex {filter} -loop {} -f gif",
                    if is_looping { 0 } else { -1 }
                )
            }
        };
        input
            .split_whitespace()
            .chain(output.split_whitespace())
            .map(str::to_owned)
            .collect()
    }
}

/// `ffmpeg` in the folders of `PATH`; the current folder is never searched.
pub fn find_ffmpeg() -> Option<PathBuf> {
    let name = format!("ffmpeg{}", std::env::consts::EXE_SUFFIX);
    let folders = std::env::var_os("PATH")?;
    std::env::split_paths(&folders)
        .filter(|folder| folder.is_absolute())
        .map(|folder| folder.join(&name))
        .find(|path| is_program(path))
}

#[cfg(unix)]
fn is_program(path: &Path) -> bool {
    use std::os::unix::fs::PermissionsExt as _;
    path.metadata()
        .is_ok_and(|about| about.is_file() && about.permissions().mode() & 0o111 != 0)
}

#[cfg(not(unix))]
fn is_program(path: &Path) -> bool {
    path.is_file()
}

/// The first line of what ffmpeg wrote to stderr, without the address of the part that says it. The
/// first one names the cause; the later ones follow from it.
pub fn first_line(said: &str) -> Option<String> {
    let line = said.lines().map(str::trim).find(|line| !line.is_empty())?;
    let line = match line
        .strip_prefix('[')
        .and_then(|rest| rest.split_once("] "))
    {
        Some((part, rest)) if part.contains(" @ 0x") => rest,
        _ => line,
    };
    Some(line.chars().filter(|c| !c.is_control()).take(300).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_says_the_kind() {
        let of = |name: &str| Container::of(Path::new(name));
        assert_eq!(
            [of("a.mp4"), of("b.WebM"), of("c.gif")],
            [
                Some(Container::Mp4),
                Some(Container::Webm),
                Some(Container::Gif)
            ]
        );
        assert_eq!([of("a.avi"), of("mp4"), of("a.mp4.png")], [None; 3]);
    }

    #[test]
    fn a_long_gif_is_not_held_in_memory() {
        let filter = |frames| {
            Container::Gif
                .arguments([1920, 1080], [1, 25], frames, true)
                .join(" ")
        };
        assert!(filter(10).contains("stats_mode=diff") && !filter(10).contains("new=1"));
        assert!(filter(1000).contains("stats_mode=single") && filter(1000).contains("new=1"));
    }

    #[test]
    fn the_cause_is_quoted_in_one_line() {
        let said = "\n[vost#0:0 @ 0x55d0c8f6] Unknown encoder 'libx264'\nError opening output files: Encoder not found\n";
        assert_eq!(
            first_line(said).as_deref(),
            Some("Unknown encoder 'libx264'")
        );
        assert_eq!(
            first_line("[why] not\u{1b}[31m\nmore").as_deref(),
            Some("[why] not[31m")
        );
        assert_eq!(first_line(" \n"), None);
    }
}
