"""Runs inside Blender, for ground_truth_peers.py: passes of a film by Cycles, one sample at each pixel's centre.

    blender -b --factory-startup --python blender_passes.py -- FILE.glb IDS.json WIDTH HEIGHT FRAMES_PER_SECOND FRAMES PASSES FOLDER

IDS.json: the index that each body's pixels get, by name. PASSES: of z, normal, object_index, vector, with commas.
"""
import json, sys

import bpy, numpy

numpy.bool = bool  # the importer of Debian's Blender 3.4 asks for it; numpy has it no more

GROUND_SCALE = 20  # the ground of the .glb is a square; that many times as wide it fills the picture


def load(glb, ids, frames_per_second):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = frames_per_second  # before the import, so that its keys fall on whole frames
    bpy.ops.import_scene.gltf(filepath=glb)
    for thing in list(bpy.data.objects):
        if thing.type == "LIGHT":
            bpy.data.objects.remove(thing)  # passes need none
            continue
        for name in (thing.name, thing.parent and thing.parent.name):
            thing.pass_index = ids.get(name, thing.pass_index)
        if thing.name == "ground":
            thing.scale = [GROUND_SCALE] * 3


def choose_passes(scene, passes):
    """No colours: no bounces of light, no other work than the first ray's."""
    scene.render.engine = "CYCLES"
    cycles = scene.cycles
    cycles.device, cycles.samples, cycles.max_bounces = "CPU", 1, 0
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "GAUSSIAN", 0.01  # pixels; the least that there is
    layer = bpy.context.view_layer
    layer.use_pass_combined = False
    for name in passes:
        setattr(layer, f"use_pass_{name}", True)


def main(glb, ids, width, height, frames_per_second, frames, passes, folder):
    with open(ids) as file:
        load(glb, json.load(file), int(frames_per_second))
    scene = bpy.context.scene
    scene.camera = bpy.data.objects["camera"]
    choose_passes(scene, passes.split(","))
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = int(width), int(height), 100
    render.threads_mode, render.threads = "FIXED", 1
    render.use_persistent_data = True  # from frame to frame what does not change stays
    render.use_compositing = render.use_sequencer = False
    settings = render.image_settings
    settings.file_format, settings.color_depth, settings.exr_codec = "OPEN_EXR_MULTILAYER", "32", "ZIP"
    render.filepath = f"{folder}/passes_######"
    scene.frame_start, scene.frame_end = 0, int(frames) - 1
    bpy.ops.render.render(animation=True)


main(*sys.argv[sys.argv.index("--") + 1:])
