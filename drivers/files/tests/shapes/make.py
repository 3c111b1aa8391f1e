"""Writes one recording as the tools of other laboratories write it, one file a shape: python3 make.py.

pandas, polars and NumPy write their own files; the others are written as the named programs write them. The recording is
that of `truth` in main.rs. Needs pandas, polars, NumPy and pyarrow.
"""

import gzip
import math
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pandas as pd
import polars as pl

OUT = Path(__file__).parent / "written"
ROWS = 40
NAMES = ["time_s", "motor_position_rad", "motor_velocity_rad_s", "motor_current_a"]
TIME = [round(0.005 * i, 3) for i in range(ROWS)]
POSITION = [round(2.5 * math.sin(0.2 * i), 5) for i in range(ROWS)]
VELOCITY = [round(100 * math.cos(0.2 * i), 4) for i in range(ROWS)]
CURRENT = [round(1.2 + 0.8 * math.cos(0.2 * i), 4) for i in range(ROWS)]
ROW = list(zip(TIME, POSITION, VELOCITY, CURRENT))
BEGIN = datetime(2026, 1, 2, 10, 0, 0)
STAMPS = [BEGIN + timedelta(seconds=t) for t in TIME]


def text(name, content, encoding="utf-8"):
    (OUT / name).write_bytes(content.encode(encoding))


def rows(form, separator=",", end="\n", comma=False, data=ROW):
    lines = [separator.join(form % value if isinstance(value, float) else str(value) for value in row) for row in data]
    lines = [line.replace(".", ",") for line in lines] if comma else lines
    return "".join(line + end for line in lines)


def names(separator=",", end="\n", of=NAMES):
    return separator.join(of) + end


def frames():
    frame = pd.DataFrame(dict(zip(NAMES, (TIME, POSITION, VELOCITY, CURRENT))))
    frame.to_csv(OUT / "pandas_index.csv")
    frame.to_csv(OUT / "pandas_plain.csv", index=False)
    frame.to_csv(OUT / "pandas_german.csv", index=False, sep=";", decimal=",")
    frame.to_csv(OUT / "pandas_tabs.tsv", index=False, sep="\t")
    frame.to_csv(OUT / "pandas_exponents.csv", index=False, float_format="%.6e")
    frame.to_csv(OUT / "pandas_quoted.csv", index=False, quoting=1)
    frame.to_csv(OUT / "pandas_packed.csv.gz", index=False)
    frame.to_csv(OUT / "pandas_utf16.csv", index=False, encoding="utf-16")
    frame.to_csv(OUT / "pandas_mark.csv", index=False, encoding="utf-8-sig")
    frame.to_csv(OUT / "pandas_crlf.csv", index=False, lineterminator="\r\n")
    frame.assign(valid=[i % 3 == 0 for i in range(ROWS)]).to_csv(OUT / "pandas_bool.csv", index=False)
    stamped = frame.rename(columns={"time_s": "timestamp"}).assign(timestamp=STAMPS)
    stamped.to_csv(OUT / "pandas_datetime.csv", index=False)
    stamped.set_index("timestamp").to_csv(OUT / "pandas_datetime_index.csv")
    zoned = stamped.assign(timestamp=pd.to_datetime(stamped["timestamp"]).dt.tz_localize("Europe/Berlin"))
    zoned.to_csv(OUT / "pandas_zoned.csv", index=False)
    spent = frame.assign(time_s=pd.to_timedelta(frame["time_s"], unit="s")).rename(columns={"time_s": "elapsed"})
    spent.to_csv(OUT / "pandas_timedelta.csv", index=False)
    gaps = frame.assign(oil_temperature=[20.0 if i % 4 == 0 else None for i in range(ROWS)], remark="warm")
    gaps.to_csv(OUT / "pandas_gaps.csv", na_rep="NaN")
    stamped.to_parquet(OUT / "pandas_datetime.parquet")
    polar = pl.DataFrame(dict(zip(NAMES, (TIME, POSITION, VELOCITY, CURRENT))))
    polar.write_csv(OUT / "polars_plain.csv")
    polar.write_csv(OUT / "polars_semicolon.csv", separator=";", decimal_comma=True)
    polar.with_columns(on=pl.Series([i > 5 for i in range(ROWS)])).write_csv(OUT / "polars_bool.csv")
    clocked = polar.rename({"time_s": "Time"}).with_columns(Time=pl.Series(STAMPS))
    clocked.write_csv(OUT / "polars_datetime.csv")
    clocked.write_parquet(OUT / "polars_datetime.parquet")
    polar.write_ipc(OUT / "polars.arrow")
    matrix = np.array(ROW)
    np.savetxt(OUT / "numpy_default.txt", matrix, header=" ".join(NAMES))
    np.savetxt(OUT / "numpy_commas.csv", matrix, delimiter=",", header=",".join(NAMES), comments="", fmt="%.6f")
    np.savetxt(OUT / "numpy_columns.dat", matrix, fmt="%12.5f", header="  ".join(NAMES), comments="")
    np.savetxt(OUT / "numpy_bare.txt", matrix, fmt="%.5f")


