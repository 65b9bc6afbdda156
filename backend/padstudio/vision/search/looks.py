"""Where and at which scale a search looks, and what each look promises.

A look costs its edges, which grow with the picture's area, and a glance at some hundreds of them:
do they agree on any plane with lines at right angles? Ground of no order ends there, whatever its
texture; what follows is the dearer part, and only so many looks get that far.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property

from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Channel
from padstudio.vision.cells.correlation import LayerIndex
from padstudio.vision.frame.prepare import Stretch, take_channel
from padstudio.vision.frame.pyramid import Plane, Pyramid
from padstudio.vision.frame.regions import Region
from padstudio.vision.search.edges import EdgeSet, Steps, find_steps
from padstudio.vision.search.lattice import Lattice
from padstudio.vision.search.plane_normals import coherence_of
from padstudio.vision.stage.params import DetectorParams, SearchParams
from padstudio.vision.stage.trace import Recorder

# So many edges tell whether all are worth while.
_GLANCE = 400


@dataclass(frozen=True, eq=False)
class Look:
    """One channel of one region at one scale.

    Attributes
    ----------
    region : Region
    level : int
    channel : {"red", "green", "blue"}
    steps : Steps
    camera : Camera
    """

    region: Region
    level: int
    channel: Channel
    steps: Steps
    camera: Camera

    @cached_property
    def edges(self) -> EdgeSet:
        """All steps, lifted to rays."""
        return self.steps.lifted(self.camera)

    @cached_property
    def _glance(self) -> EdgeSet:
        return self.steps.thinned(_GLANCE).lifted(self.camera)

    @cached_property
    def promise(self) -> float:
        """How well some of the edges agree on a plane tilted by up to 45 degrees, below 1.

        Less what one plane gets by chance, so that few edges do not promise more than many.
        """
        return self._beyond_chance(steep=False)

    @cached_property
    def steep_promise(self) -> float:
        """The same of planes tilted by more."""
        return self._beyond_chance(steep=True)

    def _beyond_chance(self, *, steep: bool) -> float:
        edges = self._glance
        if not len(edges.xy):
            return 0.0
        return coherence_of(edges, steep=steep) - 1 / math.sqrt(len(edges.xy))


@dataclass(frozen=True)
class Search:
    """What a search needs to know of its frame; `indices` stand coarse layer first.

    `lattices` gathers what was tried against the pad: each try weakens the evidence of the next;
    `looks` what was made of a region, at a level and in a channel.
    """

    pyramid: Pyramid
    camera: Camera
    stretch: Stretch
    indices: dict[Channel, LayerIndex]
    params: DetectorParams
    recorder: Recorder
    lattices: list[Lattice] = field(default_factory=list)
    looks: dict[tuple[Region, int, Channel], Look] = field(default_factory=dict)

    def look(self, region: Region, level: int, channel: Channel) -> Look:
        """One channel of a region at a scale; its edges are found once."""
        key = (region, level, channel)
        if key not in self.looks:
            plane = self.recorder.run(
                "channel", channel, take_channel,
                self.pyramid, self.stretch, channel, level, region.box,
            )  # fmt: skip
            steps = self.recorder.run(
                "edges", channel, _steps_in, plane, self.params.search, region
            )
            self.looks[key] = Look(region, level, channel, steps, self.camera)
        return self.looks[key]


def _steps_in(plane: Plane, params: SearchParams, region: Region) -> Steps:
    steps = find_steps(plane, params)
    return steps if region.mask is None else steps.take(region.holds(steps.xy))


def scales_of(regions: Iterable[Region], params: SearchParams) -> Iterator[tuple[Region, int]]:
    """Regions at the scales that suit them; at finer ones their middle, where it pays."""
    for region in regions:
        coarsest = max(0, math.floor(math.log2(max(region.box.side / params.coarsest_px, 1))))
        finest = max(0, math.ceil(math.log2(max(region.box.side / params.finest_px, 1))))
        for level in range(max(coarsest, finest), finest - 1, -1):
            yield region, level
        if region.mask is not None:
            for level in range(finest - 1, -1, -1):
                yield region.middle(params.finest_px << level), level
