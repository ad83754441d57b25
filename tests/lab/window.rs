//! Promise: a real window on a virtual display (Xvfb) opens, draws, follows the pointer, saves a
//! preset, shares the clipboard with other programs and closes.

use std::{
    io::{BufRead as _, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    time::{Duration, Instant},
};

use rasterlab::preset_file::{self, Folders};
use x11rb::{
    connection::Connection as _,
    protocol::{
        Event,
        xproto::{
            AtomEnum, BUTTON_PRESS_EVENT, BUTTON_RELEASE_EVENT, ClientMessageEvent,
            ConnectionExt as _, CreateWindowAux, EventMask, ImageFormat, InputFocus,
            KEY_PRESS_EVENT, KEY_RELEASE_EVENT, MOTION_NOTIFY_EVENT, PropMode,
            SELECTION_NOTIFY_EVENT, SelectionNotifyEvent, Window, WindowClass,
        },
        xtest::ConnectionExt as _,
    },
    rust_connection::RustConnection,
    wrapper::ConnectionExt as _,
};

const SIZE: [u16; 2] = [1280, 800];

/// How long anything may take before the test gives up: a software adapter compiles kernels on a
/// busy machine.
const PATIENCE: Duration = Duration::from_secs(120);

/// A process that does not outlive its test.
struct Owned(Child);

impl Drop for Owned {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// A display without a monitor, and a client on it.
struct Display {
    x: RustConnection,
    root: Window,
    name: String,
    _server: Owned,
}

impl Display {
    fn open() -> Self {
        let [width, height] = SIZE;
        let server = Command::new("Xvfb")
            .args([
                "-displayfd",
                "1",
                "-nolisten",
                "tcp",
                "-screen",
                "0",
                &format!("{width}x{height}x24"),
            ])
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn();
        let mut server = Owned(
            server.expect("Xvfb cannot be started; install it (Debian: apt-get install xvfb)"),
        );
        let mut number = String::new();
        BufReader::new(server.0.stdout.take().expect("a pipe"))
            .read_line(&mut number)
            .expect("Xvfb says its display");
        let name = format!(":{}", number.trim());
        let (x, screen) = RustConnection::connect(Some(&name))
            .unwrap_or_else(|error| panic!("display {name}: {error}"));
        let root = x.setup().roots[screen].root;
        Self {
            x,
            root,
            name,
            _server: server,
        }
    }

    /// The screen's pixels, rows from the top, `[r, g, b]`.
    fn screenshot(&self) -> Vec<[u8; 3]> {
        let [width, height] = SIZE;
        let image = self
            .x
            .get_image(ImageFormat::Z_PIXMAP, self.root, 0, 0, width, height, !0)
            .expect("a request")
            .reply()
            .expect("a screenshot");
        image
            .data
            .chunks_exact(4)
            .map(|p| [p[2], p[1], p[0]])
            .collect()
    }

    /// The part where the picture is, between the panels.
    fn view(&self) -> Vec<[u8; 3]> {
        let shot = self.screenshot();
        let width = usize::from(SIZE[0]);
        (90..usize::from(SIZE[1]) - 90)
            .flat_map(|y| shot[y * width + 290..y * width + 920].to_vec())
            .collect()
    }

    fn fake(&self, kind: u8, detail: u8, [x, y]: [i16; 2]) {
        self.x
            .xtest_fake_input(kind, detail, 0, self.root, x, y, 0)
            .expect("a request")
            .check()
            .expect("fake input");
        std::thread::sleep(Duration::from_millis(30));
    }

    fn drag(&self, from: [i16; 2], by: [i16; 2]) {
        self.fake(MOTION_NOTIFY_EVENT, 0, from);
        self.fake(BUTTON_PRESS_EVENT, 1, [0, 0]);
        for step in 1..=10 {
            self.fake(
                MOTION_NOTIFY_EVENT,
                0,
                [from[0] + by[0] * step / 10, from[1] + by[1] * step / 10],
            );
        }
        self.fake(BUTTON_RELEASE_EVENT, 1, [0, 0]);
    }

    /// Presses keys together, by X keysyms, and lets them go.
    fn press(&self, keysyms: &[u32]) {
        let codes: Vec<u8> = keysyms.iter().map(|&keysym| self.keycode(keysym)).collect();
        codes
            .iter()
            .for_each(|&code| self.fake(KEY_PRESS_EVENT, code, [0, 0]));
        codes
            .iter()
            .rev()
            .for_each(|&code| self.fake(KEY_RELEASE_EVENT, code, [0, 0]));
    }

    fn keycode(&self, keysym: u32) -> u8 {
        let setup = self.x.setup();
        let (low, high) = (setup.min_keycode, setup.max_keycode);
        let map = self
            .x
            .get_keyboard_mapping(low, high - low + 1)
            .expect("a request")
            .reply()
            .expect("a keyboard map");
        let index = map
            .keysyms
            .chunks(map.keysyms_per_keycode.into())
            .position(|symbols| symbols.contains(&keysym));
        low + index.unwrap_or_else(|| panic!("no key for keysym {keysym:#x}")) as u8
    }

    /// The lab's window.
    fn window(&self) -> Window {
        let children = self
            .x
            .query_tree(self.root)
            .expect("a request")
            .reply()
            .expect("the window tree")
            .children;
        let viewable = |w: &Window| {
            let size = self
                .x
                .get_geometry(*w)
                .ok()
                .and_then(|cookie| cookie.reply().ok());
            size.is_some_and(|size| size.width > 600)
        };
        *children
            .iter()
            .find(|w| viewable(w))
            .expect("the lab's window")
    }

    /// Width and height of the lab's window.
    fn size(&self) -> [u16; 2] {
        let geometry = self
            .x
            .get_geometry(self.window())
            .expect("a request")
            .reply()
            .expect("the window's geometry");
        [geometry.width, geometry.height]
    }

    /// Gives the keyboard to the window, as a window manager would.
    fn focus(&self) {
        let window = self.window();
        self.x
            .set_input_focus(InputFocus::POINTER_ROOT, window, x11rb::CURRENT_TIME)
            .expect("a request")
            .check()
            .expect("the focus");
    }

    fn atom(&self, name: &str) -> u32 {
        let cookie = self.x.intern_atom(false, name.as_bytes());
        cookie.expect("a request").reply().expect("an atom").atom
    }

    /// A window of another program, which is not shown.
    fn other_window(&self) -> Window {
        let window = self.x.generate_id().expect("an id");
        let aux = CreateWindowAux::new();
        let class = WindowClass::INPUT_OUTPUT;
        self.x
            .create_window(0, window, self.root, 0, 0, 1, 1, 0, class, 0, &aux)
            .expect("a request")
            .check()
            .expect("a window");
        window
    }

    /// Asks the owner of the clipboard for its text, which then comes as an event.
    fn ask_for_text(&self, other: Window) {
        let [clipboard, utf8] = ["CLIPBOARD", "UTF8_STRING"].map(|name| self.atom(name));
        self.x
            .convert_selection(other, clipboard, utf8, clipboard, x11rb::CURRENT_TIME)
            .expect("a request")
            .check()
            .expect("the text is asked for");
    }

    /// Takes what has come for `other`: gives `offered` to who asks for the clipboard.
    fn exchange(&self, other: Window, offered: &str) -> Option<Exchanged> {
        let utf8 = self.atom("UTF8_STRING");
        while let Some(event) = self.x.poll_for_event().expect("a connection") {
            match event {
                Event::SelectionRequest(asked) => {
                    let property = match asked.target == utf8 {
                        true => asked.property,
                        false => x11rb::NONE,
                    };
                    if property != x11rb::NONE {
                        let (mode, bytes) = (PropMode::REPLACE, offered.as_bytes());
                        self.x
                            .change_property8(mode, asked.requestor, property, utf8, bytes)
                            .expect("a request");
                    }
                    let notify = SelectionNotifyEvent {
                        response_type: SELECTION_NOTIFY_EVENT,
                        sequence: 0,
                        time: asked.time,
                        requestor: asked.requestor,
                        selection: asked.selection,
                        target: asked.target,
                        property,
                    };
                    self.x
                        .send_event(false, asked.requestor, EventMask::NO_EVENT, notify)
                        .expect("a request");
                    self.x.flush().expect("a connection");
                    if property != x11rb::NONE {
                        return Some(Exchanged::Given);
                    }
                }
                Event::SelectionNotify(came) if came.property != x11rb::NONE => {
                    let any = AtomEnum::ANY;
                    let cookie = self
                        .x
                        .get_property(true, other, came.property, any, 0, 1 << 20);
                    let value = cookie.expect("a request").reply().expect("a text").value;
                    return String::from_utf8(value).ok().map(Exchanged::Taken);
                }
                _ => {}
            }
        }
        None
    }

    /// What a window manager sends when its close button is pressed.
    fn ask_to_close(&self) {
        let window = self.window();
        let event = ClientMessageEvent::new(
            32,
            window,
            self.atom("WM_PROTOCOLS"),
            [self.atom("WM_DELETE_WINDOW"), x11rb::CURRENT_TIME, 0, 0, 0],
        );
        self.x
            .send_event(false, window, EventMask::NO_EVENT, event)
            .expect("a request")
            .check()
            .expect("the event is sent");
    }
}

/// What became of the clipboard between two programs.
enum Exchanged {
    Given,
    Taken(String),
}

/// The lab on `display`, at home in `home`.
fn start(display: &Display, home: &Path, arguments: &[&str]) -> Owned {
    let lab = Command::new(env!("CARGO_BIN_EXE_rasterlab"))
        .args(arguments)
        .current_dir(home)
        .env("DISPLAY", &display.name)
        .env_remove("WAYLAND_DISPLAY")
        .env("HOME", home)
        .env("XDG_CONFIG_HOME", home.join(".config"))
        .env("XDG_RUNTIME_DIR", home)
        .spawn();
    Owned(lab.expect("the binary starts"))
}

/// Waits until `reached`, or says what did not happen.
fn wait_for(what: &str, lab: &mut Owned, mut reached: impl FnMut() -> bool) {
    let patience = Instant::now() + PATIENCE;
    while !reached() {
        if let Some(status) = lab.0.try_wait().expect("the status of a child process") {
            panic!("the lab ended with {status} before {what}");
        }
        assert!(
            Instant::now() < patience,
            "{what}: it did not happen within {} s",
            PATIENCE.as_secs()
        );
        std::thread::sleep(Duration::from_millis(100));
    }
}

fn wait_for_exit(lab: &mut Owned) -> ExitStatus {
    let patience = Instant::now() + PATIENCE;
    loop {
        if let Some(status) = lab.0.try_wait().expect("the status of a child process") {
            return status;
        }
        assert!(Instant::now() < patience, "the lab did not end");
        std::thread::sleep(Duration::from_millis(50));
    }
}

/// Pixels that differ clearly from the most frequent color.
fn drawn(view: &[[u8; 3]]) -> usize {
    let mut counts = std::collections::HashMap::new();
    view.iter()
        .for_each(|pixel| *counts.entry(*pixel).or_insert(0usize) += 1);
    let Some((background, _)) = counts.into_iter().max_by_key(|(_, count)| *count) else {
        return 0;
    };
    view.iter()
        .filter(|pixel| {
            pixel
                .iter()
                .zip(background)
                .any(|(a, b)| a.abs_diff(b) > 24)
        })
        .count()
}

const CONTROL: u32 = 0xffe3;
const RETURN: u32 = 0xff0d;

fn is_skipped() -> bool {
    let skipped = std::env::var("RASTERLAB_GPU").as_deref() == Ok("skip");
    if skipped {
        eprintln!("RASTERLAB_GPU=skip: the window test is left out");
    }
    skipped
}

#[test]
fn a_real_window_opens_draws_follows_the_hand_saves_and_closes() {
    if is_skipped() {
        return;
    }
    let home = tempfile::tempdir().expect("a temporary folder");
    let display = Display::open();
    let mut lab = start(&display, home.path(), &["facet-knot"]);
    wait_for("the picture appeared", &mut lab, || {
        drawn(&display.view()) > 5_000
    });

    let before = display.view();
    wait_for("the picture followed the pointer", &mut lab, || {
        // Again and again: a drag that begins and ends within one slow frame is none.
        display.drag([600, 400], [120, 50]);
        let after = display.view();
        before.iter().zip(&after).filter(|(a, b)| a != b).count() > 5_000 && drawn(&after) > 5_000
    });

    display.focus();
    let saved: PathBuf = home
        .path()
        .join(".config/rasterlab/presets/my-facet-knot.toml");
    display.press(&[CONTROL, u32::from(b's')]);
    std::thread::sleep(Duration::from_millis(500));
    wait_for("the preset was saved", &mut lab, || {
        display.press(&[RETURN]);
        saved.exists()
    });
    let preset_file = preset_file::load(&saved).expect("the saved preset loads");
    assert!(preset_file.preset.camera.is_some() && preset_file.warnings.is_empty());
    let built_in = preset_file::open("facet-knot", &Folders::default())
        .expect("a built-in preset")
        .preset;
    assert_eq!(preset_file.preset.stack, built_in.stack);
    assert_ne!(preset_file.preset.camera, built_in.camera);

    display.press(&[CONTROL, u32::from(b'q')]);
    assert!(
        wait_for_exit(&mut lab).success(),
        "the lab closes with status 0"
    );
}

#[test]
fn presets_go_to_and_come_from_other_programs() {
    if is_skipped() {
        return;
    }
    let home = tempfile::tempdir().expect("a temporary folder");
    let display = Display::open();
    let mut lab = start(&display, home.path(), &["facet-knot"]);
    wait_for("the picture appeared", &mut lab, || {
        drawn(&display.view()) > 5_000
    });
    display.focus();
    let other = display.other_window();
    let preset = |id: &str| {
        let opened = preset_file::open(id, &Folders::default());
        opened.expect("a built-in preset")
    };
    let offered = preset_file::to_line(&preset("toon"));
    let copied = |lab: &mut Owned, what: &str, id: &str| {
        let mut asked = Instant::now() - PATIENCE;
        wait_for(what, lab, || {
            if asked.elapsed() > Duration::from_secs(2) {
                display.press(&[CONTROL, u32::from(b'c')]);
                display.ask_for_text(other);
                asked = Instant::now();
            }
            let Some(Exchanged::Taken(line)) = display.exchange(other, &offered) else {
                return false;
            };
            preset_file::from_line(&line)
                .is_ok_and(|copied| copied.preset.stack == preset(id).preset.stack)
        });
    };
    copied(&mut lab, "the preset was copied", "facet-knot");
    let clipboard = display.atom("CLIPBOARD");
    display
        .x
        .set_selection_owner(other, clipboard, x11rb::CURRENT_TIME)
        .expect("a request")
        .check()
        .expect("another program owns the clipboard");
    display.press(&[CONTROL, u32::from(b'v')]);
    wait_for("the lab asked for the clipboard", &mut lab, || {
        matches!(display.exchange(other, &offered), Some(Exchanged::Given))
    });
    copied(&mut lab, "the preset of another program was pasted", "toon");
}

#[test]
fn a_window_closes_when_its_frame_is_closed() {
    if is_skipped() {
        return;
    }
    let home = tempfile::tempdir().expect("a temporary folder");
    // It has the size that it had.
    let settings = home.path().join(".config/rasterlab/settings.toml");
    std::fs::create_dir_all(settings.parent().expect("a folder")).expect("a folder");
    std::fs::write(&settings, "[window]\nsize = [1100, 700]\n").expect("a file");
    let display = Display::open();
    let mut lab = start(&display, home.path(), &["builtin:cube-wall"]);
    wait_for("the picture appeared", &mut lab, || {
        drawn(&display.view()) > 5_000
    });
    assert_eq!(display.size(), [1100, 700]);
    display.ask_to_close();
    assert!(
        wait_for_exit(&mut lab).success(),
        "the lab closes with status 0"
    );
}

/// An effect that paints everything in this color.
fn coat(color: &str) -> String {
    format!(
        "// Coat: paints the surface.\n//@ use lib/surface\n\nstruct Coat {{\n    /// How much.\n    @range(0.0, 1.0, 1.0) amount: f32,\n}}\n\n\
         fn coat(surface: Surface, p: Coat) -> Surface {{\n    var s = surface;\n    s.color = vec4f({color}, 1.0);\n    return s;\n}}\n"
    )
}

#[test]
fn an_effect_file_is_edited_under_a_running_window() {
    if is_skipped() {
        return;
    }
    let home = tempfile::tempdir().expect("a temporary folder");
    let file = home.path().join("effects/coat.wgsl");
    std::fs::create_dir_all(home.path().join("effects")).expect("a folder");
    std::fs::write(&file, coat("1.0, 0.0, 0.0")).expect("a file");
    let display = Display::open();
    let mut lab = start(&display, home.path(), &["teapot", "--set", "coat"]);
    let painted = |color: [u8; 3]| {
        display
            .view()
            .iter()
            .filter(|pixel| **pixel == color)
            .count()
            > 5_000
    };
    wait_for("the picture appeared", &mut lab, || painted([255, 0, 0]));
    std::fs::write(&file, coat("0.0, 1.0, 0.0")).expect("a file");
    wait_for("the edit was seen", &mut lab, || painted([0, 255, 0]));

    // The color of the badge's title, theme::RED, is on the screen where nothing else is red.
    let badge = || {
        display
            .view()
            .iter()
            .filter(|[r, g, b]| *r > 220 && (80..150).contains(g) && (80..150).contains(b))
            .count()
            > 40
    };
    assert!(!badge());
    std::fs::write(&file, coat("0.0, 0.0, oops")).expect("a file");
    wait_for("the badge appeared", &mut lab, badge);
    assert!(painted([0, 255, 0]), "the last good picture went away");
    std::fs::write(&file, coat("0.0, 0.0, 1.0")).expect("a file");
    wait_for("the effect was healed", &mut lab, || {
        painted([0, 0, 255]) && !badge()
    });
}
