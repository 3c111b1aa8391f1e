"""One simulator of somebody else's for one of our drivers: simulators.py SIMULATOR WORDS. Prints where it answers, or that
it is missing, and ends with its standard input."""

import asyncio
import os
import pty
import socket
import sys
import threading
import tty


def terminal():
    """Both ends of a serial cable: the instrument's, and the name of the driver's."""
    instrument, driver = pty.openpty()
    for end in (instrument, driver):
        tty.setraw(end)
    return instrument, os.ttyname(driver)


def told(address):
    print(address, flush=True)


def until_told_to_end():
    sys.stdin.read()
    os._exit(0)


def pymodbus(module):
    """An ADAM-4015 in the registers of pymodbus' own RTU server: the name of the module, a Pt100 code for each channel."""
    from pymodbus.server import ModbusSerialServer
    from pymodbus.simulator import DataType, SimData, SimDevice

    def pump(source, sink):
        while True:
            os.write(sink, os.read(source, 256))

    # pymodbus opens a port as the driver does: a cable has two ends.
    (ours, server), (theirs, driver) = terminal(), terminal()
    for ends in ((ours, theirs), (theirs, ours)):
        threading.Thread(target=pump, args=ends, daemon=True).start()
    block = lambda address, values: SimData(address, values=values, datatype=DataType.REGISTERS)
    registers = [
        # −50 to 150 °C, 0 to 100 °C, −200 to 200 °C, a broken wire, and twice what nobody asks for.
        block(0, [0x8000, 0x4000, 0xC000, 0xFFFF, 1, 1]),
        block(200, [0x20, 0x21, 0x24, 0x20, 0x20, 0x20]),
    ]
    if module != "none":
        registers.append(block(210, [int(module, 16), 0]))

    async def serve():
        serving = ModbusSerialServer(SimDevice(1, registers), port=server, baudrate=9600)
        await serving.serve_forever(background=True)
        told(driver)
        await asyncio.Event().wait()

    asyncio.run(serve())


def lines(simulator, transport):
    """Lines to a simulator that takes them one by one, over a cable or a socket."""
    if transport == "tcp":
        listener = socket.create_server(("127.0.0.1", 0))
        told("tcp://127.0.0.1:%d" % listener.getsockname()[1])
        channel = listener.accept()[0]
        channel.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        file = channel.fileno()
    else:
        file, address = terminal()
        told(address)
    waiting = b""
    while True:
        got = os.read(file, 4096)
        if not got:
            return
        *whole, waiting = (waiting + got).split(b"\n")
        for line in whole:
            reply = simulator.handle(line.decode())
            if reply is not None:
                os.write(file, reply.encode() + b"\n")


def rigol(transport):
    """labmcp's DP821 with a brake's coil on channel 1. It lacks two headers of the programming guide, which are told here from its
    own state."""
    from labmcp_bench_psu.simulator import RigolSimulator

    class WithRegisters(RigolSimulator):
        def command(self, key, arg):
            if key == "SYST:REM":
                return None
            if key == "STAT:QUES:INST:ISUM1:COND?":
                output = self.out(1)
                output.update()
                held = {"CC": 1, "CV": 2}[output.solve()[2]] if output.on else 0
                return str(held | 4 * output.ovp_trip | 8 * output.ocp_trip)
            return super().command(key, arg)

    lines(WithRegisters("DP821", loads=(100.0, 100.0)), transport)


def multimeter(transport):
    """labmcp's multimeter of the standard's own commands, which measures the supply that it is built together with."""
    from labmcp_scpi.simulator import DMMPowerSupplySimulator

    simulator = DMMPowerSupplySimulator()
    volts = float(sys.argv[3])
    simulator.handle(f"CURR 1;VOLT {volts};OUTP ON")
    lines(simulator, transport)


def main():
    simulate, word = {"pymodbus": pymodbus, "rigol": rigol, "multimeter": multimeter}[sys.argv[1]], sys.argv[2]
    threading.Thread(target=until_told_to_end, daemon=True).start()
    try:
        simulate(word)
    except ModuleNotFoundError as missing:
        told(missing)


if __name__ == "__main__":
    main()
