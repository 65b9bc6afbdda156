"""A longer flight: a video again and again in one file, its packets copied as they are."""

from __future__ import annotations

from pathlib import Path

import av


def looped(video: Path, target: Path, *, times: int = 0, minutes: float = 0.0) -> Path:
    """Write a video so many times, or until it is so long."""
    with av.open(str(video)) as source, av.open(str(target), "w") as container:
        stream = source.streams.video[0]
        copy = container.add_stream_from_template(stream)
        assert stream.duration is not None
        assert stream.time_base is not None
        times = times or round(60 * minutes / float(stream.duration * stream.time_base))
        for place in range(times):
            source.seek(0)
            for packet in source.demux(stream):
                if packet.pts is None or packet.dts is None:
                    continue
                packet.pts += place * stream.duration
                packet.dts += place * stream.duration
                packet.stream = copy
                container.mux(packet)
    return target
