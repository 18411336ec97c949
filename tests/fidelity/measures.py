"""How far a picture is from a reference, and how far the reference's own noise would be.

Pictures are (h, w, 3), scene-linear and premultiplied, as is the variance of each pixel's mean.
"""

from typing import TypeAlias

import flip_evaluator
import numpy as np
import numpy.typing as npt

Picture: TypeAlias = npt.NDArray[np.float64]

GREY = 0.2
"""Linear value to which a picture's mean over what is covered is exposed before it is looked at."""


def _checked(name: str, picture: npt.ArrayLike) -> Picture:
    result = np.asarray(picture, np.float64)
    if result.ndim != 3 or result.shape[2] != 3 or result.size == 0:
        raise ValueError(f"{name}: expected shape (h, w, 3), got {result.shape}")
    if not np.isfinite(result).all():
        raise ValueError(f"{name}: not all values are finite")
    if (result < 0).any():
        raise ValueError(f"{name}: a value is less than 0")
    return result


def _pair(a_name: str, a: npt.ArrayLike, reference: npt.ArrayLike) -> tuple[Picture, Picture]:
    a, reference = _checked(a_name, a), _checked("reference", reference)
    if a.shape != reference.shape:
        raise ValueError(f"{a_name}: shape {a.shape} beside a reference of {reference.shape}")
    if not reference.any():
        raise ValueError("reference: it is black, and nothing is relative to it")
    return a, reference


def mean_error(test: npt.ArrayLike, reference: npt.ArrayLike) -> float:
    """Distance of mean colours relative to the reference's; below 0 where the picture is darker."""
    test, reference = _pair("test", test, reference)
    a, b = test.mean(axis=(0, 1)), reference.mean(axis=(0, 1))
    return float(np.copysign(np.linalg.norm(a - b), a.sum() - b.sum()) / np.linalg.norm(b))


def mean_noise(variance: npt.ArrayLike, reference: npt.ArrayLike) -> float:
    """Standard error of the reference's mean colour, relative as in `mean_error`."""
    variance, reference = _pair("variance", variance, reference)
    pixels = variance.shape[0] * variance.shape[1]
    return float(np.sqrt(variance.sum()) / pixels / np.linalg.norm(reference.mean(axis=(0, 1))))


def rmse(test: npt.ArrayLike, reference: npt.ArrayLike) -> float:
    """Root mean square of the difference over that of the reference."""
    test, reference = _pair("test", test, reference)
    return float(np.sqrt(((test - reference) ** 2).sum() / (reference**2).sum()))


def rmse_noise(variance: npt.ArrayLike, reference: npt.ArrayLike) -> float:
    """`rmse` that a picture without any error would have, from the reference's noise."""
    variance, reference = _pair("variance", variance, reference)
    return float(np.sqrt(variance.sum() / (reference**2).sum()))


def exposure(reference: npt.ArrayLike, covered: npt.NDArray[np.bool_]) -> float:
    """Factor that brings what is covered to `GREY` on average."""
    reference = _checked("reference", reference)
    if covered.shape != reference.shape[:2]:
        raise ValueError(f"covered: shape {covered.shape} beside a reference of {reference.shape}")
    if not covered.any() or not reference[covered].any():
        raise ValueError("reference: nothing bright is covered")
    return GREY / float(reference[covered].mean())


def to_srgb(linear: Picture) -> Picture:
    """Display values, 0 to 1."""
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def flip(
    test: npt.ArrayLike, reference: npt.ArrayLike, covered: npt.NDArray[np.bool_]
) -> tuple[float, npt.NDArray[np.float32]]:
    """LDR-FLIP at 67 pixels a degree, both pictures exposed alike: mean over `covered`, and the map (h, w).

    Background that both leave black would only dilute the mean.
    """
    test, reference = _pair("test", test, reference)
    factor = exposure(reference, covered)
    shown = [np.ascontiguousarray(to_srgb(factor * picture), np.float32) for picture in (reference, test)]
    error, _, _ = flip_evaluator.evaluate(*shown, "LDR", applyMagma=False, computeMeanError=False)
    error = error.reshape(covered.shape)
    return float(error[covered].mean()), error


def flip_noise(variance: npt.ArrayLike, reference: npt.ArrayLike, covered: npt.NDArray[np.bool_]) -> float:
    """`flip` of the reference beside itself with as much noise again."""
    variance, reference = _pair("variance", variance, reference)
    noise = np.random.default_rng(1).normal(size=reference.shape) * np.sqrt(variance)
    return flip(np.maximum(reference + noise, 0), reference, covered)[0]


def moved_back(later: npt.ArrayLike, motion: npt.ArrayLike) -> tuple[Picture, npt.NDArray[np.bool_]]:
    """A later picture at the places of an earlier one, bilinear, and where it shows them.

    `motion`: pixels by which what is seen at each pixel of the earlier one moves, columns and rows, (h, w, 2).
    """
    later, motion = _checked("later", later), np.asarray(motion, np.float64)
    height, width = later.shape[:2]
    if motion.shape != (height, width, 2):
        raise ValueError(f"motion: expected shape {(height, width, 2)}, got {motion.shape}")
    columns, rows = np.meshgrid(np.arange(width), np.arange(height))
    x, y = columns + motion[..., 0], rows + motion[..., 1]
    shown = (x >= 0) & (x <= width - 1) & (y >= 0) & (y <= height - 1)
    left = np.clip(np.floor(x), 0, width - 2).astype(int)
    top = np.clip(np.floor(y), 0, height - 2).astype(int)
    across, down = np.clip(x - left, 0, 1)[..., None], np.clip(y - top, 0, 1)[..., None]
    upper = later[top, left] * (1 - across) + later[top, left + 1] * across
    lower = later[top + 1, left] * (1 - across) + later[top + 1, left + 1] * across
    return upper * (1 - down) + lower * down, shown


def squared_change(pictures: list[list[Picture]], motion: npt.ArrayLike) -> tuple[float, float]:
    """Sums over the pixels shown twice: the squared change from one frame to the next, and the first one's squares.

    `pictures`: [seed][frame], two of each. Noise that two seeds do not share is not in the mean of the product of
    their changes.
    """
    changes, firsts = [], []
    for earlier, later in pictures:
        back, shown = moved_back(later, motion)
        first = _checked("earlier", earlier)
        changes.append((back - first)[shown])
        firsts.append(first[shown])
    return float((changes[0] * changes[1]).sum()), float((firsts[0] * firsts[1]).sum())
