# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures on the screen, with Blender's gpu module: OpenGL, Vulkan and Metal alike."""

import functools

import gpu
import numpy as np
from gpu_extras.batch import batch_for_shader
from mathutils import Matrix

from ..core import display
from ..core.curves import polylines
from ..core.trim import cut

_LINE_POINTS = 100_000
"""Most points of an object's lines."""
_LINE_PLACEMENTS = 1000


class Screen:
    """What one view shows: the textures of its picture, remade when the picture changes, or the yarns as lines."""

    def __init__(self):
        self._picture = None
        self._combined = None
        self._depth = None
        self._lines_of = None
        self._lines = ()
        self._transform = None
        self._codes = None

    def draw(self, picture, view):
        """Draws a core.painter.Picture of a core.view.View into the bound framebuffer, over what is there."""
        self._hold(picture)
        self._draw(_picture_shader(), picture, view)

    def draw_in_depth(self, picture, view, transform=None):
        """The same, hidden by what is nearer in the framebuffer's depth, as a `transform` (with `codes` and `exposure`
        as in core.display) shows it in a framebuffer of display light."""
        if self._hold(picture) or self._depth is None:
            self._depth = texture("R32F", picture.depth)
        shader = _deep_picture_shader(transform is not None)
        shader.bind()
        if transform is not None:
            if transform is not self._transform:
                codes = np.c_[transform.codes, np.ones(len(transform.codes), np.float32)]
                self._codes = texture("RGBA16F", codes.reshape(display.SIZE, -1, 4))
                self._transform = transform
            shader.uniform_sampler("codes", self._codes)
            shader.uniform_float("scales", display.scales(transform.exposure))
        shader.uniform_sampler("depth", self._depth)
        # Distance along the view axis to clip space's z and w.
        z, w = view.clip_from_camera[2], view.clip_from_camera[3]
        shader.uniform_float("depth_row", (-z[2], z[3], -w[2], w[3]))
        self._draw(shader, picture, view, "LESS_EQUAL")

    def _hold(self, picture):
        """Brings the texture up to date; whether it was another picture's."""
        if picture is self._picture:
            return False
        self._combined = texture("RGBA16F", np.clip(picture.combined, -65504, 65504))
        self._picture, self._depth = picture, None
        return True

    def _draw(self, shader, picture, view, depth_test="NONE"):
        shader.bind()
        shader.uniform_float("rectangle", clip_rectangle(picture.region, view.size))
        shader.uniform_sampler("picture", self._combined)
        gpu.state.depth_mask_set(False)
        gpu.state.depth_test_set(depth_test)
        gpu.state.blend_set("ALPHA_PREMULT")
        _square(shader).draw(shader)
        gpu.state.blend_set("NONE")
        gpu.state.depth_test_set("NONE")

    def draw_lines(self, snapshot, view, depth_test="NONE", transform=None):
        """Draws the yarns of a snapshot.Snapshot as thin lines: what there is before there is a picture. `transform` as
        above."""
        if snapshot is not self._lines_of:
            self._lines = [
                (_line_batch(*polylines(_shown(part), _LINE_POINTS)), np.array(part.materials[0][1].diffuse))
                for part in snapshot.content.geometries.values()
            ]
            self._lines_of = snapshot
        batches = dict(zip(snapshot.content.geometries, self._lines, strict=True))
        clip_from_world = view.clip_from_camera @ np.linalg.inv(view.world_from_camera)
        shader = _line_shader()
        shader.bind()
        gpu.state.depth_test_set(depth_test)
        gpu.state.blend_set("NONE")
        for placement in snapshot.content.placements[:_LINE_PLACEMENTS]:
            batch, color = batches[placement.key]
            if transform is not None:
                color = display.look_up(transform.codes, transform.exposure, color) ** 2.2
            shader.uniform_float("clip_from_object", Matrix(clip_from_world @ placement.world_from_object))
            shader.uniform_float("line_color", (*color, 1.0))
            batch.draw(shader)
        gpu.state.depth_test_set("NONE")

    def fill(self, color, view):
        """Fills the view's region with a scene-linear colour."""
        shader = _fill_shader()
        shader.bind()
        shader.uniform_float("rectangle", clip_rectangle(view.region, view.size))
        shader.uniform_float("fill_color", (*color, 1.0))
        gpu.state.depth_test_set("NONE")
        _square(shader).draw(shader)


def texture(kind, values):
    """A GPUTexture of (h, w) or (h, w, c) float32 values, bottom row first."""
    values = np.ascontiguousarray(values, dtype=np.float32)
    height, width = values.shape[:2]
    return gpu.types.GPUTexture(
        (width, height), format=kind, data=gpu.types.Buffer("FLOAT", values.size, values.ravel())
    )


