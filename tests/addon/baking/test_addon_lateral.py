# SPDX-License-Identifier: GPL-3.0-or-later
"""Light that travels sideways: the operator, the plain function, and the node group."""

from types import SimpleNamespace

import bmesh
import bpy
import pytest
from addon_helpers import detached, icosphere, linked
from mathutils import Matrix


@pytest.fixture
def marble(addon, lamina, material):
    """The material with two layers of marble in millimetres, the upper one bright, under a boundary."""
    red = lamina.Medium(sigma_s=[2.0, 2.5, 3.0], sigma_a=[0.0002, 0.0004, 0.001], thickness=2.0)
    deep = lamina.Medium(sigma_s=[2.0, 2.5, 3.0], sigma_a=0.0004, thickness=float("inf"))
    addon.editing.stack_io.assign_stack(
        material,
        lamina.Stack([lamina.Interface(1.5), red, deep]),
    )
    return material


def walks(material):
    nodes = material.lamina.lateral_group.nodes
    return sorted((n for n in nodes if n.type == "SUBSURFACE_SCATTERING"), key=lambda n: -n.location.y)


def test_operator_equals_function(addon, lamina, marble, call):
    assert call(bpy.ops.lamina.lateral, marble) == {"FINISHED"}
    inputs = addon.baking.lateral_job.make(marble)
    wanted = lamina.subsurface_nodes(
        addon.editing.stack_io.to_stack(marble), bpy.app.version[:2], quality="preview"
    )
    assert inputs.report == wanted.report == marble.lamina.lateral_report
    first, second = walks(marble)
    assert tuple(first.inputs["Color"].default_value)[:3] == pytest.approx(tuple(wanted.color))
    assert tuple(first.inputs["Radius"].default_value) == pytest.approx(tuple(wanted.radius))
    assert tuple(second.inputs["Color"].default_value)[:3] == pytest.approx(tuple(wanted.extra_color))
    assert first.inputs["IOR"].default_value == pytest.approx(1.5)
    assert first.falloff == "RANDOM_WALK"
    output = marble.node_tree.get_output_node("CYCLES")
    assert output.inputs["Surface"].links[0].from_node.node_tree == marble.lamina.lateral_group


def test_again_in_place(addon, marble):
    addon.baking.lateral_job.make(marble)
    group, count = marble.lamina.lateral_group, len(marble.node_tree.nodes)
    inside = len(group.nodes)
    addon.baking.lateral_job.make(marble)
    assert marble.lamina.lateral_group == group and len(group.nodes) == inside
    assert len(marble.node_tree.nodes) == count


def test_a_copy_has_a_group_of_its_own(addon, marble):
    addon.baking.lateral_job.make(marble)
    copy = marble.copy()
    addon.baking.lateral_job.make(copy)
    assert copy.lamina.lateral_group != marble.lamina.lateral_group


def test_length_of_a_blender_unit(addon, marble):
    scene = bpy.context.scene
    scene.unit_settings.scale_length = 0.01
    addon.baking.lateral_job.make(marble)
    node = next(n for n in marble.node_tree.nodes if n.type == "GROUP")
    assert node.inputs["Millimetre"].default_value == pytest.approx(0.1)
    scale = walks(marble)[0].inputs["Scale"]
    assert scale.links[0].from_socket.name == "Millimetre"


def test_portal(addon, lamina, marble, call):
    """The other output takes the place of the first, in the same group; images of earlier nodes go away."""
    addon.baking.lateral_job.make(marble)
    group = marble.lamina.lateral_group
    marble.lamina.lateral = "PORTAL"
    for _ in range(2):
        assert call(bpy.ops.lamina.lateral, marble) == {"FINISHED"}
    assert marble.lamina.lateral_group == group and not walks(marble)
    # To the source, and from there to the outside.
    assert [node.type for node in group.nodes].count("BSDF_RAY_PORTAL") == 2
    assert marble.lamina.lateral_report.startswith("Portal: ")
    (image,) = [image for image in bpy.data.images if image.name.startswith("Lamina Portal")]
    tables = lamina.portal_tables(addon.editing.stack_io.to_stack(marble), "preview")
    texels = [image.pixels[4 * k + 3] for k in range(len(tables.depths))]
    assert texels == pytest.approx(list(tables.depths), rel=1e-6)
    assert not marble.cycles.use_bump_map_correction  # it would darken tilted normals


