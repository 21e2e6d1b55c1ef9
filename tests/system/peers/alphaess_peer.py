#!/usr/bin/python3
"""An AlphaESS battery as pymodbus serves it: an independent implementation of Modbus.

    alphaess_peer.py --soc 435                 # TCP on a free port, which is printed
    alphaess_peer.py --soc 435 --serial DEVICE # RTU, 9600 8N1
    alphaess_peer.py --soc 435 --scale 60 --fault twice  # misbehaves from the controller's third
                                                         order on; time runs 60 times as fast
    alphaess_peer.py --soc 435 --scale 60 --fault reversed --every 2   # in every other
                                                                       # two-minute step only
    alphaess_peer.py --soc 435 --scale 60 --habits       # no fault: 5 s of lag, 800 W/s, 2 % of
                                                         noise, slow near full and empty

Without --scale the state of charge stays as it is. Faults of the power: reversed, twice, third,
dead (no power), idle-discharge, echo (shows the order, nothing flows), drain (1 kW in addition, not
shown). Of the display: soc-stuck, soc-inverted, capacity (100
kWh), wrong-echo (of every write). Also: other-master (orders 4.5 kW of discharge every 30 s).
Healthy habits: recalibrates (6 % up, immediately), forced-charge (below 10 %, to 11 %), balancing
(450 W while full).
Registers by the vendor's manual V1.23; every write is printed as "write ADDRESS VALUE...". The
dispatch block starts as the vendor's stop command leaves it. Runs until it is killed.
"""
import argparse
import asyncio
import random
import time

from pymodbus.datastore import ModbusSequentialDataBlock

from pymodbus_server import Unit, serve_serial, serve_tcp

UNIT = 85
SOC, CAPACITY, BATTERY_POWER = 0x0102, 0x0119, 0x0126
CHARGE_POWER_MAX, DISCHARGE_POWER_MAX, WORK_MODE, DISPATCH = 0x012C, 0x012D, 0x0440, 0x0880
STOPPED = [0, 0, 32000, 0, 32000, 0, 0, 0, 90, 255, 0]


CAPACITY_WH = 8000
RATED_W = 4000
HEALTHY_ORDERS = 2  # of the controller, after the sign check has released the battery
CYCLE_S = 120
GAIN = {"reversed": -1, "twice": 2, "third": 0.3, "dead": 0, "echo": 0}


class Cells:
    """Real power, in steps of at most a second: - charge, + discharge, in W; the charge in 0.1
    %."""

    def __init__(self, soc, has_habits):
        self.soc, self.has_habits = soc, has_habits
        self.power, self.order, self.order_age_s, self.target = 0.0, 0.0, 1e9, 0.0
        self.is_forced = False
        self.random = random.Random(1)

    def follow(self, order, seconds):
        if order != self.order:
            self.order, self.order_age_s = order, 0
        self.order_age_s += seconds
        if not self.has_habits:
            self.power = order
            return
        if self.order_age_s >= 5:
            self.target = order
        taper = min(1, (1020 - self.soc) / 80 if self.target < 0 else (self.soc + 30) / 120)
        wanted = min(max(self.target, -RATED_W * taper), RATED_W * taper)
        change = min(max(wanted - self.power, -800 * seconds), 800 * seconds)
        self.power += change

    def shown_noise(self):
        return self.random.gauss(1, 0.02) if self.has_habits else 1

    def move(self, power, seconds):
        full_or_empty = (self.soc >= 1000 and power < 0) or (self.soc <= 0 and power > 0)
        flowing = 0 if full_or_empty else power
        self.soc = min(max(self.soc - flowing * seconds / 3600 / CAPACITY_WH * 1000, 0), 1000)
        return flowing


