# make run   set up, then serve on 127.0.0.1:8000
# make test  set up, lint, check types, test
# make fuzz  send CASES requests drawn from the OpenAPI document
# make bench measure all beside peers, print tables and write var/bench.json
# make crash kill servers and databases at random, KILLS times each, and check the maps
BIN := .venv/bin
PORT ?= 8000
DATABASE ?= sqlite:///var/semtopo.db
JOBS ?= 2
CASES ?= 20000
KILLS ?= 200
VICTIMS ?= sqlite sqlite-stopped sqlite-two postgres postgres-itself
OURS = --no-emit-package networkx --no-emit-package numpy --no-emit-package colorama
EXPORT = $(BIN)/uv export --quiet --frozen --no-header --no-emit-project

.PHONY: setup run test bench peers fuzz crash picture lint types lock clean

setup: .venv/.ready

.venv/.ready: requirements.lock requirements-build.lock pyproject.toml scripts/setup.sh
	sh scripts/setup.sh
	touch $@

run: setup
	mkdir -p var
	$(BIN)/semtopo serve --host 127.0.0.1 --port $(PORT) --database $(DATABASE) --example examples/paper

test: lint types
	$(BIN)/pytest -n $(JOBS) --dist loadfile

bench: setup peers
	$(BIN)/python -m benchmarks $(BENCH)

# Programs to compare with, in a folder of their own; without them the rest is measured.
peers: setup
	-sh scripts/peers.sh

fuzz: setup
	$(BIN)/python -m tests.fuzz --cases $(CASES)

crash: setup
	set -e; for on in $(VICTIMS); do $(BIN)/python -m tests.crash --kills $(KILLS) --on $$on; done

# The picture of the README.
picture: setup
	d=$$(mktemp -d) && $(BIN)/semtopo map examples/paper/world.json examples/paper/path.csv --out $$d \
	    && cp $$d/map.svg docs/map.svg && rm -r $$d

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/hadolint Dockerfile

types: setup
	$(BIN)/mypy

# Newest versions that have been out for three days. uv.lock names hosts and is not kept.
lock: setup
	$(BIN)/uv lock --upgrade --exclude-newer '3 days'
	$(EXPORT) -o requirements.lock
	$(EXPORT) --no-dev -o requirements-runtime.lock
	$(EXPORT) --only-group build -o requirements-build.lock
	$(EXPORT) --only-group bench $(OURS) -o requirements-bench.lock

clean:
	rm -rf .venv build dist .coverage* htmlcov .mypy_cache .pytest_cache .ruff_cache .hypothesis
