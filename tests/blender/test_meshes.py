"""Meshes, as they reach the native module."""

import numpy as np
import pytest
import scenes

pytestmark = pytest.mark.blender


def cube(name="Cube", size=2.0, materials=()):
    """A cube object with its materials by face, in turns."""
    import bmesh
    import bpy

    data = bpy.data.meshes.new(name)
    shape = bmesh.new()
    bmesh.ops.create_cube(shape, size=size)
    shape.to_mesh(data)
    shape.free()
    for material in materials:
        data.materials.append(material)
    for face in data.polygons:
        face.material_index = face.index % max(len(materials), 1)
    return scenes.link(bpy.data.objects.new(name, data))


def drawn(lisle):
    import bpy

    bpy.ops.render.render()
    return lisle.scenes[-1][0].meshes


def material(name, color, viewport=(0.1, 0.2, 0.3, 1)):
    import bpy

    made = bpy.data.materials.new(name)
    made.diffuse_color = viewport
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = True
    principled = made.node_tree.get_output_node("ALL").inputs["Surface"].links[0].from_node
    principled.inputs["Base Color"].default_value = color
    return made


def area(positions, corners):
    a, b, c = (positions[corners[:, i]] for i in range(3))
    return 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum()


def test_a_cube_is_twelve_triangles_at_its_place(lisle):
    obj = cube()
    obj.location, obj.scale = (1, 2, 3), (1, 1, 2)
    obj.pass_index = 5
    (mesh,) = drawn(lisle)
    assert mesh.corners.shape == (12, 3) and mesh.normals is None
    assert area(mesh.positions, mesh.corners) == pytest.approx(24)
    np.testing.assert_array_equal(mesh.world_from_object, np.array(obj.matrix_world))
    assert (mesh.kind, mesh.base_color, mesh.name) == ("shaded", (0.8, 0.8, 0.8), "Cube")
    assert (mesh.object_index, mesh.material_name, mesh.material_index) == (5, "", 0)
    plain = material("Plain", (1, 1, 1, 1))
    plain.pass_index = 4
    obj.data.materials.append(plain)
    (mesh,) = drawn(lisle)
    assert (mesh.material_name, mesh.material_index) == ("Plain", 4)


def test_modifiers_and_smooth_faces_count(lisle):
    obj = cube()
    obj.data.polygons.foreach_set("use_smooth", [True] * 6)
    obj.modifiers.new("Subdivision", "SUBSURF").render_levels = 1
    (mesh,) = drawn(lisle)
    assert len(mesh.corners) == 48
    at_corners = mesh.positions[mesh.corners]
    outward = at_corners / np.linalg.norm(at_corners, axis=-1, keepdims=True)
    assert (np.sum(mesh.normals * outward, axis=-1) > 0.9).all()


@pytest.mark.parametrize("modifier", [None, "SUBSURF"])
def test_a_mesh_in_edit_mode_is_there(lisle, modifier):
    import bpy
    from lisle_blender.export.scene import collect

    obj = cube()
    if modifier is not None:
        subdivision = obj.modifiers.new("Modifier", modifier)
        subdivision.levels = subdivision.render_levels = 1
    bpy.context.view_layer.objects.active = obj
    bpy.ops.object.mode_set(mode="EDIT")
    (placement,) = collect(lisle, bpy.context.evaluated_depsgraph_get(), print).meshes
    assert len(placement.surface.triangles) == (12 if modifier is None else 48)
    assert [len(mesh.corners) for mesh in drawn(lisle)] == [len(placement.surface.triangles)]


def test_each_material_is_a_mesh_of_its_base_colour(lisle):
    linked = material("Linked", (1, 0, 0, 1))
    tree = linked.node_tree
    principled = tree.get_output_node("ALL").inputs["Surface"].links[0].from_node
    tree.links.new(tree.nodes.new("ShaderNodeTexChecker").outputs["Color"], principled.inputs["Base Color"])
    cube(materials=(material("Red", (0.9, 0.1, 0.2, 1)), linked, None))
    meshes = sorted(drawn(lisle), key=lambda mesh: mesh.base_color)
    np.testing.assert_allclose(
        [mesh.base_color for mesh in meshes], [(0.1, 0.2, 0.3), (0.8, 0.8, 0.8), (0.9, 0.1, 0.2)], rtol=1e-6
    )
    assert [len(mesh.corners) for mesh in meshes] == [4, 4, 4]
    assert sum(area(mesh.positions, mesh.corners) for mesh in meshes) == pytest.approx(24)
    assert len({mesh.object_id for mesh in meshes}) == 3
    assert [mesh.material_name for mesh in meshes] == ["Linked", "", "Red"]


def test_colours_come_past_reroutes_and_muted_nodes(lisle):
    import bpy

    made = material("Red", (0.9, 0.1, 0.2, 1))
    tree = made.node_tree
    output = tree.get_output_node("ALL")
    principled = output.inputs["Surface"].links[0].from_node
    (obj,) = [cube(materials=(made,))]

    def seen():
        obj.data.update()
        return drawn(lisle)[0].base_color

    def put(kind, source, target):
        node = tree.nodes.new(kind)
        tree.links.new(source, node.inputs[0])
        tree.links.new(node.outputs[0], target)
        return node

    put("NodeReroute", principled.outputs[0], output.inputs["Surface"])
    assert seen() == pytest.approx((0.9, 0.1, 0.2))
    gamma = tree.nodes.new("ShaderNodeGamma")
    gamma.inputs["Color"].default_value = (0.3, 0.4, 0.5, 1)
    tree.links.new(gamma.outputs[0], principled.inputs["Base Color"])
    assert seen() == pytest.approx((0.1, 0.2, 0.3)), "a texture has no one colour"
    gamma.mute = True
    assert seen() == pytest.approx((0.3, 0.4, 0.5))
    color = tree.nodes.new("ShaderNodeRGB")
    color.outputs[0].default_value = (0.6, 0.7, 0.8, 1)
    put("NodeReroute", color.outputs[0], gamma.inputs["Color"])
    assert seen() == pytest.approx((0.6, 0.7, 0.8))
    principled.inputs["Base Color"].links[0].is_muted = True
    assert seen() == pytest.approx((0.9, 0.1, 0.2))
    if bpy.app.version < (5, 0, 0):
        made.use_nodes = False
        assert seen() == pytest.approx((0.1, 0.2, 0.3))


