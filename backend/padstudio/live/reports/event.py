"""What happens to a stream, for outputs that tell of it."""

from __future__ import annotations

from typing import Literal, Protocol, TypeGuard, runtime_checkable

from padstudio.live.reports.source import Phase

#: The source's phases; its frames have another size; they are not of the camera file's.
EventKind = Phase | Literal["size", "frames_refused"]


@runtime_checkable
class EventOutput(Protocol):
    """An output that hears of its stream, too; called in the thread that reads frames."""

    def stream_changed(self, kind: EventKind, detail: str, code: str) -> None:
        """The stream is in another phase, or its frames have another size."""


def takes_events(output: object) -> TypeGuard[EventOutput]:
    """True where an output hears of its stream."""
    return isinstance(output, EventOutput)
