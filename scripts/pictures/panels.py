"""Panels of slices and surfaces side by side in one PNG file: drawn as SVG and rendered by a headless Chromium.

Voxels are drawn as squares of whole pixels, so that the PNG stays small.
"""
import base64
import html
import pathlib
import struct
import subprocess
import sys
import tempfile
import zlib

import nibabel
import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "tests" / "report"))
from browser import Browser  # noqa: E402

FIT, TRUTH, SEED = "#e69f00", "#56b4e9", "#f0e442"  # colours that colour-blind people can distinguish
MANY = [FIT, TRUTH, "#009e73", "#f0e442", "#cc79a7", "#d55e00"]
GAP, HEAD = 8, 26


def run(program, *arguments):
    """Runs a command. Exit codes 0 and 3 (an object failed its checks) are accepted; every other code raises an error."""
    done = subprocess.run([program, *map(str, arguments), "-q"], capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise RuntimeError(f"{arguments}: {done.stderr}")
    return done.stdout


def grey_png(pixels):
    """A data URL of an 8-bit grey picture; the first row is the top."""
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    rows = b"".join(b"\0" + row.tobytes() for row in pixels.astype(numpy.uint8))
    png = b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 0, 0, 0, 0))
    png += chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")
    return "data:image/png;base64," + base64.b64encode(png).decode()


def read_obj(path):
    points, facets = [], []
    for line in pathlib.Path(path).read_text().splitlines():
        if line.startswith("v "):
            points.append([float(word) for word in line.split()[1:4]])
        elif line.startswith("f "):
            facets.append([int(word.split("/")[0]) - 1 for word in line.split()[1:4]])
    return numpy.array(points), numpy.array(facets)


def truth_mesh(folder, name):
    """The true surface of a phantom, from its PLY file."""
    data = (folder / f"{name}_truth.ply").read_bytes()
    head, body = data.split(b"end_header\n", 1)
    words = head.decode().splitlines()
    count = {w.split()[1]: int(w.split()[2]) for w in words if w.startswith("element")}
    vertex = [w.split() for w in words if w.startswith("property") and "list" not in w]
    row = numpy.dtype([(w[2], "<" + {"float": "f4", "double": "f8"}[w[1]]) for w in vertex])
    table = numpy.frombuffer(body, row, count["vertex"])
    facets = numpy.frombuffer(body, numpy.dtype([("n", "u1"), ("v", "<i4", 3)]), count["face"], row.itemsize * count["vertex"])
    return numpy.stack([table["x"], table["y"], table["z"]], 1).astype(float), facets["v"]


class Volume:
    """A volume whose axes point to the patient's left, front and head, so that pictures show the right on the left."""

    def __init__(self, path, window=None):
        picture = nibabel.as_closest_canonical(nibabel.load(path))
        self.values = numpy.asarray(picture.dataobj, dtype=float)[::-1]
        mirror = numpy.diag([-1.0, 1, 1, 1])
        mirror[0, 3] = len(self.values) - 1
        self.index_from_ras = mirror @ numpy.linalg.inv(picture.affine)
        self.spacing = numpy.linalg.norm(picture.affine[:3, :3], axis=0)
        self.low, self.high = window or numpy.percentile(self.values, [0.5, 99.8])

    def index(self, lps):
        ras = numpy.asarray(lps, float) * [-1, -1, 1]
        return ras @ self.index_from_ras[:3, :3].T + self.index_from_ras[:3, 3]


def cut(points, facets, axis, level):
    """Line segments where a mesh meets the plane in which coordinate `axis` is `level`."""
    level += 1e-7
    corner = points[facets]
    side = corner[:, :, axis] > level
    crossed = side.any(1) & ~side.all(1)
    segments = []
    for c, s in zip(corner[crossed], side[crossed]):
        ends = []
        for a, b in ((0, 1), (1, 2), (2, 0)):
            if s[a] != s[b]:
                t = (level - c[a][axis]) / (c[b][axis] - c[a][axis])
                ends.append(c[a] + t * (c[b] - c[a]))
        segments.append(ends)
    return numpy.array(segments)


