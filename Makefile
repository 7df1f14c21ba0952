# Two commands do all the set-up on a fresh machine: `make run` and `make test`.
PYTHON ?= python3
PORT ?= 5006
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check

.PHONY: run lock test check test-slow validation bench load soak sbom lint system clean
.DEFAULT_GOAL := run

# Installs what a lock file names, each file checked against its digest. uv does so in a fraction of pip's time; where
# it cannot be had, or does not know the way to the package index that pip is told of, pip does it.
define install
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
	$(BIN)/python tests/support/run.py lint

# Lint and both halves of the tests, each to its end. ORDER=random runs the files, and what is in each, in random order.
test: .venv/.test system
	$(BIN)/python tests/support/run.py test $(ORDER)

# A minute at most, for while one works: lint and what is quick of the tests without a browser.
check: .venv/.test
	$(BIN)/python tests/support/run.py check $(ORDER)

# What is too long for every time: many runs, and the longer ways through the browser.
test-slow: .venv/.test system
	$(BIN)/python tests/support/run.py slow $(ORDER)

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
