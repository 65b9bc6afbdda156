"""Where and at which scale a search looks, and what each look promises.

A look costs its edges, which grow with the picture's area, and a glance at some hundreds of them:
do they agree on any plane with lines at right angles? Ground of no order ends there, whatever its
texture; what follows is the dearer part, and only so many looks get that far.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

from padstudio.geometry.camera import Camera
from padstudio.pad.spec import Channel
from padstudio.vision.cells.correlation import LayerIndex
from padstudio.vision.frame.prepare import Stretch, take_channel
from padstudio.vision.frame.pyramid import Plane, Pyramid
from padstudio.vision.frame.regions import Region
from padstudio.vision.search.edges import EdgeSet, Steps, find_steps
from padstudio.vision.search.foreign import explained, within
from padstudio.vision.search.known_pads import FoundPad, KnownPad
from padstudio.vision.search.lattice import Lattice
from padstudio.vision.search.plane_normals import coherence_of
from padstudio.vision.stage.params import DetectorParams, SearchParams
from padstudio.vision.stage.trace import Recorder

# So many edges tell whether all are worth while.
_GLANCE = 400
# A pattern on whose lines more than this share of a look's steps lie is all that it shows. Of
# another pattern's steps half lie there by chance.
_ALL_BUT = 0.67


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
    is_rest : bool
        What lies on the lines of a pattern that is no pad's was left out.
    """

    region: Region
    level: int
    channel: Channel
    steps: Steps
    camera: Camera
    is_rest: bool = False

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

    def beside(self, found: FoundPad) -> Look:
        """The look without what shows a pad that was found; the same where that is nothing."""
        shown = found.shows(self.steps.xy)
        if not shown.any():
            return self
        return replace(self, steps=self.steps.take(~shown))

    def without(self, pattern: Lattice) -> Look:
        """The look without what lies on the lines of a pattern; the same where that is nothing.

        Nothing is left of a look that shows hardly anything besides.
        """
        on_lines = explained(pattern, self.camera.normalize(self.steps.xy))
        if not on_lines.any():
            return self
        rest = ~on_lines & (on_lines.mean() < _ALL_BUT)
        return replace(self, steps=self.steps.take(rest), is_rest=True)

    def _beyond_chance(self, *, steep: bool) -> float:
        edges = self._glance
        if not len(edges.xy):
            return 0.0
        return coherence_of(edges, steep=steep) - 1 / math.sqrt(len(edges.xy))


