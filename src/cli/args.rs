//! The command line's commands and flags.

use std::path::PathBuf;

use clap::{Args, CommandFactory as _, Parser, Subcommand, ValueEnum};

use super::values::{fraction, frames, name, path, rate, size, turntable};
use crate::{
    effect_files::Hook,
    film::Turntable,
    link::PAGE,
    oracle,
    preset_file::Folders,
    scene::memory::{MemoryBudget, read_size},
};

/// An effects lab around a compute-shader rasterizer, judged by an exact oracle.
#[derive(Parser, Debug)]
#[command(name = "rasterlab", version, about, long_about = LONG)]
pub struct Cli {
    /// A preset, a model (.glb, .gltf, .vrm, .obj, .stl, .ply, .xyz, .pts, .las, .laz) or a PNG saved by rasterlab, to open in the window
    #[arg(value_name = "PRESET|MODEL|PICTURE.png")]
    pub open: Option<String>,
    /// Append the messages of the window's log to this file, each as a line
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub log: Option<PathBuf>,
    #[command(flatten)]
    pub common: Common,
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The shared options that were typed, by the names of their fields.
    #[arg(skip)]
    pub shared: Vec<String>,
}

const LONG: &str = "An effects lab around a compute-shader rasterizer, judged by an exact oracle.\n\n\
    Without a command the window opens. A PRESET is an id or a name of the gallery (rasterlab list presets), a .toml file, \
    a .glb, .gltf, .vrm, .obj, .stl, .ply, .xyz, .pts, .las or .laz model, a PNG saved by rasterlab, builtin:QUERY, or - for TOML from stdin.\n\n\
    Exit codes: 0 done; 1 a comparison, check or stress case failed, a measured error exceeds its limit, or a dry run found \
    changes; 2 wrong usage, or a file that cannot be read or written; 3 no suitable adapter; 4 the device was lost.";

/// Flags that commands share; [`takes`] says which has a use for which.
#[derive(Args, Debug, Default)]
#[command(next_help_heading = "Shared options")]
pub struct Common {
    /// Part of an adapter's name, or cpu for the built-in oracle [env: RASTERLAB_ADAPTER]
    #[arg(long, global = true, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Folder of presets that is searched first [default: presets, for commands] [env:
    /// RASTERLAB_PRESETS]
    #[arg(long, global = true, value_name = "DIR")]
    pub presets: Option<PathBuf>,
    /// Folder of effect files [default: effects], beside that of the user and `effects` beside a
    /// preset
    #[arg(long, global = true, value_name = "DIR")]
    pub effects: Option<PathBuf>,
    /// Folder of shaders that replaces the built-in ones; the window watches it [env:
    /// RASTERLAB_SHADERS]
    #[arg(long, global = true, value_name = "DIR")]
    pub shaders: Option<PathBuf>,
    /// The look of this preset on the scene of the PRESET or model that a command names: its
    /// effects, lights, background and animation
    #[arg(long, global = true, value_name = "ID|FILE")]
    pub preset: Option<String>,
    /// Open the model that a picture or a shared line names outside of its folder; without it only
    /// the look is used
    #[arg(long, global = true)]
    pub allow_outside: bool,
    /// Change one value of the preset, e.g. facet.amount=.5; the name of an effect alone enables
    /// it
    #[arg(long, global = true, value_name = "PATH[=VALUE]")]
    pub set: Vec<String>,
    /// Reset one value to its default; the name of an effect disables it
    #[arg(long, global = true, value_name = "PATH")]
    pub unset: Vec<String>,
    /// Most memory that opening a scene may take, e.g. 8GiB [default: half of the machine's] [env:
    /// RASTERLAB_MEMORY]
    #[arg(long, global = true, value_name = "SIZE")]
    pub memory: Option<String>,
    /// Most memory that pictures and their scenes may take on the adapter, e.g. 2GiB [default: all
    /// there is]
    #[arg(long, global = true, value_name = "SIZE", value_parser = read_size)]
    pub device_memory: Option<u64>,
    /// Print one JSON object to stdout
    #[arg(long, global = true)]
    pub json: bool,
    /// Print neither progress nor notes
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Treat unknown keys in a preset, parts that its scene does not have, and what breaks the
    /// standard of its model, as errors
    #[arg(long, global = true)]
    pub strict: bool,
    /// Overwrite existing files
    #[arg(long, global = true)]
    pub force: bool,
}

