#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the meshes of scenes/crown.xml, one for each material: an imperial crown of a jewelled band, lilies, two
halves of a mitre, a high arch and an orb with a cross.

    python3 tools/make_crown.py            # into scenes/meshes/generated
    python3 tools/make_crown.py FOLDER     # elsewhere

The build runs it (target scene_meshes). The crown stands on y = 0 around the y axis, its front towards +z, and its
band has the radius 1.
"""

import math
import pathlib
import sys
from collections import defaultdict

from mesh_shapes import (
    cross,
    difference,
    faceted,
    revolve,
    revolve_loop,
    ribbon,
    rounded_path,
    shell,
    sphere,
    spun,
    turned_profile,
    unit,
)
from mesh_writer import SCENE_MESHES, Mesh, frame, rotation, scaling, translation, write_meshes

BAND = 0.43  # height
SIDES = 8  # lilies, and large stones on the band
MITRE = (0.93, 0.95)  # half axes of the dome, across and up
MITRE_BASE = 0.40
CLEFT = 0.24  # half the distance of the mitre's halves
ARCH = (0.985, 1.10, 0.55)  # half axes, along z and up, and the height of their centre
ARCH_WIDTH = 0.17
ARCH_THICKNESS = 0.05

PEARL = sphere(1.0, 16, 10)
CABOCHON = sphere(1.0, 28, 16)


def band_radius(y):
    """Of the band and of the lilies, which lean outwards."""
    above = max(0.0, y - BAND)
    return 1.005 + 0.06 * y + 0.14 * above * above


def bent(s, y, z):
    """From a plane laid on the front of the band: s to the right, y up, z outwards."""
    radius = band_radius(y) + z
    return (radius * math.sin(s), y, radius * math.cos(s))


def on_band(angle, y, z=0.0):
    """The frame of a thing on the band, its z outwards, `angle` degrees from the front."""
    lean = (band_radius(y + 1e-4) - band_radius(y - 1e-4)) / 2e-4
    length = math.hypot(1.0, lean)
    radius = band_radius(y) + z / length
    place = frame((1, 0, 0), (0, 1 / length, lean / length), (0, -lean / length, 1 / length), (0, y, radius))
    return [place, rotation("y", angle)]


def on_arch(angle, across, out):
    """The frame of a thing on the arch, its z away from the arch, `angle` degrees from the front's foot."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    along, up = -ARCH[0] * s, ARCH[1] * c
    length = math.hypot(along, up)
    along, up = along / length, up / length
    z, y = ARCH[0] * c, ARCH[2] + ARCH[1] * s
    return [frame((1, 0, 0), (0, up, along), (0, -along, up), (across, y - out * along, z + out * up))]


def leaf(bottom, top, width, thickness, tip=0.22):
    """A petal along y that swells in its middle and has a midrib."""

    def point(u, v):
        swell = math.sin(math.pi * u)
        shape = swell * (tip + (1.0 - tip) * swell * swell)
        y = bottom + (top - bottom) * 0.5 * (1.0 - math.cos(math.pi * u))
        a = 2 * math.pi * v
        rib = math.exp(-((math.cos(a) / 0.22) ** 2))
        return bent(width * shape * math.cos(a), y, thickness * shape * math.sin(a) * (0.72 + 0.28 * rib))

    return point


def curl(center, radii, angles, width, thickness, place):
    """A petal along a spiral around `center`, from one radius and angle [degrees] to another."""

    def point(u, v):
        t = 0.5 * (1.0 - math.cos(math.pi * u))
        angle = math.radians(angles[0] + (angles[1] - angles[0]) * t)
        r = radii[0] + (radii[1] - radii[0]) * t ** 0.8 if t > 0.0 else radii[0]
        swell = math.sin(math.pi * u)
        size = swell * (0.45 + 0.55 * math.sin(math.pi * min(1.0, max(0.0, 0.1 + 0.75 * t))))
        a = 2 * math.pi * v
        r += width * size * math.cos(a)
        return place(
            center[0] + r * math.cos(angle), center[1] + r * math.sin(angle), thickness * size * math.sin(a)
        )

    return point


