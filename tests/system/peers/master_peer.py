#!/usr/bin/python3
"""A Modbus master that drives a simulated battery of any shipped map: pymodbus orders, pymodbus and
mbpoll look.

    master_peer.py --map alphaess --variant block --port 1502 --scale 60 --anchor-ns N --start-s UTC

Registers by the manufacturers' tables, by hand; independent of bess. Holds 3000 W of
charge, then of discharge, for 150 simulated seconds each, and prints

    soc TENTHS-OF-A-PERCENT
    order WATTS from UTC-S to UTC-S pymodbus WATTS mbpoll WATTS

With --day it orders a day on alphaess instead, each order for its own time. With --interfere it is
the second master: 30 s after every --every-th tick it writes stop, or another mode, instead
of another master's order, and prints the tick.
"""
import argparse
import re
import struct
import subprocess
import time

from pymodbus.client import ModbusTcpClient

RATED_W = 4000

def words(value):
    return [value >> 16 & 0xFFFF, value & 0xFFFF]

def signed(value, bits):
    return value - (1 << bits) if value >> (bits - 1) else value

class Master:
    """Writes and reads of one device, each by two independent programs."""

    def __init__(self, port):
        self.port, self.client = port, ModbusTcpClient("127.0.0.1", port=port, timeout=5)
        assert self.client.connect()

    def write(self, unit, address, *values):
        reply = self.client.write_registers(address, [v & 0xFFFF for v in values], slave=unit)
        assert not reply.isError(), (unit, address, reply)

    def read(self, unit, address, count=1, table=3):
        client = self.client
        read = client.read_holding_registers if table == 3 else client.read_input_registers
        reply = read(address, count=count, slave=unit)
        assert not reply.isError(), (unit, address, reply)
        return reply.registers

    def poll(self, unit, address, count=1, table=3):
        text = subprocess.run(
            ["/usr/bin/mbpoll", "-m", "tcp", "-p", str(self.port), "-a", str(unit), "-0", "-r",
             str(address), "-c",
             str(count), "-t", "4" if table == 3 else "3", "-1", "-o", "5", "127.0.0.1"],
            capture_output=True, text=True, check=True).stdout
        return [int(v) for v in re.findall(r"^\[\d+\]:\s+(\d+)", text, re.M)]

    def models(self):
        """Addresses of a SunSpec device's models."""
        assert self.read(1, 40000, 2) == [0x5375, 0x6E53]
        address, found = 40002, {}
        while True:
            model, length = self.read(1, address, 2)
            if model == 0xFFFF:
                return found
            found[model] = address
            address += 2 + length

class AlphaEss:
    def __init__(self, master, variant):
        self.master, self.variant = master, variant

    def order(self, watts, seconds=300):
        limit = 250 if watts > 0 else 25  # 0.4 %
        power = words(32000 - watts)
        write = self.master.write
        if self.variant == "block":
            write(85, 0x0880, 1, *power, 0, 32000, 2, limit, *words(seconds), 255, 0)
        elif self.variant == "ten_and_one":
            write(85, 0x0881, *power, 0, 32000, 2, limit, *words(seconds), 255, 0)
            write(85, 0x0880, 1)
        else:
            for address, values in ((0x0880, [1]), (0x0881, power), (0x0887, words(seconds)),
                                    (0x0886, [limit]),
                                    (0x0885, [2])):
                write(85, address, *values)

    def stop(self):
        self.master.write(85, 0x0880, 0)

    def other_mode(self):
        self.master.write(85, 0x0885, 1)

    def soc(self, read):
        return read(85, 0x0102)[0]

    def power(self, read):
        return -signed(read(85, 0x0126)[0], 16)

class Simulator:
    def __init__(self, master, _):
        self.master = master

    def order(self, watts):
        self.master.write(1, 100, 1, *words(watts), 10000 if watts > 0 else 1000, *words(300))

    def stop(self):
        self.master.write(1, 100, 0, 0, 0)

    def other_mode(self):
        self.master.write(1, 100, 0)

    def soc(self, read):
        return read(1, 10)[0] / 10

    def power(self, read):
        high, low = read(1, 11, 2)
        return signed(high << 16 | low, 32)

class SunSpec124:
    """callifo/fronius-modbus-control: a discharging limit below 0 charges (mode 2), and a charging
    limit below 0 with the same discharging limit discharges (mode 3); 10000 = 100 % of the
    rating."""

    def __init__(self, master, _):
        self.master, models = master, master.models()
        self.inverter, self.storage = models[103], models[124]
        self.mode, self.discharge = self.storage + 5, self.storage + 12
        self.revert = self.storage + 15
        self.grid = self.storage + 17

    def order(self, watts):
        share = abs(watts) * 10000 // RATED_W
        self.master.write(1, self.grid, 1)
        self.master.write(1, self.revert, 300)
        self.master.write(1, self.discharge, -share if watts > 0 else share)
        self.master.write(1, self.discharge + 1, 10000 if watts > 0 else -share)
        self.master.write(1, self.mode, 2 if watts > 0 else 3)

    def stop(self):
        self.master.write(1, self.mode, 0)

    def other_mode(self):
        """The charging limit instead of the other, or of both."""
        self.master.write(1, self.mode, 1)

    def soc(self, read):
        return read(1, self.storage + 8)[0] / 10

    def power(self, read):
        return -signed(read(1, self.inverter + 14)[0], 16)

