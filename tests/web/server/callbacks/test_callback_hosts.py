"""Which addresses a server may call."""

from __future__ import annotations

import socket
import string
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from padstudio.errors import SpecError
from padstudio.web.server.callbacks.hosts import CallbackError, CallbackHosts, resolve
from padstudio.web.server.settings import load_settings

HOSTS = CallbackHosts(["hooks.example", "build.example:8443", "[::1]:80", "10.0.0.7"])


@pytest.mark.parametrize(
    "url",
    [
        "https://hooks.example/a?b=c",
        "http://hooks.example/",
        "https://HOOKS.example:443/",
        "https://build.example:8443/x",
        "http://build.example:8443/x",
        "http://[::1]/",
        "https://10.0.0.7/",
    ],
)
def test_listed_hosts_may_be_called(url: str) -> None:
    assert str(HOSTS.check(url)).lower().startswith(url.lower().split("/")[0])


@pytest.mark.parametrize(
    "url",
    [
        "https://other.example/",
        "https://hooks.example.evil.example/",
        "https://sub.hooks.example/",
        "https://hooks.example:8443/",
        "https://build.example/",
        "http://hooks.example:443/",
        "https://hooks.example@other.example/",
        "https://user:secret@hooks.example/",
        "https://other.example\\@hooks.example/",
        "https://other.example#@hooks.example/",
        "https://hooks.example/#part",
        "https://hooks.example/\r\nX: y",
        "https://hooks.example /",
        "ftp://hooks.example/",
        "file:///etc/passwd",
        "hooks.example",
        "//hooks.example/",
        "http://[::2]/",
        "http://127.0.0.1/",
        "http://0x0a000007/",
        "https://hooks.example/" + "a" * 2000,
        "",
    ],
)
def test_others_may_not(url: str) -> None:
    with pytest.raises(SpecError) as caught:
        HOSTS.check(url)
    assert caught.value.error_code == "callback_refused"


def test_without_a_list_nobody_may_be_called() -> None:
    with pytest.raises(SpecError, match="PADSTUDIO_CALLBACK_HOSTS"):
        CallbackHosts([]).check("https://hooks.example/")


@given(st.text(string.printable, max_size=40), st.sampled_from(["http", "https"]))
def test_whatever_is_asked_for_leads_to_a_listed_host_or_nowhere(text: str, scheme: str) -> None:
    for url in (text, f"{scheme}://{text}", f"{scheme}://hooks.example{text}"):
        try:
            checked = HOSTS.check(url)
        except SpecError:
            continue
        assert checked.host in ("hooks.example", "build.example", "::1", "10.0.0.7")
        assert not checked.userinfo


@pytest.mark.parametrize("entry", ["a/", "https://a", "user@a", "*", "*.a", "", "a b", "ä", "a:x"])
def test_an_entry_is_a_host_or_a_host_and_a_port(
    entry: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    with pytest.raises(ValueError, match="host or host:port"):
        CallbackHosts([entry])
    with pytest.raises(SpecError, match="PADSTUDIO_CALLBACK_HOSTS"):
        load_settings(callback_hosts=(entry,), callback_secret="a" * 24)


def test_hosts_without_a_secret_are_refused() -> None:
    with pytest.raises(SpecError, match="PADSTUDIO_CALLBACK_SECRET"):
        load_settings(callback_hosts=("a.example",))
    assert "s" * 24 not in repr(load_settings(callback_secret="s" * 24))


def _leads_to(monkeypatch: pytest.MonkeyPatch, *addresses: str) -> None:
    def found(host: str, port: int, **_: Any) -> list[Any]:
        return [(0, 0, 0, "", (address, port)) for address in addresses]

    monkeypatch.setattr(socket, "getaddrinfo", found)


@pytest.mark.parametrize("address", ["169.254.169.254", "fe80::1%eth0", "224.0.0.1", "0.0.0.0",
                                     "::ffff:169.254.169.254", "::"])  # fmt: skip
def test_a_name_that_leads_to_where_clouds_keep_secrets_is_not_called(
    address: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    _leads_to(monkeypatch, address)
    with pytest.raises(CallbackError, match=r"hooks\.example leads to"):
        resolve("hooks.example", 443)
    _leads_to(monkeypatch, address, "192.0.2.7")
    assert resolve("hooks.example", 443) == "192.0.2.7"


def test_a_name_may_lead_to_a_private_network(monkeypatch: pytest.MonkeyPatch) -> None:
    _leads_to(monkeypatch, "10.1.2.3")
    assert resolve("build.internal", 443) == "10.1.2.3"


def test_a_name_without_an_address_is_told() -> None:
    with pytest.raises(CallbackError, match=r"no\.such\.invalid has no address"):
        resolve("no.such.invalid", 443)
