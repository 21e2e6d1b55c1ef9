#!/usr/bin/env python3
"""tests/guest/powers.py FOLDER: what tests/guest/bad_packages has left there, as a table.

cases (tabs): what, phase, runs, dpkg, kept, begun, ended (seconds of the machine), how many orders
may end otherwise than by the next one, reason. events.N: each order that the battery was given, and
how each ended, by its own account. log.csv: what the versions decided. anchor: of the simulated
clock. An order that no version decided is a step of power; exit code 1 says that there was one, or
that an order ended more often than allowed.
"""
import csv
import datetime
import pathlib
import sys

START_S = datetime.datetime.fromisoformat("2023-03-26T00:00:00+00:00").timestamp()
SCALE = 60
LATE_S = 180  # between a tick and its order at the battery: a busy machine's, in simulated time


def utc_s(text):
    return datetime.datetime.fromisoformat(text.replace("Z", "+00:00")).timestamp()


def read_events(folder):
    found = []
    for place in sorted(folder.glob("events.*"), key=lambda p: int(p.suffix[1:])):
        for row in csv.DictReader(place.open()):
            found.append((int(row["utc_ms"]) / 1000, row["event"], float(row["power_w"])))
    return sorted(found)


def main():
    folder = pathlib.Path(sys.argv[1])
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

    bad = 0
    print(f"{'package or moment':<50} {'phase':<11} {'runs':<5} {'dpkg':<8} {'kept':<4} "
          f"{'orders':>6} {'ended':>5} {'undecided':>9} {'s':>4}  reason")
    for line in (folder / "cases").read_text().splitlines():
        what, phase, runs, dpkg, kept, begun, ended, allowed, reason = line.split("\t")
        span = [START_S + (float(t) - anchor_s) * SCALE for t in (begun, ended)]
        here = [e for e in events if span[0] <= e[0] < span[1]]
        orders = [e for e in here if e[1] == "order"]
        ends = [e for e in here if e[1] != "order"]
        undecided = [e for e in orders if e[2] != 0 and not is_decided(e[0], e[2])]
        is_bad = bool(undecided) or len(ends) > int(allowed)
        bad += is_bad
        print(f"{what[:50]:<50} {phase:<11} {runs:<5} {dpkg:<8} {kept:<4} {len(orders):>6} "
              f"{len(ends):>5} {len(undecided):>9} {float(ended) - float(begun):>4.0f}  {reason}"
              f"{'  <- NOT HELD' if is_bad else ''}")
        for event in undecided[:3]:
            print(f"    {event}")
    print(f"{len(events)} orders and ends by the battery's account, "
          f"{bad} cases with a step of power")
    return 1 if bad else 0


sys.exit(main())
