# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials as artists and importers make them: TREES has a function for each, which fills a new material."""

import bpy
from tree_words import Tree, new_group


def _default(t):
    pass


def _numbers(t):
    t.set(Base_Color=(0.8, 0.05, 0.02, 1.0), Roughness=0.25, IOR=1.45, Specular_IOR_Level=0.4)
    t.principled.location = (-123.456, 78.9)


def _metal(t):
    t.set(Base_Color=(0.95, 0.7, 0.35, 1.0), Metallic=1.0, Roughness=0.3)


def _texture(t):
    image = t.image("Wood")
    mapping = t.add("ShaderNodeMapping", -900, 300)
    mapping.inputs["Scale"].default_value = (2.0, 3.0, 1.0)
    uv = t.add("ShaderNodeUVMap", -1100, 300, uv_map="UVMap")
    t.link(uv.outputs[0], mapping.inputs[0])
    t.link(mapping.outputs[0], image.inputs[0])
    t.link(image.outputs["Color"], t.principled.inputs["Base Color"])


def _painted_maps(t):
    """One packed image for each socket, as texture sites deliver."""
    for y, (name, data) in enumerate({"Base Color": False, "Metallic": True, "Roughness": True}.items()):
        t.link(t.image(name, data, True, y=-300.0 * y).outputs["Color"], t.principled.inputs[name])


def _normal_map(t):
    image = t.image("Normals", True, True)
    normal = t.add("ShaderNodeNormalMap", -300, -200, uv_map="UVMap", space="TANGENT")
    normal.inputs["Strength"].default_value = 0.7
    t.link(image.outputs["Color"], normal.inputs["Color"])
    t.link(normal.outputs[0], t.principled.inputs["Normal"])


def _bump_chain(t):
    noise = t.add("ShaderNodeTexNoise", -800, -100)
    fine = t.add("ShaderNodeBump", -500, -100, invert=True)
    coarse = t.add("ShaderNodeBump", -250, -100)
    t.link(noise.outputs[0], fine.inputs["Height"])
    t.link(noise.outputs[0], coarse.inputs["Height"])
    t.link(fine.outputs[0], coarse.inputs["Normal"])
    t.link(coarse.outputs[0], t.principled.inputs["Normal"])
    t.material.cycles.use_bump_map_correction = True


def _displacement(t):
    waves = t.add("ShaderNodeTexWave", -300, -500, bands_direction="Z")
    displacement = t.add("ShaderNodeDisplacement", 0, -500)
    t.link(waves.outputs["Fac"], displacement.inputs["Height"])
    t.link(displacement.outputs[0], t.output.inputs["Displacement"])
    t.material.displacement_method = "BOTH"


def _gltf(t):
    """The importer of glTF: metal and roughness in one image, an emission texture, and a group for occlusion."""
    colour, packed, glow = (t.image(name, name != "Albedo", True, y=y)
                            for name, y in (("Albedo", 500), ("MetallicRoughness", 200), ("Emissive", -100)))
    channels = t.add("ShaderNodeSeparateColor", -300, 200)
    paint = t.add("ShaderNodeVertexColor", -600, 700, layer_name="Color")
    mix = t.add("ShaderNodeMix", -300, 500, data_type="RGBA", blend_type="MULTIPLY")
    mix.inputs["Factor"].default_value = 1.0
    colours = [socket for socket in mix.inputs if socket.type == "RGBA"]
    t.link(colour.outputs[0], colours[0])
    t.link(paint.outputs[0], colours[1])
    t.link(next(socket for socket in mix.outputs if socket.type == "RGBA"), t.principled.inputs["Base Color"])
    t.link(packed.outputs[0], channels.inputs[0])
    t.link(channels.outputs["Green"], t.principled.inputs["Roughness"])
    t.link(channels.outputs["Blue"], t.principled.inputs["Metallic"])
    t.link(glow.outputs[0], t.principled.inputs["Emission Color"])
    t.set(Emission_Strength=1.0)
    group = new_group("glTF Material Output", [("Occlusion", "NodeSocketFloat", 1.0)])
    occlusion = t.add("ShaderNodeGroup", 300, -300, node_tree=group)
    t.link(channels.outputs["Red"], occlusion.inputs["Occlusion"])


def _gltf_alpha(t):
    colour = t.image("Leaf", packed=True)
    t.link(colour.outputs["Color"], t.principled.inputs["Base Color"])
    cut = t.add("ShaderNodeMath", -250, 0, operation="LESS_THAN")
    cut.inputs[1].default_value = 0.5
    t.link(colour.outputs["Alpha"], cut.inputs[0])
    rest = t.add("ShaderNodeMath", -100, 0, operation="SUBTRACT")
    rest.inputs[0].default_value = 1.0
    t.link(cut.outputs[0], rest.inputs[1])
    t.link(rest.outputs[0], t.principled.inputs["Alpha"])


