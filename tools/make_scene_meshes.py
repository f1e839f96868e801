#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the small curved meshes of scenes/: pots, bowls, a torus and tiles, as binary PLY with exact normals.

    python3 tools/make_scene_meshes.py            # into scenes/meshes
    python3 tools/make_scene_meshes.py FOLDER     # elsewhere

The files are committed; after a change here run it again and commit them with it. The same script writes
the same bytes. It needs Python 3 and nothing else.
"""

import math
import pathlib
import sys

from mesh_shapes import loop_handle, revolve, rounded_path, sweep, torus, turned_profile
from mesh_writer import SCENE_MESHES, Mesh, write_meshes


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


if __name__ == "__main__":
    write_meshes(meshes(), pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else SCENE_MESHES)
