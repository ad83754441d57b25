// The page: a picture with the oracle's verdict (the front door, a preset, a model, a link), the picture alone (?embed), or the scoreboard.
import init from "./rasterlab_page.js";
import { FIRST, open, wanted } from "./address.js";
import { again, device } from "./device.js";
import { presets, stills, ways } from "./gallery.js";
import { alive } from "./live.js";
import { scoreboard } from "./scoreboard.js";
import { adapterName, saver, whyNoDevice, words } from "./trouble.js";
import { asked, oraclePicture } from "./workers.js";

const find = (id) => document.getElementById(id);
const [main, canvas, still, exact, caption, detail, oracle] = [document.querySelector("main"), ...["picture", "still", "exact", "caption", "detail", "oracle"].map(find)];
const kind = document.documentElement.classList;
const isEmbed = kind.contains("embed");
/** The text of the open preset: the visitor can save it where the page cannot go on. */
let opened;

const grouped = (number) => number.toLocaleString("en-US");
const link = (text, href) => Object.assign(document.createElement("a"), { textContent: text, href, target: isEmbed ? "_blank" : "" });

/** The line below the picture, and a smaller one. */
function say(text, name = "", more = "") {
  [caption.textContent, caption.className, detail.textContent] = [text, name, more];
}

function trouble(error) {
  const isAgain = kind.contains("trouble");
  say(words(error), "wrong");
  // The scoreboard has taken its place.
  if (!caption.isConnected) main.append(caption);
  kind.add("trouble");
  oracle.disabled = true;
  if (opened) caption.append(" · ", saver(opened));
  if (isEmbed) caption.append(" · ", link("rasterlab", "./"));
  if (opened || isAgain || !find("stage")) return;
  // What was asked for is not there: home and the gallery lead on.
  find("door").href = "window.html";
  find("name").textContent = "Nothing to show here";
  find("about").replaceChildren("Go ", link("home", "./"), ", or choose from the gallery.");
  still.hidden = true;
  ways(error?.like ?? "").then((pictures) => {
    if (isEmbed) pictures.querySelectorAll("a").forEach((way) => (way.target = "_blank"));
    document.querySelector(".frame").replaceChildren(pictures);
  });
}

/** Shows code that a link brings, and returns when the visitor wants it to run. */
function allowed(code) {
  return new Promise((resolve) => {
    say("This link brings effects of its own. Their code runs on your graphics card, in the browser's sandbox. Read it, then decide.");
    const [text, run] = [document.createElement("pre"), document.createElement("button")];
    [text.id, text.textContent, run.id, run.textContent] = ["code", code, "run", "Run it"];
    run.onclick = () => {
      text.remove();
      run.remove();
      resolve();
    };
    caption.after(text, run);
  });
}

const saysLoss = () => say("The device was lost; another one is opened …");

/** The oracle's picture of a preset as large as it is shown, over the picture on the device. */
async function showOracle(preset, signal, progress) {
  const [wide, high] = preset.size();
  const { width, height } = canvas.getBoundingClientRect();
  const pixels = Math.min(1600, Math.min(width, (height * wide) / high) * devicePixelRatio);
  preset.resize(Math.max(16, Math.round(pixels)), Math.max(12, Math.round((pixels * high) / wide)));
  const colors = await oraclePicture(preset, { progress, signal });
  [exact.width, exact.height] = preset.size();
  exact.getContext("2d").putImageData(new ImageData(colors, exact.width, exact.height), 0, 0);
  exact.hidden = false;
}

/** The button that draws the oracle's picture of what is shown, with its progress, and stops it. */
function offerOracle(shown) {
  const offer = "Draw the oracle's picture";
  let stop;
  oracle.disabled = false;
  const back = () => ([exact.hidden, oracle.textContent] = [true, offer]);
  oracle.onclick = async () => {
    if (stop) return stop.abort();
    if (!exact.hidden) return back();
    stop = new AbortController();
    const preset = shown.copy();
    const progress = (part) => (oracle.textContent = `Stop: the oracle has drawn ${Math.round(100 * part)} %`);
    progress(0);
    try {
      await showOracle(preset, stop.signal, progress);
      oracle.textContent = "Show the device's picture again";
    } catch (error) {
      back();
      if (!stop.signal.aborted) detail.textContent = words(error);
    } finally {
      stop = undefined;
    }
  };
  return () => {
    stop?.abort();
    if (!exact.hidden) back();
  };
}

