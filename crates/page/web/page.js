// The page: draws the preset that its address names on the page's device, and has a worker judge it.
//
//   ?preset=ID   a preset of the gallery, from presets/ID.toml; by default hero-night
//   #rasterlab1: the line that the window copies
//   ?embed       the picture alone
import init, { OpenPreset, Page } from "./rasterlab_page.js";

const canvas = document.getElementById("picture");
const caption = document.getElementById("caption");

function say(text, kind = "") {
  caption.textContent = text;
  caption.className = kind;
}

/** The text of the preset that the address names, and what errors call it. */
async function wanted() {
  const link = decodeURIComponent(location.hash.slice(1));
  if (link) return [link, "link"];
  const id = new URLSearchParams(location.search).get("preset") ?? "hero-night";
  if (!/^[\w-]+$/.test(id)) throw new Error(`"${id}" is no id of a preset; ids have letters, digits and hyphens`);
  const answer = await fetch(`presets/${id}.toml`);
  if (!answer.ok) throw new Error(`the gallery has no preset "${id}"`);
  return [await answer.text(), id];
}

function show(colors, [width, height]) {
  [canvas.width, canvas.height] = [width, height];
  const pixels = new ImageData(new Uint8ClampedArray(colors), width, height);
  canvas.getContext("2d").putImageData(pixels, 0, 0);
}

/** The golden as a still, until the kernels are compiled. */
async function showGolden(id) {
  const answer = await fetch(`goldens/${id}.png`);
  if (!answer.ok) return;
  const still = await createImageBitmap(await answer.blob());
  [canvas.width, canvas.height] = [still.width, still.height];
  canvas.getContext("2d").drawImage(still, 0, 0);
}

/** What the oracle says of the picture, from a worker. */
function judged(text, id) {
  return new Promise((resolve, reject) => {
    const worker = new Worker("judge.js", { type: "module" });
    worker.onmessage = ({ data }) => {
      worker.terminate();
      if (data.error) reject(new Error(data.error));
      else resolve(data);
    };
    worker.onerror = (event) => reject(new Error(event.message));
    worker.postMessage({ text, id });
  });
}

async function main() {
  if (new URLSearchParams(location.search).has("embed")) document.documentElement.classList.add("embed");
  const [text, id] = await wanted();
  showGolden(id);
  if (!navigator.gpu) {
    say("This browser has no WebGPU, so the picture is a still. Chrome and Edge 113, Safari 26 and Firefox 141 have it.", "wrong");
    return;
  }
  await init();
  const preset = new OpenPreset(text, id);
  document.title = `${preset.name()} · rasterlab`;
  say(`${preset.name()}: the kernels are compiled …`);
  const page = await Page.open();
  const began = performance.now();
  const picture = await page.draw(preset);
  const ms = performance.now() - began;
  show(picture.colors(), picture.size());
  say(`${preset.name()}: drawn in ${ms.toFixed(0)} ms with its kernels; the oracle judges it …`);
  const { faults } = await judged(text, id);
  if (faults.length === 0) say(`${preset.name()}: every pixel is the oracle's`, "right");
  else say(`${preset.name()}: ${faults.join("; ")}`, "wrong");
}

main().catch((error) => say(error.message ?? String(error), "wrong"));
