"""Checks of the parts that need neither the program nor an adapter: `scripts/mutants.py --self-test`."""

import json
import os
import subprocess
import sys
import tempfile
import unittest

from . import choose, equivalent, operators, planted, results, run, suite, wgsl

FILE = """// A comment with a < b and 1u.
//@ use lib/frame
override LIMIT: u32 = 8u;
@group(0) @binding(9) var<storage, read_write> words: array<u32>;
struct Pair {
    low: u32,  // 1u
    high: u32,
}
const MOST = 7u;
fn f(
    a: vec2i, b: vec2i, @builtin(position) c: u32
) -> array<u32, 3> {
    for (var i = 0u; i < 4u; i += 1u) { words[i] = c; } // 5u
    if c == 2u { return array<u32, 3>(); }
    workgroupBarrier();
    atomicAdd(&words[c], 1u);
    switch c { case 6u: { return g(a, b); } default: {} }
}
@compute @workgroup_size(64)
fn g(a: vec2i, b: vec2i) {}
"""


def after(code, operator):
    """Every line that an operator makes of one."""
    signatures = {"f": ("vec2i", "vec2i", "u32"), "Pair": ("u32", "u32"), "_": ()}
    return [code[:begin] + text + code[end:] for name, begin, end, text in operators.edits(code, signatures) if name == operator]


class Wgsl(unittest.TestCase):
    def test_comments_declarations_heads_and_steps_of_loops_are_left_alone(self):
        masked = wgsl.changeable(FILE)
        lines = FILE.split("\n")
        self.assertEqual(len(masked), len(lines))
        for number in (0, 1, 2, 3, 4, 5, 6, 7, 9, 10, 11, 18, 19):
            self.assertNotRegex(masked[number], r"\w", lines[number])
        self.assertEqual(masked[8].strip(), "const MOST = 7u;")
        loop = masked[12]
        self.assertIn("i < 4u;", loop)
        self.assertIn("words[i] = c;", loop)
        self.assertNotIn("i += 1u", loop)
        self.assertNotIn("5u", loop)
        self.assertNotIn("<u32, 3>", masked[13])
        self.assertNotIn("6u", masked[16])
        self.assertIn("g(a, b)", masked[16])
        for line, mask in zip(lines, masked):
            self.assertTrue(all(b in (a, " ") for a, b in zip(line, mask)), mask)

    def test_code_is_more_than_comments_and_brackets(self):
        self.assertEqual([wgsl.is_code(line) for line in ["// a", "", "}", "a; // b"]], [False, False, False, True])

    def test_arguments_are_split_at_the_outer_commas(self):
        code = "f(a, g(b, c)[d, e], h)"
        self.assertEqual([code[a:b] for a, b in wgsl.arguments(code, 1)], ["a", "g(b, c)[d, e]", "h"])
        self.assertEqual(wgsl.arguments("f(a,", 1), [])

    def test_signatures_have_the_types_of_parameters_and_members(self):
        found = wgsl.signatures([FILE, "fn f(a: u32) {}", "fn h(a: ptr<function, array<u32, 3>>, b: f32) {}"])
        self.assertEqual(found["Pair"], ("u32", "u32"))
        self.assertEqual(found["g"], ("vec2i", "vec2i"))
        self.assertEqual(found["f"], ())
        self.assertEqual(len(found["h"]), 2)


