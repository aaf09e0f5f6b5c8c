#!/usr/bin/env python3
"""Makes the files of this folder: tiny volumes, odd and broken ones, with the outcome that each must have.

Run it here: /usr/bin/python3 make_corpus.py (needs python3-nibabel and python3-numpy). Every volume is 5x4x3 voxels of
value 1 + i + 10 j + 20 k unless its name says otherwise. expected.csv: file, exit code, text in the message
(errors) or in one of the warnings (exit code 0; empty when there must be none).
"""
import csv
import gzip
import os
import shutil
import struct
import zlib

import nibabel as nib
import numpy as np

EXPECTED = []
I, J, K = np.mgrid[0:5, 0:4, 0:3]
VALUES = 1 + I + 10 * J + 20 * K
RAS = np.array([[-0.5, 0, 0, 12.0], [0, 0.75, 0, -7.0], [0, 0, 2.0, 3.0], [0, 0, 0, 1]])  # x runs left, determinant < 0


def expect(name, code, text=""):
    EXPECTED.append((name, code, text))
    return name


def pack(name, data):
    """gzip without time and name, so that a rerun gives the same bytes."""
    with open(name, "wb") as out:
        out.write(gzip.compress(data, mtime=0))


def nifti(name, code, text="", data=VALUES, dtype=np.int16, affine=RAS, order="<", cls=nib.Nifti1Image, edit=None, raw_edit=None):
    header = cls.header_class(endianness=order)
    header.set_data_dtype(np.dtype(dtype).newbyteorder(order))
    image = cls(np.asarray(data).astype(dtype), affine, header)
    image.set_qform(affine, 1)
    if edit:
        edit(image)
    raw = bytearray(image.to_bytes())
    if raw_edit:
        raw = raw_edit(raw)
    expect(name, code, text)
    pack(name, bytes(raw)) if name.endswith(".gz") else open(name, "wb").write(bytes(raw))


