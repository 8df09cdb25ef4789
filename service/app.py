"""Put the service together: database, sessions, endpoints; and run it."""

from __future__ import annotations

import asyncio
import gc
import signal
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib import resources
from importlib.metadata import version
from ipaddress import ip_address
from socket import socket

import uvicorn
from fastapi import FastAPI
from fastapi.staticfiles import StaticFiles

from semtopo import InvalidOptionError
from semtopo.reading import prepare
from service import problems
from service.changes import Changes
from service.database import Database, open_database
from service.descriptors import connections_that_fit
from service.edge import BodyLimit
from service.example import make_example
from service.feeds import Feeds
from service.gate import KeyGate
from service.journal import Journal, start_log
from service.maps import Maps
from service.memory import share_arena
from service.metrics import Metrics
from service.openapi import DescribedApi
from service.page import add_page
from service.pictures import Pictures
from service.protocol import PatientProtocol
from service.retention import keep_for
from service.routes import ROUTES
from service.sessions import Sessions
from service.settings import Settings
from service.steps import Steps
from service.writer import open_writer

STOP_SECONDS_MAX = 20
"""How long to wait, when told to stop, for clients that do not take their answers."""

_ABOUT = "Turn a robot's steps into zones, a graph of zones, and answers."


def create_app(settings: Settings, database: Database) -> FastAPI:
    """Return the application on an open database, which it closes when it stops."""
    app = DescribedApi(
        title="semtopo",
        version=version("semtopo"),
        description=_ABOUT,
        lifespan=_lifespan,
        docs_url=None,
        redoc_url=None,
        # or each request would look for OpenTelemetry
        telemetry={"tracing": False, "metrics": False},
    )
    if settings.keys:
        app.add_middleware(KeyGate, service=app)
    app.add_middleware(BodyLimit, bytes_max=settings.body_bytes_max)
    app.state.metrics = Metrics()
    app.add_middleware(Journal, metrics=app.state.metrics)
    app.state.settings = settings
    app.state.database = database
    problems.register(app)
    app.router.routes.extend(ROUTES)
    add_page(app)
    # the files of Swagger UI come with a package, so that /docs works without internet
    swagger = resources.files("fastapi_swagger") / "resources"
    app.mount("/docs/files", StaticFiles(directory=str(swagger)))
    return app


def serve(settings: Settings) -> None:
    """Serve over HTTP until told to stop.

    Raises
    ------
    InvalidOptionError
        The host is to be reached from other machines, but neither `keys` nor `open` is set.
    InvalidDatabaseError, StorageError
        The database cannot be opened.
    """
    if not (settings.keys or settings.open or _is_loopback(settings.host)):
        raise InvalidOptionError("beyond this machine, serve with --keys, or with --open to anyone")
    share_arena()
    # to end when asked to is a success; uvicorn alone would let the signal end the process
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    start_log(settings.log)
    fitting = {"connections_max": connections_that_fit(settings.connections_max)}
    settings = settings.model_copy(update=fitting)
    config = uvicorn.Config(
        create_app(settings, open_database(settings.database)),
        host=settings.host,
        port=settings.port,
        http=PatientProtocol,
        ws="none",
        access_log=False,
        log_config=None,
        proxy_headers=False,  # nothing here depends on where a request comes from
        timeout_graceful_shutdown=STOP_SECONDS_MAX,
    )
    EndingServer(config).run()


class EndingServer(uvicorn.Server):
    """A server that, told to stop, ends the streams of events; it would else wait for them."""

    async def shutdown(self, sockets: list[socket] | None = None) -> None:
        """End the feeds, then wait for all other answers."""
        app = self.config.app
        if isinstance(app, FastAPI):
            app.state.feeds.close()
        await super().shutdown(sockets)


@asynccontextmanager
async def _in_background(settings: Settings, sessions: Sessions) -> AsyncIterator[None]:
    """Delete what nobody uses while something else is done, if the settings say so."""
    if settings.keep_days is None:
        yield
        return
    work = asyncio.create_task(keep_for(settings.keep_days, sessions))
    try:
        yield
    finally:
        work.cancel()
        await asyncio.wait([work])


def _is_loopback(host: str) -> bool:
    """Say whether only this machine can reach a host; a name other than localhost is not one."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


@asynccontextmanager
async def _lifespan(app: FastAPI) -> AsyncIterator[None]:
    """Begin with nothing in memory; close the database when all steps have ended."""
    settings: Settings = app.state.settings
    database: Database = app.state.database
    metrics: Metrics = app.state.metrics
    writer = open_writer(database, settings.queue_max, metrics.time_commit)
    metrics.show("queued_changes", "Changes that wait to be committed", lambda: writer.waiting)
    app.state.sessions = Sessions(database, writer, settings, metrics)
    app.state.feeds = Feeds(app.state.sessions, settings, metrics)
    app.state.steps = Steps(app.state.sessions, app.state.feeds, settings, metrics)
    app.state.changes = Changes(app.state.sessions, app.state.feeds)
    app.state.maps = Maps(app.state.sessions, settings)
    app.state.pictures = Pictures(app.state.sessions, app.state.maps)
    prepare()
    try:
        if settings.example is not None:
            await make_example(app.state.sessions, app.state.steps, settings.example)
        # what lives now lives on; left to the collector, it would stop steps for 40 ms now and then
        gc.collect()
        gc.freeze()
        async with _in_background(settings, app.state.sessions):
            yield
    finally:
        app.state.feeds.close()
        await app.state.steps.close()
        writer.close()
        database.close()
