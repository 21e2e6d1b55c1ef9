#!/usr/bin/python3
"""Mutation test of the edge: a scenario or a unit test must find each of hundreds of small defects.

  mutate.py make         builds the mutated copy of the tree
  mutate.py run [--sample N --seed S] [--only TEXT]   runs scenarios and unit tests on each
  mutate.py run --each N --rooms core/control         N of each of these rooms
  mutate.py report       the score by folder, and the survivors
  mutate.py draw         the keys that run would try, one per line, for run --keys FILE
  mutate.py compare --than FOLDER   mutants that the tests of only one tree find

survivors.txt gives the reason of each known survivor. Exit codes: 0 done; 1 fewer than
--at-least of the non-equivalent mutants are found, or a build fails; 2 the
command line.
"""
import argparse
import collections
import json
import os
import random
import re
import subprocess
import sys
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(os.path.dirname(HERE)))
ROOMS = ["core/control", "device/registers", "device/battery", "prices/record", "core/site",
         "core/supervision", "core/loop"]
# Cheapest tests first: expensive tests only run on mutants that no other test has found.
UNIT_TESTS = ["edge_test", "edge_commands_unit_test", "hil_test", "fetch_test", "tools_test",
              "control_loop_test", "site_test", "trial_test"]
TARGETS = ["bess-hil"] + UNIT_TESTS
NUMBERS_PER_FILE = 1000
LIMIT_S = 120  # of one run without a mutant

RUN_TIME = """// The active mutant, and the mutants that were executed (tests/checks/mutation).
#pragma once
#include <cstdio>
#include <cstdlib>
#include <type_traits>
struct BessMutants {{
  int awake = -1;
  unsigned char passed[{count}] = {{}};
  BessMutants() {{
    if (const char* number = std::getenv("BESS_MUTANT")) awake = std::atoi(number);
  }}
  ~BessMutants() {{
    const char* path = std::getenv("BESS_MUTANTS_PASSED");
    std::FILE* file = path != nullptr ? std::fopen(path, "we") : nullptr;
    if (file == nullptr) return;
    for (int i = 0; i < {count}; ++i) {{
      if (passed[i] != 0) std::fprintf(file, "%d\\n", i);
    }}
    std::fclose(file);
  }}
}};
inline BessMutants bess_mutants;
constexpr bool bess_mutant(int number) {{
  if (std::is_constant_evaluated()) return false;
  bess_mutants.passed[number] = 1;
  return bess_mutants.awake == number;
}}
"""


def key_of(mutant):
    nth = f" #{mutant['nth']}" if mutant["nth"] > 1 else ""
    return f"{mutant['file']} | {mutant['function']} | {mutant['was']} -> {mutant['is']}{nth}"


# --- make ---
def tracked():
    out = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, check=True,
                         capture_output=True, text=True).stdout
    return [f for f in out.splitlines() if os.path.isfile(os.path.join(ROOT, f))]


def write_if_new(path, data, mode=None):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    if os.path.islink(path):
        os.unlink(path)
    elif os.path.exists(path):
        with open(path, "rb") as f:
            if f.read() == data:
                return
    with open(path, "wb") as f:
        f.write(data)
    if mode is not None:
        os.chmod(path, mode)


def mutated(path, first, mutants, left_out):
    """The text of one file with all of its mutants, which are added to the list."""
    import schemata
    full = os.path.join(ROOT, path)
    file = schemata.File(full, ["-x", "c++", "-std=c++20", "-DNDEBUG", "-I" + ROOT,
                                "-I" + os.path.join(ROOT, "edge/generated"),
                                    "-I/usr/include/modbus"])
    for error in file.errors:
        print(f"{path}: {error}", file=sys.stderr)
    seen = collections.Counter()
    numbers = [first - 1]

    def number(_, node, alternative):
        mutant = {"file": path, "function": node.function, "was": alternative[0],
                "is": alternative[1],
                  "line": schemata.line_of(file, node.start)}
        name = (node.function, alternative[0], alternative[1])
        seen[name] += 1
        mutant["nth"] = seen[name]
        if key_of(mutant) in left_out:
            return None
        numbers[0] += 1
        mutant["number"] = numbers[0]
        mutants.append(mutant)
        return mutant["number"]

    tree = file.tree()
    text = schemata.render(file, tree, 0, len(file.text), number)
    return '#include "bess_mutant.h"\n#line 1\n' + text