def make_nifti():
    for dtype in "u1 i1 u2 i2 u4 i4 u8 i8 f4 f8".split():
        for order, end in (("<", "le"), (">", "be")):
            nifti(f"dtype_{dtype}_{end}.nii.gz", 0, dtype=dtype, order=order)
    nifti("nifti2.nii.gz", 0, cls=nib.Nifti2Image)
    nifti("one_volume_4d.nii.gz", 0, data=VALUES[..., None])
    nifti("two_volumes_4d.nii.gz", 65, "4D", data=np.stack([VALUES, VALUES], 3))
    nifti("slice_2d.nii.gz", 65, "2D", data=VALUES[:, :, 0])
    nifti("single_slice.nii.gz", 65, "2D", data=VALUES[:, :, :1])
    nifti("one_voxel.nii.gz", 65, "one voxel", data=VALUES[:1, :1, :1])
    nifti("complex.nii.gz", 65, "complex", dtype=np.complex64)
    nifti("float128.nii.gz", 65, "not supported", dtype=np.float32, raw_edit=lambda r: r[:70] + struct.pack("<hh", 1536, 128) + r[74:])
    rgb = np.zeros((5, 4, 3), dtype=[("R", "u1"), ("G", "u1"), ("B", "u1")])
    expect("rgb.nii.gz", 65, "RGB")
    pack("rgb.nii.gz", nib.Nifti1Image(rgb, RAS).to_bytes())

    nan = VALUES.astype(np.float32)
    nan[0, 0, 0], nan[1, 0, 0], nan[2, 0, 0] = np.nan, np.inf, -np.inf
    nifti("nan_inf.nii.gz", 0, "1 voxels are NaN and 2 infinite", data=nan, dtype=np.float32)
    nifti("all_nan.nii.gz", 65, "no voxel has a finite value", data=nan * np.nan, dtype=np.float32)
    nifti("constant.nii.gz", 0, data=0 * VALUES + 7)

    def units(code):
        return lambda image: image.header.__setitem__("xyzt_units", code)

    nifti("unit_micron.nii.gz", 0, affine=np.diag([1000, 1000, 1000, 1]) @ RAS, edit=units(3))
    nifti("unit_metre.nii.gz", 0, affine=np.diag([0.001, 0.001, 0.001, 1]) @ RAS, edit=units(1))
    nifti("scaled.nii.gz", 0, data=VALUES - 1, edit=lambda im: im.header.set_slope_inter(1, 1))

    def forms(s, q, s_affine=None, q_affine=None):
        def edit(image):
            image.set_sform(RAS if s_affine is None else s_affine, s)
            image.set_qform(RAS if q_affine is None else q_affine, q)
        return edit

    moved = RAS.copy()
    moved[0, 3] += 5
    skewed = RAS.copy()
    skewed[:3, 1] += 0.005 * 0.75 * np.array([1, 0, 0])  # 0.29 degrees
    sheared = RAS.copy()
    sheared[:3, 1] += 0.3 * 0.75 * np.array([1, 0, 0])
    singular = RAS.copy()
    singular[:3, 2] = 0
    nifti("qform_only.nii.gz", 0, edit=forms(0, 1))
    nifti("sform_only.nii.gz", 0, edit=forms(2, 0))
    nifti("scanner_sform_wins.nii.gz", 0, "the sform is used", edit=forms(1, 1, None, moved))
    nifti("template_sform_yields.nii.gz", 0, "the qform is used", edit=forms(4, 1, moved, None))
    nifti("no_forms.nii.gz", 0, "does not say how it lies", edit=forms(0, 0))
    nifti("slight_skew.nii.gz", 0, "degrees off a right angle", edit=forms(1, 0, skewed))
    nifti("sheared.nii.gz", 65, "sheared", edit=forms(1, 0, sheared))
    nifti("sheared_but_qform.nii.gz", 0, "the qform is used instead", edit=forms(2, 1, sheared))
    nifti("singular.nii.gz", 65, "singular", edit=forms(1, 0, singular))
    nifti("nan_sform.nii.gz", 65, "not finite", edit=forms(1, 0), raw_edit=lambda r: r[:280] + struct.pack("<f", float("nan")) + r[284:])

    nifti("qform_zero_pixdim.nii.gz", 0, "NO SPACING along axis 2", edit=forms(0, 1), raw_edit=lambda r: r[:88] + struct.pack("<f", 0) + r[92:])
    nifti("negative_dim.nii", 65, "impossible size", raw_edit=lambda r: r[:42] + struct.pack("<h", -5) + r[44:])
    nifti("zero_dim.nii", 65, "impossible size", raw_edit=lambda r: r[:46] + struct.pack("<h", 0) + r[48:])
    nifti("huge_dim.nii", 65, "absurd size", raw_edit=lambda r: r[:42] + struct.pack("<3h", 32000, 32000, 32000) + r[48:])
    nifti("large_claim.nii", 65, "truncated", raw_edit=lambda r: r[:42] + struct.pack("<3h", 2000, 2000, 2000) + r[48:])
    nifti("large_claim.nii.gz", 65, "truncated", raw_edit=lambda r: r[:42] + struct.pack("<3h", 2000, 2000, 2000) + r[48:])
    nifti("dimensions_9.nii", 65, "9 dimensions", raw_edit=lambda r: r[:40] + struct.pack("<h", 9) + r[42:])
    nifti("negative_offset.nii", 65, "data offset", raw_edit=lambda r: r[:108] + struct.pack("<f", -1e30) + r[112:])
    nifti("nan_offset.nii", 65, "data offset", raw_edit=lambda r: r[:108] + struct.pack("<f", float("nan")) + r[112:])
    nifti("truncated.nii", 65, "truncated", raw_edit=lambda r: r[:-7])
    nifti("header_cut.nii", 65, "not a NIfTI", raw_edit=lambda r: r[:200])
    nifti("plain_named_gz.nii.gz", 0, "is not gzipped")
    shutil.copy("negative_dim.nii", "plain_named_gz.nii.gz")
    raw = gzip.decompress(open("dtype_i2_le.nii.gz", "rb").read())
    open("plain_named_gz.nii.gz", "wb").write(raw)
    packed = gzip.compress(raw, mtime=0)
    open(expect("truncated.nii.gz", 65, "truncated"), "wb").write(packed[:-40])
    bad = bytearray(packed)
    bad[-6] ^= 0xFF  # the checksum
    open(expect("wrong_checksum.nii.gz", 65, "corrupt"), "wb").write(bad)
    bad = bytearray(packed)
    for at in range(40, 60):
        bad[at] ^= 0x5A
    open(expect("corrupt.nii.gz", 65, "corrupt"), "wb").write(bad)
    open(expect("packed_named_plain.nii", 0), "wb").write(packed)
    open(expect("empty.nii.gz", 65, "empty"), "wb").close()
    open(expect("text.nii", 65, "not a NIfTI"), "w").write("this is no image\n")
    for name in ("pair.hdr", "pair.img"):
        expect(name, 0)
    nib.save(nib.Nifti1Pair(VALUES.astype(np.int16), RAS), "pair.hdr")
    expect("analyze.hdr", 0, "Analyze 7.5")
    nib.save(nib.AnalyzeImage(VALUES.astype(np.int16), np.diag([-0.5, 0.75, 2, 1])), "analyze.hdr")
    expect("lonely.hdr", 65, "lonely.img is missing")
    shutil.copy("pair.hdr", "lonely.hdr")
    open(expect("brain.mgz", 65, "NIfTI (.nii"), "wb").write(b"\0\0\0\1")
    open(expect("brain.mnc", 65, "NIfTI (.nii"), "wb").write(b"CDF\1")


