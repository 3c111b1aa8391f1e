"""The tasks of the bench with SciPy: peer.py TASK FILE COLUMNS. Prints the seconds, then the answer."""
import math
import sys
import time

import numpy as np
from scipy.integrate import odeint
from scipy.linalg import lstsq
from scipy.optimize import least_squares

task, columns = sys.argv[1], int(sys.argv[3])
data = np.fromfile(sys.argv[2]).reshape(columns, -1)
rows = data.shape[1]


def least(times, work):
    took = []
    for _ in range(times):
        start = time.perf_counter()
        made = work()
        took.append(time.perf_counter() - start)
    return min(took), made


def solve(x, y):
    return lstsq(x, y, lapack_driver="gelsy", check_finite=False)[0]


def linear():
    x, y = data[:-1].T, data[-1]
    return least(5, lambda: solve(x, y))


def ranking(chosen=slice(None)):
    """Twelve regressors, candidates, response: the squared error beside each candidate."""
    model, y = data[:12, chosen], data[-1, chosen]
    errors = []
    for candidate in data[12:-1]:
        x = np.vstack([model, candidate[chosen]]).T
        errors.append(np.sum((y - x @ solve(x, y)) ** 2))
    return errors


def replicate():
    """One replicate of a block bootstrap of the ranking."""
    drawn = np.random.default_rng(1).integers(0, 100, 100)
    return ranking((drawn[:, None] * (rows // 100) + np.arange(rows // 100)).ravel())


def stribeck():
    v, y = data
    side, speed = np.sign(v), np.abs(v)

    def parts(p):
        fast = (speed / p[4]) ** p[5]
        return fast, np.exp(-fast)

    def residual(p):
        return p[0] + side * (p[1] + p[3] * parts(p)[1]) + p[2] * v - y

    def slopes(p):
        fast, fading = parts(p)
        steep = p[3] * fading * fast * side
        slow = np.log(speed / p[4])
        return np.column_stack([np.ones(rows), side, v, fading * side, steep * p[5] / p[4], -steep * slow])

    start = [0.0, 0.02, 1e-4, 0.01, 5.0, 1.0]
    each = [least(1, lambda m=m: least_squares(residual, start, slopes, method=m, x_scale="jac").x) for m in ("lm", "trf")]
    return min(each, key=lambda e: e[0])


def lugre():
    reach, speed, rise, step = 1e-5, 0.05, 0.5, 1e-3
    velocity = data[0].tolist()

    def slope(z, t):
        i = min(int(t / step), rows - 2)
        v = velocity[i] + (velocity[i + 1] - velocity[i]) * (t / step - i)
        return (v - abs(v) * z[0] / (1.0 + rise * math.exp(-((v / speed) ** 2)))) / reach

    t = step * np.arange(rows)
    took, z = least(1, lambda: odeint(slope, 0.0, t, rtol=1e-4, atol=1e-6, mxstep=100_000))
    return took, z[:, 0]


took, answer = {
    "linear": linear,
    "ranking": lambda: least(2, ranking),
    "replicate": lambda: least(1, replicate),
    "stribeck": stribeck,
    "lugre": lugre,
}[task]()
print(took, *answer)
