//! Promise: every preset with a `[test]` table looks like its golden, and goldens are the oracle's.
//! Needs an adapter for the pictures alone.
//!
//! `UPDATE_SNAPSHOTS=1` redraws the goldens of failing presets, `UPDATE_SNAPSHOTS=force` all of
//! them: always by the oracle, with the code of `rasterlab bless`, so an adapter that is wrong
//! stays wrong.

use std::{
    collections::BTreeSet,
    fs,
    path::{Path, PathBuf},
};

use rasterlab::{
    frame::{Frame, NO_TRIANGLE},
    golden::{self, Golden},
    measure::{
        Budget,
        compare::{difference_picture, pictures},
    },
    oracle,
    plan::AccuracyRequest,
    preset::{Preset, Visibility},
    preset_file::{self, PresetFile},
    scene::Scene,
};

use crate::common::*;

type Picture = Vec<[u8; 4]>;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn snapshots() -> PathBuf {
    root().join("tests/snapshots")
}

/// All presets of the gallery, by id.
fn all_preset_files() -> Vec<PresetFile> {
    let folder = fs::read_dir(root().join("presets")).expect("presets/ can be read");
    let mut files: Vec<PathBuf> = folder
        .map(|entry| entry.expect("presets/ can be read").path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    files
        .iter()
        .map(|file| preset_file::load(file).unwrap_or_else(|error| panic!("{error}")))
        .collect()
}

/// Those that have a golden.
fn preset_files() -> Vec<PresetFile> {
    all_preset_files()
        .into_iter()
        .filter(|preset_file| preset_file.preset.test.is_some())
        .collect()
}

fn preset_file(id: &str) -> PresetFile {
    preset_files()
        .into_iter()
        .find(|preset_file| preset_file.id == id)
        .unwrap_or_else(|| panic!("no preset {id}"))
}

fn scene_of(preset_file: &PresetFile) -> std::sync::Arc<Scene> {
    preset_file::load_scene(&preset_file.preset, preset_file.path.as_deref())
        .unwrap_or_else(|error| panic!("{}: {error}", preset_file.id))
}

/// The comparator: what is wrong with a picture of `preset`, compared with its golden; integers and
/// the preset's budget.
fn complaint(preset: &Preset, actual: &Picture, golden: &Picture) -> Option<String> {
    complaint_but(preset, actual, golden, &[])
}

/// The same, where pixels of `band` have two right answers and are left to the judge; empty: none.
fn complaint_but(
    preset: &Preset,
    actual: &Picture,
    golden: &Picture,
    band: &[bool],
) -> Option<String> {
    let budget = preset.test.as_ref().expect("a preset with a golden");
    let mut held = golden.clone();
    let at_step = band.iter().enumerate().filter(|(_, is_band)| **is_band);
    at_step.for_each(|(i, _)| held[i] = actual[i]);
    let delta = pictures(actual, &held, budget.max_channel);
    // A wrong triangle id is a wrong pixel.
    let allowed = u64::from(budget.max_pixels) + u64::from(budget.max_wrong_triangles);
    if delta.pixels_over_tolerance <= allowed {
        return None;
    }
    let first = delta.mismatches.first().map(|o| {
        format!(
            ", first at {:?}: {:?} for {:?}",
            o.pixel(preset.output.size[0]),
            o.a,
            o.b
        )
    });
    Some(format!(
        "{} pixels differ by more than {} of 255 (at most {} may), largest {}{}",
        delta.pixels_over_tolerance,
        budget.max_channel,
        allowed,
        delta.max_delta,
        first.unwrap_or_default()
    ))
}

/// A snapshot on disk with what a failure leaves beside it.
struct Snapshot {
    folder: PathBuf,
    id: String,
}

impl Snapshot {
    fn path(&self, end: &str) -> PathBuf {
        self.folder.join(format!("{}{end}", self.id))
    }

    fn leave(&self, end: &str, picture: &Picture, size: [u32; 2]) {
        fs::write(
            self.path(end),
            preset_file::png_bytes(picture, size).expect("a PNG"),
        )
        .expect("the snapshots folder can be written");
    }

    /// Removes what an earlier failure or update left.
    fn tidy(&self) {
        [".new.png", ".diff.png", ".old.png"]
            .iter()
            .for_each(|end| drop(fs::remove_file(self.path(end))));
    }

    /// Stores the oracle's picture as the golden; the earlier one is renamed to `.old.png`.
    fn bless(&self, golden: &Golden) {
        let [picture, sidecar] = preset_file::golden_paths(&self.folder, &self.id);
        if picture.exists() {
            fs::rename(&picture, self.path(".old.png")).expect("the golden can be moved");
        }
        fs::write(picture, &golden.png)
            .and_then(|()| fs::write(sidecar, &golden.sidecar))
            .expect("the golden can be written");
    }

    /// Compares, and leaves `.new.png` and `.diff.png` or takes them away.
    /// Pixels of `band` are left to the judge.
    fn check(&self, preset: &Preset, actual: &Picture, band: &[bool]) -> Result<(), String> {
        let size = preset.output.size;
        let [path, _] = preset_file::golden_paths(&self.folder, &self.id);
        if !path.exists() {
            self.leave(".new.png", actual, size);
            return Err(format!(
                "{}: there is no golden; rasterlab bless {} draws one",
                self.id, self.id
            ));
        }
        let complaint = match preset_file::png_pixels(&path) {
            Err(error) => Some(error.to_string()),
            Ok((_, golden_size)) if golden_size != size => Some(format!(
                "the golden is {golden_size:?}, the preset {size:?}"
            )),
            Ok((golden, _)) => complaint_but(preset, actual, &golden, band).inspect(|_| {
                self.leave(".diff.png", &difference_picture(&golden, actual, 16), size);
            }),
        };
        match complaint {
            None => {
                self.tidy();
                Ok(())
            }
            Some(complaint) => {
                self.leave(".new.png", actual, size);
                Err(format!("{}: {complaint}", self.id))
            }
        }
    }
}

/// Exact, but for what the preset's own budget allows.
fn within_budget(errors: &rasterlab::measure::ErrorReport, preset: &Preset) -> Result<(), String> {
    match preset
        .test
        .as_ref()
        .map_or(0, |test| test.max_wrong_triangles)
    {
        0 => exactness(errors),
        most => errors.within(&Budget {
            max_wrong_triangles: most.into(),
            ..Budget::default()
        }),
    }
}

#[test]
fn every_preset_is_exact_and_looks_like_its_golden_first_half() {
    exact_and_like_their_goldens(0);
}

#[test]
fn every_preset_is_exact_and_looks_like_its_golden_second_half() {
    exact_and_like_their_goldens(1);
}

/// Judges and compares the presets of one half, so that two threads have something to do.
fn exact_and_like_their_goldens(half: usize) {
    let Some(mut renderer) = loan() else { return };
    let update = std::env::var("UPDATE_SNAPSHOTS").unwrap_or_default();
    let mut failures = Vec::new();
    let options = options(&renderer);
    let files = all_preset_files();
    let (first, second) = files.split_at(files.len() / 2);
    for (turn, preset_file) in [first, second][half].iter().enumerate() {
        let (id, preset) = (&preset_file.id, &preset_file.preset);
        let scene = scene_of(preset_file);
        let snapshot = Snapshot {
            folder: snapshots(),
            id: id.clone(),
        };
        let bless = || {
            snapshot
                .bless(&golden::draw(preset_file, &scene).expect("the oracle draws every preset"))
        };
        if update == "force" && preset.test.is_some() {
            bless();
        }
        // As the preset asks for it, after the pictures that lead up to it. The others meet the
        // options in turn.
        let option = preset
            .accuracy
            .pins
            .option::<Visibility>()
            .unwrap_or(options[turn % options.len()]);
        let as_asked = AccuracyRequest {
            pins: preset.accuracy.pins.with(option),
            ..preset.accuracy
        };
        let (capture, verdict) = renderer.judged_preset(&scene, preset, &as_asked);
        within_budget(&verdict.report, preset)
            .unwrap_or_else(|why| panic!("{id} {}: {why}", option.name()));
        if preset.test.is_none() {
            continue;
        }
        // Steps of color and edges of texels leave some pixels two right answers; the judge says
        // which, and that one of them was met.
        let mut outcome = snapshot.check(preset, &capture.frame.color, &verdict.step_band);
        if outcome.is_err() && update == "1" {
            bless();
            outcome = snapshot.check(preset, &capture.frame.color, &verdict.step_band);
        }
        failures.extend(outcome.err().map(|why| format!("{} {why}", option.name())));
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// Corners on half pixels: with edges in floats and all of them inclusive, samples on edges are
/// drawn twice.
#[test]
fn a_preset_that_pins_a_lossy_option_is_verified_within_its_budget_of_wrong_triangles() {
    if loan().is_none() {
        return;
    }
    let folder = tempfile::tempdir().expect("a temporary folder");
    let verify = |budget: &str| {
        let path = folder.path().join("lossy.toml");
        let scene = "grid?cell=4&lattice=2&width=64&height=48";
        let text = format!(
            "schema = 2\n[scene]\nbuiltin = \"{scene}\"\n[accuracy]\ncoverage = \"float\"\n[output]\nsize = [64, 48]\n{budget}"
        );
        fs::write(&path, text).expect("a preset can be written");
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_rasterlab"));
        let run = command
            .arg("verify")
            .arg(&path)
            .arg("--json")
            .args(["--frames", "2"])
            .output()
            .expect("the program runs");
        let object: serde_json::Value = serde_json::from_slice(&run.stdout).expect("one object");
        let rows = object["results"].as_array().expect("rows").iter();
        let stats = rows.flat_map(|row| {
            ["wrong_triangles", "double_hits", "holes", "unexplained"]
                .map(|name| row[name].as_u64().expect("a count"))
        });
        let is_told =
            object["results"][0]["without_budget"] == serde_json::json!(["coverage=float"]);
        assert_eq!(
            is_told,
            String::from_utf8_lossy(&run.stderr)
                .contains("may err by design, and the preset states no budget for it")
        );
        (run.status.code(), stats.max().expect("an option"), is_told)
    };
    let (exit, wrong, is_told) = verify("");
    assert!(
        exit == Some(1) && wrong > 100 && is_told,
        "{exit:?}, {wrong} without a budget"
    );
    // A number of pixels for something else is no budget for wrong triangles, as long as no more
    // pixels than that have another color.
    let elsewhere = verify("[test]\nmax_pixels = 3000\nwhy = \"dots\"\n");
    assert!(elsewhere.0 == Some(1) && elsewhere.2, "{elsewhere:?}");
    let budget = |most: u64| {
        format!(
            "[test]\nmax_wrong_triangles = {most}\nwhy = \"edges that touch a sample draw it twice\"\n"
        )
    };
    assert_eq!(
        (verify(&budget(wrong)).0, verify(&budget(wrong)).2),
        (Some(0), false)
    );
    assert_eq!(
        (verify(&budget(wrong - 1)).0, verify(&budget(wrong - 1)).2),
        (Some(1), false)
    );
}

#[test]
fn every_file_among_the_snapshots_belongs_to_a_preset() {
    let tested: BTreeSet<String> = preset_files()
        .into_iter()
        .map(|preset_file| preset_file.id)
        .collect();
    let dead: Vec<String> = fs::read_dir(snapshots())
        .expect("the snapshots folder can be read")
        .map(|entry| {
            entry
                .expect("the snapshots folder can be read")
                .file_name()
                .to_string_lossy()
                .into_owned()
        })
        .filter(|name| {
            let ends = [".new.png", ".diff.png", ".old.png", ".png", ".json"];
            !ends
                .iter()
                .any(|end| name.strip_suffix(end).is_some_and(|id| tested.contains(id)))
        })
        .collect();
    assert_eq!(dead, Vec::<String>::new());
}

// -------- the comparator itself

#[test]
fn a_failure_leaves_its_pictures_and_a_pass_takes_them_away() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let preset_file = preset_file("facet-knot");
    let golden =
        golden::draw(&preset_file, &scene_of(&preset_file)).expect("the oracle draws every preset");
    let snapshot = Snapshot {
        folder: folder.path().to_owned(),
        id: preset_file.id.clone(),
    };
    let there = |end: &str| snapshot.path(end).exists();

    assert!(
        snapshot
            .check(&preset_file.preset, &golden.frame.color, &[])
            .is_err_and(|why| why.contains("no golden"))
    );
    assert!(
        there(".new.png") && !there(".png"),
        "a missing golden fails, leaves the picture, and is not made"
    );

    snapshot.bless(&golden);
    assert!(
        snapshot
            .check(&preset_file.preset, &golden.frame.color, &[])
            .is_ok()
    );
    assert!(!there(".new.png"));

    let mut wrong = golden.frame.color.clone();
    wrong[77] = [255, 0, 255, 255];
    let why = snapshot
        .check(&preset_file.preset, &wrong, &[])
        .expect_err("one wrong pixel");
    assert!(
        why.contains("1 pixels differ by more than 1 of 255 (at most 0 may)")
            && why.contains("[77, 0]"),
        "{why}"
    );
    let (left, _) = preset_file::png_pixels(&snapshot.path(".new.png")).expect("the wrong picture");
    let (diff, _) = preset_file::png_pixels(&snapshot.path(".diff.png")).expect("the difference");
    assert_eq!(left, wrong);
    assert_eq!(
        diff.iter()
            .filter(|pixel| **pixel != [0, 0, 0, 255])
            .count(),
        1
    );

    assert!(
        snapshot
            .check(&preset_file.preset, &golden.frame.color, &[])
            .is_ok()
    );
    assert!(!there(".new.png") && !there(".diff.png") && there(".png") && there(".json"));

    snapshot.bless(&golden);
    assert!(there(".old.png"), "an update keeps what was there");
}

fn drawn(preset: &Preset, scene: &Scene) -> Frame {
    oracle::render_sequence(scene, &preset.moments(scene, preset.output.size))
        .expect("the oracle draws every preset")
}

#[test]
fn mutants_of_goldens_are_caught() {
    for preset_file in ["facet-knot", "triangle_id", "facet-radial"].map(preset_file) {
        let preset = &preset_file.preset;
        let frame = drawn(preset, &scene_of(&preset_file));
        let caught = |mutant: Picture| complaint(preset, &mutant, &frame.color).is_some();
        assert!(
            !caught(frame.color.clone()),
            "{}: the golden itself",
            preset_file.id
        );

        let width = preset.output.size[0] as usize;
        let rows = |shift: fn(&mut [[u8; 4]])| {
            let mut picture = frame.color.clone();
            picture.chunks_exact_mut(width).for_each(shift);
            picture
        };
        assert!(
            caught(rows(|row| row.rotate_right(1))),
            "{}: one pixel to the right",
            preset_file.id
        );
        assert!(
            caught(rows(|row| row.rotate_left(1))),
            "{}: one pixel to the left",
            preset_file.id
        );
        let mut down = frame.color.clone();
        down.rotate_right(width);
        assert!(caught(down), "{}: one pixel down", preset_file.id);

        let brighter = frame
            .color
            .iter()
            .map(|&[r, g, b, a]| {
                [
                    r.saturating_add(2),
                    g.saturating_add(2),
                    b.saturating_add(2),
                    a,
                ]
            })
            .collect();
        assert!(caught(brighter), "{}: two steps brighter", preset_file.id);
        let mut doubled = frame.color.clone();
        let shows =
            |i: usize| pictures(&doubled[i..=i], &doubled[i - 1..i], 1).pixels_over_tolerance > 0;
        let is_edge = |i: usize| {
            (frame.triangle_id[i] == NO_TRIANGLE) != (frame.triangle_id[i - 1] == NO_TRIANGLE)
                && shows(i)
        };
        // Of some presets a line or a fog hides many of them.
        let is_seam = |i: usize| frame.triangle_id[i] != frame.triangle_id[i - 1] && shows(i);
        let all = || 1..doubled.len();
        let edge = all()
            .find(|&i| is_edge(i))
            .or_else(|| all().find(|&i| is_seam(i)))
            .expect("an edge, or a seam where nothing is empty");
        doubled[edge] = doubled[edge - 1];
        let is_strict = preset
            .test
            .as_ref()
            .is_some_and(|test| test.max_pixels + test.max_wrong_triangles == 0);
        assert!(
            !is_strict || caught(doubled),
            "{}: a pixel of the edge is doubled",
            preset_file.id
        );
    }
}
