"""`semtopo serve` and `semtopo keys`: who may come in, and how one gets a key."""

from __future__ import annotations

import subprocess
from pathlib import Path

import httpx2
import pytest

from semtopo.errors import InvalidOptionError
from service.app import serve
from service.settings import Settings
from tests.servers import SEMTOPO, Server


def semtopo(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [SEMTOPO, *arguments], cwd=cwd, capture_output=True, text=True, timeout=60, check=False
    )


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "192.0.2.1", "example.org", "", "127.0.0.1.x"])  # noqa: S104 -- refused
def test_other_machines_are_not_served_without_keys(tmp_path: Path, host: str) -> None:
    with pytest.raises(InvalidOptionError, match="--keys"):
        serve(Settings(host=host, database=f"sqlite:///{tmp_path / 'm.db'}"))
    assert list(tmp_path.iterdir()) == []


def test_the_command_says_why_it_does_not_serve(tmp_path: Path) -> None:
    done = semtopo("serve", "--host", "0.0.0.0", "--port", "0", cwd=tmp_path)  # noqa: S104 -- refused
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == (
        "semtopo: beyond this machine, serve with --keys, or with --open to anyone\n"
    )
    assert list(tmp_path.iterdir()) == []


def test_a_key_from_the_command_line_opens_a_server_with_keys(tmp_path: Path) -> None:
    server = Server(tmp_path, host="0.0.0.0", keys=True)  # noqa: S104 -- with keys
    server.start()
    place = ("--database", server.url)
    made = semtopo("keys", "add", "robot-7", *place, cwd=tmp_path)
    assert (made.returncode, made.stderr) == (0, "")
    key = made.stdout.strip()

    def status(bearer: str | None) -> int:
        headers = {} if bearer is None else {"Authorization": f"Bearer {bearer}"}
        return httpx2.get(f"http://127.0.0.1:{server.port}/sessions", headers=headers).status_code

    assert [status(key), status(None), status(key + "x")] == [200, 401, 401]
    listed = semtopo("keys", "list", *place, cwd=tmp_path)
    assert listed.stdout.startswith("robot-7\t")
    assert listed.stdout.endswith("\tvalid\n")
    assert key not in listed.stdout
    revoked = semtopo("keys", "revoke", "robot-7", *place, cwd=tmp_path)
    assert (revoked.returncode, revoked.stdout) == (0, "")
    assert status(key) == 401
    again = semtopo("keys", "list", *place, cwd=tmp_path)
    assert not again.stdout.endswith("\tvalid\n")
    server.close()
    assert server.faults() == []


@pytest.mark.parametrize(
    ("arguments", "line"),
    [
        (("add", ""), "a key needs a name of its own"),
        (("add", " "), "a key needs a name of its own"),
        (("revoke", "nobody"), "there is no valid key of that name"),
        (("list", "--database", "mysql://x"), "the database must be sqlite:///FILE"),
        (("lend", "x"), "Invalid value"),
    ],
)
def test_bad_uses_of_keys_are_told_in_one_line(
    tmp_path: Path, arguments: tuple[str, ...], line: str
) -> None:
    done = semtopo("keys", *arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("semtopo: ")
    assert line in done.stderr
    assert done.stderr.count("\n") == 1


def test_a_name_is_given_once(tmp_path: Path) -> None:
    assert semtopo("keys", "add", "a", cwd=tmp_path).returncode == 0
    assert semtopo("keys", "add", "a", cwd=tmp_path).returncode == 2
    assert (tmp_path / "semtopo.db").is_file()
