"""Exact nearest points on triangles, by testing all of them: the truth, independent of every
system."""

import numpy as np


def nearest_on(mesh, points):
    """Nearest point of the mesh for each point, and its distance."""
    corners = np.asarray(mesh[0], float)[np.array(mesh[1])]
    middle = corners.mean(axis=1)
    reach = np.linalg.norm(corners - middle[:, None], axis=2).max(axis=1)
    closest, distance = np.empty((len(points), 3)), np.empty(len(points))
    for i, p in enumerate(points):
        to_middle = np.linalg.norm(middle - p, axis=1)
        near = corners[to_middle - reach <= to_middle.min()]  # no other is as near as that middle
        q = on_triangles(p, near[:, 0], near[:, 1], near[:, 2])
        d = np.linalg.norm(q - p, axis=1)
        k = int(np.argmin(d))
        closest[i], distance[i] = q[k], d[k]
    return closest, distance


def on_triangles(p, a, b, c):
    """Nearest point to p on each triangle: on its plane if that is inside, else on the nearest
    edge.
    """
    normal = np.cross(b - a, c - a)
    squared = np.einsum("ij,ij->i", normal, normal)
    squared = np.where(squared > 0, squared, 1.0)
    on_plane = p - normal * (np.einsum("ij,ij->i", p - a, normal) / squared)[:, None]
    inside = np.ones(len(a), bool)
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= np.einsum("ij,ij->i", np.cross(v - u, on_plane - u), normal) >= 0
    edges = np.stack([on_segment(p, a, b), on_segment(p, b, c), on_segment(p, c, a)])
    best = np.argmin(np.linalg.norm(edges - p, axis=2), axis=0)
    return np.where(inside[:, None], on_plane, edges[best, np.arange(len(a))])


def on_segment(p, a, b):
    along = b - a
    squared = np.einsum("ij,ij->i", along, along)
    t = np.clip(np.einsum("ij,ij->i", p - a, along) / np.where(squared > 0, squared, 1.0), 0, 1)
    return a + t[:, None] * along
