# Two commands do all the set-up on a fresh machine: `make run` and `make test`.
PYTHON ?= python3
PORT ?= 5006
BIN := .venv/bin

.PHONY: run test check test-slow validation bench load lint browser postgresql nginx clean
.DEFAULT_GOAL := run

.venv/.runtime: pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e .
	touch $@

.venv/.test: .venv/.runtime
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e '.[test]'
	touch $@

run: .venv/.runtime
	$(BIN)/navbudget serve --port $(PORT)

# Debian's chromium drives the browser tests; a missing browser is a failure, so it is installed here.
browser:
	@command -v chromium >/dev/null || command -v chromium-browser >/dev/null || { \
	  sudo=$$(test "$$(id -u)" = 0 || echo sudo); \
	  $$sudo apt-get update -q && $$sudo apt-get install -y -q --no-install-recommends chromium; }

# The library is tested against a real PostgreSQL, which the test starts itself.
postgresql:
	@test -n "$$(ls /usr/lib/postgresql/*/bin/initdb 2>/dev/null)" || command -v initdb >/dev/null || { \
	  sudo=$$(test "$$(id -u)" = 0 || echo sudo); \
	  $$sudo apt-get update -q && $$sudo apt-get install -y -q --no-install-recommends postgresql; }

# The proxy's file in deploy/ is tested in a real nginx.
nginx:
	@test -x /usr/sbin/nginx || command -v nginx >/dev/null || { \
	  sudo=$$(test "$$(id -u)" = 0 || echo sudo); \
	  $$sudo apt-get update -q && $$sudo apt-get install -y -q --no-install-recommends nginx; }

lint: .venv/.test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/hadolint Dockerfile

# Lint and both halves of the tests, each to its end. ORDER=random runs the files, and what is in each, in random order.
test: .venv/.test browser postgresql nginx
	$(BIN)/python tests/support/run.py test $(ORDER)

# A minute at most, for while one works: lint and what is quick of the tests without a browser.
check: .venv/.test
	$(BIN)/python tests/support/run.py check $(ORDER)

# What is too long for every time: many runs, and the longer ways through the browser.
test-slow: .venv/.test browser postgresql nginx
	$(BIN)/python tests/support/run.py slow $(ORDER)

# What the Theory page says results were compared with, from the tests that compare them.
validation: .venv/.test
	$(BIN)/python -m pytest -p no:benchmark tests/acceptance tests/nav_model --write-validation

bench: .venv/.test browser
	$(BIN)/python -m pytest benchmarks --benchmark-columns=median,iqr,ops,rounds

# Fifty people at once on this machine; means something only when nothing else runs.
load: .venv/.test
	$(BIN)/python benchmarks/load.py

clean:
	rm -rf .venv build *.egg-info .pytest_cache .mypy_cache .ruff_cache .import_linter_cache
