"""One client of somebody else's on one instrument of the mock bench: clients.py CLIENT ADDRESS. Ends with 77 where it is missing."""

import sys
import time

MISSING = 77


def tcp(address):
    host, port = address.removeprefix("tcp://").split(":")
    return host, int(port)


def refused(work, *words):
    """What `work` is refused with has to hold all the words."""
    try:
        done = work()
    except Exception as error:
        said = str(error).lower()
        assert all(word in said for word in words), f"{error!r} says nothing of {words}"
        return
    raise AssertionError(f"was not refused: {done!r}")


def pipython(address):
    from pipython import GCSDevice, pitools
    from pipython.pidevice.interfaces.piserial import PISerial
    from pipython.pidevice.interfaces.pisocket import PISocket

    gateway = PISocket(*tcp(address)) if address.startswith("tcp://") else PISerial(address, 115200)
    with gateway as link:
        stage = GCSDevice(gateway=link)
        assert "C-887" in stage.qIDN() and stage.axes == ["X", "Y", "Z", "U", "V", "W"]
        assert not any(stage.qFRF().values())
        refused(lambda: stage.MOV("X", 0.1), "5")
        stage.SVO(stage.axes, [True] * len(stage.axes))
        stage.FRF()
        pitools.waitonreferencing(stage, timeout=60)
        assert all(stage.qFRF().values())
        assert stage.qTMN()["X"] < -1 and stage.qTMX()["X"] > 1
        target = {"X": 0.5, "Y": -0.25, "U": 0.2}
        stage.MOV(target)
        pitools.waitontarget(stage, timeout=20)
        there = stage.qPOS()
        assert all(abs(there[axis] - value) < 1e-3 for axis, value in target.items()), there
        assert all(stage.qONT().values())
        refused(lambda: stage.MOV("X", 500), "7")
        assert abs(stage.qPOS("X")["X"] - 0.5) < 1e-3, "nothing has moved"
        stage.MVR("X", 0.1)
        pitools.waitontarget(stage, timeout=20)
        assert abs(stage.qPOS("X")["X"] - 0.6) < 1e-3
        stage.STP(noraise=True)
        assert stage.qERR() in (0, 10) and stage.qERR() == 0


def lorenz(address):
    from lorenztelegram.telegram import LorenzConnector

    with LorenzConnector(address, timeout=0.2) as sensor:
        assert sensor.hello() and sensor.get_raw() and sensor.get_status() is not None
        sensor.read_config()
        assert len(list(sensor.config)) >= 6, sensor.config
        sensor.start_streaming(1000, 0, "C")
        indices, end = [], time.time() + 1.5
        while time.time() < end:
            index, value = sensor.streaming_recv_poll()
            if value is not None:
                indices.append(index)
        sensor.stop_streaming()
        assert len(indices) > 500, len(indices)
        gaps = [pair for pair in zip(indices, indices[1:]) if (pair[1] - pair[0]) % 256 != 1]
        assert not gaps, gaps
        time.sleep(0.2)
        sensor.ser.reset_input_buffer()
        assert sensor.hello(), "it answers again"


def celsius(register):
    """Type code 23h: 0 to 400 °C."""
    return register / 65535 * 400


def minimalmodbus(address):
    import minimalmodbus

    module = minimalmodbus.Instrument(address, 1)
    module.serial.baudrate, module.serial.timeout = 9600, 1
    assert module.read_registers(210, 1) == [0x4015]
    assert all(code == 0x23 for code in module.read_registers(200, 6))
    assert all(15 < celsius(value) < 35 for value in module.read_registers(0, 6))
    refused(lambda: module.read_register(999), "address")
    refused(lambda: module.read_bit(0), "function")


def pymodbus(address):
    from pymodbus import FramerType
    from pymodbus.client import ModbusSerialClient, ModbusTcpClient

    if address.startswith("tcp://"):
        host, port = tcp(address)
        client = ModbusTcpClient(host, port=port, framer=FramerType.RTU, timeout=1)
    else:
        client = ModbusSerialClient(address, baudrate=9600, timeout=1)
    assert client.connect()
    values = client.read_holding_registers(0, count=6, device_id=1).registers
    assert len(values) == 6 and all(15 < celsius(value) < 35 for value in values), values
    assert client.read_holding_registers(500, count=1, device_id=1).isError()
    client.close()


