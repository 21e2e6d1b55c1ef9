#!/usr/bin/python3
"""An AlphaESS battery as pymodbus serves it: an independent implementation of Modbus.

    alphaess_peer.py --soc 435                 # TCP on a free port, which is printed
    alphaess_peer.py --soc 435 --serial DEVICE # RTU, 9600 8N1

The power follows the order at once; the state of charge stays as it is.
Registers by the vendor's manual V1.23; every write is printed as "write ADDRESS VALUE...". The
dispatch block starts as the vendor's stop command leaves it. Runs until it is killed.
"""
import argparse
import asyncio

from pymodbus.datastore import ModbusSequentialDataBlock

from pymodbus_server import Unit, serve_serial, serve_tcp

UNIT = 85
SOC, CAPACITY, BATTERY_POWER = 0x0102, 0x0119, 0x0126
CHARGE_POWER_MAX, DISCHARGE_POWER_MAX, WORK_MODE, DISPATCH = 0x012C, 0x012D, 0x0440, 0x0880
STOPPED = [0, 0, 32000, 0, 32000, 0, 0, 0, 90, 255, 0]
RATED_W = 4000


class Registers(ModbusSequentialDataBlock):
    """Holding registers that print writes and follow the dispatch block."""

    def __init__(self, soc):
        super().__init__(0, [0] * 0x1000)
        self.values[0x010D] = self.values[0x0110] = 200  # 0.1 degC
        self.values[SOC] = soc                    # 0.1 %
        self.values[CAPACITY] = 80                # 0.1 kWh
        self.values[CHARGE_POWER_MAX] = self.values[DISCHARGE_POWER_MAX] = RATED_W
        self.values[WORK_MODE] = 1
        self.values[DISPATCH:DISPATCH + len(STOPPED)] = STOPPED

    def flowing(self):
        """W, + discharge."""
        ordered = self.values[DISPATCH + 2] - 32000 if self.values[DISPATCH] == 1 else 0
        is_at_end = self.values[SOC] >= 1000 and ordered < 0 or self.values[SOC] <= 0 < ordered
        return 0 if is_at_end else ordered

    def setValues(self, address, values):
        super().setValues(address, values)
        print("write", address, *values, flush=True)
        self.values[BATTERY_POWER] = self.flowing() & 0xFFFF


async def serve(options):
    unit = Unit(Registers(options.soc))
    if options.serial:
        await serve_serial(UNIT, unit, options.serial)
    await serve_tcp(UNIT, unit)


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--soc", type=int, default=435)
    parser.add_argument("--serial")
    asyncio.run(serve(parser.parse_args()))
