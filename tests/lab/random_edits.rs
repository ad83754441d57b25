//! Promise: the window does not panic, whatever a user does in it and in which order; a user whose
//! program is killed loses the edits of the last second alone.
#![cfg(target_os = "linux")]

use std::{
    cell::RefCell,
    fs,
    io::Write as _,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    time::{Duration, Instant},
};

use egui::{Event, Key, Modifiers, Pos2, Role, Vec2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use rasterlab::{preset_file, preset_file::Folders};

use crate::{harness::*, process::resident_mb, rounds::rounds};

/// Random numbers that are the same in every run.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        // Splitmix64.
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn index(&mut self, length: usize) -> usize {
        (self.bits() % length as u64) as usize
    }

    fn of<T: Clone>(&mut self, choices: &[T]) -> T {
        choices[self.index(choices.len())].clone()
    }

    fn position(&mut self, size: Vec2) -> Pos2 {
        let mut side = |length: f32| (self.bits() >> 40) as f32 / (1u64 << 24) as f32 * length;
        Pos2::new(side(size.x), side(size.y))
    }
}

/// What people do: how often it is done among ten.
const DEEDS: [Deed; 10] = [
    Deed::Press,
    Deed::Press,
    Deed::Click,
    Deed::Click,
    Deed::Click,
    Deed::Drag,
    Deed::Type,
    Deed::Search,
    Deed::Turn,
    Deed::Other,
];

#[derive(Clone, Copy)]
enum Deed {
    Press,
    Click,
    Drag,
    Type,
    Search,
    Turn,
    Other,
}

const KEYS: [Key; 40] = {
    use Key::*;
    [
        A, B, C, D, E, F, G, H, I, J, K, L, M, N, O, P, R, S, T, U, V, X, Y, Z, Num0, Num1, F1, F2,
        F11, Space, Enter, Escape, Tab, Delete, Home, End, ArrowUp, ArrowDown, ArrowLeft,
        ArrowRight,
    ]
};

const CLICKED: [Role; 7] = [
    Role::Button,
    Role::CheckBox,
    Role::ComboBox,
    Role::RadioButton,
    Role::TextInput,
    Role::SpinButton,
    Role::Slider,
];

const TEXTS: [&str; 14] = [
    "",
    "0.5",
    "-1",
    "1e9",
    "NaN",
    "30000/1001",
    "#ff8040",
    "facet",
    "cube-wall",
    "ß漢字",
    "../x",
    "[effects.lambert]\n",
    "schema = 2\n[scene]\nbuiltin = \"knot?tess=3\"\n[effects.facet]\namount = 0.5\n",
    "fn surface(p: Parameters, s: Surface) -> Surface { return s; }",
];

thread_local! {
    /// Where what is open is written after each frame.
    static STATES: RefCell<Option<fs::File>> = const { RefCell::new(None) };
}

/// The line that stands before a frame's state while the frame is drawn.
const BEGUN: &str = "a frame began\n";

/// The next frame.
fn frame(lab: &mut Lab) {
    STATES.with_borrow(|states| {
        if let Some(mut states) = states.as_ref() {
            states.write_all(BEGUN.as_bytes()).expect("a line");
        }
    });
    lab.step();
    STATES.with_borrow(|states| {
        if let Some(states) = states {
            let mut states: &fs::File = states;
            writeln!(states, "{}", state_line(lab)).expect("a line");
        }
    });
}

