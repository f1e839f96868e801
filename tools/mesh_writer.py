# SPDX-License-Identifier: GPL-3.0-or-later
"""Polygon meshes with exact normals: put together from parts, written as binary PLY."""

import math
import os
import pathlib
import struct

SCENE_MESHES = pathlib.Path(__file__).resolve().parent.parent / "scenes" / "meshes"
LARGEST_SHORT = 65535  # a face of more vertices than these counts needs wider indices

IDENTITY = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0))


def translation(x, y, z):
    return ((1.0, 0.0, 0.0, x), (0.0, 1.0, 0.0, y), (0.0, 0.0, 1.0, z))


def scaling(x, y=None, z=None):
    """By one factor, or by one for each axis; a negative factor mirrors."""
    y, z = (x if y is None else y), (x if z is None else z)
    return ((x, 0.0, 0.0, 0.0), (0.0, y, 0.0, 0.0), (0.0, 0.0, z, 0.0))


def rotation(axis, degrees):
    """About the axis "x", "y" or "z", counter-clockwise as seen from its tip."""
    c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    if axis == "x":
        return ((1.0, 0.0, 0.0, 0.0), (0.0, c, -s, 0.0), (0.0, s, c, 0.0))
    if axis == "y":
        return ((c, 0.0, s, 0.0), (0.0, 1.0, 0.0, 0.0), (-s, 0.0, c, 0.0))
    return ((c, -s, 0.0, 0.0), (s, c, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0))


def frame(x, y, z, origin):
    """Takes the coordinate axes to x, y and z and the origin to a point."""
    return tuple((x[i], y[i], z[i], origin[i]) for i in range(3))


def in_order(*transforms):
    """The transform that applies the first one first."""
    result = transforms[0]
    for t in transforms[1:]:
        result = tuple(
            tuple(
                sum(row[k] * result[k][column] for k in range(3)) + (row[3] if column == 3 else 0.0)
                for column in range(4)
            )
            for row in t
        )
    return result


class Mesh:
    """Vertices with normals and polygons, counter-clockwise seen from outside."""

    def __init__(self):
        self.vertices = []
        self.faces = []

    def add_vertex(self, position, normal):
        self.vertices.append((*position, *normal))
        return len(self.vertices) - 1

    def add(self, part, *transforms):
        """Adds a closed mesh, transformed; the first transform is applied first."""
        assert part.volume() > 0.0, "a part is inside out"
        (a, b, c, tx), (d, e, f, ty), (g, h, i, tz) = in_order(IDENTITY, *transforms)
        # Normals go by the cofactors, which keep them at right angles to the surface.
        cofactors = (
            (e * i - f * h, f * g - d * i, d * h - e * g),
            (c * h - b * i, a * i - c * g, b * g - a * h),
            (b * f - c * e, c * d - a * f, a * e - b * d),
        )
        determinant = a * cofactors[0][0] + b * cofactors[0][1] + c * cofactors[0][2]
        sign = math.copysign(1.0, determinant)
        first = len(self.vertices)
        for x, y, z, nx, ny, nz in part.vertices:
            mx, my, mz = (sign * (row[0] * nx + row[1] * ny + row[2] * nz) for row in cofactors)
            length = math.sqrt(mx * mx + my * my + mz * mz)
            self.vertices.append(
                (
                    a * x + b * y + c * z + tx,
                    d * x + e * y + f * z + ty,
                    g * x + h * y + i * z + tz,
                    mx / length,
                    my / length,
                    mz / length,
                )
            )
        for face in part.faces:
            moved = tuple(first + vertex for vertex in face)
            self.faces.append(moved if determinant > 0.0 else moved[::-1])

    def flip(self):
        self.vertices = [(x, y, z, -nx, -ny, -nz) for x, y, z, nx, ny, nz in self.vertices]
        self.faces = [face[::-1] for face in self.faces]

    def volume(self):
        total = 0.0
        for face in self.faces:
            a = self.vertices[face[0]]
            for i, j in zip(face[1:], face[2:]):
                b, c = self.vertices[i], self.vertices[j]
                total += (
                    a[0] * (b[1] * c[2] - b[2] * c[1])
                    + a[1] * (b[2] * c[0] - b[0] * c[2])
                    + a[2] * (b[0] * c[1] - b[1] * c[0])
                )
        return total / 6.0

    def triangle_count(self):
        return sum(len(face) - 2 for face in self.faces)

    def write(self, path):
        """Writes the file whole or not at all. A mesh of few vertices has indices of two bytes."""
        assert self.volume() > 0.0, f"{path.name} is inside out"
        index, code = ("ushort", "H") if len(self.vertices) <= LARGEST_SHORT else ("uint", "I")
        lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(self.vertices)}"]
        lines += [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
        lines += [f"element face {len(self.faces)}", f"property list uchar {index} vertex_indices", "end_header"]
        data = bytearray("\n".join(lines).encode() + b"\n")
        for vertex in self.vertices:
            # Rounded, so that the last bits of a machine's sine do not show; + 0.0 makes -0 into 0.
            data += struct.pack("<6f", *(round(value, 7) + 0.0 for value in vertex))
        for face in self.faces:
            data += struct.pack(f"<B{len(face)}{code}", len(face), *face)
        part = path.with_name(f"{path.name}.{os.getpid()}.part")
        part.write_bytes(data)
        part.replace(path)


def write_meshes(meshes, folder):
    """Writes pairs of a name and a mesh into the folder, which it makes, and says what they are."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, mesh in meshes:
        path = folder / f"{name}.ply"
        mesh.write(path)
        print(
            f"{path.name}: {len(mesh.vertices)} vertices, {len(mesh.faces)} faces, "
            f"{mesh.triangle_count()} triangles, {path.stat().st_size} bytes"
        )
