"""Materials, lights, camera and world, as they reach the native module."""

import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.blender


def render(lisle):
    import bpy

    bpy.ops.render.render()
    return lisle.scenes[-1][0]


def material(name="Material"):
    import bpy

    return bpy.data.materials.new(name)


def test_no_material_is_the_default(lisle):
    obj = scenes.curves("Yarn", scenes.line())
    bare = render(lisle).entries[0]
    obj.data.materials.append(material())
    untouched = render(lisle).entries[0]
    obj.data.materials[0] = None
    empty_slot = render(lisle).entries[0]
    for entry in (untouched, empty_slot):
        assert entry.yarn.__dict__ == bare.yarn.__dict__
        assert entry.material.__dict__ == bare.material.__dict__


def test_presets_reach_the_renderer(lisle):
    mat = material()
    scenes.curves("Yarn", scenes.line()).data.materials.append(mat)
    mat.lisle.yarn.preset, mat.lisle.fiber.preset = "silk-2", "gabardine"
    entry = render(lisle).entries[0]
    assert (entry.yarn.name, entry.material.name) == ("silk-2", "gabardine")


def test_customizing_starts_from_the_preset(lisle):
    mat = material()
    scenes.curves("Yarn", scenes.line()).data.materials.append(mat)
    yarn, fiber = mat.lisle.yarn, mat.lisle.fiber
    yarn.plies = 9
    assert render(lisle).entries[0].yarn.plies == 3, "numbers do not count before 'Customize'"
    yarn.customize = fiber.customize = True
    assert yarn.plies == 3 and yarn.hair_density == pytest.approx(33.77)
    yarn.plies, yarn.loop_r_max = 2, (0.5, 0.25)
    fiber.color_tt = (0.25, 0.5, 0.75)
    entry = render(lisle).entries[0]
    assert entry.yarn.plies == 2 and entry.yarn.loop_r_max == (0.5, 0.25)
    assert entry.yarn.ply_twist == pytest.approx(0.453)
    assert entry.material.color_tt == (0.25, 0.5, 0.75)
    assert fiber.beta_tt == pytest.approx(np.radians(27)) and fiber.bl_rna.properties["beta_tt"].subtype == "ANGLE"
    assert (entry.material.beta_r_deg, entry.material.beta_tt_deg, entry.material.gamma_tt_deg) == (1, 27, 38)
    fiber.specular_beta = np.radians(90)
    assert render(lisle).entries[0].material.specular_beta_deg == 90
    yarn.preset = "rayon-1"
    assert yarn.plies == 3, "choosing a preset sets all numbers again"


def test_animated_material_numbers(lisle):
    import bpy

    mat = material()
    scenes.curves("Yarn", scenes.line()).data.materials.append(mat)
    mat.lisle.yarn.customize = True
    for frame, density in ((1, 10), (3, 30)):
        mat.lisle.yarn.hair_density = density
        mat.lisle.yarn.keyframe_insert("hair_density", frame=frame)
    bpy.context.scene.frame_set(3)
    assert render(lisle).entries[0].yarn.hair_density == pytest.approx(30)


@pytest.mark.parametrize("legacy", [False, True])
def test_one_object_with_two_materials(lisle, legacy):
    first, second = scenes.line(), scenes.line(7, (-3, 1, 0), (3, 1, 0))
    if legacy:
        obj = scenes.legacy("Yarn", "POLY", first.tolist())
        scenes.add_spline(obj.data, "POLY", second.tolist()).material_index = 1
    else:
        obj = scenes.curves("Yarn", first, second)
    for preset in ("cotton-1", "silk-1"):
        obj.data.materials.append(mat := material())
        mat.lisle.yarn.preset = preset
    if not legacy:
        obj.data.attributes.new("material_index", "INT", "CURVE").data.foreach_set("value", [0, 1])
    elif not obj.data.splines[1].material_index:  # set again: it is limited to the slots there are
        obj.data.splines[1].material_index = 1
    entries = render(lisle).entries
    assert [(entry.yarn.name, len(entry.yarns.points)) for entry in entries] == [("cotton-1", 20), ("silk-1", 7)]
    np.testing.assert_allclose(entries[1].yarns.points, second)