def spreadsheets():
    text("calc_german.csv", names(";") + rows("%.5f", ";", comma=True))
    text("calc_units_latin1.csv", names(";", of=["Zeit [s]", "Motor Position [°]", "Motor Velocity [rad/s]", "Motor Current [A]"])
         + rows("%.5f", ";", comma=True, data=[(t, round(math.degrees(p), 6), v, c) for t, p, v, c in ROW]), "latin-1")
    text("excel_sep.csv", "sep=;\r\n" + names(";", "\r\n") + rows("%.5f", ";", "\r\n"))
    text("excel_unicode.txt", names("\t", "\r\n") + rows("%.5f", "\t", "\r\n", comma=True), "utf-16")
    thousands = [(t, p, v, f"{c * 1000:,.1f}") for t, p, v, c in ROW]
    german = [(t, p, v, c.translate(str.maketrans(",.", ".,"))) for t, p, v, c in thousands]
    text("excel_thousands_german.csv", names(";", of=NAMES[:3] + ["Motor Current [mA]"])
         + "".join(";".join([("%.5f" % x).replace(".", ",") for x in row[:3]] + [row[3]]) + "\n" for row in german))
    text("excel_thousands.csv", names(",", of=NAMES[:3] + ["Motor Current (mA)"])
         + "".join(",".join([f"{x:.5f}" for x in row[:3]] + [f'"{row[3]}"']) + "\n" for row in thousands))
    days = [(46024.0 + (36000 + t) / 86400, p, v, c) for t, p, v, c in ROW]
    text("excel_days.csv", names(of=["Time"] + NAMES[1:]) + "".join("%.12f,%s,%s,%s\n" % row for row in days))
    text("calc_dates.csv", names(";", of=["Zeitstempel"] + NAMES[1:])
         + "".join(f"{s:%d.%m.%Y %H:%M:%S},{s.microsecond // 1000:03d};" + ";".join(str(x).replace(".", ",") for x in row[1:]) + "\n" for s, row in zip(STAMPS, ROW)))
    text("calc_french.csv", names(";") + "".join(";".join(f"{x:,.3f}".replace(",", "\u202f").replace(".", ",") if i else f"{x:.3f}".replace(".", ",") for i, x in enumerate((t, p, v, c))) + "\n" for t, p, v, c in ROW))


