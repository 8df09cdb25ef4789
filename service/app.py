"""Put the service together: database, sessions, endpoints; and run it."""

from __future__ import annotations

import gc
import signal
import sys
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from importlib import resources
from importlib.metadata import version
from ipaddress import ip_address

import uvicorn
from fastapi import APIRouter, FastAPI, Request, Response
from fastapi.openapi.docs import get_swagger_ui_html
from fastapi.responses import HTMLResponse, JSONResponse, PlainTextResponse
from fastapi.staticfiles import StaticFiles
from prometheus_client import CONTENT_TYPE_LATEST

from semtopo import InvalidOptionError
from service import errors, schemas
from service.database import Database, open_database
from service.edge import BodyLimit
from service.example import make_example
from service.gate import KeyGate
from service.metrics import CountResponses, Metrics
from service.openapi import DescribedApi
from service.protocol import PatientProtocol
from service.routes import router
from service.sessions import Sessions
from service.settings import Settings
from service.views import views
from service.writer import open_writer

STOP_SECONDS_MAX = 20
"""How long to wait, when told to stop, for clients that do not take their answers."""

_ABOUT = "Turn a robot's steps into zones, a graph of zones, and answers."

operations = APIRouter(tags=["operations"], responses=schemas.problems(413))


def create_app(settings: Settings, database: Database) -> FastAPI:
    """Return the application on an open database, which it closes when it stops."""
    app = DescribedApi(
        title="semtopo",
        version=version("semtopo"),
        description=_ABOUT,
        lifespan=_lifespan,
        docs_url=None,
        redoc_url=None,
    )
    if settings.keys:
        app.add_middleware(KeyGate, service=app)
    app.add_middleware(BodyLimit, bytes_max=settings.body_bytes_max)
    app.state.metrics = Metrics()
    app.add_middleware(CountResponses, metrics=app.state.metrics)
    app.state.settings = settings
    app.state.database = database
    errors.register(app)
    app.include_router(router)
    app.include_router(views)
    app.include_router(operations)
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
    # to end when asked to is a success; uvicorn alone would let the signal end the process
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    uvicorn.run(
        create_app(settings, open_database(settings.database)),
        host=settings.host,
        port=settings.port,
        http=PatientProtocol,
        ws="none",
        access_log=False,
        timeout_graceful_shutdown=STOP_SECONDS_MAX,
    )


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
    writer = open_writer(database, settings.queue_max)
    app.state.sessions = Sessions(database, writer, settings, app.state.metrics)
    try:
        if settings.example is not None:
            await make_example(app.state.sessions, settings.example)
        # what lives now lives on; left to the collector, it would stop steps for 40 ms now and then
        gc.collect()
        gc.freeze()
        yield
    finally:
        await app.state.sessions.close()
        writer.close()
        database.close()


@operations.get("/healthz", response_model=schemas.HealthAnswer)
async def healthz() -> Response:
    """Say that the process answers."""
    return JSONResponse({"status": "ok"})


@operations.get("/readyz", response_model=schemas.HealthAnswer, responses=schemas.problems(503))
async def readyz(request: Request) -> Response:
    """Say that the database answers too."""
    sessions: Sessions = request.app.state.sessions
    await sessions.page(owner=None, after=0, limit=1)
    return JSONResponse({"status": "ok"})


@operations.get("/metrics", response_class=PlainTextResponse, responses=schemas.problems(401))
async def metrics(request: Request) -> Response:
    """Count and time, in the format of Prometheus."""
    found: Metrics = request.app.state.metrics
    return Response(found.written(), media_type=CONTENT_TYPE_LATEST)


@operations.get("/docs", include_in_schema=False)
async def docs() -> HTMLResponse:
    """Show the interface, and let people try it."""
    return get_swagger_ui_html(
        openapi_url="openapi.json",
        title="semtopo",
        swagger_js_url="docs/files/swagger-ui-bundle.js",
        swagger_css_url="docs/files/swagger-ui.css",
        swagger_favicon_url="docs/files/favicon-32x32.png",
    )
