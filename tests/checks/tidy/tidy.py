#!/usr/bin/env python3
"""tidy.py TREE: tidy check of the tree. Fails, naming file and line, on

- a line of more than 100 columns, except in generated files, data, tables and printed text of
  READMEs, and single words (URLs); other files with long lines are in long_lines.txt with the
  number of such lines, which may not grow
- a file of a kind that is not known, or at the top of the tree and not named in README.md
- a README or a page of the manual that has no heading, or names a file that is not there, in full
  or by the end of its path; a README of more words than allowed, and all of them together
- a document that repeats a figure of the tree that has changed
"""

import fnmatch
import pathlib
import re
import subprocess
import sys

COLUMNS = 100
README_LINES = 90  # of the top one
FOLDER_WORDS = 300  # of any other README
MANUAL_WORDS = 22_000  # of all documents without the notebook
NOTEBOOK = "shared/manual/notebook/"  # dated: its names and figures are those of its day
DATA = ("edge/generated/", "tests/data/", "tests/data/golden/", "tests/checks/fuzz/seeds/",
        "tools/delivery/monitoring/grafana_dashboard.json")
KINDS = set(
    ".c .cmake .conf .cpp .css .csv .gz .h .html .in .js .json .jsonl .md .py .rules .service .sh"
            " .sysusers .timer .tmpfiles .toml .txt .xml .yaml .yml".split())
KNOWN_NAMES = {"copyright", "conffiles", "lintian-overrides"}  # what Debian's packages have
PLACES = ("edge", "shared", "tests", "toolchains", "tools", "workstation")
SHORT = re.compile(r"`(\w[\w.-]*(?:/[\w.*-]+)*\.(?:h|cpp|py|\*))`"  # control/reasons.h
                   r"|`(\w[\w.-]*/[\w./*-]+\.(?:sh|cmake|toml|txt|js|json|md|css|csv))`")
ELSEWHERE = tuple(place + "/" for place in PLACES) + (  # checked as places, or made by programs
    "build", "runs/", "debs/", "sweeps/", "sizes/")


def tracked(tree):
    listed = subprocess.run(["git", "-C", tree, "ls-files", "-z"], capture_output=True, text=True,
                            check=True).stdout
    return [name for name in listed.split("\0") if name and (tree / name).is_file()]


def text_of(path):
    try:
        return path.read_text(encoding="utf-8")
    except UnicodeDecodeError:
        return None


def prose_only(lines):
    """For each line: is it prose, that is no table row, printed text or command?"""
    fenced = False
    for line in lines:
        fence = line.startswith("```")
        fenced = fenced != fence
        is_row = line.lstrip().startswith("|")
        yield not (fenced or fence or is_row or line.startswith("    "))


def long_lines(name, text):
    lines = text.splitlines()
    counts = prose_only(lines) if name.endswith(".md") else [True] * len(lines)
    return [number for number, (line, counted) in enumerate(zip(lines, counts), 1)
            if counted and len(line) > COLUMNS and max(len(word) for word in line.split()) < COLUMNS
            - 8]


def check_columns(tree, names, allowed, complain):
    for name in names:
        if name.startswith(DATA):
            continue
        text = text_of(tree / name)
        found = long_lines(name, text) if text is not None else []
        if len(found) > allowed.get(name, 0):
            complain(f"{name}:{found[-1]}: {len(found)} lines of more than {COLUMNS} columns,"
                     f" {allowed.get(name, 0)} are known")


def check_kinds(tree, names, complain):
    readme = (tree / "README.md").read_text(encoding="utf-8")
    for name in names:
        path = pathlib.PurePosixPath(name)
        is_script = (tree / name).read_bytes()[:2] == b"#!"
        known = path.suffix in KINDS or is_script or path.name.startswith(".") or name.startswith(
            DATA)
        if not known and path.name not in KNOWN_NAMES:
            complain(f"{name}: a file of an unknown kind")
    for top in sorted({name.split("/")[0] for name in names} - {"README.md", "CMakeLists.txt"}):
        if not top.startswith(".") and not re.search(r"[`\[(]" + re.escape(top) + r"[/`]", readme):
            complain(f"{top}: at the top of the tree, and README.md does not name it")


def documents(names):
    return [n for n in names if not n.startswith(NOTEBOOK) and
            (n.endswith("README.md") or n.startswith("shared/manual/") and n.endswith(".md"))]