LPS = np.diag([-1, -1, 1, 1]) @ RAS
VOXELS = VALUES.astype("<i2").tobytes(order="F")


def nrrd(name, code, text="", space="space: left-posterior-superior", affine=LPS, sizes="5 4 3", extra="", data=VOXELS, kind="int16", encoding="raw", directions=True):
    vector = lambda v: "(" + ",".join(repr(float(x)) for x in v) + ")"
    lines = ["NRRD0004", f"type: {kind}", f"dimension: {len(sizes.split())}", space, f"sizes: {sizes}"]
    if directions:
        lines += ["space directions: " + " ".join(vector(affine[:3, a]) for a in range(3)), "space origin: " + vector(affine[:3, 3])]
    lines += ["endian: little", f"encoding: {encoding}", extra]
    open(expect(name, code, text), "wb").write(("\n".join(line for line in lines if line) + "\n\n").encode() + data)


def make_nrrd_and_meta():
    nrrd("lps.nrrd", 0)
    nrrd("ras.nrrd", 0, space="space: right-anterior-superior", affine=RAS)
    nrrd("gzip.nrrd", 0, encoding="gzip", data=gzip.compress(VOXELS, mtime=0))
    nrrd("micron.nrrd", 0, affine=np.diag([1000, 1000, 1000, 1]) @ LPS, extra='space units: "um" "um" "um"')
    nrrd("no_space.nrrd", 0, "names no space", space="space dimension: 3")
    nrrd("spacings_only.nrrd", 0, "names no space", space="", directions=False, extra="spacings: 0.5 0.75 2")
    nrrd("no_spacing.nrrd", 0, "NO SPACING", space="", directions=False)
    nrrd("truncated.nrrd", 65, "truncated", data=VOXELS[:-3])
    nrrd("truncated_gzip.nrrd", 65, "truncated", encoding="gzip", data=gzip.compress(VOXELS, mtime=0)[:-30])
    nrrd("huge.nrrd", 65, "absurd size", sizes="900000 900000 900000")
    nrrd("bzip2.nrrd", 65, "bzip2", encoding="bzip2")
    nrrd("two_d.nrrd", 65, "2D", space="", directions=False, sizes="5 12", extra="spacings: 1 1")
    nrrd("no_data.nhdr", 65, "absent.raw is missing", extra="data file: absent.raw")
    open(expect("garbage.nrrd", 65, "damaged"), "wb").write(b"NRRD0004\nnothing of use\n\n")

    def meta(name, code, text="", data=VOXELS, file="LOCAL", extra="", dims="5 4 3", spacing="ElementSpacing = 0.5 0.75 2", kind="MET_SHORT", offset="-12 7 3"):
        header = f"ObjectType = Image\nNDims = {len(dims.split())}\nBinaryData = True\nBinaryDataByteOrderMSB = False\n{extra}"
        header += f"TransformMatrix = 1 0 0 0 -1 0 0 0 1\nOffset = {offset}\n{spacing}\nDimSize = {dims}\nElementType = {kind}\nElementDataFile = {file}\n"
        open(expect(name, code, text), "wb").write(header.encode() + (data if file == "LOCAL" else b""))

    meta("meta.mha", 0)
    meta("meta.mhd", 0, file="meta.raw")
    open("meta.raw", "wb").write(VOXELS)
    meta("no_spacing.mha", 0, "NO SPACING", spacing="")
    meta("truncated.mha", 65, "truncated", data=VOXELS[:-3])
    packed = zlib.compress(VOXELS)
    meta("compressed.mha", 0, data=packed, extra=f"CompressedData = True\nCompressedDataSize = {len(packed)}\n")
    meta("truncated_compressed.mha", 65, "truncated", data=packed[:-30], extra=f"CompressedData = True\nCompressedDataSize = {len(packed)}\n")
    meta("micron.mha", 0, extra="DistanceUnits = um\n", spacing="ElementSpacing = 500 750 2000", offset="-12000 7000 3000")
    meta("huge.mha", 65, "absurd size", dims="900000 900000 900000")
    meta("rgb.mha", 65, "3 values per voxel", extra="ElementNumberOfChannels = 3\n", data=VOXELS * 3, kind="MET_UCHAR")
    meta("no_data.mhd", 65, "absent.raw is missing", file="absent.raw")
    open(expect("garbage.mha", 65, "not a MetaImage"), "wb").write(b"nothing of use\n")


