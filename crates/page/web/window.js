// The program's window on a canvas of the page.
//
//   ?preset=ID   begins with a preset of the gallery; by default with what was open last
//   ?preset=URL  begins with the file of a preset
//   ?model=URL   shows a model, with the look of ?preset if there is one
//   #rasterlab1: begins with the line that the window copies
import init, { give_file, open_given, open_window, refuse, reopen_window } from "./rasterlab_window.js";
import { isAddress, modelAt, presetAt } from "./fetched.js";
import { BROWSERS, adapterName, goesOn, saver, words } from "./trouble.js";

/** Most of a dropped folder. */
const [MOST_MB, MOST_FILES] = [512, 4096];

const caption = document.getElementById("caption");

/** Says why the window cannot go on, with a way to save what is open. */
function fail(error) {
  caption.textContent = words(error);
  if (globalThis.rasterlabOpened) caption.append(" · ", saver(rasterlabOpened));
  caption.hidden = false;
}

/** Opens the window again, on another canvas and device: its module has kept what was open. */
async function comeBack() {
  [caption.textContent, caption.hidden] = ["The device was lost; the window opens again …", false];
  const lost = document.getElementById("window");
  const canvas = lost.cloneNode();
  lost.replaceWith(canvas);
  await reopen_window(canvas);
  caption.hidden = true;
}

async function main() {
  if (!navigator.gpu) {
    throw new Error(`This browser has no WebGPU. ${BROWSERS}`);
  }
  await init();
  const query = new URLSearchParams(location.search);
  const [line, preset, address] = [decodeURIComponent(location.hash.slice(1)), query.get("preset"), query.get("model")];
  const files = address ? await modelAt(address, (words) => (caption.textContent = `${words} …`)) : [];
  let open = line || preset || undefined;
  if (!line && preset && isAddress(preset)) {
    const { text, id } = await presetAt(preset);
    open = `/given/${id}.toml`;
    files.push([open, new TextEncoder().encode(text)]);
  }
  files.forEach(([path, bytes]) => give_file(path, bytes));
  globalThis.rasterlabAdapter = await adapterName();
  const model = address ? files[0][0] : undefined;
  await open_window(document.getElementById("window"), open ?? model, open && model);
  caption.hidden = true;
}

/** The files of a dropped folder, [path, bytes] each. */
async function filesOf(folder) {
  const files = [];
  let left = MOST_MB * 1e6;
  async function enter(entry) {
    if (entry.isFile) {
      const file = await new Promise((resolve, reject) => entry.file(resolve, reject));
      left -= file.size;
      if (left < 0 || files.length === MOST_FILES) throw new Error(`the folder ${folder.name} has more than ${MOST_FILES} files or ${MOST_MB} MB; drop the folder of the model alone`);
      files.push([`/given${entry.fullPath}`, new Uint8Array(await file.arrayBuffer())]);
      return;
    }
    const reader = entry.createReader();
    const next = () => new Promise((resolve, reject) => reader.readEntries(resolve, reject));
    for (let inside; (inside = await next()).length; ) for (const entry of inside) await enter(entry);
  }
  await enter(folder);
  return files;
}

async function openFolder(folder) {
  const files = await filesOf(folder);
  files.forEach(([path, bytes]) => give_file(path, bytes));
  open_given(files.map(([path]) => path));
}

// A file that misses the canvas would replace the page. The canvas takes files, and folders are taken here.
addEventListener("dragover", (event) => event.preventDefault());
addEventListener("drop", (event) => {
  event.preventDefault();
  const folder = [...(event.dataTransfer?.items ?? [])].map((item) => item.webkitGetAsEntry?.()).find((entry) => entry?.isDirectory);
  if (!folder) return;
  event.stopPropagation();
  openFolder(folder).catch((error) => refuse(error.message ?? String(error)));
}, true);
// Browsers report some of what they do late themselves as an event without an error.
addEventListener("error", ({ error }) => {
  if (!error) return;
  // It is said in the middle of a frame of the lost window, which ends first.
  if (goesOn(error)) setTimeout(() => comeBack().catch(fail));
  else fail(error);
});
main().catch(fail);
