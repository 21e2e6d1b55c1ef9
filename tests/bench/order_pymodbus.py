# Peer of modbus-order: the same eleven registers written and read back through pymodbus.
#   /usr/bin/python3 order_pymodbus.py PORT COUNT     prints the median in microseconds
import statistics
import sys
import time

from pymodbus.client import ModbusTcpClient

BLOCK_ADDRESS = 0x0880
UNIT = 85


def main():
    port, count = int(sys.argv[1]), int(sys.argv[2])
    client = ModbusTcpClient("127.0.0.1", port=port)
    client.connect()
    times_us = []
    for i in range(count):
        power = 28000 if i % 2 == 0 else 36000
        block = [1, 0, power, 0, 32000, 2, 250, 0, 300, 255, 0]
        start = time.perf_counter()
        client.write_registers(BLOCK_ADDRESS, block, slave=UNIT)
        read_back = client.read_holding_registers(BLOCK_ADDRESS, count=len(block), slave=UNIT)
        times_us.append(1e6 * (time.perf_counter() - start))
        if read_back.isError() or read_back.registers != block:
            sys.exit("read back %s instead of %s" % (read_back, block))
    client.close()
    print(statistics.median(times_us))


main()
