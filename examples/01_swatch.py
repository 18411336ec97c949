"""A stockinette swatch, near enough to see plies, fibers and fuzz."""

import argparse
from pathlib import Path

import lisle

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("out", nargs="?", type=Path, default=Path("out/examples"), help="folder for the pictures")
out = parser.parse_args().out
out.mkdir(parents=True, exist_ok=True)

yarns = lisle.knit_swatch("stockinette", courses=14, wales=9)
wool = lisle.Material.preset("cotton-2").replace(
    color_r=(0.06, 0.06, 0.06), color_tt=(0.74, 0.28, 0.24), beta_r_deg=6, beta_tt_deg=20, diffuse=(0.60, 0.09, 0.06)
)
image = lisle.Renderer().render(
    yarns,
    yarn=lisle.Yarn.preset("cotton-1"),
    material=wool,
    camera=lisle.Camera.fit(yarns, direction=(0.3, -1, 0.3), size=(1200, 900)),
    lights=[
        lisle.Sun(direction=(1, 0.8, -1.1), strength=5, color=(1, 0.95, 0.88), angle_rad=0.05),
        lisle.Sun(direction=(-1, 0.3, -0.2), strength=1.2, color=(0.75, 0.85, 1), angle_rad=0.2),
    ],
    ambient=(0.35, 0.37, 0.40),
    samples=32,
)
image.save(out / "swatch.png")
print(out / "swatch.png")
