"""Steps without HTTP: what becomes of a step when the database fails under it."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from enum import Enum
from typing import Any, TypeVar

import orjson
import pytest
from sqlalchemy import Connection

from semtopo.codec import zones_body
from service.database import open_database
from service.errors import StorageError
from service.feed import Feeds
from service.maps import Maps
from service.metrics import Metrics
from service.recording import StepRequest
from service.routes.sessions import new_session
from service.routes.steps import step_request
from service.schemas.sessions import SessionRequest
from service.schemas.steps import StepDocument
from service.sessions import Sessions
from service.settings import Settings
from service.steps import Steps
from service.writer import Writer, open_writer
from tests.servers import Json
from tests.service.twin import Twin, paper_steps, paper_world, untimed

pytestmark = pytest.mark.databases("sqlite", "postgres")

SESSION: Json = {"world": paper_world(), "sensor": {"beams": 36}}
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
    yield Service(sessions, steps, Maps(sessions, settings), writer)
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
        assert (await service.maps.view("s", None, "zones", zones_body)).content == twin.zones()
        assert (await service.maps.graph("s", None)).content == twin.graph()

    twin = Twin(SESSION)
    with opened(new_database()) as service:
        asyncio.run(drive())


def test_whoever_is_cancelled_leaves_the_step_to_its_end(new_database: Callable[[], str]) -> None:
    async def drive() -> None:
        await service.sessions.create(new_session("s", SessionRequest.model_validate(SESSION)))
        for document in STEPS[:10]:
            asked = asyncio.create_task(service.steps.take("s", request(document)))
            await asyncio.sleep(0)
            asked.cancel()
            with pytest.raises(asyncio.CancelledError):
                await asked
        await service.steps.close()  # waits for them
        logged, _ = await service.steps.page("s", 0, 100)
        assert [one.seq for one in logged] == list(range(1, 11))
        assert [orjson.loads(one.input) for one in logged] == STEPS[:10]

    with opened(new_database()) as service:
        asyncio.run(drive())
