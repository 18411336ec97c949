"""Which curves are yarn, and which are not."""

import pytest
import scenes

pytestmark = pytest.mark.blender


def collected(lisle):
    import bpy
    from lisle_blender.export.scene import collect

    bpy.context.view_layer.update()
    notes = []
    return collect(lisle, bpy.context.evaluated_depsgraph_get(), notes.append), notes


def drawn(lisle):
    """Names of the objects whose curves are yarn."""
    return {placement.name for placement in collected(lisle)[0].placements}


def rail(**settings):
    return scenes.legacy("Rail", "POLY", scenes.line(5), **settings)


def _followed(obj):
    scenes.empty_mesh("Train").constraints.new("FOLLOW_PATH").target = obj


def _clamped(obj):
    scenes.empty_mesh("Train").constraints.new("CLAMP_TO").target = obj


def _spine(obj):
    import bpy

    armature = scenes.link(bpy.data.objects.new("Armature", bpy.data.armatures.new("Armature")))
    bpy.context.view_layer.objects.active = armature
    bpy.ops.object.mode_set(mode="EDIT")
    armature.data.edit_bones.new("Bone").tail = (0, 0, 1)
    bpy.ops.object.mode_set(mode="OBJECT")
    armature.pose.bones["Bone"].constraints.new("SPLINE_IK").target = obj


def _bends(obj):
    scenes.empty_mesh("Train").modifiers.new("Curve", "CURVE").object = obj


def _measures_an_array(obj):
    array = scenes.empty_mesh("Train").modifiers.new("Array", "ARRAY")
    array.fit_type, array.curve = "FIT_CURVE", obj


def _bevels(obj):
    import bpy

    other = bpy.data.curves.new("Other", "CURVE")
    other.bevel_mode, other.bevel_object = "OBJECT", obj


def _tapers(obj):
    import bpy

    bpy.data.curves.new("Other", "CURVE").taper_object = obj


def _carries_text(obj):
    import bpy

    bpy.data.curves.new("Text", "FONT").follow_curve = obj


def _moves_children(obj):
    scenes.empty_mesh("Train").parent = obj
    obj.data.use_path = True
    obj.data.keyframe_insert("eval_time", frame=1)


def _guides_particles(obj):
    import bpy

    with bpy.context.temp_override(object=obj, active_object=obj):
        bpy.context.view_layer.objects.active = obj
        bpy.ops.object.forcefield_toggle()
    obj.field.type = "GUIDE"


@pytest.mark.parametrize(
    "serve",
    [
        _followed, _clamped, _spine, _bends, _measures_an_array, _bevels, _tapers, _carries_text, _moves_children,
        _guides_particles,
    ],
)  # fmt: skip
def test_a_curve_that_serves_another_object_is_no_yarn_unless_wanted(lisle, serve):
    scenes.legacy("Yarn", "POLY", scenes.line(5))
    obj = rail()
    assert drawn(lisle) == {"Yarn", "Rail"}
    serve(obj)
    assert drawn(lisle) == {"Yarn"}
    obj.lisle.is_yarn = "ALWAYS"
    assert drawn(lisle) == {"Yarn", "Rail"}


def test_other_relations_leave_yarn_as_it_is(lisle):
    obj = rail()
    child = scenes.empty_mesh("Bead")
    child.parent = obj
    obj.data.use_path = True
    child.constraints.new("COPY_LOCATION").target = obj
    child.modifiers.new("Array", "ARRAY").curve = obj  # of a fixed count, so the curve is not asked
    assert drawn(lisle) == {"Rail"}


def test_any_object_can_be_told_not_to_be_yarn(lisle):
    curves, legacy, beads = scenes.curves("Curves", scenes.line()), rail(), scenes.empty_mesh("Beads")
    with_nodes = scenes.Nodes(beads)
    with_nodes.finish(with_nodes.new("CurvePrimitiveCircle").outputs[0])
    assert drawn(lisle) == {"Curves", "Rail", "Beads"}
    for obj in (curves, legacy, beads):
        obj.lisle.is_yarn = "NEVER"
    assert drawn(lisle) == set()


def test_a_bevelled_curve_that_is_no_yarn_is_a_mesh(lisle):
    obj, instanced = rail(bevel_depth=0.1), rail(bevel_depth=0.1)
    scenes.collection_instance("Instance", instanced, location=(0, 1, 0))
    assert len(collected(lisle)[0].placements) == 2 and not collected(lisle)[0].meshes
    obj.lisle.is_yarn = instanced.lisle.is_yarn = "NEVER"
    content, _ = collected(lisle)
    assert not content.placements and len(content.meshes) == 2
    assert all(len(mesh.surface.triangles) > 8 for mesh in content.meshes)
    obj.lisle.mesh_kind = "INVISIBLE"
    assert len(collected(lisle)[0].meshes) == 1
    obj.data.bevel_depth, obj.lisle.mesh_kind = 0, "SHADED"
    assert len(collected(lisle)[0].meshes) == 1, "a bare line is nothing"
