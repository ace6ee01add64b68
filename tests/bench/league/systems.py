"""Answers of all systems to a row: contact wrench and CPU time of each pose.

A system has a name, a setting ("standard" or "best": its defaults, or the best found within a
millisecond), and answer(row, folder) -> (wrenches n x 6 about the tool's origin, microseconds n),
or None if it cannot take part. One thread; times are CPU time.
"""

import io
import subprocess
import time

import numpy as np
from rows import SPRING_N_PER_M

STIFFNESS = 1000.0  # of a penalty contact [N/m]; only directions are compared
MASS_KG = 0.1  # of a tool that an engine moves
PERIOD_S = 0.001
# Of MuJoCo: contacts nearly rigid; points that it begins its search for overlaps from.
STIFF = ' solref="0.002 1" solimp="0.99 0.999 0.0001"'
SDF_SEARCH = ' sdf_initpoints="40" sdf_iterations="10"'
THREADS = ("hammer", "advance")
HULLS = "cannot: a moving mesh is its convex hull, which overlaps the bolt"


def timed(function):
    begin = time.thread_time()
    result = function()
    return result, 1e6 * (time.thread_time() - begin)


def pushed(contacts, origin):
    """Penalty wrench of contacts (point, normal on the tool, depth)."""
    wrench = np.zeros(6)
    for point, normal, depth in contacts:
        force = STIFFNESS * depth * np.asarray(normal)
        wrench[:3] += force
        wrench[3:] += np.cross(np.asarray(point) - origin, force)
    return wrench


def rotation(pose):
    w, x, y, z = pose[:4]
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


class System:
    name, setting, paths = "", "standard", False

    def version(self):
        return ""

    def start(self, row, folder):
        """Builds the scene; returns a function from a pose to contacts, or None."""
        raise NotImplementedError

    def stepper(self, row, folder, stiffness):
        """For systems with `paths`: from the hand's place and velocity to the spring's pull, us."""
        raise NotImplementedError

    def follow(self, row, folder):
        step = self.stepper(row, folder, row.spring_n_per_m)
        wrenches, times, before = [], [], row.poses[0, 4:]
        for pose in row.poses:
            pull, us = step(pose[4:], (pose[4:] - before) / PERIOD_S)
            before = pose[4:]
            wrenches.append(np.concatenate([-pull, np.zeros(3)]))
            times.append(us)
        return np.array(wrenches), np.array(times)

    def answer(self, row, folder):
        if row.path != self.paths:
            return None
        if self.paths:
            return HULLS if row.judge in THREADS else self.follow(row, folder)
        contacts_at = self.start(row, folder)
        if contacts_at is None:
            return None
        wrenches, times = [], []
        for pose in row.poses:
            runs = [timed(lambda: contacts_at(pose)) for _ in range(3)]
            wrenches.append(pushed(runs[0][0], pose[4:]))
            times.append(min(us for _, us in runs))
        return np.array(wrenches), np.array(times)


class Refused(Exception):
    """voxtouch's message about a scene that it refuses."""


def probe(program, scene, poses, *options):
    """Wrenches (n x 6) and times [us] of `voxtouch probe`; Refused with its sentence."""
    run = subprocess.run(
        [program, "probe", scene, "--poses", poses, "--time", *options],
        capture_output=True,
        text=True,
    )
    if run.returncode:
        raise Refused(run.stderr.strip().splitlines()[-1].split(f"{scene}: ")[-1].rstrip("."))
    table = np.genfromtxt(io.StringIO(run.stdout), delimiter=",", names=True)
    return np.column_stack([table[c] for c in ("fx", "fy", "fz", "tx", "ty", "tz")]), table["us"]


def probe_path(program, scene, poses, spring_n_per_m=SPRING_N_PER_M):
    """The same of a virtual tool behind a spring."""
    return probe(program, scene, poses, "--spring", f"{spring_n_per_m:g}")


class Voxtouch(System):
    def __init__(self, program, model):
        self.program, self.model = program, model
        self.name = f"voxtouch {model}"
        self.paths = model == "virtual tool"

    def version(self):
        return subprocess.run(
            [self.program, "--version"], capture_output=True, text=True, check=True
        ).stdout.strip()

    def answer(self, row, folder):
        if row.path != self.paths:
            return None
        contact = (
            "{model: field, rendering: virtual_tool}"
            if self.paths
            else f"{{model: {self.model}, stiffness_n_per_m3: 1.0e+7, rendering: memoryless}}"
        )
        scene = folder / "voxtouch.yaml"
        scene.write_text(
            (
                f"scene: league\nvoxel_size: {row.voxel_m}\nstatic: [{{mesh: static.obj}}]\n"
                f"dynamic: {{mesh: tool.obj}}\ncontact: {contact}\ncoupling: {{design: auto}}\n"
            ),
            encoding="utf-8",
        )
        poses = folder / "poses.csv"
        try:
            if self.paths:
                return probe_path(self.program, scene, poses, row.spring_n_per_m)
            return probe(self.program, scene, poses, "--model", self.model)
        except Refused as error:
            return f"refused: {error}"


