#!/usr/bin/python3
"""Draws the result of each preset on an example: three slices with the surface and, if there is one, the click.

    scripts/pictures/draw_presets.py [--data FOLDER] [PRESET ...]       writes docs/images/preset-PRESET.png

`organ-ct` and `lesion` need FOLDER/organs-ct/example_ct.nii.gz (TotalSegmentator's test files) and FOLDER/sarcoma/STS_002_CT_image.nii.gz
(IBSI validation set); without --data they are skipped. The others use phantoms and the head of mricron-data.
"""
import argparse
import pathlib
import tempfile

import numpy

from draw_weights import HEAD, ROOT, Folder
from panels import FIT, MANY, Slice, Volume, write_png

FOLDER = None
NAMES = ("axial", "coronal", "sagittal")


def slices(volume, meshes, at, scale=6, box=None, click=None):
    """Three slices through the point `at`; the click as a dashed circle."""
    panels = []
    for axis, name in zip((2, 1, 0), NAMES):
        panel = Slice(volume, at, axis, scale, box)
        for n, mesh in enumerate(meshes):
            panel.contour(mesh, FIT if len(meshes) == 1 else MANY[n % len(MANY)], 2.5)
        if click is not None:
            panel.ball(click[:3], click[3])
        panels.append((name, panel))
    return panels


def words(ball):
    return ",".join(f"{x:g}" for x in ball)


def around(volume, mesh, margin_mm):
    index = volume.index(mesh[0])
    margin = margin_mm / volume.spacing
    return numpy.floor(index.min(0) - margin).astype(int), numpy.ceil(index.max(0) + margin).astype(int)


def solid(preset, *flags, click=(0, 0, 0, 6)):
    def draw(f):
        volume, _ = f.phantom("--radius", 18, *flags)
        return slices(volume, f.fit("--preset", preset, "--seed-sphere", words(click)), (0, 0, 0), click=click)
    return draw


def many(preset, *flags):
    def draw(f):
        volume, _ = f.phantom("--shape", "cluster", "--radius", "5,9", "--snr", 6, *flags)
        return slices(volume, f.fit("--preset", preset), (0, 0, 0))
    return draw


def brain(f):
    volume = Volume(HEAD)
    return slices(volume, f.fit("--preset", "brain-t1", volume=HEAD), (0, 18, 12), scale=2)


def clicked(preset, path, click, margin, scale, window):
    def draw(f):
        volume = Volume(FOLDER / path, window)
        meshes = f.fit("--preset", preset, "--seed-sphere", words(click), volume=FOLDER / path)
        return slices(volume, meshes, click[:3], scale, around(volume, meshes[0], margin), click)
    return draw


CASES = {
    "bright": solid("bright", "--shape", "bean", "--bias", 0.3),
    "dark": solid("dark", "--shape", "blob", "--contrast", "20,100"),
    "membrane": solid("membrane", "--shape", "blob", "--seed", 5, "--fill", "shell"),
    "brain-t1": brain,
    "nuclei": many("nuclei", "--count", 24, "--distance", 1),
    "membrane-cells": many("membrane-cells", "--count", 36, "--distance", 1, "--contrast", "20,100"),
    "organ-ct": clicked("organ-ct", "organs-ct/example_ct.nii.gz", (-89, -161, 388, 5), 30, 4, (-120, 200)),
    "lesion": clicked("lesion", "sarcoma/STS_002_CT_image.nii.gz", (75, 120, -560, 5), 40, 2, (-120, 160)),
}


def main():
    global FOLDER
    parser = argparse.ArgumentParser()
    parser.add_argument("--data", type=pathlib.Path)
    parser.add_argument("preset", nargs="*")
    arguments = parser.parse_args()
    FOLDER = arguments.data
    for name in arguments.preset or CASES:
        if name in ("organ-ct", "lesion") and FOLDER is None:
            print(f"{name}: left out, no --data")
            continue
        with tempfile.TemporaryDirectory(prefix="pellicle-presets-") as path:
            write_png(CASES[name](Folder(path)), ROOT / f"docs/images/preset-{name}.png")


if __name__ == "__main__":
    main()
