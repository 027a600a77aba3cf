"""Reads motion files with Blender's importers: python blender.py FOLDER OUT"""
import sys
from pathlib import Path

import bpy
import numpy

import tracks

# The frame that Blender puts the first key on.
FIRST_FRAME = {"bvh": 1, "fbx": 1, "glb": 0, "usda": 0}


def load(path, rate):
    """Imports a file into an empty scene of this frame rate."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    render = bpy.context.scene.render
    render.fps, render.fps_base = round(rate), 1
    kind = path.suffix[1:]
    if kind == "bvh":
        bpy.ops.import_anim.bvh(filepath=str(path), global_scale=0.01, rotate_mode="QUATERNION")
    elif kind == "glb":
        bpy.ops.import_scene.gltf(filepath=str(path))
    elif kind == "fbx":
        bpy.ops.import_scene.fbx(filepath=str(path))
    else:
        bpy.ops.wm.usd_import(filepath=str(path))
    return kind


def play(rig, clip):
    """Chooses the action of a clip where a file holds several."""
    named = [action for action in bpy.data.actions if action.name.startswith(clip)]
    if named and rig.animation_data:
        for track in rig.animation_data.nla_tracks:
            track.mute = True
        rig.animation_data.action = named[0]
        if not rig.animation_data.action_slot and named[0].slots:
            rig.animation_data.action_slot = named[0].slots[0]


def look():
    """All that is seen of the open file: what a clip more must leave alone."""
    parts = []
    for thing in sorted(bpy.data.objects, key=lambda thing: thing.name):
        parts.append([thing.name, thing.type])
        if thing.type != "MESH":
            continue
        mesh = thing.data
        parts.append([tuple(vertex.co) for vertex in mesh.vertices])
        parts.append([[(group.group, group.weight) for group in vertex.groups] for vertex in mesh.vertices])
        parts.append([tuple(polygon.vertices) for polygon in mesh.polygons])
        parts.append([material.name for material in mesh.materials] + [group.name for group in thing.vertex_groups])
    return parts


def places(rig, first, step, frames):
    """Where every bone begins: frames x bones x 3, metres, y up."""
    rows = []
    for frame in range(frames):
        whole, part = divmod(first + frame * step, 1)
        bpy.context.scene.frame_set(int(whole), subframe=part)
        world = numpy.array(rig.matrix_world)
        heads = numpy.array([bone.head for bone in rig.pose.bones])
        rows.append(heads @ world[:3, :3].T + world[:3, 3])
    return numpy.array(rows)[..., [0, 2, 1]] * [1, 1, -1]


def read(path, job):
    """Names of the bones and where they are."""
    kind = load(path, job["rate"])
    rig = next(thing for thing in bpy.data.objects if thing.type == "ARMATURE")
    play(rig, job["clip"])
    # Keys with times are placed at whole frame rates; those of BVH and USD are frames already.
    step = round(job["rate"]) / job["rate"] if kind in ("glb", "fbx") else 1
    return [bone.name for bone in rig.pose.bones], places(rig, FIRST_FRAME[kind], step, job["frames"])


folder, out = Path(sys.argv[1]), Path(sys.argv[2])
for job in tracks.jobs(folder, FIRST_FRAME):
    path, error = folder / job["file"], None
    # Importers write much to the standard output.
    with tracks.silence():
        joints, rows = read(path, job)
        if job["original"]:
            after = look()
            load(folder / job["original"], job["rate"])
            error = None if look() == after else "mesh, skin or material changed"
    if error:
        (out / f"{job['file']}.failed").write_text(error)
    else:
        tracks.write(out / job["file"], joints, rows)
