# Houses and environments in a container, without PyTorch: under 1 GB.
#   docker build -t vitruvius .
#   docker run --rm -v "$PWD:/work" vitruvius generate --rooms 5 --grammar home --out houses.jsonl
# With --build-arg EXTRA=agent it also learns; docs/install.md lists the extras.
FROM debian:12-slim
ARG EXTRA=sim
RUN apt-get update \
 && apt-get install -y --no-install-recommends python3-venv swi-prolog-nox libx11-6 \
 && rm -rf /var/lib/apt/lists/*
COPY . /src
RUN python3 -m venv /opt/vitruvius \
 && /opt/vitruvius/bin/pip install --no-cache-dir "/src[$EXTRA]" \
 && rm -rf /src
ENV PATH=/opt/vitruvius/bin:$PATH
WORKDIR /work
ENTRYPOINT ["vitruvius"]
