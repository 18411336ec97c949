"""What stands on the screen of a `window.Window`."""

import time

import numpy as np
from PIL import Image

IMPOSSIBLE = """
material = bpy.data.materials.new('Impossible')
material.lisle.yarn.customize = True
material.lisle.yarn.ply_twist = 0
bpy.data.objects['Yarn'].data.materials.append(material)
"""
"""Gives the yarn a material of which there is no yarn."""


def shows(view, place, keep=None, seconds=120):
    """The display's pixels once something else than the viewport's corner stands at a place."""
    left, top, _, _ = view.do("answer = rectangle()")
    until = time.monotonic() + seconds
    while time.monotonic() < until:
        pixels = screen(view, keep)
        if np.abs(at(pixels, place) - at(pixels, (left + 20, top + 20))).max() > 12:
            return pixels
    raise AssertionError(f"nothing at {place} after {seconds} s")


def srgb(linear):
    """The 8-bit values of scene-linear ones, as the view transform Standard shows them."""
    linear = np.clip(np.asarray(linear, np.float64), 0, 1)
    return 255 * np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)


def screen(view, keep=None):
    """The display's pixels once they stand still; `keep` names a file to look at."""
    last, same = None, 0
    for _ in range(200):
        pixels = view.display.pixels().copy()
        same = same + 1 if last is not None and np.array_equal(pixels, last) else 0
        if same == 4:
            break
        last = pixels
        time.sleep(0.05)
    if keep:
        Image.fromarray(pixels).save(view.artefacts / f"{view.backend}-{keep}.png")
    return pixels


def settled(view, keep=None, views=1):
    view.until(f"answer = is_settled({views})")
    return screen(view, keep)


def at(pixels, place):
    column, row = place
    return pixels[int(row), int(column)].astype(float)


def world(view, color, transparent=False):
    view.do(
        "world = bpy.context.scene.world = bpy.data.worlds.new('World')\n"
        f"world.node_tree.nodes['Background'].inputs['Color'].default_value = {(*color, 1)}\n"
        f"bpy.context.scene.render.film_transparent = {transparent}"
    )


def yarn_mask(pixels, rectangle, background):
    """Where a viewport shows something; without its edge, where Blender draws handles."""
    left, top, right, bottom = rectangle
    part = pixels[top + 16 : bottom - 16, left + 16 : right - 16].astype(float)
    return np.abs(part - background).max(axis=2) > 12
