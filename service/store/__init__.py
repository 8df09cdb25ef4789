"""Keep sessions, steps and maps in a database: with `tables`, the only room that speaks SQL.

Every function works on a connection that is in a transaction; whoever calls it commits. A step, its
answer, the rows it changed and the new version belong to one transaction.
"""

from service.store.changes import Change, add_change, find_time, list_changes
from service.store.creations import (
    CreationKey,
    begin_session,
    delete_unused,
    list_unused,
)
from service.store.log import (
    PAGE_CHARACTERS,
    LoggedStep,
    add_step,
    find_step,
    find_step_by_key,
    list_steps,
    page_of_steps,
)
from service.store.maps import load_checkpoint, load_state, save_changes
from service.store.progress import (
    Moment,
    Progress,
    Taken,
    find_progress,
    history_after,
    list_positions,
    moment_of,
    trail_after,
)
from service.store.sessions import (
    CHECKPOINT_EVERY,
    NewSession,
    SessionHead,
    SessionRow,
    add_session,
    advance,
    delete_session,
    find_session,
    find_version,
    is_at,
    list_sessions,
)

__all__ = [
    "CHECKPOINT_EVERY",
    "PAGE_CHARACTERS",
    "Change",
    "CreationKey",
    "LoggedStep",
    "Moment",
    "NewSession",
    "Progress",
    "SessionHead",
    "SessionRow",
    "Taken",
    "add_change",
    "add_session",
    "add_step",
    "advance",
    "begin_session",
    "delete_session",
    "delete_unused",
    "find_progress",
    "find_session",
    "find_step",
    "find_step_by_key",
    "find_time",
    "find_version",
    "history_after",
    "is_at",
    "list_changes",
    "list_positions",
    "list_sessions",
    "list_steps",
    "list_unused",
    "load_checkpoint",
    "load_state",
    "moment_of",
    "page_of_steps",
    "save_changes",
    "trail_after",
]