class Slice:
    """One slice of a volume with contours of surfaces. `at` is a point of the slice, LPS mm; `axis` is the voxel axis at
    right angles to the slice; `box` the voxels that are shown; `scale` the pixels per shortest voxel edge."""

    def __init__(self, volume, at, axis=2, scale=6, box=None):
        self.volume, self.axis = volume, axis
        self.across, self.up = [a for a in range(3) if a != axis]
        self.level = int(round(float(volume.index(at)[axis])))
        size = numpy.array(volume.values.shape)
        low, high = (numpy.zeros(3, int), size) if box is None else (numpy.maximum(box[0], 0), numpy.minimum(box[1], size))
        self.low, self.high = low, high
        edges = volume.spacing / volume.spacing.min() * scale
        self.pixels = round(edges[self.across]), round(edges[self.up])
        self.parts = []

    def extent(self):
        return ((self.high[self.across] - self.low[self.across]) * self.pixels[0], (self.high[self.up] - self.low[self.up]) * self.pixels[1])

    def place(self, index):
        """Picture coordinates from voxel coordinates; the second axis points up."""
        x = (index[..., self.across] - self.low[self.across] + 0.5) * self.pixels[0]
        y = (self.high[self.up] - index[..., self.up] - 0.5) * self.pixels[1]
        return x, y

    def contour(self, mesh, colour=FIT, width=2.5, dash=""):
        segments = cut(self.volume.index(mesh[0]), mesh[1], self.axis, self.level)
        if len(segments) == 0:
            return self
        x, y = self.place(segments)
        path = "".join(f"M{a[0]:.1f} {b[0]:.1f}L{a[1]:.1f} {b[1]:.1f}" for a, b in zip(x, y))
        self.parts.append(f'<path d="{path}" stroke="{colour}" stroke-width="{width}" stroke-linecap="round" fill="none"/>')
        return self

    def dots(self, places, colour=SEED, radius=5):
        for x, y in zip(*self.place(self.volume.index(numpy.atleast_2d(places)))):
            self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{radius}" fill="{colour}" stroke="#000"/>')
        return self

    def ball(self, centre, radius_mm, colour=SEED):
        x, y = self.place(self.volume.index(numpy.asarray(centre, float)))
        r = radius_mm / self.volume.spacing[self.across] * self.pixels[0]
        self.parts.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{r:.1f}" fill="none" stroke="{colour}" stroke-width="2" stroke-dasharray="6 5"/>')
        return self

    def svg(self):
        v = self.volume
        grey = numpy.clip((v.values - v.low) / (v.high - v.low), 0, 1) * 255
        plane = numpy.take(grey, self.level, self.axis)
        plane = plane[self.low[self.across]:self.high[self.across], self.low[self.up]:self.high[self.up]]
        w, h = self.extent()
        # 64 grey values are enough for the eye, and the file is smaller.
        data = grey_png((numpy.rint(plane / 255 * 63) * (255 / 63)).T[::-1])
        return f'<image href="{data}" width="{w}" height="{h}" preserveAspectRatio="none" style="image-rendering:pixelated"/>' + "".join(self.parts)


class Wire:
    """A wire frame of the facets that face a viewer who looks along +y, LPS."""

    def __init__(self, mesh, half_width, size=336):
        self.mesh, self.half, self.size = mesh, half_width, size

    def extent(self):
        return self.size, self.size

    def svg(self):
        points, facets = self.mesh
        scale = self.size / (2 * self.half)
        x, y = self.size / 2 + points[:, 0] * scale, self.size / 2 - points[:, 2] * scale
        out = []
        for f in facets:
            a, b, c = points[f]
            normal = numpy.cross(b - a, c - a)
            if normal[1] < 0:
                shade = int(60 + 120 * -normal[1] / numpy.linalg.norm(normal))
                corners = " ".join(f"{x[i]:.1f},{y[i]:.1f}" for i in f)
                out.append(f'<polygon points="{corners}" fill="rgb({shade},{int(shade * 0.8)},{int(shade * 0.45)})" stroke="#fff" stroke-width="0.7"/>')
        return f'<rect width="{self.size}" height="{self.size}" fill="#1a1a20"/>' + "".join(out)


def write_png(panels, path):
    """Writes the panels side by side. `panels`: pairs of a caption and an object with extent() and svg()."""
    groups, x, height = [], 0, 0
    for caption, panel in panels:
        w, h = panel.extent()
        groups.append(f'<g transform="translate({x} 0)"><text x="2" y="18">{html.escape(caption)}</text>'
                      f'<svg y="{HEAD}" width="{w}" height="{h}">{panel.svg()}</svg></g>')
        x, height = x + w + GAP, max(height, h)
    width, height = x - GAP, height + HEAD
    page = ('<!doctype html><style>body{margin:0;background:#fff}text{font:600 15px "DejaVu Sans",sans-serif;fill:#222}</style>'
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}">{"".join(groups)}</svg>')
    with tempfile.NamedTemporaryFile("w", suffix=".html") as file:
        file.write(page)
        file.flush()
        browser = Browser(int(width), int(height))
        try:
            browser.open(file.name)
            browser.wait_for("document.readyState === 'complete' && document.querySelector('svg') !== null")
            browser.screenshot(path)
        finally:
            browser.close()
    print(f"{path}: {width} x {height}, {pathlib.Path(path).stat().st_size // 1024} KB")
