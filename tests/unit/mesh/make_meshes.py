#!/usr/bin/env python3
"""Writes the meshes of the shipped scenes.

All are closed, two triangles at every edge, counter-clockwise seen from outside. OBJ in metres; STL
in millimetres, as most tools export it (a scene reads those with scale: 0.001). Same input, same
bytes: no random numbers, no dates.

  plane.obj         slab 0.24 x 0.24 x 0.02 m, top face z = 0, centred in x and y
  tilted_plane.obj  the same slab, rotated 20 degrees about x, then 25 degrees about y, in its
                    vertices
  block.obj         block 0.04 x 0.04 x 0.03 m about the origin
  cylinder.obj      radius 0.04 m, length 0.2 m, axis y through the origin, 96 sides
  sphere.obj        radius 1, for a scene's scale; icosahedron halved three times, 1280 triangles,
                    corners on the sphere
  cup.obj           coffee cup: radius 40 mm, height 90 mm, axis z, base at z = 0, handle on the +x
                    side
  cup_mm.stl        the same cup, binary, millimetres
  sphere_mm.stl     radius 10 mm, binary, millimetres
"""

import argparse
import math
import struct
import sys
from pathlib import Path


class Mesh:
    """Vertices (tuples of three) and triangles (tuples of three indices)."""

    def __init__(self):
        self.vertices = []
        self.triangles = []

    def add(self, x, y, z):
        self.vertices.append((x, y, z))
        return len(self.vertices) - 1

    def quad(self, a, b, c, d):
        """Corners counter-clockwise, cut along the shorter diagonal (the first, if they are equal
        to a part in 1e9).
        """
        p = self.vertices
        if math.dist(p[a], p[c]) <= math.dist(p[b], p[d]) * (1 + 1e-9):
            self.triangles += [(a, b, c), (a, c, d)]
        else:
            self.triangles += [(a, b, d), (b, c, d)]

    def ring(self, lower, upper):
        """Quads between two closed loops of equally many vertices that run counter-clockwise seen
        from `upper`'s side.
        """
        n = len(lower)
        for i in range(n):
            self.quad(lower[i], lower[(i + 1) % n], upper[(i + 1) % n], upper[i])

    def fan(self, centre, loop):
        """Triangles from `centre` to a closed loop that runs counter-clockwise seen from
        outside.
        """
        n = len(loop)
        for i in range(n):
            self.triangles.append((centre, loop[i], loop[(i + 1) % n]))

    def mapped(self, function):
        result = Mesh()
        result.vertices = [function(v) for v in self.vertices]
        result.triangles = list(self.triangles)
        return result


# -------------------- plain bodies
def slab(size_x, size_y, thickness):
    mesh = Mesh()
    x, y = size_x / 2, size_y / 2
    low = [mesh.add(*p, -thickness) for p in ((-x, -y), (x, -y), (x, y), (-x, y))]
    top = [mesh.add(*p, 0.0) for p in ((-x, -y), (x, -y), (x, y), (-x, y))]
    mesh.ring(low, top)
    mesh.quad(*top)
    mesh.quad(*reversed(low))
    return mesh


def block(size_x, size_y, size_z):
    """About the origin."""
    return slab(size_x, size_y, size_z).mapped(lambda v: (v[0], v[1], v[2] + size_z / 2))


def turned(mesh, about_x, about_y):
    """Rotated about x first, then about y [rad]."""
    cx, sx, cy, sy = math.cos(about_x), math.sin(about_x), math.cos(about_y), math.sin(about_y)

    def turn(v):
        x, y, z = v[0], cx * v[1] - sx * v[2], sx * v[1] + cx * v[2]
        return (cy * x + sy * z, y, -sy * x + cy * z)

    return mesh.mapped(turn)


def cylinder(radius, length, sides):
    mesh = Mesh()
    # y, z, x in place of x, y, z: counter-clockwise about the axis stays counter-clockwise.
    angle = [2 * math.pi * i / sides for i in range(sides)]
    low = [mesh.add(radius * math.sin(a), -length / 2, radius * math.cos(a)) for a in angle]
    top = [mesh.add(radius * math.sin(a), length / 2, radius * math.cos(a)) for a in angle]
    mesh.ring(low, top)
    mesh.fan(mesh.add(0.0, length / 2, 0.0), top)
    mesh.fan(mesh.add(0.0, -length / 2, 0.0), low[::-1])
    return mesh


