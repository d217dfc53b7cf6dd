# SPDX-License-Identifier: GPL-3.0-or-later
"""Interiors of Blender objects by the extension: Node Texture between two materials, as Relightable and as Lit."""

import bpy
import cycles_render
import extension


class Stone:
    """A Blender object of mixed stone, whose material's nodes say where the vein is.

    scene: its unit is a millimetre. thing: an object of the scene with one material. ground, vein: (sigma_s, sigma_a)
    in 1/mm. voxels: along the longest side. texels: of the images, along an edge. The boundary is index-matched."""

    def __init__(self, scene, thing, ground, vein, voxels, texels):
        self._scene, self._thing, self._material = scene, thing, thing.data.materials[0]
        scene.unit_settings.scale_length = 0.001
        settings = self._material.lamina.interior
        settings.source, settings.ior, settings.resolution, settings.size = "NODES", 1.0, voxels, texels
        for end, coefficients in ((settings.first, ground), (settings.second, vein)):
            end.sigma_s, end.sigma_a = coefficients
            end.g = 0.0
        self.task = self._gathered("LIT", "CAMERA")
        self.interior = self.task.fill(lambda *_: None, None)

    def show(self, output, view, samples, seed):
        """Compute images with `samples` per texel and let the material show them. output: "LIT" or "RELIGHTABLE"; view:
        "CAMERA" or "ALL", for Lit. Returns lamina.LitImages or lamina.RelightableImages."""
        import lamina  # the extension's wheel: not there before the extension is installed

        task = self._gathered(output, view)
        how = {"uvs": task.uvs, "size": task.size, "surface": task.surface, "normals": task.normals,
               "samples": samples, "seed": seed}
        if output == "LIT":
            lamps = [one.lamp(lamina) for one in task.sources if one.kind]
            found = lamina.lit_images(task.solid, self.interior, lamps, **how, **task.view)
        else:
            found = lamina.relightable_images(task.solid, self.interior, version=bpy.app.version[:2], **how)
        extension.part("interior.interior_job").apply(self._material, task, found)
        return found

    def _gathered(self, output, view):
        settings = self._material.lamina.interior
        settings.output, settings.view = output, view
        layer = self._scene.view_layers[0]
        layer.update()
        with bpy.context.temp_override(scene=self._scene, view_layer=layer), cycles_render.quiet():
            return extension.part("interior.interior_job").gather(bpy.context, self._thing, self._material)
