"""Asks a server, again where the connection breaks; its errors are ours."""

from __future__ import annotations

import json
import ssl
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, ClassVar, TypeVar

import httpx

from padstudio import __version__
from padstudio.errors import StudioError

AnswerT = TypeVar("AnswerT")

API = "/api/v1"
#: Where the token of a server is read from.
TOKEN = "PADSTUDIO_TOKEN"

# A proxy that lost the server, or a server that has enough to do at present.
_PASSING = (429, 502, 503, 504)
_FIRST_WAIT_S, _LONGEST_WAIT_S = 0.5, 15.0
# Reading is long as the last bytes of an upload are answered when the file was examined.
_TIMEOUT = httpx.Timeout(30.0, read=180.0)


class ServerError(StudioError):
    """The server cannot be reached, is none, or refuses what it was asked for."""

    code = "server_error"
    #: Of the server's answer; 0 where there is none.
    answered: int = 0


class ServerDefectError(ServerError):
    """A fault of the server's program."""

    code = "internal_error"
    exit_code: ClassVar[int] = 70


class Server:
    """A server of Pad Studio.

    Every request may be sent twice without harm: what is stored again is recognised, and flights
    are ordered under a key.

    Parameters
    ----------
    address : str
        ``https://host`` or ``http://host:port``.
    token : str or None
    patience_s : float
        Give up after so long without an answer.
    tell : callable
        Told once why nothing goes on at present.

    Raises
    ------
    ServerError
        If the address is none, or holds a secret.
    """

    def __init__(
        self,
        address: str,
        token: str | None,
        *,
        patience_s: float = 300.0,
        tell: Callable[[str], None] = print,
    ) -> None:
        self.address = _checked(address)
        if token and _is_overheard(self.address):
            tell(
                f"{self.address} is not encrypted: others on the way can read the token; use https"
            )
        self._patience_s, self._tell = patience_s, tell
        headers = {"User-Agent": f"padstudio/{__version__}"}
        if token:
            try:
                headers["Authorization"] = f"Bearer {token.encode('ascii').decode()}"
            except UnicodeError:
                raise ServerError(
                    f"{TOKEN} holds characters that no token has", code="token_required"
                ) from None
        # Redirects are not followed: they would take the token elsewhere.
        self._client = httpx.Client(
            base_url=self.address, headers=headers, timeout=_TIMEOUT, follow_redirects=False
        )

    def close(self) -> None:
        """Let go of connections."""
        self._client.close()

    def greet(self) -> str:
        """The server's version.

        Raises
        ------
        ServerError
            If nothing answers there, it is something else, or of another release.
        """
        answer = self.once("GET", f"{API}/health")
        try:
            version = str(answer.json()["version"])
        except (ValueError, KeyError, TypeError):
            raise self._no_studio() from None
        if _release(version) != _release(__version__):
            older = _release(version) < _release(__version__)
            raise ServerError(
                f"the server is of Pad Studio {version}, {'older' if older else 'newer'} than this "
                f"program, {__version__}: bring both to one release",
                code="version_differs",
            )
        return version

    def once(self, method: str, path: str, **options: Any) -> httpx.Response:
        """Ask once.

        Parameters
        ----------
        method, path : str
        **options
            As of `httpx.Client.request`.

        Raises
        ------
        ServerError
            If there is no answer (status 0), or it is an error's.
        """
        with self._translated():
            answer = self._client.request(method, path, **options)
        self._check(answer)
        return answer

    def ask(self, method: str, path: str, **options: Any) -> httpx.Response:
        """Ask until there is an answer, or patience ends; as `once`."""
        return self.insist(lambda: self.once(method, path, **options))

    def json(self, method: str, path: str, **options: Any) -> Any:
        """What `ask` is answered, read."""
        answer = self.ask(method, f"{API}{path}", **options)
        try:
            return answer.json()
        except ValueError:
            raise self._no_studio() from None

    def insist(self, step: Callable[[], AnswerT]) -> AnswerT:
        """Do something again and again while only the connection keeps it from being done."""
        end, wait_s, told = time.monotonic() + self._patience_s, _FIRST_WAIT_S, False
        while True:
            try:
                return step()
            except ServerError as error:
                if not is_passing(error) or time.monotonic() + wait_s > end:
                    raise
                if not told:
                    self._tell(f"{error.message}; trying again")
                    told = True
                time.sleep(wait_s)
                wait_s = min(2 * wait_s, _LONGEST_WAIT_S)

    @contextmanager
    def stream(self, method: str, path: str, **options: Any) -> Iterator[httpx.Response]:
        """An answer that is read piece by piece, once; raises as `once`."""
        with (
            self._translated(),
            self._client.stream(method, f"{API}{path}", **options) as answer,
        ):
            if answer.status_code >= 300:
                answer.read()
            self._check(answer)
            yield answer

    @contextmanager
    def _translated(self) -> Iterator[None]:
        try:
            yield
        except httpx.TransportError as error:
            raise self._unreachable(error) from error

    def _unreachable(self, error: httpx.TransportError) -> ServerError:
        cause: BaseException | None = error
        while cause is not None:
            if isinstance(cause, ssl.SSLCertVerificationError):
                return ServerError(
                    f"the certificate of {self.address} is not trusted: {cause.verify_message}; "
                    "SSL_CERT_FILE names the file of another authority",
                    code="certificate",
                )
            cause = cause.__cause__ or cause.__context__
        why = str(error) or type(error).__name__
        return ServerError(
            f"{self.address} does not answer ({why}); is the server running, and is that its "
            "address?",
            code="unreachable",
        )

    def _check(self, answer: httpx.Response) -> None:
        status = answer.status_code
        if status < 300:
            return
        if status < 400:
            raise ServerError(
                f"{self.address} leads on to {answer.headers.get('location', 'elsewhere')}, which "
                "is not followed; give the address where the server itself answers",
                code="redirected",
            )
        try:
            body = answer.json()["error"]
            code, message, detail = str(body["code"]), str(body["message"]), body.get("detail")
        except (ValueError, KeyError, TypeError):
            error = self._no_studio(f" (status {status})")
        else:
            if code == "token_required":
                message = f"the server asks for its token: set {TOKEN} in the environment"
            kind = ServerDefectError if code == "internal_error" else ServerError
            error = kind(message, code=code, detail=detail)
        error.answered = status
        raise error

    def _no_studio(self, what: str = "") -> ServerError:
        return ServerError(
            f"{self.address} answers, but not as a Pad Studio server{what}", code="no_studio"
        )


