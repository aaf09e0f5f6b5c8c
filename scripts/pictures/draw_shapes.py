#!/usr/bin/python3
"""Draws point clouds (above) and the Catmull-Clark surfaces that `pellicle fit` fits to them (below).

    scripts/pictures/draw_shapes.py CLOUD.xyz ...              writes docs/images/shapes.png
    scripts/pictures/draw_shapes.py --open CLOUD.xyz ...       open surfaces: writes docs/images/open.png

Clouds are text files with one point per line.
"""
import pathlib
import sys
import tempfile

import numpy

from panels import grey_png, read_obj, run, write_png

ROOT = pathlib.Path(__file__).resolve().parents[2]
PELLICLE = ROOT / "build" / "release" / "cli" / "pellicle"
SIZE = 176


def rows_of(path):
    rows = []
    for line in pathlib.Path(path).read_text().splitlines():
        words = line.replace(",", " ").split()
        if len(words) >= 3:
            rows.append([float(word) for word in words[:3]])
    return numpy.array(rows)


def view_of(points, from_below):
    """A function from world to picture coordinates: a rotation to the broad side, seen a little from above (or, with
    from_below, from the side of the mouth), then scaled and centred."""
    middle = points.mean(0)
    if from_below:
        axes, tilt = numpy.array([[1.0, 0, 0], [0, 0, 1.0], [0, -1.0, 0]]), numpy.radians(-40)
    else:
        axes, tilt = numpy.linalg.svd(points - middle, full_matrices=False)[2], numpy.radians(25)
        axes[2] = numpy.cross(axes[0], axes[1])
    turn = numpy.array([[1, 0, 0], [0, numpy.cos(tilt), -numpy.sin(tilt)], [0, numpy.sin(tilt), numpy.cos(tilt)]]) @ axes
    turned = (points - middle) @ turn.T
    low, high = turned.min(0), turned.max(0)
    scale = 0.94 * SIZE / (high - low)[:2].max()
    return lambda x: ((x - middle) @ turn.T - (low + high) / 2) * scale + SIZE / 2


def dotted(points):
    """A picture of the points; nearer points are darker."""
    picture = numpy.full((SIZE, SIZE), 255.0)
    shown = points[numpy.argsort(points[:, 2])]
    near = (shown[:, 2] - shown[:, 2].min()) / numpy.ptp(shown[:, 2])
    for x, y, grey in zip(shown[:, 0].astype(int), shown[:, 1].astype(int), 210 - 210 * near):
        picture[max(0, SIZE - 1 - y):SIZE - y, x:x + 1] = grey
    return picture


def shaded(points, facets):
    """A shaded picture: a depth buffer of random points on the facets, with light from the upper left of the viewer."""
    corner = points[facets]
    cross = numpy.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = numpy.linalg.norm(cross, axis=1)
    keep = area > 0
    corner, cross, area = corner[keep], cross[keep], area[keep]
    random = numpy.random.default_rng(0)
    chosen = random.choice(len(area), 900_000, p=area / area.sum())
    a, b = random.random((2, len(chosen), 1))
    a, b = numpy.where(a + b > 1, 1 - a, a), numpy.where(a + b > 1, 1 - b, b)
    place = corner[chosen, 0] + a * (corner[chosen, 1] - corner[chosen, 0]) + b * (corner[chosen, 2] - corner[chosen, 0])
    normal = (cross / area[:, None])[chosen]
    light = numpy.array([-0.4, 0.5, 0.77])
    grey = 45 + 200 * numpy.clip(normal @ light, 0, 1) + 90 * numpy.clip(-normal @ light, 0, 1)  # darker inside
    order = numpy.argsort(place[:, 2])
    x, y = numpy.clip(place[order, 0].astype(int), 0, SIZE - 1), numpy.clip(place[order, 1].astype(int), 0, SIZE - 1)
    picture = numpy.full((SIZE, SIZE), 255.0)
    picture[SIZE - 1 - y, x] = grey[order]
    return picture


class Pair:
    def __init__(self, above, below):
        self.pixels = numpy.rint(numpy.vstack([above, below]) / 8) * 8

    def extent(self):
        return SIZE, 2 * SIZE

    def svg(self):
        return f'<image href="{grey_png(numpy.clip(self.pixels, 0, 255))}" width="{SIZE}" height="{2 * SIZE}"/>'


def main(arguments):
    is_open = arguments[0] == "--open"
    clouds = arguments[1:] if is_open else arguments
    panels = []
    with tempfile.TemporaryDirectory() as folder:
        for cloud in clouds:
            run(PELLICLE, "fit", "-i", cloud, "-o", folder, "--name", "it", "--model", "catmull-clark", "--mesh-format", "obj",
                "--write", "mesh", "--overwrite", *(["--open"] if is_open else []))
            points = rows_of(cloud)
            view = view_of(points, is_open)
            vertices, facets = read_obj(pathlib.Path(folder) / "it_surface.obj")
            name = pathlib.Path(cloud).stem.replace("-2000", "").replace("_DERIVED", "")
            panels.append((name, Pair(dotted(view(points)), shaded(view(vertices), facets))))
    path = ROOT / "docs" / "images" / ("open.png" if is_open else "shapes.png")
    write_png(panels, path)


if __name__ == "__main__":
    main(sys.argv[1:])
