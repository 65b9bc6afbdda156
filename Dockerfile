# The studio in a container, in two stages: the first builds a wheel and the environment that it runs in,
# the second holds that and nothing else: no compilers, and none of what developers need.
# By digest, so that a build is of the same files whenever it is made. The digest of a newer image is told by
# `docker buildx imagetools inspect python:3.13-slim-trixie`.
ARG PYTHON=python:3.13.15-slim-trixie@sha256:8d9d0b8bcf6506481eae4907c18f5e3e7902e629f5f6d684f9e7c32e85e3ddf0
FROM ${PYTHON} AS build

WORKDIR /build
COPY requirements.lock requirements-run.lock ./
# Builders in an environment of their own, as pinned as the rest.
RUN python -m venv builder \
    && builder/bin/pip install --quiet --no-cache-dir uv==0.13.9 \
    && builder/bin/uv pip install --quiet --python builder/bin/python --require-hashes -r requirements.lock \
    && python -m venv --without-pip /opt/padstudio \
    && builder/bin/uv pip install --quiet --python /opt/padstudio/bin/python --require-hashes -r requirements-run.lock
COPY pyproject.toml README.md LICENSE CHANGELOG.md ./
COPY backend backend
COPY frontend frontend
COPY samples samples
COPY templates templates
RUN builder/bin/uv build --quiet --python builder/bin/python --wheel --no-build-isolation --out-dir dist \
    && builder/bin/uv pip install --quiet --python /opt/padstudio/bin/python --no-deps dist/*.whl \
    && /opt/padstudio/bin/python -m compileall -q /opt/padstudio/lib

FROM ${PYTHON}

RUN useradd --create-home --uid 10001 padstudio \
    && install --directory --owner padstudio --group padstudio /data /var/cache/padstudio
COPY --from=build /opt/padstudio /opt/padstudio

ENV PATH=/opt/padstudio/bin:$PATH \
    PADSTUDIO_DATA=/data \
    PADSTUDIO_HOST=0.0.0.0 \
    PADSTUDIO_PORT=8000 \
    NUMBA_CACHE_DIR=/var/cache/padstudio \
    PYTHONUNBUFFERED=1
USER padstudio
# What Numba compiles is kept in NUMBA_CACHE_DIR.
RUN python -m padstudio.warm
WORKDIR /data
VOLUME /data
EXPOSE 8000

# The one path that answers without a token.
HEALTHCHECK --interval=30s --timeout=5s --start-period=20s --retries=3 \
    CMD ["python", "-c", "import os, urllib.request as u; u.urlopen(f'http://127.0.0.1:{os.environ[\"PADSTUDIO_PORT\"]}/api/v1/health', timeout=4)"]

# As it listens beyond the container, it asks callers for PADSTUDIO_TOKEN; without one it makes one up
# and prints the address with it.
CMD ["padstudio", "serve"]