impl Common {
    /// The folder of presets that is searched first: `--presets`, `RASTERLAB_PRESETS`, or `presets`
    /// in the current folder.
    pub fn presets_folder(&self) -> PathBuf {
        self.presets_dir().unwrap_or_else(|| "presets".into())
    }

    /// `--presets`, or `RASTERLAB_PRESETS`.
    pub fn presets_dir(&self) -> Option<PathBuf> {
        self.presets.clone().or_else(|| {
            std::env::var_os("RASTERLAB_PRESETS")
                .filter(|dir| !dir.is_empty())
                .map(PathBuf::from)
        })
    }

    /// `--effects`, or `effects` in the current folder.
    pub fn effects_dir(&self) -> PathBuf {
        self.effects.clone().unwrap_or_else(|| "effects".into())
    }

    /// Where every command looks for presets and effects.
    pub fn folders(&self) -> Folders {
        Folders::new(Some(self.presets_folder()), &self.effects_dir())
    }

    /// Where the window looks for presets and effects: in the current folder only for effects,
    /// since it also writes presets to their files.
    pub fn window_folders(&self) -> Folders {
        Folders::new(self.presets_dir(), &self.effects_dir())
    }

    /// `--memory`, or `RASTERLAB_MEMORY`.
    pub fn memory_budget(&self) -> Result<Option<MemoryBudget>, String> {
        let variable = || {
            std::env::var("RASTERLAB_MEMORY")
                .ok()
                .filter(|size| !size.is_empty())
        };
        let given = self
            .memory
            .clone()
            .map(|size| ("--memory", size))
            .or_else(|| Some(("RASTERLAB_MEMORY", variable()?)));
        let read = |(name, size): (&str, String)| {
            size.parse()
                .map_err(|error| format!("{name} {size}: {error}"))
        };
        given.map(read).transpose()
    }

    /// `RASTERLAB_ORACLE_GIB`, where it is a number above 0.
    pub fn oracle_gib(&self) -> Option<f64> {
        std::env::var(oracle::MEMORY_VARIABLE)
            .ok()?
            .trim()
            .parse()
            .ok()
            .filter(|gib| *gib > 0.0)
    }

    /// `--adapter`, or `RASTERLAB_ADAPTER`.
    pub fn adapter_name(&self) -> Option<String> {
        self.adapter.clone().or_else(|| {
            std::env::var("RASTERLAB_ADAPTER")
                .ok()
                .filter(|name| !name.is_empty())
        })
    }
}

