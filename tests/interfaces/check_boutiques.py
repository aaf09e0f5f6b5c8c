"""The Boutiques descriptor by the rules of its schema, and a run by what it says.

Usage: check_boutiques.py PELLICLE
The rules are those of boutiques/schema/descriptor.schema.json (schema version 0.5), written down anew: required and
known keys, identifiers, what goes with what. The run substitutes value keys as Boutiques does.
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

IDENTIFIER = re.compile(r"[0-9A-Za-z_]+\Z")
TOP_REQUIRED = {"name", "description", "command-line", "schema-version", "inputs", "tool-version"}
TOP = TOP_REQUIRED | {"author", "url", "descriptor-url", "doi", "shell", "container-image", "environment-variables",
                      "groups", "tests", "online-platform-urls", "output-files", "invocation-schema",
                      "suggested-resources", "tags", "error-codes", "custom", "deprecated-by-doi", "tool-doi"}
INPUT = {"id", "name", "type", "description", "value-key", "list", "list-separator", "optional", "command-line-flag",
         "requires-inputs", "disables-inputs", "command-line-flag-separator", "default-value", "value-choices",
         "value-requires", "value-disables", "integer", "minimum", "maximum", "exclusive-minimum", "exclusive-maximum",
         "min-list-entries", "max-list-entries", "uses-absolute-path"}
OUTPUT = {"id", "name", "description", "value-key", "path-template", "conditional-path-template",
          "path-template-stripped-extensions", "list", "optional", "command-line-flag", "command-line-flag-separator",
          "uses-absolute-path", "file-template"}
NEEDS = {"command-line-flag-separator": "command-line-flag", "list-separator": "list", "min-list-entries": "list"}
ONLY = {"integer": {"Number"}, "minimum": {"Number"}, "maximum": {"Number"}, "value-choices": {"String", "Number"},
        "uses-absolute-path": {"File"}}


def entry_faults(entry, known, where):
    faults = [f"{where}: unknown key {key}" for key in entry.keys() - known]
    faults += [f"{where}: {key} is missing" for key in ("id", "name") if not entry.get(key)]
    if not IDENTIFIER.match(entry.get("id", "")):
        faults.append(f"{where}: bad id")
    return faults + [f"{where}: {key} needs {other}" for key, other in NEEDS.items() if key in entry and other not in entry]


def descriptor_faults(tool):
    faults = [f"{key} is missing" for key in TOP_REQUIRED - tool.keys()]
    faults += [f"unknown key {key}" for key in tool.keys() - TOP]
    if tool.get("schema-version") != "0.5":
        faults.append("schema-version is not 0.5")
    for text in ("name", "description", "command-line", "tool-version", "author"):
        if not (isinstance(tool.get(text), str) and tool[text]):
            faults.append(f"{text} is no text")
    ids, keys = [], []
    for entry in tool["inputs"]:
        where = f"input {entry.get('id')}"
        faults += entry_faults(entry, INPUT, where)
        if entry.get("type") not in ("String", "File", "Flag", "Number"):
            faults.append(f"{where}: type {entry.get('type')}")
        if entry.get("type") == "Flag" and (entry.get("list") or "command-line-flag" not in entry):
            faults.append(f"{where}: a Flag needs a flag and is no list")
        faults += [f"{where}: {key} is not for {entry['type']}" for key, types in ONLY.items()
                   if key in entry and entry["type"] not in types]
        keys.append(entry.get("value-key", ""))
        if tool["command-line"].count(keys[-1]) != 1:
            faults.append(f"{where}: {keys[-1]} is not once in the command line")
        ids.append(entry["id"])
    for entry in tool.get("output-files", []):
        faults += entry_faults(entry, OUTPUT, f"output {entry.get('id')}")
        if ("path-template" in entry) == ("conditional-path-template" in entry):
            faults.append(f"output {entry.get('id')}: one kind of path is needed")
        ids.append(entry["id"])
        for key in re.findall(r"\[[A-Z_]+\]", entry.get("path-template", "")):
            if key not in keys:
                faults.append(f"output {entry['id']}: {key} is no input")
    for group in tool.get("groups", []):
        faults += entry_faults(group, {"id", "name", "description", "members", "mutually-exclusive", "one-is-required",
                                       "all-or-none"}, f"group {group.get('id')}")
        faults += [f"group {group['id']}: {member} is no input" for member in group["members"] if member not in ids]
        if not group["members"]:
            faults.append(f"group {group['id']} is empty")
    for code in tool.get("error-codes", []):
        if set(code) != {"code", "description"} or not isinstance(code["code"], int):
            faults.append(f"error code {code}")
    return faults + [f"{one}: given twice" for one in set(ids) if ids.count(one) > 1]


def command_of(tool, values):
    line = tool["command-line"]
    for entry in tool["inputs"]:
        value, words = values.get(entry["id"]), ""
        if value is None and not entry.get("optional"):
            raise ValueError(f"{entry['id']} is required")
        if value is not None:
            flag, separator = entry["command-line-flag"], entry.get("command-line-flag-separator", " ")
            listed = [str(v) for v in value] if entry.get("list") else [str(value)]
            words = flag if entry["type"] == "Flag" else flag + separator + entry.get("list-separator", " ").join(listed)
        line = line.replace(entry["value-key"], words)
    return line


def main(program):
    problems = []
    said = subprocess.run([program, "segment", "--boutiques"], capture_output=True, text=True, check=True)
    tool = json.loads(said.stdout)
    problems += descriptor_faults(tool)
    for breaking in (lambda t: t.pop("inputs") and t.update(inputs=[]) or t.pop("tool-version"),
                     lambda t: t["inputs"][0].update(id="a-b"), lambda t: t["inputs"][0].update(kind="x"),
                     lambda t: t["inputs"][0].update(type="Path"), lambda t: t["output-files"][0].pop("path-template"),
                     lambda t: t["groups"][0]["members"].append("nobody")):
        wrong = json.loads(said.stdout)
        breaking(wrong)
        if not descriptor_faults(wrong):
            problems.append("a broken descriptor was not noticed")
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([program, "phantom", "-o", folder, "--name", "ball", "--size", "28", "--radius", "7", "--center",
                        "-2,1,0"], capture_output=True, check=True)
        values = {"input": f"{folder}/ball.nii.gz", "output": f"{folder}/out", "name": "it", "detail": 0,
                  "seed_sphere": ["-2,1,0,4"], "energy": ["bending=0.5", "edge=1"], "polarity": "bright",
                  "overwrite": True, "similarity": "false"}
        line = command_of(tool, values)
        for key in ("--energy=bending=0.5 --energy=edge=1", "--overwrite", "--similarity=false"):
            if key not in line:
                problems.append(f"{key} is not in: {line}")
        environment = dict(os.environ, PATH=f"{pathlib.Path(program).parent}:{os.environ['PATH']}")
        run = subprocess.run(line, shell=True, env=environment, capture_output=True, text=True)
        if run.returncode != 0:
            problems.append(f"run: {run.returncode} {run.stderr} of {line}")
        wanted = {"mask_file": 1, "mesh_files": 1, "model_files": 1, "report_file": 1, "label_map_file": 0, "picture_file": 0}
        for entry in tool["output-files"]:
            pattern = entry["path-template"].replace("[OUTPUT]", "out").replace("[NAME]", "it")
            found = len(list(pathlib.Path(folder).glob(pattern)))
            if found != wanted.pop(entry["id"], found):
                problems.append(f"{entry['id']}: {found} files {pattern}")
        problems += [f"output {one} is missing" for one in wanted]
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