/** What the oracle says about the link's bits and those of this device, as arguments of `say`; the device draws them in portable bits. */
async function provenBits(preset, text, id, bits, adapter) {
  const mine = (await again(async () => (await device()).draw(preset.in_portable_bits()), saysLoss)).hashes();
  const { bits: oracles } = await asked({ ask: "bits", text, id });
  const differ = (a, b) => ["triangles", "depths"].filter((_, i) => a[i] !== b[i]).join(" and ");
  const [own, linked] = [differ(mine, oracles), differ(oracles, bits)];
  if (linked) return [`This link was changed, or made by another version: its ${linked} are not the oracle's`, "wrong"];
  if (own) return [`${adapter} draws it wrong: its ${own} are not the oracle's`, "wrong"];
  return ["This link, your device and the oracle agree, bit for bit", "right", `triangles ${mine[0]}, depths ${mine[1]}`];
}

/** What the oracle says about the picture of this device, as arguments of `say`. */
async function proven(preset, text, id, adapter) {
  const { faults, allowed } = await again(() => asked({ ask: "verdict", text, id }), saysLoss);
  if (faults.length) return [`${adapter} draws it wrong: ${faults.join("; ")}`, "wrong"];
  const [width, height] = preset.size();
  const all = grouped(width * height);
  if (allowed) return [`The oracle agrees with ${grouped(width * height - allowed)} of ${all} pixels`, "right", `The others differ by rounding, within what the preset allows.`];
  return [`The oracle agrees with all ${all} pixels`, "right"];
}

/** One verdict for all: bits of a link where it has some, the picture, and what a model has lost. */
async function judge(preset, { text, id, bits }) {
  const adapter = await adapterName(await device());
  let verdict;
  try {
    verdict = bits && (await provenBits(preset, text, id, bits, adapter));
  } catch (error) {
    verdict = [`The bits of this link cannot be compared: ${words(error)}`, "wrong"];
  }
  if (verdict?.[1] !== "wrong") {
    const picture = await proven(preset, text, id, adapter);
    verdict = verdict && picture[1] === "right" ? verdict : picture;
  }
  const [said, name, more = ""] = verdict;
  const notes = preset.notes();
  const rest = notes.length > 2 ? `, and ${notes.length - 2} more` : "";
  if (notes.length && name === "right") say(`${said}, of what could be shown: ${words(notes.slice(0, 2).join("; "))}${rest}`, "partly", more);
  else say(said, name, [more, `${adapter}, judged at ${preset.size().join(" × ")}`].filter(Boolean).join(" · "));
}

/** Opens what the address names and says what it is. */
async function begun() {
  const address = await wanted();
  if (address.id !== "link" && !address.model && address.isOfGallery) [still.src, still.hidden] = [`goldens/${address.id}.png`, false];
  await init();
  const preset = await open(address, say);
  opened = preset.text();
  if (!kind.contains("front")) {
    document.title = `${preset.name()} · rasterlab`;
    [find("name").textContent, find("about").textContent] = [preset.name(), preset.about()];
  }
  const code = preset.brought_code();
  if (code) await allowed(code);
  return { ...address, preset, text: opened };
}

/** Without a device: why, what to do, and the oracle's picture of what was asked for, which needs none. */
async function withoutDevice([why, todo]) {
  kind.add("still");
  say(why, "wrong", todo);
  const { preset } = await begun();
  say(why, "wrong", todo);
  await showOracle(preset, undefined, (part) => (detail.textContent = `${todo} The oracle draws: ${Math.round(100 * part)} %`));
  const notes = preset.notes();
  say(why, "wrong", `${todo} This is the oracle's picture, drawn on your processor${notes.length ? `, of what could be shown: ${words(notes.slice(0, 2).join("; "))}` : "."}`);
}

async function picture() {
  const address = await begun();
  const { preset, text, id } = address;
  say("The kernels are compiled …");
  const shown = preset.copy();
  let turned = () => {};
  await alive(shown, canvas, { trouble, touched: () => turned(), isAlone: isEmbed });
  still.hidden = true;
  if (isEmbed) return parent.postMessage("rasterlab shows a picture", "*");
  turned = offerOracle(shown);
  say("Drawn on your device. The oracle judges it …", "", "Drag the picture to turn it.");
  await judge(preset, { ...address, text, id });
}

async function begin() {
  if (!isEmbed) presets().then((list) => find("strip").append(...stills(list, "").children));
  const why = await whyNoDevice();
  if (kind.contains("scoreboard")) {
    await init();
    await scoreboard(main, why);
  } else if (why) await withoutDevice(why);
  else await picture();
}

// The window opens what the page shows.
find("door").href = `window.html${location.search}${location.hash.split(";")[0]}`;
begin().catch(trouble);
// What fails outside of any promise that somebody waits for, such as a panic in a callback.
addEventListener("error", ({ error, message }) => trouble(error ?? message));
addEventListener("unhandledrejection", ({ reason }) => trouble(reason));
addEventListener("hashchange", () => location.reload());
