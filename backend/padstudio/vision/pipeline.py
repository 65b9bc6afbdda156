"""The detector: strings the stages together."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Pad
from padstudio.vision.params import DetectorParams
from padstudio.vision.types import Detection, Image, Method


class Detector:
    """Reads one pad through one camera.

    Parameters
    ----------
    pad : Pad
    camera : Camera
        Frames of another size but the same aspect are read with scaled intrinsics.
    method : {"dense", "paper"}
    params : DetectorParams
    """

    def __init__(
        self,
        pad: Pad,
        camera: Camera,
        *,
        method: Method = "dense",
        params: DetectorParams | None = None,
    ) -> None:
        self.pad = pad
        self.camera = camera
        self.method = method
        self.params = params or DetectorParams()

    def detect(self, bgr: Image, *, trace: bool = False) -> Detection:
        """Find the pad in one still.

        Parameters
        ----------
        bgr : (H, W, 3) uint8
        trace : bool
            Keep every stage's output in the result.

        Returns
        -------
        Detection
            ``.pose`` is None where ``.failure`` says why.

        Raises
        ------
        CameraMismatchError
            If the frame's aspect is not the camera's.
        """
        raise NotImplementedError

    def track(self, frames: Iterable[Image]) -> Iterator[Detection]:
        """Find the pad in a video's frames; the last pose helps the next."""
        for frame in frames:
            yield self.detect(frame)
