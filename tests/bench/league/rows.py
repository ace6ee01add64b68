"""The rows of the league: a static mesh, a tool, poses of the hand, and the expected result of each
pose.

Static rows: poses are independent, and the answer is a contact wrench. Path rows: poses are one
millisecond apart, and the answer is the wrench of a spring between hand and tool.
"""

import dataclasses
import itertools
import pathlib

import numpy as np
import shapes

SEED = 20261129
SPRING_N_PER_M = 500.0
SLIDE_DEPTH_M = 0.02
UP = np.array([0, 0, 1.0])
THREAD_GAP_M = 0.00025  # of the nut, along the radius
THREAD_PLAY_M = THREAD_GAP_M / 3**0.5  # along the axis, in each direction


@dataclasses.dataclass
class Row:
    name: str
    title: str
    static: tuple
    tool: tuple
    poses: np.ndarray  # n x 7: qw qx qy qz tx ty tz
    direction: (
        np.ndarray
    )  # n x 3, of the force (judge `torque`: of the torque); zero: no force is permitted
    path: bool = False
    spring_n_per_m: float = SPRING_N_PER_M  # of path rows
    ball_m: float = 0.0  # radius, if the tool is a ball
    depth_m: np.ndarray = None  # of the hand beyond the first touch
    voxel_m: float = 0.001
    judge: str = "direction"  # direction | torque | free | spring | hammer | advance
    window: np.ndarray = None  # samples evaluated by `spring`; default: the last 100
    facts: dict = dataclasses.field(default_factory=dict)


def poses_at(positions):
    return np.column_stack([np.tile([1.0, 0, 0, 0], (len(positions), 1)), positions])


def ball_row(name, title, static, points, normals, radius=0.01, depth=0.0005):
    normals = normals / np.linalg.norm(normals, axis=1, keepdims=True)
    return Row(
        name,
        title,
        static,
        shapes.ball(radius),
        poses_at(points + normals * (radius - depth)),
        normals,
        ball_m=radius,
        depth_m=np.full(len(points), depth),
    )


def outwards(centres, closest, distance):
    return (centres - closest) / distance[:, None]


def surface_places(mesh, count, random):
    """Random places on a mesh, uniform by area, at which a ball of 10 mm touches nothing else."""
    vertices, faces = np.asarray(mesh[0]), np.array(mesh[1])
    corner = vertices[faces]
    cross = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    area = np.linalg.norm(cross, axis=1)
    chosen = random.choice(len(faces), count, p=area / area.sum())
    u = random.random((count, 2))
    u[u.sum(1) > 1] = 1 - u[u.sum(1) > 1]
    c = corner[chosen]
    return (
        c[:, 0] + u[:, :1] * (c[:, 1] - c[:, 0]) + u[:, 1:] * (c[:, 2] - c[:, 0]),
        cross[chosen] / area[chosen][:, None],
    )


def read_obj(path, scale=1.0):
    vertices, faces = [], []
    for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines():
        words = line.split()
        if words and words[0] == "v":
            vertices.append([scale * float(x) for x in words[1:4]])
        if words and words[0] == "f":
            ids = [int(w.split("/")[0]) - 1 for w in words[1:]]
            faces += [(ids[0], ids[k], ids[k + 1]) for k in range(1, len(ids) - 1)]
    return np.array(vertices), faces


def rows_of_balls(deploy, nearest, expected):
    random = np.random.default_rng(SEED)
    plane = shapes.box((0.2, 0.2, 0.02), (0, 0, -0.01))
    xy = random.uniform(-0.06, 0.06, (100, 2))
    yield ball_row(
        "A1",
        "ball on a plane",
        plane,
        np.column_stack([xy, np.zeros(100)]),
        np.tile([0, 0, 1.0], (100, 1)),
    )
    for name, triangles in (("A2", 5_000), ("A3", 50_000), ("A4", 500_000)):
        angle, y = random.uniform(-1, 1, 100), random.uniform(-0.05, 0.05, 100)
        if not expected(name):
            continue
        normal = np.stack([np.sin(angle), np.zeros(100), np.cos(angle)], 1)
        mesh = shapes.cylinder(0.04, 0.2, triangles)
        row = ball_row(
            name,
            f"ball on a cylinder of {triangles} triangles",
            mesh,
            0.04 * normal + np.stack([np.zeros(100), y, np.zeros(100)], 1),
            normal,
        )
        row.direction = outwards(row.poses[:, 4:], *nearest(mesh, row.poses[:, 4:]))
        yield row
    if not expected("A5"):
        return
    cup = read_obj(deploy / "meshes" / "cup.obj")
    points, normals = surface_places(cup, 400, random)
    centres = points + normals * 0.0095
    closest, distance = nearest(cup, centres)
    kept = np.flatnonzero(np.abs(distance - 0.0095) < 1e-9)[:100]  # the ball touches there first
    row = ball_row("A5", "ball on the cup", cup, points[kept], normals[kept])
    row.direction = outwards(centres[kept], closest[kept], distance[kept])
    yield row


