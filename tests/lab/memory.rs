//! Promise: memory that a long job takes is given back: after Trade, and after an extreme case, the
//! program holds at most a fifth more than before. What a driver keeps of the kernels that it
//! compiled is not the program's: 25 MB a trade, lavapipe of Mesa 22.3.
#![cfg(all(target_os = "linux", target_env = "gnu"))]

use std::{
    alloc::{GlobalAlloc, Layout, System},
    sync::atomic::{AtomicUsize, Ordering},
    time::{Duration, Instant},
};

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;

use crate::harness::*;

/// The allocator of the system, and how many bytes the program holds of it.
struct Counted;

static HELD: AtomicUsize = AtomicUsize::new(0);

#[global_allocator]
static COUNTED: Counted = Counted;

#[allow(unsafe_code, reason = "an allocator has no safe form")]
// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Counted {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        HELD.fetch_add(layout.size(), Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.dealloc(block, layout) }
    }

    unsafe fn realloc(&self, block: *mut u8, layout: Layout, bytes: usize) -> *mut u8 {
        HELD.fetch_add(bytes, Ordering::Relaxed);
        HELD.fetch_sub(layout.size(), Ordering::Relaxed);
        unsafe { System.realloc(block, layout, bytes) }
    }
}

fn held_mb() -> f64 {
    HELD.load(Ordering::Relaxed) as f64 / 1e6
}

/// Measures the options of depth.
fn trade(lab: &mut Lab) {
    if !lab.state().is_trade_open() {
        press(lab, Modifiers::NONE, Key::M);
        for axis in ["coverage", "depth"] {
            click(lab, Role::CheckBox, &format!("Measure {axis}"));
        }
    }
    click(lab, Role::Button, "Measure");
    assert!(lab.state().trade_points() > 2, "{}", lab.state().log_text());
}

/// Draws and judges the largest pictures.
fn extremes(lab: &mut Lab) {
    if lab
        .query_by_role_and_label(Role::TextInput, "Cases")
        .is_none()
    {
        click(lab, Role::Button, "Judge");
        click(lab, Role::Button, "Run extreme cases…");
        lab.get_by_label("Cases").focus();
        lab.run_steps(2);
        lab.get_by_label("Cases").type_text("largest-width");
        lab.run_steps(3);
    }
    click(lab, Role::Button, "Run 1 case");
    let patience = Instant::now() + Duration::from_secs(240);
    while lab
        .query_by_role_and_label(Role::Button, "Stop the run")
        .is_some()
    {
        assert!(Instant::now() < patience, "the case does not end");
        lab.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    settle(lab);
    assert!(
        lab.state().log_text().contains("1 case: 1 "),
        "{}",
        lab.state().log_text()
    );
}

/// Does the job twice, so that what is kept once, as compiled kernels are, is not taken for what
/// grows.
fn returns(job: fn(&mut Lab)) {
    draw_pictures();
    let mut lab = lab("facet-sweep").expect("the parent has an adapter");
    let before = held_mb();
    let after = [(); 2].map(|()| {
        job(&mut lab);
        held_mb()
    });
    println!("{before:.0} MB before, {after:.0?} MB after");
    assert!(
        after[1] <= 1.2 * before,
        "{before:.0} MB before, {after:.0?} MB after"
    );
}

/// Run by the next test in separate processes, whose memory nothing else uses.
#[test]
#[ignore = "run by memory_after_a_long_job_is_about_what_it_was_before"]
fn child_that_measures() {
    returns(trade);
}

#[test]
#[ignore = "run by memory_after_a_long_job_is_about_what_it_was_before"]
fn child_that_runs_an_extreme_case() {
    returns(extremes);
}

/// Its two children measure whole jobs, 28 s of processor time on llvmpipe: `.ci/full` runs it.
#[test]
#[ignore = "slow: .ci/full"]
fn memory_after_a_long_job_is_about_what_it_was_before() {
    if crate::common::gpu().is_none() {
        return;
    }
    for job in [
        "memory::child_that_measures",
        "memory::child_that_runs_an_extreme_case",
    ] {
        let child = std::process::Command::new(std::env::current_exe().expect("this test"))
            .args(["--exact", job, "--ignored", "--nocapture"])
            .output()
            .expect("the child starts");
        let said = String::from_utf8_lossy(&child.stdout).into_owned()
            + &String::from_utf8_lossy(&child.stderr);
        assert!(child.status.success(), "{said}");
    }
}