def test_volume_of_the_portal(addon, lamina, marble, call):
    """The portal of a deep medium needs a volume. The volume goes away with another output and with the bake."""
    slab = lamina.Medium(sigma_s=[2.0, 3.0, 4.0], sigma_a=[0.1, 0.2, 0.3], thickness=float("inf"))
    addon.editing.stack_io.assign_stack(marble, lamina.Stack([slab]))
    addon.baking.lateral_job.make(marble, quality="preview", output="PORTAL")
    output = marble.node_tree.get_output_node("CYCLES")

    def volumes():
        return [link.from_node.node_tree for link in output.inputs["Volume"].links]

    assert volumes() == [marble.lamina.lateral_group]
    (scatter,) = [node for node in marble.lamina.lateral_group.nodes if node.type == "VOLUME_SCATTER"]
    assert list(scatter.inputs["Color"].default_value)[:3] == pytest.approx([2.0 / 4.3, 3.0 / 4.3, 4.0 / 4.3])
    addon.baking.lateral_job.make(marble, quality="preview", output="RELIGHTABLE")
    assert not volumes() and "Volume" not in marble.lamina.lateral_group.interface.items_tree
    addon.baking.lateral_job.make(marble, quality="preview", output="PORTAL")
    addon.baking.bake_job.bake_material(marble, quality="preview")
    assert call(bpy.ops.lamina.connect, marble) == {"FINISHED"}
    assert not volumes()


@pytest.fixture
def milk(addon, lamina, material):
    """The material as a deep medium without a boundary, whose portal needs a volume."""
    deep = lamina.Medium(sigma_s=1.0, sigma_a=0.1, thickness=float("inf"), phase=lamina.HenyeyGreenstein(0.5))
    addon.editing.stack_io.assign_stack(material, lamina.Stack([deep]))
    material.lamina.lateral = "PORTAL"
    return material


def test_a_chosen_number_of_scatterings(addon, milk, call):
    milk.lamina.lateral_orders = 2
    bpy.context.scene.cycles.volume_bounces = 0
    assert call(bpy.ops.lamina.lateral, milk) == {"FINISHED"}
    assert "scattered up to 2 times in the volume" in milk.lamina.lateral_report
    assert bpy.context.scene.cycles.volume_bounces == 1
    stale = addon.baking.lateral_job.stale
    assert stale(milk) == ""
    milk.lamina.lateral_orders = 3
    assert stale(milk) == "Out of date: computed with another number of scatterings"
    milk.lamina.lateral_layers = addon.editing.layer_list.mark(milk)
    assert stale(milk) == "", "earlier versions did not note the number"


@pytest.mark.parametrize("way", ["operator", "worker"])
def test_bounces_of_the_volume(addon, milk, call, way):
    """Making the portal raises the scene's bounces to what it needs, never lowers them, and says so."""
    scene = bpy.context.scene
    scene.cycles.volume_bounces, scene.cycles.max_bounces = 0, 2
    if way == "operator":
        assert call(bpy.ops.lamina.lateral, milk) == {"FINISHED"}
    else:
        job = addon.baking.lateral_job.start(milk, scene)
        job.wait()
        addon.baking.lateral_job.forget()
        assert job.finish() == milk
    count = milk.lamina.lateral_scatterings
    assert count == 4 and (scene.cycles.volume_bounces, scene.cycles.max_bounces) == (3, 4)
    assert milk.lamina.lateral_report.endswith(
        "Raised the scene's volume bounces from 0 to 3 and bounces in total from 2 to 4."
    )
    scene.cycles.volume_bounces, scene.cycles.max_bounces = 20, 30
    addon.baking.lateral_job.make(milk, quality="preview")
    assert (scene.cycles.volume_bounces, scene.cycles.max_bounces) == (20, 30)
    assert "Raised" not in milk.lamina.lateral_report