/// Does one thing, and says what.
fn act(lab: &mut Lab, random: &mut Random) -> String {
    let size = lab.ctx.content_rect().size();
    match random.of(&DEEDS) {
        Deed::Press => {
            let (key, modifiers) = (
                random.of(&KEYS),
                random.of(&[
                    Modifiers::NONE,
                    Modifiers::NONE,
                    Modifiers::SHIFT,
                    Modifiers::COMMAND,
                    Modifiers::COMMAND | Modifiers::SHIFT,
                    Modifiers::ALT,
                ]),
            );
            lab.key_press_modifiers(modifiers, key);
            format!("press {modifiers:?} {key:?}")
        }
        Deed::Click => {
            let role = random.of(&CLICKED);
            let nodes: Vec<_> = lab.query_all_by_role(role).collect();
            if nodes.is_empty() {
                return format!("nothing: no {role:?}");
            }
            let node = &nodes[random.index(nodes.len())];
            let label = node.accesskit_node().label().unwrap_or_default();
            node.scroll_to_me();
            node.click();
            format!("click {role:?} {label:?}")
        }
        Deed::Drag => {
            let (from, to) = (random.position(size), random.position(size));
            lab.drag_at(from);
            for part in 1..=4 {
                frame(lab);
                lab.hover_at(from + (to - from) * (part as f32 / 4.0));
            }
            frame(lab);
            lab.drop_at(to);
            format!("drag {from} to {to}")
        }
        Deed::Type => {
            let text = random.of(&TEXTS);
            lab.event(Event::Text(text.into()));
            frame(lab);
            lab.key_press_modifiers(Modifiers::NONE, random.of(&[Key::Enter, Key::Tab]));
            format!("type {text:?}")
        }
        Deed::Search => {
            lab.key_press_modifiers(Modifiers::COMMAND, Key::K);
            frame(lab);
            frame(lab);
            let letters: String = (0..2)
                .map(|_| char::from(b'a' + random.index(26) as u8))
                .collect();
            lab.event(Event::Text(letters.clone()));
            frame(lab);
            frame(lab);
            let rank = random.index(9);
            for _ in 0..rank {
                lab.key_press_modifiers(Modifiers::NONE, Key::ArrowDown);
                frame(lab);
            }
            lab.key_press_modifiers(Modifiers::NONE, Key::Enter);
            format!("the entry {rank} of {letters:?} in the palette")
        }
        Deed::Turn => {
            lab.hover_at(random.position(size));
            let delta = vec2(0.0, random.of(&[-400.0, -40.0, 40.0, 400.0]));
            lab.event(Event::MouseWheel {
                unit: egui::MouseWheelUnit::Point,
                source: egui::MouseWheelSource::Wheel,
                delta,
                phase: egui::TouchPhase::Move,
                modifiers: random.of(&[Modifiers::NONE, Modifiers::COMMAND]),
            });
            format!("turn the wheel by {delta}")
        }
        Deed::Other => match random.index(4) {
            0 => {
                let text = random.of(&TEXTS);
                lab.event(Event::Paste(text.into()));
                format!("paste {text:?}")
            }
            1 => {
                let size = random.of(&[[1280.0, 800.0], [900.0, 600.0], [640.0, 480.0]]);
                lab.set_size(size.into());
                format!("the window is {size:?}")
            }
            2 => {
                for _ in 0..random.index(4) {
                    lab.key_press_modifiers(Modifiers::COMMAND, Key::Z);
                    frame(lab);
                }
                "undo".into()
            }
            _ => {
                for _ in 0..40 {
                    if lab.state().is_idle() {
                        break;
                    }
                    frame(lab);
                    std::thread::sleep(Duration::from_millis(2));
                }
                "wait".into()
            }
        },
    }
}

/// A window on the preset `mine` in `folder`, which also keeps settings and session.
fn window(folder: &Path, open: Option<&str>) -> Option<Lab> {
    let presets = folder.join("presets");
    if !presets.exists() {
        fs::create_dir(&presets).expect("a folder");
        fs::write(presets.join("mine.toml"), MOVING).expect("a preset");
    }
    let folders = Folders {
        presets: Some(presets),
        ..Folders::default()
    };
    let lab = created(open, folders, Some(folder.join("config")), SIZE)?;
    // What no font has is a box in the program, too. The harness would panic.
    lab.ctx
        .set_missing_glyph_policy(egui::epaint::text::MissingGlyphPolicy::Tofu);
    Some(lab)
}

/// Processor time of this thread, so that other programs do not count.
fn thread_time() -> Duration {
    let stat = fs::read_to_string("/proc/thread-self/schedstat").expect("Linux tells");
    let nanoseconds = stat.split(' ').next().expect("a number");
    Duration::from_nanos(nanoseconds.parse().expect("a number"))
}

/// What a child does: seed, seconds, folder. Pictures are drawn where its seed is even.
const CHILD: &str = "RASTERLAB_RANDOM_EDITS";

fn child_of(test: &str, seed: u64, seconds: u64, folder: &Path) -> Command {
    let mut command = Command::new(std::env::current_exe().expect("this test"));
    command
        .args(["--exact", test, "--ignored", "--nocapture"])
        .env(CHILD, format!("{seed} {seconds} {}", folder.display()))
        // What is exported or thrown away without a folder stays in this one.
        .env("HOME", folder)
        .env("XDG_DATA_HOME", folder.join("data"))
        .current_dir(folder);
    command
}

/// What this child is to do.
fn orders() -> (u64, Duration, PathBuf) {
    let orders = std::env::var(CHILD).expect("the parent says what to do");
    let mut words = orders.splitn(3, ' ');
    let mut number = || words.next().and_then(|word| word.parse().ok());
    let (seed, seconds) = (number().expect("a seed"), number().expect("seconds"));
    let folder = words.next().expect("a folder").into();
    (seed, Duration::from_secs(seconds), folder)
}

/// Prints memory, and what took the window's thread longest, in processor time.
#[test]
#[ignore = "run by minutes_of_random_edits_leave_a_window_that_works"]
fn child_that_edits() {
    let (seed, time, folder) = orders();
    if seed % 2 == 0 {
        draw_pictures();
    }
    let mut lab = window(&folder, Some("mine")).expect("the parent has an adapter");
    let (mut random, start) = (Random(seed), Instant::now());
    let (mut slowest, mut deeds) = (Vec::new(), 0);
    let log = fs::File::create(folder.join("deeds.txt")).expect("a file");
    let mut early_mb = None;
    while start.elapsed() < time {
        let before = thread_time();
        let deed = act(&mut lab, &mut random);
        writeln!(&log, "{deed}").expect("a line");
        lab.step();
        lab.submit();
        slowest.push((thread_time().saturating_sub(before), deed));
        slowest.sort_by(|a, b| b.cmp(a));
        slowest.truncate(8);
        deeds += 1;
        if early_mb.is_none() && start.elapsed() > time / 6 {
            early_mb = Some(resident_mb());
        }
    }
    let (early_mb, late_mb) = (early_mb.expect("time"), resident_mb());
    println!("seed {seed}: {deeds} deeds; {early_mb:.0} MB after a sixth, {late_mb:.0} at the end");
    for (time, deed) in slowest {
        println!("{:.0} ms: {deed}", time.as_secs_f64() * 1e3);
    }
    // It still obeys.
    for _ in 0..4 {
        lab.key_press_modifiers(Modifiers::NONE, Key::Escape);
        lab.run_steps(2);
    }
    wait_until(&mut lab, "the window comes to rest", |lab| {
        lab.state().is_idle()
    });
}