def visa(address, line_end):
    import pyvisa

    manager = pyvisa.ResourceManager("@py")
    ends = {"read_termination": "\n", "write_termination": line_end, "timeout": 3000}
    if address.startswith("tcp://"):
        host, port = tcp(address)
        return manager.open_resource(f"TCPIP0::{host}::{port}::SOCKET", **ends)
    return manager.open_resource(f"ASRL{address}::INSTR", baud_rate=115200, **ends)


def pymeasure_hmp4040(address):
    from pymeasure.instruments.rohdeschwarz import HMP4040

    host, port = tcp(address)
    ends = {"read_termination": "\n", "write_termination": "\n", "timeout": 3000}
    supply = HMP4040(f"TCPIP0::{host}::{port}::SOCKET", visa_library="@py", **ends)
    assert "HMP4040" in supply.id
    supply.clear()
    supply.reset()
    supply.selected_channel = 1
    supply.voltage, supply.current = 12, 0.1
    assert (supply.voltage, supply.current) == (12, 0.1)
    supply.selected_channel_active, supply.output_enabled = True, True
    time.sleep(1.5)
    assert abs(supply.measured_current - 0.1) < 5e-3, supply.measured_current
    assert 3 < supply.measured_voltage < 8, supply.measured_voltage
    supply.voltage_step = 0.5
    supply.step_voltage_up()
    assert supply.voltage == 12.5
    supply.output_enabled = False
    assert not supply.output_enabled


def pymeasure_kepco(address):
    from pymeasure.instruments.kepco import KepcoBOP3612

    host, port = tcp(address)
    supply = KepcoBOP3612(f"TCPIP0::{host}::{port}::SOCKET", visa_library="@py", timeout=3000)
    assert supply.id.startswith("KEPCO,BOP ")
    supply.write("SYST:REM 1")
    supply.operating_mode = "CURR"
    supply.voltage_setpoint, supply.current_setpoint, supply.output_enabled = 30, 0.25, True
    assert (supply.operating_mode, supply.voltage_setpoint, supply.current_setpoint) == ("CURR", 30, 0.25)
    time.sleep(1.5)
    assert abs(supply.current - 0.25) < 5e-3 and 10 < supply.voltage < 16, (supply.current, supply.voltage)
    supply.output_enabled = False
    assert not supply.output_enabled


def pyvisa_dp821a(address):
    supply = visa(address, "\n" if address.startswith("tcp://") else "\r\n")
    assert supply.query("*IDN?").startswith("RIGOL TECHNOLOGIES,DP821A,")
    supply.write(":APPL CH1,45.0,0.25")
    assert supply.query(":APPL? CH1") == "CH1:60V/1A,45.000,0.2500"
    supply.write(":OUTP CH1,ON")
    time.sleep(1.0)
    assert supply.query(":OUTP:CVCC? CH1") == "CC"
    volt, ampere, watt = (float(word) for word in supply.query(":MEAS:ALL? CH1").split(","))
    assert abs(ampere - 0.25) < 2e-3 and abs(volt * ampere - watt) < 0.05, (volt, ampere, watt)
    supply.write(":SOUR1:CURR 7")
    assert supply.query(":SYST:ERR?").startswith("-222") and supply.query(":SYST:ERR?") == '0,"No error"'
    assert supply.query(":SOUR1:CURR?") == "0.2500", "what is refused is not taken"
    supply.write(":OUTP CH1,OFF")
    assert supply.query(":OUTP? CH1") == "OFF"
    supply.close()


def qcodes_dp821(address):
    from qcodes.instrument_drivers.rigol import RigolDP821

    host, port = tcp(address)
    supply = RigolDP821("supply", f"TCPIP0::{host}::{port}::SOCKET", visalib="@py", terminator="\n")
    supply.ch1.set_voltage(40)
    supply.ch1.set_current(0.2)
    assert (supply.ch1.set_voltage(), supply.ch1.set_current()) == (40, 0.2)
    supply.ch1.state("on")
    time.sleep(1.0)
    assert abs(supply.ch1.current() - 0.2) < 2e-3, supply.ch1.current()
    supply.ch1.state("off")
    supply.close()


CLIENTS = [pipython, lorenz, minimalmodbus, pymodbus, pymeasure_hmp4040, pymeasure_kepco, pyvisa_dp821a, qcodes_dp821]

if __name__ == "__main__":
    wanted, address = sys.argv[1:]
    try:
        {client.__name__: client for client in CLIENTS}[wanted](address)
    except ModuleNotFoundError as missing:
        print(f"{missing.name} is not installed")
        sys.exit(MISSING)
