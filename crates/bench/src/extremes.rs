//! Extreme cases: the presets of `presets/extremes`, which the program carries. Each is drawn with
//! every exact visibility option and judged by the oracle and by its `[test]` table; the command
//! `stress` and the window's panel show what came of it.

use std::{
    io,
    panic::{AssertUnwindSafe, catch_unwind},
};

use pollster::FutureExt as _;
use rasterlab_files::preset_file::{self, BUILTIN_DIR, Folders, PresetFile};
use rasterlab_model::preset::GoldenTest;
use tempfile::TempDir;
use web_time::Instant;

use crate::{
    accuracy::Visibility,
    gpu::{RenderError, Renderer},
    oracle,
    plan::Caps,
    scene::draw::DrawError,
};

/// The folder below the built-in presets.
const FOLDER: &str = "extremes";

/// The cases whose names contain one of the parts of `filter`, which commas separate; all cases
/// without a filter.
pub fn names(filter: Option<&str>) -> Vec<&'static str> {
    let filter = filter.unwrap_or_default().to_lowercase();
    let parts: Vec<&str> = filter
        .split(',')
        .map(str::trim)
        .filter(|part| !part.is_empty())
        .collect();
    let files = BUILTIN_DIR
        .get_dir(FOLDER)
        .map_or(&[][..], |folder| folder.entries());
    let mut names: Vec<&str> = files
        .iter()
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|end| end == "toml"))
        .filter_map(|path| path.file_stem()?.to_str())
        .filter(|name| parts.is_empty() || parts.iter().any(|part| name.contains(part)))
        .collect();
    names.sort_unstable();
    names
}

/// The cases as files, so that their presets find the models beside them.
pub struct Cases {
    folder: TempDir,
}

impl Cases {
    /// Writes the files into a folder of their own, which goes with this.
    pub fn unpack() -> io::Result<Self> {
        let folder = TempDir::with_prefix("rasterlab-extremes")?;
        for file in BUILTIN_DIR
            .get_dir(FOLDER)
            .into_iter()
            .flat_map(|dir| dir.files())
        {
            let name = file.path().file_name().unwrap_or_default();
            std::fs::write(folder.path().join(name), file.contents())?;
        }
        Ok(Self { folder })
    }

    fn open(&self, name: &str) -> Result<PresetFile, String> {
        let path = self.folder.path().join(format!("{name}.toml"));
        preset_file::open(&path.to_string_lossy(), &Folders::default())
            .map_err(|error| error.to_string())
    }

    /// One sentence about a case.
    pub fn about(&self, name: &str) -> String {
        self.open(name)
            .map_or_else(|error| error, |preset_file| preset_file.preset.about)
    }

    /// Draws and judges a case. `keep_going` receives what is drawn next and may stop the run by
    /// returning false. The renderer can be used for the next case after every outcome but a
    /// failure. Within [`Work`](rasterlab_model::work::Work) that is canceled, the case ends as
    /// stopped.
    pub fn run(
        &self,
        name: &'static str,
        renderer: &mut Renderer,
        keep_going: &dyn Fn(&str) -> bool,
    ) -> Report {
        let began = Instant::now();
        let mut report = Report {
            name,
            about: String::new(),
            outcome: Outcome::Passed,
            pictures: 0,
            triangles: 0,
            ms: 0.0,
        };
        let drawn = AssertUnwindSafe(|| {
            let preset_file = self.open(name).map_err(End::Sentence)?;
            report.about = preset_file.preset.about.clone();
            draw(&preset_file, renderer, keep_going, &mut report)
        });
        let drawn = catch_unwind(drawn).unwrap_or_else(|_| {
            Err(End::Sentence(
                "the program panicked; see the terminal for details".into(),
            ))
        });
        report.outcome = match drawn {
            Ok(outcome) => outcome,
            Err(End::Stopped) => Outcome::Stopped,
            Err(End::Sentence(why)) => Outcome::Failed(why),
        };
        report.ms = began.elapsed().as_secs_f64() * 1e3;
        report
    }
}

/// Why a case ends before its outcome is known.
enum End {
    Stopped,
    Sentence(String),
}

