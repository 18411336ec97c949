"""How near yarns come to each other."""

import numpy as np

CHORDS = 6
"""Samples of a segment: a quarter of a radius apart in knitted cloth, so that two radii are at most 0.01 too long."""


def _catmull_rom(points, closed):
    """Points along a uniform Catmull-Rom curve, its open ends extrapolated by reflection."""
    t = np.arange(CHORDS)[:, None] / CHORDS
    weights = 0.5 * np.hstack([-t + 2 * t**2 - t**3, 2 - 5 * t**2 + 3 * t**3, t + 4 * t**2 - 3 * t**3, t**3 - t**2])
    if closed:
        padded = np.concatenate([points[-1:], points, points[:2]])
    else:
        padded = np.concatenate([[2 * points[0] - points[1]], points, [2 * points[-1] - points[-2]]])
    windows = np.lib.stride_tricks.sliding_window_view(padded, 4, axis=0)
    return np.einsum("nk,idk->ind", weights, windows).reshape(-1, 3)


def closest_approach(curves, radius):
    """The least distance of yarns, in radii: to each other, and to themselves where > π radii of yarn lie between.

    Infinite beyond 2.2 radii. `curves`: (points (n, 3), whether closed) of each.
    """
    points, yarn, along, length = [], [], [], []
    for number, (control, closed) in enumerate(curves):
        line = _catmull_rom(np.asarray(control, np.float64) / radius, closed)
        steps = np.linalg.norm(np.diff(line, axis=0, append=line[:1]), axis=1)
        points.append(line)
        yarn.append(np.full(len(line), number))
        along.append(np.cumsum(steps) - steps)
        length.append(np.full(len(line), steps.sum() if closed else np.inf))
    points, yarn, along, length = (np.concatenate(parts) for parts in (points, yarn, along, length))

    reach = 2.2
    cells = np.floor(points / reach).astype(np.int64)
    cells -= cells.min(axis=0) - 1
    size = cells.max(axis=0) + 2
    key = np.ravel_multi_index(cells.T, size)
    order = np.argsort(key, kind="stable")
    sorted_keys = key[order]
    closest = np.inf
    for offset in np.ndindex(3, 3, 3):
        if offset < (1, 1, 1):
            continue  # A pair of cells is looked at from one of them.
        others = np.ravel_multi_index((cells + np.array(offset) - 1).T, size)
        first, end = np.searchsorted(sorted_keys, others, "left"), np.searchsorted(sorted_keys, others, "right")
        a = np.repeat(np.arange(len(points)), end - first)
        b = order[np.arange(len(a)) + np.repeat(first - np.cumsum(end - first) + (end - first), end - first)]
        between = np.abs(along[a] - along[b])
        apart = (yarn[a] != yarn[b]) | (np.minimum(between, length[a] - between) > np.pi)
        if apart.any():
            closest = min(closest, np.linalg.norm(points[a[apart]] - points[b[apart]], axis=1).min())
    return closest if closest < reach else np.inf