def programs():
    text("matlab_fprintf.csv", names(end="") + ",\n" + "".join("".join("%f," % x for x in row) + "\n" for row in ROW))
    text("matlab_fprintf_tabs.txt", names("\t", "\t\n") + "".join("".join("%f\t" % x for x in row) + "\n" for row in ROW))
    text("matlab_fprintf_rows_only.csv", names() + "".join("".join("%f," % x for x in row) + "\n" for row in ROW))
    text("matlab_writetable.csv", names() + "".join(",".join("%.15g" % x for x in row) + "\n" for row in ROW))
    text("matlab_title.txt", "Measurement of joint 3\n" + names("\t") + rows("%.5f", "\t"))
    text("matlab_bare.csv", rows("%.5f"))
    text("r_write_csv.csv", '"",' + ",".join(f'"{n}"' for n in NAMES) + "\n" + "".join(f'"{i + 1}",' + ",".join(str(x) for x in row) + "\n" for i, row in enumerate(ROW)))
    text("r_write_table.txt", " ".join(f'"{n}"' for n in NAMES) + "\n" + "".join(f'"{i + 1}" ' + " ".join(str(x) for x in row) + "\n" for i, row in enumerate(ROW)))
    text("julia_csv.csv", names() + rows("%r"))
    text("sqlite_bars.txt", names("|") + rows("%r", "|"))
    text("fortran.dat", "# run 12\n" + "# " + "  ".join(NAMES) + "\n" + rows("%16.8E", ""))
    text("gnuplot.dat", "# " + " ".join(NAMES) + "\n# s rad rad/s A\n" + rows("%g", " "))
    text("csv_comments.csv", "# bench: 3\n# operator: N, warm\n" + names() + rows("%.5f"))
    text("csv_units_line.csv", names() + "s,rad,rad/s,A\n" + rows("%.5f"))
    text("csv_cr.csv", (names() + rows("%.5f")).replace("\n", "\r"))
    text("csv_cut_off.csv", (names() + rows("%.5f"))[:-30])


LVM = """LabVIEW Measurement	
Writer_Version	2
Reader_Version	2
Separator	Tab
Decimal_Separator	%s
Multi_Headings	No
X_Columns	One
Time_Pref	Relative
Operator	N
Date	2026/01/02
Time	10:00:00.0
***End_of_Header***	
	
Channels	3			
Samples	40	40	40	
Date	2026/01/02	2026/01/02	2026/01/02	
Time	10:00:00.0	10:00:00.0	10:00:00.0	
X_Dimension	Time	Time	Time	
X0	0.0000000000000000E+0	0.0000000000000000E+0	0.0000000000000000E+0	
Delta_X	0.005000	0.005000	0.005000	
***End_of_Header***				
X_Value	%s	Comment
"""


