// The scoreboard: ways to rasterize, side by side on the visitor's device, each with its wrong pixels as the oracle counts them.
import { Live, OpenPreset } from "./rasterlab_page.js";
import { again, device } from "./device.js";
import { presets, stills } from "./gallery.js";
import { adapterName, isLoss, words } from "./trouble.js";
import { oraclePicture } from "./workers.js";

const SIZE = [400, 300];
/** A channel may be so far from the oracle's, of 255: more is another surface, no rounding. */
const TOLERANCE = 2;
const HELD_S = 4;
const DEG_PER_S = 9;

const SCENE = `schema = 2
name = "Scoreboard"
[scene]
builtin = "town?houses=40"
[camera]
eye = [8.0, 7.6, 23.0]
target = [0.0, 2.3, 0.0]
fov_y_deg = 27.0
[effects.lambert]
sun = [1.0, 0.78, 0.52, 1.0]
sky = [0.16, 0.22, 0.36, 1.0]
ground = [0.10, 0.07, 0.05, 1.0]
sun_direction = [-0.9, 0.5, 0.45]
[output]
size = [${SIZE}]
background = [0.02, 0.025, 0.04, 1.0]
`;

const WAYS = [
  { name: "Exact", about: "Edges in integers, the nearest triangle by atomics: what rasterlab draws", pins: { visibility: "split32" } },
  { name: "Race", about: "Depth loaded, compared and stored without atomics: what many software rasterizers ship", pins: { visibility: "race" }, right: "None here: this device draws so few triangles at once that no store came too late" },
  { name: "16-bit depth", about: "Evenly spaced depths in 16 bits, as in shadow maps and old engines", pins: { visibility: "split32", depth: "ndc16" } },
  { name: "Float edges", about: "Edge functions in 32-bit floats with the top-left rule", pins: { visibility: "split32", coverage: "float-top-left" }, right: "None here: no pixel of this picture lies so near an edge that 32 bits do not tell its side" },
  { name: "Hardware", about: "This device's own rasterizer, which rounds corners and depths in its own way", hardware: true, right: "None here: this device rounds as the oracle does, in this picture" },
];

const element = (tag, name, text = "") => Object.assign(document.createElement(tag), { className: name, textContent: text });
const grouped = (number) => number.toLocaleString("en-US");

/** Pixels with another color than the oracle's, and those of them that show the background instead; alpha is 0 where hardware drew nothing. */
function compared(colors, oracles) {
  const background = oracles.slice(0, 3);
  const differ = (a, at, b, from) => [0, 1, 2].some((c) => Math.abs(a[at + c] - b[from + c]) > TOLERANCE);
  const [wrong, holes] = [[], []];
  for (let at = 0; at < oracles.length; at += 4) {
    const isDrawn = colors[at + 3] !== 0 && differ(colors, at, background, 0);
    const isOwned = differ(oracles, at, background, 0);
    if (isDrawn === isOwned && (!isDrawn || !differ(colors, at, oracles, at))) continue;
    wrong.push(at / 4);
    if (isOwned && !isDrawn) holes.push(at / 4);
  }
  return { wrong, holes };
}

/** A way with its card in the table and its preset. */
function card(way, grid) {
  const own = element("article", "way");
  const frame = element("div", "frame");
  const [canvas, faults] = [element("canvas", "picture"), element("canvas", "faults")];
  for (const layer of [canvas, faults]) [layer.width, layer.height] = SIZE;
  canvas.role = "img";
  canvas.ariaLabel = `The picture of ${way.name}`;
  const [number, unit, times, why] = [element("strong", "number", "–"), element("span", "unit", "wrong pixels"), element("p", "times"), element("p", "why")];
  const figure = element("p", "figure");
  figure.append(number, unit);
  frame.append(canvas, faults);
  own.append(frame, element("h2", "", way.name), figure, times, why, element("p", "about", way.about));
  grid.append(own);
  const preset = new OpenPreset(SCENE, "scoreboard");
  for (const [axis, option] of Object.entries(way.pins ?? {})) preset.set(`accuracy.${axis}`, option);
  const open = (page) => (way.hardware ? Live.hardware(page) : new Live(page));
  return { ...way, own, canvas, faults, number, unit, times, why, preset, open };
}

/** Shows the picture of a way, and red over every pixel that differs from `reference`; returns those. */
function show({ canvas, faults, number, unit, own }, colors, reference) {
  canvas.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(colors), ...SIZE), 0, 0);
  const found = compared(colors, reference);
  const marks = new ImageData(...SIZE);
  for (const pixel of found.wrong) marks.data.set([255, 45, 70, 255], 4 * pixel);
  faults.getContext("2d").putImageData(marks, 0, 0);
  number.textContent = grouped(found.wrong.length);
  unit.textContent = found.wrong.length === 1 ? "wrong pixel" : "wrong pixels";
  own.dataset.state = found.wrong.length ? "wrong" : "right";
  return found;
}

/** A way that cannot be drawn here says why. */
function missing(way, error) {
  if (isLoss(error)) throw error;
  way.result = { error: words(error) };
  way.number.textContent = "–";
  way.why.textContent = way.result.error;
  way.own.dataset.state = "missing";
}

/** Draws, counts and times one way at this moment. */
async function measure(way, oracles) {
  try {
    const { wrong, holes } = show(way, await way.live.colors(way.preset), oracles);
    const ms = await way.live.milliseconds(way.preset);
    way.result = { wrong: wrong.length, holes: holes.length, ms };
    way.times.textContent = `${holes.length ? `${grouped(holes.length)} ${holes.length === 1 ? "hole" : "holes"} · ` : ""}${ms.toFixed(ms < 10 ? 2 : 0)} ms`;
    way.why.textContent = wrong.length ? "" : (way.right ?? "");
  } catch (error) {
    missing(way, error);
  }
}

