"""Appends the counts of 12 channels to an HDF5 file, shuffled and gzipped at level 4, and reads them back.

`table`: one data set, rows by channels, as a logger appends its rows. `columns`: one data set for each channel, which is
as small and as fast as HDF5 goes without a plug-in. Whole counts as int32 in both.
Prints rows per second (no fsync), bytes per row, seconds to read one channel, seconds to read all.
"""

import os
import statistics
import sys
import time

import h5py
import numpy as np

CHANNELS, APPEND = 12, 65536
PACKED = dict(dtype="<i4", shuffle=True, compression="gzip", compression_opts=4)

layout, path = sys.argv[1], sys.argv[3]
counts = np.fromfile(sys.argv[2], dtype="<i4").reshape(CHANNELS, -1)
rows = counts.shape[1]
by_row = np.ascontiguousarray(counts.T) if layout == "table" else None

start = time.perf_counter()
with h5py.File(path, "w") as file:
    if layout == "table":
        data = file.create_dataset("run", (0, CHANNELS), maxshape=(None, CHANNELS), chunks=(4096, CHANNELS), **PACKED)
    else:
        sets = [
            file.create_dataset(f"c{c}", (0,), maxshape=(None,), chunks=(32768,), **PACKED) for c in range(CHANNELS)
        ]
    for first in range(0, rows, APPEND):
        last = min(rows, first + APPEND)
        if layout == "table":
            data.resize(last, axis=0)
            data[first:last] = by_row[first:last]
        else:
            for c, data in enumerate(sets):
                data.resize((last,))
                data[first:last] = counts[c, first:last]
        file.flush()
written = time.perf_counter() - start


def read(channels):
    start = time.perf_counter()
    with h5py.File(path, "r") as file:
        for c in channels:
            (file["run"][:, c] if layout == "table" else file[f"c{c}"][:]) * 1e-3
    return time.perf_counter() - start


def read_all():
    if layout == "columns":
        return read(range(CHANNELS))
    start = time.perf_counter()
    with h5py.File(path, "r") as file:
        file["run"][:] * 1e-3
    return time.perf_counter() - start


# The fourth channel is the noisiest; the store is measured on the same.
one = statistics.median(read([3]) for _ in range(3))
print(rows / written, os.path.getsize(path) / rows, one, read_all())