#[derive(Subcommand, Debug)]
pub enum Command {
    /// List presets, effects with their parameters and ranges, built-in scenes and accuracy axes
    List(List),
    /// List adapters with backend, driver, limits and usable visibility options
    Adapters,
    /// Draw one picture of each preset
    Render(Render),
    /// Draw an animated preset frame by frame; finished frames are not drawn again
    Sequence(Sequence),
    /// Draw one or two values of a preset through several steps each, as one contact sheet
    Sweep(Sweep),
    /// Compare each preset on the adapter with the oracle, every buffer
    Verify(Verify),
    /// Compare two pictures or presets with each other
    Compare(Compare),
    /// Show the passes and buffers of a preset, and the reason for each
    Explain(Explain),
    /// Tell why a pixel shows what it shows: every triangle at it, and its color after each effect
    Probe(super::probe::Probe),
    /// List the materials, nodes and meshes of a scene as patterns for the key `on` of effects, and
    /// the variants of its materials
    Parts(Parts),
    /// Redraw goldens with the oracle
    Bless(Bless),
    /// Measure time and error of accuracy options and effects
    Bench(Bench),
    /// Run the extreme cases, each with its expected outcome
    Stress(Stress),
    /// Print the gallery of the README, every effect with its pictures, as Markdown
    Gallery(Gallery),
    /// Validate presets; with --render also compare them with their goldens
    Check(Check),
    /// List the presets whose picture differs from its golden, with numbers and pictures
    Review(super::review::Review),
    /// Write a commented effect file to begin with
    NewEffect(NewEffect),
    /// Print the link under which a page draws a preset, with the bits that its picture must have
    Link(Link),
    /// Write a web page with the picture of a preset, alive where the browser has WebGPU
    Page(Page),
    /// Print a completion script
    Completions { shell: clap_complete::Shell },
    /// Print the manual page, or write it and those of all commands into a folder
    #[command(hide = true)]
    Man { folder: Option<PathBuf> },
}

impl Command {
    pub fn name(&self) -> &'static str {
        match self {
            Self::List(_) => "list",
            Self::Adapters => "adapters",
            Self::Render(_) => "render",
            Self::Sequence(_) => "sequence",
            Self::Sweep(_) => "sweep",
            Self::Verify(_) => "verify",
            Self::Compare(_) => "compare",
            Self::Explain(_) => "explain",
            Self::Probe(_) => "probe",
            Self::Parts(_) => "parts",
            Self::Bless(_) => "bless",
            Self::Bench(_) => "bench",
            Self::Stress(_) => "stress",
            Self::Gallery(_) => "gallery",
            Self::Check(_) => "check",
            Self::Review(_) => "review",
            Self::NewEffect(_) => "new-effect",
            Self::Link(_) => "link",
            Self::Page(_) => "page",
            Self::Completions { .. } => "completions",
            Self::Man { .. } => "man",
        }
    }
}

/// Has a command a use for a shared option, by the name of its field? The others are refused.
pub fn takes(command: &str, option: &str) -> bool {
    const READS: &str = "presets effects shaders allow_outside memory json quiet strict";
    let (first, more) = match command {
        "completions" | "man" => return false,
        "adapters" => ("", "json quiet"),
        "gallery" => ("", "shaders quiet"),
        "list" => ("", "presets effects shaders json quiet"),
        "new-effect" => ("", "effects shaders json quiet force"),
        "stress" => ("", "adapter shaders memory device_memory json quiet"),
        "bless" => (READS, ""),
        "parts" | "link" => (READS, "preset set unset"),
        "page" => (READS, "preset set unset force"),
        "check" | "review" => return option != "preset",
        "bench" | "explain" | "probe" => return option != "force",
        _ => return true,
    };
    [first, more]
        .join(" ")
        .split(' ')
        .any(|name| name == option)
}

/// The names of the shared options.
pub fn shared_options() -> Vec<String> {
    let options = Common::augment_args(clap::Command::new("shared"));
    let names = options.get_arguments().map(|arg| arg.get_id().to_string());
    names.collect()
}

/// The table of all commands and flags, where the help of a command does not list what it refuses.
pub fn command() -> clap::Command {
    let mut command =
        Cli::command().mut_arg("log", |log| log.help_heading("Options of the window"));
    command.build();
    let shared = shared_options();
    command.mut_subcommands(|subcommand| {
        let name = subcommand.get_name().to_owned();
        let is_refused =
            |option: &str| shared.iter().any(|name| name == option) && !takes(&name, option);
        // In place: a built command knows its flags by their indices, which `mut_arg` would move.
        subcommand.mut_args(|arg| match is_refused(arg.get_id().as_str()) {
            true => arg.hide(true),
            false => arg,
        })
    })
}

