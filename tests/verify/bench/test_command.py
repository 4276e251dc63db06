"""``playground bench``: what it prints, what it writes, how it ends."""

from __future__ import annotations

import json
import sys

import pytest

from playground import cli
from playground.verify.bench.rows import chosen

SMALL = ["bench", "white_noise", "diamond_square", "--size", "33", "--rounds", "2"]


def ran(capsys, *arguments):
    status = cli.main(list(arguments))
    result = capsys.readouterr()
    return status, result.out, result.err


def test_results_are_written_read_again_and_compared(tmp_path, capsys):
    pytest.importorskip("matplotlib")
    first, page = tmp_path / "first.json", tmp_path / "page.html"
    status, out, err = ran(capsys, *SMALL, "-o", str(first))
    assert status == 0 and out.count("\n") >= 4 and "processors" in err
    result = json.loads(first.read_text(encoding="utf-8"))
    assert [figure["name"] for figure in result["figures"]] == ["diamond_square", "white_noise"]
    status, out, _ = ran(capsys, *SMALL, "--against", str(first), "--page", str(page))
    assert status == 0 and "of 2 figures alike" in out
    text = page.read_text(encoding="utf-8")
    assert text.count("<svg") == 3, "bars of the suite, and each figure over time"
    assert "diamond-square" in text and "http" not in text.split("<svg")[0]
    names = [line.split('"')[1] for line in text.split() if line.startswith('id="')]
    assert len(names) == len(set(names)), "an id of one plot is not another's"


def test_what_has_become_slower_fails_where_that_is_asked_for(tmp_path, capsys):
    first = tmp_path / "first.json"
    ran(capsys, "bench", "white_noise", "--size", "33", "--rounds", "3", "-o", str(first))
    result = json.loads(first.read_text(encoding="utf-8"))
    for samples in result["figures"][0]["ours"].values():
        samples["wall"] = [1e-6, 1.1e-6, 1.2e-6]
    first.write_text(json.dumps(result), encoding="utf-8")
    again = ["bench", "white_noise", "--size", "33", "--rounds", "3", "--against", str(first)]
    assert ran(capsys, *again)[0] == 0
    status, out, _ = ran(capsys, *again, "--fail")
    assert status == 1 and "slower" in out


def test_ours_can_be_timed_without_peers(capsys):
    alone = ["bench", "white_noise", "--size", "33", "--rounds", "2", "--json", "--no-peers"]
    (figure,) = json.loads(ran(capsys, *alone)[1])["figures"]
    assert figure["theirs"] == {} and len(figure["ours"]["auto"]["wall"]) == 2
    beside = [row for row in chosen(["frames"]) if "beside" in row.options]
    assert beside and not any("beside" in row.alone().options for row in beside)


def test_the_list_runs_nothing(capsys):
    status, out, _ = ran(capsys, "bench", "--list")
    assert status == 0
    assert "generation\tfourier\t" in out and "≥ 1.2 ×" in out


def test_json_has_every_sample(capsys):
    status, out, _ = ran(capsys, "bench", "white_noise", "--size", "33", "--rounds", "2", "--json")
    result = json.loads(out)
    assert status == 0 and result["changes"] == []
    assert len(result["figures"][0]["ours"]["auto"]["wall"]) == 2


def test_page_without_matplotlib_is_refused_before_any_run(capsys, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    status, _, err = ran(capsys, "bench", "white_noise", "--page", "page.html")
    assert status == 2 and "a page with plots needs matplotlib: " in err
