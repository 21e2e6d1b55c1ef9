#!/usr/bin/python3
"""Batteries and gateways of user reports, over Modbus TCP on a free port, which is printed:
framing, registers and behaviour only from Python's library and the manufacturers' documents.

    field_device.py --device sungrow --firmware '{"signed": true, "bits": false}' --record FILE \\
      --scale 60 --anchor-ns N --start-s UTC --gateway '{"answer_unit": 255}' --trouble '{...}'

Registers: Sungrow by mkaiser/Sungrow-SHx (13000, 13021, 5213, issue 377: 13079 counts down) and
evcc issues 17598 and 18838 (sign, bits that stay 0); Victron by victronenergy/dbus_modbustcp and
openWB/core issue 3355 (10 s); models 1, 103 and 124 by sunspec/models; AlphaESS by its manual V1.23
and senalse/ha-alphaess-modbus (function 16, 250 or 255 for 100 %); SMA by evcc (sma-hybrid, issues
17115 and 15440) and OpenEMS SmaBatteryImpl (no 40153). + charges, - discharges, in W.

SIGUSR1 begins the trouble, SIGUSR2 ends it: "refuse" (reads of unit, first to last; code, 0 =
silence; spell_s: duration from the first on), "fault_after_s", "island_after_s", "firmware" (an
update), "boot" ("zeros", "ones" or an exception). A gateway has "busy" (before_s, after_s, every:
exception 6 around every Nth tick) and "late" (every Nth answer comes before the one
after it) during the trouble, "answer_unit" and "one_client" always. The record has a line for
each write, change of power and trouble, after its time in UTC seconds. Runs until it is killed.
"""
import argparse
import json
import math
import signal
import socket
import struct
import threading
import time

CAPACITY_WH = 8000
RATED_W = 4000
CYCLE_S = 120


class Refused(Exception):
    """Exception answer with this code; 0: no answer."""

    def __init__(self, code):
        super().__init__(code)
        self.code = code


def s16(word):
    return word - 0x10000 if word >= 0x8000 else word


def u32(value, low_first=False):
    words = [value >> 16 & 0xFFFF, value & 0xFFFF]
    return words[::-1] if low_first else words


class Battery:
    """Cells that follow the order of a device immediately; a device defines `ordered`, and what it
    shows."""
    units = (1,)

    def __init__(self, firmware, soc, record):
        self.firmware, self.soc, self.record = firmware, soc, record
        self.since, self.power, self.until = None, 0, math.inf
        self.fault = self.island = False
        self.held = {}  # (unit, address): value written there

    def ordered(self):
        raise NotImplementedError

    def expire(self):
        """The device ends the order by itself."""

    def ranges(self, unit, function):
        """Readable registers: pairs of addresses; others are 0."""
        raise NotImplementedError

    def shown(self, unit, function):
        raise NotImplementedError

    def take(self, unit, address, word, now):
        """One register of a write, after all of them were stored."""

    def room(self, power):
        full, empty = self.soc >= 1 and power > 0, self.soc <= 0 and power < 0
        return 0 if full or empty else max(-RATED_W, min(RATED_W, power))

    def flow(self, until):
        power = self.room(self.ordered())
        if power != self.power:
            self.record(self.since, f"power {power:.0f}")
            self.power = power
        seconds = until - self.since
        self.soc = min(1, max(0, self.soc + power * seconds / 3600 / CAPACITY_WH))
        self.since = until

    def live(self, now):
        self.since = self.since or now
        if self.until <= now:
            self.flow(self.until)
            self.until = math.inf
            self.expire()
            self.record(self.since, "expired")
        while self.since < now:  # full or empty is seen within 5 s
            self.flow(min(now, self.since + 5))

    def soc_shown(self):
        return self.soc * self.firmware.get("soc_gain", 1)

    def read(self, unit, function, first, count):
        last = first + count - 1
        if not any(a <= first and last <= b for a, b in self.ranges(unit, function)):
            raise Refused(2)
        shown = self.shown(unit, function)
        return [shown.get(a, self.held.get((unit, a), 0)) & 0xFFFF for a in range(first, last + 1)]

    def write(self, unit, function, first, words, now):
        last = first + len(words) - 1
        if not any(a <= first and last <= b for a, b in self.ranges(unit, 3)):
            raise Refused(2)
        for i, word in enumerate(words):
            self.held[unit, first + i] = word
        for i, word in enumerate(words):
            self.take(unit, first + i, word, now)
        self.flow(now)