#[derive(Args, Debug)]
pub struct NewEffect {
    /// Name of the effect, in small letters
    pub name: String,
    /// What the effect does: surface (what color is it), vertex (where is it), sample (is it
    /// drawn), pixel (finish the picture), image (passes that read other pixels)
    #[arg(long, default_value = "surface", value_parser = Hook::parse)]
    pub hook: Hook,
    /// Begin with the text of this effect instead
    #[arg(long, value_name = "EFFECT", conflicts_with = "hook")]
    pub from: Option<String>,
}

#[derive(Args, Debug)]
pub struct Link {
    #[arg(value_name = "PRESET")]
    pub input: String,
    /// Address of the page (docs/web.md)
    #[arg(long, value_name = "URL", default_value = PAGE)]
    pub page: String,
}

#[derive(Args, Debug)]
pub struct Page {
    #[arg(value_name = "PRESET")]
    pub input: String,
    /// File to write
    #[arg(short, long, value_name = "FILE", value_parser = path())]
    pub output: PathBuf,
    /// Address of the page that shows the picture alive (docs/web.md)
    #[arg(long, value_name = "URL", default_value = PAGE)]
    pub page: String,
    /// Size in pixels, e.g. 1920x1080, or 1080p, 4k, square or story
    #[arg(long, value_name = "WxH|NAME", value_parser = size)]
    pub size: Option<[u32; 2]>,
}

#[derive(Args, Debug)]
pub struct Gallery {
    /// Write it between the gallery markers of this file instead of to stdout
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub into: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct List {
    /// What to list; without any, everything
    #[arg(value_enum)]
    pub kinds: Vec<ListKind>,
}

/// What `list` can list.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ListKind {
    /// Presets of the gallery
    Presets,
    /// Effects with their parameters
    Effects,
    /// Built-in scenes with their parameters
    Scenes,
    /// Accuracy axes with their options, from fast to accurate
    Axes,
}

impl List {
    /// Is this kind listed?
    pub fn has(&self, kind: ListKind) -> bool {
        self.kinds.is_empty() || self.kinds.contains(&kind)
    }
}

#[derive(Args, Debug)]
pub struct Render {
    #[arg(required = true, value_name = "PRESET")]
    pub inputs: Vec<String>,
    /// File to write, - for stdout; may contain {preset} {effect} {n} {n:3} {adapter} {tier}
    #[arg(short, long, value_name = "FILE", default_value = "{preset}.png", value_parser = name())]
    pub output: String,
    /// Size in pixels, e.g. 1920x1080, or 1080p, 4k, square or story
    #[arg(long, value_name = "WxH|NAME", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Draw each preset on the way to this one, which shows the same scene: numbers, colors and
    /// cameras in between; effects, choices and whole numbers switch half way
    #[arg(long, value_name = "PRESET")]
    pub toward: Option<String>,
    /// How far on the way, 0 to 1
    #[arg(long, value_name = "F", requires = "toward", default_value = "0.5", value_parser = fraction)]
    pub by: f64,
    /// Draw each preset from this bookmark of its own instead of from its camera
    #[arg(long, value_name = "NAME")]
    pub bookmark: Option<String>,
    /// Time of the picture in seconds
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub time: Option<f64>,
    /// Named tolerance: draft, fast, precise, reference or strict
    #[arg(long, value_name = "T")]
    pub tier: Option<String>,
    /// Leave preset, version, adapter and driver out of the PNG
    #[arg(long)]
    pub bare: bool,
    /// Also write the id of the visible triangle of every pixel, 4294967295 for none, as a NumPy
    /// array of u32; placeholders as in --output
    #[arg(long, value_name = "FILE", value_parser = name())]
    pub triangle_ids: Option<String>,
    /// Also write the depth of the visible sample of every pixel, in meters along the view, NaN
    /// for none, as a NumPy array of f32
    #[arg(long, value_name = "FILE", value_parser = name())]
    pub depths: Option<String>,
}

