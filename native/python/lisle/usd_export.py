"""Fibers to USD. Needs `usd-core`, as reading does."""

import os
import tempfile
from pathlib import Path

import numpy as np

from .errors import InputError
from .reference import Fibers


def save_fibers(path: str | Path, fibers: Fibers) -> None:
    """Writes fibers as one prim of linear BasisCurves, `/Fibers`, in metres, Z up, with diameters as widths.

    Args:
        path: `.usdc` or `.usda`; the file appears whole or not at all.
        fibers: as `lisle.fibers` makes them.

    Raises:
        InputError: `usd-core` is missing.
        OSError: the file cannot be written.
    """
    try:
        from pxr import Tf, Usd, UsdGeom, Vt
    except ImportError:
        raise InputError(f"{path}: writing USD needs the package usd-core: pip install usd-core") from None
    path = Path(path)
    with tempfile.TemporaryDirectory(prefix=".lisle-", dir=path.parent) as folder:
        # USD tells the kind of a file by its suffix.
        part = Path(folder) / f"fibers{path.suffix.lower()}"
        try:
            stage = Usd.Stage.CreateNew(str(part))
            UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
            UsdGeom.SetStageMetersPerUnit(stage, 1.0)
            prim = UsdGeom.BasisCurves.Define(stage, "/Fibers")
            stage.SetDefaultPrim(prim.GetPrim())
            prim.CreateTypeAttr(UsdGeom.Tokens.linear)
            prim.CreateCurveVertexCountsAttr(Vt.IntArray.FromNumpy(np.diff(fibers.offsets).astype(np.int32)))
            prim.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(fibers.points))
            prim.CreateWidthsAttr(Vt.FloatArray.FromNumpy(2.0 * fibers.radii))
            prim.SetWidthsInterpolation(UsdGeom.Tokens.vertex)
            if len(fibers.points):
                reach = float(fibers.radii.max())
                low, high = fibers.points.min(axis=0) - reach, fibers.points.max(axis=0) + reach
                prim.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(np.stack([low, high])))
            stage.Save()
        except Tf.ErrorException as error:
            raise OSError(f"{path}: cannot be written: {str(error).strip().splitlines()[-1].strip()}") from None
        del prim, stage
        os.replace(part, path)
