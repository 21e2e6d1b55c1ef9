#!/usr/bin/python3
"""An AlphaESS battery as pymodbus serves it: an implementation of Modbus that shares nothing with bess.

    alphaess_peer.py --soc 435                 # TCP on a free port, which is printed
    alphaess_peer.py --soc 435 --serial DEVICE # RTU, 9600 8N1
    alphaess_peer.py --soc 435 --scale 60 --fault twice  # misbehaves from the controller's third order on; time runs 60 times as fast

Without --scale the state of charge stays as it is. Faults: reversed, twice, third, idle-discharge, soc-stuck, dead
(no power), other-master (orders 4.5 kW of discharge every 30 s), capacity (100 kWh), wrong-echo (of every write).
Registers by the vendor's manual V1.23; every write is printed as "write ADDRESS VALUE...". The dispatch block
starts as the vendor's stop command leaves it. Runs until it is killed.
"""
import argparse
import asyncio
import time

from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
from pymodbus.server.async_io import ModbusSerialServer, ModbusTcpServer
from pymodbus.transaction import ModbusRtuFramer, ModbusSocketFramer

UNIT = 85
SOC, CAPACITY, BATTERY_POWER = 0x0102, 0x0119, 0x0126
CHARGE_POWER_MAX, DISCHARGE_POWER_MAX, WORK_MODE, DISPATCH = 0x012C, 0x012D, 0x0440, 0x0880
STOPPED = [0, 0, 32000, 0, 32000, 0, 0, 0, 90, 255, 0]


CAPACITY_WH = 8000
HEALTHY_ORDERS = 5  # three of the sign check, two of the controller


class Registers(ModbusSequentialDataBlock):
    """Holding registers that print what is written and follow the dispatch block."""

    def __init__(self, soc, scale, fault):
        super().__init__(0, [0] * 0x1000)
        self.soc, self.scale, self.fault = soc, scale, fault
        self.power, self.since, self.orders, self.foreign = 0, time.monotonic(), 0, time.monotonic()
        self.values[SOC] = soc                    # 0.1 %
        self.values[0x010D] = self.values[0x0110] = 200  # 0.1 degC
        self.values[CAPACITY] = 80                # 0.1 kWh
        self.values[CHARGE_POWER_MAX] = self.values[DISCHARGE_POWER_MAX] = 4000
        self.values[WORK_MODE] = 1
        self.values[DISPATCH:DISPATCH + len(STOPPED)] = STOPPED

    def breaks(self, fault):
        return self.fault == fault and self.orders > HEALTHY_ORDERS

    def flowing(self):
        """- charge, + discharge, in W."""
        if self.values[DISPATCH] != 1:
            return 0
        power = self.values[DISPATCH + 2] - 32000
        if self.breaks("idle-discharge") and power == 0:
            return 3000
        gain = {"reversed": -1, "twice": 2, "third": 0.3, "dead": 0}
        return int(power * (gain[self.fault] if self.fault in gain and self.breaks(self.fault) else 1))

    def live(self):
        """Up to this moment: the charge that has flowed, and what is shown of it."""
        now = time.monotonic()
        self.soc -= self.power * (now - self.since) * self.scale / 3600 / CAPACITY_WH * 1000
        self.soc, self.since = min(max(self.soc, 0), 1000), now
        if self.breaks("other-master") and (now - self.foreign) * self.scale >= 30:
            self.foreign = now
            self.values[DISPATCH:DISPATCH + 9] = [1, 0, 36500, 0, 32000, 2, 25, 0, 300]
        self.power = self.flowing()
        self.values[BATTERY_POWER] = self.power & 0xFFFF
        if not self.breaks("soc-stuck"):
            self.values[SOC] = round(self.soc)
        self.values[CAPACITY] = 1000 if self.breaks("capacity") else 80

    def getValues(self, address, count=1):
        self.live()
        return super().getValues(address, count)

    def setValues(self, address, values):
        self.live()
        super().setValues(address, values)
        print("write", address, *values, flush=True)
        self.orders += 1
        self.live()


async def serve(options):
    registers = Registers(options.soc, options.scale, options.fault)
    unit = ModbusSlaveContext(hr=registers, zero_mode=True)
    context = ModbusServerContext(slaves={UNIT: unit}, single=False)
    if options.serial:
        server = ModbusSerialServer(context, ModbusRtuFramer, port=options.serial, baudrate=9600)
        await server.start()
        print("listening on", options.serial, flush=True)
        await server.serve_forever()
        await asyncio.Event().wait()

    def spoil(response):
        if registers.breaks("wrong-echo") and response.function_code == 16:
            response.address += 1
        return response, False

    server = ModbusTcpServer(context, ModbusSocketFramer, address=("127.0.0.1", 0), response_manipulator=spoil)
    serving = asyncio.create_task(server.serve_forever())
    await server.serving
    port = server.server.sockets[0].getsockname()[1]
    print(f"listening on 127.0.0.1:{port}", flush=True)
    await serving


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--soc", type=int, default=435)
    parser.add_argument("--serial")
    parser.add_argument("--scale", type=float, default=0)
    parser.add_argument("--fault", default="")
    asyncio.run(serve(parser.parse_args()))
