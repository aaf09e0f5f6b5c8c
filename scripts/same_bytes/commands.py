"""What the two programs are asked to do: inputs made once, and the commands that are run by both.

In a command, @ is the folder of its outputs. A command runs in a folder that holds data/ and results/.
"""
import gzip
import json
import math
import random
import shlex
import struct

from programs import run_well

CH2 = "/usr/share/mricron/templates/ch2.nii.gz"
EVERYTHING = "mask,mesh,model,report,qc,convergence,sdf,prob"
# Commands that take no --threads.
SERIAL = ("info", "completion", "manual", "--version", "--help", "nonsense")

PHANTOMS = """
--name bean --shape bean --radius 11 --size 36,36,36 --seed 7
--name ellipsoid --shape ellipsoid --radius 11,8,7 --size 32,30,28 --seed 3 --spacing 1,1,1.2 --direction 10,20,30
--name dark --shape blob --radius 10 --size 32,32,32 --seed 5 --contrast 20,100
--name torus --shape torus --radius 10,4 --size 36,36,20 --seed 9
--name membrane --shape blob --radius 11 --fill shell --shell-thickness 2 --size 36,36,36 --seed 2 --snr 8
--name cells --shape cluster --count 8 --radius 4,6 --size 48,48,32 --seed 4
--name frame0 --shape sphere --radius 7 --size 28,28,28 --seed 11 --snr 8
--name frame1 --shape sphere --radius 8 --size 28,28,28 --seed 12 --snr 8 --center 0.5,0,0
--name frame2 --shape sphere --radius 9 --size 28,28,28 --seed 13 --snr 8 --center 1,0,0
"""
# Saved models and reports that later commands begin with.
RESULTS = """
segment -i data/bean.nii.gz -o results --name one --write mask,mesh,model,report,qc
segment -i data/ellipsoid.nii.gz -o results --name two --write mask,mesh,model,report
segment -i data/bean.nii.gz -o results --name three --model catmull-clark --write mask,model,report
"""

# Short form: within a minute for both programs.
SHORT = {
    "phantom": "phantom -o @ --name p --shape dumbbell --radius 9 --size 32,30,28 --bias 0.2 --noise rician --direction 5,0,9",
    "segment-everything": f"segment -i data/bean.nii.gz -o @ --write {EVERYTHING}",
    "segment-spline": "segment -i data/bean.nii.gz -o @ --model spline --seed-sphere 0,0,0,5",
    "segment-catmull-clark": "segment -i data/bean.nii.gz -o @ --model catmull-clark --mesh-format obj",
    "segment-slime": "segment -i data/bean.nii.gz -o @ --model slime --seed-sphere 0,0,0,6 --mesh-format stl",
    "segment-many": "segment -i data/cells.nii.gz -o @ --objects many --write mask,model,report",
    "segment-series": "segment -i data/series.nii -o @ --seed-sphere 0,0,0,4",
    "segment-points": "segment -i data/bean.nii.gz -o @ --points data/expert.csv --write model,report",
    "segment-handle": "segment -i data/torus.nii.gz -o @ --seed-mask data/torus_truth.nii.gz --model slime",
    "segment-gradient": "segment -i data/ellipsoid.nii.gz -o @ --solver gradient --write model,report",
    "segment-ijk": "segment -i data/ellipsoid.nii.gz -o @ --coords ijk --seed-sphere 16,15,14,5 --write model,report",
    "segment-dry-run": "segment -i data/bean.nii.gz -o @ --dry-run --preset bright --energy edge=0.5",
    "fit-cloud": "fit -i data/cloud.xyz -o @ --mesh-density 3",
    "fit-open": "fit -i data/bowl.xyz -o @ --model catmull-clark --open --mesh-density 2",
    "morph": "morph results/one_model.json results/two_model.json -o @ --steps 3 --space sphere --from -0.2",
    "export": "export results/one_model.json --mesh @/m.vtp --control @/c.ply --mask @/mask.nii.gz --sdf @/sdf.nii.gz "
              "--prob @/prob.nii.gz --like data/bean.nii.gz",
    "evaluate": "evaluate data/bean_truth.json results/one_mask.nii.gz --json @/scores.json",
    "batch": "batch data/cases.csv -o @ --keep-going",
    "report": "report results -o @/page.html",
    "info": "info data/bean.nii.gz --json",
    "energies": "segment --energy list",
    "presets": "segment --preset list",
    "manual": "manual segment",
    "completion": "completion bash",
    "boutiques": "segment --boutiques",
    "slicer": "segment --xml",
    "error-flag": "segment --no-such-flag",
    "error-input": "segment -i data/none.nii.gz -o @",
    "error-volume": "segment -i data/broken.nii.gz -o @",
    "error-seed": "segment -i data/bean.nii.gz -o @ --seed-sphere 900,0,0,5",
}