def copy_tree(out):
    source = os.path.join(out, "source")
    mutants, first = [], 0
    left_out = set()  # what does not compile: see not_compiling
    path = os.path.join(HERE, "not_compiling.txt")
    if os.path.exists(path):
        left_out = set(lines_of(path))
    wanted = re.compile("edge/(" + "|".join(ROOMS) + r")/[\w/]+\.(h|cpp)$")
    for path in tracked():
        if path.startswith("tests/checks/mutation/"):
            continue
        with open(os.path.join(ROOT, path), "rb") as f:
            data = f.read()
        if wanted.match(path):
            data = mutated(path, first, mutants, left_out).encode()
            first += NUMBERS_PER_FILE  # independent of changes in other files
        write_if_new(os.path.join(source, path), data, os.stat(os.path.join(ROOT, path)).st_mode)
    write_if_new(os.path.join(source, "bess_mutant.h"), RUN_TIME.format(count=first).encode())
    with open(os.path.join(out, "mutants.json"), "w") as f:
        json.dump(mutants, f, indent=0)
    return source, mutants


def lines_of(path):
    with open(path) as f:
        return [line.rstrip("\n") for line in f if line.strip() and not line.startswith("#")]


def make(options):
    started = time.time()
    source, mutants = copy_tree(options.out)
    count = collections.Counter(m["file"].split("/")[1] for m in mutants)
    print(f"{len(mutants)} mutants:", ", ".join(f"{room} {n}" for room, n in count.items()))
    if options.text_only:
        return 0
    build = os.path.join(options.out, "build")
    if not os.path.exists(os.path.join(build, "build.ninja")):
        launcher = ["-DCMAKE_CXX_COMPILER_LAUNCHER=ccache"] if options.ccache else []
        subprocess.run(["cmake", "-G", "Ninja", "-S", source, "-B", build, "-DBESS_WORKSTATION=OFF",
                        "-DBESS_SIMULATORS=ON", "-DCMAKE_BUILD_TYPE=Release",
                            "-DCMAKE_CXX_FLAGS_RELEASE=-O1 -DNDEBUG",
                        "-DCMAKE_CXX_FLAGS=-w -Wno-narrowing"] + launcher, check=True,
                            stdout=subprocess.DEVNULL)
    code = subprocess.run(["ninja", "-C", build, "-j", str(options.jobs), "-k",
            "0"] + TARGETS).returncode
    print(f"built in {time.time() - started:.0f} s")
    return code


