#!/usr/bin/env python3
"""Changes the shaders one line at a time and counts how many of the changes the judge notices.

    python3 scripts/mutants.py --program target/release/rasterlab              a whole campaign
    python3 scripts/mutants.py --program ... --resume RESULTS.json             go on after an interruption
    python3 scripts/mutants.py --list [--resume RESULTS.json]                  show the mutants, and parts that no command links; run none
    python3 scripts/mutants.py --program ... --only 0f3a91c2d4                 one mutant, by its id
    python3 scripts/mutants.py --self-test                                     check this script's own parts

Every mutant is one changed line of one shader file, in a private copy of the folder that the program reads through --shaders. The
suite (scripts/mutation/suite.py) first runs with unchanged shaders; every command must succeed, and the program records which heads and
sections of files each links, so that a mutant meets only commands that link its own. The first command that does not succeed catches the mutant:
a failed comparison, a lost device, a crash, or no end within the limit. A mutant that is no valid program counts apart, as does one that
scripts/mutants-equivalent.txt lists with the reason why it changes nothing, or why no command links its part. The score is caught / (valid - equivalent).

Exit codes: 0 every mutant was run and the score reaches --at-least; 1 it does not, or time ran out before the last mutant; 2 wrong
usage, or the unchanged shaders fail.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.dont_write_bytecode = True

from mutation import choose, equivalent, planted, results, run, suite  # noqa: E402

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
EQUIVALENTS = os.path.join(ROOT, "scripts", "mutants-equivalent.txt")


class Fault(Exception):
    """Ends the script with a sentence and exit code 2."""


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", help="the program rasterlab")
    parser.add_argument("--root", default=ROOT, help="folder with shaders, presets and examples [default: the repository]")
    parser.add_argument("--output", default="mutants.json", help="file of the results, written after every mutant [default: %(default)s]")
    parser.add_argument("--resume", metavar="RESULTS", help="go on with the mutants that this file of results lacks, and write to it")
    parser.add_argument("--seed", type=int, default=1, help="chooses other mutants [default: %(default)s]")
    parser.add_argument("--mutants", type=int, default=480, metavar="N", help="number of mutants, invalid ones included [default: %(default)s]")
    parser.add_argument("--from", dest="first", type=int, default=0, metavar="I", help="begin with this one, from 0")
    parser.add_argument("--count", type=int, metavar="N", help="run only this many")
    parser.add_argument("--only", action="append", default=[], metavar="ID", help="run only this mutant, listed or not; may be repeated")
    parser.add_argument("--planted", action="store_true", help="try the mistakes of scripts/mutation/planted.toml, and no others")
    parser.add_argument("--file", action="append", default=[], metavar="FILE",
                        help="only mutants of this file (lib/fixed), section (variants/coverage/boxes) or folder (lib/)")  # fmt: skip
    parser.add_argument("--survivors", action="store_true", help="with --resume: run those again that survived")
    parser.add_argument("--jobs", type=int, default=1, help="mutants at the same time [default: %(default)s]")
    parser.add_argument("--seconds", type=float, metavar="S", help="stop after this time; --resume goes on")
    parser.add_argument("--fuzz", type=int, default=60, metavar="N", help="random presets of the suite; 0: none [default: %(default)s]")
    parser.add_argument("--fuzz-seed", type=int, default=1, metavar="N", help="seed of the first random preset [default: %(default)s]")
    parser.add_argument("--leave-out", action="append", default=[], choices=suite.STEPS, help="leave out a step of the suite")
    parser.add_argument("--leave-out-failing", action="store_true", help="leave out commands that the unchanged shaders do not pass, and say so")
    parser.add_argument("--limit-factor", type=float, default=10.0, metavar="X",
                        help="a command may take X times its first time, and 20 s [default: %(default)s]")  # fmt: skip
    parser.add_argument("--at-least", type=float, default=97.0, metavar="PERCENT", help="score for exit code 0 [default: %(default)s]")
    parser.add_argument("--equivalent", default=EQUIVALENTS, metavar="FILE", help="list of equivalent mutants")
    parser.add_argument("--run-equivalent", action="store_true", help="run those too, and say which are caught nevertheless")
    parser.add_argument("--list", action="store_true", help="show the mutants and run none")
    parser.add_argument("--self-test", action="store_true", help="check the parts of this script")
    return parser.parse_args()


def digest(*texts):
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:16]


def file_digest(path):
    value = hashlib.sha256()
    with open(path, "rb") as file:
        for block in iter(lambda: file.read(1 << 20), b""):
            value.update(block)
    return value.hexdigest()[:16]


def say(text):
    print(text, flush=True)


def equivalents_of(path):
    try:
        with open(path, encoding="utf-8") as file:
            return equivalent.parse(file.read())
    except FileNotFoundError:
        return {}
    except equivalent.BadEntry as error:
        raise Fault(f"{path}: {error}") from error


class Campaign:
    def __init__(self, args):
        self.args = args
        self.shaders = os.path.join(args.root, "shaders")
        self.texts = choose.files(self.shaders)
        if not self.texts:
            raise Fault(f"{self.shaders} has no shaders; give the repository's folder with --root")
        self.entries = equivalents_of(args.equivalent)
        for entry in equivalent.stale(self.entries, choose.parts(self.texts)):
            say(f"note: the list of equivalent mutants names a line that is gone: {entry}")
        self.mutants = self.chosen()
        self.deadline = None if args.seconds is None else time.monotonic() + args.seconds
        self.environment = {name: value for name, value in os.environ.items() if name not in ("RASTERLAB_SHADERS", "RASTERLAB_PRESETS")}
        threads = max(1, (os.cpu_count() or 1) // max(args.jobs, 1))
        self.environment.setdefault("RAYON_NUM_THREADS", str(threads))
        self.output = args.resume or args.output
        self.done, self.baseline = {}, {}
        self.stopping = threading.Event()
        self.local = threading.local()
        self.scratch = None

    def chosen(self):
        args = self.args
        try:
            every = planted.mutants(self.texts, planted.entries()) if args.planted else choose.mutants(self.texts, args.mutants, args.seed)
        except planted.BadEntry as error:
            raise Fault(str(error)) from error
        if args.only:
            found = [every] if args.planted else choose.every(self.texts).values()
            possible = {mutant["id"]: mutant for of_file in found for mutant in of_file}
            missing = [one for one in args.only if one not in possible]
            if missing:
                raise Fault(f"there is no mutant {missing[0]}; --list shows all, and an id changes with the text of its line")
            return [possible[one] for one in args.only]
        if args.file:
            every = [mutant for mutant in every if any((mutant["part"] + "/").startswith(one.rstrip("/") + "/") for one in args.file)]
        end = None if args.count is None else args.first + args.count
        return every[args.first : end]

    def equivalents(self):
        """Ids of the mutants that the list names, and of those in parts that no command links, for a reason that the list gives."""
        named = {mutant["id"] for mutant in self.mutants if equivalent.reason(self.entries, mutant) is not None}
        unreached = [mutant for mutant in self.done.values() if mutant["kind"] == "unreached"]
        return named | {mutant["id"] for mutant in unreached if equivalent.elsewhere(self.entries, mutant["part"])}

    def unlinked(self):
        """Parts that have mutants, that no command of the baseline links, and of which the list gives no reason."""
        linked = [one["parts"] for one in self.baseline.values()]
        if None in linked:
            return []
        parts = {part for part, mutants in choose.every(self.texts).items() if mutants and choose.excluded(part) is None}
        return sorted(part for part in parts.difference(*linked) if not equivalent.elsewhere(self.entries, part))

    def prepare(self):
        """Finds the program and the suite, and reads the results to continue."""
        args = self.args
        if not args.program:
            raise Fault("--program PATH is missing; cargo build --release makes target/release/rasterlab")
        self.program = os.path.abspath(args.program)
        if not os.access(self.program, os.X_OK):
            raise Fault(f"{args.program} is no program that can be run")
        leave_out = set(args.leave_out)
        if not os.access(os.path.join(os.path.dirname(self.program), suite.DEVELOPERS), os.X_OK):
            say(f"note: {suite.DEVELOPERS} does not lie beside the program; its steps are left out: {', '.join(suite.DEVELOPERS_STEPS)}")
            leave_out.update(suite.DEVELOPERS_STEPS)
        cases = planted.cases(planted.entries()) if args.planted else []
        self.probes = suite.probes(args.root, args.fuzz, args.fuzz_seed, leave_out, cases)
        self.same = {
            "program": file_digest(self.program),
            "shaders": digest(*(part for item in self.texts.items() for part in item)),
            "suite": digest(*(probe.name for probe in self.probes)),
        }
        if args.resume:
            try:
                earlier = results.read(args.resume, self.same)
            except results.BadResults as error:
                raise Fault(str(error)) from error
            self.baseline = earlier["baseline"]
            # The list of equivalent mutants may have changed since.
            self.done = {mutant["id"]: mutant for mutant in earlier["mutants"] if mutant["kind"] != "listed"}
            if args.survivors:
                self.done = {one: mutant for one, mutant in self.done.items() if mutant["kind"] not in ("passed", "unreached")}

    def folder(self):
        """This thread's private copy of the shaders."""
        if not hasattr(self.local, "shaders"):
            self.local.shaders = run.copy_of(self.shaders, tempfile.mkdtemp(dir=self.scratch))
        return self.local.shaders

    def run_baseline(self, pool):
        """Runs every command on unchanged shaders, and records its time and the parts of shaders that it links."""
        missing = [probe for probe in self.probes if probe.name not in self.baseline]
        if not missing:
            return
        say(f"baseline: {len(missing)} commands with unchanged shaders")
        begin, faults = time.monotonic(), []

        def unchanged(probe):
            linked = os.path.join(tempfile.mkdtemp(dir=self.scratch), "parts")
            result = self.run_probe(probe, self.folder(), 900.0, RASTERLAB_PARTS=linked)
            try:
                with open(linked, encoding="utf-8") as file:
                    return probe, result, sorted(set(file.read().split()))
            except FileNotFoundError:
                return probe, result, None

        for future in concurrent.futures.as_completed([pool.submit(unchanged, probe) for probe in missing]):
            probe, result, parts = future.result()
            one = {"seconds": round(result.seconds, 3), "parts": parts}
            if result.kind != "passed":
                one["fails"] = f"{result.kind}: {result.why}"
            if result.kind == "passed" or self.args.leave_out_failing:
                self.baseline[probe.name] = one
            else:
                faults.append(f"`{probe.name}`: {one['fails']}")
            self.write()
        if faults:
            raise Fault("the unchanged shaders do not pass " + "; nor ".join(faults))
        total = sum(one["seconds"] for one in self.baseline.values())
        slowest = max(self.baseline, key=lambda name: self.baseline[name]["seconds"])
        longest = f"the longest: {slowest}, {self.baseline[slowest]['seconds']:.1f} s"
        say(f"baseline: done in {time.monotonic() - begin:.0f} s ({total:.0f} s of commands; {longest})")

    def run_probe(self, probe, shaders, limit, **variables):
        return run.run(probe, self.program, shaders, self.args.root, limit, {**self.environment, **variables}, self.deadline)

    def try_mutant(self, mutant):
        """The mutant with what came of it."""
        if self.stopping.is_set():
            raise run.Stopped
        linked_by = [probe for probe in self.probes if self.links(probe, mutant["part"])]
        begin = time.monotonic()
        if not linked_by:
            return {**mutant, "kind": "unreached", "step": "", "command": "", "why": "no command of the suite links this part", "seconds": 0.0}
        shaders = self.folder()
        path = os.path.join(shaders, mutant["file"] + ".wgsl")
        self.store(path, choose.changed(self.texts[mutant["file"]], mutant))
        try:
            times = {name: one["seconds"] for name, one in self.baseline.items()}
            stem = mutant["part"].split("/")[-1]
            named = [probe for probe in linked_by if mutant.get("case") and mutant["case"] in probe.words]
            for group in [[probe] for probe in named] + suite.commands(linked_by, stem, times):
                probe = suite.merged(group)
                usual = sum(times[one.name] for one in group)
                limit = 20.0 + self.args.limit_factor * usual
                result = self.run_probe(probe, shaders, limit)
                if result.kind in run.PERHAPS_OTHERS:
                    result = self.run_probe(probe, shaders, limit)
                if result.kind != "passed":
                    break
            step, command = ("", "") if result.kind == "passed" else (probe.step, probe.name)
            seconds = round(time.monotonic() - begin, 2)
            return {**mutant, "kind": result.kind, "step": step, "command": command, "why": result.why, "seconds": seconds}
        finally:
            self.store(path, self.texts[mutant["file"]])

    def links(self, probe, part):
        """Does a command link this part, or is that not known?"""
        parts = self.baseline[probe.name]["parts"]
        return parts is None or part in parts

    @staticmethod
    def store(path, text):
        # A new file, in case the old one is still being read.
        with open(path + ".new", "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(path + ".new", path)

    def write(self):
        mutants = list(self.done.values())
        total = results.counts(mutants, self.equivalents())
        results.write(self.output, {
            "schema": results.SCHEMA, **self.same, "seed": self.args.seed, "of": self.args.mutants, "counts": total,
            "score": results.score(total), "baseline": self.baseline, "mutants": mutants,
        })  # fmt: skip

    def run(self):
        equivalents = self.equivalents()
        skipped = set() if self.args.run_equivalent else equivalents
        left = [mutant for mutant in self.mutants if mutant["id"] not in self.done and mutant["id"] not in skipped]
        for mutant in self.mutants:
            if mutant["id"] in skipped and mutant["id"] not in self.done:
                why = "listed as equivalent: " + equivalent.reason(self.entries, mutant)
                self.done[mutant["id"]] = {**mutant, "kind": "listed", "step": "", "command": "", "why": why, "seconds": 0.0}
        self.scratch = tempfile.mkdtemp(prefix="mutants-")
        is_whole = True
        try:
            with concurrent.futures.ThreadPoolExecutor(self.args.jobs) as pool:
                try:
                    self.run_baseline(pool)
                    for name, one in self.baseline.items():
                        if "fails" in one:
                            say(f"note: left out, since the unchanged shaders do not pass it: {name}: {one['fails']}")
                    self.probes = [probe for probe in self.probes if "fails" not in self.baseline[probe.name]]
                    futures = [pool.submit(self.try_mutant, mutant) for mutant in left]
                    for number, future in enumerate(concurrent.futures.as_completed(futures), 1):
                        try:
                            tried = future.result()
                        except run.Stopped:
                            is_whole = False
                            self.stopping.set()
                            continue
                        self.done[tried["id"]] = tried
                        self.write()
                        say(self.progress(number, len(left), tried, equivalents))
                except BaseException:
                    self.stopping.set()
                    pool.shutdown(wait=False, cancel_futures=True)
                    run.kill_all()
                    raise
        except run.Stopped:
            is_whole = False
        finally:
            shutil.rmtree(self.scratch, ignore_errors=True)
        return is_whole

    def say_unlinked(self):
        for part in self.unlinked():
            say(f"no command of the suite links {part}")

    @staticmethod
    def progress(number, of, tried, equivalents):
        outcome = results.outcome(tried, equivalents)
        by = f"{tried['step']}: {tried['kind']}" if tried["step"] else ""
        return f"[{number:3}/{of}] {outcome:10} {tried['seconds']:6.1f} s  {tried['id']} {tried['file']}:{tried['line']} {tried['operator']}  {by}"

    def report(self, is_whole):
        """Tables and survivors; the exit code."""
        of_run = [self.done[mutant["id"]] for mutant in self.mutants if mutant["id"] in self.done]
        equivalents = self.equivalents()
        total = results.counts(of_run, equivalents)
        score = results.score(total)
        say("")
        for line in results.tables(of_run, equivalents):
            say(line)
        survivors = [mutant for mutant in of_run if results.outcome(mutant, equivalents) in ("survived", "unreached")]
        if survivors:
            say("\nSURVIVORS")
        for mutant in survivors:
            for line in results.diff(mutant):
                say(line)
            if mutant["kind"] == "unreached":
                say("  (no command of the suite reads this file)")
        self.say_unlinked()
        for mutant in of_run:
            if mutant["id"] in equivalents and results.CAUGHT.get(mutant["kind"]):
                say(f"note: listed as equivalent, and caught: {equivalent.line(mutant, mutant['why'])}")
        valid = sum(total.values()) - total["invalid"]
        text = "none" if score is None else f"{100 * score:.1f} %"
        say(f"\n{len(of_run)} of {len(self.mutants)} mutants: {total['invalid']} invalid, {valid} valid, {total['equivalent']} equivalent, "
            f"{total['caught']} caught, {total['survived']} survived, {total['unreached']} unreached; score {text}")
        if not is_whole:
            say(f"time ran out; go on with --resume {self.output}")
        return 0 if is_whole and (score is None or 100 * score >= self.args.at_least) else 1


def listed(campaign):
    for mutant in campaign.mutants:
        reason = equivalent.reason(campaign.entries, mutant)
        for line in results.diff(mutant):
            say(line)
        if reason:
            say(f"  (equivalent: {reason})")
    if campaign.args.resume:
        with open(campaign.args.resume, encoding="utf-8") as file:
            campaign.baseline = json.load(file)["baseline"]
        campaign.say_unlinked()
    say(f"{len(campaign.mutants)} mutants")


def main():
    args = arguments()
    if args.self_test:
        from mutation import selftest

        return selftest.main(ROOT)

    def interrupted(*_):
        raise KeyboardInterrupt

    signal.signal(signal.SIGTERM, interrupted)
    campaign = Campaign(args)
    if args.list:
        listed(campaign)
        return 0
    campaign.prepare()
    return campaign.report(campaign.run())


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Fault as fault:
        print(f"mutants: {fault}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        run.kill_all()
        print("mutants: interrupted; the results so far are kept", file=sys.stderr)
        sys.exit(2)
