# SPDX-License-Identifier: GPL-3.0-or-later
"""Render properties."""

import bpy

from .. import native
from .panel import LislePanel, wrapped_label


class LISLE_RENDER_PT_problem(LislePanel, bpy.types.Panel):
    """Only there if something is wrong."""

    bl_label = "Lisle Cannot Render"
    bl_context = "render"

    @classmethod
    def poll(cls, context):
        return super().poll(context) and native.problem() is not None

    def draw(self, _context):
        wrapped_label(self.layout, native.problem(), icon="ERROR")


class LISLE_RENDER_PT_sampling(LislePanel, bpy.types.Panel):
    bl_label = "Sampling"
    bl_context = "render"

    def draw(self, context):
        layout, settings = self.split_layout(), context.scene.lisle
        layout.prop(settings, "viewport_samples", text="Viewport")
        column = layout.column()
        column.prop(settings, "method")
        if settings.method == "REFERENCE":
            column.prop(settings, "reference_samples", text="Render")
            column.prop(settings, "reference_bounces")
        else:
            column.prop(settings, "samples", text="Render")
        layout.prop(settings, "seed")


class LISLE_RENDER_PT_stop(LislePanel, bpy.types.Panel):
    bl_label = "Stop Early"
    bl_context = "render"
    bl_parent_id = "LISLE_RENDER_PT_sampling"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context):
        layout, settings = self.split_layout(), context.scene.lisle
        layout.active = settings.method != "REFERENCE"
        row = layout.row(heading="Noise Threshold")
        row.prop(settings, "use_noise_threshold", text="")
        sub = row.row()
        sub.active = settings.use_noise_threshold
        sub.prop(settings, "noise_threshold", text="")
        layout.prop(settings, "time_limit")


class LISLE_RENDER_PT_shading(LislePanel, bpy.types.Panel):
    bl_label = "Fibers"
    bl_context = "render"

    def draw(self, context):
        layout, settings = self.split_layout(), context.scene.lisle
        layout.prop(settings, "shading")
        column = layout.column()
        column.active = settings.method != "REFERENCE"
        row = column.row()
        row.active = settings.shading == "physical"
        row.prop(settings, "multiple_scattering")
        column.prop(settings, "occlusion")
        column.prop(settings, "lod")


class LISLE_RENDER_PT_reference(LislePanel, bpy.types.Panel):
    bl_label = "Reference Frame"
    bl_context = "render"

    def draw(self, context):
        layout, settings = self.split_layout(), context.scene.lisle
        row = layout.row(heading="Custom Frame")
        row.prop(settings, "use_reference_frame", text="")
        sub = row.row()
        sub.active = settings.use_reference_frame
        sub.prop(settings, "reference_frame", text="")
        if not settings.use_reference_frame:
            layout.label(text=f"Yarn is measured at the first frame, {context.scene.frame_start}")


class LISLE_RENDER_PT_motion_blur(LislePanel, bpy.types.Panel):
    bl_label = "Motion Blur"
    bl_context = "render"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context):
        self.layout.prop(context.scene.render, "use_motion_blur", text="")

    def draw(self, context):
        layout, render = self.split_layout(), context.scene.render
        layout.active = render.use_motion_blur
        layout.prop(render, "motion_blur_position", text="Position")
        layout.prop(render, "motion_blur_shutter", text="Shutter")
        layout.prop(context.scene.lisle, "motion_steps")


class LISLE_RENDER_PT_film(LislePanel, bpy.types.Panel):
    bl_label = "Film"
    bl_context = "render"

    def draw(self, context):
        layout, settings = self.split_layout(), context.scene.lisle
        layout.prop(context.scene.render, "film_transparent", text="Transparent")
        column = layout.column()
        column.active = settings.method != "REFERENCE"
        column.prop(settings, "filter")
        column.prop(settings, "filter_width")


PANELS = (
    LISLE_RENDER_PT_problem,
    LISLE_RENDER_PT_sampling,
    LISLE_RENDER_PT_stop,
    LISLE_RENDER_PT_shading,
    LISLE_RENDER_PT_reference,
    LISLE_RENDER_PT_motion_blur,
    LISLE_RENDER_PT_film,
)