class Operators(unittest.TestCase):
    CASES = [
        ("compare", "if a < b {", ["if a <= b {"]),
        ("compare", "let x = a >= b;", ["let x = a > b;"]),
        ("arithmetic", "let x = a + b - c;", ["let x = a - b - c;", "let x = a + b + c;"]),
        ("arithmetic", "    -b * c", ["    -b + c"]),
        ("arithmetic", "    + b", []),
        ("assignment", "a += b;", ["a -= b;"]),
        ("bits", "let x = a & b;", ["let x = a | b;"]),
        ("bits", "atomicAdd(&a, 1u);", []),
        ("shift", "let x = a >> b;", ["let x = a << b;"]),
        ("logic", "let x = a && b;", ["let x = a || b;"]),
        ("call", "let x = min(max(a, b), c);", ["let x = max(max(a, b), c);", "let x = min(min(a, b), c);"]),
        ("call", "let x = abs(a);", ["let x = (a);"]),
        ("constant", "let x = 0u;", ["let x = 1u;"]),
        ("constant", "let x = 8u;", ["let x = 9u;", "let x = 7u;", "let x = 16u;"]),
        ("constant", "let x = 1.5;", ["let x = 3.0;", "let x = 0.75;"]),
        ("constant", "let x = 0xffu;", ["let x = 0xfeu;"]),
        ("constant", "let x = vec4u_1 + a.x2;", []),
        ("boolean", "let x = true;", ["let x = false;"]),
        ("negate", "if a == b {", ["if !(a == b) {"]),
        ("select", "let x = select(a, b, c);", ["let x = select(b, a, c);"]),
        ("arguments", "f(a, b, c);", ["f(b, a, c);"]),
        ("arguments", "f(a, a, c);", []),
        ("arguments", "unknown(a, b);", []),
        ("arguments", "min(a, b);", []),
        ("arguments", "let x = Pair(a, b);", ["let x = Pair(b, a);"]),
        ("arguments", "let x = vec2f(a, b);", ["let x = vec2f(b, a);"]),
        ("index", "let x = a[i];", ["let x = a[i + 1u];"]),
        ("index", "let x = a[0u];", []),
        ("swizzle", "let x = a.x;", ["let x = a.y;"]),
        ("swizzle", "let x = a.xyz;", ["let x = a.zyx;"]),
        ("sign", "let x = f(-a, !b);", ["let x = f(a, !b);", "let x = f(-a, b);"]),
        ("sign", "let x = a - b;", []),
        ("drop-statement", "    a = b;", ["    "]),
        ("drop-statement", "    atomicAdd(&a, 1u);", ["    "]),
        ("drop-statement", "    let a = b;", []),
        ("drop-statement", "    return a;", []),
        ("drop-guard", "    if a { return; }", ["    "]),
        ("drop-guard", "    if a { b = 1u; }", []),
        ("drop-barrier", "    workgroupBarrier();", ["    "]),
    ]  # fmt: skip

    def test_each_operator_changes_what_it_says(self):
        for operator, code, expected in self.CASES:
            self.assertEqual(after(code, operator), expected, f"{operator}: {code}")

    def test_every_operator_is_tried_here(self):
        self.assertEqual({operator for operator, _, _ in self.CASES}, set(operators.OPERATORS))


class Choice(unittest.TestCase):
    TEXTS = {"a/long": FILE * 4, "a/short": FILE, "baselines/x": FILE}

    def test_the_same_seed_chooses_the_same_mutants_and_another_seed_others(self):
        def ids(seed):
            return [mutant["id"] for mutant in choose.mutants(self.TEXTS, 20, seed)]

        self.assertEqual(ids(1), ids(1))
        self.assertNotEqual(ids(1), ids(2))

    def test_sections_are_parts_of_their_own_and_lines_keep_their_numbers(self):
        text = f"// Which.\n//@ declare fn g(a: vec2i, b: vec2i)\n\n//@ variant one\n{FILE}\n//@ step two\n{FILE}"
        parts = choose.parts({"lib/a": FILE, "variants/b": text})
        self.assertEqual(list(parts), ["lib/a", "variants/b", "variants/b/one", "variants/b/two"])
        self.assertEqual({file for part, (file, _) in parts.items() if part != "lib/a"}, {"variants/b"})
        for line, *of_parts in zip(text.split("\n"), *(one.split("\n") for file, one in parts.values() if file == "variants/b")):
            self.assertEqual(sorted(filter(None, of_parts)), [line] if line else [])
        found = choose.every({"variants/b": text})
        self.assertEqual(found["variants/b"], [])
        self.assertEqual(len(found["variants/b/one"]), len(found["variants/b/two"]))
        second = text.split("\n").index("//@ step two") + 1
        self.assertLess(max(mutant["line"] for mutant in found["variants/b/one"]), second)
        self.assertGreater(min(mutant["line"] for mutant in found["variants/b/two"]), second)

    def test_files_get_mutants_in_proportion_to_their_lines_and_excluded_ones_none(self):
        files = [mutant["file"] for mutant in choose.mutants(self.TEXTS, 20, 1)]
        self.assertEqual((files.count("a/long"), files.count("a/short"), files.count("baselines/x")), (16, 4, 0))
        self.assertEqual(choose.shares({"a": 1, "b": 1, "c": 98}, 10), {"a": 1, "b": 1, "c": 8})

    def test_ids_are_unique_and_outlive_lines_that_are_added_elsewhere(self):
        mutants = choose.mutants(self.TEXTS, 10**9, 1)
        self.assertEqual(len({mutant["id"] for mutant in mutants}), len(mutants))
        moved = choose.every({"a/short": "// One line more.\n" + FILE})["a/short"]
        self.assertEqual([mutant["id"] for mutant in moved], [mutant["id"] for mutant in choose.every(self.TEXTS)["a/short"]])

    def test_a_mutant_changes_one_line(self):
        for mutant in choose.mutants(self.TEXTS, 30, 1):
            text = self.TEXTS[mutant["file"]]
            pairs = [(a, b) for a, b in zip(text.split("\n"), choose.changed(text, mutant).split("\n")) if a != b]
            self.assertEqual(pairs, [(mutant["before"], mutant["after"])])