def test_too_few_bounces(addon, milk, call):
    """A scene that lost its bounces gets a warning, and one operator that mends it. Other nodes need none."""
    scene, bounces = bpy.context.scene, addon.baking.volume_bounces
    addon.baking.lateral_job.make(milk, quality="preview")
    assert bounces.shortage(scene, milk) == ""
    scene.cycles.volume_bounces = 2
    assert "allows 2 volume bounces" in bounces.shortage(scene, milk)
    assert call(bpy.ops.lamina.lateral_bounces, milk) == {"FINISHED"}
    assert scene.cycles.volume_bounces == 3 and bounces.shortage(scene, milk) == ""
    scene.cycles.max_bounces = 3
    assert "3 bounces in total" in bounces.shortage(scene, milk)
    link = milk.node_tree.get_output_node("CYCLES").inputs["Volume"].links[0]
    milk.node_tree.links.remove(link)
    assert bounces.shortage(scene, milk) == ""
    addon.baking.lateral_job.make(milk, quality="preview")
    assert scene.cycles.max_bounces == 4
    scene.cycles.volume_bounces = 0
    addon.baking.lateral_job.make(milk, quality="preview", output="RELIGHTABLE")
    assert bounces.shortage(scene, milk) == "" and scene.cycles.volume_bounces == 0


def test_warning_in_the_panel(addon, milk):
    """The panel draws the sentence and the operator while bounces are missing, and not otherwise."""
    addon.baking.lateral_job.make(milk, quality="preview")
    assert "lamina.lateral_bounces" not in drawn(addon, milk)
    bpy.context.scene.cycles.volume_bounces = 0
    assert "lamina.lateral_bounces" in drawn(addon, milk)


def drawn(addon, material):
    """The operators that the panel offers."""
    found = []

    class Layout:
        def operator(self, name, **_):
            found.append(name)

        def __getattr__(self, _):
            return lambda *_, **__: Layout()

        def __setattr__(self, *_):
            pass

    preferences = SimpleNamespace(system=SimpleNamespace(ui_scale=1.0))
    region = SimpleNamespace(width=400.0)
    context = SimpleNamespace(
        evaluated_depsgraph_get=bpy.context.evaluated_depsgraph_get,
        object=None, material=material, scene=bpy.context.scene, region=region, preferences=preferences
    )
    addon.ui.depth_panel._draw_soft(context, Layout())
    return found


def test_layers_without_lengths(addon, material, call):
    """The first stack's dust has an optical thickness: one sentence, and nothing changes."""
    before = len(material.node_tree.nodes)
    with pytest.raises(RuntimeError, match=r"has no lengths, must have sigma_s and sigma_a"):
        call(bpy.ops.lamina.lateral, material)
    assert material.lamina.lateral_group is None and len(material.node_tree.nodes) == before


def test_worker(addon, lamina, marble):
    job = addon.baking.lateral_job.start(marble, bpy.context.scene)
    assert addon.baking.lateral_job.running_for(marble) is job
    job.wait()
    assert job.finish() == marble and marble.lamina.lateral_group is not None
    addon.baking.lateral_job.forget()
    group = marble.lamina.lateral_group
    cancelled = addon.baking.lateral_job.start(marble, bpy.context.scene)
    cancelled.cancel()
    cancelled.wait()
    addon.baking.lateral_job.forget()
    with pytest.raises(lamina.Cancelled):
        cancelled.finish()
    assert marble.lamina.lateral_group == group


@pytest.mark.parametrize("end", ["done", "cancelled", "failed", "deleted"])
def test_the_operator_says_how_the_work_ended(addon, lamina, marble, end):
    """An error names the layer as the panel does. Nothing is reported as done for a deleted material."""
    operator = detached(addon, addon.operators.lateral.LAMINA_OT_lateral)
    job = addon.baking.lateral_job.start(marble, bpy.context.scene)
    if end == "cancelled":
        job.cancel()
    job.wait()
    addon.baking.lateral_job.forget()
    if end == "failed":
        job.error = lamina.SolveError("layers[1].tau = 3: an error of this test")
    if end == "deleted":
        bpy.data.materials.remove(marble)
    result = operator.ended(SimpleNamespace(material=None), job)
    ((level, text),) = operator.reports
    if end == "done":
        assert (result, level, text) == ({"FINISHED"}, "INFO", marble.lamina.lateral_report)
    elif end == "failed":
        name = marble.lamina.layers[1].name
        assert (result, level) == ({"CANCELLED"}, "ERROR")
        assert text == f"Layer 2 “{name}”, optical thickness = 3: an error of this test"
    else:
        assert (result, level, text) == ({"CANCELLED"}, "INFO", "Cancelled; the earlier nodes are kept")