def rows_of_holes():
    random = np.random.default_rng(SEED + 1)
    clearance = 0.0002
    for name, title, polygon in (
        ("B1", "pin", shapes.circle(0.01, 64)),
        ("B2", "cross", shapes.cross(0.015, 0.004)),
        ("B3", "gear", shapes.gear(12, 0.010, 0.012)),
    ):
        static = shapes.plate_with_hole(shapes.grown(polygon, clearance), 0.03, -0.01, 0.01)
        tool = shapes.prism(polygon, -0.02, 0.02)
        radius, angle = 0.7 * clearance * random.random(60) ** 0.5, random.uniform(0, 2 * np.pi, 60)
        free = np.stack(
            [radius * np.cos(angle), radius * np.sin(angle), random.uniform(-0.004, 0.004, 60)], 1
        )
        yield Row(
            name + "f",
            f"{title} in its hole, 0.2 mm of clearance: free poses",
            static,
            tool,
            poses_at(free),
            np.zeros((60, 3)),
            voxel_m=0.0005,
            judge="free",
        )
        sides = np.arange(60) % 4 * (np.pi / 2)
        away = np.stack([np.cos(sides), np.sin(sides), np.zeros(60)], 1)
        pushed = away * (clearance + 0.0003) + np.stack([np.zeros(60), np.zeros(60), free[:, 2]], 1)
        yield Row(
            name + "p",
            f"{title} pushed 0.3 mm into its hole's wall along x or y",
            static,
            tool,
            poses_at(pushed),
            -away,
            voxel_m=0.0005,
            depth_m=np.full(60, 0.0003),
        )
        # The pin's end dips 0.3 mm into the wall; cross and gear rotate into it.
        axis = away if name == "B1" else np.outer(np.cos(sides).round() - np.sin(sides).round(), UP)
        angle = (clearance + 0.0003) / {"B1": 0.010, "B2": 0.015, "B3": 0.011}[name]
        yield Row(
            name + "t",
            f"{title} {'tilted' if name == 'B1' else 'turned'} 0.3 mm into its hole's wall",
            static,
            tool,
            np.column_stack(
                [
                    np.full(60, np.cos(angle / 2)),
                    np.sin(angle / 2) * axis,
                    np.zeros((60, 2)),
                    free[:, 2],
                ]
            ),
            -axis,
            voxel_m=0.0005,
            judge="torque",
        )


def straight(z_from, z_to, speed, hold_s, xy=(0.0013, 0.0007)):
    steps = int(round(abs(z_to - z_from) / speed * 1000))
    z = np.concatenate(
        [
            np.full(300, z_from),
            np.linspace(z_from, z_to, steps + 1),
            np.full(int(1000 * hold_s), z_to),
        ]
    )
    return poses_at(np.column_stack([np.tile(xy, (len(z), 1)), z]))


def rows_of_springs():
    block = shapes.box((0.2, 0.2, 0.04), (0, 0, -0.02))
    poses = straight(0.012, 0.0, 0.05, 0.4)
    yield Row(
        "C1",
        "pressed 10 mm into a block",
        block,
        shapes.ball(0.01),
        poses,
        np.tile([0, 0, 1.0], (len(poses), 1)),
        path=True,
        ball_m=0.01,
        voxel_m=0.002,
        judge="spring",
        depth_m=0.01 - poses[:, 6],
    )
    for thickness in (0.002, 0.0002):
        foil = shapes.box((0.2, 0.2, thickness), (0, 0, -thickness / 2))
        for speed in (0.02, 0.1, 0.3, 1.0):
            poses = straight(0.015, 0.0, speed, 0.2)
            yield Row(
                f"C2 {1e3 * thickness:g} mm {speed:g} m/s",
                f"plate of {1e3 * thickness:g} mm, hand thrown at {speed:g} m/s",
                foil,
                shapes.ball(0.01),
                poses,
                np.tile([0, 0, 1.0], (len(poses), 1)),
                path=True,
                ball_m=0.01,
                voxel_m=0.002,
                judge="spring",
                depth_m=0.01 - poses[:, 6],
            )


