#!/usr/bin/python3
"""A meter as pymodbus serves it: an independent implementation of Modbus.

    meter_peer.py --map eastron_sdm630 --watts -1230      # TCP on a free port, which is printed

Registers by the manufacturers' tables, by hand; watts are import, a multiple of 10. Runs until
it is killed.
"""
import argparse
import asyncio
import struct
import time

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


async def serve(options):
    unit, registers = MAPS[options.map]
    values = [0] * 0x10000
    for address, block in registers(options.watts).items():
        values[address:address + len(block)] = block
    block = ModbusSequentialDataBlock(0, values)
    await serve_tcp(unit, Unit(block, 4 if options.map == "eastron_sdm630" else 3))


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--map", choices=MAPS, required=True)
    parser.add_argument("--watts", type=int, default=0)
    asyncio.run(serve(parser.parse_args()))
