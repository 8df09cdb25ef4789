"""Say how the service is, and what its interface is."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response
from fastapi.openapi.docs import get_swagger_ui_html
from fastapi.responses import HTMLResponse, JSONResponse, PlainTextResponse
from prometheus_client import CONTENT_TYPE_LATEST

from service.metrics import Metrics
from service.parameters import sessions_of
from service.schemas.operations import HealthAnswer
from service.schemas.problems import problems

router = APIRouter(tags=["operations"], responses=problems(413))


@router.get("/healthz", response_model=HealthAnswer)
async def healthz() -> Response:
    """Say that the process answers."""
    return JSONResponse({"status": "ok"})


@router.get("/readyz", response_model=HealthAnswer, responses=problems(503))
async def readyz(request: Request) -> Response:
    """Say that the database answers too."""
    await sessions_of(request).page(owner=None, after=0, limit=1)
    return JSONResponse({"status": "ok"})


@router.get("/metrics", response_class=PlainTextResponse, responses=problems(401))
async def metrics(request: Request) -> Response:
    """Count and time, in the format of Prometheus."""
    found: Metrics = request.app.state.metrics
    return Response(found.written(), media_type=CONTENT_TYPE_LATEST)


@router.get("/docs", include_in_schema=False)
async def docs() -> HTMLResponse:
    """Show the interface, and let people try it."""
    return get_swagger_ui_html(
        openapi_url="openapi.json",
        title="semtopo",
        swagger_js_url="docs/files/swagger-ui-bundle.js",
        swagger_css_url="docs/files/swagger-ui.css",
        swagger_favicon_url="docs/files/favicon-32x32.png",
    )
