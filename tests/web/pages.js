// The pages themselves, in frames.
import { OpenPreset, oracle_bits } from "/rasterlab_page.js";
import { report, text, until } from "/tests/report.js";

/** A page in a frame: its path, or what follows that of the page itself; with `before`, a script runs there first. */
async function opened(address, before) {
  const frame = document.createElement("iframe");
  [frame.width, frame.height] = [480, 360];
  const whole = address.startsWith("/") ? address : `/index.html${address}`;
  if (before) frame.srcdoc = (await text(whole)).replace("<script", `<script>${before}</script><script`);
  else frame.src = whole;
  document.body.append(frame);
  const loaded = new Promise((resolve) => (frame.onload = resolve));
  const heard = new Promise((resolve) => addEventListener("message", ({ source, data }) => source === frame.contentWindow && resolve(data)));
  await loaded;
  const find = (name) => frame.contentDocument.querySelector(name);
  return { frame, find, heard, says: (words, name = "#caption") => until(() => words.test(find(name)?.textContent ?? "") && find(name), `${address} says ${words}; it says "${find(name)?.textContent}"`) };
}

/** A test of a page: its faults are what `check` returns, or what it throws. */
async function page(name, address, check, before) {
  let faults;
  const shown = await opened(address, before);
  try {
    faults = (await check(shown)) ?? [];
  } catch (error) {
    faults = [`${error.message}; the page says "${shown.find("main")?.innerText}"`];
  }
  shown.frame.remove();
  await report(`page ${name}`, faults);
}

const line = async (id) => new OpenPreset(await text(`/presets/${id}.toml`), id).line();