def clip_rectangle(region, size):
    """(x0, y0, x1, y1) in clip space of a rectangle in pixels."""
    return tuple(2 * edge / length - 1 for edge, length in zip(region, (*size, *size), strict=True))


def _shown(geometry):
    return geometry.curves if geometry.parts is None else cut(geometry.curves, geometry.parts)[0]


def _line_batch(points, pairs):
    return batch_for_shader(_line_shader(), "LINES", {"position": points}, indices=pairs)


def _square(shader):
    return batch_for_shader(shader, "TRI_STRIP", {"corner": ((0, 0), (1, 0), (0, 1), (1, 1))})


_PLACE_RECTANGLE = "gl_Position = vec4(mix(rectangle.xy, rectangle.zw, corner), 0.0, 1.0);"


def _picture_info():
    info = gpu.types.GPUShaderCreateInfo()
    passed = gpu.types.GPUStageInterfaceInfo("lisle_picture")
    passed.smooth("VEC2", "place")
    info.push_constant("VEC4", "rectangle")
    info.sampler(0, "FLOAT_2D", "picture")
    info.vertex_in(0, "VEC2", "corner")
    info.vertex_out(passed)
    info.fragment_out(0, "VEC4", "color")
    info.vertex_source(f"void main() {{ place = corner; {_PLACE_RECTANGLE} }}")
    return info


@functools.cache
def _picture_shader():
    info = _picture_info()
    info.fragment_source("void main() { color = texture(picture, place); }")
    return gpu.shader.create_from_info(info)


_TABLE = f"""
    vec3 at_lattice(ivec3 place) {{
        return texelFetch(codes, ivec2(place.r + {display.SIZE} * place.g, place.b), 0).rgb;
    }}
    vec3 display_code(vec3 light) {{
        vec3 place = clamp(log2(1.0 + scales.x * max(light, 0.0)) * scales.y, 0.0, 1.0) * {display.SIZE - 1}.0;
        ivec3 low = min(ivec3(place), ivec3({display.SIZE - 2}));
        vec3 share = place - vec3(low);
        vec3 code = vec3(0.0);
        for (int corner = 0; corner < 8; corner++) {{
            ivec3 offset = ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
            vec3 weight = mix(1.0 - share, share, vec3(offset));
            code += weight.r * weight.g * weight.b * at_lattice(low + offset);
        }}
        return code;
    }}
"""
_STANDARD = """
    vec3 display_code(vec3 light) {
        vec3 within = clamp(light, 0.0, 1.0);
        return mix(12.92 * within, 1.055 * pow(within, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, within));
    }
"""


@functools.cache
def _deep_picture_shader(transformed):
    info = _picture_info()
    info.push_constant("VEC4", "depth_row")
    if transformed:
        info.push_constant("VEC2", "scales")
        info.sampler(2, "FLOAT_2D", "codes")
    info.sampler(1, "FLOAT_2D", "depth")
    info.depth_write("ANY")
    info.fragment_source(f"""
        {_TABLE if transformed else _STANDARD}
        void main() {{
            color = texture(picture, place);
            // Not interpolated: between a yarn and the void there is no depth.
            float along = texelFetch(depth, ivec2(place * vec2(textureSize(depth, 0))), 0).r;
            if (color.a == 0.0 || along > 1e9) {{
                discard;
            }}
            // Blender takes what is drawn over a picture to the power of 1 / 2.2 at the end.
            color.rgb = pow(display_code(color.rgb / color.a), vec3(2.2)) * color.a;
            gl_FragDepth = 0.5 + 0.5 * (depth_row.x * along + depth_row.y) / (depth_row.z * along + depth_row.w);
        }}
    """)
    return gpu.shader.create_from_info(info)


@functools.cache
def _fill_shader():
    info = gpu.types.GPUShaderCreateInfo()
    info.push_constant("VEC4", "rectangle")
    info.push_constant("VEC4", "fill_color")
    info.vertex_in(0, "VEC2", "corner")
    info.fragment_out(0, "VEC4", "color")
    info.vertex_source(f"void main() {{ {_PLACE_RECTANGLE} }}")
    info.fragment_source("void main() { color = fill_color; }")
    return gpu.shader.create_from_info(info)


@functools.cache
def _line_shader():
    info = gpu.types.GPUShaderCreateInfo()
    info.push_constant("MAT4", "clip_from_object")
    info.push_constant("VEC4", "line_color")
    info.vertex_in(0, "VEC3", "position")
    info.fragment_out(0, "VEC4", "color")
    info.vertex_source("void main() { gl_Position = clip_from_object * vec4(position, 1.0); }")
    info.fragment_source("void main() { color = line_color; }")
    return gpu.shader.create_from_info(info)