def _obj(t):
    """The importer of OBJ and MTL: textures of specular level, bump and alpha."""
    for y, (name, data) in enumerate({"Base Color": False, "Specular IOR Level": True, "Roughness": True,
                                      "Alpha": True}.items()):
        t.link(t.image(name, data, y=400.0 - 280.0 * y).outputs["Color"], t.principled.inputs[name])
    bump = t.add("ShaderNodeBump", -200, -600)
    t.link(t.image("Bump", True, y=-700).outputs["Color"], bump.inputs["Height"])
    t.link(bump.outputs[0], t.principled.inputs["Normal"])


def _cut_out(t):
    """Transparency by a mix, as before the Principled BSDF had an alpha."""
    clear = t.add("ShaderNodeBsdfTransparent", 0, 300)
    mix = t.add("ShaderNodeMixShader", 180, 300)
    image = t.image("Leaf")
    t.link(image.outputs["Alpha"], mix.inputs[0])
    t.link(clear.outputs[0], mix.inputs[1])
    t.link(t.principled.outputs[0], mix.inputs[2])
    t.link(mix.outputs[0], t.output.inputs["Surface"])


def _two_principled(t):
    other = t.add("ShaderNodeBsdfPrincipled", -200, -600)
    mix = t.add("ShaderNodeMixShader", 150, 0)
    edge = t.add("ShaderNodeLayerWeight", -100, 400)
    t.link(edge.outputs["Facing"], mix.inputs[0])
    t.link(t.principled.outputs[0], mix.inputs[1])
    t.link(other.outputs[0], mix.inputs[2])
    t.link(mix.outputs[0], t.output.inputs["Surface"])


def _glow_added(t):
    light = t.add("ShaderNodeEmission", 0, 300)
    both = t.add("ShaderNodeAddShader", 180, 200)
    t.link(t.principled.outputs[0], both.inputs[0])
    t.link(light.outputs[0], both.inputs[1])
    t.link(both.outputs[0], t.output.inputs["Surface"])


def _glass(t):
    surface = t.only_output()
    glass = t.add("ShaderNodeBsdfGlass", 0, 300)
    glass.inputs["Roughness"].default_value = 0.1
    t.link(glass.outputs[0], surface)


def _hair(t):
    surface = t.only_output()
    t.link(t.add("ShaderNodeBsdfHairPrincipled", 0, 300).outputs[0], surface)


def _classic(t):
    """Diffuse under Glossy by Fresnel, as before the Principled BSDF."""
    surface = t.only_output()
    diffuse, glossy = t.add("ShaderNodeBsdfDiffuse", 0, 300), t.add("ShaderNodeBsdfAnisotropic", 0, 100)
    diffuse.inputs["Color"].default_value = (0.1, 0.4, 0.2, 1.0)
    mix, fresnel = t.add("ShaderNodeMixShader", 200, 200), t.add("ShaderNodeFresnel", 0, 450)
    t.link(fresnel.outputs[0], mix.inputs[0])
    t.link(diffuse.outputs[0], mix.inputs[1])
    t.link(glossy.outputs[0], mix.inputs[2])
    t.link(mix.outputs[0], surface)


def _own_group(t):
    """The whole shader in a group of the artist's."""
    surface = t.only_output()
    group = new_group("Bronze shader", [("Tint", "NodeSocketColor", (0.5, 0.3, 0.1, 1.0))], "NodeSocketShader")
    shader = group.nodes.new("ShaderNodeBsdfPrincipled")
    given, result = (next(n for n in group.nodes if n.type == kind) for kind in ("GROUP_INPUT", "GROUP_OUTPUT"))
    group.links.new(given.outputs["Tint"], shader.inputs["Base Color"])
    group.links.new(shader.outputs[0], result.inputs["Out"])
    t.link(t.add("ShaderNodeGroup", 0, 300, node_tree=group).outputs[0], surface)


