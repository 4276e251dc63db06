"""Decide who may ask: a token in every address, this machine's names in ``Host``, no foreign ``Origin``.

Any page open in a browser of this machine can send requests to a port of it, and a name that leads
elsewhere first and here later (DNS rebinding) passes for its own origin. The token keeps out both,
and other users of the machine; ``Host`` and ``Origin`` are looked at all the same.
"""

from __future__ import annotations

import hmac
import re
import secrets

from playground.errors import ParameterError

_TOKEN = re.compile(r"[A-Za-z0-9_-]{16,128}")


def new_token() -> str:
    """Return a random token."""
    return secrets.token_urlsafe(24)


def check_token(token: str) -> str:
    """Return a token of the user's own; raise ``ParameterError`` for one that is too short, or no word."""
    if not _TOKEN.fullmatch(token):
        raise ParameterError(
            "the remote's token has 16 to 128 letters, digits, - and _"
            f" (found {len(token)} characters); without one, a random one is made"
        )
    return token


def refusal(host: str | None, origin: str | None, token: str, *, token_expected: str, port: int) -> str:
    """Return why a request is refused, in a message; "" for one that is not.

    ``host`` and ``origin`` are its headers, ``token`` what its address gives for ``token_expected``.
    """
    names = {f"127.0.0.1:{port}", f"localhost:{port}"}
    if host not in names:
        return f"this remote is http://127.0.0.1:{port}, and the request's Host is another"
    if origin is not None and origin not in {f"http://{name}" for name in names}:
        return "a page of another origin may not use this remote"
    if not hmac.compare_digest(token.encode("utf-8", "surrogatepass"), token_expected.encode()):
        return "the address lacks the token that playground live prints"
    return ""
