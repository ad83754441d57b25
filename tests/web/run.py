#!/usr/bin/env python3
"""Promise: in a page of Chromium the kernels draw the presets as the oracle judges them, the oracle's pictures are the goldens, and links,
embed, scoreboard and troubles say what docs/web.md says.

Serves dist/ (sh scripts/web.sh) and tests/web to headless Chromium on SwiftShader, and prints what the page reports. Fails if a report
names a fault, or if none comes for five minutes.

  tests/web/run.py                    everything
  tests/web/run.py --only NAME        one function of tests/web/*.js; may be given several times
  tests/web/run.py --kernels FOLDER   also has the browser's compiler read the kernels there:
                                      RASTERLAB_LINKED=FOLDER cargo test --release --test house shaders::
  tests/web/run.py --program FILE     also opens a page that this rasterlab writes"""

import argparse
import functools
import http.server
import io
import json
import pathlib
import queue
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import urllib.parse
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PATIENCE_S = 300
# All of them are needed for WebGPU on SwiftShader without a screen; --no-sandbox is for root.
FLAGS = """--headless --no-sandbox --enable-unsafe-webgpu --enable-features=Vulkan --use-vulkan=swiftshader --use-angle=swiftshader
--enable-unsafe-swiftshader --ignore-gpu-blocklist --enable-gpu --disable-quic --disable-background-networking --disable-component-update
--disable-sync --no-first-run""".split()
BESIDE_DIST = {"/test.html": ROOT / "tests/web/test.html", "/strict_hashes.txt": ROOT / "tests/strict_hashes.txt"}
THREE = struct.pack("<9f", -1, -1, 0, 1, -1, 0, 0, 1, 0)


def model(buffer):
    """The text of a model of one triangle, whose corners lie in `buffer` beside it."""
    views = {"bufferViews": [{"buffer": 0, "byteLength": len(THREE)}], "buffers": [{"uri": buffer, "byteLength": len(THREE)}]}
    corners = {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]}
    mesh = {"meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}], "accessors": [corners], **views}
    return json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], **mesh}).encode()


def archive(names):
    """A ZIP archive of these models, in a folder."""
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as zip:
        for name in names:
            zip.writestr(f"folder/{name}", MODELS[name])
    return packed.getvalue()


# Below /models/ for pages of this server, below /open/ for all; /models/huge.glb only says that it is large.
MODELS = {"three.gltf": model("parts/three%20corners.bin"), "parts/three corners.bin": THREE, "out.gltf": model("../out.bin"), "cut.gltf": b"{"}
MODELS["three.zip"] = archive(["three.gltf", "parts/three corners.bin"])
HUGE_BYTES = 300_000_000
PRESETS_WITH_GOLDENS = sorted(file.stem for file in (ROOT / "presets").glob("*.toml") if (ROOT / f"tests/snapshots/{file.stem}.png").exists())


class Pages(http.server.SimpleHTTPRequestHandler):
    """The files of dist/, the test's page, models, and a place for its reports."""

    # Paths of all requests so far.
    asked = []

    def __init__(self, *arguments, reports, kernels, **names):
        self.reports, self.kernels = reports, kernels
        super().__init__(*arguments, directory=ROOT / "dist", **names)

    def translate_path(self, path):
        folder, _, name = path.rpartition("/")
        if folder == "/tests" and name:
            return str(ROOT / "tests/web" / name)
        if folder == "/kernels" and self.kernels:
            return str(self.kernels / name)
        return str(BESIDE_DIST.get(path.partition("?")[0]) or super().translate_path(path))

    def send(self, body, headers={}):
        self.send_response(200)
        for name, value in {"Content-Length": str(len(body)), **headers}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def do_GET(self):
        self.asked.append(self.path)
        _, folder, name = (urllib.parse.unquote(self.path).split("/", 2) + ["", ""])[:3]
        if folder in ("models", "open") and name in MODELS:
            return self.send(MODELS[name], {"Access-Control-Allow-Origin": "*"} if folder == "open" else {})
        if self.path == "/models/huge.glb":
            return self.send(b"", {"Content-Length": str(HUGE_BYTES)})
        lists = {"/presets.json": PRESETS_WITH_GOLDENS, "/kernels.json": self.kernels and sorted(file.name for file in self.kernels.glob("*.wgsl")), "/asked.json": self.asked}
        if self.path not in lists:
            return super().do_GET()
        self.send(json.dumps(lists[self.path]).encode())

    def do_POST(self):
        length = int(self.headers["Content-Length"])
        self.reports.put(json.loads(self.rfile.read(length)))
        self.send_response(204)
        self.end_headers()

    def log_message(self, *_):
        pass


def main(page_name="test.html", arguments=None):
    parser = argparse.ArgumentParser()
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--kernels", type=pathlib.Path)
    parser.add_argument("--program", type=pathlib.Path)
    asked = parser.parse_args(arguments)
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    if chromium is None:
        print("web: no Chromium here; sh scripts/setup.sh --web installs it", file=sys.stderr)
        return 2
    reports = queue.Queue()
    server = http.server.ThreadingHTTPServer(("localhost", 0), functools.partial(Pages, reports=reports, kernels=asked.kernels))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    site = f"http://localhost:{server.server_port}/"
    page = f"{site}{page_name}?" + urllib.parse.urlencode({"only": asked.only}, doseq=True)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        if asked.program:
            BESIDE_DIST["/written.html"] = pathlib.Path(profile) / "written.html"
            subprocess.run([asked.program, "page", "facet", "-q", "-o", BESIDE_DIST["/written.html"], "--page", site], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        browser = subprocess.Popen(
            [chromium, *FLAGS, f"--user-data-dir={profile}", page], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
        )
        passed = failed = 0
        try:
            while not (report := reports.get(timeout=PATIENCE_S)).get("end"):
                faults = report["faults"]
                print(f"{report['test']}: {'; '.join(faults) or 'ok'}", flush=True)
                passed, failed = (passed, failed + 1) if faults else (passed + 1, failed)
        except queue.Empty:
            print(f"web: the page has reported nothing for {PATIENCE_S} s", file=sys.stderr)
            failed += 1
        finally:
            browser.kill()
            browser.wait()
    print(f"{passed} passed, {failed} failed")
    return 1 if failed or not passed else 0


if __name__ == "__main__":
    sys.exit(main())