class FroniusGen24(SunSpec124):
    def __init__(self, master, _):
        self.master = master
        self.mode, self.discharge, self.revert, self.grid = 40348, 40355, 40358, 40360

    def soc(self, read):
        return read(1, 40351)[0] / 10

    def power(self, read):
        return read(1, 40314)[0] - read(1, 40334)[0]

class SunSpec704:
    def __init__(self, master, _):
        self.master, models = master, master.models()
        self.control, self.battery = models[704], models[802]
        self.beats = 0

    def order(self, watts):
        self.beats += 1
        self.master.write(1, self.control + 23, 1, *words(-watts))
        self.master.write(1, self.control + 30, 0, *words(300))
        self.master.write(1, self.battery + 19, self.beats)
        self.master.write(1, self.control + 22, 1)

    def stop(self):
        self.master.write(1, self.control + 22, 0)

    def other_mode(self):
        self.master.write(1, self.control + 23, 0)

    def soc(self, read):
        return read(1, self.battery + 11)[0] / 10

    def power(self, read):
        return -signed(read(1, self.battery + 47)[0], 16)

class VictronEss3:
    def __init__(self, master, variant):
        self.master, self.phases = master, 3 if variant == "three_phase" else 1

    def order(self, watts):
        self.master.write(100, 2902, 3)
        self.master.write(228, 37, watts // self.phases, 0, 0)
        if self.phases == 3:
            self.master.write(228, 40, watts // 3, watts // 3)

    def stop(self):
        self.master.write(228, 37, 0)

    def other_mode(self):
        self.master.write(100, 2902, 1)

    def soc(self, read):
        return read(100, 843)[0] * 10

    def power(self, read):
        return signed(read(100, 842)[0], 16)

class SungrowSh:
    def __init__(self, master, variant):
        self.master, self.mode = master, 2 if variant == "forced" else 3

    def order(self, watts):
        self.master.write(1, 13079, 60)
        self.master.write(1, 13051, abs(watts))
        self.master.write(1, 13050, 0xAA if watts > 0 else 0xBB)
        self.master.write(1, 13049, self.mode)

    def stop(self):
        self.master.write(1, 13050, 0xCC)

    def other_mode(self):
        self.master.write(1, 13049, 0)

    def soc(self, read):
        return read(1, 13022, table=4)[0]

    def power(self, read):
        low, high = read(1, 5213, 2, table=4)
        return -signed(high << 16 | low, 32)

class HuaweiLuna:
    def __init__(self, master, _):
        self.master = master

    def order(self, watts):
        self.master.write(1, 47087, 1)
        self.master.write(1, 47247 if watts > 0 else 47249, *words(abs(watts)))
        self.master.write(1, 47083, 5)  # minutes
        self.master.write(1, 47246, 0)
        self.master.write(1, 47100, 1 if watts > 0 else 2)

    def stop(self):
        self.master.write(1, 47100, 0)

    def other_mode(self):
        self.master.write(1, 47100, 3 - self.master.read(1, 47100)[0] or 1)

    def soc(self, read):
        return read(1, 37760)[0]

    def power(self, read):
        high, low = read(1, 37765, 2)
        return signed(high << 16 | low, 32)

class Sma:
    def __init__(self, master, variant):
        self.master, self.variant = master, variant

    def order(self, watts):
        if self.variant == "setpoint":
            return self.master.write(3, 40149, *words(-watts), *words(802), 0, 0)
        charge, discharge = max(watts, 0), max(-watts, 0)
        self.master.write(3, 40236, *words(2289 if watts > 0 else 2290))
        for address, value in ((40793, charge), (40795, charge), (40797, discharge),
                               (40799, discharge), (40801, 0)):
            self.master.write(3, address, *words(value))

    def stop(self):
        if self.variant == "setpoint":
            return self.master.write(3, 40151, *words(803))
        self.master.write(3, 40236, *words(2424))

    def other_mode(self):
        if self.variant == "setpoint":
            return self.master.write(3, 40149, *words(1500))
        self.master.write(3, 40236, *words(2290))

    def soc(self, read):
        return read(3, 30845, 2)[1] * 10

    def power(self, read):
        charge, discharge = read(3, 31393, 2, table=4), read(3, 31395, 2, table=4)
        return (charge[0] << 16 | charge[1]) - (discharge[0] << 16 | discharge[1])

def low_first_float(value):
    high, low = struct.unpack(">HH", struct.pack(">f", value))
    return [low, high]

def from_low_first_float(raw):
    return struct.unpack(">f", struct.pack(">HH", raw[1], raw[0]))[0]

class SolarEdge:
    """Tables of solaredge-modbus-multi (const.py) and openWB (bat.py)."""

    def __init__(self, master, _):
        self.master = master

    def order(self, watts):
        self.master.write(1, 57348, 4)
        self.master.write(1, 57354, 7)
        self.master.write(1, 57355, 300, 0)
        self.master.write(1, 57358 if watts > 0 else 57360, *low_first_float(abs(watts)))
        self.master.write(1, 57357, 3 if watts > 0 else 4)

    def stop(self):
        self.master.write(1, 57357, 7)

    def other_mode(self):
        self.master.write(1, 57348, 1)

    def soc(self, read):
        return round(from_low_first_float(read(1, 57732, 2)) * 10)

    def power(self, read):
        return from_low_first_float(read(1, 57716, 2))

class GoodWe:
    """OpenEMS: EMS mode 11 charges, 12 discharges, mode and power in one write."""

    def __init__(self, master, variant):
        self.master, self.is_new = master, variant == "registers_42000"

    def write(self, mode, watts):
        if self.is_new:
            return self.master.write(247, 42000, mode, *words(watts))
        self.master.write(247, 47511, mode, watts)

    def order(self, watts):
        self.write(11 if watts > 0 else 12, abs(watts))

    def stop(self):
        self.write(1, 0)

    def other_mode(self):
        self.write(8, 0)

    def soc(self, read):
        return read(247, 37007)[0] * 10

    def power(self, read):
        high, low = read(247, 35182, 2)
        return -signed(high << 16 | low, 32)

class Kostal:
    """Kostal's interface description: 1034 is a float, low word first, below 0 charges."""

    def __init__(self, master, _):
        self.master = master

    def order(self, watts):
        self.master.write(71, 1034, *low_first_float(-watts))

    def stop(self):
        self.order(0)

    def other_mode(self):
        self.order(-1500)

    def soc(self, read):
        return read(71, 514)[0] * 10

    def power(self, read):
        return -signed(read(71, 582)[0], 16)

class Marstek:
    """openWB: function 6 only; evcc: other registers for the third generation."""

    def __init__(self, master, variant):
        self.master, self.is_new = master, variant == "gen_3"

    def write(self, address, value):
        reply = self.master.client.write_register(address, value, slave=1)
        assert not reply.isError(), (address, reply)

    def order(self, watts):
        self.write(42000, 0x55AA)
        self.write(42020 if watts > 0 else 42021, abs(watts))
        self.write(42010, 1 if watts > 0 else 2)

    def stop(self):
        self.write(42010, 0)

    def other_mode(self):
        self.write(42010, 3 - self.master.read(1, 42010)[0])

    def soc(self, read):
        return read(1, 34002)[0] if self.is_new else read(1, 32104)[0] * 10

    def power(self, read):
        if self.is_new:
            return -signed(read(1, 30006)[0], 16)
        high, low = read(1, 32202, 2)
        return -signed(high << 16 | low, 32)

DEVICES = {"alphaess": AlphaEss, "simulator": Simulator, "sunspec_124": SunSpec124,
           "fronius_gen24": FroniusGen24,
           "sunspec_704": SunSpec704, "victron_ess3": VictronEss3, "sungrow_sh": SungrowSh,
           "huawei_luna2000": HuaweiLuna, "sma": Sma, "solaredge": SolarEdge,
           "goodwe_et": GoodWe, "kostal_plenticore": Kostal, "marstek_venus": Marstek}
DAY = ((1, 2000, 2), (5, -1500, 2), (9, 4000, 1), (13, -3600, 1))  # hour, W, hours

def drive(master, device, options, now):
    print("soc", device.soc(master.read), flush=True)
    assert device.soc(master.read) == device.soc(master.poll)
    for watts in (3000, -3000):
        device.order(watts)
        begin = now()
        while now() < begin + 150:
            device.order(watts)  # a watchdog may be as short as a minute
            time.sleep(5 / options.scale)
        seen = device.power(master.read), device.power(master.poll)
        device.order(watts)
        print("order", watts, "from", begin, "to", now(), "pymodbus", seen[0], "mbpoll", seen[1],
              flush=True)

def interfere(device, options, now):
    act = device.stop if options.interfere == "stop" else device.other_mode
    tick = int(now()) // 120 + 1
    while True:
        while now() < tick * 120 + 30:
            time.sleep(2 / options.scale)
        act()
        print("tick", tick * 120, flush=True)
        tick += options.every

if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--map", choices=DEVICES, required=True)
    parser.add_argument("--variant", default="")
    parser.add_argument("--port", type=int, required=True)
    parser.add_argument("--scale", type=int, required=True)
    parser.add_argument("--anchor-ns", type=int, required=True)
    parser.add_argument("--start-s", type=int, required=True)
    parser.add_argument("--interfere", choices=["stop", "mode"])
    parser.add_argument("--every", type=int, default=1)
    chosen = parser.parse_args()

    def utc_s():
        return chosen.start_s + (time.monotonic_ns() - chosen.anchor_ns) / 1e9 * chosen.scale

    bus = Master(chosen.port)
    battery = DEVICES[chosen.map](bus, chosen.variant)
    if chosen.interfere:
        interfere(battery, chosen, utc_s)
    else:
        drive(bus, battery, chosen, utc_s)
