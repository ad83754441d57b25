//! What can be typed.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

/// An effects lab around a compute-shader rasterizer, judged by an exact oracle.
#[derive(Parser, Debug)]
#[command(name = "rasterlab", version, about, long_about = LONG)]
pub struct Cli {
    /// A preset, a model (.glb, .gltf) or a picture of ours to open in the window
    #[arg(value_name = "LOOK|MODEL|SHOT.png")]
    pub open: Option<String>,
    #[command(flatten)]
    pub common: Common,
    #[command(subcommand)]
    pub command: Option<Command>,
}

const LONG: &str = "An effects lab around a compute-shader rasterizer, judged by an exact oracle.\n\n\
    Without a command the window opens. A preset is an id of the gallery (rasterlab list), a .toml file, a .glb or .gltf \
    model, a PNG saved by rasterlab, builtin:QUERY, or - for TOML from stdin.\n\n\
    Exit codes: 0 done; 1 a comparison, check, stress case, promised accuracy or dry run failed; 2 usage, or a file that \
    cannot be read or written; 3 no suitable adapter; 4 the device was lost.";

/// Flags that every command has.
#[derive(Args, Debug, Default)]
pub struct Common {
    /// Part of an adapter's name, or cpu for the built-in oracle [env: RASTERLAB_ADAPTER]
    #[arg(long, global = true, value_name = "NAME")]
    pub adapter: Option<String>,
    /// Folder of presets that comes before all others [env: RASTERLAB_PRESETS]
    #[arg(long, global = true, value_name = "DIR")]
    pub presets: Option<PathBuf>,
    /// Change a key of the preset, e.g. facet.amount=.5; an effect's name alone enables it
    #[arg(long, global = true, value_name = "PATH[=VALUE]")]
    pub set: Vec<String>,
    /// Put a key back to its default; an effect's name takes it out
    #[arg(long, global = true, value_name = "PATH")]
    pub unset: Vec<String>,
    /// Print one JSON object
    #[arg(long, global = true)]
    pub json: bool,
    /// No progress, no notes
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Unknown keys in a preset are errors
    #[arg(long, global = true)]
    pub strict: bool,
    /// Overwrite existing files
    #[arg(long, global = true)]
    pub force: bool,
}

impl Common {
    /// `--presets`, or what the environment says.
    pub fn presets_dir(&self) -> Option<PathBuf> {
        self.presets.clone().or_else(|| std::env::var_os("RASTERLAB_PRESETS").filter(|dir| !dir.is_empty()).map(PathBuf::from))
    }

    /// `--adapter`, or what the environment says.
    pub fn adapter_name(&self) -> Option<String> {
        self.adapter.clone().or_else(|| std::env::var("RASTERLAB_ADAPTER").ok().filter(|name| !name.is_empty()))
    }
}

#[derive(Subcommand, Debug)]
pub enum Command {
    /// Presets, builtin scenes, effects and their parameters with ranges
    List(List),
    /// Every adapter with backend, driver, limits and usable options
    Adapters,
    /// One picture of each preset
    Render(Render),
    /// A moving preset, frame by frame; finished frames are not drawn again
    Sequence(Sequence),
    /// Each preset on the adapter against the oracle, all buffers
    Verify(Verify),
    /// Two pictures or presets against each other
    Compare(Compare),
    /// Passes, buffers, and the reason for each
    Explain(Explain),
    /// Redraw goldens with the oracle
    Bless(Bless),
    /// Milliseconds beside error, option by option
    Bench(Bench),
    /// The table of extreme cases, each against its expectation
    Stress(Stress),
    /// The README's gallery: every effect with its pictures, as Markdown
    Gallery(Gallery),
    /// Validate looks; with --render also against their goldens
    Check(Check),
    /// Show how the current schema changes preset files; with --write change them
    Migrate(Migrate),
    /// Print a completion script
    Completions { shell: clap_complete::Shell },
}