def _group_of_maps(t):
    """Textures from nested groups."""
    inner = new_group("Grain", [("Scale", "NodeSocketFloat", 3.0)], "NodeSocketFloat")
    noise = inner.nodes.new("ShaderNodeTexNoise")
    given, result = (next(n for n in inner.nodes if n.type == kind) for kind in ("GROUP_INPUT", "GROUP_OUTPUT"))
    inner.links.new(given.outputs["Scale"], noise.inputs["Scale"])
    inner.links.new(noise.outputs[0], result.inputs["Out"])
    outer = new_group("Maps", [("Scale", "NodeSocketFloat", 7.0)], "NodeSocketColor")
    nested = outer.nodes.new("ShaderNodeGroup")
    nested.node_tree = inner
    outer.links.new(nested.outputs[0], next(n for n in outer.nodes if n.type == "GROUP_OUTPUT").inputs["Out"])
    node = t.add("ShaderNodeGroup", -400, 0, node_tree=outer)
    node.inputs["Scale"].default_value = 11.0
    t.link(node.outputs[0], t.principled.inputs["Base Color"])
    t.link(node.outputs[0], t.principled.inputs["Roughness"])


def _reroutes(t):
    def through(given, target, x):
        first, second = t.add("NodeReroute", x, 50), t.add("NodeReroute", x + 60, 40)
        t.link(given, first.inputs[0])
        t.link(first.outputs[0], second.inputs[0])
        t.link(second.outputs[0], target)

    through(t.image("Paint").outputs["Color"], t.principled.inputs["Base Color"], -300)
    through(t.principled.outputs[0], t.output.inputs["Surface"], 200)


def _empty_reroute(t):
    loose = t.add("NodeReroute", -250, 0)
    t.link(loose.outputs[0], t.principled.inputs["Roughness"])
    t.set(Roughness=0.37)


def _frames(t):
    """Nested frames, at places that single precision rounds."""
    outer = t.add("NodeFrame", 33.3, -17.77, "Bronze", use_custom_color=True, color=(0.3, 0.2, 0.1))
    inner = t.add("NodeFrame", 101.01, 55.55, "Shader", outer)
    t.principled.location = (-210.123, 98.7654)
    t.principled.parent = inner
    image = t.image("Bronze", x=-610.777, y=290.3)
    image.parent = outer
    t.link(image.outputs["Color"], t.principled.inputs["Base Color"])


def _outputs(t):
    """Outputs for Cycles and for Eevee; the active one is that of Eevee."""
    t.output.target = "CYCLES"
    preview = t.add("ShaderNodeOutputMaterial", 400, -300, "Preview", target="EEVEE")
    simple = t.add("ShaderNodeBsdfDiffuse", 200, -300)
    t.link(simple.outputs[0], preview.inputs["Surface"])
    t.output.is_active_output, preview.is_active_output = True, True


def _shared_outputs(t):
    """One Principled feeds the outputs of both engines."""
    t.output.target = "CYCLES"
    preview = t.add("ShaderNodeOutputMaterial", 400, -300, target="EEVEE")
    t.link(t.principled.outputs[0], preview.inputs["Surface"])


def _two_for_all(t):
    spare = t.add("ShaderNodeOutputMaterial", 500, 200, "Test")
    check = t.add("ShaderNodeEmission", 300, 400)
    t.link(check.outputs[0], spare.inputs["Surface"])
    t.output.is_active_output = True


def _muted_texture_link(t):
    t.link(t.image("Off").outputs["Color"], t.principled.inputs["Base Color"], muted=True)
    t.set(Base_Color=(0.2, 0.5, 0.1, 1.0))


def _muted_output_link(t):
    t.output.inputs["Surface"].links[0].is_muted = True


def _muted_nodes(t):
    image = t.image("Off")
    image.mute = True
    t.link(image.outputs["Color"], t.principled.inputs["Base Color"])
    bump = t.add("ShaderNodeBump", -250, -100, mute=True)
    t.link(bump.outputs[0], t.principled.inputs["Normal"])


def _muted_principled(t):
    t.principled.mute = True


def _animated(t):
    for frame, value in ((1, 0.1), (20, 0.9), (40, 0.3)):
        t.principled.inputs["Roughness"].default_value = value
        t.principled.inputs["Roughness"].keyframe_insert("default_value", frame=frame)
    for frame, value in ((1, (0.9, 0.1, 0.1, 1.0)), (30, (0.1, 0.1, 0.9, 1.0))):
        t.principled.inputs["Base Color"].default_value = value
        t.principled.inputs["Base Color"].keyframe_insert("default_value", frame=frame)


def _driven(t):
    driver = t.principled.inputs["Metallic"].driver_add("default_value").driver
    driver.type = "SUM"
    variable = driver.variables.new()
    variable.targets[0].id_type = "SCENE"
    variable.targets[0].id = bpy.context.scene
    variable.targets[0].data_path = "render.fps_base"
    driven = t.principled.inputs["Emission Strength"].driver_add("default_value").driver
    driven.expression = "frame / 100"


