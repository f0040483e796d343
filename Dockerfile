# docker build -t stickslip .
# docker run --rm -v "$PWD:/data" stickslip select rig.toml
FROM python:3.13-slim AS built
COPY . /source
RUN python -m venv /opt/stickslip \
    && /opt/stickslip/bin/pip install --no-cache-dir -c /source/constraints.txt "/source[parquet,xlsx]"
# Machine code for any processor of this architecture, compiled once; root owns it, all may read it.
ENV STICKSLIP_CACHE=/opt/stickslip-code STICKSLIP_CPU=generic
RUN mkdir -m 755 /opt/stickslip-code && /opt/stickslip/bin/stickslip warmup

FROM python:3.13-slim
COPY --from=built /opt/stickslip /opt/stickslip
COPY --from=built /opt/stickslip-code /opt/stickslip-code
ENV PATH=/opt/stickslip/bin:$PATH STICKSLIP_CACHE=/opt/stickslip-code STICKSLIP_CPU=generic \
    STICKSLIP_BACKGROUND=0 MPLCONFIGDIR=/tmp/matplotlib
WORKDIR /data
ENTRYPOINT ["stickslip"]
CMD ["--help"]
