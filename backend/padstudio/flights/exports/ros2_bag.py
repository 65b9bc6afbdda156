"""A ROS 2 bag of poses, as a zip of its folder: poses with covariance, and transforms.

References
----------
https://docs.ros.org/en/rolling/p/geometry_msgs/ (PoseWithCovariance), REP 103 (axes of optical
frames) and https://github.com/ros2/rosbag2 (metadata of version 8, which Humble and later read).
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from padstudio.arrays import Array
from padstudio.flights.exports.byte_stream import ByteStream
from padstudio.flights.exports.options import ExportOptions, Record, full_poses, time_ns_of
from padstudio.flights.results.completed import covariance_of
from padstudio.geometry.pose import Pose

#: The bag's folder in the zip.
FOLDER = "poses"
#: The pad's frame, and the camera's: x right in the picture, y down, z forward.
PAD_FRAME, CAMERA_FRAME = "pad", "camera"
POSE_TOPIC, POSE_TYPE = "/camera/pose", "geometry_msgs/msg/PoseWithCovarianceStamped"
TF_TOPIC, TF_TYPE = "/tf", "tf2_msgs/msg/TFMessage"
# Read at a time of a file that is put into the zip.
_BLOCK_BYTES = 1 << 20


def write_ros2(records: Iterable[Record], options: ExportOptions) -> Iterator[bytes]:
    """A zip of a ROS 2 bag with SQLite storage; poses of quality ``full`` alone.

    ``/camera/pose`` has the camera in the frame ``pad``, metres, with its covariance in the order
    of ROS: x, y, z, then turns about X, Y and Z of the pad. ``/tf`` has the same as the transform
    from ``pad`` to ``camera``.

    Raises
    ------
    EmptyExportError
        If there is no such pose.
    """
    with TemporaryDirectory() as parent:
        folder = Path(parent) / FOLDER
        _write_bag(folder, records, options)
        yield from _zipped(folder)


def _write_bag(folder: Path, records: Iterable[Record], options: ExportOptions) -> None:
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    with Writer(folder, version=8, storage_plugin=StoragePlugin.SQLITE3) as writer:
        pose_topic = writer.add_connection(POSE_TOPIC, POSE_TYPE, typestore=store)
        tf_topic = writer.add_connection(TF_TOPIC, TF_TYPE, typestore=store)
        for record, pose, time_s in full_poses(records, "a ROS 2 bag of poses"):
            time_ns = time_ns_of(record, time_s, options)
            messages = _Messages(store.types, pose, time_ns)
            stamped = messages.pose(ros_covariance(record, pose))
            writer.write(pose_topic, time_ns, store.serialize_cdr(stamped, POSE_TYPE))
            writer.write(tf_topic, time_ns, store.serialize_cdr(messages.transform(), TF_TYPE))


class _Messages:
    """A pose as ROS's messages."""

    def __init__(self, types: Any, pose: Pose, time_ns: int) -> None:
        self._types = types
        stamp = types["builtin_interfaces/msg/Time"](*divmod(time_ns, 10**9))
        self._header = types["std_msgs/msg/Header"](stamp, PAD_FRAME)
        self._place = [float(value) for value in pose.position_mm / 1000]
        turn = [float(value) for value in pose.quaternion_xyzw]
        self._turn = types["geometry_msgs/msg/Quaternion"](*turn)

    def pose(self, covariance: Array) -> Any:
        types = self._types
        point = types["geometry_msgs/msg/Point"](*self._place)
        pose = types["geometry_msgs/msg/Pose"](point, self._turn)
        known = types["geometry_msgs/msg/PoseWithCovariance"](pose, covariance.ravel())
        return types[POSE_TYPE](self._header, known)

    def transform(self) -> Any:
        types = self._types
        shift = types["geometry_msgs/msg/Vector3"](*self._place)
        transform = types["geometry_msgs/msg/Transform"](shift, self._turn)
        name = "geometry_msgs/msg/TransformStamped"
        return types[TF_TYPE]([types[name](self._header, CAMERA_FRAME, transform)])


def ros_covariance(record: Record, pose: Pose) -> Array:
    """A pose's covariance in ROS's order and frame.

    Returns
    -------
    (6, 6) float64
        x, y, z in metres, then turns about the fixed axes X, Y, Z of the pad, radians. Files that
        hold no covariance have that of the standard deviations.
    """
    covariance = covariance_of(record)
    if covariance is None:
        shift, turn = record["position_sigma_mm"], np.radians(record["attitude_sigma_deg"])
        covariance = np.diag(np.square([*shift, *turn]))
    to_ros = np.zeros((6, 6))
    to_ros[:3, :3] = np.eye(3) / 1000
    # From turns about the camera's axes.
    to_ros[3:, 3:] = pose.rotation
    return np.asarray(to_ros @ covariance @ to_ros.T)


def _zipped(folder: Path) -> Iterator[bytes]:
    stream = ByteStream()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(folder.iterdir()):
            # Without the time of writing: the same poses are the same file.
            entry = zipfile.ZipInfo(f"{FOLDER}/{path.name}")
            entry.compress_type = zipfile.ZIP_DEFLATED
            with path.open("rb") as source, archive.open(entry, "w", force_zip64=True) as target:
                while block := source.read(_BLOCK_BYTES):
                    target.write(block)
                    yield stream.take()
    yield stream.take()
