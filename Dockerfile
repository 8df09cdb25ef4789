# docker build -t semtopo . && docker run -p 8000:8000 -v semtopo:/data semtopo
FROM python:3.12-slim AS build
ENV PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_NO_CACHE_DIR=1
WORKDIR /src
COPY requirements-build.lock requirements-runtime.lock ./
RUN python -m venv /opt/semtopo \
    && /opt/semtopo/bin/pip install --require-hashes -r requirements-runtime.lock \
    && pip install --require-hashes -r requirements-build.lock
COPY . .
RUN pip wheel --no-deps --no-build-isolation --wheel-dir /dist . \
    && /opt/semtopo/bin/pip install --no-deps --no-index /dist/*.whl

FROM python:3.12-slim
COPY --from=build /opt/semtopo /opt/semtopo
RUN useradd --system --user-group --uid 10001 --no-create-home semtopo \
    && install -d -o semtopo -g semtopo /data
ENV PATH=/opt/semtopo/bin:$PATH PYTHONUNBUFFERED=1 SEMTOPO_DATABASE=sqlite:////data/semtopo.db
USER 10001
WORKDIR /data
VOLUME /data
EXPOSE 8000
HEALTHCHECK --interval=10s --timeout=5s --start-period=20s --retries=3 \
    CMD ["python", "-c", "from urllib.request import urlopen; urlopen('http://127.0.0.1:8000/healthz', timeout=3)"]
ENTRYPOINT ["semtopo"]
# every request needs a key; one is made by: docker exec CONTAINER semtopo keys add NAME
CMD ["serve", "--host", "0.0.0.0", "--port", "8000", "--keys"]
