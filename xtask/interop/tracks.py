"""What the Python importers share: the list of files, and places written down as our own are."""
import contextlib
import json
import os
from pathlib import Path

import numpy


def jobs(folder, extensions):
    """The files with one of these extensions, as dictionaries."""
    files = json.loads((Path(folder) / "files.json").read_text())
    return [job for job in files if job["file"].rsplit(".", 1)[1] in extensions]


def write(path, joints, places):
    """places: frames x joints x 3, metres, y up."""
    places = numpy.asarray(places, dtype="<f4").reshape(-1, len(joints), 3)
    header = json.dumps({"joints": joints, "frames": len(places)})
    Path(path).write_bytes(header.encode() + b"\n" + places.tobytes())


@contextlib.contextmanager
def silence():
    """Sends what this process prints nowhere, also what libraries print."""
    kept, nowhere = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    try:
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
        os.close(nowhere)
