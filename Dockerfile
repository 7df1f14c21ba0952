FROM python:3.11-slim AS build
WORKDIR /src
COPY requirements/image.lock requirements/
RUN python -m venv /opt/navbudget \
 && /opt/navbudget/bin/pip install --no-cache-dir --require-hashes -r requirements/image.lock
COPY pyproject.toml README.md LICENSE ./
COPY nav_model nav_model
COPY app app
# What only installs stays behind.
RUN /opt/navbudget/bin/pip install --no-cache-dir --no-deps --no-build-isolation . \
 && /opt/navbudget/bin/pip uninstall --quiet --yes setuptools pip

FROM python:3.11-slim
RUN useradd --create-home --uid 10001 navbudget
COPY --from=build /opt/navbudget /opt/navbudget
USER 10001
WORKDIR /home/navbudget
# Saved designs, unless --library says otherwise: mount a volume here to keep them.
RUN mkdir -p .cache .local/share/navbudget kernels
# Compiled kernels and fonts are cached here; the package itself is not writable for this user.
ENV NUMBA_CACHE_DIR=/home/navbudget/kernels MPLCONFIGDIR=/home/navbudget/.cache/matplotlib
# Compiled for this machine's processor. On another kind the first run compiles again, once if a volume keeps it.
RUN /opt/navbudget/bin/python -m nav_model.simulation.warm
EXPOSE 5006
HEALTHCHECK --interval=30s --timeout=5s --start-period=20s --retries=3 \
  CMD ["/opt/navbudget/bin/python", "-c", "import urllib.request; urllib.request.urlopen('http://127.0.0.1:5006/liveness', timeout=4)"]
# Off loopback the server wants to know who may enter: mount a password file, or give another command with --open.
# Browsers reach the page under the host they typed: name it with --allow-origin HOST:PORT. See deploy/README.md.
ENTRYPOINT ["/opt/navbudget/bin/navbudget"]
CMD ["serve", "--address", "0.0.0.0", "--port", "5006", "--password-file", "/run/secrets/people"]