# What the full form adds.
FULL = {
    "phantom-cluster": "phantom -o @ --name p --shape cluster --count 5 --radius 3,5 --size 36,36,24 --contrast-range 0.5,1",
    "phantom-shell": "phantom -o @ --name p --shape double-torus --radius 8,3 --fill shell --size 48,32,20 --noise poisson",
    "phantom-tube": "phantom -o @ --name p --shape tube --radius 10 --size 32,32,32 --noise none --center 1,2,3",
    "phantom-superquadric": "phantom -o @ --name p --shape superquadric --radius 9,8,7 --size 32,32,32 --blur 2",
    "segment-brain": f"segment -i {CH2} -o @ --preset brain-t1 --write {EVERYTHING}",
    "segment-default": "segment -i data/ellipsoid.nii.gz -o @ -v --log-json",
    "segment-dark": "segment -i data/dark.nii.gz -o @ --polarity dark --similarity=false --mesh-format gii",
    "segment-membrane": "segment -i data/membrane.nii.gz -o @ --preset membrane --mesh-format vtp",
    "segment-rules": "segment -i data/bean.nii.gz -o @ --rule published --start octahedron --detail 2 --start-rule rays",
    "segment-balanced": "segment -i data/bean.nii.gz -o @ --rule balanced --start icosahedron --start-rule sphere",
    "segment-trace": "segment -i data/ellipsoid.nii.gz -o @ --trace @/trace --trace-every 5 --write report,convergence",
    "segment-files": "segment -i data/bean.nii.gz --output-mask @/m.nii.gz --output-mesh @/m.stl --progress-xml",
    "segment-config": "segment -i data/bean.nii.gz -o @ --config data/settings.toml",
    "segment-spline-everything": f"segment -i data/ellipsoid.nii.gz -o @ --model spline --write {EVERYTHING}",
    "segment-spline-torus": "segment -i data/torus.nii.gz -o @ --model spline-torus --seed-mask data/torus_truth.nii.gz",
    "segment-handle-catmull-clark": "segment -i data/torus.nii.gz -o @ --seed-mask data/torus_truth.nii.gz "
                                    f"--model catmull-clark --write {EVERYTHING}",
    "segment-handle-normal": "segment -i data/torus.nii.gz -o @ --seed-mask data/torus_truth.nii.gz",
    "segment-seed-mask": "segment -i data/bean.nii.gz -o @ --seed-mask data/bean_truth.nii.gz:1",
    "segment-seed-model": "segment -i data/bean.nii.gz -o @ --seed-model results/three_model.json",
    "segment-two-seeds": "segment -i data/cells.nii.gz -o @ --seeds data/seeds.csv --write mask,report",
    "segment-many-seeds": "segment -i data/cells.nii.gz -o @ --objects many --seeds data/seeds.csv --model normal",
    "segment-many-everything": f"segment -i data/cells.nii.gz -o @ --preset nuclei --radius 4,6 --write {EVERYTHING}",
    "segment-many-series": "segment -i data/series.nii -o @ --objects many --write mask",
    "segment-points-pull": "segment -i data/bean.nii.gz -o @ --points data/expert.csv --points-pull point --model spline",
    "segment-dynamic": "segment -i data/bean.nii.gz -o @ --solver dynamic --mass 0.2 --damping 0.8 --write model,report",
    "segment-levenberg-marquardt": "segment -i data/bean.nii.gz -o @ --solver levenberg-marquardt --model catmull-clark "
                                   "--write model,report",
    "segment-gradient-spline": "segment -i data/bean.nii.gz -o @ --solver gradient --model spline --write model,report",
    "segment-flux": "segment -i data/bean.nii.gz -o @ --energy flux=1,inflation=0.1,tension=0.01 --write model,report",
    "segment-crossing": "segment -i data/bean.nii.gz -o @ --energy crossing=1 --boundary step --write model,report",
    "segment-volume": "segment -i data/bean.nii.gz -o @ --target-volume 5 --volume-weight 2 --write model,report",
    "segment-error-target": "segment -i data/bean.nii.gz -o @ --error-target 0.3 --write model,report",
    "segment-ras": "segment -i data/ellipsoid.nii.gz -o @ --coords ras --seed-point 0,1,0 --seed-radius 4 --write model,report",
    "segment-dry-run-alone": "segment --dry-run --model spline --solver dynamic",
    "fit-mesh": "fit -i data/bean_truth.ply -o @ --detail 1 --mesh-density 2",
    "fit-mask": "fit -i data/bean_truth.nii.gz -o @ --model catmull-clark --detail 1 --mesh-density 2",
    "fit-label": "fit -i data/cells_truth.nii.gz:2 -o @ --model normal --mesh-density 2 --mesh-format obj",
    "fit-slime": "fit -i data/torus_truth.nii.gz -o @ --model slime --detail 1 --mesh-density 2",
    "fit-spline-grid": "fit -i data/cloud.xyz -o @ --model spline --size 8,12 --mesh-density 2",
    "fit-ladder": "fit -i data/cloud.xyz -o @ --model spline --ladder 6,10,14 --mesh-density 2",
    "fit-tolerance": "fit -i data/cloud.xyz -o @ --tolerance-mm 0.2 --tolerance-of p95 --mesh-density 2",
    "fit-smooth": "fit -i data/cloud.csv -o @ --smoothness 4 --detail 1 --mesh-density 2 --mesh-format gii",
    "morph-plane": "morph results/one_model.json results/two_model.json -o @ --mesh-format stl",
    "export-formats": "export results/three_model.json --mesh @/m.surf.gii --density 2 --control @/c.obj",
    "export-stl": "export results/two_model.json --mesh @/m.stl --control @/c.vtp --density 4",
    "evaluate-multi": "evaluate data/cells_truth.nii.gz data/cells_truth.nii.gz --multi --tolerance-mm 0.5 --json @/scores.json",
    "evaluate-mesh": "evaluate data/bean_truth.ply results/two_model.json --json @/scores.json",
    "batch-jobs": "batch data/bean.nii.gz data/dark.nii.gz -o @ --jobs 2 --detail 1 --write mask,report",
    "batch-stops": "batch data/cases.csv -o @",
    "bids": "bids data/study @ participant --preset bright",
    "bids-group": "bids data/study data/study/derivatives/pellicle group",
    "report-small": "report results -o @/page.html --no-viewer --title Small",
    "info-text": "info data/series.nii",
    "info-mesh": "info data/bean_truth.ply",
    "info-model": "info results/one_model.json --json",
    "manual-all": "manual",
    "manual-fit": "manual fit",
    "help": "--help",
    "help-segment": "segment --help",
    "help-batch": "batch --help",
    "version": "--version",
    "batch-help-of-nothing": "batch",
    "error-command": "nonsense",
    "error-model": "segment -i data/bean.nii.gz -o @ --model cube",
    "error-preset": "segment -i data/bean.nii.gz -o @ --preset nothing",
    "error-energy": "segment -i data/bean.nii.gz -o @ --energy gravity=1",
    "error-write": "segment -i data/bean.nii.gz -o @ --write everything",
    "error-config": "segment -i data/bean.nii.gz -o @ --config data/wrong.toml",
    "error-seeds": "segment -i data/bean.nii.gz -o @ --seeds data/wrong.csv",
    "error-exists": "segment -i data/bean.nii.gz -o results --name one",
    "error-export": "export data/bean_truth.json --mesh @/m.ply",
    "error-morph": "morph results/one_model.json results/three_model.json -o @",
    "error-fit": "fit -i data/wrong.csv -o @",
    "error-manifest": "batch data/wrong.csv -o @",
    "error-evaluate": "evaluate data/none.json results/one_mask.nii.gz",
    "error-spectrum": "segment -i data/spectrum.nii -o @",
}

