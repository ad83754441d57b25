// A picture that lives: it turns with the pointer or the arrow keys, comes closer with the wheel, two fingers or + and -, and plays.
import { Live } from "./rasterlab_page.js";
import { again, device } from "./device.js";

const DEG_PER_PX = 0.4;
/** A frame that takes longer is drawn with fewer pixels. */
const SLOW_MS = 60;
const MOST_PIXELS = 1600;
/** So long after the last change a picture that was drawn with fewer pixels is drawn with all of them. */
const REST_MS = 400;
const KEY_DEG = 6;

/** Shows `preset` on `canvas` for good, and returns when its first frame is there. `trouble` is told what fails later, `touched` when
 * another picture begins. In a page that scrolls (`isAlone` is false) the wheel is the picture's while that has the focus. */
export async function alive(preset, canvas, { trouble, touched = () => {}, isAlone = true }) {
  let [page, live] = [];
  const [width, height] = preset.size();
  let size = [];
  let [scale, plays, isWanted, before, restsAt] = [1, false, false, 0, Infinity];
  // What the visitor does is done between frames: the module must not be called while it draws.
  const waiting = [];

  function fit(scale) {
    const { width: wide, height: high } = canvas.getBoundingClientRect();
    const pixels = Math.min(MOST_PIXELS, Math.min(wide, (high * width) / height) * devicePixelRatio) * scale;
    const fitted = [Math.max(16, Math.round(pixels)), Math.max(12, Math.round((pixels * height) / width))];
    if (fitted[0] === size[0] && fitted[1] === size[1]) return;
    // The canvas has its old pixels until the frame of this size is there.
    size = fitted;
    preset.resize(...size);
  }

  async function draw() {
    const now = await device();
    if (page !== now) [page, live] = [now, new Live(now, canvas)];
    await live.show(preset);
  }

  async function frame() {
    isWanted = false;
    const began = performance.now();
    await again(draw);
    // Until the browser takes the frame, the canvas can be read.
    canvas.dispatchEvent(new Event("shown"));
    const ms = performance.now() - began;
    // A picture that stands still keeps its full resolution.
    if (before && ms > SLOW_MS && scale > 0.25 && restsAt !== Infinity) scale *= 0.7;
    before = ms;
  }

  let last = performance.now();
  function next(now) {
    const passed = Math.min(0.25, (now - last) / 1000);
    last = now;
    isWanted ||= page.is_lost();
    if (waiting.length || plays) {
      [restsAt, isWanted] = [now + REST_MS, true];
      fit(scale);
      touched();
    } else if (now > restsAt) {
      [restsAt, isWanted] = [Infinity, true];
      fit(1);
    }
    waiting.splice(0).forEach((change) => change());
    if (plays) plays = preset.play(passed);
    if (isWanted) frame().then(() => requestAnimationFrame(next), trouble);
    else requestAnimationFrame(next);
  }

  controls(canvas, isAlone, (...turn) => waiting.push(() => preset.orbit(...turn)));
  addEventListener("resize", () => waiting.push(() => {}));
  if (preset.is_moving()) playButton(canvas, () => (plays = !plays));
  fit(1);
  await frame();
  requestAnimationFrame(next);
}

/** A button, and the space key where nothing else takes it, that plays and pauses. */
function playButton(canvas, toggle) {
  const play = document.createElement("button");
  [play.id, play.textContent] = ["play", "▶"];
  play.setAttribute("aria-label", "Play");
  const press = () => {
    const plays = toggle();
    play.textContent = plays ? "❚❚" : "▶";
    play.setAttribute("aria-label", plays ? "Pause" : "Play");
  };
  play.onclick = press;
  addEventListener("keydown", (event) => {
    if (event.key !== " " || (event.target !== canvas && event.target !== document.body)) return;
    event.preventDefault();
    press();
  });
  canvas.after(play);
}

/** Tells `orbit` angles in degrees and the factor of the distance. */
function controls(canvas, isAlone, orbit) {
  const keys = { ArrowLeft: [-KEY_DEG, 0, 1], ArrowRight: [KEY_DEG, 0, 1], ArrowUp: [0, KEY_DEG, 1], ArrowDown: [0, -KEY_DEG, 1], "+": [0, 0, 0.9], "=": [0, 0, 0.9], "-": [0, 0, 1 / 0.9] };
  canvas.tabIndex = 0;
  canvas.addEventListener("keydown", (event) => {
    const turn = !event.ctrlKey && !event.metaKey && !event.altKey && keys[event.key];
    if (!turn) return;
    event.preventDefault();
    orbit(...turn);
  });
  const fingers = new Map();
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y) || 1;
  };
  // A finger that moves up or down scrolls a page that can be scrolled.
  canvas.style.touchAction = isAlone ? "none" : "pan-y";
  canvas.addEventListener("pointerdown", (event) => {
    canvas.focus({ preventScroll: true });
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  const lift = (event) => fingers.delete(event.pointerId);
  canvas.addEventListener("pointerup", lift);
  canvas.addEventListener("pointercancel", lift);
  canvas.addEventListener("pointermove", (event) => {
    const from = fingers.get(event.pointerId);
    if (!from) return;
    const to = { x: event.clientX, y: event.clientY };
    if (fingers.size === 1) orbit((from.x - to.x) * DEG_PER_PX, (to.y - from.y) * DEG_PER_PX, 1);
    const wide = fingers.size === 2 ? spread() : 0;
    fingers.set(event.pointerId, to);
    if (wide) orbit(0, 0, wide / spread());
  });
  canvas.addEventListener(
    "wheel",
    (event) => {
      if (!isAlone && document.activeElement !== canvas) return;
      event.preventDefault();
      orbit(0, 0, Math.exp(Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), 100) * 0.0015));
    },
    { passive: false },
  );
}
