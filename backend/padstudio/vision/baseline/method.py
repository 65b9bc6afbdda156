"""The paper's method, for comparison with the dense one frame by frame.

outline where the whole sign is in view; else for each channel: block mean → clean → Canny and
dilation → Hough lines → central window → its code; the larger window's four corners give the pose.

Every choice that the paper leaves open is named where it is made. Beyond its letter go only checks
that refuse a pose: see `padstudio.vision.baseline.decode` for what a pose has to show, and
`padstudio.vision.baseline.pose` for how sure four corners must be.
"""

from __future__ import annotations

import copy
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

import cv2
import numpy as np

from padstudio.arrays import Image
from padstudio.geometry.camera import Camera
from padstudio.geometry.pose import Pose
from padstudio.geometry.rolling_shutter import MovingPose
from padstudio.pad.spec import Channel, Pad
from padstudio.vision.baseline.central_window import central_window
from padstudio.vision.baseline.decode import WindowDecoder, WindowRead
from padstudio.vision.baseline.edges import find_edge_map
from padstudio.vision.baseline.hough import find_merged_lines
from padstudio.vision.baseline.line_grid import LineGrid, find_line_grid
from padstudio.vision.baseline.pose import WindowPose, choose_larger, window_pose
from padstudio.vision.cells.layer_read import LayerRead, read_layer
from padstudio.vision.dense.scales import doubt
from padstudio.vision.frame.block_mean import block_mean, clean
from padstudio.vision.frame.diagnosis import diagnose, examine
from padstudio.vision.frame.prepare import Stretch, take_channel
from padstudio.vision.frame.pyramid import Plane, Pyramid
from padstudio.vision.frame.regions import Region
from padstudio.vision.outline.corner_pose import unsure
from padstudio.vision.outline.quadrilateral import (
    OutlinePose,
    find_outline,
    outline_pose,
)
from padstudio.vision.refine.refiner import Refiner
from padstudio.vision.stage.detection import Detection, Uncertainty
from padstudio.vision.stage.params import DetectorParams
from padstudio.vision.stage.trace import Reason, Recorder, StageFailure

LayerName = Literal["red", "green", "blue", "outline"]


@dataclass(frozen=True)
class _Frame:
    pyramid: Pyramid
    camera: Camera
    stretch: Stretch
    region: Region
    recorder: Recorder


