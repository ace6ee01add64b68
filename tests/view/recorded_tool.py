"""How deep the tool of a recording was in the walls of its scene, from the poses in its
ContactState and from the mesh files. It uses no code of the contact query and none of the
validator.
"""

import numpy

SEEN_M = 1e-9  # two triangles' rounding


def read_obj(path, scale=1.0):
    """Vertices [m] and triangles of an OBJ file whose faces are triangles."""
    vertices, triangles = [], []
    for line in path.read_text().splitlines():
        kind, *words = line.split() or [""]
        if kind == "v":
            vertices.append([scale * float(word) for word in words])
        elif kind == "f":
            triangles.append([int(word.split("/")[0]) - 1 for word in words])
    return numpy.array(vertices), numpy.array(triangles)


def unit(vectors):
    return vectors / numpy.maximum(norm(vectors), 1e-30)[..., None]


def norm(vectors):
    return numpy.sqrt((vectors * vectors).sum(-1))


def rotated_back(quaternions, vectors):
    """`vectors` in the frames of `quaternions` (x, y, z, w)."""
    axis, w = -quaternions[:, None, :3], quaternions[:, None, 3:]
    turned = numpy.cross(axis, vectors)
    return vectors + 2 * w * turned + 2 * numpy.cross(axis, turned)


def nearest_points(a, b, c):
    """The points of the triangles a, b, c nearest to the origin."""
    ab, ac = b - a, c - a
    dot = lambda u, v: (u * v).sum(-1)
    best, least = a.copy(), dot(a, a)

    def offer(points, valid):
        squares = numpy.where(valid, dot(points, points), numpy.inf)
        better = squares < least
        best[better], least[better] = points[better], squares[better]

    for start, edge in ((a, ab), (a, ac), (b, c - b)):
        along = numpy.clip(-dot(start, edge) / numpy.maximum(dot(edge, edge), 1e-30), 0, 1)
        offer(start + along[..., None] * edge, True)
    normal = numpy.cross(ab, ac)
    square = numpy.maximum(dot(normal, normal), 1e-30)
    foot = (dot(a, normal) / square)[..., None] * normal
    v = dot(numpy.cross(foot - a, ac), normal) / square
    w = dot(numpy.cross(ab, foot - a), normal) / square
    offer(foot, (v >= 0) & (w >= 0) & (v + w <= 1))
    return best


class ConvexTool:
    """A convex closed mesh that contains its origin."""

    def __init__(self, vertices, triangles):
        a, b, c = (vertices[triangles[:, n]] for n in range(3))
        self.vertices = vertices
        self.normals = unit(numpy.cross(b - a, c - a))
        self.heights = (self.normals * a).sum(-1)
        assert self.heights.min() > 0 and self.hull_error() < SEEN_M, "the tool is not convex"
        self.outer = float(norm(vertices).max())
        edges = numpy.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]]])
        edges = numpy.unique(numpy.sort(edges, -1), axis=0)
        self.edge_middles = unit(vertices[edges].mean(1))
        self.edges = vertices[edges[:, 1]] - vertices[edges[:, 0]]

    def hull_error(self):
        return float((self.vertices @ self.normals.T - self.heights).max())

    def overlaps(self, axes, corners):
        """How far tool and triangles overlap along each axis, n x k; `axes`: n x k x 3."""
        support = (axes @ self.vertices.T).max(-1)
        return support - numpy.einsum("nkx,ncx->nkc", axes, corners).min(-1)

    def depths(self, corners):
        """How far n triangles, in the tool's frame, are in the tool [m]: the least overlap of all
        axes that can separate two convex bodies. Below 0: apart.
        """
        a, b, c = (corners[:, n] for n in range(3))
        toward = unit(nearest_points(a, b, c))
        plane = unit(numpy.cross(b - a, c - a))
        plane *= numpy.where((plane * a).sum(-1) < 0, -1.0, 1.0)[:, None]
        depths = self.overlaps(numpy.stack([toward, plane], 1), corners).min(-1)
        rest = numpy.flatnonzero(depths > -SEEN_M)
        if len(rest):
            ahead = (self.normals @ corners[rest].transpose(0, 2, 1)).min(-1)
            depths[rest] = numpy.minimum(depths[rest], (self.heights - ahead).min(-1))
        for n in rest[depths[rest] > -SEEN_M]:
            near = self.edge_middles @ toward[n] > 0.9
            sides = numpy.stack([b[n] - a[n], c[n] - b[n], a[n] - c[n]])
            axes = numpy.cross(sides[:, None], self.edges[near][None]).reshape(-1, 3)
            axes = unit(axes[norm(axes) > 1e-12])
            axes *= numpy.where(axes @ toward[n] < 0, -1.0, 1.0)[:, None]
            depths[n] = min(depths[n], self.overlaps(axes[None], corners[n : n + 1]).min())
        return depths


def deepest(tool, walls, positions, orientations, at_once=400):
    """Depth of the tool in the walls [m] at each pose, at most `tool.outer`; -inf: not near them.
    `walls`: n x 3 corners x 3.
    """
    middles = walls.mean(1)
    radii = norm(walls - middles[:, None]).max(-1)
    depths = numpy.full(len(positions), -numpy.inf)
    for begin in range(0, len(positions), at_once):
        poses = slice(begin, begin + at_once)
        low, high = positions[poses].min(0), positions[poses].max(0)
        outside = norm(numpy.maximum(numpy.maximum(low - middles, middles - high), 0))
        close = numpy.flatnonzero(outside < tool.outer + radii)
        apart = norm(positions[poses][:, None] - middles[close][None])
        pose, wall = numpy.nonzero(apart < tool.outer + radii[close])
        corners = walls[close[wall]] - positions[poses][pose][:, None]
        inside = norm(nearest_points(*corners.transpose(1, 0, 2))) < tool.outer
        pose, corners = pose[inside], corners[inside]
        found = tool.depths(rotated_back(orientations[poses][pose], corners))
        numpy.maximum.at(depths, begin + pose, found)
    return depths
