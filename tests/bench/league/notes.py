"""Sentences of the league's page: facts outside the tables, and reasons of results."""

import textwrap

COLUMNS = 100

ROWS = {
    "A2": """Two contacts that `adapted` misses count as 180° each and make most of its
        mean.""",
    "A4": """The same holds for the three that `adapted` misses here.""",
    "A5": """100 places all over the cup, inside and handle included, 0.5 mm deep at a voxel
        size of 1 mm; the truth is the direction to the nearest point. A ball that deep
        covers a cap of 3 mm radius, several facets of the cup: the exact sum of its depths
        points 1.0° off the nearest point in the mean. The accuracy page
        (`contact_accuracy.md`) asks other places, 1 mm deep at a voxel size of 2 mm, and
        its truth is the force law's integral over the tool: there `adapted` has 2.9°,
        `field` 0.61°.""",
    "B1t": """The convex hull of a plate fills its hole. So the sense in which a hull turns the
        tool in B1t to B3t has no meaning (Drake, MuJoCo, PyBullet).""",
    "B2t": """Triangles have no inside. A face of the cross meets the wall at 1.9° and is for its
        most part still in front of it: the shorter way out leads on through the wall, and Coal
        and FCL turn the cross farther in.""",
    "C2": """A hull, a triangle mesh and the virtual tool hold a plate of 0.2 mm at every
        speed here: the tool starts outside and follows by a spring.""",
    "C4": """120° round the side at 0.08 m/s, over all samples of the slide. The hand is inside the
        cup, whose wall is 5 mm thick; no system lets the tool through. The springs of MuJoCo and
        PyBullet need a damper (0.7 of critical, with a tool of 0.1 kg): it drags the tool, which
        moves faster than the hand, and makes most of their direction error. The spring of the
        virtual tool has no mass and no damper; facets of the ball's mesh, 642 points, make its
        direction error.""",
    "D2a": """The hand turns the nut and stays at its height; a spring pulls along the axis. The
        virtual tool turns too, but lags behind the hand (D2h).""",
    "D2h": """The hand does not turn. The play is 0.144 mm each way; a thread is skipped if
        the nut ends more than half a pitch away. In the virtual tool's simplified meshes about
        a thousand pairs of features touch at once, and a frame's limit of work suffices for a
        step. The tool comes to rest on the flanks within 20 frames and gives no force until
        then, which this figure takes for 12 mm; such frames count as not converged.""",
    "D2l": """The nut is pressed down on its flanks and may turn. Flanks of 60° lock from a
        friction of tan(lead angle) cos 30° = 0.0375 on. In MuJoCo it falls by its weight,
        and is locked if it turns by less than 1° in half a second. The mesh has 128 sides a
        turn: facets of 32 lock it by their own slope. The virtual tool has more pairs here
        than in D2h and does not turn.""",
    "C3": """The hand is `pen`. voxtouch starts only what it can certify or what the device
        can show; the other systems know neither and run. At 2,000 N/m none of them swings
        with this device.""",
    "D1": """The virtual tool's row is a `body`: its contact's stiffness follows from its
        mass, for a rest depth of 0.1 mm on a sixth of a surface. A fifth of the
        cube's face lies in voxels along its edges, whose points lie above it and do not
        push: it sinks by 0.1 mm / 0.81. On other grids they push for two faces: the block
        of `block.yaml` sinks by 0.08 mm.""",
    "D2p": """Torque is a ratio to p/2π times the force. `adapted` pushes all points along
        their mean normal, which is the bolt's axis, so it shows none.""",
}

SYSTEMS = {
    "voxtouch": """`adapted` and `original` give depths by voxel layers: within a voxel of a
        surface they touch, so they touch in all free poses of B and D2f. `field` is sampled
        at points of the tool: an edge that crosses an edge passes between two points (E1),
        and a foil thinner than a voxel has no inside (E2). The virtual tool touches with the
        triangles of its mesh: facets of a ball turn its direction by up to half their angle
        (C4), and on a thread it lags (D2h).""",
    "Coal": """Exact for a ball, which is a distance to a point. Two meshes give a contact
        for each pair of triangles that meet; their sum by depth is this league's, and deep
        overlaps (E3) and edges (E1, B3p) have pairs that point sideways, or out by the far side
        (B2t).""",
    "Drake": """Its documentation: in point contact a mesh is its convex hull. Inside a cup,
        a hole or a nut the hull is full (A5, B, D2). Hydroelastic contact sums pressures
        over the facets of both meshes at a resolution of 2 mm, so its error shrinks with
        the triangles of the cylinder.""",
    "trimesh": """The nearest point on all triangles, so it is exact, in Python and NumPy. It has
        no contacts of two meshes, so it plays the rows of balls only.""",
    "FCL": """As Coal, and a ball too is met triangle by triangle (A2 to A5): the error
        shrinks with the triangles.""",
    "MuJoCo": """Its documentation: a mesh is its convex hull (A5, B, D2), and contacts are
        soft by default (0.908 of k d in C1, 0.71 at 2,000 N/m in C4, 0.85 in E1s). `MuJoCo
        stiff` sets solref and solimp nearly rigid. `MuJoCo SDF` looks for the deepest points
        from 40 starts in distances that are interpolated in an octree: inner corners are
        rounded by less than 0.1 mm (B2f, B3f), and the points that are found need not be
        symmetric (B, E1, E3): the torque in B1t is up to 20° off.""",
    "PyBullet": """A mesh is its convex hull, grown by a margin of 1 mm: 1.099 of k d in C1
        is (10 + 1) mm over 10 mm, 1.111 in E3s (18 + 2) mm over 18 mm, 1.663 in E1s (3 + 2) mm
        over 3 mm. `PyBullet concave` keeps the triangles of what rests, for which Bullet has a
        flag; what moves stays a hull with its margin. So a pin touches in its hole (B1f: 0.9 mm
        deep), and cross, gear and nut are filled (B2, B3, D2).""",
}


def paragraph(text):
    return textwrap.wrap(
        " ".join(text.split()), COLUMNS, break_long_words=False, break_on_hyphens=False
    ) + [""]


def of_row(name):
    """Lines below a row's table; those of C2 to C4 below the last of their tables."""
    if name.startswith("C2"):
        return paragraph(ROWS["C2"]) if name == "C2 2 mm 1 m/s" else []
    if name.startswith("C4"):
        return paragraph(ROWS["C4"]) if name == "C4 cylinder 371 N/m" else []
    if name.startswith("C3"):
        return paragraph(ROWS["C3"]) if name == "C3 371 N/m" else []
    return paragraph(ROWS[name]) if name in ROWS else []


def of_systems():
    lines = ["## The systems", ""]
    for system, text in SYSTEMS.items():
        lines += paragraph(f"**{system}.** {text}")
    return lines
