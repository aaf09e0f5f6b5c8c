"""Volumes that `pellicle phantom` does not make, for the commands of the documentation.

make_volume.py tiff IN.nii.gz OUT.tif          the same voxels as a plain stack of 16-bit pages, which knows no spacing
make_volume.py series IN.nii.gz ... OUT.nii.gz   volumes of one kind as the frames of a 4D file
"""
import array
import gzip
import struct
import sys


def voxels(path):
    """Size and 16-bit values (0 to 1000) of a phantom, x fastest."""
    data = gzip.open(path).read()
    size = struct.unpack_from("<3h", data, 42)
    kind = {4: "h", 16: "f", 512: "H"}[struct.unpack_from("<h", data, 70)[0]]
    values = array.array(kind, data[int(struct.unpack_from("<f", data, 108)[0]):])
    low, high = min(values), max(values)
    return size, array.array("H", [round(1000 * (v - low) / (high - low)) for v in values])


def tiff(source, target):
    """Little-endian, uncompressed, one strip a page."""
    (nx, ny, nz), values = voxels(source)
    page, entries = 2 * nx * ny, 10
    directory = 2 + 12 * entries + 4
    with open(target, "wb") as out:
        out.write(struct.pack("<2sHI", b"II", 42, 8))
        for z in range(nz):
            start = 8 + z * (directory + page)
            tags = [(254, 4, 2), (256, 4, nx), (257, 4, ny), (258, 3, 16), (259, 3, 1), (262, 3, 1), (273, 4, start + directory),
                    (277, 3, 1), (278, 4, ny), (279, 4, page)]
            out.write(struct.pack("<H", entries) + b"".join(struct.pack("<HHII", tag, kind, 1, value) for tag, kind, value in tags))
            out.write(struct.pack("<I", 0 if z + 1 == nz else start + directory + page))
            out.write(values[z * nx * ny:(z + 1) * nx * ny].tobytes())


def series(*paths):
    frames = [gzip.open(path).read() for path in paths[:-1]]
    first = int(struct.unpack_from("<f", frames[0], 108)[0])
    head = bytearray(frames[0][:first])
    struct.pack_into("<h", head, 40, 4)
    struct.pack_into("<h", head, 48, len(frames))
    struct.pack_into("<f", head, 92, 1.0)
    with gzip.open(paths[-1], "wb", 1) as out:
        out.write(bytes(head) + b"".join(frame[first:] for frame in frames))


if __name__ == "__main__":
    {"tiff": tiff, "series": series}[sys.argv[1]](*sys.argv[2:])