def test_a_slot_linked_to_the_object_wins(lisle):
    obj = scenes.curves("Yarn", scenes.line())
    obj.data.materials.append(mat := material("Of the data"))
    mat.lisle.yarn.preset = "silk-1"
    obj.material_slots[0].link = "OBJECT"
    obj.material_slots[0].material = mat = material("Of the object")
    mat.lisle.yarn.preset = "rayon-4"
    assert render(lisle).entries[0].yarn.name == "rayon-4"


def test_material_set_by_geometry_nodes(lisle):
    mat = material()
    mat.lisle.yarn.preset = "rayon-4"
    for obj in (scenes.curves("Own", scenes.line()), scenes.empty_mesh("Maker")):
        nodes = scenes.Nodes(obj)
        geometry = nodes.input
        if obj.type == "MESH":
            circle = nodes.new("CurvePrimitiveCircle").outputs[0]
            geometry = nodes.new("InstanceOnPoints", Points=nodes.input, Instance=circle).outputs[0]
        nodes.finish(nodes.new("SetMaterial", Geometry=geometry, Material=mat).outputs[0])
    assert [entry.yarn.name for entry in render(lisle).entries] == ["rayon-4"] * 2


def light(kind, **settings):
    import bpy

    data = bpy.data.lights.new("Light", kind)
    for name, value in settings.items():
        setattr(data, name, value)
    obj = scenes.link(bpy.data.objects.new("Light", data))
    obj.location = (1, 2, 3)
    obj.rotation_euler = (np.pi / 2, 0, 0)  # turns its −Z to +Y
    return obj


def the_light(lisle, kind):
    (native,) = render(lisle).lights
    assert type(native).__name__ == kind
    return native


def test_sun(lisle):
    light("SUN", energy=3, angle=0.1, color=(1, 0.5, 0.25))
    sun = the_light(lisle, "Sun")
    np.testing.assert_allclose(sun.direction, (0, 1, 0), atol=1e-6)
    assert sun.strength == 3 and sun.color == (1, 0.5, 0.25) and sun.angle_rad == pytest.approx(0.1)


def test_point(lisle):
    obj = light("POINT", energy=40, shadow_soft_size=0.5, exposure=1)
    point = the_light(lisle, "Point")
    assert point.position == (1, 2, 3) and point.power == 80 and point.radius == 0.5
    obj.data.normalize = False
    assert the_light(lisle, "Point").power == pytest.approx(80 * np.pi)


def test_light_temperature_tints(lisle):
    obj = light("POINT", use_temperature=True, temperature=3000, color=(1, 1, 0.5))
    red, green, blue = the_light(lisle, "Point").color
    np.testing.assert_allclose((red, green, blue * 2), obj.data.temperature_color, rtol=1e-6)
    assert red > green > blue


def test_spot(lisle):
    light("SPOT", energy=40, spot_size=1.25, spot_blend=0.5, shadow_soft_size=0.25).scale = (2, 3, 4)
    spot = the_light(lisle, "Spot")
    np.testing.assert_allclose(spot.direction, (0, 1, 0), atol=1e-6)
    assert (spot.power, spot.cone_angle_rad, spot.blend, spot.radius) == (40, 1.25, 0.5, 0.25)


@pytest.mark.parametrize(
    ("shape", "native_shape", "size"),
    [
        ("SQUARE", "rectangle", (4, 6)),
        ("RECTANGLE", "rectangle", (4, 1.5)),
        ("DISK", "disk", (4, 6)),
        ("ELLIPSE", "disk", (4, 1.5)),
    ],
)
def test_area(lisle, shape, native_shape, size):
    obj = light("AREA", energy=40, shape=shape, size=2, size_y=0.5)
    obj.scale = (2, 3, 4)
    area = the_light(lisle, "Area")
    assert (area.shape, area.power) == (native_shape, 40)
    np.testing.assert_allclose(area.size, size, rtol=1e-6)
    np.testing.assert_allclose(area.world_from_light[:3, 3], (1, 2, 3))
    np.testing.assert_allclose(area.world_from_light[:3, :3].T @ area.world_from_light[:3, :3], np.eye(3), atol=1e-6)
    np.testing.assert_allclose(area.world_from_light[:3, 2], (0, -1, 0), atol=1e-6)


