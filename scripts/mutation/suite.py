"""The detection suite: commands that the unchanged shaders pass, cheapest kind first."""

import glob
import os

# Steps of equal cost in the order in which a mutant meets them: the gallery, small; presets with options and scenes that the gallery lacks, in
# scripts/mutation/presets, and goldens of effects of files in scripts/mutation/files, whose oracle would follow a change of the library; extreme
# cases; cases that need code and random presets, of the developers' program; effects of files.
STEPS = ["verify", "options", "stress", "cases", "fuzz", "examples"]

# The developers' program, beside the program, and its steps.
DEVELOPERS = "rasterlab-fuzz"
DEVELOPERS_STEPS = ["cases", "fuzz"]

SMALL = ["--size", "96x72", "--frames", "2"]
# The oracle evaluates the text of effects of files, which takes longer.
SMALLER = ["--size", "48x36"]

# Extreme cases that take long.
SLOW_STRESS = ["million-triangles", "many-layers-of-xray", "layers-of-glass", "too-many-layers-of-glass"]

# Cases that need code and take little time; a name stands for all cases whose names contain it.
CASES = [
    "d3d-snap", "translation", "non-finite", "near-ties", "degenerate-triangles", "queues",
    "empty-pictures", "mirrored-transforms", "shuffled-triangles",
    "near-plane-sweep", "culled-cameras", "culled-behind-holes", "clipped-in-turns", "skins-beside-other-meshes",
]  # fmt: skip

# Examples that take the oracle half a minute of a CPU, and whose library files others read too.
SLOW_EXAMPLES = ["strata"]

# Most probes of one command, so that a mutant which one of them notices does not wait for all.
REST = 20

# `fuzz` in parts of this many presets, so that one part suffices to detect most.
FUZZ_PART = 10

# Notes that tell of a failure while the program goes on, for instance to shrink a preset that failed.
FAILED_NOTE = {"fuzz": r"^seed \d+ failed: ", "stress": r"^case [\w-]+: ", "cases": r"^case [\w-]+: "}


class Probe:
    """One command of the suite. Those of the same `head` can be run as one command with several inputs, which `joint` puts together."""

    def __init__(self, step, head, inputs, joint=None):
        self.step, self.head, self.inputs, self.joint = step, head, inputs, joint

    @property
    def words(self):
        return self.head + (self.inputs if self.joint is None else [self.joint.join(self.inputs)])

    @property
    def name(self):
        return " ".join(self.words)

    def command(self, program, shaders):
        if self.step in DEVELOPERS_STEPS:
            return [os.path.join(os.path.dirname(program), DEVELOPERS), self.words[0], "--shaders", shaders, *self.words[1:]]
        return [program, "--shaders", shaders, *self.words]


def probes(root, fuzz_count, fuzz_seed, leave_out=(), cases=()):
    """All probes, in the order of their steps. `cases`: more cases, which may be slow."""

    def presets(step, head, folder, but=()):
        paths = sorted(glob.glob(os.path.join(root, folder, "*.toml")))
        stems = {path: os.path.basename(path)[: -len(".toml")] for path in paths}
        return [Probe(step, head, [os.path.relpath(path, root)]) for path in paths if stems[path] not in but]

    found = presets("verify", ["verify", *SMALL], "presets")
    found += presets("options", ["verify", "--frames", "2"], os.path.join("scripts", "mutation", "presets"))
    found += presets("options", ["check", "--render"], os.path.join("scripts", "mutation", "files"))
    extremes = [os.path.basename(path)[: -len(".toml")] for path in sorted(glob.glob(os.path.join(root, "presets", "extremes", "*.toml")))]
    quick = [name for name in extremes if name not in SLOW_STRESS or name in cases]
    found += [Probe("stress", ["stress", "--filter"], [name], ",") for name in quick]
    others = [case for case in cases if case not in CASES and case not in quick]
    found += [Probe("cases", ["cases"], [name], ",") for name in CASES + others]
    for begin in range(0, fuzz_count, FUZZ_PART):
        part = min(FUZZ_PART, fuzz_count - begin)
        found.append(Probe("fuzz", ["presets", "--seed", str(fuzz_seed + begin), "--count", str(part)], []))
    found += presets("examples", ["verify", *SMALLER], "examples", SLOW_EXAMPLES)
    return [probe for probe in found if probe.step not in leave_out]


def commands(relevant, stem, seconds):
    """Groups of probes, each one command, for a mutant of the file `stem`: first those that are named after the file, then the others;
    what takes less time comes first."""

    def cost(probe):
        return seconds.get(probe.name, 0.0)

    ranked = []
    for step in STEPS:
        by_head = {}
        for probe in sorted((probe for probe in relevant if probe.step == step), key=cost):
            by_head.setdefault(tuple(probe.head), []).append(probe)
        for same in by_head.values():
            named = [probe for probe in same if any(stem in os.path.basename(word) for word in probe.inputs)]
            others = [probe for probe in same if probe not in named]
            rest = [others[begin : begin + REST] for begin in range(10, len(others), REST)]
            ranked += [(0, named[:2]), (0, named[2:]), (1, others[:2]), (1, others[2:10]), *((1, some) for some in rest)]
    ranked = [(rank, sum(map(cost, group)), group) for rank, group in ranked if group]
    return [group for _, _, group in sorted(ranked, key=lambda one: one[:2])]


def merged(group):
    """One probe that runs a group."""
    return Probe(group[0].step, group[0].head, [one for probe in group for one in probe.inputs], group[0].joint)
