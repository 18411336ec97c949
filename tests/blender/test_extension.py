"""The extension as a whole: registration, panels, the manifest."""

import subprocess
import sys
from pathlib import Path

import pytest
import scenes

REPOSITORY = Path(__file__).parent.parent.parent

blender = pytest.mark.blender


@blender
def test_register_and_unregister_leave_nothing_behind(addon):
    import bpy

    def traces():
        owners = (bpy.types.Material, bpy.types.Scene, bpy.types.Object, bpy.types.ViewLayer)
        handlers = [
            h
            for name in ("render_init", "load_pre", "load_post", "frame_change_post")
            for h in getattr(bpy.app.handlers, name)
        ]
        handlers = [h for h in handlers if h.__module__.startswith("lisle_blender")]
        panels = [p for p in addon.ui.blender_panels._panels() if "LISLE" in p.COMPAT_ENGINES]
        classes = [c for c in bpy.types.RenderEngine.__subclasses__() if c.__module__.startswith("lisle_blender")]
        classes = [c for c in classes if c.is_registered]
        return [hasattr(owner, "lisle") for owner in owners], len(handlers), len(panels), len(classes)

    registered = traces()
    for _ in range(3):
        addon.unregister()
        assert traces() == ([False] * 4, 0, 0, 0)
        addon.register()
        assert traces() == registered


@blender
def test_settings_survive_a_file(addon, tmp_path):
    import bpy

    obj = scenes.curves("Yarn", scenes.line())
    obj.data.materials.append(material := bpy.data.materials.new("Wool"))
    material.lisle.yarn.preset, material.lisle.yarn.customize = "silk-1", True
    material.lisle.yarn.plies = 5
    obj.lisle.remeasure, bpy.context.scene.lisle.samples = True, 99
    bpy.context.view_layer.lisle.use_pass_tangent = True
    bpy.ops.wm.save_as_mainfile(filepath=str(tmp_path / "a.blend"))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.open_mainfile(filepath=str(tmp_path / "a.blend"))
    yarn = bpy.data.materials["Wool"].lisle.yarn
    assert (yarn.preset, yarn.customize, yarn.plies) == ("silk-1", True, 5)
    assert bpy.data.objects["Yarn"].lisle.remeasure and bpy.context.scene.lisle.samples == 99
    assert bpy.context.view_layer.lisle.use_pass_tangent and bpy.context.scene.render.engine == "LISLE"


@blender
def test_without_the_native_module_it_says_what_is_missing(addon, monkeypatch, capsys, tmp_path):
    import bpy

    addon.unregister()
    monkeypatch.setitem(sys.modules, "lisle", None)
    addon.register()
    assert "'lisle' cannot be loaded" in capsys.readouterr().out
    panel = addon.ui.render.LISLE_RENDER_PT_problem
    context = Context(engine="LISLE", scene=bpy.context.scene)
    assert panel.poll(context)
    layout = draw(panel, context)
    assert "wheel is missing" in " ".join(layout.texts)
    material = bpy.data.materials.new("Material")
    material.lisle.yarn.customize = True  # no preset to copy from: a message, no exception
    scenes.curves("Yarn", scenes.line())
    scenes.use_exr(tmp_path / "a.exr")
    with pytest.raises(RuntimeError, match="Install the Lisle package for this platform"):
        bpy.ops.render.render(write_still=True)
    assert not list(tmp_path.iterdir())


@blender
def test_an_older_blender_is_refused_by_name(addon, monkeypatch):
    monkeypatch.setattr(addon, "SUPPORTED", ((99, 0, 0), (100, 0, 0)))
    with pytest.raises(RuntimeError, match=r"needs Blender 99\.0 or later"):
        addon.register()


class Context:
    def __init__(self, **values):
        self.__dict__.update(values)


class Layout:
    """Stands in for bpy.types.UILayout, of which there is none without a window; refuses what it would refuse."""

    def __init__(self, texts=None):
        self.texts = [] if texts is None else texts

    def _child(self, **_):
        return Layout(self.texts)

    column = row = box = _child

    def prop(self, owner, name, text=None, **_):
        self.texts.append(owner.bl_rna.properties[name].name if text is None else text)

    def label(self, text="", icon="NONE"):
        self.texts.append(text)

    def template_icon_view(self, owner, name, **_):
        self.texts.append(owner.bl_rna.properties[name].name)


def draw(panel, context):
    class Drawn:
        layout = Layout()
        GROUP, FIELDS = getattr(panel, "GROUP", None), getattr(panel, "FIELDS", None)
        split_layout = panel.split_layout

    drawn = Drawn()
    panel.draw(drawn, context)
    return drawn.layout


