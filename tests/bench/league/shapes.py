"""Meshes of the league, written as OBJ [m]. Each function gives (vertices, faces)."""

import numpy as np


def write_obj(path, vertices, faces):
    with open(path, "w", encoding="utf-8") as file:
        file.writelines(f"v {x:.12g} {y:.12g} {z:.12g}\n" for x, y, z in vertices)
        file.writelines("f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces)


def ball(radius, subdivisions=4):
    """An icosphere: 642 vertices at 3 subdivisions, 2562 at 4."""
    g = (1 + 5**0.5) / 2
    v = np.array(
        [
            (-1, g, 0),
            (1, g, 0),
            (-1, -g, 0),
            (1, -g, 0),
            (0, -1, g),
            (0, 1, g),
            (0, -1, -g),
            (0, 1, -g),
            (g, 0, -1),
            (g, 0, 1),
            (-g, 0, -1),
            (-g, 0, 1),
        ],
        float,
    )
    f = [
        (0, 11, 5),
        (0, 5, 1),
        (0, 1, 7),
        (0, 7, 10),
        (0, 10, 11),
        (1, 5, 9),
        (5, 11, 4),
        (11, 10, 2),
        (10, 7, 6),
        (7, 1, 8),
        (3, 9, 4),
        (3, 4, 2),
        (3, 2, 6),
        (3, 6, 8),
        (3, 8, 9),
        (4, 9, 5),
        (2, 4, 11),
        (6, 2, 10),
        (8, 6, 7),
        (9, 8, 1),
    ]
    v = list(v / np.linalg.norm(v[0]))
    for _ in range(subdivisions):
        middle, finer = {}, []

        def between(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                m = v[a] + v[b]
                v.append(m / np.linalg.norm(m))
                middle[key] = len(v) - 1
            return middle[key]

        for a, b, c in f:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            finer += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        f = finer
    return radius * np.array(v), f


def box(size, centre=(0, 0, 0)):
    h = 0.5 * np.asarray(size)
    v = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * h + centre
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return v, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def cylinder(radius, length, triangles):
    """Along y, closed. About `triangles` triangles, split evenly around and along."""
    around = max(32, int((triangles * np.pi * radius / length) ** 0.5))
    along = max(1, triangles // (2 * around))
    angle = 2 * np.pi * np.arange(around) / around
    rings = [
        np.stack([radius * np.sin(angle), np.full(around, y), radius * np.cos(angle)], 1)
        for y in np.linspace(-length / 2, length / 2, along + 1)
    ]
    v = list(np.concatenate(rings)) + [(0, -length / 2, 0), (0, length / 2, 0)]
    f, low, top = [], len(v) - 2, len(v) - 1
    for k in range(along):
        for i in range(around):
            a, b = k * around + i, k * around + (i + 1) % around
            f += [(a, b, a + around), (b, b + around, a + around)]
    for i in range(around):
        f.append((low, (i + 1) % around, i))
        f.append((top, along * around + i, along * around + (i + 1) % around))
    return np.array(v), f


def circle(radius, sides):
    angle = 2 * np.pi * np.arange(sides) / sides
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], 1)


def cross(arm, half_width):
    a, w = arm, half_width
    return np.array(
        [
            (a, -w),
            (a, w),
            (w, w),
            (w, a),
            (-w, a),
            (-w, w),
            (-a, w),
            (-a, -w),
            (-w, -w),
            (-w, -a),
            (w, -a),
            (w, -w),
        ]
    )


def gear(teeth, inner, outer):
    points = []
    for k in range(teeth):
        for part, radius in ((-0.25, inner), (-0.15, outer), (0.15, outer), (0.25, inner)):
            angle = 2 * np.pi * (k + part) / teeth
            points.append((radius * np.cos(angle), radius * np.sin(angle)))
    return np.array(points)


def grown(polygon, by):
    """The polygon with each edge moved outwards (counter-clockwise corners)."""
    before, after = np.roll(polygon, 1, 0), np.roll(polygon, -1, 0)

    def normal(a, b):
        d = (b - a) / np.linalg.norm(b - a, axis=1, keepdims=True)
        return np.stack([d[:, 1], -d[:, 0]], 1)

    n1, n2 = normal(before, polygon), normal(polygon, after)
    return polygon + by * (n1 + n2) / (1 + np.sum(n1 * n2, 1, keepdims=True))


def cut(polygon):
    """Ear clipping of a simple polygon, counter-clockwise."""
    left, out = list(range(len(polygon))), []

    def area(a, b, c):
        (x, y), (u, v), (s, t) = polygon[a], polygon[b], polygon[c]
        return (u - x) * (t - y) - (s - x) * (v - y)

    while len(left) > 3:
        for k in range(len(left)):
            a, b, c = left[k - 1], left[k], left[(k + 1) % len(left)]
            inside = any(
                min(area(a, b, p), area(b, c, p), area(c, a, p)) >= 0
                for p in left
                if p not in (a, b, c)
            )
            if area(a, b, c) > 0 and not inside:
                out.append((a, b, c))
                left.pop(k)
                break
        else:
            raise ValueError("the polygon crosses itself")
    return out + [tuple(left)]


def prism(polygon, low, high):
    n = len(polygon)
    v = np.concatenate([np.column_stack([polygon, np.full(n, z)]) for z in (low, high)])
    f = [(c, b, a) for a, b, c in cut(polygon)] + [
        (a + n, b + n, c + n) for a, b, c in cut(polygon)
    ]
    for i in range(n):
        j = (i + 1) % n
        f += [(i, j, j + n), (i, j + n, i + n)]
    return v, f


def plate_with_hole(polygon, half_width, low, high):
    """A square plate around the hole. Corners of square and hole are joined by angle, in
    two rings.
    """
    n = len(polygon)
    angle = np.arctan2(polygon[:, 1], polygon[:, 0])
    scale = half_width / np.maximum(np.abs(np.cos(angle)), np.abs(np.sin(angle)))
    outer = np.stack([scale * np.cos(angle), scale * np.sin(angle)], 1)
    rings = [(polygon, low), (outer, low), (outer, high), (polygon, high)]
    v = np.concatenate([np.column_stack([p, np.full(n, z)]) for p, z in rings])
    f = []
    for r in range(4):
        for i in range(n):
            j, s = (i + 1) % n, (r + 1) % 4
            f += [(r * n + i, r * n + j, s * n + j), (r * n + i, s * n + j, s * n + i)]
    return v, f


def wedge(half_width, height, length):
    """Roof with its edge along x at z = 0, faces at 45 degrees if height is half_width."""
    corners = np.array([(0.0, 0.0), (-half_width, -height), (half_width, -height)])  # y, z
    v = np.concatenate(
        [np.column_stack([np.full(3, x), corners]) for x in (-length / 2, length / 2)]
    )
    f = [(0, 2, 1), (3, 4, 5)]
    for i in range(3):
        j = (i + 1) % 3
        f += [(i, j, j + 3), (i, j + 3, i + 3)]
    return v, f


PITCH_M, MAJOR_M = 0.0025, 0.010  # M20
SIDES = 32  # facets per turn and rows per pitch: rows joined along the diagonal follow the helix


def thread_radius(phase, grown_m=0.0):
    """ISO profile: crest p/8, flanks of 30 degrees to the plane across, root p/4; phase [turns]."""
    depth = 0.625 * 3**0.5 / 2 * PITCH_M
    away = np.abs((phase + 0.5) % 1.0 - 0.5)  # from the middle of the crest
    down = np.clip((away - 1 / 16) / (5 / 16), 0, 1)
    return MAJOR_M + grown_m - depth * down


def threaded(low, high, sides, grown_m=0.0):
    """Grid of the threaded surface, n rows of sides vertices, rows PITCH_M / sides apart."""
    rows = np.arange(round(low / PITCH_M * sides), round(high / PITCH_M * sides) + 1)
    around = np.arange(sides)
    r = thread_radius((rows[:, None] - around[None, :]) / sides, grown_m)
    angle = 2 * np.pi * around / sides
    z = np.broadcast_to(rows[:, None] * PITCH_M / sides, r.shape)
    return np.stack([r * np.cos(angle), r * np.sin(angle), z], 2).reshape(-1, 3), len(rows)


def grid_faces(rows, sides, inwards):
    f = []
    for k in range(rows - 1):
        for i in range(sides):
            j = (i + 1) % sides
            a, b, c, d = k * sides + i, k * sides + j, (k + 1) * sides + j, (k + 1) * sides + i
            f += [(a, c, b), (a, d, c)] if inwards else [(a, b, c), (a, c, d)]
    return f


def bolt(length, sides=SIDES):
    v, rows = threaded(-length / 2, length / 2, sides)
    f, n = grid_faces(rows, sides, False), len(v)
    v = np.concatenate([v, [(0, 0, -length / 2), (0, 0, length / 2)]])
    for i in range(sides):
        j = (i + 1) % sides
        f += [(n, j, i), (n + 1, (rows - 1) * sides + i, (rows - 1) * sides + j)]
    return v, f


def nut(length, gap, sides=SIDES, outer_m=0.015):
    """The bolt's thread moved outwards by `gap`, in a cylinder."""
    v, rows = threaded(-length / 2, length / 2, sides, gap)
    f, n = grid_faces(rows, sides, True), len(v)
    angle = 2 * np.pi * np.arange(sides) / sides
    ring = np.stack([outer_m * np.cos(angle), outer_m * np.sin(angle)], 1)
    v = np.concatenate(
        [v] + [np.column_stack([ring, np.full(sides, z)]) for z in (-length / 2, length / 2)]
    )
    top = (rows - 1) * sides
    for i in range(sides):
        j = (i + 1) % sides
        a, b, c, d = n + i, n + j, n + sides + j, n + sides + i
        f += [(a, b, c), (a, c, d), (i, j, b), (i, b, a)]
        f += [(top + j, top + i, d), (top + j, d, c)]
    return v, f