/// An hour is RASTERLAB_ROUNDS=60.
#[test]
#[ignore = "slow: .ci/full"]
fn minutes_of_random_edits_leave_a_window_that_works() {
    if crate::common::gpu().is_none() {
        return;
    }
    let seconds = u64::from(rounds(60));
    for seed in [101, 102] {
        let folder = tempfile::tempdir().expect("a folder");
        let child = child_of(
            "random_edits::child_that_edits",
            seed,
            seconds / 2,
            folder.path(),
        )
        .output()
        .expect("the child starts");
        let said = String::from_utf8_lossy(&child.stdout).into_owned()
            + &String::from_utf8_lossy(&child.stderr);
        let deeds = fs::read_to_string(folder.path().join("deeds.txt")).unwrap_or_default();
        let last: Vec<_> = deeds.lines().rev().take(12).collect();
        assert!(
            child.status.success(),
            "seed {seed}: {said}\nlast deeds: {last:#?}"
        );
        println!("{said}");
    }
}

/// The preset that is open, as one line.
fn state_line(lab: &Lab) -> String {
    let text = preset_file::to_shared_toml(lab.state().preset_file());
    format!("{:?}", text)
}

/// Writes what is open after each frame into a file, until it is killed.
#[test]
#[ignore = "run by who_kills_the_program_loses_the_last_second"]
fn child_that_is_killed() {
    let (seed, time, folder) = orders();
    let mut lab = window(&folder, Some("mine")).expect("the parent has an adapter");
    let (mut random, start) = (Random(seed), Instant::now());
    STATES.set(Some(
        fs::File::create(folder.join("states.txt")).expect("a file"),
    ));
    while start.elapsed() < time {
        act(&mut lab, &mut random);
        frame(&mut lab);
        // The thread that writes the session gets a processor.
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// A frame is a quarter of a second of the window's clock. A change waits for a second, and a write
/// that has begun for another.
const FRAMES_LOST: usize = 10;

/// Five hundred are RASTERLAB_ROUNDS=63.
#[test]
#[ignore = "slow: .ci/full"]
fn who_kills_the_program_loses_the_last_second() {
    if crate::common::gpu().is_none() {
        return;
    }
    let mut random = Random(7);
    let (mut with_edits, mut without) = (0, 0);
    for seed in 0..u64::from(rounds(8)) {
        let folder = tempfile::tempdir().expect("a folder");
        let mut child = child_of(
            "random_edits::child_that_is_killed",
            seed,
            60,
            folder.path(),
        )
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the child starts");
        let states = folder.path().join("states.txt");
        while fs::metadata(&states).map_or(0, |states| states.len()) == 0 {
            assert!(
                child.try_wait().expect("a child").is_none(),
                "seed {seed}: it ended"
            );
            std::thread::sleep(Duration::from_millis(20));
        }
        std::thread::sleep(Duration::from_millis(random.bits() % 2500));
        child.kill().expect("it runs");
        child.wait().expect("it ends");

        let text = fs::read_to_string(&states).expect("states");
        // The last line may be cut off.
        let all: Vec<&str> = text.lines().filter(|line| line.ends_with('"')).collect();
        let mut lab = window(folder.path(), None).expect("an adapter");
        lab.run_steps(3);
        let asked = lab
            .query_by_role_and_label(Role::Button, "Open it again")
            .is_some();
        if !asked {
            assert!(
                all.len() <= FRAMES_LOST,
                "seed {seed}: after {} frames nothing is left",
                all.len()
            );
            without += 1;
            continue;
        }
        lab.get_by_role_and_label(Role::Button, "Open it again")
            .click();
        lab.run_steps(3);
        let restored = state_line(&lab);
        let late = &all[all.len().saturating_sub(FRAMES_LOST)..];
        // What a frame that was being drawn had already kept is newer than every line.
        let is_newer = text.ends_with(BEGUN) && !all.contains(&restored.as_str());
        assert!(
            late.contains(&restored.as_str()) || is_newer || all.len() <= FRAMES_LOST,
            "seed {seed}: of {} frames none of the last is restored, but {:?}",
            all.len(),
            all.iter().rposition(|state| *state == restored)
        );
        with_edits += 1;
    }
    println!("{with_edits} restored, {without} killed before anything was kept");
    assert!(with_edits > without);
}