def check_documents(tree, names, complain):
    total = 0
    for name in documents(names):
        text = (tree / name).read_text(encoding="utf-8")
        if not re.match(r"# \w", text):
            complain(f"{name}:1: begins with no heading")
        lines, words = text.count("\n"), len(text.split())
        if name == "README.md" and lines > README_LINES:
            complain(f"{name}: {lines} lines, {README_LINES} at most")
        if name.endswith("README.md") and not name.startswith("shared/manual/"):
            if name != "README.md" and words > FOLDER_WORDS:
                complain(f"{name}: {words} words, {FOLDER_WORDS} at most")
        total += words
        folder = (tree / name).parent
        for link in re.findall(r"\]\(([^)#: ]*[./][^)#: ]*)\)", text):
            if not (folder / link).exists():
                complain(f"{name}: links to {link}, which is not there")
        for place in re.findall(r"`((?:%s)/[\w./-]+)`" % "|".join(PLACES), text):
            there = (tree / place, folder / place)
            if not any(path.exists() for path in there) and "NAME" not in place:
                complain(f"{name}: names {place}, which is not there")
        for short in map("".join, SHORT.findall(text)):
            there = short.startswith(ELSEWHERE) or "NAME" in short or any(folder.glob(short))
            if not there:
                ends = "*/" + short
                if not any(fnmatch.fnmatchcase("/" + n, ends) for n in names):
                    complain(f"{name}: names {short}, which is not there")
    if total > MANUAL_WORDS:
        complain(f"{total} words in all documents, {MANUAL_WORDS} at most without the notebook")


def figures(tree):
    """Patterns in which a README repeats a figure, and the figure."""
    signature = (tree / "edge/generated/decision_signature.txt").read_text(encoding="utf-8")
    header = (tree / "edge/generated/student_weights.h").read_text(encoding="utf-8")
    states = re.search(r"STATES_CHECKED\s+\w*\(?(\d+)|(\d+) states", header)
    yield r"signature=([0-9a-f]{16})\b", re.search(r"signature=([0-9a-f]{16})", signature)[1]
    yield r"([\d,]{10,}) (?:inputs|states)", next(filter(None, states.groups()))
    maps = [m for m in (tree / "edge/device/maps").glob("*.toml")]
    yield r"\b(\d+) register maps\b", str(len(maps))
    scenarios = list((tree / "tests/scenarios").glob("*.toml"))
    yield r"\b(\d+) (?:shipped )?scenarios\b", str(len(scenarios))
    for pattern, name, row in (
            (r"\b(\d+) faults of bus", "tools/simulators/battery_sim/battery_faults.h",
             r"^  ROW\(k"),
            (r"\b(\d+) faults\b(?! of bus)", "tests/system/trial/trial_fault.cpp", r'^    \{"'),
            (r"\b(\d+) honest (?:variants|batteries)", "tests/system/trial/healthy_batteries.cpp",
             r'^    \{(?:\.name = )?"'),
            (r"\b(\d+) alerts, each", "tools/delivery/monitoring/bess_rules.yml", r"^ *- alert:")):
        rows = (tree / name).read_text(encoding="utf-8") if (tree / name).exists() else ""
        yield pattern, str(len(re.findall(row, rows, re.M)))


def check_figures(tree, names, complain):
    held = list(figures(tree))
    for name in documents(names):
        text = " ".join((tree / name).read_text(encoding="utf-8").split())
        for pattern, expected in held:
            for match in re.finditer(pattern, text):
                said = next(filter(None, match.groups()))
                if said.replace(",", "") != expected:
                    complain(f"{name}: says {said}, the tree {expected}")


def main():
    if len(sys.argv) != 2:
        print(__doc__, file=sys.stderr)
        return 2
    tree = pathlib.Path(sys.argv[1]).resolve()
    if not (tree / ".git").exists():
        print("needs a clone, whose files git can list")
        return 77
    names = tracked(tree)
    complaints = []
    listed = (tree / "tests/checks/tidy/long_lines.txt").read_text(encoding="utf-8").splitlines()
    allowed = {line.split()[1]: int(line.split()[0]) for line in listed
               if line and not line.startswith("#")}
    check_columns(tree, names, allowed, complaints.append)
    check_kinds(tree, names, complaints.append)
    check_documents(tree, names, complaints.append)
    check_figures(tree, names, complaints.append)
    print("\n".join(complaints) or "tidy")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