def tiff_pages(pages, description="", resolution=None, photometric=1, samples=1, tile=None):
    """A little-endian TIFF, one strip or tile a page."""
    out = bytearray(b"II*\0\0\0\0\0")
    link = 4
    for index, page in enumerate(pages):
        height, width = page.shape[0], page.shape[1]
        blob = page.astype(page.dtype.newbyteorder("<")).tobytes()
        if tile:
            padded = np.zeros((tile, tile), page.dtype)
            padded[:height, :width] = page
            blob = padded.tobytes()
        bits, form = page.dtype.itemsize * 8, {"u": 1, "i": 2, "f": 3}[page.dtype.kind]
        at = len(out)
        out += blob + b"\0" * (len(blob) % 2)
        tags = [(256, 4, width), (257, 4, height), (258, 3, bits), (259, 3, 1), (262, 3, photometric), (277, 3, samples), (339, 3, form)]
        tags += [(322, 4, tile), (323, 4, tile), (324, 4, at), (325, 4, len(blob))] if tile else [(273, 4, at), (278, 4, height), (279, 4, len(blob))]
        if index == 0 and description:
            text = description.encode() + b"\0"
            text += b"\0" * (len(text) % 2) + b"\0\0\0\0"
            tags.append((270, 2, (len(text), len(out))))
            out += text
        if resolution:
            for tag, value in zip((282, 283), resolution):
                tags.append((tag, 5, (1, len(out))))
                parts = 10**9 if value < 4 else 10**6
                out += struct.pack("<II", round(value * parts), parts)
        out[link:link + 4] = struct.pack("<I", len(out))
        out += struct.pack("<H", len(tags))
        for tag, kind, value in sorted(tags):
            count, content = value if isinstance(value, tuple) else (1, value)
            out += struct.pack("<HHI", tag, kind, count) + (struct.pack("<HH", content, 0) if kind == 3 else struct.pack("<I", content))
        link = len(out)
        out += struct.pack("<I", 0)
    return bytes(out)