def bezel(radius, height, wire):
    """A ring that holds a stone on the plane z = 0."""
    ring = revolve_loop(
        [
            (radius - wire, -0.02, 0.3 * wire),
            (radius + 1.6 * wire, -0.02, 0.3 * wire),
            (radius + 1.6 * wire, 0.3 * height, 0.5 * wire),
            (radius + wire, height, 0.8 * wire),
            (radius - wire, height, 0.8 * wire),
        ],
        28,
        max_step=1.0,
        max_turn=math.radians(15),
    )
    mesh = Mesh()
    mesh.add(ring, rotation("x", 90.0))
    return mesh


def table_cut(width, height, depth):
    """A stone of an octagonal outline with a table, its front towards +z."""
    cut = 0.3

    def ring(scale, z):
        x, y = scale * width, scale * height
        corner = cut * scale * min(width, height)
        return [
            (sx * (x - (corner if first == sx * sy else 0.0)), sy * (y - (0.0 if first == sx * sy else corner)), z)
            for sx, sy in ((1, 1), (-1, 1), (-1, -1), (1, -1))
            for first in (-1, 1)
        ]

    return faceted([ring(0.8, -0.02), ring(1.0, 0.2 * depth), ring(0.93, 0.5 * depth), ring(0.62, depth)])


class Crown:
    """The parts of the crown, by material."""

    def __init__(self):
        self.parts = defaultdict(Mesh)

    def add(self, material, part, *transforms):
        self.parts[material].add(part, *transforms)

    def pearl(self, radius, *place):
        self.add("pearl", PEARL, scaling(radius), *place)

    def set_stone(self, material, width, height, *place):
        """A cabochon in its bezel on the frame's plane z = 0."""
        self.add(material, CABOCHON, scaling(width, height, 0.62 * min(width, height)), *place)
        ring = bezel(1.0, 0.3, 0.13)
        self.add("gold", ring, scaling(width, height, min(width, height)), *place)

    def set_table(self, material, width, height, *place):
        """A table-cut stone in a stepped frame."""
        depth = 0.55 * min(width, height)
        self.add(material, table_cut(width, height, depth), *place)
        rim = 0.022
        steps = ((0.0, -0.02), (0.0, 0.4 * depth), (0.3 * rim, 0.6 * depth), (0.8 * rim, 0.6 * depth))
        outline = [(width + rim, height + rim, z, inset) for inset, z in steps]
        rings = []
        for x, y, z, inset in outline + [
            (width - 0.01, height - 0.01, 0.42 * depth, 0.0), (width - 0.01, height - 0.01, -0.02, 0.0)
        ]:
            x, y = x - inset, y - inset
            rings.append([(x, y, z), (-x, y, z), (-x, -y, z), (x, -y, z)])
        self.add("gold", faceted(rings, loop=True), *place)


