//! `review`: the presets whose picture differs from its golden, with numbers and, in a folder, the
//! pictures: what `check` finds, one line each, the worst first.

use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::{
    args::Common,
    backend::Backend,
    check::check,
    error::{CliError, Exit},
    files,
    finding::{Drawn, Finding},
    open::gallery_name,
    streams::{Streams, number},
    values::path,
};
use crate::{
    golden::{difference_text, has_golden},
    measure::compare::{PictureDelta, difference_picture, pictures},
    preset_file::{self, Existing},
};

/// Factor of the pictures of differences.
const GAIN: u8 = 16;

#[derive(Args, Debug)]
pub struct Review {
    /// Presets; without any, all of the gallery that have a golden. The oracle draws them, and every difference counts;
    /// with --adapter the adapter does, and those within the budget of [test] are left out
    #[arg(value_name = "PRESET")]
    pub files: Vec<String>,
    /// Write three pictures of each into this folder, PRESET.golden.png, PRESET.now.png and
    /// PRESET.difference.png (16 times the difference), and the listing as review.txt
    #[arg(long, short, value_name = "DIR", value_parser = path())]
    pub output: Option<PathBuf>,
    /// Folder of the goldens [default: snapshots beside the preset, if it is there, or else
    /// tests/snapshots]
    #[arg(long, value_name = "DIR")]
    pub snapshots: Option<PathBuf>,
}

/// A preset that differs from its golden, or cannot be compared with it.
struct Reviewed {
    preset: String,
    exit: Exit,
    /// In a sentence.
    text: String,
    drawn: Option<(Drawn, PictureDelta)>,
}

impl Reviewed {
    /// None if nothing differs that counts.
    fn of(finding: Finding, backend: &Backend) -> Option<Self> {
        let exact = finding.drawn.map(|drawn| {
            let delta = pictures(&drawn.expected, &drawn.actual, 0);
            (drawn, delta)
        });
        let differs = |(_, delta): &(Drawn, PictureDelta)| delta.pixels_over_tolerance > 0;
        let counts = !finding.problems.is_empty()
            || matches!(backend, Backend::Oracle) && exact.as_ref().is_some_and(differs);
        counts.then(|| Self {
            preset: finding.preset,
            exit: finding.exit.and(Exit::Failed),
            text: match &exact {
                Some((drawn, delta)) => difference_text(delta, drawn.size),
                None => finding.problems.join("; "),
            },
            drawn: exact,
        })
    }

    fn line(&self) -> String {
        format!("{}: {}\n", self.preset, self.text)
    }

    fn json(&self) -> Value {
        let delta = self.drawn.as_ref().map(|(_, delta)| delta);
        json!({
            "preset": self.preset, "text": self.text,
            "pixels": self.drawn.as_ref().map(|(drawn, _)| drawn.expected.len()),
            "pixels_changed": delta.map(|delta| delta.pixels_over_tolerance),
            "max_color_delta": delta.map(|delta| delta.max_delta),
            "rms_color_delta": delta.map(|delta| number(delta.rms)),
        })
    }
}

pub fn run(common: &Common, args: &Review, streams: &mut Streams) -> Result<Exit, CliError> {
    let names = match &args.files[..] {
        [] => preset_file::gallery(&common.folders())
            .iter()
            .filter(|entry| entry.preset_file.as_ref().is_ok_and(has_golden))
            .map(gallery_name)
            .collect(),
        names => names.to_vec(),
    };
    let mut backend = match common.adapter {
        Some(_) => Backend::open(common, streams)?,
        None => Backend::Oracle,
    };
    let bar = streams.progress(names.len() as u64);
    let mut reviewed = Vec::new();
    for name in &names {
        bar.set_message(name.clone());
        let snapshots = args.snapshots.as_deref();
        let finding = check(common, snapshots, name, Some(&mut backend));
        reviewed.extend(Reviewed::of(finding, &backend));
        bar.inc(1);
    }
    bar.finish_and_clear();
    // Those that cannot be compared come first, then those with the most pixels.
    let changed = |reviewed: &Reviewed| {
        let pixels = |(_, delta): &(Drawn, PictureDelta)| delta.pixels_over_tolerance;
        reviewed.drawn.as_ref().map_or(u64::MAX, pixels)
    };
    reviewed.sort_by_key(|one| std::cmp::Reverse(changed(one)));
    let listing: String = reviewed.iter().map(Reviewed::line).collect();
    if let Some(folder) = &args.output {
        write(folder, &reviewed, &listing, common.force)?;
    }
    if streams.json {
        let results = reviewed.iter().map(Reviewed::json).collect();
        streams.object("review", backend.json(), results)?;
    } else {
        streams.text(&listing)?;
    }
    streams.note(&match reviewed.len() {
        0 => format!("none of {} presets differs from its golden", names.len()),
        count => format!(
            "{count} of {} presets differ; rasterlab bless PRESET accepts what the oracle draws now",
            names.len()
        ),
    });
    Ok(reviewed
        .iter()
        .fold(Exit::Done, |exit, reviewed| exit.and(reviewed.exit)))
}

/// Writes the pictures and the listing into a folder, which is made if it is missing.
fn write(
    folder: &Path,
    reviewed: &[Reviewed],
    listing: &str,
    replaces: bool,
) -> Result<(), CliError> {
    std::fs::create_dir_all(folder)
        .map_err(|error| CliError::usage(format!("{}: {error}", folder.display())))?;
    let existing = match replaces {
        true => Existing::Replace,
        false => Existing::Keep,
    };
    let put = |name: String, bytes: &[u8]| files::write(&folder.join(name), bytes, existing);
    put("review.txt".into(), listing.as_bytes())?;
    for one in reviewed {
        let Some((drawn, _)) = &one.drawn else {
            continue;
        };
        let difference = difference_picture(&drawn.expected, &drawn.actual, GAIN);
        for (end, colors) in [
            ("golden", &drawn.expected),
            ("now", &drawn.actual),
            ("difference", &difference),
        ] {
            let png = preset_file::png_bytes(colors, drawn.size)?;
            put(format!("{}.{end}.png", one.preset), &png)?;
        }
    }
    Ok(())
}