class Registers(ModbusSequentialDataBlock):
    """Holding registers that print writes and follow the dispatch block."""

    def __init__(self, options):
        super().__init__(0, [0] * 0x1000)
        self.cells = Cells(options.soc, options.habits)
        self.scale, self.fault, self.every = options.scale, options.fault, options.every
        self.since = self.foreign = time.monotonic()
        self.orders, self.broke = 0, None
        self.is_checked = False  # its sign
        self.flowing, self.mirror = 0, None
        self.values[0x010D] = self.values[0x0110] = 200  # 0.1 degC
        self.values[SOC] = options.soc            # 0.1 %
        self.values[CAPACITY] = 80                # 0.1 kWh
        self.values[CHARGE_POWER_MAX] = self.values[DISCHARGE_POWER_MAX] = RATED_W
        self.values[WORK_MODE] = 1
        self.values[DISPATCH:DISPATCH + len(STOPPED)] = STOPPED

    def breaks(self, fault, now=None):
        if self.fault != fault or not self.is_checked or self.orders <= HEALTHY_ORDERS:
            return False
        now = now or time.monotonic()
        self.broke = self.broke or now
        return int((now - self.broke) * self.scale / CYCLE_S) % self.every == 0

    def ordered(self):
        return self.values[DISPATCH + 2] - 32000 if self.values[DISPATCH] == 1 else 0

    def step(self, now, seconds):
        cells = self.cells
        cells.follow(self.ordered(), seconds)
        power = cells.power
        for fault, gain in GAIN.items():
            if self.breaks(fault, now):
                power *= gain
        rests = self.values[DISPATCH] == 1 and self.ordered() == 0
        if self.breaks("idle-discharge", now) and rests:
            power = 3000
        if self.breaks("forced-charge", now):
            cells.is_forced = cells.soc < 100 or (cells.is_forced and cells.soc < 110)
            power = -500 if cells.is_forced else power
        self.flowing = cells.move(power, seconds)
        if self.breaks("balancing", now) and cells.soc >= 995 and power <= 0:
            self.flowing = -450
        if self.breaks("drain", now):
            cells.move(1000, seconds)

    def shown_soc(self):
        if self.breaks("soc-stuck"):
            return self.values[SOC]
        soc = self.cells.soc
        if self.breaks("soc-inverted"):
            self.mirror = self.mirror or soc
            soc = 2 * self.mirror - soc
        if self.breaks("recalibrates"):
            soc += 60
        return min(max(round(soc), 0), 1000)

    def live(self):
        """Real and shown energy up to now."""
        now = time.monotonic()
        seconds = (now - self.since) * self.scale
        steps = max(int(seconds), 1)
        for i in range(steps):
            self.step(self.since + (now - self.since) * (i + 1) / steps, seconds / steps)
        self.since = now
        if self.breaks("other-master") and (now - self.foreign) * self.scale >= 30:
            self.foreign = now
            self.values[DISPATCH:DISPATCH + 9] = [1, 0, 36500, 0, 32000, 2, 25, 0, 300]
            self.step(now, 0)
        shown = self.ordered() if self.breaks("echo") else self.flowing * self.cells.shown_noise()
        self.values[BATTERY_POWER] = round(shown) & 0xFFFF
        self.values[SOC] = self.shown_soc()
        self.values[CAPACITY] = 1000 if self.breaks("capacity") else 80

    def getValues(self, address, count=1):
        self.live()
        return super().getValues(address, count)

    def setValues(self, address, values):
        self.live()
        super().setValues(address, values)
        print("write", address, *values, flush=True)
        self.orders += 1
        if not self.is_checked and address == DISPATCH and values[0] == 0:
            self.is_checked, self.orders = True, 0
        self.live()


async def serve(options):
    registers = Registers(options)
    if options.serial:
        await serve_serial(UNIT, Unit(registers), options.serial)

    def spoil(response):
        if registers.breaks("wrong-echo") and response.function_code == 16:
            response.address += 1
        return response

    await serve_tcp(UNIT, Unit(registers), spoil)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--soc", type=int, default=435)
    parser.add_argument("--serial")
    parser.add_argument("--scale", type=float, default=0)
    parser.add_argument("--fault", default="")
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--habits", action="store_true")
    asyncio.run(serve(parser.parse_args()))
