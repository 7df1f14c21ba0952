# Two commands do all the set-up on a fresh machine: `make run` and `make test`.
PYTHON ?= python3
PORT ?= 5006
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check

.PHONY: run lock lint test check test-slow tests durations simulator validation bench load soak sbom system clean
.DEFAULT_GOAL := run

# Installs what a lock file names, each file checked against its digest. uv does so in a fraction of pip's time; where
# it cannot be had, or does not know the way to the package index that pip is told of, pip does it.
define install
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "NavBudget needs Python 3.11 or later: make PYTHON=python3.11")'
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	{ $(PIP) install --quiet --require-hashes -r requirements/installer.lock && \
	  $(BIN)/uv pip install --quiet --compile-bytecode --python $(BIN)/python --require-hashes -r requirements/$(1).lock; } || \
	  $(PIP) install --quiet --require-hashes -r requirements/$(1).lock
	$(PIP) install --quiet --no-deps --no-build-isolation -e .
endef

.venv/.runtime: pyproject.toml requirements/run.lock
	$(call install,run)
	touch $@

.venv/.test: .venv/.runtime requirements/test.lock
	$(call install,test)
	touch $@

# Writes the lock files anew after pyproject.toml has changed; `make lock UPGRADE=--upgrade` takes in new releases too.
COMPILE = $(BIN)/uv pip compile --quiet $(UPGRADE) --universal --python-version 3.11 --fork-strategy fewest \
  --generate-hashes --custom-compile-command 'make lock' pyproject.toml
lock:
	test -x $(BIN)/uv || { $(PYTHON) -m venv .venv && $(PIP) install --quiet 'uv>=0.13'; }
	$(COMPILE) --group build --extra test -o requirements/test.lock
	$(COMPILE) --group build -c requirements/test.lock -o requirements/run.lock
	$(COMPILE) --group build --extra oauth --extra postgresql -c requirements/test.lock -o requirements/image.lock
	$(BIN)/uv pip compile --quiet $(UPGRADE) --universal --python-version 3.11 --generate-hashes \
	  --custom-compile-command 'make lock' --group installer -o requirements/installer.lock

run: .venv/.runtime
	$(BIN)/navbudget serve --port $(PORT)

# What tests drive besides Python: a browser, a PostgreSQL that a test starts itself, the proxy of deploy/nginx.conf, and
# a spreadsheet program without a screen.
# A missing one is a failure, so all that are missing are installed here at once.
system:
	@missing=$$( \
	  command -v chromium chromium-browser >/dev/null || echo chromium; \
	  ls /usr/lib/postgresql/*/bin/initdb >/dev/null 2>&1 || command -v initdb >/dev/null || echo postgresql; \
	  test -x /usr/sbin/nginx || command -v nginx >/dev/null || echo nginx; \
	  command -v soffice >/dev/null || echo libreoffice-calc-nogui); \
	test -z "$$missing" || { \
	  sudo=$$(test "$$(id -u)" = 0 || echo sudo); \
	  $$sudo apt-get update -q && $$sudo apt-get install -y -q --no-install-recommends $$missing; }

lint: .venv/.test
	@failed=; for one in "ruff check ." "ruff format --check ." mypy lint-imports "hadolint Dockerfile"; do \
	  $(BIN)/$$one || failed=1; done; test -z "$$failed"

# Lint and tests run beside each other, each to its end, and what it has to say then. ORDER=random runs the files, and what
# is in each, in random order; ORDER=12345 is an order that was random again.
BESIDE = $(MAKE) --no-print-directory --jobs --output-sync --keep-going
CORES := $(shell nproc 2>/dev/null || echo 2)
# Two more than cores, as much of a test is waiting for a server or a page.
WORKERS = $(shell echo $$(($(CORES) + 2)))
RANDOM_ORDER = --random-order-bucket=module $(patsubst %,--random-order-seed=%,$(filter-out random,$(ORDER)))
# As a module: processes that a test starts find its file then. A worker takes file after file, the longest first.
PYTEST = $(BIN)/python -m pytest -p no:benchmark -n $(WORKERS) --dist loadfile --no-loadscope-reorder \
  $(if $(ORDER),$(RANDOM_ORDER))
KIND = --skip-unchanged
# A hundred processes that each compile every source anew are a third of the whole time.
unexport PYTHONDONTWRITEBYTECODE

test: .venv/.test system
	+$(BESIDE) lint tests

# For while one works: lint and what is quick of the tests without a browser, by the durations measured last. How long
# it takes: CONTRIBUTING.md. A worker for each core: each takes 15 s to collect the tests, and none of these waits.
check: .venv/.test
	+$(BESIDE) lint tests WORKERS=$(CORES) KIND="--skip-unchanged --quick --ignore tests/browser"

# What is too long for every time: many runs, the longer ways through the browser, and what `make test` leaves out while
# the files that it watches stay as they are.
test-slow: .venv/.test system
	+$(BESIDE) tests KIND="-m 'slow or watches' --hypothesis-profile searching"

tests: simulator
	$(PYTEST) $(KIND)

# How long each test takes: the order of `make test`, and what is quick enough for `make check`.
durations: .venv/.test system
	+$(BESIDE) tests KIND=--write-durations

# Compiled before the tests: two workers that find nothing compiled would each do it.
simulator: .venv/.test
	@$(BIN)/python -m nav_model.simulation.warm

# What the Theory page says results were compared with, from the tests that compare them.
validation: .venv/.test
	$(BIN)/python -m pytest -p no:benchmark tests/acceptance tests/nav_model --write-validation

bench: .venv/.test system
	$(BIN)/python -m pytest benchmarks --benchmark-columns=median,iqr,ops,rounds

# Fifty people at once on this machine; means something only when nothing else runs.
load: .venv/.test
	$(BIN)/python benchmarks/load.py

# Hundreds of pages opened, used and closed: what stays of them in the server's memory.
soak: .venv/.test
	$(BIN)/python benchmarks/soak.py

# What is in the image, with its digests, as CycloneDX; made from the lock file alone.
sbom: .venv/.runtime
	$(BIN)/python deploy/sbom.py requirements/image.lock > sbom.json

clean:
	rm -rf .venv build *.egg-info .pytest_cache .mypy_cache .ruff_cache .import_linter_cache