@pytest.mark.parametrize(("output", "off"), [("PORTAL", 76), ("RELIGHTABLE", 78)])
def test_a_thin_object_is_named(addon, lamina, marble, output, off):
    """By rays inwards: a ball is as thick as its diameter. A volume fits all objects."""
    slab = lamina.Medium(sigma_s=3.0, sigma_a=0.33, thickness=float("inf"))
    addon.editing.stack_io.assign_stack(marble, lamina.Stack([slab]))
    job, thickness = addon.baking.lateral_job, addon.baking.body_thickness
    found, millimetre = job.make(marble, quality="preview", output=output), job.millimetre(bpy.context.scene)
    way = float(max(found.distance)) * millimetre
    ball = linked("Ball", icosphere("Ball", 0.5 * 8.0 * way))

    def told():
        depsgraph = bpy.context.evaluated_depsgraph_get()
        return thickness.too_thin(ball, marble, depsgraph, millimetre)

    assert told() == ""
    ball.scale = (0.5,) * 3
    bpy.context.view_layer.update()
    assert told().startswith(f"{ball.name} is ") and f"off by {off} %" in told() and "Volume" in told()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    assert thickness.thin_part(ball.evaluated_get(depsgraph)) == pytest.approx(4.0 * way, rel=0.2)
    assert thickness.too_thin(None, marble, depsgraph, millimetre) == ""
    job.make(marble, quality="preview", output="VOLUME")
    assert told() == ""


def test_overlapping_parts_are_one_body(addon):
    """A ball, and a flat lens in it: the lens is no surface, and rays go on below it."""
    ball = icosphere("Ball", 1.0)
    both, lens = bmesh.new(), icosphere("Lens", 0.3)
    both.from_mesh(ball)
    lens.transform(Matrix.Translation((0.0, 0.0, 0.85)) @ Matrix.Diagonal((1.0, 1.0, 0.02, 1.0)))
    both.from_mesh(lens)
    both.to_mesh(ball)
    both.free()
    obj = linked("Ball", ball)
    bpy.context.view_layer.update()
    evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
    assert addon.baking.body_thickness.thin_part(evaluated) > 1.0


