"""The list of mutants that change nothing that may be seen, each with the reason: scripts/mutants-equivalent.txt.

    PART: BEFORE => AFTER ## REASON
    PART: BEFORE => * ## REASON
    PART: => ## REASON

on one line each. The second form is of every change of a line, the third of a part that no command links on some adapters: it counts where one does. PART is a file, or a section of one (`variants/coverage/fixed`); BEFORE and AFTER are the line without and with the
change, indentation left out; AFTER is empty where the line is dropped. An entry is found by these texts, not by a line number, so it outlives changes elsewhere in the file.
"""

import re

ENTRY = re.compile(r"(?P<part>[\w/]+):(?: (?P<before>.+?))?? =>(?: (?P<after>.*?))? ## (?P<reason>.+)")


class BadEntry(ValueError):
    """A line of the list that is no entry."""


def parse(text):
    """Entries by (part, before, after)."""
    entries = {}
    for number, line in enumerate(text.split("\n"), 1):
        if not line.strip() or line.startswith("#"):
            continue
        found = ENTRY.fullmatch(line.strip())
        if not found:
            raise BadEntry(f"line {number} is no entry: {line.strip()!r}; write PART: BEFORE => AFTER ## REASON")
        key = found["part"], (found["before"] or "").strip(), (found["after"] or "").strip()
        if key in entries:
            raise BadEntry(f"line {number} repeats an entry: {line.strip()!r}")
        entries[key] = found["reason"].strip()
    return entries


def reason(entries, mutant):
    part, before = mutant["part"], mutant["before"].strip()
    return entries.get((part, before, mutant["after"].strip())) or entries.get((part, before, "*"))


def elsewhere(entries, part):
    """Why no command may link a part; none where one should."""
    return entries.get((part, "", ""))


def line(mutant, why="REASON"):
    """The entry of a mutant, to be pasted into the list."""
    return f"{mutant['part']}: {mutant['before'].strip()} => {mutant['after'].strip()} ## {why}".replace("=>  ##", "=> ##")


def stale(entries, parts):
    """Entries whose line no longer stands in its part; `parts` as of `choose.parts`."""
    gone = []
    for part, before, after in entries:
        lines = {one.strip() for one in parts.get(part, ("", ""))[1].split("\n")}
        if part not in parts or before not in lines:
            gone.append(f"{part}: {before} => {after}")
    return gone
