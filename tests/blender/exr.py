"""Just enough of OpenEXR to read what Blender saves: scan lines without compression, in one part or several."""

import struct

import numpy as np

_DTYPES = {0: "<u4", 1: "<f2", 2: "<f4"}
_MULTIPART, _TILED_OR_DEEP = 0x1000, 0x0A00


def read_exr(path):
    """{channel name: (h, w) array, top row first}."""
    with open(path, "rb") as file:
        data = file.read()
    headers, at, multipart = _headers(path, data)
    pictures = {}
    for header in headers:
        assert header["compression"] == b"\0", f"{path} is compressed"
        at = _read_part(data, at, header, multipart, pictures)
    return pictures


def read_attributes(path):
    """{attribute name: bytes} of the first part."""
    with open(path, "rb") as file:
        data = file.read()
    return _headers(path, data)[0][0]


def _headers(path, data):
    magic, version = struct.unpack_from("<ii", data)
    assert magic == 20000630 and not version & _TILED_OR_DEEP, f"{path}: not a scan-line EXR"
    multipart = bool(version & _MULTIPART)
    at, headers = 8, []
    while not headers or (multipart and data[at]):
        header, at = _header(data, at)
        headers.append(header)
    return headers, at + multipart, multipart


def _read_part(data, at, header, multipart, pictures):
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    channels, position, listing = [], 0, header["channels"]
    while listing[position]:
        name, position = _text(listing, position)
        channels.append((name, np.dtype(_DTYPES[struct.unpack_from("<i", listing, position)[0]])))
        position += 16
    pictures |= {name: np.empty((height, width), dtype) for name, dtype in channels}
    for offset in np.frombuffer(data, "<u8", height, at):
        position = int(offset) + 4 * multipart  # the part's number
        y, _ = struct.unpack_from("<ii", data, position)
        position += 8
        for name, dtype in channels:
            pictures[name][y - y0] = np.frombuffer(data, dtype, width, position)
            position += width * dtype.itemsize
    return at + 8 * height


def _header(data, at):
    attributes = {}
    while data[at]:
        name, at = _text(data, at)
        _, at = _text(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1
