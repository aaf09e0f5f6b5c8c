"""Reads the meshes in a folder with code that is not Pellicle's and compares them with truth.txt (LPS mm, corners)."""
import base64
import struct
import sys
import xml.etree.ElementTree as xml

import nibabel
import numpy as np

folder = sys.argv[1]
truth = np.loadtxt(folder + "/truth.txt")


def check(name, corners, tolerance):
    worst = np.abs(corners - truth).max() if corners.shape == truth.shape else np.inf
    print(f"{name}: {worst:.3g} mm")
    if not worst <= tolerance:
        sys.exit(f"{name} differs")


gifti = nibabel.load(folder + "/m.surf.gii")
points, triangles = gifti.agg_data("pointset"), gifti.agg_data("triangle")
assert points.dtype == np.float32 and triangles.dtype == np.int32
system = gifti.get_arrays_from_intent("pointset")[0].coordsys
assert np.array_equal(system.xform, np.eye(4)), "the coordinate system is the identity"
check("gii", points[triangles.ravel()] * [-1, -1, 1], 1e-5)  # RAS -> LPS

raw = open(folder + "/m.ply", "rb").read()
head, body = raw.split(b"end_header\n", 1)
assert b"comment SPACE=LPS" in head and b"binary_little_endian" in head
n = int(head.split(b"element vertex ")[1].split()[0])
f = int(head.split(b"element face ")[1].split()[0])
vertex = np.frombuffer(body, "<f8", 6 * n).reshape(n, 6)
face = np.frombuffer(body[48 * n:], np.dtype([("n", "u1"), ("v", "<i4", 3)]), f)
assert len(body) == 48 * n + 13 * f and (face["n"] == 3).all()
assert np.allclose(np.linalg.norm(vertex[:, 3:], axis=1), 1)
check("ply", vertex[face["v"].ravel(), :3], 0)

raw = open(folder + "/m.stl", "rb").read()
assert b"SPACE=LPS" in raw[:80] and not raw.startswith(b"solid")
(count,) = struct.unpack("<I", raw[80:84])
facet = np.frombuffer(raw[84:], np.dtype([("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")]), count)
normal = np.cross(facet["v"][:, 1] - facet["v"][:, 0], facet["v"][:, 2] - facet["v"][:, 0])
assert (np.einsum("ij,ij->i", normal, facet["n"]) > 0).all()
check("stl", facet["v"].reshape(-1, 3), 1e-5)

root = xml.parse(folder + "/m.vtp").getroot()
arrays = {a.get("Name"): a for a in root.iter("DataArray")}
data = {k: base64.b64decode(a.text)[8:] for k, a in arrays.items()}
vertex = np.frombuffer(data["Points"], "<f8").reshape(-1, 3)
corner = np.frombuffer(data["connectivity"], "<i8")
assert np.array_equal(np.frombuffer(data["offsets"], "<i8"), np.arange(3, len(corner) + 1, 3))
assert [a.text.split() for a in root.iter("Array")] == [["76", "80", "83", "0"]]
check("vtp", vertex[corner], 0)
