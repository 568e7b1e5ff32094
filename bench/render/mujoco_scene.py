"""A scene that bench-render exported, as a MuJoCo model: one mocap body for each of ours, seen by the same camera."""
import json
import math
import pathlib

import mujoco
import numpy as np

GEOMS = mujoco.mjtObj.mjOBJ_GEOM


def words(numbers):
    return " ".join(f"{x:.9g}" for x in numbers)


class Scene:
    def __init__(self, folder, samples, shadow_side):
        self.folder = pathlib.Path(folder)
        self.scene = json.loads((self.folder / "scene.json").read_text())
        self.width, self.height = self.scene["width"], self.scene["height"]
        assets, bodies = [], []
        for number, body in enumerate(self.scene["bodies"]):
            geoms = []
            for geom in body["geoms"]:
                name = geom["file"].removesuffix(".msh")
                # a surface of its own need not enclose a volume
                assets.append(f'<mesh name="m{name}" file="{geom["file"]}" inertia="shell"/>')
                geoms.append(f'<geom name="g{name}" type="mesh" mesh="m{name}" contype="0" conaffinity="0" mass="0" '
                             f'pos="{words(geom["pos"])}" quat="{words(geom["quat"])}" rgba="{words(geom["rgba"])}"/>')
            bodies.append(f'<body name="b{number}" mocap="true">{"".join(geoms)}</body>')
        camera = self.scene["camera"]
        self.xml = f"""<mujoco><compiler meshdir="{self.folder}"/>
          <visual><global offwidth="{self.width}" offheight="{self.height}" fovy="{math.degrees(camera["fov"])}"/>
            <quality offsamples="{samples}" shadowsize="{shadow_side}"/><map znear="0.01" zfar="50"/></visual>
          <statistic extent="2" center="{words(camera["target"])}"/>
          <asset>{"".join(assets)}
            <texture type="skybox" builtin="gradient" rgb1="0.9 0.93 0.96" rgb2="0.6 0.7 0.8" width="256" height="256"/>
            <texture name="grid" type="2d" builtin="checker" rgb1="0.8 0.8 0.8" rgb2="0.75 0.75 0.75" width="256" height="256"/>
            <material name="grid" texture="grid" texrepeat="20 20"/></asset>
          <worldbody><light directional="true" pos="0 0 3" dir="-0.25 0.75 -1.35" castshadow="true"/>
            <geom name="floor" type="plane" size="10 10 1" pos="0 0 {self.scene["floor"]}" material="grid"/>
            {"".join(bodies)}</worldbody></mujoco>"""
        self.model = mujoco.MjModel.from_xml_string(self.xml)
        self.data = mujoco.MjData(self.model)
        self.mocap = [self.model.body(f"b{i}").mocapid[0] for i in range(len(bodies))]
        self.frames = self.scene["frames"]

        eye, target = np.array(camera["eye"]), np.array(camera["target"])
        forward = (target - eye) / np.linalg.norm(target - eye)
        self.camera = mujoco.MjvCamera()
        self.camera.type = mujoco.mjtCamera.mjCAMERA_FREE
        self.camera.lookat[:] = target
        self.camera.distance = np.linalg.norm(target - eye)
        self.camera.azimuth = math.degrees(math.atan2(forward[1], forward[0]))
        self.camera.elevation = math.degrees(math.asin(forward[2]))

    def pose(self, k):
        for mocap, pose in zip(self.mocap, self.frames[k]):
            self.data.mocap_pos[mocap] = pose["pos"]
            self.data.mocap_quat[mocap] = pose["quat"]
        mujoco.mj_forward(self.model, self.data)

    def renderer(self):
        return mujoco.Renderer(self.model, self.height, self.width)

    def body_of_geom(self):
        """Number of our body for each geom id; -1 = the floor."""
        names = {self.model.body(f"b{i}").id: i for i in range(len(self.mocap))}
        return np.array([names.get(b, -1) for b in self.model.geom_bodyid])