def test_instanced_and_hidden_lights(lisle):
    scenes.collection_instance("Lamps", light("POINT"), location=(10, 0, 0))
    light("POINT").hide_render = True
    assert the_light(lisle, "Point").position == (11, 2, 3)


def project(camera, point):
    """Normalised device coordinates, x and y in −1 to 1 inside the frame."""
    clip = camera.clip_from_camera @ np.linalg.inv(camera.world_from_camera) @ (*point, 1)
    return clip[:2] / clip[3]


@pytest.mark.parametrize("kind", ["PERSP", "ORTHO"])
@pytest.mark.parametrize("fit", ["AUTO", "HORIZONTAL", "VERTICAL"])
@pytest.mark.parametrize("size", [(640, 480), (480, 640)])
def test_camera_sees_what_blender_says(lisle, kind, fit, size):
    """Blender's `world_to_camera_view` is the judge, with shift, scale and pixel aspect."""
    import bpy
    from bpy_extras.object_utils import world_to_camera_view
    from mathutils import Vector

    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.pixel_aspect_y = 1.5
    camera = scene.camera
    camera.location, camera.rotation_euler, camera.scale = (3, -6, 4), (1, 0.1, 0.4), (2, 2, 2)
    camera.data.type, camera.data.sensor_fit = kind, fit
    camera.data.shift_x, camera.data.shift_y = 0.1, -0.05
    camera.data.ortho_scale, camera.data.lens = 7, 35
    scenes.curves("Yarn", scenes.line())
    native = render(lisle).camera
    assert native.size == size
    for point in ((0, 0, 0), (1, 2, 0.5), (-2, 0.5, 1)):
        expected = world_to_camera_view(scene, camera, Vector(point))
        np.testing.assert_allclose(project(native, point) / 2 + 0.5, expected[:2], atol=1e-5)


def sky_world(name="Sky", size=(8, 4), is_float=True, mapping=None):
    """A world lit by a generated picture: (world, image, its texels (h, w, 4), row 0 at the top)."""
    import bpy

    world = bpy.data.worlds.new(name)
    if bpy.app.version < (5, 0, 0):
        world.use_nodes = True
    tree = world.node_tree
    image = bpy.data.images.new(name, *size, float_buffer=is_float)
    texels = np.random.default_rng(3).uniform(0, 1, (size[1], size[0], 4)).astype(np.float32)
    image.pixels.foreach_set(texels[::-1].ravel())
    texture = tree.nodes.new("ShaderNodeTexEnvironment")
    texture.image = image
    background = tree.get_output_node("ALL").inputs["Surface"].links[0].from_node
    background.inputs["Strength"].default_value = 1.5
    tree.links.new(texture.outputs["Color"], background.inputs["Color"])
    if mapping is not None:
        node = tree.nodes.new("ShaderNodeMapping")
        node.vector_type = mapping
        node.inputs["Rotation"].default_value = (0.1, -0.2, 0.9)
        coordinates = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(coordinates.outputs["Generated"], node.inputs["Vector"])
        tree.links.new(node.outputs["Vector"], texture.inputs["Vector"])
    return world, image, texels


def drawn_world(lisle, world):
    """(lisle.Scene as drawn, notes about it)."""
    import bpy
    from lisle_blender.export.world import plan_of

    bpy.context.scene.world = world
    bpy.ops.render.render()
    notes = []
    plan_of(world, notes.append)
    return lisle.scenes[-1][0], notes


def test_world_picture_lights_and_turns(lisle):
    from mathutils import Euler

    scenes.curves("Yarn", scenes.line())
    turn = np.array(Euler((0.1, -0.2, 0.9)).to_matrix())
    for mapping, expected in ((None, np.eye(3)), ("POINT", turn.T), ("TEXTURE", turn)):
        world, _, texels = sky_world(mapping=mapping)
        scene, notes = drawn_world(lisle, world)
        assert notes == []
        assert scene.ambient == (0, 0, 0)
        np.testing.assert_array_equal(scene.environment.image.texels, texels[:, :, :3])
        np.testing.assert_allclose(scene.environment.world_from_environment, expected, atol=1e-6)
        assert scene.environment.strength == 1.5


