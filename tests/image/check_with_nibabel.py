#!/usr/bin/env python3
"""Reads written volumes back with nibabel. Manifest lines (tab-separated): `frame WRITTEN ORIGINAL`: size, affine,
qform, sform, codes, pixdim and unit are the same bits; `affine WRITTEN NUMBERS`: the affine is those 12 RAS numbers."""
import logging
import sys

import nibabel as nib
import numpy as np

logging.disable(logging.CRITICAL)  # nibabel tells of the oddities that the originals were made for


def load(path):
    """nibabel goes by the name; a file that is not what its name says is read by content."""
    try:
        return nib.load(path)
    except nib.filebasedimages.ImageFileError:
        import gzip
        raw = open(path, "rb").read()
        return nib.Nifti1Image.from_bytes(gzip.decompress(raw) if raw[:2] == b"\x1f\x8b" else raw)


def frame_faults(written, original):
    faults = []
    if written.shape != original.shape[:3]:
        faults.append(f"shape {written.shape}, not {original.shape}")
    a, b = written.header, original.header
    for field in ("qform_code", "sform_code", "quatern_b", "quatern_c", "quatern_d", "qoffset_x", "qoffset_y", "qoffset_z", "srow_x", "srow_y", "srow_z"):
        if not np.array_equal(a[field], b[field], equal_nan=True):
            faults.append(f"{field} {a[field]}, not {b[field]}")
    if not np.array_equal(a["pixdim"][:4], b["pixdim"][:4], equal_nan=True):
        faults.append(f"pixdim {a['pixdim'][:4]}, not {b['pixdim'][:4]}")
    if int(a["xyzt_units"]) & 7 != int(b["xyzt_units"]) & 7:
        faults.append("unit")
    if not np.array_equal(written.affine, original.affine):
        faults.append("affine")
    return faults


def main():
    failures = 0
    for line in open(sys.argv[1]):
        kind, path, other = line.rstrip("\n").split("\t")
        written = nib.load(path)
        faults = []
        if f"_{written.get_data_dtype()}." not in path and "oblique" not in path:
            faults.append(f"type {written.get_data_dtype()}")
        if kind == "frame":
            faults += frame_faults(written, load(other))
        else:
            expected = np.array([float(x) for x in other.split()]).reshape(3, 4)
            for name, affine in (("sform", written.get_sform()), ("qform", written.get_qform())):
                if not np.allclose(affine[:3], expected, rtol=0, atol=2e-6 * np.abs(expected).max()):
                    faults.append(f"{name} {affine[:3].tolist()}, not {expected.tolist()}")
        np.asarray(written.dataobj)
        if faults:
            failures += 1
            print(f"{path} ({other}): {'; '.join(faults)}", file=sys.stderr)
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