def make_tiff():
    def stack(dtype):
        return [VALUES[:, :, k].T.astype(dtype) for k in range(3)]

    def tiff(name, code, text="", pages=None, **options):
        open(expect(name, code, text), "wb").write(tiff_pages(stack("u2") if pages is None else pages, **options))

    imagej = "ImageJ=1.53\nimages=3\nslices=3\nunit={}\nspacing={}\nloop=false\n"
    ome = '<?xml version="1.0"?><OME><Image><Pixels SizeX="5" SizeY="4" SizeZ="3" SizeC="{}" SizeT="1" Type="uint16" {}/></Image></OME>'
    tiff("imagej.tif", 0, description=imagej.format("mm", 2.0), resolution=(2, 1 / 0.75))
    tiff("imagej_micron.tif", 0, description=imagej.format("micron", 2000.0), resolution=(0.002, 1 / 750))
    tiff("imagej_no_unit.tif", 0, "NO SPACING unit", description="ImageJ=1.53\nimages=3\nslices=3\nspacing=2.0\n")
    tiff("imagej_no_z.tif", 0, "NO SPACING between slices", description="ImageJ=1.53\nimages=3\nslices=3\nunit=mm\n", resolution=(2, 1 / 0.75))
    tiff("imagej_frames.tif", 65, "4D", description="ImageJ=1.53\nimages=3\nframes=3\n")
    tiff("imagej_missing_pages.tif", 65, "the file has 2 pages", pages=stack("u2")[:2], description=imagej.format("mm", 2.0))
    tiff("ome.tif", 0, description=ome.format(1, 'PhysicalSizeX="500" PhysicalSizeY="0.75" PhysicalSizeYUnit="mm" PhysicalSizeZ="2000" PhysicalSizeZUnit="&#181;m"'))
    tiff("ome_no_z.tif", 0, "NO SPACING along z", description=ome.format(1, 'PhysicalSizeX="500" PhysicalSizeY="750"'))
    tiff("ome_channels.tif", 65, "4D", description=ome.format(3, ""))
    tiff("plain.tif", 0, "NO SPACING", resolution=(72, 72))
    for dtype in "u1 i1 i2 u4 i4 f4 f8".split():
        tiff(f"plain_{dtype}.tif", 0, "NO SPACING", pages=stack(dtype))
    tiff("tiled.tif", 0, "NO SPACING", tile=16)
    tiff("single_page.tif", 65, "single page", pages=stack("u2")[:1])
    tiff("uneven_pages.tif", 65, "page 2", pages=[stack("u2")[0], stack("u2")[1][:3], stack("u2")[2]])
    tiff("rgb.tif", 65, "RGB", pages=[np.repeat(p[:, :, None], 3, 2).astype("u1") for p in stack("u1")], photometric=2, samples=3)
    whole = tiff_pages(stack("u2"))
    open(expect("truncated.tif", 65, "truncated"), "wb").write(whole[:-60])
    open(expect("garbage.tif", 65, "TIFF"), "wb").write(b"not a tiff at all")


def dicom(name, position, k, series="1.2.3.1", orientation="1\\0\\0\\0\\1\\0", spacing="0.75\\0.5", extra=(), slope="1", rows=4, samples=1):
    """One slice, explicit VR little endian. Pixels are VALUES[:, :, k]."""
    def element(group, number, vr, value):
        value = value.encode() if isinstance(value, str) else value
        if len(value) % 2:
            value += b"\0" if vr in (b"UI", b"OW") else b" "
        head = struct.pack("<HH", group, number) + vr
        return head + (b"\0\0" + struct.pack("<I", len(value)) if vr == b"OW" else struct.pack("<H", len(value))) + value

    short = lambda value: struct.pack("<H", value)
    object_class = "1.2.840.10008.5.1.4.1.1.4"
    meta = element(2, 0x01, b"OW", b"\0\1") + element(2, 0x02, b"UI", object_class) + element(2, 0x03, b"UI", f"{series}.{k + 1}")
    meta += element(2, 0x10, b"UI", "1.2.840.10008.1.2.1")
    pixels = VALUES[:, :rows, k % 3].T.astype("<i2").tobytes() * samples
    data = dict([
        ((0x0008, 0x0016), (b"UI", object_class)), ((0x0008, 0x0018), (b"UI", f"{series}.{k + 1}")), ((0x0008, 0x0060), (b"CS", "MR")),
        ((0x0020, 0x000d), (b"UI", "1.2.3")), ((0x0020, 0x000e), (b"UI", series)), ((0x0020, 0x0013), (b"IS", str(k + 1))),
        ((0x0020, 0x0032), (b"DS", "\\".join(f"{x:g}" for x in position))), ((0x0020, 0x0037), (b"DS", orientation)),
        ((0x0028, 0x0002), (b"US", short(samples))), ((0x0028, 0x0004), (b"CS", "MONOCHROME2" if samples == 1 else "RGB")),
        ((0x0028, 0x0010), (b"US", short(rows))), ((0x0028, 0x0011), (b"US", short(5))), ((0x0028, 0x0030), (b"DS", spacing)),
        ((0x0028, 0x0100), (b"US", short(16))), ((0x0028, 0x0101), (b"US", short(16))), ((0x0028, 0x0102), (b"US", short(15))),
        ((0x0028, 0x0103), (b"US", short(1))), ((0x0028, 0x1052), (b"DS", "0")), ((0x0028, 0x1053), (b"DS", slope)), ((0x7fe0, 0x0010), (b"OW", pixels))])
    for key, value in dict(extra).items():
        data.pop(key, None)
        if value:
            data[key] = value
    body = b"".join(element(*key, *value) for key, value in sorted(data.items()))
    os.makedirs(os.path.dirname(name), exist_ok=True)
    open(name, "wb").write(b"\0" * 128 + b"DICM" + element(2, 0, b"UL", struct.pack("<I", len(meta))) + meta + body)


