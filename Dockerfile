# docker build -t rtphys . && docker run -v "$PWD/data:/data" rtphys collect --task click_bell --episodes 2 --out /data
# Both README commands:  docker run --entrypoint make rtphys collect    and    docker run --entrypoint make rtphys test
FROM python:3.12-slim-trixie
RUN apt-get update && apt-get install -y --no-install-recommends make git ca-certificates \
        libx11-6 libgomp1 libvulkan1 mesa-vulkan-drivers && rm -rf /var/lib/apt/lists/*
WORKDIR /opt/rtphys
COPY . .
RUN make setup-test
ENV PATH=/opt/rtphys/.venv/bin:$PATH
ENTRYPOINT ["rtphys"]
CMD ["--help"]
