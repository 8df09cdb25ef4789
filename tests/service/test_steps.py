"""Steps without HTTP: what becomes of a step when the database fails under it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from enum import Enum
from typing import Any, TypeVar

import orjson
import pytest
from sqlalchemy import Connection

from semtopo.codec import zones_body
from service.database import open_database
from service.errors import StorageError
from service.feeds import Feeds
from service.maps import Maps
from service.metrics import Metrics
from service.recording import StepRequest
from service.routes.sessions import new_session
from service.routes.steps import step_request
from service.schemas.sessions import SessionRequest
from service.schemas.steps import StepDocument
from service.sessions import Sessions
from service.settings import Settings
from service.steps import COMPUTERS, Steps
from service.writer import Writer, open_writer
from tests.servers import Json
from tests.service.twin import Twin, paper_steps, paper_world, untimed

pytestmark = pytest.mark.databases("sqlite", "postgres")

SESSION: Json = {"world": paper_world(), "sensor": {"beams": 36}}
HEAVY: Json = {
    "world": {"zones": [
        {"label": f"z{x}-{y}", "kind": "space", "low": [x, y], "high": [x + 1, y + 1]}
        for x in range(60) for y in range(60)
    ]},
    "sensor": {"beams": 1_000, "range": 60.0, "samples": 100},
}  # fmt: skip
STEPS = paper_steps()
Result = TypeVar("Result")


class Lose(Enum):
    """What is lost of a change."""

    NOTHING = 0
    THE_ANSWER = 1
    ALL = 2


class FailingWriter:
    """A writer that fails when told to, after a commit or instead of it."""

    def __init__(self, writer: Writer) -> None:
        self._writer = writer
        self.lose = Lose.NOTHING

    async def commit(self, change: Callable[[Connection], Result]) -> Result:
        lose, self.lose = self.lose, Lose.NOTHING
        if lose is Lose.ALL:
            raise StorageError("as if the disk were full")
        result = await self._writer.commit(change)
        if lose is Lose.THE_ANSWER:
            raise StorageError("as if the connection were cut")
        return result

    @property
    def waiting(self) -> int:
        return self._writer.waiting

    def close(self) -> None:
        self._writer.close()


@dataclass(frozen=True, slots=True)
class Service:
    """All that an application has, on a writer that can fail."""

    sessions: Sessions
    steps: Steps
    maps: Maps
    writer: FailingWriter


@contextmanager
def opened(url: str) -> Iterator[Service]:
    settings, metrics, database = Settings(), Metrics(), open_database(url)
    writer = FailingWriter(open_writer(database, settings.queue_max))
    sessions = Sessions(database, writer, settings, metrics)
    steps = Steps(sessions, Feeds(sessions, settings, metrics), settings, metrics)
    try:
        yield Service(sessions, steps, Maps(sessions, settings), writer)
    finally:
        asyncio.run(steps.close())
        writer.close()
        database.close()


def request(document: Json, key: str | None = None) -> StepRequest:
    return step_request(StepDocument.model_validate(document), key)


async def take(service: Service, wanted: StepRequest) -> Any:  # noqa: ANN401 -- JSON
    return untimed(orjson.loads((await service.steps.take("s", wanted)).content))


@pytest.mark.parametrize("lose", [Lose.THE_ANSWER, Lose.ALL])
@pytest.mark.parametrize("key", ["k", None])
def test_after_a_failure_a_step_is_taken_on_what_is_stored(
    new_database: Callable[[], str], lose: Lose, key: str | None
) -> None:
    async def drive() -> None:
        await service.sessions.create(new_session("s", SessionRequest.model_validate(SESSION)))
        assert await take(service, request(STEPS[0])) == twin.step(STEPS[0])
        service.writer.lose = lose
        with pytest.raises(StorageError):
            await take(service, request(STEPS[4], key))
        assert service.sessions.known("s") is None
        if lose is Lose.THE_ANSWER:
            first = twin.step(STEPS[4])
        if key is not None:
            again = await take(service, request(STEPS[4], key))
            assert again == (first if lose is Lose.THE_ANSWER else twin.step(STEPS[4]))
        assert await take(service, request(STEPS[6])) == twin.step(STEPS[6])
        zones = await service.maps.view("s", None, "zones", lambda it: zones_body(it.state))
        assert zones.content == twin.zones()
        assert (await service.maps.graph("s", None)).content == twin.graph()

    twin = Twin(SESSION)
    with opened(new_database()) as service:
        asyncio.run(drive())


def test_whoever_is_cancelled_can_ask_again_and_the_step_is_taken_once(
    new_database: Callable[[], str],
) -> None:
    async def drive() -> int:
        await service.sessions.create(new_session("s", SessionRequest.model_validate(SESSION)))
        cancelled = 0
        for number, document in enumerate(STEPS[:24]):
            wanted = request(document, f"k{number}")
            asked = asyncio.create_task(service.steps.take("s", wanted))
            # from before it has begun until after it was handed to the writer
            for _ in range(number % 6):
                await asyncio.sleep(0.001 * (number % 4))
            asked.cancel()
            with suppress(asyncio.CancelledError):
                await asked
            cancelled += asked.cancelled()
            assert await take(service, wanted) == twin.step(document)
        await service.steps.close()
        logged, _ = await service.steps.page("s", 0, 100)
        assert [orjson.loads(one.input) for one in logged] == STEPS[:24]
        zones = await service.maps.view("s", None, "zones", lambda it: zones_body(it.state))
        assert zones.content == twin.zones()
        return cancelled

    twin = Twin(SESSION)
    with opened(new_database()) as service:
        assert asyncio.run(drive()) > 6


def test_a_step_that_computes_long_keeps_no_reader_waiting(
    new_database: Callable[[], str],
) -> None:
    """More long steps than there are threads for them, and a read: the read is answered first."""

    async def drive() -> None:
        create = service.sessions.create
        await create(new_session("s", SessionRequest.model_validate(SESSION)))
        heavy = [f"heavy{number}" for number in range(2 * COMPUTERS)]
        for name in heavy:
            await create(new_session(name, SessionRequest.model_validate(HEAVY)))
        taken = [asyncio.create_task(service.steps.take(n, request(STEPS[0]))) for n in heavy]
        for _ in range(20):
            await service.maps.graph("s", None)
        assert not any(one.done() for one in taken[COMPUTERS:])
        await asyncio.gather(*taken)

    with opened(new_database()) as service:
        asyncio.run(drive())
