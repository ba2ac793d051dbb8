#!/usr/bin/env python3
"""Reads a .pvd index and its .vtp files with nothing but an XML parser and struct.

read_vtk.py INDEX.pvd prints one JSON object: per frame the time, the numbers of points, cells and
contacts, and the sums of all arrays, which the caller compares with the recording.
"""
import json
import os
import struct
import sys
import xml.etree.ElementTree as ElementTree


def read_arrays(path):
    with open(path, "rb") as file:
        content = file.read()
    start = content.index(b"<AppendedData encoding=\"raw\">")
    data = content[content.index(b"_", start + len(b"<AppendedData encoding=\"raw\">")) + 1:]
    root = ElementTree.fromstring(content[:start] + b"</VTKFile>")
    assert root.attrib["byte_order"] == "LittleEndian" and root.attrib["header_type"] == "UInt64"
    piece = root.find("PolyData/Piece")
    arrays = {}
    for section in piece:
        for array in section:
            offset = int(array.attrib["offset"])
            (size,) = struct.unpack_from("<Q", data, offset)
            code = {"Float32": "f", "Int32": "i"}[array.attrib["type"]]
            values = struct.unpack_from("<%d%s" % (size // 4, code), data, offset + 8)
            arrays[section.tag + "/" + array.attrib["Name"]] = values
    points = int(piece.attrib["NumberOfPoints"])
    cells = int(piece.attrib["NumberOfPolys"]) + int(piece.attrib["NumberOfVerts"])
    assert len(arrays["Points/points"]) == 3 * points
    kind = "Polys" if "Polys/offsets" in arrays else "Verts"
    assert len(arrays[kind + "/offsets"]) == cells
    if cells:
        assert arrays[kind + "/offsets"][-1] == len(arrays[kind + "/connectivity"])
        assert max(arrays[kind + "/connectivity"]) < points
    return points, cells, arrays


def main(path):
    frames = []
    for data_set in ElementTree.parse(path).getroot().find("Collection"):
        file = os.path.join(os.path.dirname(path), data_set.attrib["file"])
        points, cells, arrays = read_arrays(file)
        frames.append({
            "time": float(data_set.attrib["timestep"]),
            "name": data_set.attrib["name"],
            "points": points,
            "cells": cells,
            "sums": {name: sum(values) for name, values in arrays.items()},
        })
    print(json.dumps(frames))


main(sys.argv[1])