# --- run ---
class Runner:
    def __init__(self, options):
        self.out = options.out
        self.build = os.path.join(options.out, "build")
        self.source = os.path.join(options.out, "source")
        self.mutants = mutants_of(options.out)
        self.passed = os.path.join(options.out, f"passed-{os.getpid()}.txt")
        self.kinds = options.kinds.split(",") if options.kinds else ["scenario"] + UNIT_TESTS
        self.from_s, self.to_s = options.seconds
        self.kills = collections.Counter()
        self.key = {m["number"]: key_of(m) for m in self.mutants}
        self.covered = self.coverage()

    def environment(self, **more):
        return dict(os.environ, **more)

    def ends_well(self, command, limit_s=LIMIT_S, **more):
        try:
            done = subprocess.run(command, env=self.environment(**more), stdout=subprocess.DEVNULL,
                                  stderr=subprocess.DEVNULL, stdin=subprocess.DEVNULL,
                                          timeout=limit_s,
                                  cwd=self.build)
            return done.returncode == 0
        except subprocess.TimeoutExpired:
            return False

    def tests(self, kind):
        """The names of all scenarios, or of the tests of one program."""
        if kind == "scenario":
            folder = os.path.join(self.source, "tests/scenarios")
            return [f[:-5] for f in sorted(os.listdir(folder)) if f.endswith(".toml")]
        listed = subprocess.run([os.path.join(self.build, kind), "--gtest_list_tests"],
                capture_output=True,
                                text=True, cwd=self.build)
        suite, names = "", []
        for line in listed.stdout.splitlines():
            name = line.split("#")[0].rstrip()
            if name.startswith(" "):
                names.append(suite + name.strip())
            else:
                suite = name
        return names

    def command(self, kind, names):
        if kind == "scenario":
            pinned = os.path.join(self.source, "tests/data/golden/scenarios.txt")
            return [os.path.join(self.build, "bess-hil"), "run", "--pinned", pinned] + [
                os.path.join(self.source, "tests/scenarios", n + ".toml") for n in names]
        return [os.path.join(self.build, kind), "--gtest_brief=1", "--gtest_fail_fast",
                "--gtest_filter=" + ":".join(names)]

    def coverage(self):
        """The tests that execute each mutant; determined once per build and cached."""
        covered = collections.defaultdict(list)
        for kind in self.kinds:
            program = os.path.join(self.build, "bess-hil" if kind == "scenario" else kind)
            if not os.path.exists(program):
                print(f"{kind}: not built, left out")
                continue
            path = os.path.join(self.out, f"coverage-{kind}.json")
            kept = {}
            if os.path.exists(path) and os.path.getmtime(path) > os.path.getmtime(program):
                with open(path) as f:
                    kept = json.load(f)
            kept = {name: kept.get(name) or self.passed_by(kind, name) for name in self.tests(kind)}
            with open(path, "w") as f:
                json.dump(kept, f)
            for name, (took_s, numbers) in kept.items():
                if not self.from_s < took_s <= self.to_s:
                    continue
                for number in numbers:
                    covered[number].append([kind, name, took_s])
        return covered

    def passed_by(self, kind, name):
        """Seconds of one test and the mutants it executes; none if it fails without a mutant."""
        if os.path.exists(self.passed):
            os.unlink(self.passed)
        started = time.time()
        well = self.ends_well(self.command(kind, [name]), BESS_MUTANTS_PASSED=self.passed)
        took_s = round(time.time() - started, 2)
        if not os.path.exists(self.passed) or not well:
            why = "tells nothing" if well else "fails"
            print(f"left out: {kind} {name}: {why} without a mutant")
            return [took_s, []]
        with open(self.passed) as f:
            return [took_s, [int(line) for line in f]]

    def finder(self, number):
        """The kind of test that finds this mutant and its name, or None. Scenarios first."""
        by_kind = collections.defaultdict(list)
        for kind, name, took_s in self.covered.get(number, []):
            by_kind[kind].append((name, took_s))
        for kind in self.kinds:
            # Tests with many finds run first and one at a time, so that the finder is known.
            tests = sorted(by_kind[kind], key=lambda t: (-self.kills[kind, t[0]], t[1]))
            at, size = 0, 1
            while at < len(tests):
                some = tests[at:at + size]
                limit_s = 20 + 20 * sum(t[1] for t in some)
                if not self.ends_well(self.command(kind, [t[0] for t in some]), limit_s,
                        BESS_MUTANT=str(number)):
                    for test in some:
                        self.kills[kind, test[0]] += 1 / len(some)
                    return kind, some[0][0] if size == 1 else f"one of {len(some)}"
                at += size
                size *= 4
        return None


def mutants_of(folder):
    with open(os.path.join(folder, "mutants.json")) as f:
        return json.load(f)


def chosen(mutants, options):
    if options.also_in:
        elsewhere = {key_of(m) for m in mutants_of(options.also_in)}
        mutants = [m for m in mutants if key_of(m) in elsewhere]
    if options.keys:
        asked = set(lines_of(options.keys))
        mutants = [m for m in mutants if key_of(m) in asked]
        missing = asked - {key_of(m) for m in mutants}
        if missing:
            sys.exit(f"mutate.py: {options.keys}: this tree has no \"{min(missing)}\": draw with "
                     "--also-in what both have")
    by_room = {room: [] for room in options.rooms}
    for mutant in mutants:
        room = room_of(mutant["file"])
        if room in by_room and options.only in key_of(mutant):
            by_room[room].append(mutant["number"])
    if options.each:
        by_room = {room: drawn(numbers, options.each, f"{options.seed} {room}")
                   for room, numbers in by_room.items()}
    numbers = sorted(sum(by_room.values(), []))
    if options.sample:
        numbers = drawn(numbers, options.sample, options.seed)
    random.Random(options.seed).shuffle(numbers)  # an interrupted run is a sample
    return numbers


