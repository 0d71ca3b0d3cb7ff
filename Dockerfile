# The nodes and `eha` on a machine without ROS 2:
#   docker build --tag eha .
#   docker run --rm --interactive --tty eha eha diagnose bags/rig_five_effects.mcap --out out/five
FROM python:3.12-slim-bookworm
# Debian removes superseded versions from its mirrors, so none is pinned.
# hadolint ignore=DL3008
RUN apt-get update \
 && apt-get install --no-install-recommends --yes make \
 && rm -rf /var/lib/apt/lists/* \
 && useradd --uid 1000 --create-home eha
USER 1000
WORKDIR /home/eha/eha
COPY --chown=1000:1000 . .
RUN make PYTHON=python3 env
ENV PATH="/home/eha/eha/.venv/bin:$PATH" ROS_AUTOMATIC_DISCOVERY_RANGE=LOCALHOST
CMD ["bash"]
