"""Send a server what its OpenAPI document allows, and what it does not, and judge every answer.

    python -m tests.fuzz --cases 20000

starts a server of its own and reports how often each operation gave each status. An answer is wrong
if it is a 5xx, or its status, media type or body is not as the document says.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import hypothesis
import schemathesis
from hypothesis import HealthCheck, Phase, given
from hypothesis import strategies as st
from hypothesis.errors import Unsatisfiable
from schemathesis import GenerationMode
from schemathesis.checks import not_a_server_error
from schemathesis.core.failures import FailureGroup
from schemathesis.core.result import Ok
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)

from tests.mending import SCAN, AnyCase, Known, mend
from tests.servers import Server
from tests.service.twin import paper_steps, paper_world

CHECKS = [
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_schema_conformance,
]
FAULTS_SHOWN = 10
CASES_ON_ONE_SESSION = 200
STEPS = 8

AIMS = ["anywhere", "known", "sound", "sound"]
"""Where a case goes: where it was drawn to, or to a session that exists; those that are `sound` are
also mended where the service demands more than its schema can say."""


@dataclass
class Tally:
    """What was answered: how often each status by operation, and what was wrong."""

    statuses: Counter[tuple[str, int]] = field(default_factory=Counter)
    faults: dict[str, str] = field(default_factory=dict)

    @property
    def cases(self) -> int:
        """How many cases were sent."""
        return self.statuses.total()

    @property
    def server_errors(self) -> int:
        """How many answers were a 5xx."""
        return sum(count for (_, status), count in self.statuses.items() if status >= 500)

    @property
    def share_of_success(self) -> float:
        """The share of cases that were answered by a success, averaged over operations."""
        labels = {label for label, _ in self.statuses}
        shares = [
            sum(n for (name, status), n in self.statuses.items() if name == label and status < 400)
            / sum(n for (name, _), n in self.statuses.items() if name == label)
            for label in labels
        ]
        return sum(shares) / max(1, len(shares))

    def lines(self) -> Iterator[str]:
        """Yield a line for each operation."""
        for label in dict.fromkeys(label for label, _ in self.statuses):
            found = sorted((s, n) for (name, s), n in self.statuses.items() if name == label)
            yield f"{label:40}" + "  ".join(f"{status}: {count}" for status, count in found)


class Fuzz:
    """One run against a server."""

    def __init__(self, server: Server) -> None:
        """Read what the server says of itself."""
        self.tally = Tally()
        self._server = server
        self._base = f"http://127.0.0.1:{server.port}"
        described = schemathesis.openapi.from_url(f"{self._base}/openapi.json")
        self._schema = described.exclude(path_regex="/events$")  # an answer without an end
        self._known: dict[bool, Known] = {}
        self._uses = 0

    def run(self, cases: int, seed: int) -> Tally:
        """Send at least so many cases, shared by all operations, half of them against the rules.

        Some operations have nothing that could be wrong, so that they take fewer.
        """
        while self.tally.cases < cases:
            self._send_all(cases - self.tally.cases, seed)
            seed += 1
        return self.tally

    def _send_all(self, cases: int, seed: int) -> None:
        """Send up to so many cases, shared by all operations."""
        found = list(self._schema.get_all_operations())
        operations = [one.ok() for one in found if isinstance(one, Ok)]
        assert len(operations) == len(found), "the document cannot be read"
        for operation in operations:
            for mode in (GenerationMode.POSITIVE, GenerationMode.NEGATIVE):
                share = max(1, cases // (2 * len(operations)))
                self._send(operation.as_strategy(generation_mode=mode), share, seed)

    def _send(self, drawn: st.SearchStrategy[AnyCase], cases: int, seed: int) -> None:
        """Send cases of one operation."""

        @hypothesis.seed(seed)
        @hypothesis.settings(
            max_examples=cases, deadline=None, database=None, phases=[Phase.generate],
            suppress_health_check=list(HealthCheck),
        )  # fmt: skip
        @given(drawn, st.sampled_from(AIMS))
        def send(case: AnyCase, aim: str) -> None:
            self._judge(case, aim)

        try:
            send()
        except Unsatisfiable:  # nothing about an operation without input can be wrong
            return

    def _judge(self, case: AnyCase, aim: str) -> None:
        """Send one case, and take note of the answer."""
        if aim != "anywhere" and "session_id" in (case.path_parameters or {}):
            known = self._session()
            case.path_parameters["session_id"] = known.session
            if aim == "sound":
                mend(case, known)
        answer = case.call(base_url=self._base, timeout=30)
        self.tally.statuses[case.operation.label, answer.status_code] += 1
        if case.method == "DELETE" and answer.status_code == 204:
            self._known.clear()
        try:
            case.validate_response(answer, checks=CHECKS)
        except FailureGroup as group:
            for fault in group.exceptions:
                key = f"{case.operation.label}: {answer.status_code}: {fault.title}"
                self.tally.faults.setdefault(key, str(group)[:3000])

    def _session(self) -> Known:
        """Return a session that has a map, in turn with a world and without.

        Now and then it is a new one.
        """
        self._uses += 1
        if self._uses % CASES_ON_ONE_SESSION == 0:
            self._known.clear()
        has_world = self._uses % 2 == 0
        if has_world not in self._known:
            self._known[has_world] = self._begun(has_world=has_world)
        return self._known[has_world]

    def _begun(self, *, has_world: bool) -> Known:
        """Begin a session, and take some steps."""
        path = self._server.create(world=paper_world() if has_world else None)
        for document in paper_steps()[:STEPS]:
            self._server.step(path, document if has_world else {**document, "scan": SCAN})
        zones = ("corridor", "A") if has_world else ("a", "b")

        def restrict() -> str:
            answer = self._server.client.post(
                f"{path}/restrictions", json={"zone": zones[0], "factor": 2}
            )
            return str(answer.json()["id"])

        return Known(path.removeprefix("/sessions/"), STEPS, zones, restrict)


def main() -> int:
    """Run, and report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=1)
    given_ = parser.parse_args()
    warnings.simplefilter("ignore")
    began = time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        server = Server(Path(folder))
        server.start()
        tally = Fuzz(server).run(given_.cases, given_.seed)
        server.close()
        faults = server.faults()
    print("\n".join(tally.lines()))
    for name, what in list(tally.faults.items())[:FAULTS_SHOWN]:
        print(f"\n{name}\n{what}")
    print(f"{tally.share_of_success:.0%} of the cases of each operation succeeded, on the average")
    print(
        f"{tally.cases} cases in {time.monotonic() - began:.0f} s: {tally.server_errors} server"
        f" errors, {len(tally.faults)} kinds of wrong answers, {len(faults)} tracebacks"
    )
    return 1 if tally.faults or tally.server_errors or faults else 0


if __name__ == "__main__":
    sys.exit(main())