class Planted(unittest.TestCase):
    def test_a_text_that_stands_once_is_replaced_in_whichever_file_it_is(self):
        texts = {"lib/a": "let x = 1u;\nlet y = 2u;\nlet z = 3u;\n", "lib/b": "let x = 4u;\n"}
        mutant, = planted.mutants(texts, [{"from": "2u;\nlet z", "to": "5u;\nlet z", "case": "sizes"}])
        self.assertEqual((mutant["file"], mutant["line"], mutant["case"]), ("lib/a", 2, "sizes"))
        self.assertEqual(choose.changed(texts["lib/a"], mutant), "let x = 1u;\nlet y = 5u;\nlet z = 3u;\n")
        for entry in ({"from": "let x", "to": "var x"}, {"from": "7u", "to": "8u"}, {"from": "4u", "to": "4u"}):
            self.assertRaises(planted.BadEntry, planted.mutants, texts, [entry])


class Equivalents(unittest.TestCase):
    MUTANT = {"id": "1", "part": "lib/a", "file": "lib/a", "line": 3, "before": "    let x = a | b; // c", "after": "    let x = a & b; // c"}

    def test_an_entry_is_found_by_its_texts(self):
        entries = equivalent.parse("# A comment.\n\n" + equivalent.line(self.MUTANT, "a has no bits of b") + "\n")
        self.assertEqual(equivalent.reason(entries, {**self.MUTANT, "line": 99}), "a has no bits of b")
        self.assertIsNone(equivalent.reason(entries, {**self.MUTANT, "part": "lib/b"}))
        self.assertIsNone(equivalent.reason(entries, {**self.MUTANT, "after": "    let x = a ^ b; // c"}))
        every = equivalent.parse(equivalent.line({**self.MUTANT, "after": "*"}, "idle"))
        self.assertEqual(equivalent.reason(every, self.MUTANT), "idle")

    def test_a_dropped_line_has_an_empty_text(self):
        dropped = {**self.MUTANT, "after": ""}
        self.assertEqual(equivalent.reason(equivalent.parse(equivalent.line(dropped, "twice")), dropped), "twice")

    def test_an_entry_without_a_reason_and_one_that_stands_twice_are_refused(self):
        entry = equivalent.line(self.MUTANT, "why")
        for text in ("lib/a: x => y", "x => y ## why", f"{entry}\n{entry}"):
            self.assertRaises(equivalent.BadEntry, equivalent.parse, text)

    def test_an_entry_of_a_part_says_why_no_command_links_it(self):
        entries = equivalent.parse("variants/a/b: => ## only a => on another driver")
        self.assertEqual(equivalent.elsewhere(entries, "variants/a/b"), "only a => on another driver")
        self.assertIsNone(equivalent.elsewhere(entries, "variants/a"))
        self.assertEqual(equivalent.stale(entries, {"variants/a/b": ("variants/a", "x\n")}), [])
        self.assertEqual(len(equivalent.stale(entries, {"variants/a": ("variants/a", "x\n")})), 1)

    def test_an_entry_whose_line_is_gone_is_named(self):
        entries = equivalent.parse(equivalent.line(self.MUTANT, "why"))
        self.assertEqual(equivalent.stale(entries, {"lib/a": ("lib/a", self.MUTANT["before"])}), [])
        self.assertEqual(len(equivalent.stale(entries, {"lib/a": ("lib/a", "let y = 1u;")})), 1)


class Results(unittest.TestCase):
    KINDS = ["failed", "hang", "lost", "crash", "refused", "passed", "unreached", "listed", "invalid"]
    MUTANTS = [{"id": kind, "kind": kind, "step": "verify", "part": "lib/a", "operator": "compare"} for kind in KINDS]

    def test_the_score_leaves_out_invalid_and_equivalent_mutants(self):
        total = results.counts(self.MUTANTS, {"listed", "failed"})
        self.assertEqual(total, {"caught": 5, "survived": 1, "unreached": 1, "invalid": 1, "equivalent": 1})
        self.assertEqual(results.score(total), 5 / 7)
        self.assertIsNone(results.score(results.counts([], set())))
        self.assertTrue(results.tables(self.MUTANTS, set()))

    def test_results_of_other_shaders_are_not_continued(self):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "results.json")
            results.write(path, {"schema": results.SCHEMA, "shaders": "a", "mutants": []})
            self.assertEqual(results.read(path, {"shaders": "a"})["mutants"], [])
            self.assertRaises(results.BadResults, results.read, path, {"shaders": "b"})
            self.assertEqual(os.listdir(folder), ["results.json"])
            self.assertRaises(results.BadResults, results.read, os.path.join(folder, "none"), {})


