# SPDX-License-Identifier: GPL-3.0-or-later
"""The settings that are stored in .blend files: `material.lisle`, `scene.lisle`, `object.lisle`, `view_layer.lisle`.

A yarn or fiber is a preset of the native module; 'Customize' copies its numbers into the properties here, which
count from then on. Every property has the name of the native field it stands for.
"""

import functools
from math import radians

import bpy

from . import native, overrides
from .core.errors import NativeError
from .presets import DEFAULT_FIBER, DEFAULT_YARN, FIBER_ITEMS, YARN_ITEMS, number_of, thumbnails
from .presets.thumbnails import items_of

_OVERRIDABLE = {"LIBRARY_OVERRIDABLE"}
BoolProperty, EnumProperty, FloatProperty, FloatVectorProperty, IntProperty, PointerProperty = (
    functools.partial(make, override=_OVERRIDABLE)
    for make in (
        bpy.props.BoolProperty,
        bpy.props.EnumProperty,
        bpy.props.FloatProperty,
        bpy.props.FloatVectorProperty,
        bpy.props.IntProperty,
        bpy.props.PointerProperty,
    )
)


def _tag(group, _context):
    """Tells views that what they show has changed: Blender does not do so for an extension's properties."""
    overrides.keep(group.id_data)
    group.id_data.update_tag()


def from_native(group, preset, field):
    """What a property of a group has for a native preset: Blender's angles are in radians."""
    if field in group.ANGLES:
        return radians(getattr(preset, f"{field}_deg"))
    return getattr(preset, field)


def _make_sockets(group, _context):
    """Gives the compositor's nodes the sockets of the passes that are on."""
    for view_layer in group.id_data.view_layers:
        view_layer.update_render_passes()


def _fill_from_preset(group, context):
    """Copies the preset's numbers, so that customizing starts from what is on screen."""
    _tag(group, context)
    if not group.customize:
        return
    try:
        preset = group.native_preset(native.module())
    except NativeError as error:
        print(f"Lisle: {error}")
        return
    for field in group.FIELDS:
        setattr(group, field, from_native(group, preset, field))


def _length(name, description, **options):
    return FloatProperty(name=name, description=description, precision=4, step=0.1, update=_tag, **options)


def _variate(name, description, **options):
    description = f"{description}: mean and standard deviation"
    return FloatVectorProperty(name=name, description=description, size=2, precision=4, update=_tag, **options)


def _color(name, description):
    return FloatVectorProperty(name=name, description=description, subtype="COLOR", size=3, min=0, max=1, update=_tag)


def _angle(name, description):
    return FloatProperty(
        name=name,
        description=description,
        min=radians(0.1),
        max=radians(90),
        default=radians(10),
        subtype="ANGLE",
        update=_tag,
    )


def _pass(name, description):
    return BoolProperty(name=name, description=description, update=_make_sockets)


def yarn_radius(description, **options):
    """A property of an object or an operator."""
    return FloatProperty(
        name="Yarn Radius",
        description=description,
        **{"min": 0, "soft_max": 0.1, "precision": 5, "step": 0.01, "subtype": "DISTANCE"} | options,
    )


