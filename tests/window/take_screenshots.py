"""Takes the manual's screenshots: `LISLE_PACKAGE=… python tests/window/take_screenshots.py docs/images`."""

import os
import sys
import tempfile
import time
from pathlib import Path

import program
import window
from PIL import Image

HERE = Path(__file__).parent
SIZE = (1280, 800)

SCENE = """
import math
for obj in list(bpy.data.objects):
    bpy.data.objects.remove(obj)
scene = bpy.context.scene
scene.render.engine = 'LISLE'
scene.lisle.viewport_samples = 64
scene.render.film_transparent = False
world = scene.world = bpy.data.worlds.new('World')
world.node_tree.nodes['Background'].inputs['Color'].default_value = (0.25, 0.27, 0.3, 1)
sun = bpy.data.objects.new('Sun', bpy.data.lights.new('Sun', 'SUN'))
sun.data.energy, sun.rotation_euler = 4, (0.9, 0.2, 0.5)
scene.collection.objects.link(sun)
camera = bpy.data.objects.new('Camera', bpy.data.cameras.new('Camera'))
camera.location, camera.rotation_euler = (0, -0.25, 0.03), (1.45, 0, 0)
scene.collection.objects.link(camera)
scene.camera = camera
properties = next(a for a in bpy.context.window_manager.windows[0].screen.areas if a.type == 'PROPERTIES')
view = space()
view.clip_start = 0.001
view.overlay.show_floor = view.overlay.show_axis_x = view.overlay.show_axis_y = view.overlay.show_cursor = False
operator(bpy.ops.lisle.add_knit_swatch, pattern='rib-2-2', courses=16, wales=20, yarn='cotton-1', fiber='fleece')
bpy.context.active_object.select_set(False)
"""

WIDER_PANELS = "operator(bpy.ops.screen.area_move, x=areas()[0].x + areas()[0].width, y=areas()[0].y + 200, delta=-130)"
"""So that their labels can be read."""

PICTURES = {
    "blender-rendered": """
view.shading.type = 'RENDERED'
look((1.25, 0, 0.45), distance=0.13)
properties.spaces.active.context = 'MATERIAL'
""",
    "blender-overlay": """
import bmesh
mesh = bpy.data.meshes.new('Ball')
ball = bmesh.new()
bmesh.ops.create_uvsphere(ball, u_segments=48, v_segments=24, radius=0.012)
ball.to_mesh(mesh)
for polygon in mesh.polygons:
    polygon.use_smooth = True
for name, location in (('Front', (0.012, -0.012, 0.0)), ('Behind', (-0.02, 0.006, 0.008))):
    obj = bpy.data.objects.new(name, mesh)
    obj.location = location
    scene.collection.objects.link(obj)
scene.render.engine = 'BLENDER_WORKBENCH'
view.shading.type = 'SOLID'
scene.lisle.show_overlay = True
properties.spaces.active.context = 'OBJECT'
bpy.context.view_layer.objects.active = bpy.data.objects['Knit Swatch']
""",
    "blender-render-settings": """
scene.render.engine = 'LISLE'
view.shading.type = 'RENDERED'
for name in ('Front', 'Behind'):
    bpy.data.objects.remove(bpy.data.objects[name])
scene.lisle.show_overlay = False
rv3d().view_perspective = 'CAMERA'
properties.spaces.active.context = 'RENDER'
""",
}


def main():
    out = Path(sys.argv[1])
    path, reason = program.find()
    if path is None:
        sys.exit(reason)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        for name in ("pixels", "commands"):
            (folder / name).mkdir()
        blender = program.Program(path, folder)
        blender.install(Path(os.environ["LISLE_PACKAGE"]).absolute())
        blend = folder / "empty.blend"
        blender.script(HERE / "make_scene.py", blend, "sound")
        display = window.Display(folder / "pixels", SIZE)
        opened = window.Window(blender, display, blend, folder / "commands", "opengl")
        try:
            # Borders move where no region has the pointer.
            opened.do("x = areas()[0].x + areas()[0].width; bpy.context.window_manager.windows[0].cursor_warp(x, 400)")
            time.sleep(1)
            opened.do(WIDER_PANELS)
            opened.do(SCENE)
            opened.do("bpy.context.window_manager.windows[0].cursor_warp(2, 2)")
            for name, code in PICTURES.items():
                opened.do(code)
                time.sleep(1)
                opened.until("answer = is_settled()", 300)
                time.sleep(1)
                Image.fromarray(display.pixels()).save(out / f"{name}.jpg", quality=88)
        finally:
            opened.close()
            display.close()


if __name__ == "__main__":
    main()
