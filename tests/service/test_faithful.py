"""The service is only a shell: whatever is done, it answers what the bare library would."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest
from hypothesis import settings
from hypothesis import strategies as st
from hypothesis.stateful import (
    RuleBasedStateMachine,
    initialize,
    invariant,
    precondition,
    rule,
    run_state_machine_as_test,
)

from semtopo.runs import LabelledRuns
from semtopo.types import MappingOptions, Point, Pose
from tests.servers import Backend, Json, Server
from tests.service.twin import (
    Twin,
    at,
    options_json,
    scan_step,
    sensor_json,
    untimed,
    world_json,
)
from tests.strategies import Scene, all_options, labelled_runs, poses, scenes

pytestmark = pytest.mark.databases("sqlite", "postgres")

RUNS = {"sqlite": 25, "postgres": 8}

picks = st.integers(0, 1_000)
"""Numbers to choose one thing of many, whatever their number is then."""


@dataclass
class Session:
    """A session of the service with its twin, and the bodies that it was sent."""

    path: str
    twin: Twin
    walk: tuple[Point, ...] = ()
    sent: list[Json] = field(default_factory=list)
    replies: list[bytes] = field(default_factory=list)


class Shell(RuleBasedStateMachine):
    """Robots begin sessions, take steps, repeat them and retry them; now and then, a crash."""

    def __init__(self, server: Server) -> None:
        super().__init__()
        self.server = server
        self.sessions: list[Session] = []
        self.crashes = 0

    def chosen(self, pick: int) -> Session:
        return self.sessions[pick % len(self.sessions)]

    def take(self, session: Session, document: Json) -> None:
        """Take a step on both sides, and compare what they say."""
        headers = {"Idempotency-Key": f"step-{len(session.sent)}"}
        reply = self.server.client.post(f"{session.path}/step", json=document, headers=headers)
        assert reply.status_code == 201, reply.text
        assert untimed(reply.json()) == session.twin.step(document)
        session.sent.append(document)
        session.replies.append(reply.content)

    @initialize(scene=scenes(), chosen=all_options)
    def begin(self, scene: Scene, chosen: MappingOptions) -> None:
        body = {
            "world": world_json(scene.world),
            "sensor": sensor_json(scene.sensor),
            "mapping": options_json(chosen),
        }
        path = self.server.create(**body)
        self.sessions.append(Session(path, Twin(body), scene.walk))
        self.take(self.sessions[-1], at(*scene.walk[0]))

    @precondition(lambda self: len(self.sessions) < 4)
    @rule(scene=scenes(), chosen=all_options)
    def begin_another(self, scene: Scene, chosen: MappingOptions) -> None:
        self.begin(scene, chosen)

    @precondition(lambda self: len(self.sessions) < 4)
    @rule(chosen=all_options)
    def begin_without_world(self, chosen: MappingOptions) -> None:
        body = {"mapping": options_json(chosen)}
        self.sessions.append(Session(self.server.create(**body), Twin(body)))

    @rule(pick=picks, number=picks)
    def walk(self, pick: int, number: int) -> None:
        session = self.chosen(pick)
        if session.walk:
            self.take(session, at(*session.walk[number % len(session.walk)]))

    @rule(pick=picks, pose=poses, runs=labelled_runs())
    def scan(self, pick: int, pose: Pose, runs: LabelledRuns) -> None:
        self.take(self.chosen(pick), scan_step(pose, runs))

    @rule(pick=picks)
    def stand_still(self, pick: int) -> None:
        session = self.chosen(pick)
        if session.sent:
            self.take(session, session.sent[-1])

    @rule(pick=picks, number=picks, by_seq=st.booleans())
    def retry(self, pick: int, number: int, by_seq: bool) -> None:  # noqa: FBT001 -- drawn
        """Send an earlier step once more: the answer is that of then, and nothing changes."""
        session = self.chosen(pick)
        if not session.sent:
            return
        index = number % len(session.sent)
        document, headers = session.sent[index], {"Idempotency-Key": f'"step-{index}"'}
        if by_seq:
            document, headers = {**document, "seq": index + 1}, {}
        reply = self.server.client.post(f"{session.path}/step", json=document, headers=headers)
        assert (reply.status_code, reply.content) == (201, session.replies[index])

    @rule(pick=picks, number=picks)
    def look_back(self, pick: int, number: int) -> None:
        session = self.chosen(pick)
        seq = number % (session.twin.seq + 1)
        assert self.server.get(f"{session.path}/graph", at=seq) == session.twin.graph(seq)
        assert self.server.get(f"{session.path}/zones", at=seq) == session.twin.zones(seq)

    @precondition(lambda self: len(self.sessions) > 1)
    @rule(pick=picks)
    def delete(self, pick: int) -> None:
        session = self.chosen(pick)
        assert self.server.client.delete(session.path).status_code == 204
        self.sessions.remove(session)
        assert self.server.client.get(session.path).status_code == 404

    @precondition(lambda self: self.crashes == 0)
    @rule(chance=st.integers(0, 29))
    def crash(self, chance: int) -> None:
        """Kill -9, which takes long; so it happens once in some runs."""
        if chance == 17:
            self.server.restart()
            self.crashes += 1

    @invariant()
    def maps_are_alike(self) -> None:
        for session in self.sessions:
            assert self.server.get(f"{session.path}/graph") == session.twin.graph()
            assert self.server.get(f"{session.path}/zones") == session.twin.zones()

    def teardown(self) -> None:
        for session in self.sessions:
            self.server.client.delete(session.path)


def test_the_service_is_only_a_shell(own_server: Server, backend: Backend) -> None:
    own_server.start()

    class ShellOfOurs(Shell):
        def __init__(self) -> None:
            super().__init__(own_server)

    run_state_machine_as_test(
        ShellOfOurs,
        settings=settings(max_examples=RUNS[backend], stateful_step_count=20, deadline=None),
    )