def drawn(numbers, count, seed):
    return sorted(random.Random(seed).sample(numbers, min(count, len(numbers))))


def draw(options):
    mutants = mutants_of(options.out)
    key = {m["number"]: key_of(m) for m in mutants}
    print(*(key[number] for number in chosen(mutants, options)), sep="\n")
    return 0


def room_of(path):
    """The folder below edge/ that a file is counted in."""
    return next((room for room in ROOMS if path.startswith(f"edge/{room}/")), "elsewhere")


def rooms_of(text):
    rooms = text.split(",")
    for room in rooms:
        if room not in ROOMS:
            raise argparse.ArgumentTypeError(f'"{room}" is none of ' + ", ".join(ROOMS))
    return rooms


def seconds_of(text):
    """Above the first, up to the second; 0 includes an unknown time."""
    bounds = re.fullmatch(r"(\d+)-(\d*)", text)
    if not bounds:
        raise argparse.ArgumentTypeError(f'"{text}" is not as 0-4 or 4-')
    return float(bounds[1]) or -1.0, float(bounds[2] or 1e9)


def survivors_known():
    path = os.path.join(HERE, "survivors.txt")
    known = {}
    if os.path.exists(path):
        for line in lines_of(path):
            reason, _, key = line.partition(" | ")
            known[key] = reason
    return known


def run(options):
    runner = Runner(options)
    path = os.path.join(options.out, options.results)
    done = {}
    if os.path.exists(path) and options.resume:
        with open(path) as f:
            done = {r["key"]: r for r in map(json.loads, f)}
    with open(path, "a" if options.resume else "w") as out:
        for number in chosen(runner.mutants, options):
            key = runner.key[number]
            if key in done and not (options.again and not done[key]["by"]):
                continue
            found = runner.finder(number)
            result = {"key": key, "by": list(found) if found else None,
                      "passed": len(runner.covered.get(number, []))}
            print(json.dumps(result), file=out, flush=True)
    return report(options)


# --- report ---
def results_of(folder, options):
    """The latest result of each mutant, by its key."""
    with open(os.path.join(folder, options.results)) as f:
        return {r["key"]: r for r in map(json.loads, f)}


def compare(options):
    """Exit code 1 if these tests miss a mutant that the tests of another tree find."""
    old, new = results_of(options.than, options), results_of(options.out, options)
    known = survivors_known()
    rooms = collections.defaultdict(collections.Counter)
    lost = []
    for key in sorted(old.keys() & new.keys()):
        by = old[key]["by"], new[key]["by"]
        found = {(True, True): "both", (True, False): "there", (False, True): "here",
                 (False, False): "neither"}[by[0] is not None, by[1] is not None]
        if found == "neither" and known.get(key, "").startswith("equivalent"):
            found = "equivalent"
        rooms[room_of(key)][found] += 1
        if found == "there":
            lost.append(f"lost: {key}, found there by {' '.join(by[0])}")
    total = sum(rooms.values(), collections.Counter())
    print("| room | mutants | equivalent | found by both | there alone | here alone | by neither "
          "| there | here |\n|---|---|---|---|---|---|---|---|---|")
    for name, c in sorted(rooms.items()) + [("all", total)]:
        percent = [100 * (c["both"] + c[side]) / max(1, c.total() - c["equivalent"])
                   for side in ("there", "here")]
        print(f"| {name} | {c.total()} | {c['equivalent']} | {c['both']} | {c['there']} "
              f"| {c['here']} | {c['neither']} | {percent[0]:.1f} % | {percent[1]:.1f} % |")
    print(*lost, sep="\n", end="\n" if lost else "")
    return 1 if lost else 0