impl From<String> for End {
    fn from(sentence: String) -> Self {
        Self::Sentence(sentence)
    }
}

/// The visibility options that lose nothing and that an adapter has.
fn options(caps: &Caps, pinned: Option<Visibility>) -> Vec<Visibility> {
    match pinned {
        Some(pinned) => vec![pinned],
        None => Visibility::EXACT
            .into_iter()
            .filter(|option| option.is_supported(caps.int64_atomics))
            .collect(),
    }
}

fn draw(
    preset_file: &PresetFile,
    renderer: &mut Renderer,
    keep_going: &dyn Fn(&str) -> bool,
    report: &mut Report,
) -> Result<Outcome, End> {
    let preset = &preset_file.preset;
    let test = preset.test.clone().unwrap_or_default();
    let scene = match preset_file::load_scene(preset, preset_file.path.as_deref()) {
        Ok(scene) => scene,
        Err(error) => return judge_refusal(&test, &error.to_string()),
    };
    let moments = preset.moments(&scene, preset.output.size);
    let Some((view, stack)) = moments.last() else {
        return Err("the preset shows no moment".to_owned().into());
    };
    for option in options(&renderer.gpu().caps, preset.accuracy.pins.option()) {
        if !keep_going(option.name()) {
            return Err(End::Stopped);
        }
        report.pictures += 1;
        report.triangles += scene.triangle_count();
        let mut accuracy = preset.accuracy;
        accuracy.pins = accuracy.pins.with(option);
        let capture = async {
            renderer.set_scene(&scene).await?;
            renderer.capture_last(&moments, &accuracy).await
        }
        .block_on();
        let capture = match capture {
            Ok(capture) => capture,
            Err(RenderError::Draw(DrawError::Canceled(_))) => return Err(End::Stopped),
            Err(error) => return judge_refusal(&test, &error.to_string()),
        };
        let verdict = match oracle::judge(&scene, view, stack, &capture.picture()) {
            Ok(verdict) => verdict,
            Err(DrawError::Canceled(_)) => return Err(End::Stopped),
            Err(error) => return Err(error.to_string().into()),
        };
        let over = test.pixels_over_tolerance(&verdict, &capture.frame);
        let mut faults = test.faults(&verdict.report, over, false);
        faults.extend(test.count_faults(&capture.frame, capture.layers.as_deref()));
        faults.extend(
            renderer
                .gpu()
                .take_error()
                .map(|error| format!("the device reports {error}")),
        );
        if !test.refused.is_empty() {
            faults.push(format!(
                "it was drawn but must be refused: {}",
                test.refused
            ));
        }
        if !faults.is_empty() {
            return Err(format!("{}: {}", option.name(), faults.join("; ")).into());
        }
    }
    Ok(Outcome::Passed)
}

/// What a refusal is to the test.
fn judge_refusal(test: &GoldenTest, sentence: &str) -> Result<Outcome, End> {
    if test.expects_refusal(sentence) {
        Ok(Outcome::Refused(sentence.into()))
    } else {
        Err(End::Sentence(sentence.into()))
    }
}

/// The outcome of a case.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    Passed,
    /// Refused as expected, with this sentence.
    Refused(String),
    /// What must hold does not, for these reasons.
    Failed(String),
    /// The user stopped the run.
    Stopped,
}

impl Outcome {
    /// The outcome as tables show it.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Refused(_) => "refused as expected",
            Self::Failed(_) => "FAILED",
            Self::Stopped => "stopped",
        }
    }

    /// The reason of a refusal or a failure.
    pub fn why(&self) -> Option<&str> {
        match self {
            Self::Refused(why) | Self::Failed(why) => Some(why),
            Self::Passed | Self::Stopped => None,
        }
    }

    /// Returns true if what must hold does not.
    pub const fn is_failure(&self) -> bool {
        matches!(self, Self::Failed(_))
    }
}

/// The result of running a case.
#[derive(Clone, Debug)]
pub struct Report {
    pub name: &'static str,
    /// What it draws, in one sentence.
    pub about: String,
    pub outcome: Outcome,
    pub pictures: u64,
    pub triangles: u64,
    /// Milliseconds.
    pub ms: f64,
}
