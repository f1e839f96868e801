#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the curved meshes of scenes/: pots, bowls, a torus and tiles, as binary PLY with exact normals.

    python3 tools/make_scene_meshes.py            # into scenes/meshes
    python3 tools/make_scene_meshes.py FOLDER     # elsewhere

The files are committed; after a change here run it again and commit them with it. The same script writes
the same bytes. It needs Python 3 and nothing else.
"""

import math
import pathlib
import struct
import sys

SMALL_RADIUS = 0.025  # roundings that are too small in the picture to need many faces
DEFAULT_FOLDER = pathlib.Path(__file__).resolve().parent.parent / "scenes" / "meshes"


class Mesh:
    """Vertices with normals and polygons, counter-clockwise seen from outside."""

    def __init__(self):
        self.vertices = []
        self.faces = []

    def add_vertex(self, position, normal):
        self.vertices.append((*position, *normal))
        return len(self.vertices) - 1

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

    def write(self, path):
        assert self.volume() > 0.0, f"{path.name} is inside out"
        lines = ["ply", "format binary_little_endian 1.0", f"element vertex {len(self.vertices)}"]
        lines += [f"property float {name}" for name in ("x", "y", "z", "nx", "ny", "nz")]
        lines += [f"element face {len(self.faces)}", "property list uchar ushort vertex_indices", "end_header"]
        data = bytearray("\n".join(lines).encode() + b"\n")
        for vertex in self.vertices:
            # Rounded, so that the last bits of a machine's sine do not show; + 0.0 makes -0 into 0.
            data += struct.pack("<6f", *(round(value, 7) + 0.0 for value in vertex))
        for face in self.faces:
            data += struct.pack(f"<B{len(face)}H", len(face), *face)
        path.write_bytes(data)


def rounded_path(corners, max_step, max_turn):
    """Samples (x, y, tangent x, tangent y) of a polygonal line with rounded corners.

    corners: (x, y) of the ends, (x, y, radius) between. max_step: length of the pieces of straight lines;
    max_turn: of arcs, in radians, twice as much in small ones.
    """
    samples = []

    def add(x, y, tx, ty):
        if not samples or math.hypot(x - samples[-1][0], y - samples[-1][1]) > 1e-7:
            samples.append((x, y, tx, ty))

    def add_line(x0, y0, x1, y1, tx, ty):
        count = max(1, math.ceil(math.hypot(x1 - x0, y1 - y0) / max_step))
        for i in range(count + 1):
            add(x0 + (x1 - x0) * i / count, y0 + (y1 - y0) * i / count, tx, ty)

    def direction(a, b):
        length = math.hypot(b[0] - a[0], b[1] - a[1])
        return (b[0] - a[0]) / length, (b[1] - a[1]) / length

    x, y = corners[0]
    for before, corner, after in zip(corners, corners[1:], corners[2:]):
        (ax, ay), (bx, by) = direction(before, corner), direction(corner, after)
        turn = math.atan2(ax * by - ay * bx, ax * bx + ay * by)
        radius = corner[2]
        cut = radius * math.tan(abs(turn) / 2)
        start = corner[0] - cut * ax, corner[1] - cut * ay
        assert (start[0] - x) * ax + (start[1] - y) * ay > -1e-9, f"the roundings at {corner} overlap"
        add_line(x, y, *start, ax, ay)
        side = math.copysign(1.0, turn)
        center = start[0] - side * radius * ay, start[1] + side * radius * ax
        step = max_turn if radius > SMALL_RADIUS else 2 * max_turn
        count = max(1, math.ceil(abs(turn) / step))
        for i in range(1, count + 1):
            angle = turn * i / count
            tx = ax * math.cos(angle) - ay * math.sin(angle)
            ty = ax * math.sin(angle) + ay * math.cos(angle)
            x, y = center[0] + side * radius * ty, center[1] - side * radius * tx
            add(x, y, tx, ty)
    tx, ty = direction(corners[-2], corners[-1])
    assert (corners[-1][0] - x) * tx + (corners[-1][1] - y) * ty > -1e-9, "the last rounding reaches too far"
    add_line(x, y, corners[-1][0], corners[-1][1], tx, ty)
    return samples


def join_rings(mesh, rings):
    """Quads between consecutive rings of equal size; a ring of one vertex is a pole."""
    count = max(len(ring) for ring in rings)
    for lower, upper in zip(rings, rings[1:]):
        for i in range(count):
            j = (i + 1) % count
            if len(lower) == 1:
                mesh.faces.append((lower[0], upper[i], upper[j]))
            elif len(upper) == 1:
                mesh.faces.append((lower[i], upper[0], lower[j]))
            else:
                mesh.faces.append((lower[i], upper[i], upper[j], lower[j]))


def circle(count):
    return [(math.cos(2 * math.pi * i / count), math.sin(2 * math.pi * i / count)) for i in range(count)]


def revolve(profile, segments):
    """The profile (radius, height, tangent), from the axis to the axis, turned around the y axis; the outside
    is on its right."""
    mesh = Mesh()
    rings = []
    for radius, height, tangent_radius, tangent_height in profile:
        if radius < 1e-9:
            up = -math.copysign(1.0, tangent_radius)
            rings.append([mesh.add_vertex((0.0, height, 0.0), (0.0, up, 0.0))])
            continue
        rings.append(
            [
                mesh.add_vertex(
                    (radius * c, height, radius * s),
                    (tangent_height * c, -tangent_radius, tangent_height * s),
                )
                for c, s in circle(segments)
            ]
        )
    join_rings(mesh, rings)
    return mesh


def sweep(path, radius, segments, round_end):
    """A tube along a path in the plane z = 0. It begins with a flat cap and ends with one or a hemisphere."""
    mesh = Mesh()
    around = [(c, -s) for c, s in circle(segments)]  # as seen along the path, so that faces look outside

    def ring(x, y, tx, ty, scale, lean):
        # The normals lean along the tangent on a hemisphere.
        across = math.sqrt(1.0 - lean * lean)
        result = []
        for c, s in around:
            normal = (-c * ty * across + lean * tx, c * tx * across + lean * ty, s * across)
            result.append(
                mesh.add_vertex((x - c * ty * radius * scale, y + c * tx * radius * scale, s * radius * scale), normal)
            )
        return result

    def flat_cap(x, y, tx, ty, sign):
        center = mesh.add_vertex((x, y, 0.0), (sign * tx, sign * ty, 0.0))
        border = ring(x, y, tx, ty, 1.0, 0.0)
        for i in border:  # the same places as the tube's end, with the cap's normal: a crease
            mesh.vertices[i] = (*mesh.vertices[i][:3], sign * tx, sign * ty, 0.0)
        join_rings(mesh, [[center], border] if sign < 0 else [border, [center]])

    flat_cap(*path[0], -1.0)
    rings = [ring(*sample, 1.0, 0.0) for sample in path]
    x, y, tx, ty = path[-1]
    if round_end:
        steps = max(3, segments // 4)
        for i in range(1, steps):
            lean = math.sin(math.pi / 2 * i / steps)
            along = radius * lean
            scale = math.cos(math.pi / 2 * i / steps)
            rings.append(ring(x + along * tx, y + along * ty, tx, ty, scale, lean))
        rings.append([mesh.add_vertex((x + radius * tx, y + radius * ty, 0.0), (tx, ty, 0.0))])
    join_rings(mesh, rings)
    if not round_end:
        flat_cap(x, y, tx, ty, 1.0)
    return mesh


def torus(major, minor, around, across):
    mesh = Mesh()
    rings = []
    for c, s in circle(across):
        rings.append(
            [
                mesh.add_vertex(((major + minor * c) * a, minor * s, (major + minor * c) * b), (c * a, s, c * b))
                for a, b in circle(around)
            ]
        )
    join_rings(mesh, [*rings, rings[0]])
    return mesh


def tile_row(count, size, depth):
    """Boxes with gaps of their own width between them, along +x from the origin, whose fronts face +z."""
    mesh = Mesh()
    for column in range(count):
        low = (2 * column * size, 0.0, -depth)
        high = ((2 * column + 1) * size, size, 0.0)
        for axis in range(3):
            for side, bound in ((-1.0, low), (1.0, high)):
                a, b = (axis + 1) % 3, (axis + 2) % 3
                normal = [0.0, 0.0, 0.0]
                normal[axis] = side
                face = []
                for u, v in ((low, low), (high, low), (high, high), (low, high)):
                    corner = [0.0, 0.0, 0.0]
                    corner[axis], corner[a], corner[b] = bound[axis], u[a], v[b]
                    face.append(mesh.add_vertex(corner, normal))
                mesh.faces.append(tuple(face if side > 0.0 else reversed(face)))
    return mesh


def turned_profile(corners, max_step=0.06, max_turn=math.radians(12)):
    return rounded_path(corners, max_step, max_turn)


def pot_body(radius, height, wall, bottom_rounding):
    """A cylinder with a rounded bottom edge and a rolled rim."""
    inner = radius - wall
    return revolve(
        turned_profile(
            [
                (0.0, 0.0),
                (radius, 0.0, bottom_rounding),
                (radius, height - 0.018, 0.02),
                (radius + 0.012, height - 0.003, 0.006),
                (radius + 0.007, height + 0.006, 0.005),
                (inner, height - 0.008, 0.012),
                (inner, wall, bottom_rounding - wall),
                (0.0, wall),
            ]
        ),
        88,
    )


def pot_lid(radius, height, knob):
    """A dome with a knob; its underside is flat."""
    return revolve(
        turned_profile(
            [
                (0.0, 0.0),
                (radius, 0.0, 0.004),
                (radius, 0.01, 0.004),
                (0.62 * radius, 0.75 * height, 0.9 * radius),
                (0.4 * knob, height, 0.012),
                (0.34 * knob, height + 0.55 * knob, 0.25 * knob),
                (knob, height + 0.7 * knob, 0.3 * knob),
                (0.92 * knob, height + 1.35 * knob, 0.3 * knob),
                (0.0, height + 1.45 * knob),
            ],
            max_turn=math.radians(11),
        ),
        80,
    )


def loop_handle(span, reach, radius):
    """A bow from (0, -span / 2) to (0, span / 2) that reaches out along +x; the ends are meant to stand in a
    wall."""
    path = rounded_path(
        [
            (0.0, -span / 2),
            (reach, -span / 2, 0.75 * min(reach, span / 2)),
            (reach, span / 2, 0.75 * min(reach, span / 2)),
            (0.0, span / 2),
        ],
        0.02,
        math.radians(7.5),
    )
    return sweep(path, radius, 24, round_end=False)


def long_handle(length, rise, radius):
    path = rounded_path([(0.0, 0.0), (0.12, 0.0, 0.1), (length, rise)], 0.03, math.radians(4))
    return sweep(path, radius, 28, round_end=True)


def bowl(radius, height, wall):
    """On a foot ring, open upwards."""
    foot = 0.4 * radius
    return revolve(
        turned_profile(
            [
                (0.0, 0.014),
                (foot - 0.022, 0.014, 0.005),
                (foot - 0.018, 0.0, 0.004),
                (foot, 0.0, 0.004),
                (foot + 0.004, 0.016, 0.006),
                (0.82 * radius, 0.12 * height, 0.47 * radius),
                (radius, height, 0.49 * wall),
                (radius - wall, height + 0.003, 0.49 * wall),
                (0.82 * radius - wall, 0.12 * height + wall, 0.45 * radius),
                (0.0, 0.12 * height + wall - 0.002),
            ],
            max_step=0.05,
            max_turn=math.radians(8),
        ),
        88,
    )


def meshes():
    yield "pot_body", pot_body(0.25, 0.27, 0.012, 0.05)
    yield "pot_lid", pot_lid(0.258, 0.065, 0.034)
    yield "pot_handle", loop_handle(0.13, 0.07, 0.0105)
    yield "saucepan_body", pot_body(0.17, 0.14, 0.012, 0.035)
    yield "saucepan_handle", long_handle(0.34, 0.05, 0.0125)
    yield "bowl", bowl(0.2, 0.13, 0.014)
    yield "torus", torus(0.24, 0.085, 88, 40)
    yield "tile_row", tile_row(10, 0.14, 0.03)


def main(arguments):
    folder = pathlib.Path(arguments[0]) if arguments else DEFAULT_FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    for name, mesh in meshes():
        path = folder / f"{name}.ply"
        mesh.write(path)
        print(f"{path.name}: {len(mesh.vertices)} vertices, {len(mesh.faces)} faces, {path.stat().st_size} bytes")


if __name__ == "__main__":
    main(sys.argv[1:])
