"""Make the example ready: a session that has been driven already, to be looked at and asked."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from semtopo import PoseDocument, WorldDocument
from semtopo.formats.path import read_path
from service.errors import StorageError, UnknownSessionError
from service.routes.sessions import new_session
from service.routes.steps import step_request
from service.schemas.sessions import SessionRequest
from service.schemas.steps import StepDocument
from service.sessions import Sessions
from service.steps import Steps

SESSION_ID = "example"


async def make_example(sessions: Sessions, steps: Steps, folder: Path) -> None:
    """Drive the path of a folder through its world, as far as that was not done before."""
    world = WorldDocument.model_validate_json((folder / "world.json").read_bytes())
    path = read_path((folder / "path.csv").read_bytes())
    try:
        driven = (await sessions.find(SESSION_ID)).state.seq
    except UnknownSessionError:
        with suppress(StorageError):  # another process may just have done so
            await sessions.create(new_session(SESSION_ID, SessionRequest(world=world)))
        driven = 0
    for seq, pose in enumerate(path[driven:], start=driven + 1):
        document = StepDocument(pose=PoseDocument(x=pose.x, y=pose.y, theta=pose.theta), seq=seq)
        await steps.take(SESSION_ID, step_request(document))