class Running(unittest.TestCase):
    """With shell scripts in place of the program."""

    def outcome(self, script, step="verify", limit=20.0):
        with tempfile.TemporaryDirectory() as folder:
            path = os.path.join(folder, "program")
            script_path = os.path.join(folder, suite.DEVELOPERS) if step in suite.DEVELOPERS_STEPS else path
            with open(script_path, "w", encoding="utf-8") as file:
                file.write("#!/bin/sh\n" + script)
            os.chmod(script_path, 0o755)
            return run.run(suite.Probe(step, [step], []), path, folder, folder, limit, dict(os.environ))

    def test_exit_codes_and_notes_tell_what_happened(self):
        cases = [
            ("exit 0", "passed"), ("echo 'teapot with split32: 3 holes' >&2; exit 1", "failed"), ("exit 2", "refused"), ("exit 4", "lost"),
            ("exit 101", "crash"), ("kill -SEGV $$", "crash"), ("echo '  ┌─ wgsl:12:3' >&2; exit 2", "invalid"),
            ("echo 'because shaders/lib/fixed.wgsl:12: error: types differ' >&2; exit 2", "invalid"),
            ("echo 'error: the queues still overflow' >&2; exit 2", "refused"),
        ]  # fmt: skip
        for script, kind in cases:
            self.assertEqual(self.outcome(script).kind, kind, script)
        self.assertEqual(self.outcome(cases[1][0]).why, "teapot with split32: 3 holes")

    def test_a_program_that_does_not_end_is_ended(self):
        self.assertEqual(self.outcome("sleep 60", limit=0.3).kind, "hang")

    def test_the_first_note_of_a_failure_suffices(self):
        result = self.outcome("echo 'seed 3 failed: 2 holes' >&2; sleep 60", step="fuzz")
        self.assertEqual((result.kind, result.why), ("failed", "seed 3 failed: 2 holes"))
        self.assertLess(result.seconds, 30.0)


class WholeCampaign(unittest.TestCase):
    """With a program that links one of two sections, and notices one line of it."""

    PROGRAM = """#!/bin/sh
[ -z "$RASTERLAB_PARTS" ] || echo variants/both/seen >> "$RASTERLAB_PARTS"
[ "$(grep -c 'const MOST = 7u;' "$2/variants/both.wgsl")" = 2 ] || { echo 'teapot with split32: 3 holes' >&2; exit 1; }
"""

    def run_in(self, folder, *words):
        script = os.path.join(Repository.root, "scripts", "mutants.py")
        output = os.path.join(folder, "results.json")
        fixed = ["--program", os.path.join(folder, "program"), "--root", folder, "--equivalent", os.path.join(folder, "equivalent.txt")]
        run_it = subprocess.run([sys.executable, script, *fixed, *words], capture_output=True, text=True, check=False, timeout=120)
        with open(output, encoding="utf-8") as file:
            return run_it, json.load(file)["mutants"]

    def test_mutants_are_caught_survive_and_are_continued(self):
        with tempfile.TemporaryDirectory() as folder:
            output, program = os.path.join(folder, "results.json"), os.path.join(folder, "program")
            for name in ("shaders/variants", "presets"):
                os.makedirs(os.path.join(folder, name))
            both = f"//@ declare const MOST\n//@ variant seen\n{FILE}//@ variant unseen\n{FILE}"
            texts = {"shaders/variants/both.wgsl": both, "presets/teapot.toml": "", "program": self.PROGRAM, "equivalent.txt": ""}
            for name, text in texts.items():
                with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                    file.write(text)
            os.chmod(program, 0o755)
            words = ["--mutants", "16", "--jobs", "2", "--fuzz", "10"]
            first, mutants = self.run_in(folder, "--output", output, "--count", "12", *words)
            self.assertEqual((first.returncode, len(mutants)), (1, 12), first.stdout + first.stderr)
            second, mutants = self.run_in(folder, "--resume", output, *words)
            self.assertEqual((second.returncode, len(mutants)), (1, 16), second.stdout + second.stderr)
            self.assertNotIn("baseline:", second.stdout)
            for mutant in mutants:
                is_noticed = mutant["part"] == "variants/both/seen" and "const MOST" in mutant["before"]
                unseen = "unreached" if mutant["part"] == "variants/both/unseen" else "passed"
                self.assertEqual(mutant["kind"], "failed" if is_noticed else unseen, mutant)
            self.assertIn("failed", {mutant["kind"] for mutant in mutants})
            self.assertIn("no command of the suite links variants/both/unseen\n", second.stdout)
            self.assertNotIn("links variants/both/seen", second.stdout)
            with open(os.path.join(folder, "shaders/variants/both.wgsl"), encoding="utf-8") as file:
                self.assertEqual(file.read(), both)
            # A list of equivalent mutants that names all survivors, and a bound that the score keeps.
            with open(os.path.join(folder, "equivalent.txt"), "w", encoding="utf-8") as file:
                file.write("\n".join(sorted({equivalent.line(mutant, "why") for mutant in mutants if mutant["kind"] != "failed"})))
            third, mutants = self.run_in(folder, "--resume", output, *words)
            self.assertIn("score 100.0 %", third.stdout)
            self.assertEqual(third.returncode, 0, third.stdout + third.stderr)

    def test_a_baseline_that_fails_stops_the_campaign_with_a_sentence(self):
        with tempfile.TemporaryDirectory() as folder:
            for name in ("shaders", "presets/extremes"):
                os.makedirs(os.path.join(folder, name))
            for name, text in {"presets/extremes/a.toml": "", "shaders/a.wgsl": FILE, "program": "#!/bin/sh\nexit 1\n"}.items():
                with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
                    file.write(text)
            os.chmod(os.path.join(folder, "program"), 0o755)
            failed, mutants = self.run_in(folder, "--output", os.path.join(folder, "results.json"), "--leave-out", "verify", "--leave-out", "options")
            self.assertEqual((failed.returncode, mutants), (2, []))
            self.assertIn("the unchanged shaders do not pass `stress --filter", failed.stderr)


