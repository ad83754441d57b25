"""The list of mutants that change nothing that may be seen, each with the reason: scripts/mutants-equivalent.txt.

    FILE: BEFORE => AFTER ## REASON

on one line each; BEFORE and AFTER are the line without and with the change, indentation left out; AFTER is empty where the line is
dropped. An entry is found by these texts, not by a line number, so it outlives changes elsewhere in the file.
"""

import re

ENTRY = re.compile(r"(?P<file>[\w/]+): (?P<before>.+?) =>(?: (?P<after>.*?))? ## (?P<reason>.+)")


class BadEntry(ValueError):
    """A line of the list that is no entry."""


def parse(text):
    """Entries by (file, before, after)."""
    entries = {}
    for number, line in enumerate(text.split("\n"), 1):
        if not line.strip() or line.startswith("#"):
            continue
        found = ENTRY.fullmatch(line.strip())
        if not found:
            raise BadEntry(f"line {number} is no entry: {line.strip()!r}; write FILE: BEFORE => AFTER ## REASON")
        key = found["file"], found["before"].strip(), (found["after"] or "").strip()
        if key in entries:
            raise BadEntry(f"line {number} repeats an entry: {line.strip()!r}")
        entries[key] = found["reason"].strip()
    return entries


def reason(entries, mutant):
    return entries.get((mutant["file"], mutant["before"].strip(), mutant["after"].strip()))


def line(mutant, why="REASON"):
    """The entry of a mutant, to be pasted into the list."""
    return f"{mutant['file']}: {mutant['before'].strip()} => {mutant['after'].strip()} ## {why}".replace("=>  ##", "=> ##")


def stale(entries, texts):
    """Entries whose line no longer stands in its file."""
    gone = []
    for file, before, after in entries:
        lines = {one.strip() for one in texts.get(file, "").split("\n")}
        if before not in lines:
            gone.append(f"{file}: {before} => {after}")
    return gone