def is_passing(error: ServerError) -> bool:
    """True where the same request may succeed in a while."""
    return error.error_code == "unreachable" or error.answered in _PASSING


def _release(version: str) -> tuple[int, ...]:
    """Major and minor: within one release requests and answers stay the same."""
    parts = version.split(".")[:2]
    return tuple(int(part) if part.isdecimal() and len(part) < 10 else -1 for part in parts)


def _is_overheard(address: str) -> bool:
    url = httpx.URL(address)
    return url.scheme == "http" and url.host not in ("localhost", "127.0.0.1", "::1")


def _checked(address: str) -> str:
    """The address without what belongs into requests alone."""
    try:
        url = httpx.URL(address)
    except httpx.InvalidURL as error:
        raise ServerError(f"--server is no address: {error}", code="invalid_server") from error
    if url.userinfo or url.query or url.fragment:
        raise ServerError(
            "--server must hold neither token nor password, which other users of this machine "
            f"could read: give the address alone, and the token in {TOKEN}",
            code="invalid_server",
        )
    if url.scheme not in ("http", "https") or not url.host:
        raise ServerError(
            "--server must be an address such as https://studio.example or http://127.0.0.1:8000",
            code="invalid_server",
        )
    return str(url).rstrip("/")


def error_of(found: dict[str, Any] | None) -> tuple[str, str]:
    """Message and code of what stands in a flight as its error."""
    error = found or {}
    return str(error.get("message", json.dumps(found))), str(error.get("code", "failed"))
