# Functions for demo.sh and test.sh: from a bare system to a built catkin workspace that links this checkout.
# SPDX-License-Identifier: BSD-3-Clause
# shellcheck shell=bash disable=SC2034

checkout=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd -P)

say() { printf '\n== %s\n' "$*"; }

fail() {
  printf '\nERROR: %s\n' "$*" >&2
  exit 1
}

warn() { printf '\nWARNING: %s\n' "$*" >&2; }

# Folder of ROS Noetic and ROS-O. Debian's own packages of ROS are in /usr.
opt_ros=${opt_ros:-/opt/ros}

# Prints the setup file of ROS 1 in $opt_ros, if it exists.
ros_setup() {
  local setup
  for setup in "$opt_ros"/{noetic,one}/setup.bash; do
    [[ ! -f $setup ]] || { echo "$setup" && return; }
  done
}

# Packages of Debian and Ubuntu for building and running all programs and tests (both scripts share one build).
packages_to_run=(
  # compiler and build tools; `study reproduce` also needs make
  build-essential cmake python3-setuptools
  # Python bindings
  pybind11-dev python3-dev
  # libraries
  libopencv-imgproc-dev libopencv-imgcodecs-dev libeigen3-dev libceres-dev libyaml-cpp-dev libbz2-dev
  libboost-dev libboost-program-options-dev libboost-filesystem-dev
  # plants with a model file: physics, and images without a screen
  libmujoco-dev libegl-dev libegl1 libgl1-mesa-dri libtinyxml2-dev
  # tests
  libgtest-dev python3-opencv
  # figures
  python3-matplotlib python3-numpy python3-pandas python3-pil python3-tqdm python3-yaml
  # sweeps
  parallel
)
# ROS 1 from Debian. Any other ROS has its own packages, which rosdep finds through package.xml.
[[ -n $(ros_setup) ]] || packages_to_run+=(
  catkin python3-catkin-pkg
  # messages: the .msg files, then their C++ headers
  ros-message-generation ros-message-runtime
  ros-std-msgs ros-sensor-msgs ros-geometry-msgs ros-actionlib-msgs ros-rosgraph-msgs ros-diagnostic-msgs
  libstd-msgs-dev libsensor-msgs-dev libgeometry-msgs-dev libactionlib-msgs-dev libros-rosgraph-msgs-dev
  libdiagnostic-msgs-dev
  # ROS in C++
  ros-std-srvs libstd-srvs-dev python3-std-srvs
  libroscpp-dev libactionlib-dev librosbag-dev libroslz4-dev libcv-bridge-dev libimage-transport-dev libroslib-dev
  libdiagnostic-updater-dev pluginlib-dev libtf2-ros-dev
  # tests
  librostest-dev python3-rostest python3-rosunit
  # ROS in Python and its command line tools
  python3-rospy python3-std-msgs python3-sensor-msgs python3-actionlib python3-cv-bridge
  python3-roslaunch python3-rosbag python3-rostopic python3-rosnode python3-rosservice
  python3-rosparam python3-rosmsg python3-diagnostic-msgs
  rosbash rospack-tools rviz
)
# Packages that some systems lack. The comment after a package says what is missing without it.
optional_packages=(libmujoco-dev)  # plants with a model file: not in Debian 11 and Ubuntu 22.04

# Sources a catkin setup file. `set +u`, because the file reads variables that may be unset.
source_setup() {  # FILE
  local setup=$1
  shift  # otherwise the setup file would read the arguments of this function
  set +u
  . "$setup"
  set -u
}

# Puts the system's own tools and libraries first, even if the caller has activated another Python or ROS environment.
use_system_environment() {
  export PATH=/usr/bin:/bin:/usr/sbin:/sbin:$PATH
  unset PYTHONPATH PYTHONHOME LD_LIBRARY_PATH CMAKE_PREFIX_PATH
  unset ROS_PACKAGE_PATH ROS_ROOT ROS_DISTRO ROS_MASTER_URI
  local setup
  setup=$(ros_setup)
  [[ -z $setup ]] || source_setup "$setup"
  export PYTHONNOUSERSITE=1
  export PYTHONUNBUFFERED=1 ROSCONSOLE_STDOUT_LINE_BUFFERED=1  # programs show progress immediately, also through pipes
  # Only this machine can reach master and nodes, unless the caller sets an address.
  [[ -n ${ROS_IP:-}${ROS_HOSTNAME:-} ]] || export ROS_IP=127.0.0.1
}

