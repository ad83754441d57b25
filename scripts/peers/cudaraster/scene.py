"""Models, cameras and arrays: what rasterlab and its peer both draw."""

import json
import math
import struct
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np

F = np.float32
NO_TRIANGLE = 2**32 - 1


@dataclass
class Model:
    """Positions, f32 [n, 3], and the corners of triangles, int [t, 3], in the order of rasterlab's triangle ids."""

    positions: np.ndarray
    triangles: np.ndarray


@dataclass(frozen=True)
class Camera:
    """A perspective camera: eye and target in meters, vertical field of view in degrees, distance of the near plane."""

    eye: tuple
    target: tuple = (0.0, 0.0, 0.0)
    fov_y_deg: float = 45.0
    near_m: float = 0.125

    def settings(self):
        """The flags of rasterlab that name this camera."""
        values = {"eye": list(self.eye), "target": list(self.target), "fov_y_deg": self.fov_y_deg, "near_m": self.near_m}
        return [flag for key, value in values.items() for flag in ("--set", f"camera.{key}={json.dumps(value)}")]

    def matrix(self, width, height):
        """rasterlab's clip_from_world, f64 [4, 4] by rows: y up, depth near / w; multiplied in the order of crates/model/src/scene/view.rs."""
        eye, target = np.array(self.eye, float), np.array(self.target, float)
        back = unit(eye - target)
        right = unit(np.cross((0.0, 1.0, 0.0), back))
        up = np.cross(back, right)
        view = np.eye(4)
        for row, axis in enumerate((right, up, back)):
            view[row, :3] = axis
            view[row, 3] = -float(axis[0] * eye[0] + axis[1] * eye[1] + axis[2] * eye[2])
        focal = 1.0 / math.tan(math.radians(self.fov_y_deg) * 0.5)
        x, y = focal / (width / height), focal
        return np.array([view[0] * x, view[1] * y, [0.0, 0.0, 0.0, self.near_m], -view[2]])


def unit(vector):
    return vector * (1.0 / math.sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]))


def clip_positions(model, camera, width, height):
    """x, y and w of every vertex as rasterlab's strict vertex stage computes them: the matrix rounded to f32, then
    ((m0 x + m1 y) + m2 z) + m3 with every operation rounded to f32. f32 [n, 3]."""
    matrix = camera.matrix(width, height).astype(F)
    x, y, z = (model.positions[:, axis] for axis in range(3))
    return np.stack([((row[0] * x + row[1] * y) + row[2] * z) + row[3] for row in matrix[[0, 1, 3]]], axis=1)


def term_sums(model, camera, width, height):
    """The sums of the magnitudes of the terms of x, y and w, f64 [n, 3]."""
    matrix = np.abs(camera.matrix(width, height))[[0, 1, 3]]
    return np.abs(model.positions.astype(float)) @ matrix[:, :3].T + matrix[:, 3]


def opengl_positions(clip, row_0_is_top, near=None, far=None):
    """The clip positions for the peer, f32 [n, 4]: x and w as they are, y negated if row 0 of its picture shall be the top, and z of
    OpenGL between planes laid closely around the model, nearer is smaller."""
    w = clip[:, 2].astype(float)
    near = max(w.min() * 0.99, 1e-3) if near is None else near
    far = w.max() * 1.01 if far is None else far
    z = ((far + near) * w - 2.0 * far * near) / (far - near)
    y = -clip[:, 1] if row_0_is_top else clip[:, 1]
    return np.ascontiguousarray(np.stack([clip[:, 0], y, z.astype(F), clip[:, 2]], axis=1))


def read_glb(path):
    """The one primitive of a GLB as scripts/raster_scenes.py writes it."""
    data = Path(path).read_bytes()
    magic, version, _ = struct.unpack_from("<III", data)
    if magic != 0x46546C67 or version != 2:
        raise ValueError(f"{path}: not a GLB of version 2")
    length = struct.unpack_from("<I", data, 12)[0]
    document = json.loads(data[20 : 20 + length])
    body = data[28 + length :]

    def array(number):
        accessor = document["accessors"][number]
        view = document["bufferViews"][accessor["bufferView"]]
        kind, components = {5126: ("<f4", 3), 5125: ("<u4", 1)}[accessor["componentType"]]
        return np.frombuffer(body, kind, accessor["count"] * components, view.get("byteOffset", 0))

    (mesh,) = document["meshes"]
    (primitive,) = mesh["primitives"]
    positions = array(primitive["attributes"]["POSITION"]).reshape(-1, 3)
    corners = array(primitive["indices"]) if "indices" in primitive else np.arange(len(positions))
    return Model(positions.astype(F), corners.astype(np.int64).reshape(-1, 3))


def read_npy(path):
    """An array that rasterlab wrote; numpy's own reader must read the same."""
    data = Path(path).read_bytes()
    if data[:8] != b"\x93NUMPY\x01\x00":
        raise ValueError(f"{path}: not a NumPy file of version 1.0")
    length = struct.unpack_from("<H", data, 8)[0]
    header = eval(data[10 : 10 + length].decode(), {"__builtins__": {}})  # noqa: S307 - a literal
    array = np.frombuffer(data[10 + length :], header["descr"]).reshape(header["shape"])
    assert not header["fortran_order"] and np.array_equal(array, np.load(path), equal_nan=header["descr"] == "<f4")
    return array


class Program:
    """The program rasterlab, which draws and measures."""

    def __init__(self, path, adapter=None):
        self.command = [str(Path(path).resolve())]
        self.adapter = ["--adapter", adapter] if adapter else []

    def run(self, arguments, folder):
        done = subprocess.run([*self.command, *arguments], cwd=folder, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"rasterlab {' '.join(arguments)}\n{done.stderr}")
        return done

    def triangle_ids(self, glb, camera, size, settings):
        """The ids that rasterlab draws, int64 [height, width], top row first, -1 for none."""
        folder, target = Path(glb).parent, "peer-ids.npy"
        arguments = ["render", Path(glb).name, "--bare", "--force", "-o", "peer.png", "--triangle-ids", target]
        arguments += ["--size", "{}x{}".format(*size), *camera.settings(), *self.adapter]
        arguments += [flag for setting in settings for flag in ("--set", setting)]
        self.run(arguments, folder)
        ids = read_npy(folder / target)
        return np.where(ids == NO_TRIANGLE, -1, ids.astype(np.int64))

    def bench(self, glb, camera, size, samples):
        """The rows of rasterlab bench for the default picture."""
        arguments = ["bench", Path(glb).name, "--format", "json", "--samples", str(samples), "--size", "{}x{}".format(*size)]
        done = self.run([*arguments, *camera.settings(), *self.adapter], Path(glb).parent)
        return json.loads(done.stdout)
