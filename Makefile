# Two commands do all the set-up on a fresh machine: `make run` and `make test`.
PYTHON ?= python3
PORT ?= 5006
BIN := .venv/bin

.PHONY: run test test-slow validation bench load lint browser postgresql nginx clean
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

test: .venv/.test browser postgresql nginx lint
	$(BIN)/python -m pytest -n 3 --dist loadfile -p no:benchmark --ignore tests/browser
	$(BIN)/python -m pytest -n 2 --dist load -p no:benchmark tests/browser

test-slow: .venv/.test browser postgresql nginx
	$(BIN)/python -m pytest -n 2 -m slow -p no:benchmark --ignore tests/browser
	$(BIN)/python -m pytest -n 2 -m slow -p no:benchmark tests/browser

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