class Sungrow(Battery):
    """SH: firmware "signed" (13021 and 5213), "bits" (of 13000), "countdown" (of 13079)."""

    def at(self, address):
        return self.held.get((1, address), 0)

    def ordered(self):
        if self.at(13049) not in (2, 3):
            return 0
        return {0xAA: 1, 0xBB: -1}.get(self.at(13050), 0) * self.at(13051)

    def expire(self):
        if self.at(13049) == 3:
            self.held[1, 13049] = 0

    def take(self, unit, address, word, now):
        if address == 13079:
            self.until = now + word

    def ranges(self, unit, function):
        if function == 3:
            return [(13000, 13099), (33046, 33049)]
        return [(12999, 13099)] + ([(5213, 5214)] if self.firmware.get("signed") else [])

    def shown(self, unit, function):
        power = round(self.power)
        if function == 3:
            left = self.until - self.since if self.until < math.inf else 0
            counted = {13079: math.ceil(left)} if self.firmware.get("countdown", True) else {}
            return {33046: RATED_W // 10, 33047: RATED_W // 10} | counted
        words = dict(zip((5213, 5214), u32(-power, True)))
        bits = (2 if power > 0 else 4 if power < 0 else 0) if self.firmware.get("bits", True) else 0
        words[12999] = 0x1000 if self.island else 0x0040
        words[13000] = 1 | bits if bits else 0
        words[13021] = -power if self.firmware.get("signed") else abs(power)
        words[13022] = round(self.soc_shown() * 1000)
        words[13024] = 200
        words[13065] = 1 if self.fault else 0  # of the battery, low word first
        return words


class Victron(Battery):
    """GX with a Multi (unit 227) and a BMS (225): "timeout_s" of a set-point, "mode" that 2902
    reads."""
    units = (100, 225, 227)

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.held[100, 2902] = self.firmware.get("mode", 1)

    def ordered(self):
        if self.held[100, 2902] != 3:
            return 0
        return sum(s16(self.held.get((227, a), 0)) for a in (37, 40, 41) if self.until < math.inf)

    def take(self, unit, address, word, now):
        if (unit, address) == (227, 37):
            self.until = now + self.firmware.get("timeout_s", 60)

    def ranges(self, unit, function):
        return {100: [(800, 870), (2900, 2902)], 225: [(256, 330)], 227: [(3, 60)]}[unit]

    def shown(self, unit, function):
        if unit == 100:
            return {842: round(self.power), 843: round(self.soc_shown() * 100), 820: 500}
        if unit == 225:
            return {267: 2 if self.fault else 0}
        return {29: 240 if self.island else 0, 31: 3}


class SunSpec(Battery):
    """A chain of models at "base": 1, 103 and 124, or those of "models"."""
    MODEL_LENGTHS = {1: 66, 101: 50, 103: 50, 120: 26, 124: 24}

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.base = self.firmware.get("base", 40000)
        self.heads, address = {}, self.base + 2
        for model in self.firmware.get("models", [1, 103, 124]):
            self.heads[model] = address
            address += 2 + self.MODEL_LENGTHS[model]
        self.end = address
        for offset, word in ((12, 10000), (13, 10000)):
            self.held[1, self.heads.get(124, 0) + offset] = word

    def of_124(self, offset):
        return s16(self.held.get((1, self.heads[124] + offset), 0))

    def ordered(self):
        """StorCtl_Mod bit 0 limits charging to InWRte, bit 1 discharging to OutWRte; between both
        the house decides, and takes nothing here. A negative rate requests the other direction."""
        if 124 not in self.heads:
            return 0
        mode = self.of_124(5)
        most = self.of_124(13) * RATED_W / 10000 if mode & 1 else RATED_W
        least = -self.of_124(12) * RATED_W / 10000 if mode & 2 else -RATED_W
        power = max(least, min(most, 0))
        return 0 if power > 0 and not self.of_124(17) else power

    def expire(self):
        self.held[1, self.heads[124] + 5] = 0

    def take(self, unit, address, word, now):
        revert_s = self.of_124(15)
        self.until = now + revert_s if revert_s else math.inf

    def ranges(self, unit, function):
        return [(self.base, self.end + 1)]

    def read(self, unit, function, first, count):
        boot = self.firmware.get("boot")
        if boot in ("zeros", "ones"):
            return [0 if boot == "zeros" else 0xFFFF] * count
        if boot:
            raise Refused(boot)
        if any(a <= first <= a + 99 for a in self.firmware.get("silent", [])):
            raise Refused(0)
        return super().read(unit, function, first, count)

    def write(self, unit, function, first, words, now):
        if self.firmware.get("boot"):
            raise Refused(2)
        super().write(unit, function, first, words, now)

    def shown(self, unit, function):
        words = {self.base: 0x5375, self.base + 1: 0x6E53, self.end: 0xFFFF, self.end + 1: 0}
        for model, head in self.heads.items():
            words |= {head: model, head + 1: self.MODEL_LENGTHS[model]}
        if 103 in self.heads:
            head = self.heads[103]
            words |= {head + 14: -round(self.power), head + 15: 0,
                      head + 38: 7 if self.fault else 4}
        if 124 in self.heads:
            head = self.heads[124]
            words |= {head + 2: RATED_W, head + 8: round(self.soc_shown() * 10000), head + 18: 0,
                      head + 22: -2, head + 25: -2}
        return words


class AlphaEss(Battery):
    units = (85,)
    BLOCK = 0x0880

    def __init__(self, *arguments):
        super().__init__(*arguments)
        for i, word in enumerate((0, 0, 32000, 0, 32000, 0, 0, 0, 90, 255, 0)):
            self.held[85, self.BLOCK + i] = word

    def at(self, offset):
        return self.held[85, self.BLOCK + offset]

    def ordered(self):
        if self.at(0) != 1 or self.at(5) != 2:
            return 0
        power = 32000 - (self.at(1) << 16 | self.at(2))
        limit = self.at(6) / 250
        reached = self.soc >= limit if power > 0 else self.soc <= limit
        return 0 if reached else power

    def expire(self):
        self.held[85, self.BLOCK] = 0

    def take(self, unit, address, word, now):
        self.until = now + (self.at(7) << 16 | self.at(8)) if self.at(0) else math.inf

    def ranges(self, unit, function):
        return [(0x0010, 0x0040), (0x0100, 0x0150), (0x0430, 0x0448), (0x0880, 0x088A),
                (0x08D0, 0x08D5)]

    def shown(self, unit, function):
        return {0x0102: round(self.soc_shown() * 1000), 0x010D: 200, 0x0110: 200,
                0x0119: CAPACITY_WH // 100, 0x0126: -round(self.power), 0x012C: RATED_W,
                0x012D: RATED_W, 0x0440: 2 if self.island else 1, 0x08D5: 1 if self.fault else 0}


class Sma(Battery):
    """"smart_energy" obeys 40149 alone, and has no 40153; else 40236 with its limits as well."""
    units = (3,)

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.held[3, 40237] = 2424
        self.held[3, 40796] = self.held[3, 40800] = RATED_W

    def at(self, address):
        value = self.held.get((3, address), 0) << 16 | self.held.get((3, address + 1), 0)
        return value - (1 << 32) if value >= 1 << 31 else value

    def ordered(self):
        if self.until == math.inf:
            return 0
        if self.at(40151) == 802:
            return -self.at(40149)
        if self.firmware.get("smart_energy"):
            return 0
        return {2289: 1, 2290: -1}.get(self.at(40236), 0) * max(self.at(40793), self.at(40797))

    def take(self, unit, address, word, now):
        self.until = now + 60

    def ranges(self, unit, function):
        control = 40152 if self.firmware.get("smart_energy") else 40154
        return [(30201, 30202), (30845, 30846), (31391, 31396), (40149, control), (40236, 40237),
                (40793, 40802)]

    def shown(self, unit, function):
        power = round(self.power)
        values = {30201: 35 if self.fault else 307, 30845: round(self.soc_shown() * 100),
                  31391: 307, 31393: max(power, 0), 31395: max(-power, 0)}
        return {a + i: word for a, value in values.items() for i, word in enumerate(u32(value))}


class Site:
    """The battery behind its gateway: one request at a time from any client."""

    def __init__(self, options):
        self.options, self.lock = options, threading.RLock()
        self.gateway, self.trouble = json.loads(options.gateway), json.loads(options.trouble)
        self.file = open(options.record, "w", buffering=1, encoding="ascii")
        self.battery = DEVICES[options.device](json.loads(options.firmware), options.soc,
                                               self.record)
        self.troubled_since, self.refused_since, self.answers, self.late = None, None, 0, b""
        self.clients = 0

    def now(self):
        o = self.options
        return o.start_s + (time.monotonic_ns() - o.anchor_ns) / 1e9 * o.scale

    def record(self, at, text):
        print(f"{at:.3f} {text}", file=self.file)

    def begin(self, *_):
        with self.lock:
            self.troubled_since = self.now()
            self.healthy = dict(self.battery.firmware)
            self.battery.firmware.update(self.trouble.get("firmware", {}))
            if "boot" in self.trouble:
                self.battery.firmware["boot"] = self.trouble["boot"]
            self.record(self.now(), "trouble")

    def end(self, *_):
        with self.lock:
            self.troubled_since = None
            self.battery.firmware = self.healthy
            self.battery.fault = self.battery.island = False
            self.record(self.now(), "healthy")

    def suffer(self, now):
        for what in ("fault", "island"):
            after = self.trouble.get(what + "_after_s")
            if after is None or self.troubled_since is None or getattr(self.battery, what):
                continue
            if now >= self.troubled_since + after:
                setattr(self.battery, what, True)
                self.record(now, what)

    def check_refused(self, unit, first, last, now):
        rule = self.trouble.get("refuse")
        if rule is None or self.troubled_since is None or unit != rule.get("unit", unit):
            return
        if last < rule["first"] or first > rule["last"]:
            return
        self.refused_since = self.refused_since or now
        if now > self.refused_since + rule.get("spell_s", math.inf):
            return
        self.record(now, f"refused {unit} {first} {last}")
        raise Refused(rule["code"])

    def check_busy(self, now):
        busy = self.gateway.get("busy")
        if busy is None or self.troubled_since is None:
            return
        tick, after = divmod(now + busy["before_s"], CYCLE_S)
        if tick % busy["every"] == 0 and after < busy["before_s"] + busy["after_s"]:
            raise Refused(6)

    def answer(self, unit, pdu):
        now = self.now()
        self.suffer(now)
        self.battery.live(now)
        function, first, count = struct.unpack(">BHH", pdu[:5])
        if unit not in self.battery.units:
            raise Refused(10)
        self.check_busy(now)
        if function in (3, 4):
            self.check_refused(unit, first, first + count - 1, now)
            words = self.battery.read(unit, function, first, count)
            return struct.pack(f">BB{count}H", function, 2 * count, *words)
        if function not in (6, 16):
            raise Refused(1)
        words = [count] if function == 6 else struct.unpack(f">{count}H", pdu[6:])
        self.battery.write(unit, function, first, words, now)
        self.record(now, f"write {unit} {first} " + " ".join(map(str, words)))
        return pdu[:5]

    def frames(self, transaction, unit, pdu):
        """Reply to one request."""
        try:
            answer = self.answer(unit, pdu)
        except Refused as refused:
            if refused.code == 0:
                return b""
            answer = bytes([pdu[0] | 0x80, refused.code])
        unit = self.gateway.get("answer_unit", unit)
        frame = struct.pack(">HHHB", transaction, 0, len(answer) + 1, unit) + answer
        before, self.late = self.late, b""
        self.answers += 1
        every = self.gateway.get("late", 0)
        if every and self.troubled_since is not None and self.answers % every == 0:
            self.late = frame
            return before
        return before + frame

    def serve(self, connection):
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        file = connection.makefile("rb")
        try:
            while len(head := file.read(7)) == 7:
                transaction, _, length, unit = struct.unpack(">HHHB", head)
                pdu = file.read(length - 1)
                with self.lock:
                    frames = self.frames(transaction, unit, pdu)
                connection.sendall(frames)
        except OSError:
            pass  # the client is gone
        finally:
            connection.close()
            self.clients -= 1

    def age(self):
        """Records power changes, also without requests."""
        while True:
            time.sleep(1 / self.options.scale)
            with self.lock:
                self.suffer(self.now())
                self.battery.live(self.now())

    def listen(self):
        server = socket.create_server(("127.0.0.1", 0))
        threading.Thread(target=self.age, daemon=True).start()
        print("port", server.getsockname()[1], flush=True)
        while True:
            connection, _ = server.accept()
            if self.gateway.get("one_client") and self.clients > 0:
                connection.close()
                continue
            self.clients += 1
            threading.Thread(target=self.serve, args=(connection,), daemon=True).start()


DEVICES = {"sungrow": Sungrow, "victron": Victron, "sunspec": SunSpec, "alphaess": AlphaEss,
           "sma": Sma}


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--device", choices=DEVICES, required=True)
    parser.add_argument("--firmware", default="{}")
    parser.add_argument("--gateway", default="{}")
    parser.add_argument("--trouble", default="{}")
    parser.add_argument("--record", required=True)
    parser.add_argument("--soc", type=float, default=0.3)
    parser.add_argument("--scale", type=int, required=True)
    parser.add_argument("--anchor-ns", type=int, required=True)
    parser.add_argument("--start-s", type=int, required=True)
    site = Site(parser.parse_args())
    signal.signal(signal.SIGUSR1, site.begin)
    signal.signal(signal.SIGUSR2, site.end)
    site.listen()