def slide(radius, depth, speed, z_from, z_to):
    """Path of a hand `depth` below the first touch of a ball of 10 mm on a cylinder about z, for
    120 degrees around its side away from +x; outside, in, around and out. Directions, and the
    samples that slide.
    """
    steps = int(round(np.radians(120) * (radius + 0.01) / speed * 1000))
    inside = radius + 0.01 - depth
    way_in = np.linspace(radius + 0.012, inside, int((depth + 0.002) / 0.05 * 1000))
    reach = np.concatenate([way_in, np.full(200 + steps, inside), way_in[::-1]])
    part = np.clip((np.arange(len(reach)) - len(way_in) - 200) / steps, 0, 1)
    angle = np.pi + np.radians(120) * (part - 0.5)
    normal = np.stack([np.cos(angle), np.sin(angle), np.zeros(len(angle))], 1)
    places = reach[:, None] * normal + np.outer(z_from + (z_to - z_from) * part, UP)
    return poses_at(places), normal, (part > 0) & (part < 1)


def rows_of_slides(deploy, expected):
    """C4: the hand is 20 mm deep: for the cup, with a wall of 5 mm, it is inside the cup."""
    if not expected("C4"):
        return
    v, f = shapes.cylinder(0.04, 0.2, 20_000)
    upright = (np.asarray(v)[:, [2, 0, 1]], f)
    cup = read_obj(deploy / "meshes" / "cup.obj")
    for title, mesh, low, high in (
        ("cylinder", upright, -0.02, 0.02),
        ("cup", cup, 0.025, 0.065),
    ):
        poses, normal, window = slide(0.04, SLIDE_DEPTH_M, 0.08, low, high)
        for spring in (371.0, 2000.0):
            yield Row(
                f"C4 {title} {spring:g} N/m",
                f"slide round the {title}, hand 20 mm deep, spring of {spring:g} N/m",
                mesh,
                shapes.ball(0.01),
                poses,
                normal,
                path=True,
                spring_n_per_m=spring,
                ball_m=0.01,
                voxel_m=0.002,
                judge="spring",
                window=window,
                depth_m=0.05 - np.hypot(poses[:, 4], poses[:, 5]),
            )


def rows_of_edges():
    """E: sharp edges that cross, a foil, boxes half through each other."""
    random = np.random.default_rng(SEED + 2)
    up = np.array([0, 0, 1.0])
    roof = shapes.wedge(0.01, 0.01, 0.06)
    turned = np.array([[0, 1, 0], [1, 0, 0], [0, 0, -1.0]])  # 180 degrees: edge along y, downwards
    tool = (np.asarray(roof[0]) @ turned.T, roof[1])
    at = np.column_stack([random.uniform(-0.01, 0.01, (60, 2)), np.full(60, -0.0003)])
    yield Row(
        "E1",
        "sharp edges crossed at right angles, 0.3 mm deep",
        roof,
        tool,
        poses_at(at),
        np.tile(up, (60, 1)),
        voxel_m=0.0005,
    )
    path = straight(0.003, -0.003, 0.03, 0.2)
    yield Row(
        "E1s",
        "edge pulled 3 mm across an edge by a spring",
        roof,
        tool,
        path,
        np.tile(up, (len(path), 1)),
        path=True,
        voxel_m=0.0005,
        judge="spring",
        depth_m=-path[:, 6],
    )
    foil = shapes.box((0.2, 0.2, 0.0002), (0, 0, -0.0001))
    xy = random.uniform(-0.05, 0.05, (60, 2))
    yield ball_row(
        "E2",
        "ball on a foil of 0.2 mm, 0.05 mm deep",
        foil,
        np.column_stack([xy, np.zeros(60)]),
        np.tile(up, (60, 1)),
        depth=0.00005,
    )
    cube = shapes.box((0.04, 0.04, 0.04), (0, 0, 0))
    at = np.column_stack([random.uniform(-0.005, 0.005, (60, 2)), np.full(60, 0.022)])
    yield Row(
        "E3",
        "cubes of 40 mm, 18 mm through each other",
        cube,
        cube,
        poses_at(at),
        np.tile(up, (60, 1)),
        voxel_m=0.002,
    )
    path = straight(0.042, 0.022, 0.1, 0.2)
    yield Row(
        "E3s",
        "cube pulled 18 mm into a cube by a spring",
        cube,
        cube,
        path,
        np.tile(up, (len(path), 1)),
        path=True,
        voxel_m=0.002,
        judge="spring",
        depth_m=0.04 - path[:, 6],
    )
    depth = np.arange(1, 39) * 0.0005
    yield Row(
        "E3d",
        "cubes of 40 mm, 0.5 to 19 mm through each other",
        cube,
        cube,
        poses_at(np.column_stack([np.full(38, 0.0013), np.full(38, 0.0007), 0.04 - depth])),
        np.tile(up, (38, 1)),
        voxel_m=0.002,
        depth_m=depth,
    )