export async function links() {
  const preset = new OpenPreset(await text("/presets/facet.toml"), "facet");
  const bits = oracle_bits(preset.in_portable_bits());
  const showsOracle = async ({ says, find }) => {
    find("#oracle").click();
    await says(/Show the device's picture/, "#oracle");
    const early = find("#exact").hidden && "the oracle's picture is not shown";
    find("#oracle").click();
    return [early, !find("#exact").hidden && "the oracle's picture stays"];
  };
  await page("proof", `#${preset.line()};${bits.join("-")}`, async (shown) => {
    const { className } = await shown.says(/This link, your device and the oracle agree, bit for bit/);
    return [className !== "right" && "it does not look right", ...(await showsOracle(shown))];
  });
  const other = `${"0".repeat(16)}-${bits[1]}`;
  await page("other bits", `#${preset.line()};${other}`, async ({ says }) => {
    const { className } = await says(/was changed.*its triangles are not the oracle's/);
    return [className !== "wrong" && "it looks right"];
  });
  await page("unproven", `#${await line("wobble")};${other}`, async ({ says }) => void (await says(/cannot be compared: .*strict/)));
  for (const [name, address, words] of [
    ["cut link", "#rasterlab1:AAAA", /link is cut off/],
    ["strange link", "#other", /none of rasterlab's/],
    ["cut bits", `#${preset.line()};12`, /link is cut off/],
    ["bad escapes", "#%E0%A4%A", /link is cut off/],
    ["no preset", "?preset=facett", /no preset "facett"/],
  ]) {
    await page(name, address, async ({ says, find }) => {
      const { className } = await says(words);
      await until(() => find(".gallery a"), "the gallery leads on");
      const leads = find(".gallery a").href;
      return [className !== "wrong" && "it looks right", find(".save") && "it offers something to save", name === "no preset" && !/preset=facet$/.test(leads) && `it leads to ${leads}`];
    });
  }
}

export async function addresses() {
  const judged = async ({ says }) => void (await says(/^The oracle agrees with/));
  await page("model", "?model=models/three.gltf", async (shown) => {
    await judged(shown);
    shown.find("#oracle").click();
    await shown.says(/Show the device's picture/, "#oracle");
  });
  await page("look on a model", "?preset=toon&model=/models/three.gltf", async (shown) => {
    await judged(shown);
    await shown.says(/ on three$/, "#name");
  });
  await page("preset at an address", "?preset=presets/facet.toml", judged);
  const elsewhere = `http://127.0.0.1:${location.port}`;
  await page("model of another site", `?model=${elsewhere}/open/three.gltf`, judged);
  for (const [name, address, words] of [
    ["model of a site that refuses", `?model=${elsewhere}/models/three.gltf`, /three.gltf cannot be fetched: 127.0.0.1:\d+ cannot be reached, or does not let other pages read its files/],
    ["no model", "?model=models/none.glb", /none.glb cannot be fetched: localhost:\d+ answers 404/],
    ["large model", "?model=models/huge.glb", /huge.glb is larger than 256 MB/],
    ["cut model", "?model=models/cut.gltf", /cut.gltf: /],
    ["model that reaches out", "?model=models/out.gltf", /out.gltf: .*leads out of the model's folder/],
    ["strange address", "?model=ftp://host/a.glb", /is no address of a file/],
    ["no preset at an address", "?preset=presets/none.toml", /none.toml cannot be fetched/],
  ]) {
    await page(name, address, async ({ says }) => [(await says(words)).className !== "wrong" && "it looks right"]);
  }
  const asked = JSON.parse(await text("/asked.json")).filter((path) => /models|out/.test(path));
  const buffers = asked.filter((path) => path === "/models/parts/three%20corners.bin").length;
  await report("a model's files are fetched once, and none outside of its folder", [(buffers !== 2 || asked.includes("/out.bin")) && `it asked for ${asked}`]);
}

export async function brought() {
  const wash = await text("/tests/wash.wgsl");
  const own = `schema = 2\n[scene]\nbuiltin = "teapot?tess=4"\n[effects.wash]\n[effect_files]\nwash = '''\n${wash}'''\n[output]\nsize = [64, 48]\n`;
  const carried = new OpenPreset(own, "own").line();
  await page("brought code", `#${carried}`, async ({ says, find }) => {
    await says(/fn wash/, "#code");
    const early = /drawn|oracle/i.test(find("#caption").textContent);
    find("#run").click();
    await says(/^The oracle agrees with/);
    return [early && "it was drawn unasked", find("#code") && "the code stays"];
  });
}

/** The sum of the bytes that a canvas shows. */
function seen(canvas) {
  const copy = new OffscreenCanvas(canvas.width, canvas.height).getContext("2d");
  copy.drawImage(canvas, 0, 0);
  return copy.getImageData(0, 0, canvas.width, canvas.height).data.reduce((sum, byte) => sum + byte, 0);
}

/** From now on returns the device that has encoded last in a window. */
function seenDevice({ GPUDevice }) {
  const encode = GPUDevice.prototype.createCommandEncoder;
  let device;
  GPUDevice.prototype.createCommandEncoder = function (...all) {
    device = this;
    return encode.apply(this, all);
  };
  return () => device;
}

export async function embed() {
  await page("embed", "?embed&preset=hero-walk", async ({ find, heard, frame }) => {
    const said = await Promise.race([heard, new Promise((resolve) => setTimeout(resolve, 240_000, "nothing"))]);
    const [canvas, window] = [find("#picture"), frame.contentWindow];
    let shown = [];
    canvas.addEventListener("shown", () => shown.push(seen(canvas)));
    /** What `act` does shows another picture, more than a black one. */
    const shows = async (act, what) => {
      shown = [];
      act();
      await until(() => shown.some((sum) => sum > 255 * canvas.width * canvas.height), what);
    };
    const at = (type, clientX, clientY) => canvas.dispatchEvent(new window.PointerEvent(type, { pointerId: 1, clientX, clientY, bubbles: true }));
    canvas.setPointerCapture = () => {};
    await shows(() => {
      at("pointerdown", 100, 100);
      at("pointermove", 220, 120);
      at("pointerup", 220, 120);
    }, "the picture turns");
    await shows(() => canvas.dispatchEvent(new window.WheelEvent("wheel", { deltaY: -100, bubbles: true, cancelable: true })), "it comes closer");
    const play = find("#play");
    await shows(() => window.dispatchEvent(new window.KeyboardEvent("keydown", { key: " ", bubbles: true, cancelable: true })), "it plays");
    await until(() => new Set(shown).size > 2, "it shows one frame after another");
    const names = play.getAttribute("aria-label");
    play.click();
    const device = seenDevice(window);
    await shows(() => canvas.dispatchEvent(new window.WheelEvent("wheel", { deltaY: 100, bubbles: true, cancelable: true })), "it draws the next frame");
    await shows(() => device().destroy(), "it comes back from a lost device");
    return [said !== "rasterlab shows a picture" && `it says ${said}`, names !== "Pause" && `the button says ${names}`, play.getAttribute("aria-label") !== "Play" && "it goes on"];
  });
  await page("embed of a still preset", "?embed&preset=facet", async ({ find, heard }) => {
    await heard;
    return [find("#play") && "it has a button to play"];
  });
}

/** What `rasterlab page facet` has written: run.py --program. */
export async function written() {
  if (!(await fetch("/written.html")).ok) return;
  await page("written page", "/written.html", async ({ find, frame }) => {
    const still = find("#picture");
    await until(() => still.complete, "the still");
    const early = !still.naturalWidth && "it has no still";
    await until(() => !find("#picture"), "the still gives way");
    const { left, width } = find("iframe").getBoundingClientRect();
    return [early, !(left >= 0 && width > 100 && left + width <= frame.width) && `the picture lies at ${left}, ${width} wide`];
  });
  const still = "Object.defineProperty(navigator, 'gpu', { value: undefined })";
  await page("written page without WebGPU", "/written.html", async ({ find }) => {
    await until(() => find("#picture")?.complete, "the still");
    return [!find("#picture").naturalWidth && "it has no still", find("iframe") && "it has more than a still"];
  }, still);
}

export async function troubles() {
  await page("no WebGPU", "", async ({ says, find }) => {
    await says(/has no WebGPU/);
    await says(/Firefox.*This is the oracle's picture/, "#detail");
    return [find("#strip").children.length < 6 && "few pictures", find("#exact").hidden && "no picture of the oracle"];
  }, "Object.defineProperty(navigator, 'gpu', { value: undefined })");
  const lose = (most) => `let losses = 0; const open = GPUAdapter.prototype.requestDevice; GPUAdapter.prototype.requestDevice = async function (...all) { const device = await open.apply(this, all); if (losses++ < ${most}) setTimeout(() => device.destroy(), 1); return device; };`;
  await page("lost device", "", async ({ says }) => {
    await says(/device was lost; another one is opened/);
    await says(/^The oracle agrees with/);
  }, lose(1));
  await page("device that is lost again and again", "", async ({ says, find }) => {
    await says(/lost again and again/);
    return [!(await (await fetch(find(".save").href)).text()).includes("schema") && "it saves no preset"];
  }, lose(Infinity));
  const fail = "GPUDevice.prototype.createBuffer = () => { throw new TypeError('a mistake for the test') };";
  await page("panic", "", async ({ says, find }) => {
    await says(/made a mistake and has stopped: .*panicked at/);
    return [!find(".save") && "it saves no preset"];
  }, fail);
}

export async function scoreboard() {
  await page("scoreboard", "?scoreboard", async ({ find, frame, says }) => {
    await says(/^Counted at 0°/, ".status");
    const ways = [...frame.contentDocument.querySelectorAll(".way")].map((way) => ({
      name: way.querySelector("h2").textContent,
      state: way.dataset.state,
      wrong: Number(way.querySelector(".number").textContent.replaceAll(",", "")),
      red: way.querySelector(".faults").getContext("2d").getImageData(0, 0, 400, 300).data.filter((byte, at) => at % 4 === 3 && byte).length,
    }));
    const faults = ways.filter(({ wrong, red }) => wrong !== red).map(({ name, wrong, red }) => `${name}: ${wrong} wrong, ${red} red`);
    const wrong = Object.fromEntries(ways.map(({ name, wrong }) => [name, wrong]));
    if (ways.length !== 5) faults.push(`${ways.length} ways`);
    if (!(wrong.Exact <= 4)) faults.push(`exact: ${wrong.Exact} wrong`);
    if (!(wrong["16-bit depth"] > 100)) faults.push(`16-bit depth: ${wrong["16-bit depth"]} wrong`);
    let copied;
    Object.defineProperty(frame.contentWindow.navigator, "clipboard", { value: { writeText: async (text) => (copied = text) } });
    [...find("footer").querySelectorAll("button")].at(-1).click();
    await until(() => copied, "the result is copied", 5);
    if (!/Exact: \d+ wrong of 120,000 pixels[^]*http:.*\?scoreboard/.test(copied)) faults.push(`copied: ${copied}`);
    console.log(copied);
    return faults;
  });
}
