//! Promise: a calibration is measured once, kept for the adapter, and used by `explain`; a file that is broken is named and measured anew.

use super::*;

fn is_skipped() -> bool {
    let is_skipped = std::env::var("RASTERLAB_GPU").as_deref() == Ok("skip");
    if is_skipped {
        eprintln!("RASTERLAB_GPU=skip: GPU tests are left out");
    }
    is_skipped
}

#[test]
fn a_calibration_is_kept_used_and_mended() {
    if is_skipped() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let without = run_in(folder.path(), &["explain", "facet", "--size", "64x48"]);
    assert!(without.out.contains("not predicted: this adapter has no calibration"), "{}", without.out);
    let unasked = run_in(folder.path(), &["explain", "facet", "--size", "64x48", "--measure", "--json", "--quiet"]);
    let cost = &json(&unasked)["results"][0]["cost"];
    assert!(cost["frame"]["predicted_ms"].is_null() && cost["frame"]["measured_ms"].as_f64().is_some_and(|ms| ms > 0.0), "{cost}");

    let first = run_in(folder.path(), &["calibrate", "--json"]);
    assert_eq!(first.code, 0, "{}", first.err);
    assert!(first.err.contains("pictures were measured in") && first.err.contains("kept in"), "{}", first.err);
    let results = json(&first)["results"].as_array().expect("results").clone();
    let units: Vec<_> = results.iter().filter(|one| one["unit"].is_string()).cloned().collect();
    let option = |name: &str| results.iter().find(|one| one["option"] == name).expect("a measured option")["of_the_defaults"].clone();
    let strict = option("vertex_transform=strict");
    assert!([0, 1].iter().all(|at| strict[at].as_f64().is_some_and(|fraction| fraction > 0.1 && fraction < 10.0)), "{strict}");
    let samples = results.iter().find_map(|one| one["max_small_samples"].as_u64());
    assert!(samples.is_some_and(|samples| (1..=16_384).contains(&samples)), "{results:?}");
    let ms = |unit: &str| units.iter().find(|one| one["unit"] == unit).and_then(|one| one["ms"].as_f64()).expect("a unit");
    assert!(ms("pass") > 0.0 && ms("small_operation") > 0.0 && ms("pixel_operation") + ms("pixel") > 0.0, "{units:?}");
    let again = run_in(folder.path(), &["calibrate", "--json"]);
    assert!(again.err.contains("the calibration that was kept"), "{}", again.err);
    for (one, other) in units.iter().zip(json(&again)["results"].as_array().expect("a result for every unit")) {
        let ms = [one, other].map(|unit| unit["ms"].as_f64().expect("a number"));
        assert!(one["unit"] == other["unit"] && (ms[0] - ms[1]).abs() <= 1e-12 * ms[0], "{one} {other}");
    }

    let explained = run_in(folder.path(), &["explain", "facet", "--size", "64x48", "--measure", "--json", "--quiet"]);
    let cost = &json(&explained)["results"][0]["cost"];
    let of = |name: &str| cost["frame"][name].as_f64().expect("a number");
    assert!((of("ratio") - of("predicted_ms") / of("measured_ms")).abs() < 1e-6 && of("predicted_ms") > 0.0, "{cost}");
    let passes = cost["passes"].as_array().unwrap();
    let sum: f64 = passes.iter().map(|pass| pass[1]["predicted_ms"].as_f64().unwrap() - ms("lone_pass")).sum();
    assert!(
        (sum - of("predicted_ms")).abs() < 1e-9,
        "a frame takes as long as its passes, less what timing them alone takes: {sum} {cost}"
    );

    let calibrations = folder.path().join("config/rasterlab/calibrations");
    let files: Vec<_> = fs::read_dir(&calibrations).unwrap().map(|file| file.unwrap().path()).collect();
    assert_eq!(files.len(), 1, "{files:?}");
    fs::write(&files[0], "{").unwrap();
    let broken = run_in(folder.path(), &["explain", "facet", "--size", "64x48"]);
    assert!(broken.code == 0 && broken.err.contains("is no calibration") && broken.out.contains("not predicted"), "{}", broken.err);
    let checked = run_in(folder.path(), &["calibrate", "--check", "1"]);
    assert!(checked.err.contains("is no calibration") && checked.err.contains("pictures were measured in"), "{}", checked.err);
    let last = checked.out.lines().last().unwrap_or_default();
    assert!(checked.out.starts_with("SEED") && last.contains("of 1 predictions within 25 % of the measured time"), "{}", checked.out);
}
