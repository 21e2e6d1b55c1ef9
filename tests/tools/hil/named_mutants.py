#!/usr/bin/env python3
"""named_mutants.py BUILD [NAME...]: the named defects of mutants.txt, and what their scenario says.

Builds the programs of those named (default: all; some thirty seconds each), runs each on its
scenario and prints a row: the defect, its scenario, the rule that was to find it, and all rules
that did. Exit codes: 0 each was caught by its rule, 1 one was not, 2 the command line.
"""
import json
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parents[2]


def rows():
    for line in (HERE / "mutants.txt").read_text().splitlines():
        if line[:1].isalpha():
            yield line.split(" | ")[:4]


def rules_found(program, scenario):
    done = subprocess.run([program, "run", ROOT / "tests/scenarios" / f"{scenario}.toml", "--json"],
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, timeout=600)
    runs = json.loads(done.stdout)["runs"]
    return list(dict.fromkeys(f["rule"] for run in runs for f in run["findings"]))


def main():
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        print(__doc__)
        return 0 if len(sys.argv) > 1 else 2
    build, names = pathlib.Path(sys.argv[1]), sys.argv[2:]
    wanted = [row for row in rows() if not names or row[0] in names]
    if unknown := set(names) - {row[0] for row in wanted}:
        print(f"named_mutants.py: not in mutants.txt: {' '.join(sorted(unknown))}",
              file=sys.stderr)
        return 2
    subprocess.run(["cmake", "--build", build, "--target"] +
                   [f"hil_mutant_{row[0]}" for row in wanted], check=True,
                   stdout=subprocess.DEVNULL)
    escaped = 0
    print("| defect | scenario | rule that finds it | all that did |\n|---|---|---|---|")
    for name, scenario, rule, _ in wanted:
        found = rules_found(build / f"hil_mutant_{name}", scenario)
        escaped += rule not in found
        told = rule if rule in found else f"**not by {rule}**"
        print(f"| {name} | {scenario} | {told} | {', '.join(found)} |", flush=True)
    print(f"{len(wanted) - escaped} of {len(wanted)} caught")
    return 1 if escaped else 0


if __name__ == "__main__":
    sys.exit(main())
