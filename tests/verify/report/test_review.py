"""The local page: only who has its address may use it, and what it changes is what was looked at."""

from __future__ import annotations

import http.client
import json
import re
import socket
import struct
import threading
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from playground.cli import main
from playground.data.image_files import encode_png, read_png
from playground.errors import DataError
from playground.verify.shots.page.document import policy_of
from playground.verify.shots.results import Record, flat, read_results, record_of, write_result
from playground.verify.shots.review import Review

from ...guards import GENEROUS, ask, assert_guarded
from .pictures import picture

RESULTS = Path("results")
PLACE = Path("screenshots/hills/llvmpipe")


class Client:
    """Sends requests to a review's port, well-formed or not."""

    def __init__(self, review: Review) -> None:
        self.review = review

    def ask(
        self, method: str, path: str, body: object = None, **headers: str
    ) -> tuple[int, str, dict[str, str]]:
        """Send a request below the token; return status, text and headers."""
        return ask(self.review.server, method, path, body, **headers)

    def act(self, action: str, *records: Record, **headers: str) -> list[dict[str, object]]:
        body = {"action": action, "shots": [{"name": r.name, "stamp": r.stamp} for r in records]}
        status, text, _ = self.ask(
            "POST", "act", body, **{"X_Shots_Token": self.review.server.guard.token} | headers
        )
        assert status == 200, text
        return json.loads(text)

    def state(self) -> dict[str, dict[str, str]]:
        return json.loads(self.ask("GET", "state")[1])


@pytest.fixture
def client(leave) -> Iterator[Client]:
    leave("hills/dawn", picture(1), picture(2))
    leave("hills/dusk", picture(3))
    leave("hills/noon", picture(4), picture(4))
    leave("hills/night", word="hang", message="took more than 60 s")
    with Review(RESULTS) as review:
        serving = threading.Thread(target=review.serve, daemon=True)
        serving.start()
        yield Client(review)
        review.end()
        serving.join(GENEROUS)
        assert not serving.is_alive()


def records() -> dict[str, Record]:
    return {record.shot: record for record in read_results(RESULTS)}


def files() -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in PLACE.glob("*")}


# Who may ask


def test_it_listens_on_this_machine_alone(client: Client) -> None:
    assert client.review.server.server_address[0] == "127.0.0.1"
    assert re.fullmatch(r"http://127\.0\.0\.1:\d+/[\w-]{32}/", client.review.url)


def test_nobody_else_sees_or_changes_anything(client: Client) -> None:
    before = files()
    assert_guarded(client.review.server)
    assert files() == before
    assert client.ask("GET", "state", Host=f"localhost:{client.review.server.guard.port}")[0] == 200


def test_a_change_needs_the_token_in_a_header_and_its_own_page(client: Client) -> None:
    before = files()
    dawn = records()["dawn"]
    body = {"action": "accept", "shots": [{"name": dawn.name, "stamp": dawn.stamp}]}
    right = client.review.server.guard.token
    own = f"http://127.0.0.1:{client.review.server.guard.port}"
    for headers in (
        {},
        {"X_Shots_Token": "x"},
        {"X_Shots_Token": "é"},
        {"X_Shots_Token": right, "Origin": "http://evil.example"},
        {"X_Shots_Token": right, "Origin": "null"},
        {"X_Shots_Token": right, "Origin": own.replace("127.0.0.1", "127.0.0.1.evil.example")},
    ):
        assert client.ask("POST", "act", body, **headers)[0] == 403
        assert client.ask("POST", "done", {}, **headers)[0] == 403
    assert client.ask("GET", "act")[0] == 404, "nothing changes by a GET"
    assert files() == before
    assert client.ask("POST", "act", body, X_Shots_Token=right, Origin=own)[0] == 200
    assert files() != before


def test_every_answer_forbids_what_a_page_need_not_do(client: Client) -> None:
    for path in ("", "state", "nothing", "picture/hills/dawn.actual.png"):
        _, _, headers = client.ask("GET", path)
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert headers["Referrer-Policy"] == "no-referrer", "the address is a secret"
        assert headers["Cache-Control"] == "no-store"
        assert headers["X-Frame-Options"] == "DENY"
        policy = headers["Content-Security-Policy"]
        assert policy.startswith("default-src 'none'") and "frame-ancestors 'none'" in policy
        assert "unsafe" not in policy and "http" not in policy
        assert not [name for name in headers if name.lower().startswith("access-control")]
    page_policy = policy_of(client.review.session.setting)
    assert page_policy in client.ask("GET", "")[2]["Content-Security-Policy"]