impl Command {
    pub fn name(&self) -> &'static str {
        match self {
            Self::List(_) => "list",
            Self::Adapters => "adapters",
            Self::Render(_) => "render",
            Self::Sequence(_) => "sequence",
            Self::Verify(_) => "verify",
            Self::Compare(_) => "compare",
            Self::Explain(_) => "explain",
            Self::Bless(_) => "bless",
            Self::Bench(_) => "bench",
            Self::Stress(_) => "stress",
            Self::Gallery(_) => "gallery",
            Self::Check(_) => "check",
            Self::Migrate(_) => "migrate",
            Self::Completions { .. } => "completions",
        }
    }
}

#[derive(Args, Debug)]
pub struct Gallery {
    /// Writes it between the marks of this file instead of to stdout
    #[arg(long, value_name = "FILE")]
    pub into: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct List {
    /// Only effects
    #[arg(long)]
    pub effects: bool,
    /// Only presets
    #[arg(long)]
    pub preset_files: bool,
    /// Only the accuracy axes: axes with their options, from fast to accurate
    #[arg(long)]
    pub axes: bool,
    /// Only builtin scenes
    #[arg(long)]
    pub scenes: bool,
}

#[derive(Args, Debug)]
pub struct Render {
    #[arg(required = true, value_name = "LOOK")]
    pub preset_files: Vec<String>,
    /// Where to; - for stdout. Knows {preset} {effect} {n} {n:3} {adapter} {tier}
    #[arg(short, long, value_name = "FILE", default_value = "{preset}.png")]
    pub output: String,
    /// Size in pixels, e.g. 1920x1080
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Time of the picture in seconds
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub time: Option<f64>,
    /// Named tolerance: draft, fast, precise, reference, strict
    #[arg(long, value_name = "T")]
    pub tier: Option<String>,
    /// Leave look, version, adapter and driver out of the PNG
    #[arg(long)]
    pub bare: bool,
}

#[derive(Args, Debug)]
pub struct Sequence {
    #[arg(value_name = "LOOK")]
    pub preset_file: String,
    /// A file per frame, e.g. 'frame_{frame:4}.png'. Knows {preset} {effect} {frame} {frame:4} {adapter} {tier}
    #[arg(short, long, value_name = "FILE", required_unless_present = "apng")]
    pub output: Option<String>,
    /// All frames in one animated PNG
    #[arg(long, value_name = "FILE")]
    pub apng: Option<PathBuf>,
    /// Time of frame 0 in seconds; without it the preset's own range begins
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub from: Option<f64>,
    /// Time at which the film is over, which is not drawn: it is the first moment of the next round
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub to: Option<f64>,
    /// Frames in a second of film
    #[arg(long, value_name = "N", default_value_t = 30.0)]
    pub fps: f64,
    /// Only these frames, B not among them: the share of one machine of many
    #[arg(long, value_name = "A..B", value_parser = frames)]
    pub frames: Option<[Option<u32>; 2]>,
    /// Size in pixels, e.g. 1920x1080
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Named tolerance: draft, fast, precise, reference, strict
    #[arg(long, value_name = "T")]
    pub tier: Option<String>,
}

#[derive(Args, Debug)]
pub struct Verify {
    /// Presets; without any, every preset of the gallery that has a golden
    #[arg(value_name = "LOOK")]
    pub preset_files: Vec<String>,
    /// Draw so many frames, which must be equal to the bit
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    pub frames: u32,
    /// Size in pixels instead of the preset's own
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
    /// Folder for pictures: expected, actual and difference side by side
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
}

#[derive(Args, Debug)]
pub struct Compare {
    /// A PNG or a preset
    pub a: String,
    /// A PNG or a preset
    pub b: String,
    /// Picture of the differences
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<String>,
    /// Largest difference of a channel that passes, of 255
    #[arg(long, default_value_t = 1)]
    pub max_channel: u8,
    /// Pixels beyond it that pass
    #[arg(long, default_value_t = 0)]
    pub max_pixels: u64,
    /// Pixels with another triangle id that pass, between presets
    #[arg(long, default_value_t = 0)]
    pub max_wrong_triangles: u64,
    /// Size in pixels of presets instead of their own
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
}

#[derive(Args, Debug)]
pub struct Explain {
    pub preset_file: String,
    /// Size in pixels instead of the preset's own
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub size: Option<[u32; 2]>,
}

#[derive(Args, Debug)]
pub struct Bless {
    /// Presets of the preset folder, or effects whose first preset is to be made
    #[arg(value_name = "LOOK|EFFECT")]
    pub names: Vec<String>,
    /// Every preset that has a [test] table
    #[arg(long, conflicts_with = "names")]
    pub all: bool,
    /// Change nothing; exit 1 if any golden would change
    #[arg(long)]
    pub dry_run: bool,
    /// Folder of the goldens
    #[arg(long, value_name = "DIR", default_value = "tests/snapshots")]
    pub snapshots: PathBuf,
}

#[derive(Args, Debug)]
pub struct Bench {
    /// Presets; without any, daylight on each --scene
    #[arg(value_name = "LOOK")]
    pub preset_files: Vec<String>,
    /// A builtin scene by query or a model file, instead of the preset's own; may be repeated
    #[arg(long, value_name = "SCENE")]
    pub scene: Vec<String>,
    /// What every effect costs: each alone, with the values of its canonical preset, beside none
    #[arg(long)]
    pub effects: bool,
    /// Axes of the accuracy axes, by commas: every combination of their options, milliseconds beside error
    #[arg(long, value_name = "AXES", value_delimiter = ',', conflicts_with = "effects")]
    pub axes: Vec<String>,
    /// With --axes: every option alone beside the preset as it is planned, instead of every combination; a row per option, a pair of
    /// columns per scene
    #[arg(long, requires = "axes")]
    pub each: bool,
    /// Size in pixels of every row
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "1920x1080")]
    pub size: [u32; 2],
    /// Timed frames per row
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub samples: u32,
    #[arg(long, value_enum, default_value_t = Format::Table)]
    pub format: Format,
}