# What every number of threads has to agree on, short enough for each run of the tests.
THREADS = ["segment-everything", "segment-spline", "segment-catmull-clark", "segment-many", "segment-gradient", "segment-points",
           "segment-handle", "fit-spline-grid", "fit-open", "morph", "export", "evaluate"]


def arguments(command, name, threads):
    """The words of a command for `threads` threads; 0: as the program likes."""
    words = [word.replace("@", f"out/{name}") for word in shlex.split(command)]
    return words + (["--threads", str(threads)] if threads and words[0] not in SERIAL else [])


def series_of(frames, time_unit):
    """3D NIfTI-1 files as one 4D file under the first one's header."""
    volumes = [bytearray(gzip.decompress(path.read_bytes())) for path in frames]
    joined = volumes[0] + b"".join(bytes(volume[352:]) for volume in volumes[1:])
    struct.pack_into("<h", joined, 40, 4)
    struct.pack_into("<h", joined, 48, len(volumes))
    struct.pack_into("<f", joined, 92, 2.5)
    joined[123] = (joined[123] & 7) | time_unit
    return bytes(joined)


def cloud(count, open_top):
    """Points near a ball with three bumps, or near its lower half."""
    engine, points = random.Random(1), []
    while len(points) < count:
        x = [engine.gauss(0, 1) for _ in range(3)]
        length = math.hypot(*x)
        u = [c / length for c in x]
        if open_top and u[2] > 0.1:
            continue
        radius = (20 if open_top else 20 + 2 * math.sin(3 * u[0]) * math.cos(2 * u[1])) + engine.gauss(0, 0.1)
        points.append([radius * c for c in u])
    return points