#[derive(Args, Debug)]
pub struct Sequence {
    #[arg(value_name = "PRESET")]
    pub input: String,
    /// A file per frame, e.g. 'frame_{frame:4}.png'; may contain {preset} {effect} {frame}
    /// {frame:4} {adapter} {tier}
    #[arg(short, long, value_name = "FILE", required_unless_present_any = ["apng", "video", "count"], value_parser = name())]
    pub output: Option<String>,
    /// Write all frames into one animated PNG
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub apng: Option<PathBuf>,
    /// Write all frames into a video, .mp4, .webm or .gif, with ffmpeg
    #[arg(long, value_name = "FILE", value_parser = path())]
    pub video: Option<PathBuf>,
    /// Turn once over the range: the camera goes around the scene, or with =scene the scene turns
    /// before it
    #[arg(long, value_name = "WHAT", num_args = 0..=1, require_equals = true, default_missing_value = "camera", value_parser = turntable)]
    pub turntable: Option<Turntable>,
    /// Go to the look of this preset, which shows the same scene, evenly from the first frame to
    /// the last: numbers, colors and cameras in between; effects, choices and whole numbers switch
    /// half way
    #[arg(long, value_name = "PRESET")]
    pub toward: Option<String>,
    /// Print the number of frames and draw nothing
    #[arg(long)]
    pub count: bool,
    /// Time of frame 0 in seconds; default: begin of the preset's range
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub from: Option<f64>,
    /// End time in seconds, which is not drawn; default: end of the preset's range
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub to: Option<f64>,
    /// Frames per second, e.g. 24 or 30000/1001
    #[arg(long, value_name = "N", default_value = "30", value_parser = rate)]
    pub fps: f64,
    /// Frames A..B, B excluded; use it to split a job
    #[arg(long, value_name = "A..B", value_parser = frames)]
    pub frames: Option<[Option<u32>; 2]>,
    /// Size in pixels, e.g. 1920x1080, or 1080p, 4k, square or story
    #[arg(long, value_name = "WxH|NAME", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Named tolerance: draft, fast, precise, reference or strict
    #[arg(long, value_name = "T")]
    pub tier: Option<String>,
}

#[derive(Args, Debug)]
pub struct Sweep {
    #[arg(value_name = "PRESET")]
    pub input: String,
    /// A value and its steps, e.g. facet.amount=0..1:5 (from, to, number of steps) or
    /// facet.pattern=uniform,sweep; the first runs along the rows, a second from row to row
    #[arg(long, required = true, value_name = "PATH=STEPS")]
    pub vary: Vec<String>,
    /// File to write, - for stdout; may contain {preset} {effect} {n} {n:3} {adapter} {tier}
    #[arg(short, long, value_name = "FILE", default_value = "{preset}-sweep.png", value_parser = name())]
    pub output: String,
    /// Size of each picture in pixels, e.g. 320x240
    #[arg(long, value_name = "WxH|NAME", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Time of the pictures in seconds
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub time: Option<f64>,
    /// Named tolerance: draft, fast, precise, reference or strict
    #[arg(long, value_name = "T")]
    pub tier: Option<String>,
}

