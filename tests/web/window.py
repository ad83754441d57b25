#!/usr/bin/env python3
"""Promise: the window opens in a page of Chromium and draws its preset, an edit changes the picture, a preset is
saved by a download, a dropped model is shown, and settings survive a reload.

Serves dist/ (sh scripts/web.sh) and tests/web/window_test.html as run.py does. With a folder as argument it leaves pictures of the window
there."""

import base64
import pathlib
import sys

import run


class Pages(run.Pages):
    """Those of run.py, and a place for pictures of the window."""

    def do_PUT(self):
        picture = self.rfile.read(int(self.headers["Content-Length"]))
        if len(sys.argv) > 1:
            file = pathlib.Path(sys.argv[1]) / pathlib.Path(self.path).name
            file.write_bytes(base64.b64decode(picture.partition(b",")[2]))
        self.send_response(204)
        self.end_headers()


if __name__ == "__main__":
    run.BESIDE_DIST["/window_test.html"] = run.ROOT / "tests/web/window_test.html"
    run.Pages = Pages
    run.FLAGS.append("--window-size=1280,800")
    sys.exit(run.main("window_test.html", []))