def sphere(radius, halvings):
    """Icosahedron whose edges are halved `halvings` times, every new corner moved out to the
    sphere.
    """
    mesh = Mesh()
    g = (1 + math.sqrt(5)) / 2

    def add(v):
        scale = radius / math.sqrt(sum(c * c for c in v))
        return mesh.add(*(scale * c for c in v))

    for a, b in ((1, g), (-1, g), (1, -g), (-1, -g)):
        add((0, a, b)), add((a, b, 0)), add((b, 0, a))
    corners = mesh.vertices
    edge = min(math.dist(corners[0], corners[k]) for k in range(1, 12)) * 1.01
    near = lambda i, j: math.dist(corners[i], corners[j]) < edge
    for i in range(12):
        for j in range(12):
            for k in range(12):
                if (
                    i < j
                    and i < k
                    and j != k
                    and near(i, j)
                    and near(j, k)
                    and near(k, i)
                    and outward(corners, i, j, k)
                ):
                    mesh.triangles.append((i, j, k))
    for _ in range(halvings):
        middle = {}

        def between(i, j):
            key = (min(i, j), max(i, j))
            if key not in middle:
                middle[key] = add(tuple(a + b for a, b in zip(mesh.vertices[i], mesh.vertices[j])))
            return middle[key]

        finer = []
        for i, j, k in mesh.triangles:
            a, b, c = between(i, j), between(j, k), between(k, i)
            finer += [(i, a, c), (a, j, b), (c, b, k), (a, b, c)]
        mesh.triangles = finer
    return mesh


def outward(v, i, j, k):
    """Is triangle (i, j, k) counter-clockwise seen from outside a body around the origin?"""
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = v[i], v[j], v[k]
    return ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx) > 0


# -------------------- cup
CUP_SIDES = 64  # round the axis; a side is 3.9 mm of the outer wall
CUP_RADIUS = 0.040
CUP_HEIGHT = 0.090
CUP_WALL = 0.005
CUP_BOTTOM = 0.006
CUP_CHAMFER = 0.002  # at the foot, and the fillet inside the bottom
WALL_ROWS = 25  # of quads on the outer wall; a row is 3.4 mm
PATCH_SIDES = 3  # columns cut out of the wall for each end of the handle: 11.8 mm
PATCH_ROWS = 3  # rows: 10.2 mm
LOWER_ROW = 5  # first row of the lower patch, counted from the foot
UPPER_ROW = 17  # first row of the upper patch
HANDLE_REACH = 0.026  # distance of the handle's centre line from the wall
HANDLE_STEPS = 24
HANDLE_HALF_WIDTH = 0.0055  # across, in y
HANDLE_HALF_DEPTH = 0.0050  # in the plane of the handle


def cup_profile():
    """(radius, z) from the middle of the base out, up the wall, over the rim and down to the middle
    of the floor; and the index at which the wall's WALL_ROWS + 1 points begin."""
    rim = CUP_WALL / 2
    top, floor = CUP_HEIGHT - rim, CUP_BOTTOM
    points = [(CUP_RADIUS * f, 0.0) for f in (0.35, 0.7)]
    points.append((CUP_RADIUS - CUP_CHAMFER, 0.0))
    start = len(points)
    points += [
        (CUP_RADIUS, CUP_CHAMFER + (top - CUP_CHAMFER) * i / WALL_ROWS)
        for i in range(WALL_ROWS + 1)
    ]
    for i in range(1, 6):  # half a circle over the rim
        a = math.pi * i / 6
        points.append((CUP_RADIUS - rim + rim * math.cos(a), top + rim * math.sin(a)))
    inner = CUP_RADIUS - CUP_WALL
    down = 7
    points += [(inner, top + (floor + CUP_CHAMFER - top) * i / down) for i in range(down + 1)]
    points.append((inner - CUP_CHAMFER, floor))
    points += [(inner * f, floor) for f in (0.7, 0.35)]
    return points, start


