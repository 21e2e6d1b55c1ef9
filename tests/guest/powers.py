#!/usr/bin/env python3
"""What tests/guest/bad_packages has found: a CSV with a row for each case.

  powers.py account CSV PACKAGE FOLDER SCALE   adds what has been left in FOLDER
  powers.py held CSV PACKAGE CASE              exit code 0: that case of that package held
  powers.py table CSV PACKAGE                  prints its rows; exit code 1: one did not hold

FOLDER has cases (tabs): what, phase, runs, dpkg, kept, begun, ended (seconds of the machine), how
many orders may end otherwise than by the next one, reason, how many checks failed. events.N: each
order that the battery was given, and how each ended, by its own account. log.csv: what the versions
decided. anchor: of the simulated clock, which runs SCALE times as fast. An order that no version
decided is a step of power.
"""
import csv
import datetime
import pathlib
import sys

START_S = datetime.datetime.fromisoformat("2023-03-26T00:00:00+00:00").timestamp()
LATE_S = 180  # between a tick and its order at the battery: a busy machine's, in simulated time
COLUMNS = ["package", "what", "phase", "runs", "dpkg", "kept", "orders", "ended", "allowed",
           "undecided", "failed_checks", "seconds", "held", "reason"]


def utc_s(text):
    return datetime.datetime.fromisoformat(text.replace("Z", "+00:00")).timestamp()


def read_events(folder):
    found = []
    for place in sorted(folder.glob("events.*"), key=lambda p: int(p.suffix[1:])):
        for row in csv.DictReader(place.open()):
            found.append((int(row["utc_ms"]) / 1000, row["event"], float(row["power_w"])))
    return sorted(found)


def read_rows(table):
    """The newest row of each case."""
    rows = {}
    if table.exists():
        for row in csv.DictReader(table.open()):
            rows[row["package"], row["what"]] = row
    return rows


def account(table, package, folder, scale):
    anchor_s = int((folder / "anchor").read_text()) / 1e9
    events = read_events(folder)
    decided = {}
    for row in csv.DictReader((folder / "log.csv").open()):
        if row["ordered_power_w"] not in ("", "none"):
            decided.setdefault(float(row["ordered_power_w"]), []).append(utc_s(row["utc"]))
    shifts = [0.0]
    if (folder / "shifts").exists():
        shifts += [float(line) for line in (folder / "shifts").read_text().split()]

    def is_decided(at_s, power_w):
        return any(-LATE_S < at_s + shift - tick < LATE_S
                   for tick in decided.get(power_w, []) for shift in shifts)

    is_new = not table.exists()
    with table.open("a") as out:
        writer = csv.DictWriter(out, COLUMNS, lineterminator="\n")
        if is_new:
            writer.writeheader()
        for line in (folder / "cases").read_text().splitlines():
            what, phase, runs, dpkg, kept, begun, ended, allowed, reason, failed = line.split("\t")
            span = [START_S + (float(t) - anchor_s) * scale for t in (begun, ended)]
            here = [e for e in events if span[0] <= e[0] < span[1]]
            orders = [e for e in here if e[1] == "order"]
            ends = len(here) - len(orders)
            undecided = [e for e in orders if e[2] != 0 and not is_decided(e[0], e[2])]
            is_held = not undecided and ends <= int(allowed) and failed == "0"
            writer.writerow({
                "package": package, "what": what, "phase": phase, "runs": runs, "dpkg": dpkg,
                "kept": kept, "orders": len(orders), "ended": ends, "allowed": allowed,
                "undecided": len(undecided), "failed_checks": failed,
                "seconds": f"{float(ended) - float(begun):.0f}",
                "held": "yes" if is_held else "no", "reason": reason})
            for event in undecided[:3]:
                print(f"{what}: nobody decided {event}")


def print_table(table, package):
    rows = [row for (of, _), row in read_rows(table).items() if of == package]
    print(f"{'package or moment':<50} {'phase':<11} {'runs':<5} {'dpkg':<8} {'kept':<4} "
          f"{'orders':>6} {'ended':>5} {'undecided':>9} {'s':>4}  reason")
    for row in rows:
        print(f"{row['what'][:50]:<50} {row['phase']:<11} {row['runs']:<5} {row['dpkg']:<8} "
              f"{row['kept']:<4} {row['orders']:>6} {row['ended']:>5} {row['undecided']:>9} "
              f"{row['seconds']:>4}  {row['reason']}"
              f"{'' if row['held'] == 'yes' else '  <- NOT HELD'}")
    bad = sum(row["held"] != "yes" for row in rows)
    total = {name: sum(int(row[name]) for row in rows) for name in ("orders", "ended")}
    print(f"{len(rows)} cases, {total['orders']} orders, {total['ended']} of them ended otherwise "
          f"than by the next, by the battery's account; {bad} cases have not held")
    return 1 if bad else 0


def main(what, table, package, *more):
    table, package = pathlib.Path(table), pathlib.Path(package).name
    if what == "account":
        return account(table, package, pathlib.Path(more[0]), float(more[1]))
    if what == "table":
        return print_table(table, package)
    return 0 if read_rows(table).get((package, more[0]), {}).get("held") == "yes" else 1


sys.exit(main(*sys.argv[1:]))