# What may be requested


@pytest.mark.parametrize(
    "path",
    [
        "picture/../../secret.png",
        "picture/hills/../../secret.png",
        "picture/%2e%2e/%2e%2e/secret.png",
        "picture/..%2f..%2fsecret.png",
        "picture/..%5c..%5csecret.png",
        "picture//etc/passwd",
        "picture/{folder}/secret.png",
        "picture/hills/dawn.json",
        "picture/hills/dawn.actual.png%00",
        "picture/hills/noon.actual.png",
        "../secret.png",
        "nothing",
        "page/report.js",
        "state/",
    ],
)
def test_no_path_leads_to_another_file(client: Client, path: str) -> None:
    Path("secret.png").write_bytes(encode_png(picture(9)))
    status, text, _ = client.ask("GET", path.format(folder=Path.cwd()))
    assert (status, text) == (404, "there is no such page\n")


def test_pictures_are_the_files_as_they_are(client: Client) -> None:
    for record in records().values():
        for name in record.actual.pictures.values():
            status, text, headers = client.ask("GET", f"picture/{name}?x")
            assert status == 200 and headers["Content-Type"] == "image/png"
            assert text.encode("latin-1") == (RESULTS / name).read_bytes()


def test_the_page_is_the_report_with_buttons(client: Client) -> None:
    status, html, _ = client.ask("GET", "")
    assert status == 200
    assert html.count('data-do="accept"') == 2 + html.count("""'[data-do="accept"]'"""), "for dawn and dusk"
    assert client.review.server.guard.token not in html, "what is copied from the page gives nothing away"
    source = re.search(r'src="(picture/[^"]+)"', html)
    assert source and client.ask("GET", source[1])[0] == 200


@pytest.mark.parametrize(
    "body",
    [
        0,
        [],
        {},
        {"action": "erase", "shots": []},
        {"action": "accept", "shots": [{"name": "hills/dawn"}]},
        {"action": "accept", "shots": "hills/dawn"},
    ],
)
def test_a_malformed_request_changes_nothing(client: Client, body: object) -> None:
    before = files()
    status, _, _ = client.ask(
        "POST", "act", body if body is not None else 0, X_Shots_Token=client.review.server.guard.token
    )
    assert status == 400 and files() == before


# What it does


def test_accept_writes_the_reference_and_undo_restores_it(client: Client) -> None:
    before = files()
    dawn = records()["dawn"]
    (answer,) = client.act("accept", dawn)
    assert (
        answer["ok"]
        and answer["message"] == f"wrote {PLACE.as_posix()}/dawn.png  (in place of the one before)"
    )
    np.testing.assert_array_equal(read_png(PLACE / "dawn.png")[0], picture(1))
    assert client.state()["hills/dawn"]["state"] == "accepted"
    assert client.state()["hills/dusk"]["state"] == "open"
    (answer,) = client.act("undo", dawn)
    assert answer["ok"] and answer["message"] == f"restored {PLACE.as_posix()}/dawn.png"
    assert files() == before
    assert client.state()["hills/dawn"]["state"] == "open"


def test_accept_as_further_keeps_the_reference(client: Client) -> None:
    before = files()
    dawn = records()["dawn"]
    assert client.act("also", dawn)[0]["ok"]
    assert files().items() > before.items() and "dawn.2.png" in files()
    assert client.state()["hills/dawn"]["state"] == "further"
    client.act("undo", dawn)
    assert files() == before


def test_several_are_accepted_and_each_refusal_has_its_words(client: Client) -> None:
    result = records()
    answers = client.act("accept", result["dawn"], result["night"], result["noon"], result["dusk"])
    assert [answer["ok"] for answer in answers] == [True, False, False, True]
    assert answers[1]["message"] == "no reference can be made of it (took more than 60 s)"
    assert "it passed" in str(answers[2]["message"])
    assert {"dawn.png", "dusk.png"} <= files().keys()
    assert len(client.review.summary()) == 2


def test_a_second_tab_cannot_accept_or_undo_twice(client: Client) -> None:
    dawn = records()["dawn"]
    assert client.act("undo", dawn)[0] == {
        "name": "hills/dawn",
        "ok": False,
        "message": "nothing to undo",
    }
    client.act("accept", dawn)
    before = files()
    assert client.act("also", dawn)[0]["message"] == "it is accepted already"
    assert files() == before


