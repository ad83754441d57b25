// The page: a picture with the oracle's verdict, the picture alone (?embed), or the scoreboard (?scoreboard).
import init from "./rasterlab_page.js";
import { open, wanted } from "./address.js";
import { again, device } from "./device.js";
import { alive } from "./live.js";
import { scoreboard } from "./scoreboard.js";
import { BROWSERS, adapterName, gallery, saver, words } from "./trouble.js";
import { asked, oraclePicture } from "./workers.js";

const main = document.querySelector("main");
const canvas = document.getElementById("picture");
const caption = document.getElementById("caption");
const query = new URLSearchParams(location.search);
/** The text of the open preset: the visitor can save it where the page cannot go on. */
let opened;

function say(text, kind = "") {
  caption.textContent = text;
  caption.className = kind;
}

/** Another line below the caption. */
function add(text, kind = "") {
  const line = document.createElement("p");
  [line.textContent, line.className] = [text, kind];
  main.append(line);
  return line;
}

function trouble(error) {
  say(words(error), "wrong");
  // The scoreboard has taken its place.
  if (!caption.isConnected) main.append(caption);
  document.documentElement.classList.add("trouble");
  if (opened) caption.append(" · ", saver(opened));
}

function button(text, act) {
  const made = document.createElement("button");
  made.textContent = text;
  made.onclick = act;
  return made;
}

function shape(width, height) {
  [canvas.width, canvas.height] = [width, height];
  main.style.setProperty("--aspect", width / height);
}

function show(colors, [width, height]) {
  shape(width, height);
  canvas.getContext("2d").putImageData(new ImageData(new Uint8ClampedArray(colors), width, height), 0, 0);
}

/** The golden as a still, until the kernels are compiled. */
async function showGolden(id) {
  const answer = await fetch(`goldens/${id}.png`);
  if (!answer.ok) return;
  const still = await createImageBitmap(await answer.blob());
  shape(still.width, still.height);
  canvas.getContext("2d").drawImage(still, 0, 0);
}

/** Shows code that a link brings, and returns when the visitor wants it to run. */
function allowed(code) {
  return new Promise((resolve) => {
    say("This link brings effects of its own. Their code runs on your graphics card, in the browser's sandbox. Read it, then decide.");
    const text = document.createElement("pre");
    text.id = "code";
    text.textContent = code;
    const run = button("Run it", () => {
      text.remove();
      run.remove();
      resolve();
    });
    main.append(text, run);
  });
}

const saysLoss = () => say("The device was lost; another one is opened …");

/** A link to the program's window with the same preset. */
function offerWindow() {
  const link = document.createElement("a");
  [link.textContent, link.href] = ["Open it in the window", `window.html${location.search}${location.hash.split(";")[0]}`];
  add("").append(link);
}

/** Draws the preset in portable bits, and says whether they are the oracle's and the link's. */
async function prove(preset, text, id, bits) {
  const proof = add("The bits of its triangles and depths are compared …");
  proof.id = "proof";
  const adapter = (await device()).adapter() || (await adapterName()) || "this device";
  try {
    const mine = (await again(async () => (await device()).draw(preset.in_portable_bits()))).hashes();
    const { bits: oracles } = await asked({ ask: "bits", text, id });
    const differ = (a, b) => ["triangle ids", "depths"].filter((_, i) => a[i] !== b[i]).join(" and ");
    const [own, linked] = [differ(mine, oracles), differ(oracles, bits)];
    proof.className = own || linked ? "wrong" : "right";
    if (linked) proof.textContent = `The link's ${linked} are not the oracle's: it was made by another version, or changed`;
    else if (own) proof.textContent = `${adapter}: ${own} differ from the oracle's`;
    else proof.textContent = `${adapter}: the same bits as the oracle's, triangles ${mine[0]}, depths ${mine[1]}`;
  } catch (error) {
    [proof.textContent, proof.className] = [`Its bits cannot be compared: ${words(error)}`, "wrong"];
  }
}

/** A button that draws the oracle's picture in workers, with progress, and one to stop. */
function offerOracle(preset) {
  const line = add("");
  const offer = () => line.replaceChildren(button("Draw the oracle's picture", draw));
  const draw = async () => {
    const stop = new AbortController();
    const told = document.createElement("span");
    line.replaceChildren(button("Stop", () => stop.abort()), told);
    const progress = (part) => (told.textContent = ` the oracle draws: ${Math.round(100 * part)} %`);
    progress(0);
    try {
      show(await oraclePicture(preset, { progress, signal: stop.signal }), preset.size());
      line.textContent = "This is the oracle's picture, drawn on your processor in exact arithmetic";
    } catch (error) {
      if (stop.signal.aborted) offer();
      else [line.textContent, line.className] = [words(error), "wrong"];
    }
  };
  line.id = "oracle";
  offer();
}

async function picture() {
  const address = await wanted();
  const { id, bits } = address;
  opened = address.text;
  if (!address.model) showGolden(id);
  await init();
  const preset = await open(address, say);
  const text = preset.text();
  opened = text;
  document.title = `${preset.name()} · rasterlab`;
  const code = preset.brought_code();
  if (code) await allowed(code);
  say(`${preset.name()}: the kernels are compiled …`);
  await device();
  const began = performance.now();
  const drawn = await again(async () => (await device()).draw(preset), saysLoss);
  show(drawn.colors(), drawn.size());
  say(`${preset.name()}: drawn in ${(performance.now() - began).toFixed(0)} ms with its kernels; the oracle judges it …`);
  const { faults } = await again(() => asked({ ask: "verdict", text, id }), saysLoss);
  if (faults.length === 0) say(`${preset.name()}: every pixel is the oracle's`, "right");
  else say(`${preset.name()}: ${faults.join("; ")}`, "wrong");
  if (bits) await prove(preset, text, id, bits);
  offerOracle(preset);
  offerWindow();
}

async function embed() {
  document.documentElement.classList.add("embed");
  const address = await wanted();
  const { id, model } = address;
  opened = address.text;
  // The still of the gallery, until the first frame covers it.
  if (id !== "link" && !model) canvas.style.background = `url("goldens/${id}.png") center / contain no-repeat`;
  await init();
  const preset = await open(address, say);
  opened = preset.text();
  document.title = preset.name();
  const code = preset.brought_code();
  if (code) await allowed(code);
  await alive(preset, canvas, trouble);
  parent.postMessage("rasterlab shows a picture", "*");
}

async function begin() {
  if (!navigator.gpu) {
    const { text, id } = await wanted().catch(() => ({ id: "hero-night" }));
    opened = text;
    await showGolden(id);
    say(`This browser has no WebGPU, so this page shows stills. ${BROWSERS}.`, "wrong");
    if (!query.has("embed")) main.append(gallery());
    return;
  }
  if (query.has("scoreboard")) {
    document.documentElement.classList.add("scoreboard");
    await init();
    await scoreboard(main);
  } else if (query.has("embed")) await embed();
  else await picture();
}

begin().catch(trouble);
// What fails outside of any promise that somebody waits for, such as a panic in a callback.
addEventListener("error", ({ error, message }) => trouble(error ?? message));
addEventListener("unhandledrejection", ({ reason }) => trouble(reason));
addEventListener("hashchange", () => location.reload());
