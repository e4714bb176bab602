# SPDX-License-Identifier: BSD-3-Clause
import os
from typing import Any, Dict, Iterator, Optional, Union

import numpy as np
import numpy.typing as npt

Path = Union[str, "os.PathLike[str]"]
Floats = npt.NDArray[np.float64]

class InputError(ValueError):
    """What was given cannot be used. The message names it, its value, and what was expected."""

class Camera:
    """A pinhole camera: pixels, centres at whole coordinates. `depth_unit_m`: metres for one step of a
    16-bit depth."""

    width: int
    height: int
    fx: float
    fy: float
    cx: float
    cy: float
    depth_unit_m: float
    def __init__(self, width: int, height: int, fx: float, fy: float, cx: float, cy: float,
                 depth_unit_m: float = 0.001) -> None: ...
    @staticmethod
    def load(path: Path) -> Camera:
        """A camera file of posefusion, ORB-SLAM, OpenCV or ROS; with the distortion that it tells."""

class Frame:
    """A colour and a depth image of one moment. The arrays are the images' own memory."""

    color: npt.NDArray[np.uint8]  #: H x W x 3, R G B
    depth: npt.NDArray[Any]  #: H x W, uint16 in the camera's depth_unit_m
    stamp: int  #: ns
    camera: Camera

class Recording:
    """The frames of a folder that can be read, one after another, once."""

    def __len__(self) -> int: ...
    def __iter__(self) -> Iterator[Frame]: ...
    def __next__(self) -> Frame: ...
    def truth(self) -> Floats:
        """N x 8 of groundtruth.txt, N = 0 where there is none."""

class Result:
    """What is known of the camera after a frame."""

    stamp: int  #: ns
    status: str  #: initializing, tracking, doubtful or lost
    outcome: str  #: fused, or why it was not
    reason: str  #: in words; empty: it was fused
    T_world_camera: Optional[Floats]  #: 4 x 4, m; None: the camera is not located
    covariance: Floats  #: 6 x 6, of a small motion in the camera's frame, m and rad

class Map:
    """Discs, in the world (z up, in the first camera). Arrays of N rows."""

    points: npt.NDArray[np.float32]  #: N x 3, m
    normals: npt.NDArray[np.float32]  #: N x 3
    colors: npt.NDArray[np.uint8]  #: N x 3, R G B
    radii: npt.NDArray[np.float32]  #: N, m
    confidences: npt.NDArray[np.float32]  #: N, probability that it stands still
    def __len__(self) -> int: ...

class Slam:
    """The whole chain; the result is that of posefusion_run, to the bit. It uses all cores and leaves
    Python's lock to others while it works; calls from several threads wait for each other."""

    def __init__(self, config: Union[None, Path, Dict[str, Any]] = None, mode: Optional[str] = None,
                 recording: Optional[Recording] = None) -> None:
        """`config`: a YAML file, or {"frame": {"max_depth_m": 4}}, or {"frame.max_depth_m": 4}. `mode`:
        elastic, posefusion or pfh. `recording`: its depth camera and its people, where it names them."""
    def process(self, color: npt.NDArray[np.uint8], depth: npt.NDArray[Any],
                stamp: Union[int, float], camera: Camera) -> Result:
        """`color`: H x W x 3, R G B. `depth`: H x W, float32 in metres or uint16 in the camera's unit. Both
        are read where they lie, copied only where their pixels are not one after another, and may be
        written over afterwards. `stamp`: seconds as float, nanoseconds as int; later than all before."""
    def finish(self) -> str:
        """After the last frame: waits for loops that are still looked at. What that did, in a line."""
    def trajectory(self) -> Floats:
        """N x 8: stamp (s), position (m), quaternion x y z w; as loops have corrected it so far."""
    def map(self) -> Map: ...
    def save(self, path: Path) -> int:
        """Writes trajectory.txt and map.ply into a folder; the number of discs."""

class Statistics:
    count: int
    rmse: float
    mean: float
    median: float
    std: float
    min: float
    max: float
    sse: float

class Errors:
    translation_m: Statistics
    rotation_deg: Statistics
    scale: float  #: of the alignment

def open_folder(path: Path, camera: Optional[Path] = None) -> Recording:
    """A TUM folder; `camera`: a camera file instead of its own."""

def read_tum(path: Path) -> Floats:
    """A trajectory file (TUM; KITTI and EuRoC are known too) as N x 8."""

def write_tum(path: Path, trajectory: Floats, comment: str = "") -> None: ...

def ate(truth: Union[Path, Floats], estimate: Union[Path, Floats], align: str = "rigid",
        max_difference: float = 0.02, offset: float = 0.0) -> Errors:
    """Absolute errors of the poses. `align`: none, rigid, similarity or origin. `max_difference` (s)
    between stamps that are a pair; `offset` (s) is added to those of the estimate."""

def rpe(truth: Union[Path, Floats], estimate: Union[Path, Floats], step: float = 1.0, unit: str = "frames",
        overlapping: bool = False, align: str = "rigid", max_difference: float = 0.02,
        offset: float = 0.0) -> Errors:
    """Errors of motions of `step` frames, seconds or metres (`unit`), end to end or `overlapping`."""