class Baseline:
    """The paper's method for one pad and one camera.

    Parameters
    ----------
    pad : Pad
    camera : Camera
    params : DetectorParams
    """

    def __init__(self, pad: Pad, camera: Camera, params: DetectorParams) -> None:
        self.pad = pad
        self.camera = camera
        self.params = params
        # Of one pose, windows of larger cells cover more of the picture.
        largest_first = sorted(pad.layers, key=lambda layer: -layer.cell_mm)
        self.decoders: dict[Channel, WindowDecoder] = {
            layer.channel: WindowDecoder(pad, layer) for layer in largest_first
        }

    def with_params(self, params: DetectorParams) -> Baseline:
        """The same under other parameters."""
        other = copy.copy(self)
        other.params = params
        return other

    def detect(self, bgr: Image, recorder: Recorder) -> Detection:
        """Find the pad in one frame, without any hint."""
        seen = examine(bgr, self.pad, self.camera, self.params.prepare, recorder)
        regions = seen.regions
        frame = _Frame(seen.pyramid, seen.camera, seen.stretch, regions[0], recorder)
        # Parts of a sign that reaches beyond the frame have no outline of their own.
        first = 1 if _is_cut(regions[0], seen.pyramid) else len(regions)
        outline = self._from_outlines(frame, regions[:first])
        if isinstance(outline, OutlinePose) or outline.reason is Reason.CHANNELS_SWAPPED:
            return self._told(frame, outline)
        found = self._from_windows(frame, regions, outline)
        if found.failure is None or found.failure.reason is Reason.CHANNELS_SWAPPED:
            return found
        if regions[first:]:
            outline = self._from_outlines(frame, regions[first:])
            if isinstance(outline, OutlinePose) or outline.reason is Reason.CHANNELS_SWAPPED:
                return self._told(frame, outline)
        return Detection(None, diagnose(seen, found.failure))

    def _told(self, frame: _Frame, outline: OutlinePose | StageFailure) -> Detection:
        """What an outline leads to: a whole sign is larger than any window of it, and wins."""
        if isinstance(outline, StageFailure):
            return Detection(None, outline)
        recorder = frame.recorder
        if recorder.keep:
            recorder.append(self._explain(replace(frame, region=outline.outline.region)))
        recorder.note("pose", None, outline)
        return _detection(outline, "outline")

    def _explain(self, frame: _Frame) -> Recorder:
        """For a trace: the stages that the result did not need."""
        shown = Recorder(keep=True, memo=frame.recorder.memo)
        self._read_channels(replace(frame, recorder=shown), next(self._levels(frame)), 1)
        return shown

    def _from_outlines(
        self, frame: _Frame, regions: Sequence[Region]
    ) -> OutlinePose | StageFailure:
        """The pose from the first region that is a whole sign; else why the likeliest is none."""
        first: StageFailure | None = None
        for region in regions:
            found = self._from_outline(replace(frame, region=region))
            if isinstance(found, OutlinePose):
                fault = self._doubt(frame, found.pose, found.read)
                if fault is None:
                    return found
                found = fault
            if found.reason is Reason.CHANNELS_SWAPPED:
                return found
            first = first or found
        assert first is not None
        return first

    def _from_outline(self, frame: _Frame) -> OutlinePose | StageFailure:
        run, limits = frame.recorder.run, self.params.paper
        pyramid, camera = frame.pyramid, frame.camera
        sought = (self.pad, frame.region, self.params.outline)
        found = run("outline", None, find_outline, pyramid, camera, *sought)
        if isinstance(found, StageFailure):
            return found
        bound = self.params.log10_false_alarm
        posed = run("outline", None, outline_pose, found, pyramid, camera, self.pad, bound)
        if isinstance(posed, StageFailure):
            return posed
        side_px = math.sqrt(cv2.contourArea(found.corners_xy.astype(np.float32)))
        share, attitude_deg = limits.most_position_share, limits.most_attitude_deg
        return unsure(posed.pose, posed.covariance, side_px, share, attitude_deg) or posed

    def _from_windows(
        self, frame: _Frame, regions: Sequence[Region], nearest: StageFailure
    ) -> Detection:
        """The pose from the first scale at which a window is read."""
        attempts = 0
        # From near, the pad's colour falls apart into regions; then the whole frame is it.
        for region in dict.fromkeys((regions[0], regions[-1])):
            local = replace(frame, region=region)
            for level in self._levels(local):
                attempts += len(self.decoders)
                found = self._from_window(local, level, attempts)
                if isinstance(found, WindowPose):
                    return _detection(found, found.read.layer.channel)
                if found.reason is Reason.CHANNELS_SWAPPED:
                    return Detection(None, found)
                nearest = max(nearest, found, key=_progress)
        return Detection(None, nearest)

    def _from_window(self, frame: _Frame, level: int, attempts: int) -> WindowPose | StageFailure:
        reads, failures = self._read_channels(frame, level, attempts)
        if not reads:
            return max(failures, key=_progress)
        choice = frame.recorder.run("choose", None, choose_larger, reads)
        run, params, layer = frame.recorder.run, self.params.paper, choice.read.layer
        posed = run("pose", None, window_pose, self.pad, frame.camera, choice.read, params)
        if isinstance(posed, StageFailure):
            return posed
        pose = MovingPose(posed.pose)
        cells = read_layer(frame.pyramid, frame.camera, self.pad, layer, pose, attempts)
        fault = None if cells is None else self._doubt(frame, posed.pose, cells)
        return fault or posed

    def _doubt(self, frame: _Frame, pose: Pose, read: LayerRead) -> StageFailure | None:
        """What the channels show against a pose, where layers share a code (`dense.scales`)."""
        refiner = Refiner(frame.pyramid, frame.camera, self.pad, self.params, 1)
        fault = doubt(refiner, MovingPose(pose), read)
        if fault is not None:
            frame.recorder.note("pose", None, fault)
        return fault

    def _levels(self, frame: _Frame) -> Iterator[int]:
        """Scales of the frame, the coarser ones first: there lines are quick to find."""
        side, params = frame.region.box.side, self.params.paper
        first = max(0, math.ceil(math.log2(max(side / params.coarsest_px, 1.0))))
        last = max(0, math.ceil(math.log2(max(side / params.finest_px, 1.0))))
        yield from range(first, last - 1, -1)

    def _read_channels(
        self, frame: _Frame, level: int, attempts: int
    ) -> tuple[list[WindowRead], list[StageFailure]]:
        reads: list[WindowRead] = []
        failures: list[StageFailure] = []
        for channel in self.decoders:
            found = self._read_channel(frame, channel, level, attempts)
            if isinstance(found, StageFailure):
                failures.append(found)
                continue
            reads.append(found)
            # Smaller windows would lose; a trace shows them all the same.
            if not frame.recorder.keep:
                break
        return reads, failures

    def _read_channel(
        self, frame: _Frame, channel: Channel, level: int, attempts: int
    ) -> WindowRead | StageFailure:
        run, params = frame.recorder.run, self.params.paper
        plane = run(
            "channel",
            channel,
            take_channel,
            frame.pyramid,
            frame.stretch,
            channel,
            level,
            frame.region.box,
        )
        grid = self._find_lines(frame, plane)
        if isinstance(grid, StageFailure):
            return grid
        window = run("grid", channel, central_window, grid, self.pad.window)
        if isinstance(window, StageFailure):
            return window
        decoder = self.decoders[channel]
        return run("decode", channel, decoder.decode, frame.pyramid, window, attempts, params)

    def _find_lines(self, frame: _Frame, plane: Plane) -> LineGrid | StageFailure:
        run, params, channel = frame.recorder.run, self.params.paper, plane.channel
        binary = run("block_mean", channel, block_mean, plane, params.blocks)
        cleaned = run("clean", channel, clean, binary, params.speck_px)
        edges = run(
            "edges",
            channel,
            find_edge_map,
            cleaned,
            frame.region,
            frame.camera,
            self.pad.levels,
            params,
        )
        if isinstance(edges, StageFailure):
            return edges
        lines = run("lines", channel, find_merged_lines, edges, params)
        if isinstance(lines, StageFailure):
            return lines
        return run("lines", channel, find_line_grid, lines)


def _is_cut(region: Region, pyramid: Pyramid) -> bool:
    """Whether a region reaches beyond the frame."""
    margin = 1 << region.level
    box = region.box
    return (
        min(box.x0, box.y0) < margin
        or box.x1 > pyramid.width - margin
        or box.y1 > pyramid.height - margin
    )


def _progress(failure: StageFailure) -> int:
    return failure.progress


def _detection(found: WindowPose | OutlinePose, layer: LayerName) -> Detection:
    evidence = found.read.evidence
    return Detection(
        pose=found.pose,
        layer=layer,
        cells_read=evidence.read,
        cells_wrong=evidence.wrong,
        log10_false_alarm=evidence.log10_false_alarm,
        reprojection_px=found.rms_px,
        uncertainty=Uncertainty.of(found.pose, found.covariance),
    )