def add_band(crown):
    """The band with its rims, two strings of pearls, stones and scrolls between them."""
    profile = [
        (0.95, 0.0, 0.015),
        (1.045, 0.0, 0.018),
        (1.045, 0.055, 0.015),
        (1.006, 0.062, 0.006),
        (1.026, BAND - 0.06, 0.006),
        (1.065, BAND - 0.052, 0.015),
        (1.065, BAND, 0.018),
        (0.97, BAND, 0.015),
    ]
    crown.add("gold", revolve_loop(profile, 160, max_step=0.2))
    count = 104
    for y in (0.092, BAND - 0.09):
        for i in range(count):
            crown.pearl(0.0285, *on_band(360.0 * (i + 0.5) / count, y, 0.014))
    scrolls = [
        spun(
            curl(
                (sx * 0.232, 0.215 + sy * 0.042),
                (0.062, 0.016),
                (90 - sx * 90 - sx * sy * 55, 90 - sx * 90 + sx * sy * 480),
                0.0095,
                0.011,
                bent,
            ),
            44,
            8,
        )
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    for side in range(SIDES):
        angle = 360.0 * side / SIDES
        if side % 2 == 0:
            crown.set_table("ruby" if side % 4 == 0 else "emerald", 0.098, 0.078, *on_band(angle, 0.215))
        else:
            crown.set_stone("sapphire", 0.098, 0.074, *on_band(angle, 0.215, 0.004))
        between = angle + 180.0 / SIDES
        crown.set_stone("diamond" if side % 2 else "emerald", 0.05, 0.05, *on_band(between, 0.215, 0.004))
        for offset in (-0.0706, 0.0706):
            crown.pearl(0.019, *on_band(between, 0.215 + offset, 0.012))
        for scroll in scrolls:
            crown.add("gold", scroll, rotation("y", angle))


def add_lily(crown, angle, is_front):
    """A fleur-de-lis of five petals with stones and pearls; that of the front is larger."""
    base = BAND - 0.02
    parts = []
    size = 1.12 if is_front else 1.0

    def place(s, y, z):
        return bent(size * s, base + size * y, size * z)

    parts.append(spun(leaf(base, base + size * 0.66, size * 0.155, size * 0.05), 36, 22))
    for side in (-1, 1):
        upper = (90 + side * 115, 90 - side * 250)
        parts.append(spun(curl((side * 0.195, 0.36), (0.2, 0.055), upper, 0.044, 0.042, place), 56, 14))
        lower = (180 - 35, 180 + 235) if side > 0 else (35, -235)
        parts.append(spun(curl((side * 0.145, 0.115), (0.135, 0.035), lower, 0.03, 0.034, place), 44, 12))
    turn = rotation("y", angle)
    for part in parts:
        crown.add("gold", part, turn)
    collar = base + size * 0.205

    def at(s, y, z):
        return [*on_band(math.degrees(size * s), base + size * y, size * z), turn]

    crown.add(
        "gold", sphere(1.0, 40, 20), scaling(size * 0.118, size * 0.036, size * 0.075), *on_band(0.0, collar, 0.0), turn
    )
    for side in (-1, 1):
        crown.pearl(size * 0.034, *at(side * 0.197, 0.36, 0.012))
        crown.pearl(size * 0.024, *at(side * 0.147, 0.113, 0.012))
    stone = ("ruby", "sapphire")[round(angle / 45.0) % 2]
    crown.set_stone(stone, size * 0.05, size * 0.075, *at(0.0, 0.385, 0.036))
    crown.set_stone("diamond", size * 0.03, size * 0.03, *at(0.0, 0.545, 0.026))
    crown.set_stone("emerald", size * 0.032, size * 0.032, *at(0.0, 0.095, 0.02))
    crown.pearl(size * 0.052, *at(0.0, 0.69, 0.0))


def add_finial(crown, angle):
    """A pearl in a cup between two lilies."""
    cup = revolve(
        turned_profile(
            [
                (0.0, -0.03),
                (0.06, -0.03, 0.01),
                (0.05, 0.02, 0.02),
                (0.02, 0.045, 0.02),
                (0.02, 0.085, 0.015),
                (0.052, 0.115, 0.02),
                (0.05, 0.138, 0.003),
                (0.0, 0.12),
            ],
            max_step=0.03,
        ),
        40,
    )
    place = on_band(angle, BAND, -0.03)
    crown.add("gold", cup, *place)
    crown.pearl(0.06, translation(0.0, 0.175, 0.0), *place)
    for side in (-1, 1):
        beside = on_band(angle + side * 4.6, BAND + 0.02, -0.03)
        crown.pearl(0.033, *beside)


def mitre_point(alpha, beta, out=0.0):
    """On the right half of the dome: alpha from its front over the top to its back, beta from the middle plane to the
    right, both in radians."""
    across, up = MITRE[0] + out, MITRE[1] + out
    rho = math.cos(beta)
    return (across * math.sin(beta), MITRE_BASE + up * rho * math.sin(alpha), across * rho * math.cos(alpha))


def on_mitre_frame(alpha, beta, out=0.0):
    """The frame of a thing on the dome, its z outwards and its y along alpha; both angles in degrees."""
    alpha, beta = math.radians(alpha), math.radians(beta)
    x, y, z = mitre_point(alpha, beta)
    outwards = unit((x / MITRE[0] ** 2, (y - MITRE_BASE) / MITRE[1] ** 2, z / MITRE[0] ** 2))
    right = unit(difference(mitre_point(alpha, beta + 1e-5), mitre_point(alpha, beta - 1e-5)))
    origin = (x + out * outwards[0], y + out * outwards[1], z + out * outwards[2])
    return frame(right, cross(outwards, right), outwards, origin)


def add_mitre(crown):
    """The two halves with their borders, pearls and scrolls, and the cap of velvet inside."""
    begin = math.asin(CLEFT / MITRE[0])
    end = math.radians(88.0)

    def half(u, v):
        return mitre_point(math.pi * v, begin + (end - begin) * u)

    plate = shell(half, 0.03, 24, 48)
    if plate.volume() < 0.0:
        plate.flip()

    def rim(u, v):
        t = 0.5 * (1.0 - math.cos(math.pi * u))
        size = 0.034 * math.sin(math.pi * u) ** 0.25 if 0.0 < u < 1.0 else 0.0
        a = 2 * math.pi * v
        return mitre_point(math.pi * (1.02 * t - 0.01), begin + size * math.cos(a), 0.9 * size * math.sin(a))

    border = spun(rim, 120, 12)

    def on_mitre(alpha, beta):
        """Lays a small plane on the dome."""
        return lambda s, y, z: mitre_point(
            math.radians(alpha) + y / (MITRE[0] * math.cos(math.radians(beta))), math.radians(beta) + s / MITRE[0], z
        )

    scrolls = []
    for alpha in range(18, 180, 24):
        place = on_mitre(alpha, 38.0)
        for turn in (-1, 1):
            angles = (180.0 + turn * 20.0, 180.0 - turn * 500.0)
            scrolls.append(spun(curl((0.0, turn * 0.075), (0.075, 0.018), angles, 0.014, 0.016, place), 48, 8))
        place = on_mitre(alpha + 12, 56.0)
        for turn in (-1, 1):
            angles = (0.0 + turn * 20.0, 0.0 - turn * 460.0)
            scrolls.append(spun(curl((0.0, turn * 0.06), (0.06, 0.016), angles, 0.012, 0.014, place), 44, 8))
    for mirror in (1, -1):
        flip = scaling(mirror, 1, 1)
        for part in (plate, border, *scrolls):
            crown.add("gold", part, flip)
        count = 50
        for i in range(count):
            x, y, z = mitre_point(math.radians(8.0 + 164.0 * i / (count - 1)), begin + 0.075, 0.008)
            crown.pearl(0.026, translation(x, y, z), flip)
        for i, alpha in enumerate(range(24, 160, 22)):
            stone = ("ruby", "emerald", "sapphire")[i % 3]
            crown.set_stone(stone, 0.034, 0.046, on_mitre_frame(alpha, 27.0, 0.004), flip)
            for offset in (-5.0, 5.0):
                crown.pearl(0.015, on_mitre_frame(alpha + offset, 27.0, 0.008), flip)
    dome = revolve(
        turned_profile(
            [(0.0, 0.06), (0.9, 0.06, 0.04), (0.885, 1.3, 0.86), (0.0, 1.305)], max_step=0.05, max_turn=math.radians(5)
        ),
        96,
    )
    crown.add("velvet", dome)


def add_arch(crown):
    """The arch from the front lily to the back one, with pearls along its edges and a row of stones."""
    steps = 96
    path = []
    for i in range(steps + 1):
        angle = math.pi * i / steps
        tx, ty = -ARCH[0] * math.sin(angle), ARCH[1] * math.cos(angle)
        length = math.hypot(tx, ty)
        path.append((ARCH[0] * math.cos(angle), ARCH[2] + ARCH[1] * math.sin(angle), tx / length, ty / length))
    t, w = 0.5 * ARCH_THICKNESS, 0.5 * ARCH_WIDTH
    corners = [(-t, -w, 0.016), (t, -w, 0.016), (t, w, 0.016), (-t, w, 0.016)]
    section = rounded_path([(-t, 0.0), *corners, (-t, 0.0)], 0.2, math.radians(12))[:-1]
    crown.add("gold", ribbon(path, section), frame((0, 0, 1), (0, 1, 0), (-1, 0, 0), (0, 0, 0)))
    count = 54
    for i in range(count):
        angle = 4.0 + 172.0 * i / (count - 1)
        for side in (-1, 1):
            crown.pearl(0.027, *on_arch(angle, side * (w - 0.004), t + 0.008))
    for i, angle in enumerate(range(21, 160, 12)):
        if angle == 93:  # under the foot of the orb
            continue
        material = ("ruby", "diamond", "sapphire", "diamond")[i % 4]
        width = 0.034 if material == "diamond" else 0.042
        crown.set_stone(material, width, 1.25 * width, *on_arch(angle, 0.0, t + 0.002))


def add_top(crown):
    """A foot, a sapphire as the orb and the cross above it."""
    top = ARCH[2] + ARCH[1] + 0.5 * ARCH_THICKNESS
    foot = [
        (0.0, -0.03),
        (0.125, -0.03, 0.01),
        (0.12, 0.02, 0.015),
        (0.06, 0.05, 0.02),
        (0.075, 0.085, 0.02),
        (0.09, 0.10, 0.004),
        (0.0, 0.09),
    ]
    crown.add("gold", revolve(turned_profile(foot, max_step=0.03), 56), translation(0.0, top, 0.0))
    center = top + 0.215
    crown.add("sapphire", sphere(1.0, 64, 36), scaling(0.145, 0.155, 0.145), translation(0.0, center, 0.0))
    belt = revolve_loop(
        [(0.135, -0.022, 0.006), (0.156, -0.022, 0.006), (0.156, 0.022, 0.006), (0.135, 0.022, 0.006)], 72
    )
    crown.add("gold", belt, rotation("y", 2.5), translation(0.0, center, 0.0))  # shares no vertex with the next
    crown.add("gold", belt, rotation("z", 90.0), scaling(1.0, 1.068, 1.0), translation(0.0, center, 0.0))
    for i in range(14):
        if i % 7:
            x, z = 0.157 * math.sin(2 * math.pi * i / 14), 0.157 * math.cos(2 * math.pi * i / 14)
            crown.pearl(0.016, translation(x, center, z))
    cap = [
        (0.0, -0.02), (0.06, -0.02, 0.01), (0.05, 0.01, 0.01), (0.024, 0.03, 0.01), (0.024, 0.055, 0.002), (0.0, 0.056)
    ]
    crown.add("gold", revolve(turned_profile(cap, max_step=0.03), 40), translation(0.0, center + 0.155, 0.0))
    middle = center + 0.155 + 0.25

    def arm(length):
        def ring(inset, z):
            near, far = 0.028 - 0.5 * inset, 0.088 - inset
            return [(near, 0.004, z), (far, length - inset, z), (-far, length - inset, z), (-near, 0.004, z)]

        return faceted([ring(0.012, -0.03), ring(0.0, -0.018), ring(0.0, 0.018), ring(0.012, 0.03)])

    for turn in range(4):
        place = [rotation("z", 90.0 * turn), translation(0.0, middle, 0.0)]
        length = 0.215 if turn == 2 else 0.185
        crown.add("gold", arm(length), *place)
        for face in (1, -1):
            crown.set_stone(
                "ruby", 0.024, 0.034, translation(0.0, 0.112, 0.03), rotation("y", 0.0 if face > 0 else 180.0), *place
            )
        if turn != 2:
            crown.pearl(0.034, translation(0.0, length + 0.022, 0.0), *place)
            for side in (-1, 1):
                crown.pearl(0.02, translation(side * 0.074, length + 0.012, 0.0), *place)
    for face in (0.0, 180.0):
        crown.set_stone(
            "diamond", 0.044, 0.044, translation(0.0, 0.0, 0.028), rotation("y", face), translation(0.0, middle, 0.0)
        )


def meshes():
    crown = Crown()
    add_band(crown)
    for side in range(SIDES):
        angle = 360.0 * side / SIDES
        add_lily(crown, angle, side == 0)
        add_finial(crown, angle + 180.0 / SIDES)
    add_mitre(crown)
    add_arch(crown)
    add_top(crown)
    for material, mesh in sorted(crown.parts.items()):
        yield f"crown_{material}", mesh
    plate = [(0.0, -0.09), (3.75, -0.09, 0.02), (3.8, 0.0, 0.03), (0.0, 0.0)]
    yield "crown_plate", revolve(turned_profile(plate, max_step=0.6), 160)


if __name__ == "__main__":
    write_meshes(meshes(), pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else SCENE_MESHES / "generated")
