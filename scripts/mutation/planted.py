"""The mistakes that people planted: scripts/mutation/planted.toml. Each replaces a text that stands exactly once in all shaders, in whichever
file that is."""

import hashlib
import os
import tomllib

from . import choose

LIST = os.path.join(os.path.dirname(os.path.abspath(__file__)), "planted.toml")


class BadEntry(ValueError):
    """An entry whose text does not stand in the shaders exactly once."""


def entries(path=LIST):
    with open(path, "rb") as file:
        return tomllib.load(file)["mutant"]


def mutants(texts, listed):
    """The mutants of the list, as those of `choose.mutants`; `case` is the stress case that is asked first, or empty."""
    found, parts = [], choose.parts(texts)
    for entry in listed:
        before, after = entry["from"], entry["to"]
        files = [name for name, text in texts.items() for _ in range(text.count(before))]
        if len(files) != 1 or before == after:
            raise BadEntry(f"planted.toml: {before!r} stands {len(files)} times in the shaders; an entry replaces a text that is there once")
        name = files[0]
        line = texts[name][: texts[name].index(before)].count("\n") + 1
        part = next(part for part, (file, text) in parts.items() if file == name and text.split("\n")[line - 1])
        identity = hashlib.sha256("\0".join(["planted", before, after]).encode()).hexdigest()[:10]
        found.append({
            "id": identity, "part": part, "file": name, "line": line, "operator": "planted", "before": before, "after": after, "case": entry.get("case", ""),
        })  # fmt: skip
    return found


def cases(listed):
    """Names of the stress cases that the list asks for."""
    return sorted({entry["case"] for entry in listed if "case" in entry})
