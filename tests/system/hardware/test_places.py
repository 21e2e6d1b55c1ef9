"""bess-edge on its targets: on this machine, on an emulated Raspberry Pi, on a real one over
ssh; with a simulated battery on the same machine, and with a real one on request.
shared/manual/guides/hardware_tests.md has the commands."""
import math
import re
from collections import namedtuple

import pytest
from conftest import TREE
from real_battery import AbortKey, drive, limited

Limits = namedtuple("Limits", "power_w soc_min soc_max")
START = "2023-03-26T00:00:00Z"
SCALE = 120


def prices():
    """An hour before START and two after, so that the battery charges, rests and discharges."""
    lines = ["minute_utc,indicative_eur_mwh,settled_eur_mwh"]
    for minute in range(-60, 120):
        day, clock = ("26", minute) if minute >= 0 else ("25", minute + 24 * 60)
        value = f"{100 + 600 * math.sin(minute / 4):.2f}"
        lines.append(f"2023-03-{day}T{clock // 60:02}:{clock % 60:02}:00Z,{value},{value}")
    return "\n".join(lines) + "\n"


class Site:
    """A simulated battery and a simulated market on the place, and a controller's configuration
    between them."""

    def __init__(self, place):
        folder = place.folder
        place.write(f"{folder}/minutes.csv", prices())
        place.start(
            f"{place.sim} site --program {place.sim} --folder {folder} --prices "
            f"{folder}/minutes.csv "
                    f"--map {place.map} --utc-start {START} --time-scale {SCALE} --set "
                    f"battery.response_timeout_ms=500",
                    f"{folder}/site.log")
        assert place.command.poll_until_success(f"grep -q settings {folder}/site.log", timeout=20.0,
                                                sleepduration=0.2)
        self.config = f"{folder}/edge.toml"
        place.run(f"{place.edge} commission --config {self.config} --yes")
        place.fetch_prices(self.config)


@pytest.fixture(scope="module")
def site(place):
    return Site(place)


def test_decides_as_what_was_proved(place):
    assert place.run(f"{place.edge} signature").strip() == (
        TREE / "edge/generated/decision_signature.txt").read_text().strip()


def test_drives_a_simulated_battery_and_the_map_fits_what_was_recorded(place, site):
    recording = f"{place.folder}/device.jsonl"
    said = place.run(f"{place.edge} --config {site.config} --cycles 4 --record {recording}")
    assert said.count(" mode=running ") == 4
    assert re.search(r" mode=stopping .* battery=ok ", said)
    place.run(f"{place.edge} map check --against {recording} --config {site.config}")


def test_keeps_the_limits_of_a_real_battery(place, site):
    """--real on the simulated battery: no order above the limit, released at the end."""
    said = drive(place, site.config, Limits(400, 0.3, 0.7), cycles=4, cycle_s=120 / SCALE)
    ordered = [int(w) for w in re.findall(r" ordered_power_w=(-?\d+) ", said)]
    assert max(abs(w) for w in ordered) == 400


def test_the_abort_key_ends_it_at_once(place, site):
    looks = iter([False, False, True])
    said = drive(place, site.config, Limits(400, 0.3, 0.7), cycles=1000, cycle_s=120 / SCALE,
                 is_aborted=lambda: next(looks, True))
    assert said.count(" mode=running ") <= 4


def test_limits_replace_those_of_the_settings():
    text = limited(
        'control = false\n[battery]\nmap = "a"  # power_w = 1\npower_w = 4000\n[[reserve]]\nsoc = '
        '0.2\n', 500,
                   0.3, 0.7)
    assert text == (
        'control = true\n[battery]\npower_w = 500\nmap = "a"  # power_w = 1\n[[reserve]]\nsoc = '
        '0.2\n'
                    "[guard]\nsoc_min = 0.3\nsoc_max = 0.7\n")


@pytest.fixture
def real_config(pytestconfig):
    config = pytestconfig.getoption("--real")
    if config is None:
        pytest.skip("no real battery: --real CONFIG")
    return config


def test_a_real_battery_is_what_its_map_says(place, real_config):
    """Reads only."""
    recording = f"{place.folder}/real.jsonl"
    place.run(f"{place.edge} record --config {real_config} --for 1m --every 5s --out {recording}",
              timeout=120)
    place.run(f"{place.edge} map check --against {recording} --config {real_config}")


def test_a_real_battery_follows_within_its_limits(place, real_config, pytestconfig):
    if not pytestconfig.getoption("--yes-drive-real-battery"):
        pytest.skip("--yes-drive-real-battery was not said")
    limits = Limits(*(pytestconfig.getoption(f"--real-{name}")
                      for name in ("power-w", "soc-min", "soc-max")))
    with AbortKey() as key:
        said = drive(place, real_config, limits, pytestconfig.getoption("--real-cycles"),
                     is_aborted=key.is_pressed)
    print(said)