class LisleYarn(bpy.types.PropertyGroup):
    """A procedural yarn. Lengths are relative: the yarn is scaled to the radius of its curve."""

    FIELDS = (
        "plies", "fibers_per_ply", "ply_twist", "fiber_twist", "ply_radius", "ellipse_long", "ellipse_short",
        "fiber_radius", "density_beta", "density_epsilon", "r_min", "migration_rate",
        "loop_density", "hair_density", "loop_r_max", "hair_r_min", "hair_r_span", "hair_z_span", "hair_theta_span",
    )  # fmt: skip
    ANGLES = ()

    preset: EnumProperty(
        name="Yarn",
        description="The measured yarn it is spun like",
        items=items_of("yarn", YARN_ITEMS),
        default=number_of(DEFAULT_YARN, YARN_ITEMS),
        update=_fill_from_preset,
    )
    customize: BoolProperty(
        name="Customize",
        description="Change the yarn's numbers; choosing a yarn sets them all again",
        update=_fill_from_preset,
    )
    plies: IntProperty(name="Plies", description="Plies twisted into the yarn", min=1, max=16, default=3, update=_tag)
    fibers_per_ply: IntProperty(
        name="Fibers per Ply",
        description="Fibers twisted into each ply",
        min=1,
        soft_max=300,
        max=60000,
        default=75,
        update=_tag,
    )
    ply_twist: _length(
        "Ply Twist", "Length of yarn for one turn of its plies; the sign is the direction", default=0.453
    )
    fiber_twist: _length(
        "Fiber Twist", "Length of ply for one turn of its fibers; the sign is the direction", default=-0.369
    )
    ply_radius: _length("Ply Spread", "Diameter of the helix that the plies follow", min=0, default=0.038)
    ellipse_long: _length("Ply Width", "Long half axis of a ply's section", min=1e-5, default=0.026)
    ellipse_short: _length("Ply Thickness", "Short half axis of a ply's section", min=1e-5, default=0.02)
    fiber_radius: _length("Fiber Radius", "Radius of one fiber", min=1e-6, default=0.002)
    density_beta: FloatProperty(
        name="Density Falloff",
        description="How strongly fibers gather at the ply's core",
        min=0,
        soft_max=1,
        update=_tag,
    )
    density_epsilon: FloatProperty(
        name="Density Floor", description="Share of the fibers spread evenly over the ply", min=0, max=0.5, update=_tag
    )
    r_min: FloatProperty(
        name="Migration Depth",
        description="Least relative radius of a fiber that wanders inwards",
        min=0,
        max=1,
        update=_tag,
    )
    migration_rate: FloatProperty(
        name="Migration Rate",
        description="Times a fiber wanders in and out per turn",
        min=0.01,
        soft_max=5,
        default=1,
        update=_tag,
    )
    loop_density: FloatProperty(
        name="Loops",
        description="Fibers that leave the ply as loops, per unit of length",
        min=0,
        soft_max=100,
        update=_tag,
    )
    hair_density: FloatProperty(
        name="Hairs", description="Fibers that end in the air, per unit of length", min=0, soft_max=100, update=_tag
    )
    loop_r_max: _variate("Loop Height", "Largest distance of a loop from the ply's centre")
    hair_r_min: _variate("Hair Start", "Distance from the ply's centre at which a hair leaves")
    hair_r_span: _variate("Hair Reach", "How much farther out its tip is")
    hair_z_span: _variate("Hair Slant", "Its extent along the ply")
    hair_theta_span: _variate("Hair Turn", "Angle it turns around the ply", unit="ROTATION")

    def native_preset(self, lisle):
        return lisle.Yarn.preset(self.preset)


class LisleFiber(bpy.types.PropertyGroup):
    """How a fiber scatters light: reflection (R), transmission (TT), and a diffuse part."""

    FIELDS = (
        "color_r", "color_tt", "beta_r", "beta_tt", "gamma_tt",
        "diffuse", "diffuse_weight", "specular", "specular_beta",
    )  # fmt: skip
    ANGLES = ("beta_r", "beta_tt", "gamma_tt", "specular_beta")

    preset: EnumProperty(
        name="Fiber",
        description="The measured fiber it scatters light like",
        items=items_of("fiber", FIBER_ITEMS),
        default=number_of(DEFAULT_FIBER, FIBER_ITEMS),
        update=_fill_from_preset,
    )
    customize: BoolProperty(
        name="Customize",
        description="Change the fiber's numbers; choosing a fiber sets them all again",
        update=_fill_from_preset,
    )
    color_r: _color("Reflection", "Share of the light that is reflected straight on, before the Fresnel rise")
    color_tt: _color("Transmission", "Share of the light entering a fiber that passes through it: the yarn's colour")
    beta_r: _angle("Reflection Width", "Width of the highlight along the fiber")
    beta_tt: _angle("Transmission Width", "Spread of transmitted light along the fiber")
    gamma_tt: _angle("Transmission Spread", "Spread of transmitted light around the fiber")
    diffuse: _color("Diffuse", "Colour of the diffuse part")
    diffuse_weight: FloatProperty(
        name="Diffuse Weight",
        description="Share of the diffuse part in physical shading, 0 for bare fibers",
        min=0,
        max=1,
        update=_tag,
    )
    specular: _color("Specular", "Colour of the highlight in simple shading")
    specular_beta: _angle("Specular Width", "Width of the highlight in simple shading")

    def native_preset(self, lisle):
        return lisle.Material.preset(self.preset)


