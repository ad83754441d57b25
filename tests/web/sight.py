#!/usr/bin/env python3
"""Promise: a stranger sees what the page is, and one verdict; where there is no device, no secure address or nothing of that name, the page says so
in plain words, shows the oracle's picture or the gallery, and leads on; on a desktop and on a phone nothing jumps, sticks out or is asked for in vain.

Serves dist/ as run.py does and steers headless Chromium through its pipe.

  tests/web/sight.py                        everything
  tests/web/sight.py FOLDER                 leaves a picture of every sight in the folder
  tests/web/sight.py [FOLDER] --only WORDS  the sights whose names have these words"""

import argparse
import base64
import fcntl
import functools
import http.server
import json
import os
import pathlib
import queue
import re
import select
import struct
import subprocess
import sys
import tempfile
import threading
import time

import run

SIZES = {"desktop": (1280, 800), "phone": (390, 844)}
PATIENCE_S = 120
BARE = "--headless --no-sandbox --no-first-run --disable-background-networking --disable-component-update --disable-sync".split()
# Names that are not localhost are no secure addresses.
INSECURE = ["--host-resolver-rules=MAP insecure.test 127.0.0.1"]
BROWSERS = {"device": run.FLAGS + INSECURE, "no adapter": [*BARE, "--disable-gpu"], "no WebGPU": [*BARE, "--disable-gpu", "--disable-blink-features=WebGPU"]}
TERMINAL = re.compile(r"--adapter|mesa|Vulkan driver|/given/|rasterlab [a-z]+ [A-Z-]|not compiled")
# A page has come to rest with a verdict, a trouble, or the oracle's picture.
VERDICT = r"agree|oracle's picture, drawn|differ"


def cut_glb():
    """A GLB of two triangles of their own buffer views, without the bytes of the second, and its whole length."""
    views = [{"buffer": 0, "byteOffset": 36 * at, "byteLength": 36} for at in range(2)]
    corners = [{"bufferView": at, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]} for at in range(2)]
    primitives = [{"attributes": {"POSITION": at}} for at in range(2)]
    text = json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [{"primitives": primitives}],
                       "accessors": corners, "bufferViews": views, "buffers": [{"byteLength": 72}]}).encode()
    text += b" " * (-len(text) % 4)
    length = 12 + 8 + len(text) + 8 + 72
    whole = struct.pack("<4sII", b"glTF", 2, length) + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", 72, b"BIN\0") + run.THREE * 2
    return whole[:-20], length


CUT, WHOLE = cut_glb()
run.MODELS["cut.glb"] = CUT

# Name, browser, address, words that come and stay, in any order: patterns between `.*`. {link} is a link with bits, {cut} the same cut off, {changed} one of other bits.
SIGHTS = [
    ("front", "device", "", r"An effects lab.*The oracle agrees with.*Open in the window.*Who draws the right pixel"),
    ("preset", "device", "?preset=facet", r"Half cut.*The oracle agrees with all 76,800 pixels"),
    ("link", "device", "#{link}", r"This link, your device and the oracle agree, bit for bit"),
    ("changed link", "device", "#{changed}", r"This link was changed.*triangles are not the oracle's"),
    ("cut link", "device", "#{cut}", r"This link is cut off.*home"),
    ("no preset", "device", "?preset=facett", r'The gallery has no preset "facett"'),
    ("no preset in the embed", "device", "?embed&preset=facett", r'The gallery has no preset "facett"'),
    ("no preset in the window", "device", "window.html?preset=facett", r'The gallery has no preset "facett".*Half cut.*home'),
    ("cut link in the window", "device", "window.html#{cut}", r"This link is cut off.*home"),
    ("model that is cut off", "device", "?model=models/cut.glb", rf"of what could be shown: the file is cut off after {len(CUT)} of {WHOLE} bytes"),
    ("model of a site that refuses in the window", "device", "window.html?model=http://127.0.0.1:{port}/models/three.gltf", r"three.gltf cannot be fetched.*CORS"),
    ("embed", "device", "?embed&preset=hero-walk", None),
    ("scoreboard", "device", "?scoreboard", r"Counted at 0°|It turns"),
    ("window", "device", "window.html?preset=facet", None),
    ("insecure", "device", "http://insecure.test:{port}/", r"not secure.*needs https.*oracle's picture, drawn"),
    ("insecure scoreboard", "device", "http://insecure.test:{port}/?scoreboard", r"needs https.*The oracle's picture"),
    ("no adapter", "no adapter", "", r"has WebGPU, but finds no graphics device.*oracle's picture, drawn"),
    ("link without adapter", "no adapter", "#{link}", r"finds no graphics device.*oracle's picture, drawn"),
    ("model without adapter", "no adapter", "?model=models/three.gltf", r"finds no graphics device.*oracle's picture, drawn"),
    ("scoreboard without adapter", "no adapter", "?scoreboard", r"finds no graphics device.*The oracle's picture"),
    ("embed without adapter", "no adapter", "?embed&preset=facet", r"finds no graphics device.*oracle's picture, drawn"),
    ("window without adapter", "no adapter", "window.html?preset=facet", r"finds no graphics device.*See the oracle's picture"),
    ("no WebGPU", "no WebGPU", "", r"has no WebGPU.*oracle's picture, drawn"),
]

