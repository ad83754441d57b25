"""The detection suite: commands that the unchanged shaders pass, cheapest kind first."""

import glob
import os

# Steps in the order in which a mutant meets them: the gallery, small; presets with options and scenes that the gallery lacks, in
# scripts/mutation/presets; extreme cases; random presets; effects of files.
STEPS = ["verify", "options", "stress", "fuzz", "examples"]

SMALL = ["--size", "96x72", "--frames", "2"]
# The oracle evaluates the text of effects of files, which takes longer.
SMALLER = ["--size", "48x36"]

# Cases of `stress` that take little time; a name stands for all cases whose names contain it.
STRESS = [
    "clipped-quads", "beyond-the-guard-band", "rotated-quads", "fan-around-a-sample", "d3d", "translation", "sizes", "slivers",
    "size-class-borders", "guard-band", "clipped-needles", "w-around-zero", "non-finite", "depth-range", "relative-positions", "coplanar-layers", "near-ties",
    "degenerate-triangles", "queues", "empty-pictures", "odd-picture-sizes", "mirrored-transforms", "draw-limit", "unusual-skins",
    "rotations-of-any-length", "after-a-day", "shuffled-triangles", "near-plane-sweep", "culled-walk", "culled-cameras", "culled-behind-holes", "edges-beside-axes",
    "clipped-in-turns", "played-particles", "normals-along-axes",
    "skins-beside-other-meshes",
]  # fmt: skip

# Examples that take the oracle half a minute of a CPU, and whose library files others read too.
SLOW_EXAMPLES = ["strata"]

# `fuzz` in parts of this many presets, so that one part suffices to detect most.
FUZZ_PART = 10

# Notes that tell of a failure while the program goes on, for instance to shrink a preset that failed.
FAILED_NOTE = {"fuzz": r"^seed \d+ failed: ", "stress": r"^case \d+, [\w-]+: "}


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
        return [program, "--shaders", shaders, *self.words]


def probes(root, fuzz_count, fuzz_seed, leave_out=(), joins_stress=True, cases=()):
    """All probes, in the order of their steps. `joins_stress`: the program takes several cases at once. `cases`: more cases of `stress`."""

    def presets(step, head, folder, but=()):
        paths = sorted(glob.glob(os.path.join(root, folder, "*.toml")))
        stems = {path: os.path.basename(path)[: -len(".toml")] for path in paths}
        return [Probe(step, head, [os.path.relpath(path, root)]) for path in paths if stems[path] not in but]

    found = presets("verify", ["verify", *SMALL], "presets")
    found += presets("options", ["verify", "--frames", "2"], os.path.join("scripts", "mutation", "presets"))
    for name in STRESS + [case for case in cases if case not in STRESS]:
        found.append(Probe("stress", ["stress", "--filter"], [name], ",") if joins_stress else Probe("stress", ["stress", "--filter", name], []))
    for begin in range(0, fuzz_count, FUZZ_PART):
        part = min(FUZZ_PART, fuzz_count - begin)
        found.append(Probe("fuzz", ["fuzz", "--seed", str(fuzz_seed + begin), "--count", str(part)], []))
    found += presets("examples", ["verify", *SMALLER], "examples", SLOW_EXAMPLES)
    return [probe for probe in found if probe.step not in leave_out]


def commands(relevant, stem, seconds):
    """Groups of probes, each one command, for a mutant of the file `stem`: of every step first the cheapest probe, one that is named
    after the file if there is one, then the others."""

    def rank(probe):
        return (stem not in probe.name, seconds.get(probe.name, 0.0))

    groups = []
    for step in STEPS:
        of_step = sorted((probe for probe in relevant if probe.step == step), key=rank)
        by_head = {}
        for probe in of_step:
            by_head.setdefault(tuple(probe.head), []).append(probe)
        for same in by_head.values():
            first = 1 if len(same) > 2 else len(same)
            groups += [group for group in (same[:first], same[first : first + 6], same[first + 6 :]) if group]
    return groups


def merged(group):
    """One probe that runs a group."""
    return Probe(group[0].step, group[0].head, [one for probe in group for one in probe.inputs], group[0].joint)
