"""Which mutants a campaign tries: a fixed number, spread over heads and sections of files in proportion to their lines, the same for the same seed."""

import hashlib
import os
import re

from . import operators, wgsl

# Folders, files and sections of files, below `shaders`, that are not changed, each with the reason.
EXCLUDED = {
    "baselines/": "for comparison only: `bench` measures these kernels, and `verify` judges none of their pictures",
    "variants/coverage/float": "errs by design: no right answer exists that a change could miss",
    "variants/large_edges/float": "errs by design, as coverage = float does",
}
# Also left alone, in every file: comments and directives; heads of functions, structs and bindings, which reflection compares with the
# Rust side; the defaults of overrides, all of which the kernel key replaces; the step of a `for` loop.


def excluded(name):
    return next((reason for prefix, reason in EXCLUDED.items() if name.startswith(prefix)), None)


def files(shaders):
    """Name (without .wgsl) and text of every file, sorted."""
    found = {}
    for folder, _, names in os.walk(shaders):
        for name in names:
            if name.endswith(".wgsl"):
                path = os.path.join(folder, name)
                with open(path, encoding="utf-8") as file:
                    found[os.path.relpath(path, shaders)[: -len(".wgsl")].replace(os.sep, "/")] = file.read()
    return dict(sorted(found.items()))


SECTION = re.compile(r"//@ (?:variant|step) (\w+)")


def parts(texts):
    """File and text of every part: the head of a file (`lib/fixed`), and each section (`variants/coverage/fixed`). The text is the file's with
    the lines of other parts left empty, so that lines keep their numbers."""
    found = {}
    for file, text in texts.items():
        lines, part = text.split("\n"), file
        for number, line in enumerate(lines):
            section = SECTION.fullmatch(line.strip())
            part = f"{file}/{section.group(1)}" if section else part
            found.setdefault(part, (file, [""] * len(lines)))[1][number] = line
    return {part: (file, "\n".join(lines)) for part, (file, lines) in found.items()}


def _rank(*parts):
    return hashlib.sha256("\0".join(map(str, parts)).encode()).hexdigest()


def sites(part, file, text, signatures):
    """Every mutant of a part. Its id depends on the part's name and the changed line's text, not on the line's number."""
    lines, found, occurrences = text.split("\n"), {}, {}
    for number, code in enumerate(wgsl.changeable(text), 1):
        line = lines[number - 1]
        occurrences[line] = occurrences.get(line, -1) + 1
        for operator, begin, end, replacement in operators.edits(code, signatures):
            after = (line[:begin] + replacement + line[end:]).rstrip()
            if after == line.rstrip():
                continue
            identity = _rank(part, line.strip(), after.strip(), occurrences[line])[:10]
            mutant = {"id": identity, "part": part, "file": file, "line": number, "operator": operator, "before": line, "after": after}
            found.setdefault(identity, mutant)
    return list(found.values())


def _of_part(found, count, seed):
    """`count` of a part's mutants: lines that have none yet first, and of a line the operators that were used least."""
    found = sorted(found, key=lambda mutant: _rank(seed, mutant["id"]))
    chosen, per_line, per_operator = [], {}, {}
    while found and len(chosen) < count:
        best = min(found, key=lambda mutant: (per_line.get(mutant["line"], 0), per_operator.get(mutant["operator"], 0)))
        found.remove(best)
        chosen.append(best)
        per_line[best["line"]] = per_line.get(best["line"], 0) + 1
        per_operator[best["operator"]] = per_operator.get(best["operator"], 0) + 1
    return chosen


def shares(weights, count):
    """`count` divided in proportion to the weights, at least 1 each where it suffices; the largest remainders are rounded up."""
    total = sum(weights.values())
    exact = {name: count * weight / total for name, weight in weights.items()}
    given = {name: max(1, int(value)) for name, value in exact.items()}
    by_remainder = sorted(exact, key=lambda name: (given[name] - exact[name], name))
    missing = count - sum(given.values())
    for name in by_remainder[: max(missing, 0)]:
        given[name] += 1
    while sum(given.values()) > count:
        largest = max(given, key=lambda name: (given[name] > 1, given[name] - exact[name], name))
        given[largest] -= 1
    return given


def every(texts):
    """Every mutant of every part."""
    signatures = wgsl.signatures(texts.values())
    return {part: sites(part, file, text, signatures) for part, (file, text) in parts(texts).items()}


def mutants(texts, count, seed):
    """The mutants of a campaign in the order in which they run, which mixes the files, so that any beginning of it is a fair sample."""
    found = {name: of_part for name, of_part in every(texts).items() if of_part and excluded(name) is None}
    lines = {name: sum(map(wgsl.is_code, text.split("\n"))) for name, (_, text) in parts(texts).items() if name in found}
    given = shares(lines, min(count, sum(map(len, found.values()))))
    chosen = [mutant for name in found for mutant in _of_part(found[name], given[name], seed)]
    return sorted(chosen, key=lambda mutant: _rank(seed, "order", mutant["id"]))


def changed(text, mutant):
    """The file with the mutant's line, which must stand where the mutant says; a planted mutant may replace several lines or a part of one."""
    if mutant["operator"] == "planted":
        return text.replace(mutant["before"], mutant["after"])
    lines = text.split("\n")
    if lines[mutant["line"] - 1] != mutant["before"]:
        raise ValueError(f"{mutant['file']}.wgsl has another line {mutant['line']} than mutant {mutant['id']}")
    lines[mutant["line"] - 1] = mutant["after"]
    return "\n".join(lines)