# Prints the name of this system, and warns if it is not one of the tested systems. Argument: an os-release file.
check_system() {
  local file=${1:-/etc/os-release} id='' version='' name='an unknown system' setup
  setup=$(ros_setup)
  if [[ -r $file ]]; then
    id=$(. "$file" && printf %s "${ID:-}")
    version=$(. "$file" && printf %s "${VERSION_ID:-}")
    name=$(. "$file" && printf %s "${PRETTY_NAME:-$name}")
  fi
  if [[ $id == debian && $version =~ ^1[123]$ && -z $setup ]]; then
    echo "System: $name"
  else
    warn "this is $name${setup:+ with $setup}. DDM is tested on Debian 11, 12 and 13 with Debian's own ROS 1 packages, not here.
If something fails, see 'Other systems' in $checkout/doc/install.md, or use a container:
    docker run --rm -it -v $checkout:/ddm debian:12 bash /ddm/ddm_launch/scripts/${0##*/}"
  fi
}

# Prints those arguments that are not installed.
missing_packages() {
  local installed package
  # dpkg-query fails if it does not find one of the names, but prints the others.
  installed=$(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "$@" 2>/dev/null || true)
  for package in "$@"; do
    grep -qxF -- "installed $package" <<<"$installed" || echo "$package"
  done
}

# Runs a command as root, through sudo if necessary. Arguments: a description of the action, then the command.
as_root() {
  local words=$1
  shift
  if [[ $(id -u) == 0 ]]; then
    "$@"
  elif command -v sudo >/dev/null; then
    sudo "$@"
  else
    fail "to $words needs root, and there is no sudo.
Remedy: have an administrator run, then call this script again:
    ${*@Q}"
  fi
}

around_apt=()  # prefix for apt-get commands; test.sh sets it

# Installs packages with apt-get. Arguments: a command to run before the installation, or an empty string; then the
# packages.
apt_install() {
  local before=$1
  shift
  (($#)) || return 0
  # One command, so that users without root can give the printed line to an administrator. It waits until another apt
  # has finished.
  local apt='apt-get -o DPkg::Lock::Timeout=300'
  echo "Installing $# missing packages: $*"
  as_root "install packages" env DEBIAN_FRONTEND=noninteractive "${around_apt[@]}" sh -c \
    "${before:+$apt $before && }$apt install -y --no-install-recommends $*" </dev/null ||
    fail "the packages could not be installed: see apt-get's lines above.
Remedy: check the network and /etc/apt, then call this script again. If this system has no such package, see
'Other systems' in $checkout/doc/install.md."
}

# Prints those arguments that exist in the package lists of this system.
available_packages() {
  local package
  for package in "$@"; do
    ! apt-cache show "$package" >/dev/null 2>&1 || echo "$package"
  done
}

# Installs those arguments that are missing. If nothing is missing, it needs neither a password nor a network. Skips
# optional packages that this system does not have, and names them.
install_packages() {
  local package missing required=() optional=() available
  mapfile -t missing < <(missing_packages "$@")
  if ((${#missing[@]} == 0)); then
    echo "Packages: all $# installed"
    return
  fi
  if ! command -v apt-get >/dev/null; then
    warn "this system has no apt-get, so nothing is installed. The build needs, by the names of Debian: $*"
    return
  fi
  for package in "${missing[@]}"; do
    if [[ " ${optional_packages[*]} " == *" $package "* ]]; then optional+=("$package"); else required+=("$package"); fi
  done
  apt_install update "${required[@]}"
  mapfile -t available < <(available_packages "${optional[@]}")
  apt_install '' "${available[@]}"
  for package in "${optional[@]}"; do
    [[ " ${available[*]} " == *" $package "* ]] || echo "Not available on this system, and left out: $package"
  done
}

# Installs the packages in package.xml if ROS is not Debian's own. If rosdep fails, the build reports what is missing.
install_by_rosdep() {
  [[ -n $(ros_setup) ]] || return 0
  if ! command -v rosdep >/dev/null; then
    warn "rosdep is not installed, so the packages that package.xml lists are not installed either.
Remedy, if the build misses one: install rosdep (python3-rosdep), run 'sudo rosdep init', and call this script again."
    return
  fi
  { rosdep update --rosdistro "$ROS_DISTRO" &&
    rosdep install --from-paths "$checkout" --ignore-src --rosdistro "$ROS_DISTRO" -y -r; } ||
    warn "rosdep did not install everything that package.xml lists: see its lines above. The build is tried all the same."
}

# Adds the name localhost, which ROS needs and bare systems (for example, made by debootstrap) lack.
ensure_localhost_resolves() {
  getent hosts localhost >/dev/null && return
  echo "The name localhost does not resolve: adding the line '127.0.0.1 localhost' to /etc/hosts"
  as_root "add a line to /etc/hosts" sh -c 'echo "127.0.0.1 localhost" >>/etc/hosts'
}

# Prints a port for the ROS master: the default port, or any free port if another master uses the default port.
free_master_port() {
  if (: </dev/tcp/localhost/11311) 2>/dev/null; then
    /usr/bin/python3 -c 'import socket; probe = socket.socket(); probe.bind(("", 0)); print(probe.getsockname()[1])'
  else
    echo 11311
  fi
}

# Makes the workspace $DDM_WS (default: ~/ddm_ws) with this checkout in its source space.
make_workspace() {
  DDM_WS=$(realpath -m -- "${DDM_WS:-$HOME/ddm_ws}")
  [[ $DDM_WS != *[[:space:]]* ]] || fail "the workspace '$DDM_WS' must not have a space in its path.
Remedy: set DDM_WS to another folder."
  [[ $DDM_WS/ != "$checkout"/* ]] || fail "the workspace $DDM_WS lies inside the checkout $checkout.
Remedy: set DDM_WS to a folder outside of it."
  mkdir -p "$DDM_WS/src" || fail "cannot make $DDM_WS/src. Remedy: set DDM_WS to a folder that you may write."
  export DDM_WS ROS_HOME=$DDM_WS/ros_home
  [[ $checkout == "$DDM_WS/src/"* ]] && return  # cloned into the source space, so no link is needed
  local link=$DDM_WS/src/ddm
  if [[ ! -e $link && ! -L $link ]]; then
    ln -s "$checkout" "$link"
  elif [[ $(realpath -m "$link") != "$checkout" ]]; then
    fail "$link exists and is not this checkout ($checkout) but $(realpath -m "$link").
Remedy: remove it, or set DDM_WS to another folder."
  fi
}

# Prints the number of compiler jobs: one per core, with at least two gigabytes for each. catkin's variable
# ROS_PARALLEL_JOBS takes precedence.
job_flags() {
  if [[ -n ${ROS_PARALLEL_JOBS:-} ]]; then
    echo "$ROS_PARALLEL_JOBS"
    return
  fi
  local cores memory
  cores=$(nproc)
  memory=$(awk '/^MemAvailable/ {print int($2 / 2000000)}' /proc/meminfo)
  ((memory >= 1)) || memory=1
  echo "-j$((cores < memory ? cores : memory))"
}

# A first build is fastest if all sources of a target are compiled together, because most of the time goes into headers.
unity_flags=(-DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=0)

# Makes a devel space with the folders that catkin writes into the environment of tests. catkin does so only at the
# first configuration, and only for folders that exist.
make_devel_space() {  # FOLDER
  mkdir -p "$1/bin" "$1/lib/pkgconfig" "$1/lib/python3/dist-packages"
}

# Runs the Release build in $DDM_WS/build and $DDM_WS/devel. Arguments: make targets, or none for all programs. demo.sh
# and test.sh must use the same flags, because otherwise each script would rebuild the results of the other.
build_release() {
  local flags=(-DCMAKE_BUILD_TYPE=Release -DDDM_AVX2="${DDM_AVX2:-ON}" -DDDM_WERROR=OFF "${unity_flags[@]}") jobs
  [[ -z ${CI:-} ]] || flags[2]=-DDDM_WERROR=ON
  read -ra jobs < <(job_flags)
  make_devel_space "$DDM_WS/devel"
  catkin_make -C "$DDM_WS" "${jobs[@]}" "${flags[@]}" "$@"
}
