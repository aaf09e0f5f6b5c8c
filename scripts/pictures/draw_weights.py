#!/usr/bin/python3
"""Draws the effect of the weight of each energy: the same phantom fitted with a small, a medium and a large weight.

    scripts/pictures/draw_weights.py [ENERGY ...]        writes docs/images/weight-ENERGY.png

Orange: the fit. Blue: the phantom's exact surface. Needs the release build, python3-numpy, python3-nibabel, chromium and, for
`crossing`, the head of mricron-data (scripts/setup.sh installs them).
"""
import pathlib
import sys
import tempfile

import numpy

from panels import FIT, MANY, TRUTH, Slice, Volume, Wire, read_obj, run, truth_mesh, write_png

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "build/release/cli/pellicle"
HEAD = "/usr/share/mricron/templates/ch2.nii.gz"


def stage(energies, solver="least-squares", detail=2, steps=60, smoothing=1.0):
    """A settings file with one stage, so that no other stage hides the effect of the weight."""
    lines = ["[[stage]]", 'name = "one"', f"detail = {detail}", "resolution = 1", f"smoothing = {smoothing}", "reach = 8",
             f"max_steps = {steps}", "tolerance = 0.005", f'solver = "{solver}"', "[stage.energies]"]
    return "\n".join(lines + [f"{name} = {weight}" for name, weight in energies.items()]) + "\n"


class Folder:
    def __init__(self, path):
        self.path, self.count = pathlib.Path(path), 0

    def phantom(self, *flags):
        run(PROGRAM, "phantom", "-o", self.path, "--name", "p", "--size", "64,64,64", *flags)
        return Volume(self.path / "p.nii.gz"), truth_mesh(self.path, "p") if "cluster" not in flags else None

    def fit(self, *flags, config=None, volume=None):
        """The meshes of a fit, one per object."""
        self.count += 1
        out = self.path / f"fit{self.count}"
        if config is not None:
            (self.path / "stage.toml").write_text(config)
            flags = ("--config", self.path / "stage.toml", *flags)
        run(PROGRAM, "segment", "-i", volume or self.path / "p.nii.gz", "-o", out, "--write", "mesh", "--mesh-format", "obj", *flags)
        return [read_obj(path) for path in sorted(out.glob("*_surface*.obj"))]


def three(volume, truth, fits, at=(0, 0, 0), axis=2, **more):
    panels = []
    for caption, meshes in fits:
        panel = Slice(volume, at, axis, **more)
        if truth is not None:
            panel.contour(truth, TRUTH, 1.5)
        for mesh in meshes:
            panel.contour(mesh, FIT)
        panels.append((caption, panel))
    return panels


BLOB = ("--shape", "blob", "--radius", 18, "--amplitude", 0.5, "--seed", 5)
READING = ("--polarity", "bright", "--boundary", "step", "--similarity=false")  # one hypothesis about the image only


def weighted(f, name, weights, others, *flags, solver="least-squares", detail=2, seed="0,0,0,10"):
    """Fits of one stage with the given weights of the energy `name`; all other settings are the same."""
    return [(f"{name} {w:g}", f.fit("--seed-sphere", seed, *READING, *flags, config=stage({**others, name: w}, solver, detail))) for w in weights]


def region(f):
    image, truth = f.phantom(*BLOB)
    return three(image, truth, weighted(f, "region", (0.001, 1, 1000), {"bending": 2e-3, "spacing": 0.05}))


def edge(f):
    image, truth = f.phantom(*BLOB)
    return three(image, truth, weighted(f, "edge", (0.001, 1, 1000), {"bending": 2e-3, "spacing": 0.05}, seed="0,0,0,17"))


def bending(f):
    image, truth = f.phantom(*BLOB, "--snr", 2)
    return three(image, truth, weighted(f, "bending", (2e-8, 2e-4, 0.2), {"region": 1, "spacing": 0.05}, detail=3))


def tension(f):
    image, truth = f.phantom(*BLOB)
    return three(image, truth, weighted(f, "tension", (0, 0.01, 0.1), {"region": 1, "bending": 2e-4, "spacing": 0.05}))


def flux(f):
    image, truth = f.phantom(*BLOB)
    return three(image, truth, weighted(f, "flux", (0.1, 10, 100), {"bending": 2e-3, "spacing": 0.05}, solver="gradient", seed="0,0,0,17"))


def inflation(f):
    image, truth = f.phantom(*BLOB)
    return three(image, truth, weighted(f, "inflation", (-1.5, 0, 1.5), {"region": 1, "bending": 2e-3, "spacing": 0.05}))


def volume(f):
    image, truth = f.phantom(*BLOB)
    config = stage({"region": 1, "bending": 2e-3, "spacing": 0.05})
    return three(image, truth, [(f"--volume-weight {w}", f.fit("--seed-sphere", "0,0,0,10", *READING, "--target-volume", 38, "--volume-weight", w, config=config))
                                for w in (0.1, 1, 30)])


def springs(f):
    image, truth = f.phantom(*BLOB)
    points = numpy.array([[24.0, 2.0, 0.0], [22.0, 9.0, 0.0], [23.0, -5.0, 0.0], [23.0, 2.0, 7.0], [23.0, 2.0, -7.0]])
    (f.path / "points.csv").write_text("x,y,z\n" + "\n".join(",".join(map(str, p)) for p in points) + "\n")
    panels = three(image, truth, weighted(f, "springs", (0.02, 1, 30), {"region": 1, "bending": 2e-3, "spacing": 0.05}, "--points", f.path / "points.csv"))
    for _, panel in panels:
        panel.dots(points[:3])
    return panels


def spacing(f):
    f.phantom("--shape", "ellipsoid", "--radius", "24,14,14")
    fits = weighted(f, "spacing", (0, 0.05, 10), {"region": 1, "bending": 2e-4}, "--mesh-density", 2, "--start-rule", "sphere", seed="-6,0,0,10")
    return [(caption, Wire(meshes[0], 28)) for caption, meshes in fits]


def body(f):
    image, _ = f.phantom("--shape", "cluster", "--count", 14, "--radius", "6,9", "--distance", 0.9, "--snr", 8, "--elongation", 1.8)
    panels = []
    for w in (0.001, 1, 10):
        panel = Slice(image, (0, 0, 0))
        for n, mesh in enumerate(f.fit("--preset", "nuclei", "--energy", f"body={w}")):
            panel.contour(mesh, MANY[n % len(MANY)])
        panels.append((f"body {w}", panel))
    return panels


def crossing(f):
    image = Volume(HEAD)
    return three(image, None, [(f"crossing {w}", f.fit("--preset", "brain-t1", "--energy", f"crossing={w}", volume=HEAD)) for w in (0.001, 1, 100)],
                 at=(0, 10, -10), axis=1, scale=2)


CASES = {case.__name__: case for case in (region, edge, body, crossing, bending, tension, spacing, springs, flux, volume, inflation)}


def main(names):
    for name in names or CASES:
        with tempfile.TemporaryDirectory(prefix="pellicle-weights-") as path:
            write_png(CASES[name](Folder(path)), ROOT / f"docs/images/weight-{name}.png")


if __name__ == "__main__":
    main(sys.argv[1:])