LINK = """(async () => {
  const page = await import("./rasterlab_page.js");
  await page.default();
  const preset = new page.OpenPreset(await (await fetch("presets/facet.toml")).text(), "facet");
  return `${preset.line()};${page.oracle_bits(preset.in_portable_bits()).join("-")}`;
})()"""
# What is said, how far things have jumped, what sticks out, which pictures of the gallery are empty, and where what matters ends.
SEEN = """(async () => {
  const shifts = await new Promise((resolve) => {
    let sum = 0;
    new PerformanceObserver((list) => list.getEntries().forEach((entry) => (sum += entry.value))).observe({ type: "layout-shift", buffered: true });
    setTimeout(() => resolve(sum), 200);
  });
  const wide = document.documentElement.scrollWidth - innerWidth;
  const broken = [...document.images].filter((image) => image.complete && image.src && !image.naturalWidth).map(({ src }) => src);
  const ends = ["#name", "#picture", "#caption", "#door", "#score"].map((name) => [name, document.querySelector(name)?.getBoundingClientRect()]).map(([name, rect]) => [name, rect?.bottom]);
  const greens = [...document.querySelectorAll(".right")].filter((line) => line.textContent).length;
  const picture = document.querySelector("#picture");
  const drawn = picture && [picture.width, Math.round(picture.getBoundingClientRect().width * devicePixelRatio)];
  const icon = document.querySelector("link[rel=icon]")?.href;
  const description = document.querySelector("meta[name=description]")?.content;
  return { title: document.title, shifts, wide, broken, ends, greens, drawn, icon, description, saves: !!document.querySelector(".save"), address: location.search };
})()"""