class Coal(System):
    name = "Coal"

    def version(self):
        import coal

        return coal.__version__

    @staticmethod
    def mesh(module, vertices, faces):
        model = module.BVHModelOBBRSS()
        model.beginModel(len(faces), len(vertices))
        points = module.StdVec_Vec3s()
        for vertex in np.asarray(vertices, float):
            points.append(vertex)
        triangles = (
            module.StdVec_Triangle()
            if hasattr(module, "StdVec_Triangle")
            else module.StdVec_Triangle32()
        )
        kind = module.Triangle if hasattr(module, "Triangle") else module.Triangle32
        for a, b, c in faces:
            triangles.append(kind(int(a), int(b), int(c)))
        model.addSubModel(points, triangles)
        model.endModel()
        return model

    def start(self, row, folder):
        import coal

        static = self.mesh(coal, *row.static)
        fixed = coal.Transform3s.Identity()
        if row.ball_m:
            centre_ball = coal.Sphere(1e-9)
            moved, request, result = (
                coal.Transform3s.Identity(),
                coal.DistanceRequest(True),
                coal.DistanceResult(),
            )

            def nearest(pose):
                moved.setTranslation(pose[4:])
                result.clear()
                distance = coal.distance(centre_ball, moved, static, fixed, request, result)
                point = np.array(result.getNearestPoint2())
                away = pose[4:] - point
                return (
                    [(point, away / np.linalg.norm(away), row.ball_m - distance)]
                    if distance < row.ball_m
                    else []
                )

            return nearest
        tool = self.mesh(coal, *row.tool)
        moved, request, result = (
            coal.Transform3s.Identity(),
            coal.CollisionRequest(),
            coal.CollisionResult(),
        )
        request.num_max_contacts = 2000
        request.enable_contact = True

        def collide(pose):
            moved.setTranslation(pose[4:])
            moved.setRotation(rotation(pose))
            result.clear()
            coal.collide(tool, moved, static, fixed, request, result)
            return [
                (np.array(c.pos), -np.array(c.normal), abs(c.penetration_depth))
                for c in (result.getContact(i) for i in range(result.numContacts()))
            ]

        return collide


class Fcl(System):
    name = "FCL"

    def version(self):
        import importlib.metadata

        return importlib.metadata.version("python-fcl")

    def start(self, row, folder):
        import fcl

        def mesh(vertices, faces):
            model = fcl.BVHModel()
            model.beginModel(len(vertices), len(faces))
            model.addSubModel(np.asarray(vertices, float), np.asarray(faces))
            model.endModel()
            return model

        static = fcl.CollisionObject(mesh(*row.static), fcl.Transform())
        shape = fcl.Sphere(row.ball_m) if row.ball_m else mesh(*row.tool)
        request = fcl.CollisionRequest(num_max_contacts=2000, enable_contact=True)

        def collide(pose):
            tool, result = (
                fcl.CollisionObject(shape, fcl.Transform(rotation(pose), pose[4:])),
                fcl.CollisionResult(),
            )
            fcl.collide(static, tool, request, result)
            return [
                (c.pos, np.asarray(c.normal), abs(c.penetration_depth)) for c in result.contacts
            ]

        return collide


class Trimesh(System):
    name = "trimesh"

    def version(self):
        import trimesh

        return trimesh.__version__

    def start(self, row, folder):
        import trimesh

        if not row.ball_m or len(row.static[1]) > 100_000:
            return None
        static = trimesh.Trimesh(row.static[0], row.static[1], process=False)
        surface = trimesh.proximity.ProximityQuery(static)

        def nearest(pose):
            points, distances, _ = surface.on_surface(pose[None, 4:])
            away = pose[4:] - points[0]
            if distances[0] >= row.ball_m:
                return []
            return [(points[0], away / np.linalg.norm(away), row.ball_m - distances[0])]

        return nearest