def _glow(t):
    t.set(Emission_Color=(1.0, 0.6, 0.2, 1.0), Emission_Strength=3.0)


def _glowing_paint(t):
    _glow(t)
    t.set(Coat_Weight=0.8)


def _half_clear(t):
    t.set(Alpha=0.35)
    t.material.blend_method = "HASHED"


def _glowing_leaf(t):
    _gltf_alpha(t)
    _glow(t)


def _volume(t):
    fog = t.add("ShaderNodeVolumePrincipled", 0, -500)
    t.link(fog.outputs[0], t.output.inputs["Volume"])


def _no_output(t):
    t.nodes.remove(t.output)


def _nothing_linked(t):
    t.links.remove(t.output.inputs["Surface"].links[0])


def _no_nodes(t):
    t.nodes.clear()


def _nodes_off(t):
    if bpy.app.version < (5, 0, 0):
        setattr(t.material, "use_" + "nodes", False)


def _everything(t):
    """All that layers cannot carry."""
    t.set(Subsurface_Weight=0.3, Transmission_Weight=0.2, Sheen_Weight=0.5, Anisotropic=0.6, Coat_Weight=0.8,
          Coat_Tint=(1.0, 0.8, 0.6, 1.0), Specular_Tint=(0.9, 0.9, 1.0, 1.0))
    if "Thin Film Thickness" in t.principled.inputs:
        t.set(Thin_Film_Thickness=300.0)
    tangent = t.add("ShaderNodeTangent", -250, -400, axis="X")
    t.link(tangent.outputs[0], t.principled.inputs["Tangent"])


def _ramps(t):
    noise = t.add("ShaderNodeTexVoronoi", -900, 0, feature="SMOOTH_F1")
    ramp = t.add("ShaderNodeValToRGB", -500, 0)
    ramp.color_ramp.elements.new(0.4).color = (0.6, 0.3, 0.1, 1.0)
    ramp.color_ramp.interpolation = "B_SPLINE"
    curves = t.add("ShaderNodeRGBCurve", -250, 0)
    curves.mapping.curves[3].points.new(0.3, 0.6)
    t.link(noise.outputs["Distance"], ramp.inputs[0])
    t.link(ramp.outputs["Color"], curves.inputs["Color"])
    t.link(curves.outputs[0], t.principled.inputs["Base Color"])
    t.link(ramp.outputs["Alpha"], t.principled.inputs["Roughness"])


def _names(t):
    t.principled.name, t.principled.label = "Bronze · n° 7", "bronze"
    t.output.name = "Ausgabe"
    t.principled["author's note"] = {"kept": [1.0, 2.5], "by": "hand"}
    t.principled.width, t.principled.hide, t.principled.use_custom_color = 311.0, True, True


def _several_principled(t):
    """Variants side by side, of which the middle one is shown."""
    for y in (-700, 700):
        t.add("ShaderNodeBsdfPrincipled", -200, y).inputs["Roughness"].default_value = 0.9
    t.nodes.active = t.image("Bake target")


def _geometry(t):
    colour = t.add("ShaderNodeAttribute", -400, 200, attribute_name="Col", attribute_type="GEOMETRY")
    geometry = t.add("ShaderNodeNewGeometry", -400, -100)
    t.link(colour.outputs["Color"], t.principled.inputs["Base Color"])
    t.link(geometry.outputs["Pointiness"], t.principled.inputs["Roughness"])


def _coated(t):
    t.set(Base_Color=(0.02, 0.05, 0.3, 1.0), Coat_Weight=1.0, Coat_Roughness=0.05, Metallic=0.4)


TREES = {
    function.__name__.strip("_").replace("_", " "): function
    for function in (
        _default, _numbers, _metal, _coated, _texture, _painted_maps, _normal_map, _bump_chain, _displacement,
        _gltf, _gltf_alpha, _obj, _cut_out, _two_principled, _glow_added, _glass, _hair, _classic, _own_group,
        _group_of_maps, _reroutes, _empty_reroute, _frames, _outputs, _shared_outputs, _two_for_all,
        _muted_texture_link, _muted_output_link, _muted_nodes, _muted_principled, _animated, _driven, _glow,
        _glowing_paint, _half_clear, _glowing_leaf, _volume, _no_output, _nothing_linked, _no_nodes, _nodes_off,
        _everything, _ramps, _names, _several_principled, _geometry,
    )
}


def make(addon, name):
    """A new material with this tree."""
    material = bpy.data.materials.new(name)
    addon.nodes.node_tree.of(material)
    TREES[name](Tree(material))
    return material
