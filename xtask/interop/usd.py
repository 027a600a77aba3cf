"""Reads USD files with usd-core: python usd.py FOLDER OUT"""
import sys
from pathlib import Path

import numpy
from pxr import Usd, UsdGeom, UsdSkel

import tracks


def places(path, frames):
    """Joint names and where they are: frames x joints x 3, metres, y up."""
    stage = Usd.Stage.Open(str(path))
    cache = UsdSkel.Cache()
    roots = [UsdSkel.Root(prim) for prim in stage.Traverse() if prim.IsA(UsdSkel.Root)]
    cache.Populate(roots[0], Usd.TraverseInstanceProxies())
    prim = next(prim for prim in stage.Traverse() if prim.IsA(UsdSkel.Skeleton))
    query = cache.GetSkelQuery(UsdSkel.Skeleton(prim))
    unit = UsdGeom.GetStageMetersPerUnit(stage)
    rows = []
    for frame in range(frames):
        world = UsdGeom.XformCache(frame).GetLocalToWorldTransform(prim)
        rows.append([(m * world).ExtractTranslation() for m in query.ComputeJointSkelTransforms(frame)])
    rows = numpy.array(rows) * unit
    if UsdGeom.GetStageUpAxis(stage) == UsdGeom.Tokens.z:
        rows = rows[..., [0, 2, 1]] * [1, 1, -1]
    return [joint.rsplit("/", 1)[-1] for joint in query.GetJointOrder()], rows


folder, out = Path(sys.argv[1]), Path(sys.argv[2])
for job in tracks.jobs(folder, ["usda"]):
    joints, rows = places(folder / job["file"], job["frames"])
    tracks.write(out / job["file"], joints, rows)
