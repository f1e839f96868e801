# SPDX-License-Identifier: GPL-3.0-or-later
"""Shapes with exact normals that the meshes of scenes/ are made of: turned, swept and faceted ones."""

import math

from mesh_writer import Mesh

SMALL_RADIUS = 0.025  # roundings that are too small in the picture to need many faces


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


def outline(segments, core):
    """(x, z, cosine, sine) of the corner arcs' centers and directions around a rectangle of half sizes `core`."""
    if core == (0.0, 0.0):
        return [(0.0, 0.0, c, s) for c, s in circle(segments)]
    result = []
    steps = segments // 4
    for quarter, (x, z) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        for i in range(steps + 1):
            angle = math.pi / 2 * (quarter + i / steps)
            result.append((x * core[0], z * core[1], math.cos(angle), math.sin(angle)))
    return result


def turned_ring(mesh, sample, around):
    radius, height, tangent_radius, tangent_height = sample
    return [
        mesh.add_vertex(
            (x + radius * c, height, z + radius * s), (tangent_height * c, -tangent_radius, tangent_height * s)
        )
        for x, z, c, s in around
    ]


def revolve(profile, segments, core=(0.0, 0.0)):
    """The profile (radius, height, tangent), from the axis to the axis, turned around the y axis; the outside
    is on its right. With a core the corners of a rectangle of these half sizes are turned around instead."""
    mesh = Mesh()
    rings = []
    for sample in profile:
        radius, height, tangent_radius, _ = sample
        if radius < 1e-9:
            up = -math.copysign(1.0, tangent_radius)
            rings.append([mesh.add_vertex((0.0, height, 0.0), (0.0, up, 0.0))])
        else:
            rings.append(turned_ring(mesh, sample, outline(segments, core)))
    join_rings(mesh, rings)
    return mesh


def revolve_loop(corners, segments, max_step=0.06, max_turn=math.radians(12)):
    """A ring around the y axis: a closed line of rounded corners (radius, height, rounding), the outside on its
    right, is turned. It begins on a straight part before its first corner."""
    (x0, y0, _), (x1, y1, _) = corners[-1], corners[0]
    begin = (0.5 * (x0 + x1), 0.5 * (y0 + y1))
    samples = rounded_path([begin, *corners, begin], max_step, max_turn)[:-1]
    mesh = Mesh()
    rings = [turned_ring(mesh, sample, outline(segments, (0.0, 0.0))) for sample in samples]
    join_rings(mesh, [*rings, rings[0]])
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


def turned_profile(corners, max_step=0.06, max_turn=math.radians(12)):
    return rounded_path(corners, max_step, max_turn)


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


def sphere(radius, around, across):
    """With poles on the y axis."""
    mesh = Mesh()
    rings = [[mesh.add_vertex((0.0, -radius, 0.0), (0.0, -1.0, 0.0))]]
    for i in range(1, across):
        angle = math.pi * i / across
        r, y = math.sin(angle), -math.cos(angle)
        normals = [(r * c, y, r * s) for c, s in circle(around)]
        rings.append([mesh.add_vertex(tuple(radius * x for x in normal), normal) for normal in normals])
    rings.append([mesh.add_vertex((0.0, radius, 0.0), (0.0, 1.0, 0.0))])
    join_rings(mesh, rings)
    return mesh


def rod(corners, radius, segments, round_end=True, max_step=0.05, max_turn=math.radians(10)):
    """A tube along a line of rounded corners in the plane z = 0."""
    return sweep(rounded_path(corners, max_step, max_turn), radius, segments, round_end)


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def difference(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def unit(a):
    length = math.sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2])
    return (a[0] / length, a[1] / length, a[2] / length)


def faceted(rings, loop=False):
    """A solid of flat faces between consecutive rings of equally many points. It ends with the convex polygons of
    the first and the last ring, or with a loop joins them."""
    mesh = Mesh()

    def add_face(points):
        normal = (0.0, 0.0, 0.0)
        for a, b in zip(points[1:], points[2:]):
            area = cross(difference(a, points[0]), difference(b, points[0]))
            normal = (normal[0] + area[0], normal[1] + area[1], normal[2] + area[2])
        normal = unit(normal)
        mesh.faces.append(tuple(mesh.add_vertex(point, normal) for point in points))

    for lower, upper in zip(rings, rings[1:] + rings[:1] if loop else rings[1:]):
        for i, low in enumerate(lower):
            j = (i + 1) % len(lower)
            add_face((low, upper[i], upper[j], lower[j]))
    if not loop:
        add_face(rings[0])
        add_face(rings[-1][::-1])
    if mesh.volume() < 0.0:
        mesh.flip()
    return mesh


def rectangle_ring(low, high, z, inset=0.0):
    (x0, y0), (x1, y1) = low, high
    return [
        (x0 + inset, y0 + inset, z),
        (x1 - inset, y0 + inset, z),
        (x1 - inset, y1 - inset, z),
        (x0 + inset, y1 - inset, z),
    ]


