#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the meshes of scenes/kitchen.xml, one for each material, in metres and in their places.

    python3 tools/make_kitchen.py            # into scenes/meshes/generated
    python3 tools/make_kitchen.py FOLDER     # elsewhere

The build runs it (target scene_meshes). The room is 3.7 wide (x), 2.5 high (y) and 3.9 deep (z); its back wall
is z = 0 and the window is in its left wall, x = 0.
"""

import math
import pathlib
import random
import sys

from mesh_shapes import (
    box,
    faceted,
    loop_handle,
    panel,
    rectangular_frame,
    revolve,
    revolve_loop,
    rod,
    sphere,
    turned_profile,
)
from mesh_writer import SCENE_MESHES, Mesh, rotation, scaling, translation, write_meshes

WORKTOP = 0.90  # height
DEPTH = 0.62  # of the worktop
FRONT = 0.57  # where doors and drawers begin
PLINTH = 0.10
DOOR = 0.02  # thickness
GAP = 0.003  # between doors
HOB = (1.54, 0.315)  # centre of the hob, x and z
SINK = (0.33, 1.2)
SINK_HALF = (0.176, 0.246)
WINDOW = ((0.75, 1.12), (1.6, 2.1))  # z and y
TILES_TOP = 2.06
TILE = (0.15, 0.075)
JOINT = 0.004
SHELVES = (1.40, 1.74)

FACES_X = rotation("y", 90.0)  # turns what faces +z to face +x, with its own x along -z


def turned(*corners, segments=52):
    """A solid of revolution from corners (radius, height, rounding); metres are small against the steps."""
    return revolve(turned_profile(corners, max_step=0.03), segments)


def front(width, height, frame):
    """A door or drawer with a recessed panel, its back at z = 0."""
    edge, slope = 0.002, 0.006
    return panel(
        width - GAP,
        height - GAP,
        ((0.0, 0.0), (0.0, DOOR - edge), (edge, DOOR), (frame, DOOR), (frame + slope, DOOR - 0.008)),
    )


def handle(span, is_horizontal):
    """A bow for what faces +z."""
    bow = Mesh()
    turn = [rotation("x", 90.0)] if is_horizontal else []
    bow.add(loop_handle(span, 0.034, 0.0055), *turn, rotation("y", -90.0))
    return bow


def base_units():
    """What the two rows of base units are made of, as (kind, low end, high end) along the row as seen."""
    back = [("drawers", 0.64, 1.24), ("doors", 1.84, 2.44), ("drawers", 2.44, 3.0)]
    left = [("door", 0.64, 0.9), ("doors", 0.9, 1.5), ("drawers", 1.5, 2.1), ("door", 2.1, 2.46)]
    return [(unit, lambda x: [translation(x, 0.0, FRONT)]) for unit in back] + [
        (unit, lambda z: [FACES_X, translation(FRONT, 0.0, z)]) for unit in left
    ]


def add_unit(cupboards, handles, unit, place):
    kind, low, high = unit
    top = WORKTOP - 0.04
    width = high - low
    middle = 0.5 * (low + high)

    def add(mesh, part, along, height, depth=0.0):
        mesh.add(part, translation(0.0, height, depth), *place(along))

    if kind == "drawers":
        edges = (PLINTH, 0.38, 0.64, top)
        for y0, y1 in zip(edges, edges[1:]):
            add(cupboards, front(width, y1 - y0, 0.032), middle, 0.5 * (y0 + y1))
            add(handles, handle(0.16, True), middle, 0.5 * (y0 + y1) + 0.055, DOOR - 0.004)
        return
    height = top - PLINTH
    leaves = 2 if kind == "doors" else 1
    leaf = width / leaves
    for i in range(leaves):
        center = low + (i + 0.5) * leaf
        add(cupboards, front(leaf, height, 0.055), center, PLINTH + 0.5 * height)
        side = 1.0 if i == 0 else -1.0  # the handles of a pair are side by side
        add(handles, handle(0.14, False), center + side * (0.5 * leaf - 0.028), top - 0.15, DOOR - 0.004)


def cupboards_and_handles():
    cupboards, handles = Mesh(), Mesh()
    for unit, place in base_units():
        add_unit(cupboards, handles, unit, place)
    top = WORKTOP - 0.041
    cupboards.add(box((0.003, PLINTH, 0.003), (3.0, top, FRONT - 0.001), 0.001))
    under_sink = WORKTOP - 0.245
    for low, high, y in ((FRONT + 0.001, 0.9, top), (0.901, 1.499, under_sink), (1.5, 2.46, top)):
        cupboards.add(box((0.004, PLINTH, low), (FRONT - 0.001, y, high), 0.001))
    cupboards.add(
        panel(FRONT + DOOR, top, ((0.0, 0.0), (0.0, 0.018), (0.002, 0.02))), translation(0.297, 0.5 * top, 2.462)
    )
    # Over the worktop on the right.
    low, high = (1.93, 1.48), (2.93, 2.24)
    cupboards.add(box((low[0], low[1], 0.002), (high[0], high[1], 0.30), 0.002))
    for i in range(2):
        center = low[0] + 0.25 + 0.5 * i
        cupboards.add(front(0.5, high[1] - low[1], 0.055), translation(center, 0.5 * (low[1] + high[1]), 0.301))
        side = 1.0 if i == 0 else -1.0
        handles.add(handle(0.14, False), translation(center + side * 0.222, low[1] + 0.15, 0.301 + DOOR - 0.004))
    cornice = ((0.0, 0.0), (0.0, 0.012), (0.012, 0.03), (0.012, 0.045))
    cupboards.add(
        panel(1.03, 0.365, cornice), rotation("x", -90.0), translation(2.43, high[1] + 0.001, 0.1835)
    )
    return cupboards, handles


def plinth():
    mesh = Mesh()
    mesh.add(box((0.002, 0.001, 0.002), (2.98, PLINTH, FRONT - 0.05), 0.001))
    mesh.add(box((0.002, 0.001, FRONT - 0.049), (FRONT - 0.05, PLINTH, 2.44), 0.001))
    return mesh


def worktop():
    """Two slabs; the left one has a hole for the sink."""
    mesh = Mesh()
    upright = rotation("x", -90.0)  # takes z to y and y to -z
    thick, chamfer = 0.04, 0.004

    def slab(part):
        mesh.add(part, upright, translation(0.0, WORKTOP - thick, 0.0))

    slab(box((0.001, -DEPTH, 0.0), (3.02, -0.001, thick), chamfer))
    (x, z), (dx, dz) = SINK, SINK_HALF
    hole = ((x - dx, -z - dz), (x + dx, -z + dz))
    slab(rectangular_frame(((0.001, -2.5), (DEPTH, -DEPTH - 0.0005)), hole, 0.0, thick, chamfer))
    return mesh


def tile_wall(mesh, width, low, high, is_covered, chance, *place):
    """Bevelled tiles in running bond on the plane z = 0 from the origin; each is a little askew."""
    row = 0
    y = low
    while y + TILE[1] < high:
        x = -0.5 * TILE[0] * (row % 2)
        while x < width:
            x0, x1 = max(x, 0.0), min(x + TILE[0], width)
            if x1 - x0 > 0.04 and not is_covered(x0, x1, y, y + TILE[1]):
                tile = panel(x1 - x0 - JOINT, TILE[1] - JOINT, ((0.0, -0.004), (0.0, 0.004), (0.011, 0.0075)))
                lean = [rotation(axis, chance.uniform(-0.35, 0.35)) for axis in "xy"]
                mesh.add(tile, *lean, translation(0.5 * (x0 + x1), y + 0.5 * TILE[1], 0.0), *place)
            x += TILE[0]
        y += TILE[1]
        row += 1


def tiles():
    mesh = Mesh()
    chance = random.Random(11)
    tile_wall(mesh, 3.0, WORKTOP + 0.003, TILES_TOP, lambda *_: False, chance, translation(0.009, 0.0, 0.0))
    (z0, y0), (z1, _) = WINDOW

    def window(x0, x1, low, high):
        return 2.5 - x1 < z1 + 0.01 and 2.5 - x0 > z0 - 0.01 and high > y0 - 0.03

    tile_wall(mesh, 2.5 - 0.009, WORKTOP + 0.003, TILES_TOP, window, chance, FACES_X, translation(0.0, 0.0, 2.5))
    return mesh


def floor_tiles(parity):
    mesh = Mesh()
    size = 0.32
    for i in range(12):
        for j in range(13):
            if (i + j) % 2 == parity:
                part = panel(size - JOINT, size - JOINT, ((0.0, -0.002), (0.0, 0.004), (0.002, 0.006)))
                mesh.add(part, rotation("x", -90.0), translation((i + 0.5) * size - 0.1, 0.0, (j + 0.5) * size - 0.1))
    return mesh


def sink():
    """Hangs under the worktop; its rim is wider than the hole."""
    mesh = Mesh()
    profile = turned_profile(
        [
            (0.0, -0.2),
            (0.068, -0.2, 0.03),
            (0.068, -0.012, 0.004),
            (0.088, -0.012, 0.002),
            (0.088, -0.001, 0.002),
            (0.06, -0.001, 0.006),
            (0.056, -0.19, 0.035),
            (0.0, -0.19),
        ],
        max_step=0.03,
        max_turn=math.radians(10),
    )
    core = (SINK_HALF[0] - 0.056, SINK_HALF[1] - 0.056)
    mesh.add(revolve(profile, 40, core), translation(SINK[0], WORKTOP - 0.04, SINK[1]))
    drain = turned(
        (0.0, -0.008),
        (0.042, -0.008, 0.001),
        (0.042, 0.002, 0.0015),
        (0.034, 0.002, 0.001),
        (0.03, -0.004, 0.002),
        (0.0, -0.004),
        segments=48,
    )
    mesh.add(drain, translation(SINK[0], WORKTOP - 0.04 - 0.19, SINK[1]))
    return mesh


def tap():
    mesh = Mesh()
    place = translation(SINK[0] - SINK_HALF[0] - 0.055, WORKTOP, SINK[1])
    mesh.add(
        turned(
            (0.0, -0.01),
            (0.027, -0.01, 0.002),
            (0.027, 0.004, 0.003),
            (0.02, 0.009, 0.004),
            (0.019, 0.095, 0.006),
            (0.0, 0.097),
            segments=48,
        ),
        place,
    )
    neck = rod(
        [(0.0, 0.08), (0.0, 0.36, 0.1), (0.21, 0.36, 0.1), (0.21, 0.235)],
        0.0115,
        32,
        round_end=False,
        max_step=0.03,
        max_turn=math.radians(6),
    )
    mesh.add(neck, place)
    nozzle = turned((0.0, 0.0), (0.0145, 0.0, 0.002), (0.0145, 0.03, 0.003), (0.0, 0.031), segments=40)
    mesh.add(nozzle, translation(0.21, 0.215, 0.0), place)
    lever = rod([(0.0, 0.0), (0.045, 0.0, 0.02), (0.085, 0.035)], 0.0065, 24, max_step=0.02)
    mesh.add(lever, rotation("y", -90.0), translation(0.0, 0.065, 0.012), place)
    return mesh


def hood():
    mesh = Mesh()

    def ring(half, y, depth):
        x = HOB[0]
        return [(x - half, y, 0.002), (x + half, y, 0.002), (x + half, y, depth), (x - half, y, depth)]

    mesh.add(
        faceted(
            [
                ring(0.292, 1.60, 0.482),
                ring(0.296, 1.604, 0.486),
                ring(0.296, 1.655, 0.486),
                ring(0.292, 1.66, 0.482),
                ring(0.15, 1.93, 0.27),
                ring(0.146, 1.94, 0.266),
            ]
        )
    )
    mesh.add(box((HOB[0] - 0.13, 1.935, 0.002), (HOB[0] + 0.13, 2.51, 0.245), 0.003))
    return mesh


def hob_and_oven():
    """The black glass; the steel around it with knobs; the thin rings of the hob."""
    glass, steel, rings = Mesh(), Mesh(), Mesh()
    top = WORKTOP + 0.0065
    glass.add(
        panel(0.58, 0.51, ((0.0, -0.003), (0.0, 0.0055), (0.001, 0.0065))),
        rotation("x", -90.0),
        translation(HOB[0], WORKTOP, HOB[1]),
    )
    for x, z, radius in ((-0.14, -0.02, 0.115), (0.155, 0.02, 0.095), (0.13, -0.16, 0.075)):
        ring = revolve_loop(
            [
                (radius, -0.0005, 0.0001),
                (radius + 0.002, -0.0005, 0.0001),
                (radius + 0.002, 0.0005, 0.0002),
                (radius, 0.0005, 0.0002),
            ],
            96,
        )
        rings.add(ring, translation(HOB[0] + x, top, HOB[1] + z))
    steel.add(panel(0.6 - GAP, 0.12, ((0.0, 0.0), (0.0, 0.02), (0.002, 0.022))), translation(HOB[0], 0.798, FRONT))
    knob = turned(
        (0.0, 0.0),
        (0.02, 0.0, 0.002),
        (0.02, 0.004, 0.001),
        (0.0165, 0.007, 0.002),
        (0.0155, 0.026, 0.003),
        (0.0, 0.027),
        segments=40,
    )
    for i in range(5):
        steel.add(knob, rotation("x", 90.0), translation(HOB[0] + 0.105 * (i - 2), 0.798, FRONT + 0.0215))
    glass.add(panel(0.6 - GAP, 0.632, ((0.0, 0.0), (0.0, 0.02), (0.002, 0.022))), translation(HOB[0], 0.42, FRONT))
    bow = loop_handle(0.5, 0.05, 0.0095)
    steel.add(bow, rotation("x", 90.0), rotation("y", -90.0), translation(HOB[0], 0.685, FRONT + 0.02))
    return glass, steel, rings


def window():
    """The painted frame with its bars and the sill."""
    mesh = Mesh()
    (z0, y0), (z1, y1) = WINDOW
    low, high = (-z1, y0), (-z0, y1)
    inner = ((low[0] + 0.05, low[1] + 0.05), (high[0] - 0.05, high[1] - 0.05))
    mesh.add(rectangular_frame((low, high), inner, -0.1, -0.05, 0.006), FACES_X)
    middle = -0.5 * (z0 + z1)
    cross_bar = y0 + 0.62 * (y1 - y0)
    mesh.add(
        box((middle - 0.028, inner[0][1] - 0.003, -0.098), (middle + 0.028, inner[1][1] + 0.003, -0.054), 0.005),
        FACES_X,
    )
    for a, b in ((inner[0][0], middle - 0.028), (middle + 0.028, inner[1][0])):
        mesh.add(box((a - 0.003, cross_bar - 0.014, -0.096), (b + 0.003, cross_bar + 0.014, -0.06), 0.004), FACES_X)
    mesh.add(box((low[0] - 0.05, y0 - 0.028, -0.1), (high[0] + 0.05, y0, 0.05), 0.004), FACES_X)
    return mesh


def left_wall():
    """With a hole for the window; it reaches out of the room on all sides."""
    (z0, y0), (z1, y1) = WINDOW
    mesh = Mesh()
    hole = ((-z1, y0), (-z0, y1))
    mesh.add(rectangular_frame(((-3.95, -0.05), (0.05, 2.55)), hole, -0.14, 0.0, 0.003), FACES_X)
    return mesh


def woodwork():
    """Shelves, a chopping board against the wall and wooden spoons."""
    mesh = Mesh()
    for y in SHELVES:
        mesh.add(
            box((0.26, 0.0, 0.0), (1.14, 0.23, 0.028), 0.003), rotation("x", -90.0), translation(0.0, y - 0.028, 0.2385)
        )
    edge = [(0.0, 0.0), (0.05, 0.0, 0.006), (0.05, 0.02, 0.006), (0.0, 0.02)]
    board = revolve(turned_profile(edge, max_step=0.03), 32, (0.09, 0.14))
    mesh.add(board, rotation("x", 78.0), translation(1.02, WORKTOP + 0.185, 0.0468))
    for angle, lean, height in ((20.0, 12.0, 0.285), (150.0, 14.0, 0.27), (265.0, 10.0, 0.30)):
        place = [
            rotation("z", -lean),
            translation(0.01, 0.0, 0.0),
            rotation("y", angle),
            translation(0.165, WORKTOP + 0.02, 0.20),
        ]
        mesh.add(rod([(0.0, 0.0), (0.0, height)], 0.0055, 20, max_step=0.04), *place)
        mesh.add(sphere(1.0, 32, 16), scaling(0.022, 0.034, 0.009), translation(0.0, height, 0.0), *place)
    return mesh


def plate(radius):
    return turned(
        (0.0, 0.003),
        (0.5 * radius, 0.003, 0.002),
        (0.52 * radius, 0.0, 0.001),
        (0.57 * radius, 0.0, 0.001),
        (0.6 * radius, 0.005, 0.01),
        (radius, 0.018, 0.0018),
        (radius - 0.001, 0.0222, 0.0018),
        (0.62 * radius, 0.0095, 0.02),
        (0.0, 0.0085),
        segments=60,
    )


def dish(radius, height):
    foot = 0.45 * radius
    return turned(
        (0.0, 0.004),
        (foot - 0.006, 0.004, 0.001),
        (foot - 0.005, 0.0, 0.0008),
        (foot, 0.0, 0.0008),
        (foot + 0.002, 0.006, 0.003),
        (0.88 * radius, 0.25 * height, 0.5 * radius),
        (radius, height, 0.002),
        (radius - 0.0045, height, 0.002),
        (0.86 * radius - 0.004, 0.25 * height + 0.006, 0.45 * radius),
        (0.0, 0.011),
        segments=52,
    )


def mug():
    mesh = Mesh()
    mesh.add(
        turned(
            (0.0, 0.0),
            (0.036, 0.0, 0.006),
            (0.04, 0.09, 0.0018),
            (0.036, 0.09, 0.0018),
            (0.032, 0.006, 0.006),
            (0.0, 0.006),
            segments=40,
        )
    )
    mesh.add(loop_handle(0.046, 0.03, 0.0045), translation(0.036, 0.047, 0.0))
    return mesh


def crockery():
    """White: plates and bowls in stacks, mugs, a dish on the worktop."""
    mesh = Mesh()
    low, high = SHELVES
    for i in range(7):
        mesh.add(plate(0.108), translation(0.44, low + 0.009 * i, 0.125))
    for i in range(4):
        mesh.add(dish(0.075, 0.062), translation(0.68, low + 0.019 * i, 0.125))
    for x, angle in ((0.86, 35.0), (0.98, 50.0), (1.08, 25.0)):
        mesh.add(mug(), rotation("y", angle), translation(x, low, 0.12))
    for i in range(3):
        mesh.add(dish(0.1, 0.075), translation(0.97, high + 0.02 * i, 0.122))
    for i in range(5):
        mesh.add(plate(0.125), translation(2.42, WORKTOP + 0.009 * i, 0.27))
    return mesh


def jar(radius, height):
    return turned(
        (0.0, 0.0),
        (radius, 0.0, 0.01),
        (radius, height, 0.007),
        (0.8 * radius, height, 0.002),
        (0.8 * radius, height + 0.008, 0.002),
        (0.96 * radius, height + 0.008, 0.003),
        (0.96 * radius, height + 0.024, 0.006),
        (0.2 * radius, height + 0.026, 0.004),
        (0.16 * radius, height + 0.036, 0.003),
        (0.3 * radius, height + 0.04, 0.004),
        (0.28 * radius, height + 0.054, 0.006),
        (0.0, height + 0.056),
    )


def jars():
    """Glazed: lidded jars on the upper shelf and the pot that holds the spoons."""
    mesh = Mesh()
    high = SHELVES[1]
    for x, radius, height in ((0.36, 0.058, 0.15), (0.51, 0.052, 0.125), (0.645, 0.046, 0.1)):
        mesh.add(jar(radius, height), translation(x, high, 0.122))
    crock = turned(
        (0.0, 0.0),
        (0.052, 0.0, 0.012),
        (0.062, 0.08, 0.05),
        (0.054, 0.15, 0.05),
        (0.058, 0.165, 0.002),
        (0.052, 0.165, 0.002),
        (0.046, 0.13, 0.04),
        (0.052, 0.02, 0.012),
        (0.0, 0.012),
    )
    mesh.add(crock, translation(0.165, WORKTOP, 0.20))
    return mesh


def bottle(radius, height):
    neck = 0.38 * radius
    return turned(
        (0.0, 0.0),
        (radius, 0.0, 0.006),
        (radius, 0.58 * height, 0.5 * radius),
        (neck, 0.76 * height, 0.8 * radius),
        (neck, 0.93 * height, 0.001),
        (1.25 * neck, 0.935 * height, 0.001),
        (1.25 * neck, 0.975 * height, 0.002),
        (0.8 * neck, 0.98 * height, 0.001),
        (0.75 * neck, height, 0.002),
        (0.0, height),
        segments=56,
    )


def herb_pot():
    """A pot of earth and its leaves, apart."""
    pot = turned(
        (0.0, 0.0),
        (0.034, 0.0, 0.004),
        (0.042, 0.062, 0.004),
        (0.048, 0.063, 0.003),
        (0.049, 0.085, 0.003),
        (0.0, 0.078),
        segments=48,
    )
    leaves = Mesh()
    leaf = sphere(1.0, 14, 8)
    chance = random.Random(5)
    for i in range(90):
        angle, lean, reach = 137.508 * i, chance.uniform(10.0, 75.0), chance.uniform(0.035, 0.075)
        length = chance.uniform(0.011, 0.018)
        leaves.add(
            leaf,
            scaling(0.6 * length, 0.14 * length, length),
            rotation("x", chance.uniform(-50.0, 20.0)),
            translation(0.0, 0.0, reach),
            rotation("x", lean - 90.0),
            rotation("y", angle),
            translation(0.0, 0.083, 0.0),
        )
    return pot, leaves


def herbs():
    """Two pots on the window sill."""
    pots, leaves = Mesh(), Mesh()
    sill = WINDOW[0][1]
    for z, angle in ((0.855, 0.0), (1.0, 77.0)):
        place = [rotation("y", angle), translation(0.0, sill, z)]
        for mesh, part in zip((pots, leaves), herb_pot()):
            mesh.add(part, *place)
    return pots, leaves


def bottles():
    mesh = Mesh()
    mesh.add(bottle(0.036, 0.29), translation(0.33, WORKTOP, 0.13))
    mesh.add(bottle(0.030, 0.24), translation(0.415, WORKTOP, 0.19))
    mesh.add(bottle(0.036, 0.28), translation(0.775, SHELVES[1], 0.12))
    return mesh


def meshes():
    cupboards, handles = cupboards_and_handles()
    glass, steel, rings = hob_and_oven()
    steel.add(hood())
    pots, leaves = herbs()
    yield "kitchen_cupboards", cupboards
    yield "kitchen_handles", handles
    yield "kitchen_plinth", plinth()
    yield "kitchen_worktop", worktop()
    yield "kitchen_tiles", tiles()
    yield "kitchen_floor_light", floor_tiles(0)
    yield "kitchen_floor_dark", floor_tiles(1)
    yield "kitchen_sink", sink()
    yield "kitchen_tap", tap()
    yield "kitchen_glass", glass
    yield "kitchen_steel", steel
    yield "kitchen_hob_rings", rings
    yield "kitchen_window", window()
    yield "kitchen_left_wall", left_wall()
    yield "kitchen_wood", woodwork()
    yield "kitchen_crockery", crockery()
    yield "kitchen_jars", jars()
    yield "kitchen_bottles", bottles()
    yield "kitchen_herb_pots", pots
    yield "kitchen_herbs", leaves


if __name__ == "__main__":
    write_meshes(meshes(), pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else SCENE_MESHES / "generated")