@pytest.mark.parametrize("size", [0.01, 1.0])
def test_bent_faces_are_not_thin(addon, size):
    """A monkey of quads, each of two triangles at an angle: rays from the middle of a quad pass its own triangles."""
    bpy.ops.mesh.primitive_monkey_add(size=2.0 * size)
    obj = bpy.context.object
    obj.modifiers.new("Smooth", "SUBSURF").levels = 2
    thin = addon.baking.body_thickness.thin_part(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    assert 0.02 * size < thin < 0.3 * size


@pytest.fixture
def milk_ball(addon, milk):
    """A ball, 10 mm wide, of milk with a mean free path of 1 / 1.1 mm."""
    obj = bpy.data.objects.new("Ball", icosphere("Ball", 0.005))
    obj.data.materials.append(milk)
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    bpy.context.view_layer.update()
    return obj


@pytest.mark.parametrize("output", ["PORTAL", "RELIGHTABLE"])
def test_inside_out_meshes_are_refused(addon, milk, milk_ball, call, output):
    milk.lamina.lateral = output
    milk_ball.data.flip_normals()
    with pytest.raises(RuntimeError, match="Ball is inside out"):
        call(bpy.ops.lamina.lateral, milk)
    milk_ball.data.flip_normals()
    assert call(bpy.ops.lamina.lateral, milk) == {"FINISHED"}
    milk_ball.scale = (-1.0, 1.0, 1.0)  # Blender turns the faces of mirrored objects
    bpy.context.view_layer.update()
    assert call(bpy.ops.lamina.lateral, milk) == {"FINISHED"}
    milk_ball.data.clear_geometry()  # shows nothing
    assert call(bpy.ops.lamina.lateral, milk) == {"FINISHED"}


@pytest.mark.parametrize("output", ["PORTAL", "RELIGHTABLE"])
def test_scripts_and_other_objects_are_checked(addon, lamina, milk, milk_ball, output):
    """Without the operator, and for an object that is not the active one."""
    lamp = bpy.data.objects.new("Lamp", bpy.data.lights.new("Lamp", "SUN"))
    bpy.context.scene.collection.objects.link(lamp)
    bpy.context.view_layer.objects.active = lamp
    milk_ball.data.flip_normals()
    for call in (addon.baking.lateral_job.make, addon.baking.lateral_job.start):
        milk.lamina.lateral = output
        with pytest.raises(lamina.InteriorError, match="Ball is inside out"):
            call(milk, bpy.context.scene)
    assert milk.lamina.lateral_group is None and addon.baking.lateral_job.running() is None


@pytest.mark.parametrize("output", ["PORTAL", "RELIGHTABLE"])
def test_planes_are_allowed(milk, milk_ball, call, output):
    bpy.ops.mesh.primitive_plane_add(size=0.01)
    bpy.context.object.data.materials.append(milk)
    milk.lamina.lateral = output
    assert call(bpy.ops.lamina.lateral, milk) == {"FINISHED"}


def test_opaque_faces_of_other_materials_are_told(milk, milk_ball, call):
    assert call(bpy.ops.lamina.lateral, milk) == {"FINISHED"}
    assert "Lamps shine" not in milk.lamina.lateral_report
    milk_ball.data.materials.append(bpy.data.materials.new("Cap"))
    assert call(bpy.ops.lamina.lateral, milk) == {"FINISHED"}
    assert "Lamps shine" not in milk.lamina.lateral_report  # no face has the material
    milk_ball.data.polygons[0].material_index = 1
    assert call(bpy.ops.lamina.lateral, milk) == {"FINISHED"}
    assert "Lamps shine into the body through opaque faces" in milk.lamina.lateral_report


def test_relightable_refuses_bodies_that_light_crosses(milk, milk_ball, call):
    milk.lamina.lateral = "RELIGHTABLE"
    milk_ball.scale = (0.00364,) * 3  # .04 mean free paths across; the icosphere's flat faces leave .038 as mean width
    bpy.context.view_layer.update()
    before = milk.lamina.lateral_report
    words = "0.038 mean free paths wide .*98 % of the light.*Exact in the panel Depth"
    with pytest.raises(RuntimeError, match=words):
        call(bpy.ops.lamina.lateral, milk)
    assert milk.lamina.lateral_report == before and milk.lamina.lateral_group is None
    milk.lamina.lateral = "PORTAL"  # the panel warns
    assert call(bpy.ops.lamina.lateral, milk) == {"FINISHED"}


def test_a_body_as_a_volume(addon, lamina, milk, call):
    """One medium below a boundary: Cycles' own closures, and the bounces that they need."""
    scene, job = bpy.context.scene, addon.baking.lateral_job
    milk.lamina.lateral = "VOLUME"
    body = job.make(milk)
    kinds = {node.type for node in milk.lamina.lateral_group.nodes}
    assert {"VOLUME_SCATTER", "VOLUME_ABSORPTION"} <= kinds
    assert ("BSDF_GLASS" in kinds) == (body.surface.ior != 1.0) and job.stale(milk) == ""
    assert scene.cycles.volume_bounces == body.bounces - 1 and scene.cycles.glossy_bounces >= 32
    scatter = next(node for node in milk.lamina.lateral_group.nodes if node.type == "VOLUME_SCATTER")
    largest = max(*body.medium.sigma_s, *body.medium.sigma_a)
    assert list(scatter.inputs["Color"].default_value)[:3] == pytest.approx([s / largest for s in body.medium.sigma_s])
    milk.lamina.lateral = "RELIGHTABLE"
    job.make(milk)
    assert "VOLUME_SCATTER" not in {node.type for node in milk.lamina.lateral_group.nodes}
    milk.lamina.lateral = "VOLUME"
    addon.editing.layer_list.add_layer(milk).mode = "coefficients"
    with pytest.raises(RuntimeError, match="must be one homogeneous medium"):
        call(bpy.ops.lamina.lateral, milk)
    assert "VOLUME_SCATTER" not in {node.type for node in milk.lamina.lateral_group.nodes}, "unchanged"
