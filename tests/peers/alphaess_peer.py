#!/usr/bin/python3
"""An AlphaESS battery as pymodbus serves it: an implementation of Modbus that shares nothing with bess.

    alphaess_peer.py --soc 435                 # TCP on a free port, which is printed
    alphaess_peer.py --soc 435 --serial DEVICE # RTU, 9600 8N1

Registers by the vendor's manual V1.23; every write is printed as "write ADDRESS VALUE...". The dispatch block
starts as the vendor's stop command leaves it. Runs until it is killed.
"""
import argparse
import asyncio

from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
from pymodbus.server.async_io import ModbusSerialServer, ModbusTcpServer
from pymodbus.transaction import ModbusRtuFramer, ModbusSocketFramer

UNIT = 85
SOC, CAPACITY, BATTERY_POWER = 0x0102, 0x0119, 0x0126
CHARGE_POWER_MAX, DISCHARGE_POWER_MAX, WORK_MODE, DISPATCH = 0x012C, 0x012D, 0x0440, 0x0880
STOPPED = [0, 0, 32000, 0, 32000, 0, 0, 0, 90, 255, 0]


class Registers(ModbusSequentialDataBlock):
    """Holding registers that print what is written and follow the dispatch block."""

    def __init__(self, soc):
        super().__init__(0, [0] * 0x1000)
        self.values[SOC] = soc                    # 0.1 %
        self.values[0x010D] = self.values[0x0110] = 200  # 0.1 degC
        self.values[CAPACITY] = 80                # 0.1 kWh
        self.values[CHARGE_POWER_MAX] = self.values[DISCHARGE_POWER_MAX] = 4000
        self.values[WORK_MODE] = 1
        self.values[DISPATCH:DISPATCH + len(STOPPED)] = STOPPED

    def setValues(self, address, values):
        super().setValues(address, values)
        print("write", address, *values, flush=True)
        running = self.values[DISPATCH] == 1
        power = self.values[DISPATCH + 2] - 32000 if running else 0  # - charge, + discharge
        self.values[BATTERY_POWER] = power & 0xFFFF


async def serve(options):
    unit = ModbusSlaveContext(hr=Registers(options.soc), zero_mode=True)
    context = ModbusServerContext(slaves={UNIT: unit}, single=False)
    if options.serial:
        server = ModbusSerialServer(context, ModbusRtuFramer, port=options.serial, baudrate=9600)
        await server.start()
        print("listening on", options.serial, flush=True)
        await server.serve_forever()
        await asyncio.Event().wait()
    server = ModbusTcpServer(context, ModbusSocketFramer, address=("127.0.0.1", 0))
    serving = asyncio.create_task(server.serve_forever())
    await server.serving
    port = server.server.sockets[0].getsockname()[1]
    print(f"listening on 127.0.0.1:{port}", flush=True)
    await serving


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--soc", type=int, default=435)
    parser.add_argument("--serial")
    asyncio.run(serve(parser.parse_args()))