class LisleMaterialSettings(bpy.types.PropertyGroup):
    """`material.lisle`"""

    yarn: PointerProperty(type=LisleYarn)
    fiber: PointerProperty(type=LisleFiber)


class LisleSceneSettings(bpy.types.PropertyGroup):
    """`scene.lisle`"""

    show_overlay: BoolProperty(
        name="Yarn Fibers",
        description="Draw yarn with its fibers over the viewport's picture, in any shading mode and with any engine",
        update=_tag,
    )

    method: EnumProperty(
        name="Pictures",
        description="How final pictures are drawn; viewports are always drawn in real time",
        items=(
            ("REAL_TIME", "Real Time", "By the renderer of the viewport", 0),
            (
                "REFERENCE",
                "Reference",
                "By a path tracer through every fiber, on all cores: slow, and right. "
                "It takes 40 bytes of memory for each segment of a fiber, up to 200 while it starts",
                1,
            ),
        ),
    )
    samples: IntProperty(
        name="Samples", description="Jittered samples per pixel", min=1, soft_max=256, max=65536, default=16
    )
    reference_samples: IntProperty(
        name="Samples",
        description="Paths per pixel of a reference picture",
        min=1,
        soft_max=4096,
        max=65536,
        default=64,
    )
    reference_bounces: IntProperty(
        name="Bounces",
        description="Most times that light is scattered in a reference picture; 0 for any number",
        min=0,
        soft_max=64,
        max=65536,
        default=0,
    )
    viewport_samples: IntProperty(
        name="Viewport Samples",
        description="Samples per pixel after which a picture in the viewport is finished",
        min=1,
        soft_max=64,
        max=65536,
        default=8,
        update=_tag,
    )
    shading: EnumProperty(
        name="Shading",
        description="How fibers scatter light",
        items=(
            ("physical", "Physical", "Reflection and transmission, as measured on fibers", 0),
            ("simple", "Simple", "A highlight and a diffuse part; faster", 1),
        ),
        update=_tag,
    )
    multiple_scattering: BoolProperty(
        name="Multiple Scattering",
        description="Light that fibers send each other, which gives light yarn most of its colour. Computed once for "
        "each yarn and material, for some seconds, and kept on disk",
        default=True,
        update=_tag,
    )
    occlusion: EnumProperty(
        name="Ambient Occlusion",
        description="How deep fibers receive less light from the surroundings",
        items=(
            ("distance", "Distance", "From the distance to the yarn's centre", 0),
            ("table", "Table", "Precomputed over the yarn's section", 1),
        ),
        update=_tag,
    )
    lod: FloatProperty(
        name="Level of Detail",
        description="Fibers thinner than this many pixels are merged; 0 draws every fiber",
        min=0,
        max=16,
        default=1,
        subtype="PIXEL",
        update=_tag,
    )
    use_noise_threshold: BoolProperty(
        name="Noise Threshold",
        description="Stop before all samples are drawn, when the picture is smooth enough",
    )
    noise_threshold: FloatProperty(
        name="Threshold",
        description="Noise at which to stop, relative to the colour's square root. Looked at after 16, 32, 64 samples "
        "and so on",
        min=0.0001,
        soft_min=0.001,
        max=1,
        default=0.01,
        precision=4,
    )
    time_limit: FloatProperty(
        name="Time Limit",
        description="Stop when a picture has taken so long; 0 for no limit",
        min=0,
        subtype="TIME_ABSOLUTE",
        unit="TIME_ABSOLUTE",
    )
    filter: EnumProperty(
        name="Pixel Filter",
        description="How samples are spread about a pixel's center",
        items=(
            ("blackman-harris", "Blackman-Harris", "Smooth, without ringing", 0),
            ("gaussian", "Gaussian", "Sharper at the same width", 1),
            ("box", "Box", "Even", 2),
        ),
    )
    filter_width: FloatProperty(
        name="Width",
        description="Width of the pixel filter",
        min=0.01,
        soft_max=10,
        max=100,
        default=1.5,
        subtype="PIXEL",
    )
    motion_steps: IntProperty(
        name="Steps",
        description="Times at which the scene is evaluated while the shutter is open, besides its opening. "
        "Between them everything moves evenly",
        min=1,
        soft_max=8,
        max=64,
        default=2,
    )
    seed: IntProperty(name="Seed", description="Seed of the sample pattern", min=0, update=_tag)
    use_reference_frame: BoolProperty(
        name="Custom Reference Frame",
        description="Measure yarn at a frame of your choice, not at the start of the frame range",
        update=_tag,
    )
    reference_frame: IntProperty(
        name="Frame",
        description="Frame at which yarn has its natural length; fibers keep their places on it in all frames",
        default=1,
        update=_tag,
    )