def rows(points, separator):
    return "".join(separator.join(f"{c:.5f}" for c in point) + "\n" for point in points)


def make_inputs(program, folder):
    """data/ and results/ in `folder`, by the first program."""
    data = folder / "data"
    for line in PHANTOMS.strip().splitlines():
        run_well(program, ["phantom", "-o", "data", *line.split()], folder)
    frames = [data / f"frame{t}.nii.gz" for t in range(3)]
    (data / "series.nii").write_bytes(series_of(frames, 8))
    (data / "spectrum.nii").write_bytes(series_of(frames, 32))
    (data / "broken.nii.gz").write_bytes(frames[0].read_bytes()[:3000])
    points = cloud(600, False)
    (data / "cloud.xyz").write_text(rows(points, " "))
    (data / "cloud.csv").write_text("x,y,z\n" + rows(points, ","))
    (data / "bowl.xyz").write_text(rows(cloud(500, True), " "))
    (data / "expert.csv").write_text("x,y,z,weight\n10,0,0,1\n0,-9,1,2\n")
    (data / "seeds.csv").write_text("x,y,z,r,label,name\n" + cluster_seeds(data))
    (data / "wrong.csv").write_text("x,y\n1,word\n")
    (data / "settings.toml").write_text('model = "catmull-clark"\nwrite = ["mask", "report"]\nsmoothing = 1.5\n')
    (data / "wrong.toml").write_text('modle = "normal"\n')
    (data / "cases.csv").write_text('name,input,seed-sphere\na,bean.nii.gz,"0,0,0,5"\nb,broken.nii.gz,\nc,ellipsoid.nii.gz,\n')
    study = data / "study"
    for label, image in (("01", "bean"), ("02", "ellipsoid")):
        anat = study / f"sub-{label}" / "anat"
        anat.mkdir(parents=True)
        (anat / f"sub-{label}_T1w.nii.gz").write_bytes((data / f"{image}.nii.gz").read_bytes())
    (study / "dataset_description.json").write_text('{"Name": "Study", "BIDSVersion": "1.9.0"}\n')
    for line in RESULTS.strip().splitlines():
        run_well(program, line.split(), folder)
    run_well(program, shlex.split("bids data/study data/study/derivatives/pellicle participant --preset bright"), folder)


def cluster_seeds(data):
    truth = json.loads((data / "cells_truth.json").read_text())
    return "".join(",".join(f"{c:.3f}" for c in seed["center"]) + f",3,{n + 1},cell-{n + 1}\n"
                   for n, seed in enumerate(truth["objects"][:2]))