def test_world_picture_of_bytes_is_decoded(lisle):
    scenes.curves("Yarn", scenes.line())
    world, image, texels = sky_world(is_float=False)
    codes = np.round(texels[:, :, :3].astype(np.float64) * 255) / 255

    def drawn(space):
        image.colorspace_settings.name = space  # which makes the generated pixels again
        image.pixels.foreach_set(texels[::-1].ravel())
        return drawn_world(lisle, world)[0].environment.image.texels

    linear = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(drawn("sRGB"), linear, atol=1e-4)
    np.testing.assert_allclose(drawn("Non-Color"), codes, atol=1e-4)


def test_world_picture_is_read_once_until_its_pixels_change(lisle):
    import bpy
    from lisle_blender.export.world import forget_images, read_world

    world, image, texels = sky_world()
    first = read_world(lisle, world, print)
    assert read_world(lisle, world, print).environment.image is first.environment.image
    assert first.equals(read_world(lisle, world, print))
    world.node_tree.get_output_node("ALL").inputs["Surface"].links[0].from_node.inputs["Strength"].default_value = 2
    assert not first.equals(read_world(lisle, world, print))
    image.pixels.foreach_set(np.zeros(texels.size, np.float32))
    forget_images()
    assert not read_world(lisle, world, print).environment.image.texels.any()
    bpy.context.scene.world = None


def test_what_a_world_leaves_out_is_noted(lisle):
    scenes.curves("Yarn", scenes.line())
    world, _, _ = sky_world(mapping="POINT")
    mapping = next(node for node in world.node_tree.nodes if node.type == "MAPPING")
    mapping.inputs["Scale"].default_value = (1, 1, 2)
    scene, notes = drawn_world(lisle, world)
    assert len(notes) == 1 and "only the rotation" in notes[0]
    texture = next(node for node in world.node_tree.nodes if node.type == "TEX_ENVIRONMENT")
    texture.image = None
    scene, notes = drawn_world(lisle, world)
    assert len(notes) == 1 and "no picture" in notes[0]
    assert scene.environment is None and scene.ambient == (0, 0, 0)


def test_world_without_nodes_and_with_unreadable_ones(lisle):
    import bpy

    scene = bpy.context.scene
    scenes.curves("Yarn", scenes.line())
    assert tuple(render(lisle).ambient) == (0, 0, 0)
    world = scene.world = bpy.data.worlds.new("World")
    if bpy.app.version < (5, 0, 0):
        world.color = (0.1, 0.2, 0.3)
        np.testing.assert_allclose(render(lisle).ambient, (0.1, 0.2, 0.3), rtol=1e-6)
        world.use_nodes = True
    tree = world.node_tree
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    background.inputs["Color"].default_value = (0.5, 0.25, 0.125, 1)
    strength = tree.nodes.new("ShaderNodeValue")
    strength.outputs[0].default_value = 3
    tree.links.new(strength.outputs[0], background.inputs["Strength"])
    np.testing.assert_allclose(render(lisle).ambient, (1.5, 0.75, 0.375))
    tree.links.new(tree.nodes.new("ShaderNodeTexChecker").outputs[0], background.inputs["Color"])
    np.testing.assert_allclose(render(lisle).ambient, (1.5, 0.75, 0.375))
    tree.links.clear()
    assert tuple(render(lisle).ambient) == (0, 0, 0)