#[derive(Args, Debug)]
pub struct Verify {
    /// Presets; without any, every preset of the gallery that has a golden
    #[arg(value_name = "PRESET")]
    pub inputs: Vec<String>,
    /// Number of frames to draw; all must be bit-identical
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub frames: u32,
    /// Size in pixels instead of the preset's own
    #[arg(long, value_name = "WxH|NAME", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Folder for pictures of expected, actual and difference side by side
    #[arg(short, long, value_name = "DIR", value_parser = path())]
    pub output: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct Compare {
    /// A PNG or a preset
    pub a: String,
    /// A PNG or a preset
    pub b: String,
    /// Write a picture of the differences
    #[arg(short, long, value_name = "FILE", value_parser = name())]
    pub output: Option<String>,
    /// Largest allowed difference of a channel, of 255
    #[arg(long, default_value_t = 1)]
    pub max_channel: u8,
    /// Allowed number of pixels that differ by more
    #[arg(long, default_value_t = 0)]
    pub max_pixels: u64,
    /// Allowed number of pixels with another triangle, between presets
    #[arg(long, alias = "max-wrong-owner", default_value_t = 0)]
    pub max_wrong_triangles: u64,
    /// Size in pixels instead of the presets' own
    #[arg(long, value_name = "WxH|NAME", value_parser = size)]
    pub size: Option<[u32; 2]>,
}

#[derive(Args, Debug)]
pub struct Explain {
    #[arg(value_name = "PRESET")]
    pub input: String,
    /// Also time the frame and its passes
    #[arg(long)]
    pub measure: bool,
    /// Size in pixels instead of the preset's own
    #[arg(long, value_name = "WxH|NAME", value_parser = size)]
    pub size: Option<[u32; 2]>,
}

#[derive(Args, Debug)]
pub struct Parts {
    /// A preset, a model, or builtin:QUERY
    #[arg(value_name = "SCENE")]
    pub input: String,
}

#[derive(Args, Debug)]
pub struct Bless {
    /// Preset files, names of presets in the preset folder, or effects that have no preset yet and
    /// get one
    #[arg(value_name = "PRESET|EFFECT")]
    pub names: Vec<String>,
    /// Every preset that has a [test] table
    #[arg(long, conflicts_with = "names")]
    pub all: bool,
    /// Change nothing; exit 1 if any golden would change
    #[arg(long)]
    pub dry_run: bool,
    /// Folder of the goldens [default: snapshots beside the preset, if it is there, or else
    /// tests/snapshots]
    #[arg(long, value_name = "DIR")]
    pub snapshots: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct Bench {
    /// Presets; without any, the lambert effect on each --scene
    #[arg(value_name = "PRESET")]
    pub inputs: Vec<String>,
    /// A built-in scene by query, or a model file, instead of the preset's scene; may be repeated
    #[arg(long, value_name = "SCENE")]
    pub scene: Vec<String>,
    /// Measure every effect alone, with the values of the preset of its name, and no effect
    #[arg(long)]
    pub every_effect: bool,
    /// Accuracy axes, separated by commas: measure every combination of their options
    #[arg(
        long,
        value_name = "AXES",
        value_delimiter = ',',
        conflicts_with = "every_effect"
    )]
    pub axes: Vec<String>,
    /// With --axes: measure one changed option at a time instead of every combination; a row per
    /// option, columns per scene
    #[arg(long, requires = "axes")]
    pub each: bool,
    /// Size of the pictures in pixels
    #[arg(long, value_name = "WxH|NAME", value_parser = size, default_value = "1920x1080")]
    pub size: [u32; 2],
    /// Number of timed frames per row
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub samples: u32,
    /// Format of the output
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub format: Format,
}

#[derive(Args, Debug)]
pub struct Stress {
    /// Run only the cases whose names contain this text; several are separated by commas
    #[arg(long, value_name = "F")]
    pub filter: Option<String>,
    /// List the cases and draw nothing
    #[arg(long)]
    pub list: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    Table,
    Json,
    Csv,
    Md,
}

#[derive(Args, Debug)]
pub struct Check {
    /// Presets; without any, the whole gallery
    #[arg(value_name = "FILE")]
    pub files: Vec<String>,
    /// Also draw each preset on the adapter and compare it with its golden
    #[arg(long)]
    pub render: bool,
    /// Write one self-contained HTML file with all pictures
    #[arg(long, value_name = "FILE", requires = "render", value_parser = name())]
    pub report: Option<String>,
    /// Folder of the goldens [default: snapshots beside the preset, if it is there, or else
    /// tests/snapshots]
    #[arg(long, value_name = "DIR")]
    pub snapshots: Option<PathBuf>,
}
