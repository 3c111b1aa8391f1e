"""Ranks the candidates of a friction run with SciPy: each is refitted beside the model by least squares, and the best
eight once more without each of ten folds. Same means over chunks of settled motion, same candidates in number; no
error control, no search for shapes, no memory effects. Prints the seconds."""
import sys
import time

import numpy as np
from scipy.linalg import lstsq

GEAR, TORQUE_CONSTANT, CHUNK = 60.0, 0.08, 10
run = np.fromfile(sys.argv[1]).reshape(10, -1)

start = time.perf_counter()
n = run.shape[1] // 250 * 250
# The first fifth of each step is left out, the rest averaged over chunks of 40 ms.
t, q, v, i, link, load, warm, _, segment, _ = run[:, :n].reshape(10, -1, 250)[:, :, 50:].reshape(10, -1, CHUNK).mean(axis=2)
side = np.sign(v)
y = TORQUE_CONSTANT * i - load / GEAR
base = np.column_stack([side, v])
slow, fast = np.abs(v).min(), np.abs(v).max()
candidates = [np.ones_like(v), np.abs(v), v * np.abs(v), np.abs(load) * side, load * load * side, np.abs(load) * v, t]
candidates += [(warm - 25) * v, (warm - 25) * side, y**3]
candidates += [np.exp(-((np.abs(v) / s) ** d)) * side for s in np.geomspace(0.7 * slow, fast / 3, 6) for d in (0.9, 1.8)]
candidates += [np.abs(v) ** a * side for a in (0.3, 0.5, 0.7)]
candidates = [c[:, None] for c in candidates]
for h in range(1, 121):
    candidates.append(np.column_stack([np.cos(h * q), np.sin(h * q)]))
for h in range(1, 61):
    wave = np.column_stack([np.cos(h * link), np.sin(h * link)])
    candidates.append(wave * side[:, None])
    candidates.append(np.column_stack([wave * side[:, None], wave * v[:, None]]))


def error(rows, left, x):
    factors = lstsq(x[rows], y[rows], lapack_driver="gelsy", check_finite=False)[0]
    return np.sum((y[left] - x[left] @ factors) ** 2)


everything = np.ones(len(y), bool)
fold = segment.astype(int) // 2 % 10
model = base
for _ in range(2):  # the effect that is there, and the step that finds no other
    beside = [np.hstack([model, c]) for c in candidates]
    best = np.argsort([error(everything, everything, x) for x in beside])[:8]
    held_out = [sum(error(fold != f, fold == f, beside[b]) for f in range(10)) for b in best]
    model = beside[best[int(np.argmin(held_out))]]
print(time.perf_counter() - start)
