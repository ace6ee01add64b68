"""Requirements of RViz and tf2 on the messages that they draw, checked for every message.

The rules are those of rviz_default_plugins (marker_common.cpp, marker_array_display.cpp,
markers/*.cpp, validate_floats) and tf2 (buffer_core.cpp), from knowledge and not compared with a
release. They use no namespace, id or frame of this project.
"""

import math

(
    ARROW,
    CUBE,
    SPHERE,
    CYLINDER,
    LINE_STRIP,
    LINE_LIST,
    CUBE_LIST,
    SPHERE_LIST,
    POINTS,
    TEXT,
    MESH,
    TRIANGLES,
) = range(12)
ADD, DELETE, DELETEALL = 0, 2, 3
OF_POINTS = (LINE_STRIP, LINE_LIST, CUBE_LIST, SPHERE_LIST, POINTS, TRIANGLES)


def seconds(stamp):
    return stamp.sec + 1e-9 * stamp.nanosec


def norm(q):
    return math.sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w)


def finite(*vectors):
    return all(
        math.isfinite(getattr(v, name))
        for v in vectors
        for name in ("x", "y", "z", "w", "r", "g", "b", "a")
        if hasattr(v, name)
    )


class Frames:
    """A tf2 buffer that stores names, parents and the newest pose, and tf2's warnings."""

    def __init__(self):
        self.of, self.errors = {}, []

    def take(self, message, fixed):
        for t in message.transforms:
            child, parent, place = t.child_frame_id, t.header.frame_id, t.transform
            stamp = seconds(t.header.stamp)
            known = self.of.get(child)
            for wrong, sentence in (
                (not child or not parent, "a frame without a name"),
                (child == parent, "its own parent"),
                (child.startswith("/"), "a name with a slash before it"),
                (not finite(place.translation, place.rotation), "not a number"),
                (abs(norm(place.rotation) - 1.0) > 1e-6, "a quaternion that is not of norm 1"),
                (known and known["parent"] != parent, "two parents"),
                (known and known["fixed"] != fixed, "both on /tf and on /tf_static"),
                (
                    known and not fixed and stamp <= known["stamp"],
                    "a stamp again, or an older one (TF_REPEATED_DATA)",
                ),
            ):
                if wrong:
                    self.errors.append(f"frame {child}: {sentence}")
            track = known["way"] if known else []
            track.append((stamp, (place.translation.x, place.translation.y, place.translation.z)))
            self.of[child] = {"parent": parent, "fixed": fixed, "stamp": stamp, "way": track}

    def reach(self, frame, root):
        """Whether tf2 can transform `frame` to `root`."""
        for _ in range(100):
            if frame == root:
                return True
            if frame not in self.of:
                return False
            frame = self.of[frame]["parent"]
        return False


class Markers:
    """A MarkerArray display: the displayed markers, and its errors."""

    def __init__(self):
        self.shown, self.errors, self.deleted, self.corners_sent = {}, [], [], []

    def take(self, message, now):
        self.shown = {
            key: (m, end) for key, (m, end) in self.shown.items() if end is None or end > now
        }
        keys = [(m.ns, m.id) for m in message.markers if m.action == ADD]
        if len(keys) != len(set(keys)):
            self.errors.append(f"one array adds a marker twice: {keys}")
        for m in message.markers:
            key = (m.ns, m.id)
            if m.action == DELETEALL:
                self.shown.clear()
            elif m.action == DELETE:
                if self.shown.pop(key, None):
                    self.deleted.append(key)
            elif m.action == ADD:
                self.errors += [f"marker {key}: {e}" for e in fault_of(m)]
                lifetime = seconds(m.lifetime)
                self.shown[key] = (m, now + lifetime if lifetime > 0 else None)
                if m.type == TRIANGLES:
                    self.corners_sent.append((now, len(m.points)))
            else:
                self.errors.append(f"marker {key}: action {m.action} does not exist")

    def of(self, name_space):
        return [m for (ns, _), (m, _) in sorted(self.shown.items()) if ns == name_space]


def fault_of(m):
    """Sentences on a marker that is added."""
    lifetime, count = seconds(m.lifetime), len(m.points)
    needs = {
        ARROW: "xy" if count else "xyz",
        LINE_STRIP: "x",
        LINE_LIST: "x",
        POINTS: "xy",
        TEXT: "z",
    }.get(m.type, "xyz")
    rules = (
        (
            not finite(m.pose.position, m.pose.orientation, m.scale, m.color, *m.points, *m.colors),
            "not a number",
        ),
        (abs(norm(m.pose.orientation) - 1.0) > 1e-6, "a quaternion that is not of norm 1"),
        (
            any(getattr(m.scale, axis) <= 0.0 for axis in needs),
            f"its scale is not above 0 in {needs}",
        ),
        (m.color.a <= 0.0 and not m.colors, "it cannot be seen: alpha is 0"),
        (
            not m.header.frame_id or m.header.frame_id.startswith("/"),
            "no frame, or one with a slash before it",
        ),
        (m.type not in range(12), f"type {m.type} does not exist"),
        (lifetime < 0.0, "a lifetime below 0"),
        (m.type in OF_POINTS and count == 0, "a list without points"),
        (m.type == TRIANGLES and count % 3 != 0, f"{count} corners are no triangles"),
        (m.type == LINE_LIST and count % 2 != 0, f"{count} ends are no lines"),
        (m.type == ARROW and count not in (0, 2), f"an arrow with {count} points"),
        (
            m.type == ARROW and count == 2 and m.points[0] == m.points[1],
            "an arrow without a direction",
        ),
        (
            m.type not in OF_POINTS and m.type != ARROW and count > 0,
            "points that nothing is made of",
        ),
        (
            len(m.colors) not in (0, count)
            and not (m.type == TRIANGLES and 3 * len(m.colors) == count),
            "as many colours as points, or none",
        ),
        (m.type == TEXT and not m.text, "a text without words"),
        (
            m.type == MESH and not m.mesh_resource.startswith(("package://", "http://")),
            f"'{m.mesh_resource}' is no file of another host",
        ),
        (m.type != MESH and bool(m.mesh_resource), "a mesh that is not drawn"),
    )
    return [sentence for broken, sentence in rules if broken]
