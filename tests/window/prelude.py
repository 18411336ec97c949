"""Executed once in Blender: names that the tests use."""

import sys

import bpy
from bpy_extras.view3d_utils import location_3d_to_region_2d
from mathutils import Euler, Vector

PACKAGE = "bl_ext.user_default.lisle_blender"


def painter():
    return sys.modules[f"{PACKAGE}.engine.painting"].PAINTER


def areas():
    return [area for area in bpy.context.window_manager.windows[0].screen.areas if area.type == "VIEW_3D"]


def region(area=None):
    return next(region for region in (area or areas()[0]).regions if region.type == "WINDOW")


def space(area=None):
    return (area or areas()[0]).spaces.active


def rv3d(area=None):
    return space(area).region_3d


def bare(area=None):
    """Nothing but the scene in the viewport, not even the mouse."""
    bpy.context.window_manager.windows[0].cursor_warp(2, 2)
    view = space(area)
    view.overlay.show_overlays = False
    view.show_gizmo = view.show_region_header = view.show_region_toolbar = view.show_region_tool_header = False
    view.show_region_ui = view.show_region_hud = False


def look(rotation=(0, 0, 0), distance=12.0, at=(0, 0, 0), perspective="PERSP", area=None):
    view = rv3d(area)
    view.view_perspective = perspective
    view.view_location = at
    view.view_rotation = Euler(rotation).to_quaternion()
    view.view_distance = distance


def is_settled(views=1):
    """Whether everything shown is finished, in so many views."""
    shown = painter()
    return len(shown._views) == views and not shown.busy() and not shown.news()


def on_screen(points, area=None):
    """Pixels (column, row from the top of the display) of world-space points in a viewport."""
    there = region(area)
    height = bpy.context.window_manager.windows[0].height
    projected = [location_3d_to_region_2d(there, rv3d(area), Vector(point)) for point in points]
    return [(there.x + p.x, height - there.y - p.y) for p in projected]


def rectangle(area=None):
    """Of a viewport: left, top, right, bottom pixels of the display."""
    there = region(area)
    height = bpy.context.window_manager.windows[0].height
    return there.x, height - there.y - there.height, there.x + there.width, height - there.y


def close_other_windows():
    """Closes the windows of renders; Blender's first one would take all others with it."""
    for window in bpy.context.window_manager.windows[1:]:
        with bpy.context.temp_override(window=window):
            bpy.ops.wm.window_close()


def operator(call, area=None, invoke=False, **arguments):
    """Calls an operator as from within a viewport; `invoke` as from a menu."""
    area = area or areas()[0]
    with bpy.context.temp_override(window=bpy.context.window_manager.windows[0], area=area, region=region(area)):
        return list(call("INVOKE_DEFAULT" if invoke else "EXEC_DEFAULT", **arguments))