@blender
def test_every_panel_draws(addon):
    import bpy

    obj = scenes.curves("Yarn", scenes.line())
    world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    background = world.node_tree.get_output_node("ALL").inputs["Surface"].links[0].from_node
    texture = world.node_tree.nodes.new("ShaderNodeTexEnvironment")  # without a picture
    world.node_tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    context = Context(
        engine="LISLE",
        scene=bpy.context.scene,
        view_layer=bpy.context.view_layer,
        object=obj,
        material=bpy.data.materials.new("Material"),
        world=world,
    )
    shown = set()
    mesh = scenes.empty_mesh("Mesh")
    for panel in addon.ui._PANELS:
        context.object = mesh if panel.__name__ == "LISLE_OBJECT_PT_mesh" else obj
        if panel.poll(context):
            shown.add(panel.__name__)
            assert draw(panel, context).texts, panel.__name__
        context.engine = "CYCLES"
        assert not panel.poll(context)
        context.scene.lisle.show_overlay = True
        assert panel.poll(context) == (panel.__name__.startswith(("LISLE_MATERIAL", "LISLE_OBJECT_PT_yarn")))
        context.scene.lisle.show_overlay = False
        context.engine = "LISLE"
    assert shown == {panel.__name__ for panel in addon.ui._PANELS} - {"LISLE_RENDER_PT_problem"}


@blender
def test_every_number_of_a_yarn_and_fiber_has_a_place_in_a_panel(addon):
    panels = addon.ui.material.PANELS
    for group, name in ((addon.properties.LisleYarn, "yarn"), (addon.properties.LisleFiber, "fiber")):
        shown = [field for panel in panels if getattr(panel, "GROUP", None) == name for field in panel.FIELDS]
        assert sorted(shown) == sorted(group.FIELDS)


@blender
def test_every_setting_is_explained_and_lengths_and_angles_have_units(addon):
    import bpy

    groups = [cls for cls in vars(addon.properties).values() if isinstance(cls, type)]
    groups = [cls for cls in groups if issubclass(cls, bpy.types.PropertyGroup)]
    assert len(groups) >= 6
    for group in groups:
        for prop in group.bl_rna.properties:
            if prop.identifier in group.__annotations__ and prop.type != "POINTER":
                assert prop.description and prop.description != prop.name, (group, prop.identifier)
    units = {
        (addon.properties.LisleObjectSettings, "yarn_radius"): "LENGTH",
        (addon.properties.LisleYarn, "hair_theta_span"): "ROTATION",
        (addon.properties.LisleFiber, "beta_r"): "ROTATION",
        (addon.properties.LisleSceneSettings, "time_limit"): "TIME_ABSOLUTE",
    }
    for (group, name), unit in units.items():
        assert group.bl_rna.properties[name].unit == unit, name


@blender
def test_blenders_own_panels_apply(addon):
    import bpy

    names = {p.__name__ for p in addon.ui.blender_panels._panels() if "LISLE" in p.COMPAT_ENGINES}
    assert names >= {
        "RENDER_PT_format", "RENDER_PT_frame_range", "RENDER_PT_output", "RENDER_PT_color_management",
        "DATA_PT_lens", "DATA_PT_camera", "DATA_PT_EEVEE_light", "DATA_PT_spot", "WORLD_PT_context_world",
        "EEVEE_WORLD_PT_surface", "EEVEE_MATERIAL_PT_context_material", "VIEWLAYER_PT_layer",
    }  # fmt: skip
    assert not [name for name in names if "freestyle" in name] and "DATA_PT_light" not in names
    assert bpy.context.scene.render.engine == "LISLE"


def blender_ext():
    """Blender's own extension tool."""
    import bpy

    return Path(bpy.utils.system_resource("SCRIPTS")) / "addons_core/bl_pkg/cli/blender_ext.py"


@blender
def test_manifest_is_valid(addon):
    import tomllib

    command = [sys.executable, str(blender_ext()), "validate", str(REPOSITORY / "addon")]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    # Without its wheel the folder is no package yet; all else has to be right.
    complaints = [line for line in (result.stdout + result.stderr).splitlines() if "rror" in line]
    assert all("wheel" in line for line in complaints), complaints
    manifest = tomllib.loads((REPOSITORY / "addon" / "blender_manifest.toml").read_text())
    assert manifest["id"] == "lisle_blender" and manifest["license"] == ["SPDX:GPL-3.0-or-later"]
    assert tuple(map(int, manifest["blender_version_min"].split("."))) == addon.SUPPORTED[0]