class MuJoCo(System):
    """`best` is SDF for independent poses, and stiff for paths; `sdf` is both, for threads."""

    def __init__(self, setting, paths=False):
        self.setting, self.paths = setting, paths
        self.sdf = setting == "sdf" or (setting == "best" and not paths)
        self.stiff = setting != "standard" and paths
        self.name = "MuJoCo" + (" SDF" if self.sdf else " stiff" if self.stiff else "")

    def version(self):
        import mujoco

        return mujoco.__version__

    def model(self, row, folder):
        import mujoco

        stiff = STIFF if self.stiff else ""
        shape = ' type="sdf"' if self.sdf else ' type="mesh"'
        tool = (
            f'<geom type="sphere" size="{row.ball_m}"'
            if row.ball_m
            else f'<geom{shape} mesh="tool"'
        )
        free = (
            '<freejoint name="free"/>'
            if not self.paths
            else (
                '<joint name="x" type="slide" axis="1 0 0"/><joint name="y" type="slide" axis="0 1'
                ' 0"/><joint name="z" type="slide" axis="0 0 1"/>'
            )
        )
        points = SDF_SEARCH if self.sdf else ""
        return mujoco.MjModel.from_xml_string(
            f'<mujoco><option timestep="{PERIOD_S}" gravity="0 0 0"{points}/><asset><mesh'
            f' name="static" file="{folder / "static.obj"}"/><mesh name="tool"'
            f' file="{folder / "tool.obj"}"/></asset><worldbody><geom{shape} mesh="static"'
            f' friction="0 0 0" condim="1"{stiff}/><body name="tool">{free}{tool} mass="{MASS_KG}"'
            f' friction="0 0 0" condim="1"{stiff}/></body></worldbody></mujoco>'
        )

    def answer(self, row, folder):
        if self.paths and self.sdf:
            if row.judge == "advance":
                import threads

                return threads.turned_in_mujoco(row, folder)
            return self.follow(row, folder) if row.judge == "hammer" else None
        return super().answer(row, folder)

    def start(self, row, folder):
        import mujoco

        model = self.model(row, folder)
        data = mujoco.MjData(model)
        tool = model.body("tool").id

        def collide(pose):
            data.qpos[:3], data.qpos[3:7] = pose[4:], pose[:4]
            mujoco.mj_kinematics(model, data)
            mujoco.mj_collision(model, data)
            found = []
            for c in data.contact[: data.ncon]:
                if c.dist < 0:
                    to_tool = 1.0 if model.geom_bodyid[c.geom2] == tool else -1.0
                    found.append((c.pos.copy(), to_tool * c.frame[:3], -c.dist))
            return found

        return collide

    def stepper(self, row, folder, stiffness):
        import mujoco

        model = self.model(row, folder)
        data = mujoco.MjData(model)
        damping = 2 * 0.7 * (stiffness * MASS_KG) ** 0.5
        data.qpos[:3] = row.poses[0, 4:]

        def step(hand, velocity):
            pull = stiffness * (hand - data.qpos[:3])
            data.qfrc_applied[:3] = pull + damping * (velocity - data.qvel[:3])
            return pull, timed(lambda: mujoco.mj_step(model, data))[1]

        return step


class Bullet(System):
    def __init__(self, setting, paths=False):
        self.setting, self.paths = setting, paths
        self.name = "PyBullet" + (" concave" if setting == "best" else "")

    def version(self):
        import importlib.metadata

        return importlib.metadata.version("pybullet")

    def world(self, row, folder):
        import pybullet
        from pybullet_utils import bullet_client

        client = bullet_client.BulletClient(connection_mode=pybullet.DIRECT)
        flags = {"flags": pybullet.GEOM_FORCE_CONCAVE_TRIMESH} if self.setting == "best" else {}
        static = client.createMultiBody(
            0,
            client.createCollisionShape(
                pybullet.GEOM_MESH, fileName=str(folder / "static.obj"), **flags
            ),
        )
        shape = (
            client.createCollisionShape(pybullet.GEOM_SPHERE, radius=row.ball_m)
            if row.ball_m
            else client.createCollisionShape(pybullet.GEOM_MESH, fileName=str(folder / "tool.obj"))
        )
        tool = client.createMultiBody(MASS_KG, shape, basePosition=row.poses[0, 4:])
        for body in (static, tool):
            client.changeDynamics(body, -1, lateralFriction=0, linearDamping=0, angularDamping=0)
        client.setTimeStep(PERIOD_S)
        return client, static, tool

    def start(self, row, folder):
        if len(row.static[1]) > 100_000:
            return None  # the OBJ reader takes minutes
        client, static, tool = self.world(row, folder)

        def collide(pose):
            client.resetBasePositionAndOrientation(tool, pose[4:], [*pose[1:4], pose[0]])
            return [
                (c[5], np.asarray(c[7]), -c[8])
                for c in client.getClosestPoints(tool, static, 0.0)
                if c[8] < 0
            ]

        return collide

    def stepper(self, row, folder, stiffness):
        client, _, tool = self.world(row, folder)
        # As in MuJoCo, the tool does not rotate.
        client.changeDynamics(tool, -1, localInertiaDiagonal=[1.0] * 3)
        damping = 2 * 0.7 * (stiffness * MASS_KG) ** 0.5

        def step(hand, velocity):
            at = np.array(client.getBasePositionAndOrientation(tool)[0])
            pull = stiffness * (hand - at)
            force = pull + damping * (velocity - np.array(client.getBaseVelocity(tool)[0]))
            client.applyExternalForce(tool, -1, force, at, 2)  # in the world
            return pull, timed(client.stepSimulation)[1]

        return step


