"""Driving a real battery: limits of its own, a person who watches, and a key that ends
it."""
import json
import os
import re
import select
import termios
import time
import tty


def limited(settings, power_w, soc_min, soc_max):
    """The text of a bess-edge configuration, with these limits instead of its own."""
    tables = {"": {"control": "true"}, "battery": {"power_w": str(power_w)},
              "guard": {"soc_min": str(soc_min), "soc_max": str(soc_max)}}
    lines, table = [], ""
    head = [f"{key} = {value}" for key, value in tables[""].items()]
    seen = set()
    for line in settings.splitlines():
        name = re.match(r"\s*\[([^\[\]]+)\]\s*(#.*)?$", line)
        if name or line.lstrip().startswith("[["):
            table = name.group(1).strip() if name else "[[]]"
            lines.append(line)
            if table in tables and table not in seen:
                seen.add(table)
                lines += [f"{key} = {value}" for key, value in tables[table].items()]
            continue
        key = re.match(r"\s*([A-Za-z_]+)\s*=", line)
        if key and key.group(1) in tables.get(table, {}):
            continue
        lines.append(line)
    for name in ("battery", "guard"):
        if name not in seen:
            lines += [f"[{name}]"] + [f"{key} = {value}" for key, value in tables[name].items()]
    return "\n".join(head + lines) + "\n"


class AbortKey:
    """Q at the terminal, despite pytest's capture of streams. Without a terminal use Ctrl-C
    alone."""

    def __enter__(self):
        try:
            self.terminal = os.open("/dev/tty", os.O_RDWR | os.O_NOCTTY)
        except OSError:
            self.terminal = None
            return self
        self.before = termios.tcgetattr(self.terminal)
        tty.setcbreak(self.terminal)
        os.write(self.terminal, b"\r\ndriving the battery: press Q to end it immediately\r\n")
        return self

    def __exit__(self, *_):
        if self.terminal is not None:
            termios.tcsetattr(self.terminal, termios.TCSADRAIN, self.before)
            os.close(self.terminal)

    def is_pressed(self):
        if self.terminal is None:
            return False
        ready, _, _ = select.select([self.terminal], [], [], 0)
        return bool(ready) and os.read(self.terminal, 1) in b"qQ"


def complaint(status, limits):
    """Violated limits in a running controller's status; "" if there are none."""
    last = status.get("last", status)
    ordered, power, soc = (last.get(key) for key in ("ordered_power_w", "battery_power_w",
                                                     "soc_e4"))
    if ordered is not None and abs(ordered) > limits.power_w:
        return f"{ordered} W were ordered, more than {limits.power_w} W"
    if power is not None and abs(power) > 1.2 * limits.power_w + 200 and ordered is not None:
        return f"{power} W flow at a limit of {limits.power_w} W"
    slack = 0.01  # a register may show whole percents
    if soc is not None and ordered and ordered > 0 and soc / 1e4 > limits.soc_max + slack:
        return f"it is charged at {soc / 100} %"
    if soc is not None and ordered and ordered < 0 and soc / 1e4 < limits.soc_min - slack:
        return f"it is discharged at {soc / 100} %"
    return ""


def drive(place, config, limits, cycles, cycle_s=120, is_aborted=lambda: False):
    """Drives the battery of `config` (a path on the place) within the limits; the controller's log.

    On any end (regular, key, Ctrl-C or violated limit) the controller is stopped, which
    orders 0 W and releases the battery, and its last output is checked.
    """
    own = f"{config}.limited.toml"
    place.write(own, limited(place.read(config), limits.power_w, limits.soc_min, limits.soc_max))
    log = f"{place.folder}/real.log"
    prices = place.fetch_prices(own)
    pid = place.start(f"{place.edge} --config {own} --cycles {cycles}", log)
    why = ""
    try:
        deadline = time.monotonic() + (cycles + 2) * cycle_s + 60
        while place.is_running(pid) and not why:
            _, text = place.attempt(f"{place.edge} status --json --config {own}")
            why = complaint(json.loads(text), limits) if text.startswith("{") else ""
            if is_aborted():
                why = "aborted"
            if time.monotonic() > deadline:
                why = "it did not end in time"
            time.sleep(min(1, cycle_s / 10))
    finally:
        place.attempt(f"kill -TERM {pid} {prices}")
        for _ in range(700):  # releasing a battery without a watchdog is retried for 65 s
            if not place.is_running(pid):
                break
            time.sleep(0.1)
        said = place.read(log)
        place.attempt(f"rm -f {own}")
        assert re.search(r" mode=stopping .* battery=ok ", said), said
    assert why in ("", "aborted"), why
    return said
