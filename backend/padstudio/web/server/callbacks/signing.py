"""What a callback says, and how its receiver can tell that it is ours.

Headers and signature are those of Standard Webhooks
(https://github.com/standard-webhooks/standard-webhooks/blob/main/spec/standard-webhooks.md).
"""

from __future__ import annotations

import base64
import hashlib
import hmac
import json
from datetime import UTC, datetime
from typing import Any

from padstudio.store.database.flight_tables import FlightRow


def message(flight: FlightRow) -> bytes:
    """The body: what happened, when, and to which flight.

    Parameters
    ----------
    flight : FlightRow
        One that has ended.

    Returns
    -------
    bytes
        JSON; links are paths on the server.
    """
    api = f"/api/v1/flights/{flight.id}"
    data: dict[str, Any] = {
        "id": flight.id,
        "name": flight.name,
        "state": flight.state,
        "created_at": _time(flight.created_at),
        "started_at": _time(flight.started_at),
        "finished_at": _time(flight.finished_at),
        "frames_total": flight.frames_total,
        "frames_done": flight.frames_done,
        "frames_ok": flight.frames_ok,
        "error": flight.error,
        "links": {
            "flight": api,
            "summary": f"{api}/summary",
            "poses": f"{api}/export/jsonl",
            "page": f"/flights/{flight.id}",
        },
    }
    told = {"type": f"flight.{flight.state}", "timestamp": data["finished_at"], "data": data}
    return json.dumps(told, ensure_ascii=False).encode()


def headers(secret: str, delivery: str, body: bytes, now: datetime) -> dict[str, str]:
    """The headers that name and sign a callback.

    Parameters
    ----------
    secret : str
        Its UTF-8 bytes are the key.
    delivery : str
        The same in all attempts.
    body : bytes
    now : datetime
        Of this attempt; receivers refuse old ones, lest somebody send them again.
    """
    seconds = str(int(now.timestamp()))
    signed = b".".join((delivery.encode(), seconds.encode(), body))
    digest = hmac.new(secret.encode(), signed, hashlib.sha256).digest()
    return {
        "webhook-id": delivery,
        "webhook-timestamp": seconds,
        "webhook-signature": "v1," + base64.b64encode(digest).decode(),
    }


def _time(value: datetime | None) -> str | None:
    return None if value is None else value.astimezone(UTC).isoformat().replace("+00:00", "Z")