def test_result_rerun_since_review_is_not_accepted(client: Client) -> None:
    before = files()
    dawn = records()["dawn"]
    write_result(
        RESULTS, record_of(flat(dawn) | {"pictures": {}, "digest": "", "when": 9.0}), {"actual": picture(8)}
    )
    (answer,) = client.act("accept", dawn)
    assert not answer["ok"] and "the tests have run again since" in str(answer["message"])
    assert files() == before
    assert client.state()["hills/dawn"]["stamp"] != dawn.stamp


def test_many_at_once_are_done_one_after_the_other(client: Client) -> None:
    """Of eight tabs that accept the same picture, one does it; what is there is whole."""
    dawn = records()["dawn"]
    answers: list[dict[str, object]] = []
    tabs = [threading.Thread(target=lambda: answers.extend(client.act("also", dawn))) for _ in range(8)]
    for tab in tabs:
        tab.start()
    for tab in tabs:
        tab.join(GENEROUS)
    assert sorted(answer["ok"] for answer in answers) == [False] * 7 + [True]
    assert sorted(files()) == ["dawn.2.png", "dawn.png", "noon.png"]


def test_unreadable_record_is_reported_and_server_continues(client: Client) -> None:
    path = RESULTS / "hills/dawn.json"
    before = path.read_text(encoding="utf-8")
    path.write_text("{", encoding="utf-8")
    status, text, _ = client.ask("GET", "")
    assert status == 500 and "results/hills/dawn.json: not the record of a shot" in text
    path.write_text(before, encoding="utf-8")
    assert client.ask("GET", "")[0] == 200


# Beginning and end


def test_done_ends_it_once_it_is_answered(leave) -> None:
    leave(actual=picture(1))
    with Review(RESULTS) as review:
        serving = threading.Thread(target=review.serve)
        serving.start()
        status, text, _ = Client(review).ask("POST", "done", {}, X_Shots_Token=review.server.guard.token)
        assert (status, text) == (200, "{}")
        serving.join(GENEROUS)
        assert not serving.is_alive()
        assert review.summary() == ["nothing was accepted"]


def test_done_ends_it_also_where_the_client_has_gone(leave, capfd) -> None:
    leave(actual=picture(1))
    with Review(RESULTS) as review:
        serving = threading.Thread(target=review.serve)
        serving.start()
        with socket.create_connection(
            ("127.0.0.1", review.server.guard.port), timeout=GENEROUS
        ) as connection:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
            guard = review.server.guard
            head = f"POST /{guard.token}/done HTTP/1.1\r\nHost: 127.0.0.1:{guard.port}\r\n"
            rest = f"X-Shots-Token: {guard.token}\r\nContent-Length: 2\r\n\r\n{{}}"
            connection.sendall((head + rest).encode())
        serving.join(GENEROUS)
        assert not serving.is_alive() and capfd.readouterr().err == ""


def test_a_port_that_is_taken_is_reported(leave) -> None:
    leave(actual=picture(1))
    with (
        Review(RESULTS) as first,
        pytest.raises(DataError, match=f"cannot listen on port {first.server.guard.port}: "),
    ):
        Review(RESULTS, first.server.guard.port)


def test_review_prints_address_and_accepted_shots_at_end(
    leave, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    record = leave(actual=picture(1), expected=picture(2))
    opened: list[str] = []

    def accept_and_end(url: str) -> None:
        result = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/([\w-]+)/", url)
        assert result, url
        connection = http.client.HTTPConnection("127.0.0.1", int(result[1]), timeout=GENEROUS)
        for path, body in (
            ("act", {"action": "accept", "shots": [{"name": record.name, "stamp": record.stamp}]}),
            ("done", {}),
        ):
            connection.request("POST", f"/{result[2]}/{path}", json.dumps(body), {"X-Shots-Token": result[2]})
            assert connection.getresponse().read()
        connection.close()

    def browse(url: str) -> bool:
        opened.append(url)
        threading.Thread(target=accept_and_end, args=[url]).start()
        return True

    monkeypatch.setattr("webbrowser.open", browse)
    assert main(["shots", "review", "results"]) == 0
    out, err = capsys.readouterr()
    assert out.splitlines() == opened
    assert f"wrote {PLACE.as_posix()}/dawn.png  (in place of the one before)" in err
    assert opened[0].split("/")[3] not in err, "the token is a secret"
