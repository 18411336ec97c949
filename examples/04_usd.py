"""Yarn curves in a USD file, read back frame by frame. Needs usd-core."""

import argparse
from pathlib import Path

import lisle
import numpy as np
from pxr import Usd, UsdGeom, Vt

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("out", nargs="?", type=Path, default=Path("out/examples"), help="folder for the pictures")
out = parser.parse_args().out
out.mkdir(parents=True, exist_ok=True)
path = out / "swatch.usdc"

swatch = lisle.knit_swatch("garter", courses=10, wales=8)
stage = Usd.Stage.CreateNew(str(path))
UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.z)
UsdGeom.SetStageMetersPerUnit(stage, 1.0)
stage.SetStartTimeCode(1)
stage.SetEndTimeCode(3)
curves = UsdGeom.BasisCurves.Define(stage, "/Yarns")
curves.CreateTypeAttr(UsdGeom.Tokens.cubic)
curves.CreateBasisAttr(UsdGeom.Tokens.catmullRom)
curves.CreateWrapAttr(UsdGeom.Tokens.pinned)
curves.CreateCurveVertexCountsAttr(np.diff(swatch.offsets).astype(int).tolist())
curves.CreateWidthsAttr([float(2 * swatch.radii[0])])
curves.SetWidthsInterpolation(UsdGeom.Tokens.constant)
points = curves.CreatePointsAttr()
for frame in (1, 2, 3):
    moved = swatch.points * np.float32([1 + 0.05 * frame, 1, 1])
    points.Set(Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(moved)), frame)
stage.Save()

renderer = lisle.Renderer()
for frame in (1, 2, 3):
    yarns = lisle.load(path, frame=frame)
    image = renderer.render(
        yarns,
        camera=lisle.Camera.fit(yarns, size=(480, 360)),
        lights=[lisle.Sun(direction=(1, 0.8, -1.1), strength=4)],
        ambient=(0.4, 0.4, 0.4),
        samples=4,
    )
    image.save(out / f"usd_{frame:04d}.png")
    print(out / f"usd_{frame:04d}.png")
