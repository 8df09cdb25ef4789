"""Serve the page: static files that come with the package, and may load nothing from elsewhere."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

from fastapi import APIRouter, FastAPI
from fastapi.responses import FileResponse
from fastapi.staticfiles import StaticFiles
from starlette.types import Message, Receive, Scope, Send

_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self';"
    " base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
"""Nothing from elsewhere, nothing inline: a label that looks like a script stays a label."""

HEADERS = {
    "Content-Security-Policy": _POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-cache",
}

_FOLDER = Path(str(resources.files("service") / "viewer"))

router = APIRouter()


@router.get("/", include_in_schema=False)
async def page() -> FileResponse:
    """Show the page."""
    return FileResponse(_FOLDER / "index.html", headers=HEADERS)


class _Files(StaticFiles):
    """Files that go out with the headers of the page."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Send a file, or 304 if the browser has it."""
        more = [(name.lower().encode(), value.encode()) for name, value in HEADERS.items()]

        async def headed(message: Message) -> None:
            if message["type"] == "http.response.start":
                message["headers"] = [*message["headers"], *more]
            await send(message)

        await super().__call__(scope, receive, headed)


def add_page(app: FastAPI) -> None:
    """Let an application show the page at `/`, its files below `/viewer`."""
    app.include_router(router)
    app.mount("/viewer", _Files(directory=_FOLDER, follow_symlink=True))
