"""Options of how frames are read: those of ``padstudio detect``, here or by a server."""

from __future__ import annotations

from typing import Annotated, Literal

import typer

Topic = Annotated[
    str | None, typer.Option(help="Of recordings: the topic with the pictures, if several have.")
]
Output = Annotated[str, typer.Option("-o", "--output", help="Poses file to write; - is stdout.")]
MethodName = Annotated[
    Literal["dense", "paper"],
    typer.Option(help="dense: all that is in the picture; paper: the published method."),
]
Unmix = Annotated[
    bool, typer.Option(help="Un-mix colours by the pad's crosstalk, where it has one.")
]
AtRest = Annotated[bool, typer.Option("--at-rest", help="The camera stood still, as on a tripod.")]
Param = Annotated[
    list[str] | None,
    typer.Option(
        "--param",
        metavar="NAME=VALUE",
        help="A detector parameter, as search.least_step=0.4; again for more.",
    ),
]
Stride = Annotated[int, typer.Option(min=1, help="Read every n-th frame of videos.")]
Rotation = Annotated[bool, typer.Option(help="Turn videos as their rotation flag says.")]
Fuse = Annotated[
    bool, typer.Option(help="Fuse the poses of a video over time, each by its own covariance.")
]
Smooth = Annotated[
    bool, typer.Option("--smooth", help="Fuse them with later frames, too: for recordings.")
]
Quiet = Annotated[bool, typer.Option("-q", "--quiet", help="No summary.")]
