"""One unit on pymodbus's server, for pymodbus 3.0 (Debian 12) and 3.8 (Debian 13)."""
import asyncio

from pymodbus.datastore import ModbusServerContext, ModbusSlaveContext

try:
    from pymodbus.framer import FramerType
    from pymodbus.server import ModbusSerialServer, ModbusTcpServer
    TCP, RTU, IS_3_8 = FramerType.SOCKET, FramerType.RTU, True
except ImportError:
    from pymodbus.server.async_io import ModbusSerialServer, ModbusTcpServer
    from pymodbus.transaction import ModbusRtuFramer as RTU, ModbusSocketFramer as TCP
    IS_3_8 = False


class Unit(ModbusSlaveContext):
    """A block of registers from address 0; 3.8 has no zero mode."""

    def __init__(self, block, read_function=3):
        super().__init__()
        self.block, self.functions = block, (read_function, 6, 16)

    def validate(self, fc_as_hex, address, count=1):
        return fc_as_hex in self.functions and self.block.validate(address, count)

    def getValues(self, fc_as_hex, address, count=1):
        return self.block.getValues(address, count)

    def setValues(self, fc_as_hex, address, values):
        self.block.setValues(address, values)


async def serve_serial(unit_id, unit, device):
    context = ModbusServerContext(slaves={unit_id: unit}, single=False)
    server = ModbusSerialServer(context, port=device, baudrate=9600, framer=RTU)
    if not IS_3_8:
        await server.start()
    serving = asyncio.create_task(server.serve_forever())
    print("listening on", device, flush=True)
    await serving
    await asyncio.Event().wait()


async def serve_tcp(unit_id, unit):
    """On a free port."""
    context = ModbusServerContext(slaves={unit_id: unit}, single=False)
    if IS_3_8:
        server = ModbusTcpServer(context, address=("127.0.0.1", 0), framer=TCP)
        await server.serve_forever(background=True)
        sockets, serving = server.transport.sockets, server.serving
    else:
        server = ModbusTcpServer(context, address=("127.0.0.1", 0), framer=TCP)
        serving = asyncio.create_task(server.serve_forever())
        await server.serving
        sockets = server.server.sockets
    print(f"listening on 127.0.0.1:{sockets[0].getsockname()[1]}", flush=True)
    await serving