def make_dicom():
    def folder(name, code, text, slices):
        expect(name, code, text)
        for n, options in enumerate(slices):
            # Names against the order of the positions: it is the positions that count.
            dicom(f"{name}/{9 - n}.dcm", **options)

    at = lambda z, k, **more: dict(position=(-12, 7, z), k=k, **more)
    even = [at(3, 0), at(5, 1), at(7, 2)]
    folder("dicom_even", 0, "", even)
    folder("dicom_slopes", 0, "", [at(3, 0, slope="2"), at(5, 1, slope="2"), at(7, 2, slope="2")])
    folder("dicom_missing_slice", 65, "1 missing between", even + [at(11, 0)])
    folder("dicom_uneven", 65, "uneven slices", even + [at(9.8, 0), at(11.8, 1)])
    folder("dicom_doubled", 65, "two slices at one position", even + [at(5, 1)])
    folder("dicom_mixed_series", 65, "mixed series", even + [at(9, 0, series="1.2.3.9")])
    folder("dicom_mixed_orientation", 65, "mixed orientations", even[:2] + [at(7, 2, orientation="0\\1\\0\\0\\0\\1")])
    folder("dicom_mixed_size", 65, "mixed sizes", even[:2] + [at(7, 2, rows=3)])
    folder("dicom_tilted", 65, "sheared", [dict(position=(-12, 7 + n, 3 + 2 * n), k=n) for n in range(3)])
    folder("dicom_shifted", 65, "off the line", even[:1] + [dict(position=(-12, 9, 5), k=1)] + even[2:])
    folder("dicom_rgb", 65, "RGB", [at(3 + 2 * n, n, samples=3) for n in range(3)])
    folder("dicom_multiframe", 65, "multi-frame", [at(3, 0, extra={(0x0028, 0x0008): (b"IS", "3")})])
    folder("dicom_no_position", 65, "where it lies", [at(3 + 2 * n, n, extra={(0x0020, 0x0032): None}) for n in range(3)])
    folder("dicom_no_spacing", 0, "NO SPACING", [at(3 + 2 * n, n, extra={(0x0028, 0x0030): None}) for n in range(3)])
    folder("dicom_single", 65, "single slice", even[:1])
    expect("dicom_even/9.dcm", 65, "the folder that holds its series")
    os.makedirs("dicom_none", exist_ok=True)
    open("dicom_none/notes.txt", "w").write("no image here\n")
    expect("dicom_none", 65, "no DICOM file")
    dicom("dicom_truncated/a.dcm", (-12, 7, 3), 0)
    dicom("dicom_truncated/b.dcm", (-12, 7, 5), 1)
    content = open("dicom_truncated/b.dcm", "rb").read()
    open("dicom_truncated/b.dcm", "wb").write(content[:-11])
    expect("dicom_truncated", 65, "truncated DICOM")
    expect("absent.nii", 66, "no such file")


if __name__ == "__main__":
    os.chdir(os.path.dirname(os.path.abspath(__file__)))
    make_nifti()
    make_nrrd_and_meta()
    make_tiff()
    make_dicom()
    with open("expected.csv", "w", newline="") as out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(["file", "exit", "text"])
        writer.writerows(EXPECTED)
