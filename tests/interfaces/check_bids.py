"""`pellicle bids` on a small dataset of phantoms, by the rules of BIDS 1.9 for derivatives.

Usage: check_bids.py PELLICLE
Rules from bids-standard/bids-specification: src/derivatives/imaging.md (masks, space-orig), common-data-types.md
(Sources as BIDS URIs through DatasetLinks), src/schema/rules/dataset_metadata.yaml (GeneratedBy),
rules/entities.yaml (order of entities).
"""
import json
import pathlib
import re
import subprocess
import sys
import tempfile

ORDER = ["sub", "ses", "sample", "task", "acq", "ce", "rec", "dir", "run", "echo", "space", "seg", "res", "den", "label",
         "desc"]
SUFFIXES = {"mask": {".nii.gz", ".json"}, "dseg": {".nii.gz", ".json", ".tsv"}}


def name_faults(path):
    """What is wrong with one file of sub-*/."""
    name, faults = path.name, []
    match = re.fullmatch(r"((?:[a-z]+-[A-Za-z0-9]+_)+)([a-z]+)(\.[a-z.]+)", name)
    if not match:
        return [f"{name}: not entities, suffix, extension"]
    entities = [entity.split("-") for entity in match[1].rstrip("_").split("_")]
    keys = [key for key, _ in entities]
    if any(key not in ORDER for key in keys) or keys != sorted(set(keys), key=ORDER.index):
        faults.append(f"{name}: entities {keys}")
    if match[3] not in SUFFIXES.get(match[2], set()):
        faults.append(f"{name}: {match[2]}{match[3]}")
    values = dict(entities)
    folders = [f"sub-{values.get('sub')}"] + ([f"ses-{values['ses']}"] if "ses" in values else []) + ["anat"]
    if list(path.parts[-len(folders) - 1:-1]) != folders:
        faults.append(f"{path}: not in {folders}")
    return faults


def dataset_faults(root, raw):
    description = json.loads((root / "dataset_description.json").read_text())
    faults = [f"dataset_description: {key}" for key in ("Name", "BIDSVersion") if not description.get(key)]
    if description.get("DatasetType") != "derivative" or not description["GeneratedBy"][0].get("Name"):
        faults.append("dataset_description: a derivative names what generated it")
    link = root / description["DatasetLinks"]["raw"]
    if link.resolve() != raw.resolve():
        faults.append(f"DatasetLinks: {link} is not the raw dataset")
    ignored = [line.strip("/") for line in (root / ".bidsignore").read_text().split()]
    for path in sorted(root.rglob("*")):
        relative = path.relative_to(root)
        if path.is_dir() or relative.parts[0] in ignored:
            continue
        if len(relative.parts) == 1:
            if path.name not in ("dataset_description.json", "README.md", ".bidsignore"):
                faults.append(f"{path.name} has no place at the root")
            continue
        faults += name_faults(path)
        if path.name.endswith(".nii.gz") and not path.with_name(path.name[:-7] + ".json").exists():
            faults.append(f"{path.name}: no sidecar")
        if path.suffix == ".json":
            sidecar = json.loads(path.read_text())
            for source in sidecar["Sources"] + [sidecar["SpatialReference"]]:
                kind, name, place = source.split(":")
                if (kind, name) != ("bids", "raw") or not (raw / place).is_file():
                    faults.append(f"{path.name}: source {source}")
            if path.name.endswith("_mask.json") and sidecar.get("Type") not in ("Brain", "Lesion", "Face", "ROI"):
                faults.append(f"{path.name}: Type")
    return faults


def main(program):
    problems = []
    with tempfile.TemporaryDirectory() as name:
        raw = pathlib.Path(name) / "study"
        out = raw / "derivatives" / "pellicle"
        run = lambda *words: subprocess.run([program, *map(str, words)], capture_output=True, text=True)
        images = ["sub-01/anat/sub-01_T1w.nii.gz", "sub-02/ses-a/anat/sub-02_ses-a_run-1_T1w.nii.gz",
                  "sub-02/ses-b/anat/sub-02_ses-b_run-1_T1w.nii.gz"]
        for i, image in enumerate(images):
            path = raw / image
            run("phantom", "-o", path.parent, "--name", "ball", "--size", "24", "--radius", "6", "--snr", "9", "--seed", i)
            for file in path.parent.glob("ball*"):
                file.rename(path) if file.name == "ball.nii.gz" else file.unlink()
        (raw / "dataset_description.json").write_text('{"Name": "balls", "BIDSVersion": "1.9.0"}')
        broken = raw / "sub-03" / "anat" / "sub-03_T1w.nii.gz"
        broken.parent.mkdir(parents=True)
        broken.write_text("no volume")
        flags = ["--preset", "bright", "--detail", "0", "--seed-sphere", "0,0,0,4", "--write", "mask,model,report"]

        one = run("bids", raw, out, "participant", "--participant-label", "sub-02", *flags)
        if one.returncode not in (0, 3) or one.stdout.count("\n") != 2:
            problems.append(f"one participant: {one.returncode} {one.stdout} {one.stderr}")
        every = run("bids", raw, out, "participant", *flags)
        if every.returncode != 1 or "sub-03_T1w n/a failed" not in every.stdout or every.stdout.count("\n") != 2:
            problems.append(f"all participants, of which one was done: {every.returncode} {every.stdout} {every.stderr}")
        masks = {str(path.relative_to(out)) for path in out.glob("sub-*/**/*_mask.nii.gz")}
        wanted = {image.replace("_T1w", "_space-orig_desc-brain_mask") for image in images}
        if masks != wanted:
            problems.append(f"masks: {masks}")
        problems += dataset_faults(out, raw)
        for image in images:
            stem = pathlib.Path(image).name[:-7]
            mask = out / image.replace("_T1w", "_space-orig_desc-brain_mask")
            if mask.read_bytes() != (out / "pellicle" / stem / f"{stem}_mask.nii.gz").read_bytes():
                problems.append(f"{stem}: other mask")

        many = run("bids", raw, out, "participant", "--participant_label", "01", "--desc", "balls", "--preset", "nuclei",
                   "--overwrite")
        table = out / "sub-01/anat/sub-01_space-orig_desc-balls_dseg.tsv"
        if many.returncode not in (0, 3) or not table.read_text().startswith("index\t"):
            problems.append(f"many: {many.returncode} {many.stderr}")
        problems += dataset_faults(out, raw)
        group = run("bids", raw, out, "group")
        page = out / "pellicle" / "report.html"
        if group.returncode != 0 or "sub-02_ses-b_run-1_T1w" not in page.read_text():
            problems.append(f"group: {group.returncode} {group.stderr}")

        wrong = [(66, ("bids", raw, out, "participant", "--participant-label", "99")), (64, ("bids", raw, raw, "participant")),
                 (66, ("bids", raw / "nowhere", out, "participant")), (64, ("bids", raw, out, "session")),
                 (66, ("bids", raw, out, "participant", "--suffix", "T2w")), (64, ("bids", raw, out, "participant", "--desc", "a_b")),
                 (64, ("bids", raw, out, "participant", "--write", "mesh")), (66, ("bids", raw, raw / "none", "group"))]
        other = pathlib.Path(name) / "other"
        other.mkdir()
        (other / "dataset_description.json").write_text('{"Name": "x", "GeneratedBy": [{"Name": "y"}]}')
        wrong.append((73, ("bids", raw, other, "participant")))
        for code, words in wrong:
            result = run(*words)
            if result.returncode != code or result.stderr.count("\n") != 1 or result.stdout:
                problems.append(f"{words}: {result.returncode} {result.stderr}")
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