class Repository(unittest.TestCase):
    root = ""

    def test_the_shaders_have_enough_mutants_and_the_list_of_equivalents_is_up_to_date(self):
        texts = choose.files(os.path.join(self.root, "shaders"))
        self.assertGreaterEqual(len(choose.mutants(texts, 480, 1)), 400)
        for prefix in choose.EXCLUDED:
            self.assertTrue(any(name.startswith(prefix) for name in choose.parts(texts)), prefix)
        with open(os.path.join(self.root, "scripts", "mutants-equivalent.txt"), encoding="utf-8") as file:
            entries = equivalent.parse(file.read())
        self.assertEqual(equivalent.stale(entries, choose.parts(texts)), [])
        every = [key(mutant) for found in choose.every(texts).values() for mutant in found]
        possible = {*every, *((part, before, "*") for part, before, _ in every)}
        self.assertEqual([entry for entry in entries if entry[1] and entry not in possible], [])

    def test_every_planted_mistake_replaces_text_that_the_shaders_have_once(self):
        listed = planted.entries()
        found = planted.mutants(choose.files(os.path.join(self.root, "shaders")), listed)
        self.assertEqual(len({mutant["id"] for mutant in found}), len(listed))
        named = [probe.words[-1] for probe in suite.probes(self.root, 0, 0, cases=planted.cases(listed)) if probe.step in ("stress", "cases")]
        self.assertLessEqual(set(planted.cases(listed)), set(named))

    def test_the_suite_has_commands_of_every_step_and_groups_run_each_of_them_once(self):
        probes = suite.probes(self.root, 60, 1)
        self.assertEqual(len({probe.name for probe in probes}), len(probes))
        self.assertEqual([step for step in suite.STEPS if any(probe.step == step for probe in probes)], suite.STEPS)
        groups = suite.commands(probes, "fog", {probe.name: 1.0 for probe in probes})
        self.assertEqual(sorted(probe.name for group in groups for probe in group), sorted(probe.name for probe in probes))
        self.assertLessEqual(max(map(len, groups)), suite.REST)
        self.assertLess(len(groups), len(probes) / 4)
        self.assertIn("fog", suite.merged(groups[0]).name)
        stress = [suite.merged(group).words for group in groups if group[0].step == "stress"]
        self.assertTrue(all(len(words) == 3 for words in stress), stress)


def key(mutant):
    return mutant["part"], mutant["before"].strip(), mutant["after"].strip()


def main(root):
    Repository.root = root
    suite_of_tests = unittest.defaultTestLoader.loadTestsFromModule(__import__(__name__, fromlist=["*"]))
    return 0 if unittest.TextTestRunner(verbosity=1).run(suite_of_tests).wasSuccessful() else 1
