"""Reads what `pellicle segment` wrote with nibabel, and checks the report against its schema.

Usage: check_outputs.py INPUT.nii.gz FOLDER STEM SCHEMA.json
"""
import hashlib
import json
import re
import sys

import nibabel
import numpy

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "null": type(None)}


def is_type(value, name):
    if name == "number":
        return isinstance(value, (int, float)) and not isinstance(value, bool)
    if name == "integer":
        return isinstance(value, int) and not isinstance(value, bool)
    return isinstance(value, TYPES[name])


def faults(value, schema, where="report"):
    """The part of JSON Schema draft 7 that the schema uses; an unknown keyword is a fault, so that none is passed over."""
    found = []
    known = {"$schema", "title", "description", "type", "enum", "const", "pattern", "minimum", "maximum", "minItems",
             "maxItems", "items", "properties", "required", "additionalProperties"}
    found += [f"{where}: keyword {key} is not checked" for key in schema.keys() - known]
    if "type" in schema:
        names = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
        if not any(is_type(value, name) for name in names):
            return found + [f"{where}: {value!r} is no {names}"]
    if "enum" in schema and value not in schema["enum"]:
        found.append(f"{where}: {value!r} is none of {schema['enum']}")
    if "const" in schema and value != schema["const"]:
        found.append(f"{where}: {value!r} is not {schema['const']!r}")
    if "pattern" in schema and isinstance(value, str) and not re.search(schema["pattern"], value):
        found.append(f"{where}: {value!r} does not match")
    if "minimum" in schema and is_type(value, "number") and not value >= schema["minimum"]:
        found.append(f"{where}: {value} is too small")
    if "maximum" in schema and is_type(value, "number") and not value <= schema["maximum"]:
        found.append(f"{where}: {value} is too large")
    if isinstance(value, list):
        if not schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value)):
            found.append(f"{where}: {len(value)} items")
        for i, item in enumerate(value):
            found += faults(item, schema.get("items", {}), f"{where}[{i}]")
    if isinstance(value, dict):
        properties = schema.get("properties", {})
        found += [f"{where}: {key} is missing" for key in schema.get("required", []) if key not in value]
        for key, item in value.items():
            rest = schema.get("additionalProperties", {})
            if key not in properties and rest is False:
                found.append(f"{where}: {key} is not in the schema")
            else:
                found += faults(item, properties.get(key, rest if isinstance(rest, dict) else {}), f"{where}.{key}")
    return found


def main(source, folder, stem, schema):
    volume = nibabel.load(source)
    report = json.load(open(f"{folder}/{stem}_report.json"))
    problems = faults(report, json.load(open(schema)))
    maps = {}
    for kind, dtype in (("mask", "uint8"), ("sdf", "float32"), ("prob", "float32")):
        image = nibabel.load(f"{folder}/{stem}_{kind}.nii.gz")
        maps[kind] = numpy.asanyarray(image.dataobj)
        for key in ("sform_code", "qform_code", "pixdim", "srow_x", "srow_y", "srow_z", "quatern_b", "quatern_c",
                    "quatern_d", "qoffset_x", "qoffset_y", "qoffset_z"):
            if not numpy.array_equal(image.header[key], volume.header[key]):
                problems.append(f"{kind}: {key} differs from the input's")
        if image.shape != volume.shape or image.get_data_dtype() != numpy.dtype(dtype):
            problems.append(f"{kind}: {image.shape} {image.get_data_dtype()}")
    inside = maps["mask"] > 0
    if not numpy.array_equal(numpy.unique(maps["mask"]), [0, 1]):
        problems.append("mask: values are not 0 and 1")
    if not (maps["sdf"][inside].max() <= 1e-3 and maps["sdf"][~inside].min() >= -1e-3):
        problems.append("sdf: the sign disagrees with the mask")
    if not (maps["prob"].min() >= 0 and maps["prob"].max() <= 1 and maps["prob"][inside].mean() > 0.8):
        problems.append("prob: out of range")
    voxel_ml = abs(numpy.linalg.det(volume.affine[:3, :3])) / 1000
    volumes = report["objects"][0]["volume_ml"]
    if abs(inside.sum() * voxel_ml / volumes["mask"] - 1) > 1e-6:
        problems.append("report: mask volume differs from the mask's")
    if abs(volumes["partial_volume"] / volumes["surface"] - 1) > 0.005:
        problems.append("report: partial volume and surface disagree")
    for entry in report["inputs"] + report["outputs"]:
        if hashlib.sha256(open(entry["path"], "rb").read()).hexdigest() != entry["sha256"]:
            problems.append(f"report: wrong hash of {entry['path']}")
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
