"""Plays 3D Slicer: reads the module's description and runs it as Slicer's host does.

Usage: play_slicer.py PELLICLE MODULE
The command line and the reading of progress follow Slicer, Base/QTCLI/vtkSlicerCLIModuleLogic.cxx (ApplyTask): every
number and choice is handed over, empty texts are not, points as x,y,z once for each; after the run the tags of
progress are taken off stdout one kind after the other.
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ElementTree

from description_rules import description_faults, text


def say(problems, message, good):
    if not good:
        problems.append(message)


def command_line(xml, values):
    """What Slicer's host would type; `values` are what a person chose, by name."""
    words = []
    for node in ElementTree.fromstring(xml).iter():
        name = text(node, "name")
        if not name:
            continue
        flag, value = "--" + text(node, "longflag"), values.get(name, text(node, "default"))
        if node.tag == "boolean":
            words += [flag] if value == "true" else []
        elif node.tag == "point":
            for point in values.get(name, []):
                words += [flag, point]
        elif node.tag.endswith(("-enumeration", "integer", "double", "float")):
            words += [flag, value]
        elif value:
            words += [flag, value]
    return words


def without_progress(out):
    for tag in ("progress", "stage-progress", "name", "comment", "time", "start", "end"):
        out = re.sub(rf"<filter-{tag}>[^<]*</filter-{tag}>[ \t\n\r]*", "", out)
    return out


def broken(xml):
    """The same description with one rule broken each: the rules must see it."""
    yield xml.replace("<longflag>seed_radius", "<longflag>seed-radius")
    yield xml.replace('coordinateSystem="lps"', 'coordinateSystem="LPS"')
    yield xml.replace('type="label"', 'type="labels"', 1)
    yield xml.replace("<channel>output</channel>", "", 1)
    yield xml.replace("<category>", "<kind>").replace("</category>", "</kind>")
    yield xml.replace("</executable>", "")


def main(program, module):
    problems = []
    environment = dict(os.environ, PELLICLE_PROGRAM=program, LD_LIBRARY_PATH="/nowhere")
    run = lambda words, **more: subprocess.run(words, capture_output=True, text=True, env=environment, **more)
    described = run([module, "--xml"])
    say(problems, f"--xml: {described.returncode} {described.stderr}", described.returncode == 0 and not described.stderr)
    xml = described.stdout
    problems += description_faults(xml)
    for wrong in broken(xml):
        say(problems, "a broken description was not noticed", wrong != xml and description_faults(wrong))
    groups = ElementTree.fromstring(xml).findall("parameters")
    say(problems, "the first group is for everybody, the others are advanced",
        [g.get("advanced") for g in groups] == [None] + ["true"] * (len(groups) - 1) and len(groups) >= 4)
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        run([program, "phantom", "-o", name, "--name", "ball", "--size", "32", "--radius", "9", "--center", "-2,1,0"],
            check=True)
        mask, mesh = folder / "mask.nii.gz", folder / "mesh.vtp"
        values = {"input": str(folder / "ball.nii.gz"), "output_mask": str(mask), "output_mesh": str(mesh),
                  "seed_point": ["-2,1,0"], "seed_radius": "6", "detail": "1", "polarity": "bright",
                  "energy": "bending=0.2,edge=1"}
        for node in ElementTree.fromstring(xml).iter():  # a name that is gone would test nothing
            values.get(text(node, "name")) is None or values.setdefault("seen", set()).add(text(node, "name"))
        say(problems, f"parameters are missing: {values['seen']}", len(values["seen"]) == len(values) - 1)
        words = command_line(xml, values)
        result = run([module, "--returnparameterfile", str(folder / "r.params")] + words)
        say(problems, f"run: {result.returncode} {result.stderr}", result.returncode == 0 and not result.stderr)
        shares = [float(s) for s in re.findall("<filter-progress>([^<]*)</filter-progress>", result.stdout)]
        say(problems, f"progress: {shares}", len(shares) > 3 and shares == sorted(shares) and shares[-1] == 1.0)
        say(problems, "begin and end", result.stdout.startswith("<filter-start>") and "<filter-end>" in result.stdout)
        say(problems, f"what is left of stdout: {result.stdout}",
            re.fullmatch(r"1 [0-9.]+ ok [0-9.]+\n", without_progress(result.stdout)))
        say(problems, f"files: {sorted(os.listdir(name))}",
            {p.name for p in folder.iterdir()} == {"ball.nii.gz", "ball_truth.nii.gz", "ball_truth.ply",
                                                   "ball_truth.json", "mask.nii.gz", "mesh.vtp"})
        for file in (mask, mesh):
            scores = run([program, "evaluate", str(folder / "ball_truth.json"), str(file)])
            dice = re.search(r"dice\D*([0-9.]+)", scores.stdout)
            say(problems, f"{file.name}: {scores.stdout}{scores.stderr}", dice and float(dice.group(1)) > 0.95)
        # Nothing chosen but files: found without a seed. Files of an earlier run are replaced.
        words = command_line(xml, {k: values[k] for k in ("input", "output_mask", "detail")})
        again = run([module, "--processinformationaddress", "0x7f00"] + words)
        say(problems, f"again: {again.returncode} {again.stderr}", again.returncode == 0)
        # A fit that fails its checks still gives its files, with a warning: Slicer loads them after code 0 only.
        words = command_line(xml, dict(values, seed_point=["-13,-13,-13"], seed_radius="1", detail="0"))
        poor, direct = run([module] + words), run([program, "segment", "--overwrite"] + words)
        say(problems, f"poor: {poor.returncode} {direct.returncode} {poor.stderr}",
            direct.returncode == 3 and poor.returncode == 0 and "warning" in poor.stderr)
        lost = run([module] + command_line(xml, dict(values, input=str(folder / "no.nrrd"))))
        say(problems, f"lost: {lost.returncode}", lost.returncode == 66 and lost.stdout.rstrip().endswith("</filter-end>"))
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