def test_worlds_are_read_past_reroutes_and_muted_nodes(lisle):
    scenes.curves("Yarn", scenes.line())
    world, _, _ = sky_world(mapping="POINT")
    tree = world.node_tree
    for link in list(tree.links):
        reroute = tree.nodes.new("NodeReroute")
        tree.links.new(link.from_socket, reroute.inputs[0])
        tree.links.new(reroute.outputs[0], link.to_socket)
    scene, notes = drawn_world(lisle, world)
    assert notes == [] and scene.environment.strength == 1.5
    turn = scene.environment.world_from_environment
    assert not np.allclose(turn, np.eye(3))
    mapping = next(node for node in tree.nodes if node.type == "MAPPING")
    mapping.mute = True
    np.testing.assert_array_equal(drawn_world(lisle, world)[0].environment.world_from_environment, np.eye(3))
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    background.mute = True
    scene, _ = drawn_world(lisle, world)
    assert scene.environment is None and scene.ambient == (0, 0, 0)


def test_a_light_that_cannot_be_drawn_is_named(lisle, monkeypatch):
    def refuse(**_):
        raise lisle.InputError("Sun.strength: -1 is less than 0")

    monkeypatch.setattr(lisle, "Sun", refuse)
    light("SUN", energy=1)
    with pytest.raises(RuntimeError, match=r"light 'Light': Sun\.strength"):
        render(lisle)


@pytest.mark.parametrize("kind", ["SUN", "POINT", "SPOT", "AREA"])
def test_lights_without_light_are_noted(lisle, kind):
    import bpy
    from lisle_blender.export.scene import collect

    def collected():
        bpy.context.view_layer.update()
        notes = []
        return collect(lisle, bpy.context.evaluated_depsgraph_get(), notes.append).lights, notes

    obj = light(kind, energy=1)
    assert len(collected()[0]) == 1 and not collected()[1]
    obj.scale = (1, 1, 0) if kind != "AREA" else (0, 1, 1)
    lights, notes = collected()
    if kind == "POINT":
        assert len(lights) == 1, "a point looks the same at any scale"
    else:
        assert not lights and "light 'Light': it is scaled to 0" in notes[0]
    obj.scale = (1, 1, 1)
    obj.data.energy = -1
    lights, notes = collected()
    assert not lights and "light 'Light': its strength is negative" in notes[0]
    if kind == "AREA":
        obj.data.energy, obj.data.size = 1, 0
        lights, notes = collected()
        assert not lights and "light 'Light': its size is 0" in notes[0]


def test_nothing_of_scale_0_stops_a_picture(lisle):
    scenes.curves("Yarn", scenes.line()).scale = (0, 0, 0)
    light("AREA", energy=1).scale = (0, 0, 0)
    light("SUN", energy=1).scale = (0, 0, 0)
    scene = render(lisle)
    assert not scene.entries and not scene.lights


def test_depth_of_field_is_the_cameras(lisle):
    import bpy

    scenes.curves("Yarn", scenes.line())
    camera = bpy.context.scene.camera
    dof = camera.data.dof
    assert render(lisle).camera.aperture_radius == 0
    camera.data.type, camera.data.lens = "PERSP", 40
    dof.use_dof, dof.aperture_fstop, dof.focus_distance = True, 2.0, 3.5
    dof.aperture_blades, dof.aperture_rotation, dof.aperture_ratio = 6, 0.5, 1.5
    seen = render(lisle).camera
    assert seen.aperture_radius == pytest.approx(0.01)
    assert seen.focus_distance == pytest.approx(3.5)
    assert (seen.blades, seen.rotation_rad, seen.ratio) == (6, pytest.approx(0.5), 1.5)
    camera.data.type = "ORTHO"
    assert render(lisle).camera.aperture_radius == pytest.approx(0.25)


def test_focus_on_an_object_is_along_the_view(lisle):
    import bpy

    scenes.curves("Yarn", scenes.line())
    camera = bpy.context.scene.camera
    camera.scale = (3, 3, 3)
    target = scenes.link(bpy.data.objects.new("Focus", None))
    target.location = (2, 5, 4)
    camera.data.dof.use_dof, camera.data.dof.focus_object = True, target
    assert render(lisle).camera.focus_distance == pytest.approx(6)
    scenes.keyframes(target, "location", {1: (0, 0, 4), 3: (0, 0, 0)})
    bpy.context.scene.frame_set(3)
    assert render(lisle).camera.focus_distance == pytest.approx(10)
