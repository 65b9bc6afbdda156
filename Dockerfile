# The studio in a container. The steps are those of `make install`, in two stages: the first builds the
# environment, the second holds it and nothing else.
FROM python:3.13-slim AS build

RUN apt-get update \
    && apt-get install -y --no-install-recommends make \
    && rm -rf /var/lib/apt/lists/*
WORKDIR /opt/padstudio
COPY Makefile pyproject.toml requirements.lock README.md LICENSE ./
COPY backend backend
COPY frontend frontend
COPY samples samples
COPY templates templates
RUN make install && .venv/bin/python -m compileall -q backend

FROM python:3.13-slim

RUN useradd --create-home --uid 10001 padstudio \
    && install --directory --owner padstudio --group padstudio /data /var/cache/padstudio
COPY --from=build /opt/padstudio /opt/padstudio

ENV PATH=/opt/padstudio/.venv/bin:$PATH \
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