def patch_border(row, flip):
    """(row, side) of the border of a patch, counter-clockwise seen from outside the wall, beginning
    at the corner of least y and, with `flip`, of greatest z: there the handle arrives upside
    down."""
    low, high, r0, r1 = 0, PATCH_SIDES, row, row + PATCH_ROWS
    border = [(r0, s) for s in range(low, high)] + [(r, high) for r in range(r0, r1)]
    border += [(r1, s) for s in range(high, low, -1)] + [(r, low) for r in range(r1, r0, -1)]
    if not flip:
        return border
    # Mirrored in z, so that point i of both borders is point i of the handle's section; it is now
    # clockwise.
    return [(r0 + r1 - r, s) for r, s in border]


def in_patch(row, side):
    return 0 <= side < PATCH_SIDES and any(
        start <= row < start + PATCH_ROWS for start in (LOWER_ROW, UPPER_ROW)
    )


def handle_section(count_sides, count_rows):
    """(y, depth) of the handle's section, a rounded rectangle: one point for each of
    patch_border()'s, each in the direction that the border's point lies in."""
    half_s, half_r = count_sides / 2, count_rows / 2
    section = []
    for r, s in patch_border(0, False):
        a, b = (s - half_s) / half_s, (r - half_r) / half_r
        length = (a**4 + b**4) ** 0.25  # between a circle (2) and a rectangle (infinity)
        section.append((HANDLE_HALF_WIDTH * a / length, HANDLE_HALF_DEPTH * b / length))
    return section


def add_handle(mesh, wall):
    """Sweeps the section along half an ellipse in the plane y = 0 from the lower patch to the upper
    one. `wall[row][side]`.
    """
    lower = [wall[r][s % CUP_SIDES] for r, s in patch_border(LOWER_ROW, False)]
    upper = [wall[r][s % CUP_SIDES] for r, s in patch_border(UPPER_ROW, True)]
    z_of = lambda row: mesh.vertices[wall[row][0]][2]
    z_low = (z_of(LOWER_ROW) + z_of(LOWER_ROW + PATCH_ROWS)) / 2
    z_high = (z_of(UPPER_ROW) + z_of(UPPER_ROW + PATCH_ROWS)) / 2
    middle, half = (z_low + z_high) / 2, (z_high - z_low) / 2
    section = handle_section(PATCH_SIDES, PATCH_ROWS)
    borders = [
        [(mesh.vertices[v][1], mesh.vertices[v][2] - z_low) for v in lower],
        [(mesh.vertices[v][1], z_high - mesh.vertices[v][2]) for v in upper],
    ]

    previous = lower
    for step in range(1, HANDLE_STEPS):
        a = math.pi * step / HANDLE_STEPS
        x, z = CUP_RADIUS + HANDLE_REACH * math.sin(a), middle - half * math.cos(a)
        tx, tz = HANDLE_REACH * math.cos(a), half * math.sin(a)
        length = math.hypot(tx, tz)
        tx, tz = tx / length, tz / length
        # From the patch's outline to the section within a fifth of the path, and back.
        blend = min(1.0, 5 * min(step, HANDLE_STEPS - step) / HANDLE_STEPS)
        border = borders[0] if 2 * step < HANDLE_STEPS else borders[1]
        ring = []
        for (y0, d0), (y1, d1) in zip(border, section):
            y, d = y0 + blend * (y1 - y0), d0 + blend * (d1 - d0)
            ring.append(mesh.add(x - tz * d, y, z + tx * d))
        mesh.ring(previous, ring)
        previous = ring
    mesh.ring(previous, upper)