#[derive(Args, Debug)]
pub struct Stress {
    /// Only cases of this number, or whose name contains this
    #[arg(long, value_name = "F")]
    pub filter: Option<String>,
    /// Seed of every case that throws dice
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u32,
    /// Draw nothing; show the cases
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
pub struct Migrate {
    /// Preset files
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Change the files
    #[arg(long)]
    pub write: bool,
}

#[derive(Args, Debug)]
pub struct Check {
    /// Presets; without any, the whole gallery
    #[arg(value_name = "FILE")]
    pub files: Vec<String>,
    /// Also draw each on the adapter and compare it with its golden
    #[arg(long)]
    pub render: bool,
    /// One self-contained HTML file with all pictures
    #[arg(long, value_name = "FILE", requires = "render")]
    pub report: Option<String>,
    /// Folder of the goldens
    #[arg(long, value_name = "DIR", default_value = "tests/snapshots")]
    pub snapshots: PathBuf,
}

/// `30..60`, `..60`, `30..`.
fn frames(text: &str) -> Result<[Option<u32>; 2], String> {
    let wrong = || format!("frames are A..B, A.. or ..B with whole numbers, B not among them, for instance 0..60; {text:?} is not");
    let (from, to) = text.split_once("..").ok_or_else(wrong)?;
    let end = |end: &str| if end.is_empty() { Ok(None) } else { end.parse().map(Some).map_err(|_| wrong()) };
    match [end(from)?, end(to)?] {
        [Some(from), Some(to)] if from >= to => Err(format!("frames {text} hold no frame: {from} is not before {to}")),
        ends => Ok(ends),
    }
}

/// `1920x1080`.
fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("a size is WIDTHxHEIGHT, each 0 to 16384, for instance 1920x1080; {text:?} is not");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let side = |side: &str| side.parse().ok().filter(|side| *side <= 16_384).ok_or_else(wrong);
    Ok([side(width)?, side(height)?])
}
