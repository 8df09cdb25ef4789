"""A database is copied while it is served, and the copy is whole: it is served in its turn."""

from __future__ import annotations

import subprocess
import threading
from pathlib import Path

import httpx2
import pytest

from service.backup import back_up
from service.errors import InvalidDatabaseError
from tests.crash import assert_whole
from tests.servers import SEMTOPO, Server
from tests.service.twin import Twin, paper_steps, paper_world

SESSION = {"world": paper_world(), "sensor": {"beams": 36}}


def test_a_copy_taken_under_way_is_the_map_of_a_moment(tmp_path: Path) -> None:
    def drive() -> None:
        with httpx2.Client(base_url=server.client.base_url, timeout=30) as client:
            for document in paper_steps():
                assert client.post(f"{path}/step", json=document).status_code == 201
                driven.append(1)

    server, driven = Server(tmp_path / "one"), list[int]()
    server.start()
    path = server.create(**SESSION)
    robot = threading.Thread(target=drive)
    robot.start()
    known = []
    for number in range(2):
        before = len(driven)
        assert back_up(server.url, tmp_path / f"{number}.db") > 0
        known.append((before, len(driven) + 1))
    robot.join()
    server.close()
    assert known[0][0] < 81  # it was under way
    for number, (least, most) in enumerate(known):
        copy = tmp_path / f"{number}.db"
        assert_whole(copy)
        again = Server(tmp_path / f"of {number}", f"sqlite:///{copy}")
        again.start()
        seq = again.client.get(path).json()["seq"]
        assert least <= seq <= most
        twin = Twin.driven(SESSION, paper_steps()[:seq])
        assert again.get(f"{path}/zones") == twin.zones()
        again.step(path, paper_steps()[seq % 81])
        again.close()


def semtopo(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [SEMTOPO, "backup", *arguments], cwd=cwd, capture_output=True, text=True, check=False
    )


@pytest.mark.parametrize(
    ("url", "file", "says"),
    [
        ("postgresql://localhost/x", "new.db", "pg_dump"),
        ("sqlite:///nowhere.db", "new.db", "no database"),
        ("sqlite:///taken.db", "taken.db", "already"),
        ("sqlite:///taken.db", "new.db", "cannot be copied"),
        ("sqlite:///taken.db", "no/folder/new.db", "No such file"),
        ("mysql://x", "new.db", "sqlite:///FILE"),
    ],
)
def test_what_cannot_be_copied_is_one_line(tmp_path: Path, url: str, file: str, says: str) -> None:
    (tmp_path / "taken.db").write_bytes(b"no database")
    done = semtopo("--database", url, file, cwd=tmp_path)
    assert done.returncode == 2
    assert says in done.stderr
    assert done.stderr.count("\n") == 1
    assert [it.name for it in tmp_path.iterdir()] == ["taken.db"]


def test_the_command_copies(tmp_path: Path) -> None:
    server = Server(tmp_path / "one")
    server.start()
    path = server.create()
    done = semtopo("--database", server.url, "copy.db", cwd=tmp_path)
    server.close()
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == f"copy.db: {(tmp_path / 'copy.db').stat().st_size} bytes\n"
    assert path
    with pytest.raises(InvalidDatabaseError):
        back_up("sqlite:///:memory:", tmp_path / "new.db")