def report(options):
    results = results_of(options.out, options).values()
    known = survivors_known()
    rooms = collections.defaultdict(collections.Counter)
    unknown = []
    for r in results:
        room = rooms[room_of(r["key"])]
        room["all"] += 1
        if r["by"]:
            room["scenario" if r["by"][0] == "scenario" else "unit"] += 1
            continue
        reason = known.get(r["key"])
        room["equivalent" if reason and reason.startswith("equivalent") else "survived"] += 1
        if not reason:
            unknown.append(r)
    total = sum(rooms.values(), collections.Counter())
    print("| room | mutants | by a scenario | by a unit test | equivalent | survived "
          "| caught of the others |\n|---|---|---|---|---|---|---|")
    for name, c in sorted(rooms.items()) + [("all", total)]:
        print(f"| {name} | {c['all']} | {c['scenario']} | {c['unit']} | {c['equivalent']} "
              f"| {c['survived']} | {caught_percent(c):.1f} % |")
    lines = [("not reached: " if r["passed"] == 0 else "survived:    ") + r["key"]
             for r in sorted(unknown, key=lambda r: r["key"])]
    print(*lines, sep="\n", end="\n" if lines else "")
    if options.survivors:
        with open(options.survivors, "w") as out:
            out.writelines(line + "\n" for line in lines)
    if caught_percent(total) < options.at_least:
        caught = caught_percent(total)
        print(f"mutate.py: {caught:.1f} % are caught, {options.at_least} % are asked for: add a "
              "scenario or a test, or the reason to survivors.txt", file=sys.stderr)
        return 1
    return 0


def caught_percent(counts):
    """Share of the non-equivalent mutants that are found."""
    return 100 * (counts["scenario"] + counts["unit"]) / max(1,
            counts["all"] - counts["equivalent"])


def main():
    parser = argparse.ArgumentParser(description=__doc__,
            formatter_class=argparse.RawDescriptionHelpFormatter)
    what = {"make": make, "run": run, "report": report, "draw": draw, "compare": compare}
    parser.add_argument("what", choices=what)
    parser.add_argument("--out", default=os.path.join(ROOT, "build-mutation"),
            help="default: build-mutation")
    parser.add_argument("--jobs", type=int, default=2, help="parallel compilations")
    parser.add_argument("--ccache", action="store_true", help="compile through ccache")
    parser.add_argument("--text-only", action="store_true",
            help="write the mutated tree, do not build it")
    parser.add_argument("--sample", type=int, default=0, help="number of mutants, drawn by --seed")
    parser.add_argument("--each", type=int, default=0, help="number of mutants of each room")
    parser.add_argument("--rooms", type=rooms_of, default=ROOMS,
            help="only these rooms, separated by commas: " + ", ".join(ROOMS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--survivors", default="",
            help="output file for survivors without a reason in survivors.txt")
    parser.add_argument("--only", default="", help="only mutants whose line contains this text")
    parser.add_argument("--keys", default="", help="only mutants whose keys are in this file")
    parser.add_argument("--also-in", default="",
            help="only mutants that the tree in this folder also has")
    parser.add_argument("--than", default="", help="compare: the other tree's folder")
    parser.add_argument("--kinds", default="",
            help="only these kinds of test, in this order: scenario, edge_test, ...")
    parser.add_argument("--seconds", type=seconds_of, default=(-1.0, 1e9),
            help="only tests of this duration in s: 0-4 for a first run, then --resume --again "
                 "--seconds 4- for who is left")
    parser.add_argument("--at-least", type=float, default=0, help="required percentage found")
    parser.add_argument("--results", default="results.jsonl",
            help="file of results in --out")
    parser.add_argument("--resume", action="store_true", help="continue with the previous results")
    parser.add_argument("--again", action="store_true", help="with --resume: run survivors again")
    options = parser.parse_args()
    options.out = os.path.abspath(options.out)
    os.makedirs(options.out, exist_ok=True)
    if options.what == "compare" and not options.than:
        parser.error("compare needs --than FOLDER, another tree's build-mutation")
    return what[options.what](options)


if __name__ == "__main__":
    sys.exit(main())
