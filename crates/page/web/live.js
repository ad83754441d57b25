// A picture that lives: it turns with the pointer, comes closer with the wheel or two fingers, and plays.
import { Live } from "./rasterlab_page.js";
import { again, device } from "./device.js";

const DEG_PER_PX = 0.4;
/** A frame that takes longer is drawn with fewer pixels. */
const SLOW_MS = 60;
const MOST_PIXELS = 1600;

/** Shows `preset` on `canvas` for good, and returns when its first frame is there. `trouble` is told what fails later. */
export async function alive(preset, canvas, trouble) {
  let [page, live] = [];
  const [width, height] = preset.size();
  let [scale, plays, isWanted, before] = [1, false, false, 0];
  // What the visitor does is done between frames: the module must not be called while it draws.
  const waiting = [];

  function fit() {
    const pixels = Math.min(MOST_PIXELS, Math.max(innerWidth, (innerHeight * width) / height) * devicePixelRatio) * scale;
    const fitted = [Math.max(16, Math.round(pixels)), Math.max(12, Math.round((pixels * height) / width))];
    if (fitted[0] === canvas.width && fitted[1] === canvas.height) return;
    [canvas.width, canvas.height] = fitted;
    preset.resize(...fitted);
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
    if (before && ms > SLOW_MS && scale > 0.25) {
      scale *= 0.7;
      fit();
      isWanted = true;
    }
    before = ms;
  }

  let last = performance.now();
  function next(now) {
    const passed = Math.min(0.25, (now - last) / 1000);
    last = now;
    isWanted ||= waiting.length > 0 || page.is_lost();
    waiting.splice(0).forEach((change) => change());
    if (plays) {
      plays = preset.play(passed);
      isWanted = true;
    }
    if (isWanted) frame().then(() => requestAnimationFrame(next), trouble);
    else requestAnimationFrame(next);
  }

  controls(canvas, (...turn) => waiting.push(() => preset.orbit(...turn)));
  addEventListener("resize", () => waiting.push(fit));
  if (preset.is_moving()) playButton(() => (plays = !plays));
  fit();
  await frame();
  requestAnimationFrame(next);
}

/** A button, and the space key, that plays and pauses. */
function playButton(toggle) {
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
    if (event.key !== " " || event.target === play) return;
    event.preventDefault();
    press();
  });
  document.querySelector("main").append(play);
}

/** Tells `orbit` angles in degrees and the factor of the distance. */
function controls(canvas, orbit) {
  const fingers = new Map();
  const spread = () => {
    const [a, b] = [...fingers.values()];
    return Math.hypot(a.x - b.x, a.y - b.y) || 1;
  };
  canvas.style.touchAction = "none";
  canvas.addEventListener("pointerdown", (event) => {
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
      event.preventDefault();
      orbit(0, 0, Math.exp(Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), 100) * 0.0015));
    },
    { passive: false },
  );
}