class Drake(System):
    def __init__(self, setting):
        self.setting = setting
        self.name = "Drake" + (" hydroelastic" if setting == "best" else "")

    def version(self):
        import importlib.metadata

        return importlib.metadata.version("drake")

    def start(self, row, folder):
        from pydrake.geometry import (
            AddCompliantHydroelasticProperties,
            AddRigidHydroelasticProperties,
            FramePoseVector,
            GeometryFrame,
            GeometryInstance,
            HydroelasticContactRepresentation,
            Mesh,
            ProximityProperties,
            SceneGraph,
            Sphere,
        )
        from pydrake.math import RigidTransform, RotationMatrix

        if len(row.static[1]) > 100_000:
            return None
        scene = SceneGraph()
        source = scene.RegisterSource("league")
        frame = GeometryFrame("tool")
        scene.RegisterFrame(source, frame)

        def add(shape, moving, compliant):
            instance = GeometryInstance(RigidTransform(), shape, "tool" if moving else "static")
            properties = ProximityProperties()
            if compliant:
                AddCompliantHydroelasticProperties(0.002, 1e6, properties)
            else:
                AddRigidHydroelasticProperties(0.002, properties)
            instance.set_proximity_properties(properties)
            if moving:
                return scene.RegisterGeometry(source, frame.id(), instance)
            return scene.RegisterAnchoredGeometry(source, instance)

        moving = Sphere(row.ball_m) if row.ball_m else Mesh(str(folder / "tool.obj"))
        tool = add(moving, True, bool(row.ball_m))
        add(Mesh(str(folder / "static.obj")), False, False)
        if self.setting == "best" and not row.ball_m:
            # Two rigid meshes have no contact surface; a compliant mesh needs a volume mesh.
            return None
        context = scene.CreateDefaultContext()
        query_port, pose_port = scene.get_query_output_port(), scene.get_source_pose_port(source)

        def collide(pose):
            poses = FramePoseVector()
            poses.set_value(frame.id(), RigidTransform(RotationMatrix(rotation(pose)), pose[4:]))
            pose_port.FixValue(context, poses)
            query = query_port.Eval(context)
            if self.setting == "standard":
                return [
                    (
                        p.p_WCa if p.id_A == tool else p.p_WCb,
                        np.asarray(p.nhat_BA_W) * (1 if p.id_A == tool else -1),
                        p.depth,
                    )
                    for p in query.ComputePointPairPenetration()
                ]
            found = []
            for surface in query.ComputeContactSurfaces(HydroelasticContactRepresentation.kPolygon):
                sign = 1.0 if surface.id_M() == tool else -1.0
                for i in range(surface.num_faces()):
                    pressure = surface.poly_e_MN().EvaluateCartesian(i, surface.centroid(i))
                    found.append(
                        (
                            surface.centroid(i),
                            sign * np.asarray(surface.face_normal(i)),
                            pressure * surface.area(i) / STIFFNESS,
                        )
                    )
            return found

        return collide


def everybody(program):
    return [
        Voxtouch(program, "field"),
        Voxtouch(program, "adapted"),
        Voxtouch(program, "original"),
        Voxtouch(program, "virtual tool"),
        Coal(),
        Fcl(),
        Trimesh(),
        MuJoCo("standard"),
        MuJoCo("best"),
        Bullet("standard"),
        Bullet("best"),
        Drake("standard"),
        Drake("best"),
        MuJoCo("standard", True),
        MuJoCo("best", True),
        MuJoCo("sdf", True),
        Bullet("standard", True),
        Bullet("best", True),
    ]