def test_what_is_seen_of_a_mesh(lisle):
    objects = {kind: cube(kind) for kind in ("SHADED", "SHADOW_CATCHER", "HOLDOUT", "INVISIBLE")}
    for kind, obj in objects.items():
        obj.lisle.mesh_kind = kind
    for name in ("is_holdout", "is_shadow_catcher"):
        setattr(cube(name), name, True)
    cube("Unseen").visible_camera = False
    cube("Hidden").hide_render = True
    assert {mesh.name: mesh.kind for mesh in drawn(lisle)} == {
        "SHADED": "shaded", "SHADOW_CATCHER": "shadow-catcher", "HOLDOUT": "holdout",
        "is_holdout": "holdout", "is_shadow_catcher": "shadow-catcher",
    }  # fmt: skip


def test_yarn_can_be_a_holdout(lisle):
    import bpy
    from lisle_blender.export.scene import collect

    for name in ("Seen", "Hole"):
        scenes.curves(name, scenes.line()).is_holdout = name == "Hole"
    content = collect(lisle, bpy.context.evaluated_depsgraph_get(), print)
    assert {placement.name: placement.is_holdout for placement in content.placements} == {"Seen": False, "Hole": True}


def test_views_notice_that_yarn_becomes_a_holdout(lisle):
    import bpy
    from lisle_blender.export.scene import collect

    obj = scenes.curves("Yarn", scenes.line())

    def content():
        return collect(lisle, bpy.context.evaluated_depsgraph_get(), print)

    before = content()
    assert content().equals(before)
    obj.is_holdout = True
    assert not content().equals(before)


def test_instances_share_their_geometry(lisle):
    collection = scenes.collection_instance("Instances", cube(), location=(0, 5, 0))
    import bpy

    other = scenes.link(bpy.data.objects.new("Other", None))
    other.instance_type, other.instance_collection = "COLLECTION", collection.instance_collection
    a, b = drawn(lisle)
    assert a.triangles is b.triangles and a.object_id != b.object_id
    assert {tuple(mesh.world_from_object[:3, 3]) for mesh in (a, b)} == {(0, 5, 0), (0, 0, 0)}


def test_text_and_surfaces_are_meshes_and_volumes_are_told(lisle):
    import bpy
    from lisle_blender.export.scene import collect

    text = bpy.data.curves.new("Text", "FONT")
    text.body = "x"
    scenes.link(bpy.data.objects.new("Text", text))
    scenes.link(bpy.data.objects.new("Smoke", bpy.data.volumes.new("Smoke")))
    (mesh,) = drawn(lisle)
    assert mesh.name == "Text" and len(mesh.corners) > 4
    notes = []
    collect(lisle, bpy.context.evaluated_depsgraph_get(), notes.append)
    assert len(notes) == 1 and "'Smoke' (volume)" in notes[0]


def test_an_unchanged_mesh_is_the_same_native_one_in_the_next_frame(lisle):
    import bpy

    still, moving, bending = cube("Still"), cube("Moving"), cube("Bending", size=1.0)
    scenes.keyframes(moving, "location", {1: (0, 0, 0), 2: (1, 0, 0)})
    key = bending.shape_key_add(name="Basis")
    key = bending.shape_key_add(name="Bent")
    key.data[0].co.x += 1
    key.value = 0
    key.keyframe_insert("value", frame=1)
    key.value = 1
    key.keyframe_insert("value", frame=2)
    bpy.context.scene.frame_end = 2
    bpy.ops.render.render(animation=True)
    first, second = ({mesh.name: mesh for mesh in scene.meshes} for scene, _ in lisle.scenes[-2:])
    assert first["Still"].triangles is second["Still"].triangles
    assert first["Moving"].triangles is second["Moving"].triangles
    assert not np.array_equal(first["Moving"].world_from_object, second["Moving"].world_from_object)
    assert first["Bending"].triangles is not second["Bending"].triangles
    assert {name: mesh.object_id for name, mesh in first.items()} == {m.name: m.object_id for m in second.values()}
    assert still.name in first


def test_views_notice_what_changes_on_a_mesh(lisle):
    import bpy
    from lisle_blender.export.scene import collect

    obj = cube(materials=(material("Red", (0.9, 0.1, 0.2, 1)),))

    def content():
        return collect(lisle, bpy.context.evaluated_depsgraph_get(), print)

    before = content()
    assert content().equals(before)
    changes = (
        lambda: setattr(obj, "location", (1, 0, 0)),
        lambda: setattr(obj.lisle, "mesh_kind", "HOLDOUT"),
        lambda: obj.data.vertices[0].co.__setitem__(0, 7.0),
        lambda: obj.data.materials.__setitem__(0, material("Blue", (0, 0, 1, 1))),
    )
    for change in changes:
        change()
        obj.data.update()
        bpy.context.view_layer.update()
        after = content()
        assert not after.equals(before)
        before = after
