"""The kinds of experiments: what an order looks like, what makes it, and with what."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import Body
from pydantic import Discriminator, Tag

from padstudio.experiments.budget.order import BudgetOrder as Budget
from padstudio.experiments.budget.run import budget_report
from padstudio.experiments.report import Experiment
from padstudio.experiments.reproduction.experiment import reproduce
from padstudio.experiments.reproduction.plan import paper_camera
from padstudio.experiments.shootout.order import Shootout
from padstudio.experiments.shootout.report import run as shoot_out
from padstudio.geometry.camera import Camera
from padstudio.store.store import Store
from padstudio.web.api.cameras import camera_text
from padstudio.web.schemas.experiments import budget, reproduction, shootout
from padstudio.web.schemas.experiments.budget import BudgetOrder
from padstudio.web.schemas.experiments.reproduction import ReproductionOrder
from padstudio.web.schemas.experiments.shootout import ShootoutOrder


def _kind(order: Any) -> Any:
    return order.get("kind") if isinstance(order, dict) else getattr(order, "kind", None)


#: All orders, which `kind` tells apart.
NewExperiment = Annotated[
    Annotated[ReproductionOrder, Tag("reproduction")]
    | Annotated[ShootoutOrder, Tag("shootout")]
    | Annotated[BudgetOrder, Tag("budget")],
    Discriminator(
        _kind,
        custom_error_type="unknown_kind",
        custom_error_message="kind must be one of reproduction, shootout, budget",
    ),
    Body(
        openapi_examples={
            "reproduction": {"value": reproduction.EXAMPLE},
            "shootout": {"value": shootout.EXAMPLE},
            "budget": {"value": budget.EXAMPLE},
        }
    ),
]


@dataclass(frozen=True)
class Kind:
    """A kind of experiment.

    Attributes
    ----------
    name : str
        What one is called that was given no name.
    make : Experiment
        Runs in a worker process.
    prepare : callable
        Makes of an order, and of what is stored, what `make` takes: ids of pads and cameras become
        their files. May raise any `StudioError`.
    camera : callable
        Whose frames are simulated, of what was prepared.
    """

    name: str
    make: Experiment
    prepare: Callable[[Any, Store], dict[str, Any]]
    camera: Callable[[Mapping[str, Any]], Camera]


def _as_it_is(order: ReproductionOrder, store: Store) -> dict[str, Any]:
    return {"seeds": order.seeds, "only": order.only}


def _with_files(order: ShootoutOrder | BudgetOrder, store: Store) -> dict[str, Any]:
    """The order with the contents of its pad's and its camera's files."""
    asked = order.model_dump(exclude={"kind", "name"})
    asked["pad"] = store.pads.get(order.pad).content or ""
    asked["camera"] = camera_text(store, order.camera)
    return asked


def _shootout(order: ShootoutOrder, store: Store) -> dict[str, Any]:
    """A shoot-out that can be simulated; refused here, rather than when its turn comes."""
    asked = _with_files(order, store)
    Shootout.of(asked)
    return asked


def _budget(order: BudgetOrder, store: Store) -> dict[str, Any]:
    """A budget that can be made; refused here, too."""
    asked = _with_files(order, store)
    Budget.from_plain(asked)
    return asked


def _own_camera(prepared: Mapping[str, Any]) -> Camera:
    return Camera.loads(prepared["camera"])


KINDS = {
    "reproduction": Kind(
        "the paper's experiments", reproduce, _as_it_is, lambda prepared: paper_camera()
    ),
    "shootout": Kind("shoot-out", shoot_out, _shootout, _own_camera),
    "budget": Kind("error budget", budget_report, _budget, _own_camera),
}
