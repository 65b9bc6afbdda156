"""What an order of the paper's experiments looks like; the OpenAPI file's source."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import ConfigDict, Field

from padstudio.experiments.reproduction.plan import EXPERIMENTS, MOST_SEEDS, ExperimentName
from padstudio.web.schemas.asked import Asked

EXAMPLE: dict[str, Any] = {"kind": "reproduction", "seeds": 5, "only": ["ranges", "landing"]}


class ReproductionOrder(Asked):
    """The paper's experiments, to be made again."""

    model_config = ConfigDict(json_schema_extra={"examples": [EXAMPLE]})

    kind: Literal["reproduction"]
    name: str | None = Field(None, min_length=1, max_length=200)
    seeds: int = Field(5, ge=1, le=MOST_SEEDS, description="Frames of each place, each different.")
    only: list[ExperimentName] = Field(
        default_factory=list,
        max_length=len(EXPERIMENTS),
        description="Which experiments; none names all.",
    )
