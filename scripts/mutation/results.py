"""The results of a campaign: a JSON file that is written anew after every mutant, and the tables."""

import json
import os
import tempfile

SCHEMA = 1
# What a mutant's kind says of it: a failed comparison is the usual one.
CAUGHT = dict.fromkeys(["failed", "hang", "crash", "lost", "refused"], "caught")
# Those that the list named when they were due were not run.
UNCAUGHT = {"passed": "survived", "unreached": "unreached", "listed": "survived"}


class BadResults(ValueError):
    """A file of results that cannot be continued."""


def write(path, results):
    """Replaces the file at once, so that an interrupted campaign leaves a whole one."""
    folder = os.path.dirname(os.path.abspath(path))
    handle, temporary = tempfile.mkstemp(prefix=".mutants-", suffix=".json", dir=folder)
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        json.dump(results, file, indent=1, ensure_ascii=False)
        file.write("\n")
    os.replace(temporary, path)


def read(path, same):
    """Results to continue; those of `same` (shaders, program, suite) must be equal."""
    try:
        with open(path, encoding="utf-8") as file:
            results = json.load(file)
    except (OSError, ValueError) as error:
        raise BadResults(f"{path} cannot be read: {error}") from error
    if not isinstance(results, dict) or results.get("schema") != SCHEMA:
        raise BadResults(f"{path} is no result of this script; begin without --resume")
    for name, value in same.items():
        if results.get(name) != value:
            raise BadResults(f"{path} belongs to another {name}; begin without --resume")
    return results


def outcome(mutant, equivalents):
    """caught, survived, unreached, invalid or equivalent; `equivalents` are those that the list names now."""
    if mutant["kind"] in UNCAUGHT:
        return "equivalent" if mutant["id"] in equivalents else UNCAUGHT[mutant["kind"]]
    return CAUGHT.get(mutant["kind"], mutant["kind"])


def counts(mutants, equivalents):
    total = dict.fromkeys(["caught", "survived", "unreached", "invalid", "equivalent"], 0)
    for mutant in mutants:
        total[outcome(mutant, equivalents)] += 1
    return total


def score(total):
    """Caught of those that are valid and not equivalent; none where there are none."""
    judged = total["caught"] + total["survived"] + total["unreached"]
    return total["caught"] / judged if judged else None


def _table(head, rows):
    rows = [head, *rows]
    widths = [max(len(str(row[column])) for row in rows) for column in range(len(head))]
    lines = []
    for row in rows:
        cells = [str(cell).ljust(width) if at == 0 else str(cell).rjust(width) for at, (cell, width) in enumerate(zip(row, widths))]
        lines.append("  ".join(cells).rstrip())
    return lines


def _by(mutants, equivalents, key):
    names = sorted({key(mutant) for mutant in mutants})
    rows = []
    for name in names:
        total = counts([mutant for mutant in mutants if key(mutant) == name], equivalents)
        of = score(total)
        rows.append([name, *total.values(), "" if of is None else f"{100 * of:.1f} %"])
    return rows


def tables(mutants, equivalents):
    """Lines: what caught the mutants, and the counts by folder and by operator."""
    head = ["caught", "survived", "unreached", "invalid", "equivalent", "score"]
    caught = [mutant for mutant in mutants if outcome(mutant, equivalents) == "caught"]
    ways = {}
    for mutant in caught:
        way = mutant["step"] if mutant["kind"] == "failed" else f"{mutant['step']}: {mutant['kind']}"
        ways[way] = ways.get(way, 0) + 1
    lines = _table(["CAUGHT BY", "mutants"], sorted(ways.items(), key=lambda way: -way[1]))
    lines += ["", *_table(["FOLDER", *head], _by(mutants, equivalents, lambda mutant: "/".join(mutant["part"].split("/")[:-1])))]
    lines += ["", *_table(["OPERATOR", *head], _by(mutants, equivalents, lambda mutant: mutant["operator"]))]
    return lines


def diff(mutant):
    """The mutant as a diff of one line."""
    head = f"{mutant['id']}  shaders/{mutant['file']}.wgsl:{mutant['line']}  ({mutant['operator']})"
    after = mutant["after"].strip()
    return [head, f"  - {mutant['before'].strip()}", f"  + {after}" if after else "  (dropped)"]