function text(ways, adapter, angle) {
  const rows = ways.map(({ name, result: { error, wrong, holes, ms } }) =>
    error ? `${name}: ${error}` : `${name}: ${grouped(wrong)} wrong of ${grouped(SIZE[0] * SIZE[1])} pixels, ${grouped(holes)} holes, ${ms.toFixed(2)} ms`,
  );
  const link = `${location.origin}${location.pathname}?scoreboard`;
  return [`rasterlab scoreboard: ${adapter}, ${SIZE.join(" x ")}, seen from ${Math.round(angle)}°`, ...rows, link].join("\n");
}

function head(lead) {
  const top = element("header", "");
  const home = Object.assign(element("a", "home", "rasterlab"), { href: "./" });
  top.append(home, element("h1", "", "Who draws the right pixel?"), element("p", "lead", lead));
  return top;
}

/** Without a device: why, what to do, and the picture of the oracle, which needs none. */
async function withoutDevice(main, [why, todo]) {
  const [grid, status, strip] = [element("div", "ways"), element("p", "wrong", why), element("nav", "", "")];
  strip.id = "strip";
  const sight = card({ name: "The oracle's picture", about: "Worked out on your processor: what the five ways would be held against." }, grid);
  [sight.number.textContent, sight.unit.textContent, sight.times.textContent] = ["", "", "The oracle draws …"];
  main.replaceChildren(head("Five ways to find the triangle of each pixel, drawn on your device and held against an exact oracle."), status, element("p", "lead", todo), grid, strip);
  presets().then((list) => strip.append(...stills(list, "").children));
  const progress = (part) => (sight.times.textContent = `The oracle draws: ${Math.round(100 * part)} %`);
  const oracles = await oraclePicture(sight.preset, { progress });
  show(sight, oracles, oracles);
  [sight.times.textContent, sight.number.textContent, sight.unit.textContent] = ["Every pixel is exact", "", ""];
}

/** Shows the scoreboard for good, and returns when its first moment is measured. `why` says that there is no device. */
export async function scoreboard(main, why) {
  document.title = "Who draws the right pixel? · rasterlab";
  if (why) return withoutDevice(main, why);
  const adapter = await adapterName(await device());
  const [grid, status] = [element("div", "ways"), element("p", "status", "The oracle draws …")];
  const copy = element("button", "", "Copy the result");
  const here = element("button", "", "Count here");
  copy.disabled = here.disabled = true;
  const foot = element("footer", "");
  foot.append(status, here, copy);
  main.replaceChildren(head(`One scene on ${adapter}, five ways to find the triangle of each pixel. An exact oracle on your processor draws it too, and every pixel that differs is red.`), grid, foot);
  const ways = WAYS.map((way) => card(way, grid));
  let [angle, isWanted] = [0, true];
  here.onclick = () => (isWanted = true);
  copy.onclick = async () => {
    try {
      await navigator.clipboard.writeText(text(ways, adapter, measuredAt));
      copy.textContent = "Copied";
    } catch {
      copy.textContent = "The browser refused";
    }
    setTimeout(() => (copy.textContent = "Copy the result"), 2000);
  };

  let page;
  /** Does `act` with all ways on the device as it is now. */
  const onDevice = (act) =>
    again(async () => {
      const now = await device();
      if (page !== now) ways.forEach((way) => (way.live = way.open(now)));
      page = now;
      await act();
    });

  let [measuredAt, heldUntil] = [0, 0];
  async function count() {
    isWanted = false;
    here.disabled = true;
    status.textContent = "The oracle draws …";
    const oracles = await oraclePicture(ways[0].preset, { progress: (part) => (status.textContent = `The oracle draws: ${Math.round(100 * part)} %`) });
    await onDevice(async () => {
      for (const way of ways) {
        status.textContent = `Counting: ${way.name} …`;
        await measure(way, oracles);
      }
    });
    measuredAt = ((angle % 360) + 360) % 360;
    heldUntil = performance.now() + 1000 * HELD_S;
    copy.disabled = here.disabled = false;
    status.textContent = `Counted at ${Math.round(measuredAt)}°. Wrong: a channel differs from the oracle's by more than ${TOLERANCE} of 255. Milliseconds: repeated frames, by the browser's clock.`;
  }

  /** While it turns, what is exact is the measure, since the oracle would be too slow. */
  async function turn(step) {
    if (ways[0].result.error) return;
    angle += step;
    ways.forEach(({ preset }) => preset.orbit(step, 0, 1));
    status.textContent = `It turns, and red is what differs from ${ways[0].name}. Count here asks the oracle again; last counted at ${Math.round(measuredAt)}°.`;
    let measure;
    await onDevice(async () => {
      for (const way of ways) {
        if (way.result.error) continue;
        try {
          const colors = await way.live.colors(way.preset);
          if (way === ways[0]) measure = colors;
          show(way, colors, measure);
        } catch (error) {
          missing(way, error);
        }
      }
    });
  }

  await count();
  let last = performance.now();
  const next = async (now) => {
    if (isWanted) await count();
    else if (now > heldUntil) await turn(Math.min(0.25, (now - last) / 1000) * DEG_PER_S);
    last = now;
    requestAnimationFrame((then) => next(then).catch((error) => (status.textContent = words(error))));
  };
  requestAnimationFrame((now) => next(now).catch((error) => (status.textContent = words(error))));
}