class LisleObjectSettings(bpy.types.PropertyGroup):
    """`object.lisle`"""

    mesh_kind: EnumProperty(
        name="Mesh",
        description="What is seen of this object's mesh. What is seen at all hides yarn and throws shadows on it",
        items=(
            ("SHADED", "Shaded", "A matt surface of the material's base colour", 0),
            ("SHADOW_CATCHER", "Shadow Catcher", "Only the shadows on it, to lay over a photograph", 1),
            ("HOLDOUT", "Holdout", "A hole in the picture", 2),
            ("INVISIBLE", "Invisible", "Nothing, nor its shadow", 3),
        ),
        update=_tag,
    )

    is_yarn: EnumProperty(
        name="Curves",
        description="Whether this object's curves are drawn as yarn",
        items=(
            (
                "AUTO",
                "Automatic",
                "Yarn, unless the curve serves another object as a path, a profile, a taper or a guide",
                0,
            ),
            ("ALWAYS", "Yarn", "Yarn, whatever else the curve serves as", 1),
            ("NEVER", "No Yarn", "Not drawn as yarn; a curve with a bevel is a mesh, as in other engines", 2),
        ),
        update=_tag,
    )
    yarn_radius: yarn_radius(
        "Radius of the yarn; 0 takes the curve's own. Multiplies the point radius of legacy curves", update=_tag
    )
    use_reference_frame: BoolProperty(
        name="Own Reference Frame",
        description="Measure this object's yarn at its own frame, not at the scene's",
        update=_tag,
    )
    reference_frame: IntProperty(
        name="Frame", description="Frame at which this object's yarn has its natural length", default=1, update=_tag
    )
    remeasure: BoolProperty(
        name="Re-measure Each Frame",
        description="Take every frame's curves as yarn at rest. For curves whose number of points changes: "
        "fibers then slide along yarn that stretches",
        update=_tag,
    )


class LisleViewLayerSettings(bpy.types.PropertyGroup):
    """`view_layer.lisle`"""

    use_pass_tangent: _pass("Fiber Tangent", "Direction of the fibers, world space")
    use_pass_coverage: _pass("Coverage", "Alpha of what is drawn, also where the film is opaque")
    use_pass_diffuse: _pass(
        "Diffuse",
        "Light of lamps by the diffuse part. This pass and the next four add up to the colour of the yarn",
    )
    use_pass_specular: _pass("Specular", "Light of lamps that fibers reflect")
    use_pass_transmission: _pass("Transmission", "Light of lamps that shines through fibers")
    use_pass_scattered: _pass("Scattered", "Light of lamps that is scattered more than once")
    use_pass_ambient: _pass("Ambient", "Light of the surroundings, without the background")
    use_pass_shadow: _pass("Shadow", "Share of the lamps' light that shadows leave, from 0 in the dark to 1")
    use_pass_denoising: _pass(
        "Denoising Data", "Denoising Albedo and Denoising Normal, for the compositor's Denoise node"
    )


_GROUPS = (
    LisleYarn,
    LisleFiber,
    LisleMaterialSettings,
    LisleSceneSettings,
    LisleObjectSettings,
    LisleViewLayerSettings,
)
_OWNERS = (
    (bpy.types.Material, LisleMaterialSettings),
    (bpy.types.Scene, LisleSceneSettings),
    (bpy.types.Object, LisleObjectSettings),
    (bpy.types.ViewLayer, LisleViewLayerSettings),
)


def register():
    thumbnails.register()
    for group in _GROUPS:
        bpy.utils.register_class(group)
    for owner, group in _OWNERS:
        owner.lisle = PointerProperty(type=group)


def unregister():
    for owner, _ in _OWNERS:
        del owner.lisle
    for group in reversed(_GROUPS):
        bpy.utils.unregister_class(group)
    thumbnails.unregister()
