#!/usr/bin/env python3
"""Promise: the window opens in a page of Chromium and draws its preset, an edit changes the picture, a preset is saved by a download,
dropped models, archives, folders and effects and models at addresses open, judgements and Trade go on in workers, films are downloads, everything is exported and taken in
again, settings survive a reload, a narrow window folds its panels, and a mistake shows its words.

Serves dist/ (sh scripts/web.sh) and tests/web/window_test.html as run.py does.

  tests/web/window.py                        everything
  tests/web/window.py FOLDER                 leaves pictures of the window in the folder
  tests/web/window.py [FOLDER] --only WORDS  the tests whose names have these words; may be given several times"""

import base64
import pathlib
import sys

import run

FOLDER = next((argument for argument in sys.argv[1:2] if not argument.startswith("--")), None)


class Pages(run.Pages):
    """Those of run.py, and a place for pictures of the window."""

    def do_PUT(self):
        picture = self.rfile.read(int(self.headers["Content-Length"]))
        if FOLDER:
            file = pathlib.Path(FOLDER) / pathlib.Path(self.path).name
            file.write_bytes(base64.b64decode(picture.partition(b",")[2]))
        self.send_response(204)
        self.end_headers()


if __name__ == "__main__":
    run.BESIDE_DIST["/window_test.html"] = run.ROOT / "tests/web/window_test.html"
    run.Pages = Pages
    run.FLAGS.append("--window-size=1280,800")
    sys.exit(run.main("window_test.html", sys.argv[2:] if FOLDER else sys.argv[1:]))