def instruments():
    tail = "\t".join(NAMES[1:])
    text("labview.lvm", LVM % (".", tail) + rows("%.6f", "\t"))
    text("labview_comma.lvm", (LVM % (",", tail)) + rows("%.6f", "\t", comma=True))
    text("keysight.csv", "x-axis," + ",".join(NAMES[1:]) + "\nsecond,rad,rad/s,A\n" + rows("%+.6E"))
    text("tektronix.csv", "Model,MSO24\nFirmware Version,2.0\n\nWaveform Type,ANALOG\nHorizontal Units,s\nSample Interval,0.005\nRecord Length,40\n\n\n"
         + names(of=["TIME"] + NAMES[1:]) + rows("%.6E"))
    text("siglent.csv", "Record Length,Analog:40\nSample Interval,0.005\nVertical Units,A,,,\nModel Number,SDS\n" + names(of=["Second"] + NAMES[1:]) + rows("%.6f"))
    text("picoscope.csv", names(of=["Time", "motor_position", "motor_velocity", "motor_current"]) + "(ms),(rad),(rad/s),(mA)\n\n"
         + rows("%.5f", data=[(t * 1e3, p, v, c * 1e3) for t, p, v, c in ROW]))
    text("catman.asc", "HBM_CATMAN_DATAFILE_40\t5.0\nCreated\t02.01.2026\n\n" + "\t".join(["Time  1 - default sample rate [s]", "Motor Position [deg]", "Motor Velocity [rpm]", "Motor Current [A]"]).replace("Time  1 - default sample rate", "Time")
         + "\n" + rows("%.7f", "\t", data=[(t, math.degrees(p), v * 60 / (2 * math.pi), c) for t, p, v, c in ROW]))
    text("motec.csv", '"Format","MoTeC CSV File",,\n"Venue","bench 3",,\n"Sample Rate","200.000","Hz",\n\n' + ",".join(f'"{n}"' for n in ["Time"] + NAMES[1:]) + '\n"s","rad","rad/s","A"\n\n'
         + "".join(",".join(f'"{x:.5f}"' for x in row) + "\n" for row in ROW))
    text("canape.csv", names(";") + "s;rad;rad/s;A\n" + rows("%.5f", ";"))
    text("twincat.csv", "Name;joint\nFile;C:\\a.svdx\nStart;02.01.2026 10:00\n\n" + names(";", of=["Time [ms]", "Motor Position [rad]", "Motor Velocity [rad/s]", "Motor Current [A]"])
         + rows("%.5f", ";", data=[(t * 1e3, p, v, c) for t, p, v, c in ROW]))
    text("influx.csv", "#group,false,false,false,false\n#datatype,dateTime:RFC3339Nano,double,double,double\n" + names(of=["time"] + NAMES[1:])
         + "".join(f"{s:%Y-%m-%dT%H:%M:%S}.{s.microsecond:06d}Z," + ",".join(str(x) for x in row[1:]) + "\n" for s, row in zip(STAMPS, ROW)))
    text("grafana.csv", '"Time",' + ",".join(f'"{n}"' for n in NAMES[1:]) + "\n" + "".join(f'"{s:%Y-%m-%d %H:%M:%S}.{s.microsecond // 1000:03d}",' + ",".join(str(x) for x in row[1:]) + "\n" for s, row in zip(STAMPS, ROW)))
    text("clock.csv", names(of=["Time"] + NAMES[1:]) + "".join(f"{s:%H:%M:%S}.{s.microsecond // 1000:03d}," + ",".join(str(x) for x in row[1:]) + "\n" for s, row in zip(STAMPS, ROW)))
    text("clock_date.txt", names("\t", of=["Date", "Time"] + NAMES[1:]) + "".join(f"{s:%Y-%m-%d}\t{s:%H:%M:%S}.{s.microsecond // 1000:03d}\t" + "\t".join(str(x) for x in row[1:]) + "\n" for s, row in zip(STAMPS, ROW)))
    epoch = [(1767348000 + t, p, v, c) for t, p, v, c in ROW]
    text("epoch_s.csv", names(of=["timestamp"] + NAMES[1:]) + "".join("%.6f,%s,%s,%s\n" % row for row in epoch))
    text("epoch_ms.csv", names(of=["timestamp"] + NAMES[1:]) + "".join("%d,%s,%s,%s\n" % (round(row[0] * 1e3), *row[1:]) for row in epoch))
    text("epoch_us.log", names(of=["Timestamp"] + NAMES[1:]) + "".join("%d,%s,%s,%s\n" % (round(row[0] * 1e6), *row[1:]) for row in epoch))
    text("epoch_ns.csv", names(of=["time"] + NAMES[1:]) + "".join("%d,%s,%s,%s\n" % (1767348000 * 10**9 + round(row[0] * 1e9), *row[1:]) for row in ROW))
    text("serial_monitor.log", "booting...\nready\n" + names(", ") + rows("%.5f", ", ") + "# stopped\n")
    text("named_again.csv", names() + rows("%.5f", data=ROW[:20]) + names() + rows("%.5f", data=ROW[20:]))
    text("stm_micros.csv", names(of=["t [us]"] + NAMES[1:]) + rows("%r", data=[(round(t * 1e6), *rest) for t, *rest in ROW]))
    text("arduino_millis.csv", names(of=["time"] + NAMES[1:]) + rows("%r", data=[(round(t * 1e3), *rest) for t, *rest in ROW]))
    text("mixed_signs.csv", names(";", of=NAMES[:3] + ["motor_current"]).replace("motor_current\n", "motor_current [mA]\n")
         + "".join(";".join([("%.5f" % x).replace(".", ",") for x in row[:3]] + ["%.3f" % (1 + row[3] / 10)]) + "\n" for row in ROW))


if __name__ == "__main__":
    OUT.mkdir(exist_ok=True)
    for old in OUT.iterdir():
        old.unlink()
    frames()
    spreadsheets()
    programs()
    instruments()
    print(len(list(OUT.iterdir())), "files")
