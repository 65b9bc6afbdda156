"""``padstudio verify``: what holds for a pad file, proved from its fields."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated

import typer

from padstudio.cli.support import note
from padstudio.pad.coding.pad_spec import PAPER_COST
from padstudio.pad.coding.verify import Verification
from padstudio.pad.coding.verify_pad import Apart, verify_pad
from padstudio.pad.spec import Pad

_EXAMPLES = (
    "Examples: [bold]padstudio verify pad.json[/] · [bold]padstudio verify pad.json --json | jq[/]"
)


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command(epilog=_EXAMPLES)(verify)


def verify(
    pad: Annotated[Path, typer.Argument(help="Pad file.")],
    as_json: Annotated[
        bool, typer.Option("--json", help="Write everything that was found, as JSON.")
    ] = False,
) -> None:
    """Prove the properties of a pad: each layer's windows, and the layers' beside each other.

    Ends with 1 where the pad does not hold what its file promises.
    """
    found = verify_pad(Pad.load(pad))
    if as_json:
        print(json.dumps(found.to_dict(), indent=1))
    else:
        for channel, layer in found.layers:
            print(f"{channel}: {layer.rows} x {layer.cols} cells, {_layer_in_words(layer)}")
        for pair in found.apart:
            print(f"{' and '.join(pair.channels)}: {_pair_in_words(pair)}")
    if found.relation == "shared":
        note(f"layers that share a code: {PAPER_COST}")
    if found.broken:
        note(f"{pad} promises what does not hold: {'; '.join(found.broken)}")
        raise typer.Exit(1)


def _layer_in_words(layer: Verification) -> str:
    if not layer.unique:
        return f"a window of {layer.window} x {layer.window} occurs twice"
    turned = layer.unique_under_rotation
    least = layer.min_distance_under_rotation if turned else layer.min_distance
    how = "in all four turns" if turned else "as printed"
    return f"each window once {how}, windows differ in {_at_least(least)}"


def _pair_in_words(pair: Apart) -> str:
    if pair.relation == "shared":
        copy = f", a copy of the {pair.channels[0]} layer's corner" if pair.is_corner else ""
        return f"shared{copy}: {pair.shared} windows occur in both"
    return f"{pair.relation}: windows differ in {_at_least(pair.min_distance)}, in every turn"


def _at_least(distance: int) -> str:
    return f"at least {distance} cell{'s' if distance > 1 else ''}"