def panel(width, height, steps):
    """Centred rectangles one above another along z, joined by flat faces: steps (inset, z) from the back."""
    low, high = (-0.5 * width, -0.5 * height), (0.5 * width, 0.5 * height)
    return faceted([rectangle_ring(low, high, z, inset) for inset, z in steps])


def box(low, high, chamfer):
    """A box whose edges along its front and back (z) are chamfered."""
    (x0, y0, z0), (x1, y1, z1) = low, high
    steps = ((chamfer, z0), (0.0, z0 + chamfer), (0.0, z1 - chamfer), (chamfer, z1))
    return faceted([rectangle_ring((x0, y0), (x1, y1), z, inset) for inset, z in steps])


def rectangular_frame(outer, inner, z0, z1, chamfer):
    """A slab from z0 to z1 between two rectangles ((x, y), (x, y)), chamfered at its front."""
    return faceted(
        [
            rectangle_ring(*outer, z0),
            rectangle_ring(*outer, z1 - chamfer),
            rectangle_ring(*outer, z1, chamfer),
            rectangle_ring(*inner, z1, -chamfer),
            rectangle_ring(*inner, z1 - chamfer),
            rectangle_ring(*inner, z0),
        ],
        loop=True,
    )


def spun(point, along, around):
    """A closed surface point(u, v) for u from 0 to 1 between two smooth poles and v around them, in turns. The
    normals are those of the surface, by central differences."""
    step = 1e-5
    mesh = Mesh()

    def normal(u, v):
        du = difference(point(u + step, v), point(u - step, v))
        dv = difference(point(u, v + step), point(u, v - step))
        return unit(cross(du, dv))

    def pole(u, near):
        normals = [normal(near, v) for v in (0.0, 0.25, 0.5, 0.75)]
        return [mesh.add_vertex(point(u, 0.0), unit(tuple(map(sum, zip(*normals)))))]

    rings = [pole(0.0, 2 * step)]
    for i in range(1, along):
        u = i / along
        rings.append([mesh.add_vertex(point(u, j / around), normal(u, j / around)) for j in range(around)])
    rings.append(pole(1.0, 1.0 - 2 * step))
    join_rings(mesh, rings)
    if mesh.volume() < 0.0:
        mesh.flip()
    return mesh


def ribbon(path, section):
    """A bar along a path (x, y, tangent) in the plane z = 0: its section is a closed line of samples (across, z,
    tangent), its outside on the right. Across points to the path's right. It ends with flat caps."""
    mesh = Mesh()

    def ring(sample, cap):
        x, y, tx, ty = sample
        result = []
        for across, z, ta, tz in section:
            side, up = (tz, -ta) if cap == 0.0 else (0.0, 0.0)
            normal = (side * ty + cap * tx, -side * tx + cap * ty, up)
            result.append(mesh.add_vertex((x + across * ty, y - across * tx, z), normal))
        return result

    rings = [ring(sample, 0.0) for sample in path]
    join_rings(mesh, rings)
    begin, end = ring(path[0], -1.0), ring(path[-1], 1.0)
    mesh.faces.append(tuple(begin))
    mesh.faces.append(tuple(reversed(end)))
    if mesh.volume() < 0.0:
        mesh.faces = [face[::-1] for face in mesh.faces]
    return mesh


def shell(point, thickness, columns, rows):
    """A plate whose outer side is point(u, v) for u and v from 0 to 1, its inner side `thickness` below. The outer
    side is on the right of u when v goes up."""
    step = 1e-5
    mesh = Mesh()

    def sample(i, j):
        u, v = i / columns, j / rows
        du = difference(point(u + step, v), point(u - step, v))
        dv = difference(point(u, v + step), point(u, v - step))
        return point(u, v), unit(cross(du, dv))

    outer = [[sample(i, j) for j in range(rows + 1)] for i in range(columns + 1)]

    def below(p, n):
        return tuple(p[k] - thickness * n[k] for k in range(3))

    def add_grid(depth, sign):
        grid = [
            [mesh.add_vertex(below(p, n) if depth else p, tuple(sign * c for c in n)) for p, n in column]
            for column in outer
        ]
        for a, b in zip(grid, grid[1:]):
            for j in range(rows):
                face = (a[j], b[j], b[j + 1], a[j + 1])
                mesh.faces.append(face if sign > 0.0 else face[::-1])

    add_grid(False, 1.0)
    add_grid(True, -1.0)
    border = [outer[i][0] for i in range(columns)] + [outer[columns][j] for j in range(rows)]
    border += [outer[columns - i][rows] for i in range(columns)] + [outer[0][rows - j] for j in range(rows)]
    for (p, n), (q, m) in zip(border, border[1:] + border[:1]):
        corners = (p, below(p, n), below(q, m), q)
        normal = unit(cross(difference(corners[1], p), difference(corners[3], p)))
        mesh.faces.append(tuple(mesh.add_vertex(corner, normal) for corner in corners))
    return mesh
