// The program's window on a canvas of the page.
//
//   ?preset=ID   begins with a preset of the gallery; by default with what was open last
//   ?preset=URL  begins with the file of a preset
//   ?model=URL   shows a model, with the look of ?preset if there is one
//   #rasterlab1: begins with the line that the window copies
import init, { give_file, open_given, open_window, refuse, reopen_window } from "./rasterlab_window.js";
import { isAddress, modelAt, presetAt } from "./fetched.js";
import { presets, similar, stills } from "./gallery.js";
import { adapterName, goesOn, saver, whyNoDevice, words } from "./trouble.js";

/** Most of a dropped folder. */
const [MOST_MB, MOST_FILES] = [512, 4096];

const CUT = new Error("This link is cut off. Copy it once more, whole");

const caption = document.getElementById("caption");

/** Says why the window cannot go on, with a way to save what is open. */
function fail(error) {
  caption.textContent = words(error);
  document.title = "rasterlab";
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

/** What the address names: what the window begins with, a model for it, and why one of them is not there. */
async function named() {
  const query = new URLSearchParams(location.search);
  const [preset, address] = [query.get("preset"), query.get("model")];
  let [open, model, files] = [undefined, undefined, []];
  try {
    open = decodeURIComponent(location.hash.slice(1)) || undefined;
    if (open && !open.startsWith("rasterlab1:")) throw new Error("This link is none of rasterlab's: behind # it must begin with rasterlab1:");
    if (address) files = await modelAt(address, (words) => (caption.textContent = `${words} …`));
    model = files[0]?.[0];
    if (!open && preset && isAddress(preset)) {
      const { text, id } = await presetAt(preset);
      files.push([`/given/${id}.toml`, new TextEncoder().encode(text)]);
      open = `/given/${id}.toml`;
    } else if (!open && preset) {
      const gallery = await presets();
      if (gallery.length && !gallery.some(([id]) => id === preset)) {
        throw Object.assign(new Error(`The gallery has no preset "${preset}"`), { like: preset });
      }
      open = preset;
    }
  } catch (error) {
    return { files, why: error instanceof URIError ? CUT : error };
  }
  return { open, model, files };
}

/** Says over the open window what the address names and is not there, and what is like it. */
async function tellAbsent({ message, like }) {
  const [note, close] = [document.createElement("div"), document.createElement("button")];
  note.className = "note";
  close.textContent = "Close";
  close.onclick = () => note.remove();
  const found = like ? await similar(like) : [];
  const ways = [...found.map(([id, name]) => [`${name} (${id})`, `window.html?preset=${id}`]), ["home", "./"]];
  const links = ways.flatMap(([textContent, href]) => [" · ", Object.assign(document.createElement("a"), { textContent, href })]);
  note.append(`${message}. The presets of the gallery are at the left`, ...links, " ", close);
  document.body.append(note);
}

/** The title, and the address of what is shown: `id` names a preset of the gallery as it is there. */
let shownId;
globalThis.rasterlabShows = (title, id) => {
  document.title = title;
  // The first is what the address asks for.
  if (shownId !== undefined && id !== shownId) history.replaceState(null, "", id ? `?preset=${id}` : new URLSearchParams(location.search).has("model") ? location.href : location.pathname);
  shownId = id;
};

async function main() {
  const why = await whyNoDevice();
  if (why) {
    const page = Object.assign(document.createElement("a"), { href: `./${location.search}${location.hash}`, textContent: "See the oracle's picture of it" });
    const note = caption.cloneNode();
    note.append(`${why.join(" ")} `, page, stills((await presets()).slice(0, 12), "gallery"));
    return caption.replaceWith(note);
  }
  await init();
  const { open, model, files, why: not } = await named();
  files.forEach(([path, bytes]) => give_file(path, bytes));
  globalThis.rasterlabAdapter = await adapterName();
  const canvas = document.getElementById("window");
  try {
    await open_window(canvas, open ?? model, open && model);
  } catch (error) {
    // A line that cannot be read is refused before the window opens.
    if (!open?.startsWith("rasterlab1:") || globalThis.rasterlabPanic) throw error;
    await open_window(canvas, undefined, undefined);
    tellAbsent(/cut off/.test(error) ? CUT : { message: words(error) });
  }
  if (not) tellAbsent({ message: words(not), like: not.like });
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
