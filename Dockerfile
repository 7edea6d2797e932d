# An image that has everything built: `docker build -t ddm .`, then `docker run --rm -it ddm`, see doc/install.md.
# SPDX-License-Identifier: BSD-3-Clause
ARG BASE=debian:12
FROM $BASE

# the packages first: they stay the same when the sources change
COPY ddm_launch/scripts/workspace.sh /ddm/ddm_launch/scripts/
RUN bash -euc '. /ddm/ddm_launch/scripts/workspace.sh; check_system; install_packages "${packages_to_run[@]}"' && \
    rm -rf /var/lib/apt/lists/* /var/cache/apt/archives/*.deb

ENV DDM_WS=/ddm_ws
COPY . /ddm
RUN bash -euc '. /ddm/ddm_launch/scripts/workspace.sh; use_system_environment; make_workspace; install_by_rosdep; build_release'

WORKDIR /runs
ENTRYPOINT ["bash", "/ddm/ddm_launch/scripts/entrypoint.sh"]
CMD ["bash", "/ddm/ddm_launch/scripts/demo.sh", "--runs", "/runs/demo"]
