#!/usr/bin/python3
"""A meter as pymodbus serves it: an implementation of Modbus that shares nothing with bess.

    meter_peer.py --map eastron_sdm630 --watts -1230      # TCP on a free port, which is printed
    meter_peer.py --map sunspec --battery-port 1502 --scale 120 --anchor-ns N --lie inverted \\
        --lie-from-s 900 --truth truth.csv

Registers by the makers' tables, worked out by hand; watts are import, a multiple of 10. With
--battery-port it stands at the connection of a house that moves (from --seed) and of a battery,
whose power it asks bess-sim for (map simulator), and may lie about their sum. --truth: second,
house, battery, shown, a line each time. Runs until it is killed.
"""
import argparse
import asyncio
import collections
import random
import struct
import threading
import time

from pymodbus.client import ModbusTcpClient
from pymodbus.datastore import ModbusSequentialDataBlock

from pymodbus_server import Unit, serve_tcp


def words(fmt, value):
    packed = struct.pack(">" + fmt, value)
    return list(struct.unpack(f">{len(packed) // 2}H", packed))


def sunspec(watts):
    """"SunS", common model 1, meter model 203 (A, V, Hz as "not implemented"), end."""
    meter = [0x8000] * 105
    meter[16] = words("h", watts // 10)[0]  # W, two registers behind the model's head
    meter[20] = 1                           # W_SF
    return {40000: [0x5375, 0x6E53, 1, 66] + [0] * 66 + [203, 105] + meter + [0xFFFF, 0]}


MAPS = {  # unit, registers by address
    "sunspec": (1, sunspec),
    "fronius_smart_meter": (200, sunspec),
    "victron_gx": (100, lambda w: {820: [words("h", p)[0] for p in (w - 500, 700, -200)]}),
    "eastron_sdm630": (1, lambda w: {0x34: words("f", w), 0x46: words("f", 50.0)}),
    "p1_dongle_pro": (1, lambda w: {0: words("I", int(time.time())),
                                    14: words("I", max(w, 0)), 16: words("I", max(-w, 0))}),
}


class House:
    """A refrigerator, noise, and a kettle or an oven now and then."""

    def __init__(self, seed):
        self.random, self.until_s, self.extra_w = random.Random(seed), 0, 0

    def watts(self, second):
        while second >= self.until_s:
            on = self.extra_w == 0
            self.extra_w = self.random.choice((1800, 2200, 3200)) if on else 0
            self.until_s += self.random.uniform(60, 300) if on else self.random.uniform(200, 900)
        return 350 + self.extra_w + self.random.gauss(0, 15)


class Connection:
    """Grid = house + battery, and what the meter makes of it."""

    def __init__(self, options):
        self.options, self.house, self.past = options, House(options.seed), collections.deque()
        self.battery = ModbusTcpClient("127.0.0.1", port=options.battery_port, timeout=5)
        assert self.battery.connect()
        self.frozen = None

    def second(self):
        return (time.monotonic_ns() - self.options.anchor_ns) * self.options.scale / 1e9

    def battery_watts(self):
        reply = self.battery.read_holding_registers(11, count=2, slave=1)
        assert not reply.isError(), reply
        return struct.unpack(">i", struct.pack(">HH", *reply.registers))[0]

    def lies(self, second):
        o = self.options
        begun = second - o.lie_from_s
        return begun >= 0 and (o.lie_each_s == 0 or begun % o.lie_each_s < o.lie_for_s)

    def shown(self, second, house, grid):
        self.past.append((second, grid))
        while len(self.past) > 1 and self.past[1][0] <= second - 60:
            self.past.popleft()
        if not self.lies(second):
            self.frozen = grid
            return grid
        return {"honest": grid, "frozen": self.frozen, "inverted": -grid, "x0.1": 0.1 * grid,
                "x0.5": 0.5 * grid, "offset": grid - 1000, "late": self.past[0][1],
                "phase": house / 3}[self.options.lie]

    def follow(self, show, truth):
        while True:
            second = self.second()
            house, battery = self.house.watts(max(second, 0)), self.battery_watts()
            shown = self.shown(second, house, house + battery)
            show(int(round(shown / 10)) * 10)
            if truth:
                print(f"{second:.1f},{house:.0f},{battery},{shown:.0f}", file=truth, flush=True)
            time.sleep(0.5 / self.options.scale)


async def serve(options):
    unit, registers = MAPS[options.map]
    values = [0] * 0x10000
    for address, block in registers(options.watts).items():
        values[address:address + len(block)] = block
    block = ModbusSequentialDataBlock(0, values)
    if options.battery_port:
        def show(watts):
            for address, content in registers(watts).items():
                block.values[address:address + len(content)] = content
        truth = open(options.truth, "w", encoding="utf-8") if options.truth else None
        threading.Thread(target=Connection(options).follow, args=(show, truth), daemon=True).start()
    await serve_tcp(unit, Unit(block, 4 if options.map == "eastron_sdm630" else 3))


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--map", choices=MAPS, required=True)
    parser.add_argument("--watts", type=int, default=0)
    parser.add_argument("--battery-port", type=int)
    parser.add_argument("--scale", type=float, default=1)
    parser.add_argument("--anchor-ns", type=int, default=0)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--lie", default="honest",
                        choices=("honest", "frozen", "inverted", "x0.1", "x0.5", "offset", "late",
                                 "phase"))
    parser.add_argument("--lie-from-s", type=float, default=0)
    parser.add_argument("--lie-each-s", type=float, default=0)
    parser.add_argument("--lie-for-s", type=float, default=0)
    parser.add_argument("--truth")
    asyncio.run(serve(parser.parse_args()))