def screwed(turns, up_m=0.0):
    """Poses of a nut at these angles, moved up by `up_m` in its play."""
    half = np.pi * np.asarray(turns)
    zero = np.zeros(len(half))
    z = np.asarray(turns) * shapes.PITCH_M + up_m
    return np.column_stack([np.cos(half), zero, zero, np.sin(half), zero, zero, z])


def hammered(speed, reach_m, blows):
    """Heights of a hand that moves up and down at this speed, waits 20 ms at each end, and ends at
    0.
    """
    step = speed * 0.001

    def go(z_from, z_to):
        n = int(np.ceil(abs(z_to - z_from) / step))
        return np.concatenate([np.linspace(z_from, z_to, n + 1)[1:], np.full(20, z_to)])

    legs, at = [np.zeros(300)], 0.0
    for goal in [-reach_m, reach_m] * blows + [0.0]:
        legs.append(go(at, goal))
        at = goal
    return np.concatenate(legs + [np.zeros(200)])


def rows_of_threads():
    """D2: nut M20 on its bolt. Radial gap 0.25 mm, so 0.144 mm of play along the axis in each
    direction."""
    bolt, nut = shapes.bolt(0.02), shapes.nut(0.01, THREAD_GAP_M)
    turns = np.linspace(0, 1, 33) - 0.5
    common = {"voxel_m": 0.00025}
    yield Row(
        "D2f",
        "nut M20 along its bolt for a turn, in the middle of its play",
        bolt,
        nut,
        screwed(turns),
        np.zeros((33, 3)),
        judge="free",
        **common,
    )
    yield Row(
        "D2p",
        "nut M20 pressed 0.06 mm up into its flanks",
        bolt,
        nut,
        screwed(turns, THREAD_PLAY_M + 0.00006),
        np.tile([0, 0, -1.0], (33, 1)),
        facts={"torque_per_force_m": shapes.PITCH_M / (2 * np.pi)},
        **common,
    )
    z = hammered(6.0, 0.012, 10)
    yield Row(
        "D2h",
        "nut M20 hammered along its bolt at 6 m/s, 12 mm each way",
        bolt,
        nut,
        poses_at(np.column_stack([np.zeros((len(z), 2)), z])),
        np.zeros((len(z), 3)),
        path=True,
        judge="hammer",
        **common,
    )
    turns = np.concatenate([np.zeros(300), np.linspace(0, 1, 1501), np.ones(100)])
    poses = screwed(turns)
    poses[:, 6] = 0.0
    yield Row(
        "D2a",
        "nut M20 turned once about its bolt, pulled down by a spring",
        bolt,
        nut,
        poses,
        np.zeros((len(poses), 3)),
        path=True,
        judge="advance",
        window=(turns > 0.25) & (turns < 1),
        **common,
    )


def all_rows(deploy, nearest, expected):
    """Every row with a requested name; `nearest` gives the truth for rows of balls."""
    for row in itertools.chain(
        rows_of_balls(deploy, nearest, expected),
        rows_of_holes(),
        rows_of_springs(),
        rows_of_slides(deploy, expected),
        rows_of_edges(),
        rows_of_threads(),
    ):
        if expected(row.name):
            yield row


def write_poses(file, poses):
    np.savetxt(file, poses, "%.12g", ",", header="qw,qx,qy,qz,tx,ty,tz", comments="")


def asked_of(row):
    if row.path:
        return f"path, 1 ms a row, spring of {row.spring_n_per_m:g} N/m"
    return "poses that stand alone" + (": torque" if row.judge == "torque" else "")


def write_row(row, folder):
    """The files that any program can take part with."""
    folder.mkdir(parents=True, exist_ok=True)
    shapes.write_obj(folder / "static.obj", *row.static)
    shapes.write_obj(folder / "tool.obj", *row.tool)
    write_poses(folder / "poses.csv", row.poses)
    np.savetxt(folder / "right.csv", row.direction, "%.12g", ",", header="dx,dy,dz", comments="")
    (folder / "row.txt").write_text(
        f"{row.title}\n{asked_of(row)}\n",
        encoding="utf-8",
    )