def cup():
    """Walls and floor are one solid of revolution; the handle is a tube between the borders of
    two patches omitted from the outer wall. The whole is one surface with one hole (genus 1)
    and without self-intersection."""
    mesh = Mesh()
    profile, start = cup_profile()
    # Side 0 begins half a patch before the x axis: the handle is symmetric in y.
    angle = [2 * math.pi * (s - PATCH_SIDES / 2) / CUP_SIDES for s in range(CUP_SIDES)]
    loops = [[mesh.add(r * math.cos(a), r * math.sin(a), z) for a in angle] for r, z in profile]
    wall = loops[start : start + WALL_ROWS + 1]
    for row in range(len(loops) - 1):
        for s in range(CUP_SIDES):
            if in_patch(row - start, s):
                continue
            t = (s + 1) % CUP_SIDES
            mesh.quad(loops[row][s], loops[row][t], loops[row + 1][t], loops[row + 1][s])
    mesh.fan(mesh.add(0.0, 0.0, profile[0][1]), loops[0][::-1])
    mesh.fan(mesh.add(0.0, 0.0, profile[-1][1]), loops[-1])
    add_handle(mesh, wall)
    return without_unused(mesh)


def without_unused(mesh):
    used = sorted({v for t in mesh.triangles for v in t})
    fresh = {v: k for k, v in enumerate(used)}
    result = Mesh()
    result.vertices = [mesh.vertices[v] for v in used]
    result.triangles = [tuple(fresh[v] for v in t) for t in mesh.triangles]
    return result


# -------------------- files
def number(value):
    """At most 9 significant digits, and nothing below a nanometre: keeps the last bit of a sine out
    of the file.
    """
    text = f"{round(value, 9):.9g}"
    return "0" if text == "-0" else text


def obj_bytes(mesh, comment):
    lines = ["# " + comment]
    lines += ["v " + " ".join(number(c) for c in v) for v in mesh.vertices]
    lines += ["f " + " ".join(str(k + 1) for k in t) for t in mesh.triangles]
    return ("\n".join(lines) + "\n").encode("ascii")


def stl_bytes(mesh, scale, comment):
    """Binary STL. Normals are left 0, as the format allows: readers take them from the corners."""
    data = [comment.encode("ascii").ljust(80), struct.pack("<I", len(mesh.triangles))]
    for t in mesh.triangles:
        corners = [float(number(c * scale)) for k in t for c in mesh.vertices[k]]
        data.append(struct.pack("<12fH", 0, 0, 0, *corners, 0))
    return b"".join(data)


def all_files():
    plane = slab(0.24, 0.24, 0.02)
    ball, coffee_cup = sphere(1.0, 3), cup()
    return {
        "plane.obj": obj_bytes(plane, "slab 0.24 x 0.24 x 0.02 m, top face z = 0"),
        "tilted_plane.obj": obj_bytes(
            turned(plane, math.radians(20), math.radians(25)),
            "slab 0.24 x 0.24 x 0.02 m, turned 20 deg about x, then 25 deg about y",
        ),
        "block.obj": obj_bytes(
            block(0.04, 0.04, 0.03), "block 0.04 x 0.04 x 0.03 m about the origin"
        ),
        "cylinder.obj": obj_bytes(
            cylinder(0.04, 0.2, 96), "cylinder, radius 0.04 m, length 0.2 m, axis y"
        ),
        "sphere.obj": obj_bytes(ball, "sphere, radius 1"),
        "cup.obj": obj_bytes(coffee_cup, "coffee cup, metres, axis z, base at z = 0, handle at +x"),
        "cup_mm.stl": stl_bytes(coffee_cup, 1000.0, "coffee cup, millimetres"),
        "sphere_mm.stl": stl_bytes(ball, 10.0, "sphere of radius 10 mm, millimetres"),
    }


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument(
        "--out",
        type=Path,
        default=Path(__file__).resolve().parents[3] / "deploy/meshes",
        help="folder to write to (default: deploy/meshes)",
    )
    parser.add_argument(
        "--check",
        action="store_true",
        help="write nothing; fail if a file is not what would be written",
    )
    options = parser.parse_args()
    differing = []
    for name, data in all_files().items():
        path = options.out / name
        if not options.check:
            options.out.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
            print(f"{name}: {len(data)} bytes")
        elif not path.is_file() or path.read_bytes() != data:
            differing.append(name)
    if differing:
        print(
            f"not as this script writes them: {', '.join(differing)}; run it without --check",
            file=sys.stderr,
        )
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