@dataclass(frozen=True)
class Search:
    """What a search needs to know of its frame, and what came of it so far.

    Attributes
    ----------
    pyramid : Pyramid
    camera : Camera
    stretch : Stretch
    known : tuple of KnownPad
        All pads that are looked for, of the same channels.
    params : DetectorParams
    recorder : Recorder
    elsewhere : int
        Layers of pads that are looked for in other planes of the same frame.
    one_suffices : bool
        Nothing is wanted any more once a pad has a pose that can be used as a whole.
    lattices : list of Lattice
        What was tried against the pads: each try weakens the evidence of the next.
    looks : dict
        What was made of a region, at a level and in a channel.
    found : list of FoundPad
        The rest of the search leaves out these pads, and what shows them.
    foreign : list of Lattice
        Clear patterns that are no pad's; looks leave out what lies on their lines.
    parts, scales : dict
        What was left of regions, and at which scales they are looked at.
    """

    pyramid: Pyramid
    camera: Camera
    stretch: Stretch
    known: tuple[KnownPad, ...]
    params: DetectorParams
    recorder: Recorder
    elsewhere: int = 0
    one_suffices: bool = False
    lattices: list[Lattice] = field(default_factory=list)
    looks: dict[tuple[Region, int, Channel], Look] = field(default_factory=dict)
    found: list[FoundPad] = field(default_factory=list)
    foreign: list[Lattice] = field(default_factory=list)
    parts: dict[tuple[Region, FoundPad], list[Region]] = field(default_factory=dict)
    scales: dict[Region, list[tuple[Region, int]]] = field(default_factory=dict)

    @property
    def wanted(self) -> list[KnownPad]:
        """Pads that were not found yet; none where the one that was found suffices."""
        done = [found.known for found in self.found]
        if self.suffices:
            return []
        return [pad for pad in self.known if pad not in done]

    @property
    def suffices(self) -> bool:
        """True where nothing more is to be found."""
        poses = (found.detection for found in self.found)
        return self.one_suffices and any(pose.quality == "full" for pose in poses)

    @property
    def channels(self) -> list[Channel]:
        """Of the pads' layers, those of the largest cells first."""
        sizes: dict[Channel, float] = {}
        for pad in self.known:
            for index in pad.indices:
                channel, size = index.layer.channel, index.layer.cell_mm
                sizes[channel] = max(size, sizes.get(channel, 0.0))
        return sorted(sizes, key=lambda channel: -sizes[channel])

    @property
    def looked_at(self) -> list[Channel]:
        """Channels in which lattices are looked for: of a grey picture one is all of them."""
        return self.channels[:1] if self.stretch.grey else self.channels

    @property
    def attempts(self) -> int:
        """How many lattices were compared with how many layers, of all pads."""
        layers = sum(len(pad.indices) for pad in self.known)
        return len(self.lattices) * (layers + self.elsewhere)

    def shows_foreign(self, region: Region) -> bool:
        """True where most of a region shows a pattern that was read, and is no pad's."""
        if region.mask is None or not self.foreign:
            return False
        normalized = self.camera.normalize(region.points())
        return any(within(pattern, normalized).mean() > 0.5 for pattern in self.foreign)

    def at(self, channel: Channel) -> list[tuple[KnownPad, LayerIndex]]:
        """Layers in a channel, of pads that were not found yet."""
        return [
            (pad, index)
            for pad in self.wanted
            for index in pad.indices
            if index.layer.channel == channel
        ]

    def left_of(self, region: Region) -> list[Region]:
        """Parts of a region that show no pad that was found, the same ones every time."""
        parts = [region]
        for found in self.found:
            for part in parts:
                if (part, found) not in self.parts:
                    self.parts[part, found] = found.left_of(part)
            parts = [rest for part in parts for rest in self.parts[part, found]]
        return parts

    def places(self, regions: Iterable[Region]) -> Iterator[tuple[Region, int]]:
        """What is left of regions, at the scales that suit it, the same ones every time."""
        for region in regions:
            for part in self.left_of(region):
                if part not in self.scales:
                    middles = self.stretch.grey or part.mask is not None
                    self.scales[part] = list(_scales_of(part, self.params.search, middles))
                yield from self.scales[part]

    def look(self, region: Region, level: int, channel: Channel) -> Look:
        """One channel of a region at a scale; its edges are found once, and those left out that
        show a pad that was found."""
        key = (region, level, channel)
        if key not in self.looks:
            plane = self.recorder.run(
                "channel", channel, take_channel,
                self.pyramid, self.stretch, channel, level, region.box,
            )  # fmt: skip
            steps = self.recorder.run(
                "edges", channel, _steps_in, plane, self.params.search, region, self.stretch.veiled
            )
            self.looks[key] = self.recorder.make(
                "lines", Look, region, level, channel, steps, self.camera
            )
        for found in self.found:
            self.looks[key] = self.looks[key].beside(found)
        for pattern in self.foreign:
            self.looks[key] = self.looks[key].without(pattern)
        return self.looks[key]


def _steps_in(plane: Plane, params: SearchParams, region: Region, noisy: bool) -> Steps:
    steps = find_steps(plane, params, noisy=noisy)
    return steps if region.mask is None else steps.take(region.holds(steps.xy))


def _scales_of(region: Region, params: SearchParams, middles: bool) -> Iterator[tuple[Region, int]]:
    """A region at the scales that suit it; at finer ones its middle, where it pays."""
    coarsest = max(0, math.floor(math.log2(max(region.box.side / params.coarsest_px, 1))))
    finest = max(0, math.ceil(math.log2(max(region.box.side / params.finest_px, 1))))
    for level in range(max(coarsest, finest), finest - 1, -1):
        yield region, level
    if middles:
        for level in range(finest - 1, -1, -1):
            yield region.middle(params.finest_px << level), level