class Browser:
    """Chromium with one page, steered by messages through its pipe, each ended by a zero byte."""

    def __init__(self, flags, profile):
        (mine_in, its_out), (its_in, mine_out) = os.pipe(), os.pipe()
        # Above those that it expects, 3 and 4.
        its_in, its_out = (fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (its_in, its_out))

        def place():
            os.dup2(its_in, 3)
            os.dup2(its_out, 4)

        self.process = subprocess.Popen(
            [run_chromium(), *flags, "--remote-debugging-pipe", f"--user-data-dir={profile}", "about:blank"],
            preexec_fn=place, pass_fds=(3, 4), stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self.input, self.output, self.rest, self.asked, self.failed = mine_out, mine_in, b"", 0, []
        self.session = None
        target = next(info for info in self.ask("Target.getTargets")["targetInfos"] if info["type"] == "page")
        self.session = self.ask("Target.attachToTarget", targetId=target["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Network", "Runtime"):
            self.ask(f"{domain}.enable")

    def ask(self, method, **parameters):
        self.asked += 1
        message = {"id": self.asked, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.input, json.dumps(message).encode() + b"\0")
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            for message in self.heard(end):
                if message.get("id") == self.asked:
                    if "error" in message:
                        raise RuntimeError(f"{method}: {message['error']['message']}")
                    return message["result"]
        raise TimeoutError(method)

    def heard(self, end):
        """Messages that are there; requests that fail are kept."""
        while b"\0" not in self.rest:
            if not select.select([self.output], [], [], max(0, end - time.monotonic()))[0]:
                return
            self.rest += os.read(self.output, 1 << 20)
        text, self.rest = self.rest.split(b"\0", 1)
        message = json.loads(text)
        if message.get("method") == "Network.responseReceived" and message["params"]["response"]["status"] >= 400:
            self.failed.append(message["params"]["response"]["url"])
        if message.get("method") == "Network.loadingFailed" and not message["params"].get("canceled"):
            self.failed.append(message["params"]["errorText"])
        yield message

    def value(self, expression):
        told = self.ask("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in told:
            raise RuntimeError(told["exceptionDetails"]["exception"].get("description", "it threw"))
        return told["result"].get("value")

    def open(self, address, size):
        self.ask("Emulation.setDeviceMetricsOverride", width=size[0], height=size[1], deviceScaleFactor=1, mobile=size[0] < 600)
        # A fragment alone would stay on the same page.
        self.ask("Page.navigate", url="about:blank")
        self.ask("Page.navigate", url=address)
        self.failed.clear()

    def wait(self, expression, what):
        end = time.monotonic() + PATIENCE_S
        while time.monotonic() < end:
            try:
                if found := self.value(expression):
                    return found
            except RuntimeError:
                pass
            time.sleep(0.3)
        raise TimeoutError(what)

    def picture(self, file):
        file.write_bytes(base64.b64decode(self.ask("Page.captureScreenshot", format="png")["data"]))

    def close(self):
        self.process.kill()
        self.process.wait()
        os.close(self.input)
        os.close(self.output)


def run_chromium():
    return run.shutil.which("chromium") or run.shutil.which("chromium-browser")


def is_meant(failed, name):
    """A site that refuses is asked in this sight alone."""
    return "refuses" in name and ("ERR_FAILED" in failed or "three.gltf" in failed)


def is_absent(name):
    return "cut" in name or name.startswith("no preset") or "insecure" in name


def faults_of(browser, kind, name, words, size):
    """What is wrong with the sight that is open."""
    said = ""
    if words:
        text = 'document.body?.innerText ?? ""'
        try:
            browser.wait(" && ".join(f"/{part}/.test({text})" for part in words.split(".*")), "")
        except TimeoutError:
            return [f"it does not say {words!r}, but {browser.value(text)!r}"]
        said = browser.value(text)
    if "window" in name and kind == "device":
        browser.wait('document.getElementById("caption")?.hidden', "the window does not open")
    elif not words:
        browser.wait('document.querySelector("#still")?.hidden', "no picture comes")
    time.sleep(2)
    seen = browser.value(SEEN)
    told = [
        (TERMINAL.search(said), f"it says {TERMINAL.search(said)}"),
        (seen["shifts"] > (0.02 if kind == "device" and not is_absent(name) else 0.1), f"it jumps by {seen['shifts']:.3f}"),
        (seen["wide"] > 0, f"it is {seen['wide']} pixels too wide"),
        (seen["broken"], f"empty pictures: {seen['broken']}"),
        (not seen["title"] or not seen["icon"] or not seen["description"], "it lacks a title, an icon or a description"),
        ("changed" in name and seen["greens"], "something is green"),
        ("cut link" in name and seen["saves"], "it offers something to save"),
        ([one for one in browser.failed if not is_meant(one, name)], f"requests fail: {browser.failed}"),
    ]
    if name == "front":
        told += [(end > size[1], f"{what} ends at {end:.0f}") for what, end in seen["ends"]]
        told += [(abs(seen["drawn"][0] - seen["drawn"][1]) > 1, f"it is drawn {seen['drawn'][0]} wide and shown {seen['drawn'][1]} wide")]
    return [words for is_wrong, words in told if is_wrong]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", nargs="?", type=pathlib.Path)
    parser.add_argument("--only", action="append", default=[])
    asked = parser.parse_args()
    if run_chromium() is None:
        print("web: no Chromium here; sh scripts/setup.sh --web installs it", file=sys.stderr)
        return 2
    server = http.server.ThreadingHTTPServer(("localhost", 0), functools.partial(run.Pages, reports=queue.Queue(), kernels=None))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    port = server.server_port
    site = f"http://localhost:{port}/"
    passed = failed = 0
    names = {}
    for kind, flags in BROWSERS.items():
        sights = [sight for sight in SIGHTS if sight[1] == kind and (not asked.only or any(words in sight[0] for words in asked.only))]
        if not sights:
            continue
        with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
            browser = Browser(flags, profile)
            try:
                if not names:
                    browser.open(f"{site}test.html?only=nothing", SIZES["desktop"])
                    link = browser.wait(LINK, "a link")
                    names = {"link": link, "cut": link[: len(link) // 2], "changed": link.partition(";")[0] + ";" + "0" * 16 + link[-17:], "port": port}
                for name, _, address, words in sights:
                    for screen, size in SIZES.items():
                        began, whole = time.monotonic(), address.format(**names)
                        browser.open(whole if whole.startswith("http") else site + whole, size)
                        try:
                            faults = faults_of(browser, kind, name, words, size)
                        except (TimeoutError, RuntimeError) as error:
                            faults = [str(error)]
                        if asked.folder:
                            browser.picture(asked.folder / f"{name.replace(' ', '-')}-{screen}.png")
                        print(f"{name}, {screen}, {time.monotonic() - began:.0f} s: {'; '.join(faults) or 'ok'}", flush=True)
                        passed, failed = (passed, failed + 1) if faults else (passed + 1, failed)
            finally:
                browser.close()
    print(f"{passed} passed, {failed} failed")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
