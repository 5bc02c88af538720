# shellcheck shell=bash disable=SC2034
#
# What the scripts share; sourced, never run. The sourcing script begins with a comment that is its
# --help.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cores=$(nproc)

fail() {
  echo "$0: $*" >&2
  exit 1
}

# The comment at the head of the script that runs.
print_help() {
  sed -n '2,/^[^#]/{s/^# \{0,1\}//p}' "$0"
}

# value_of OPTION [VALUE]: the value, or an error when the command line ends after the option.
value_of() {
  (($# >= 2)) || fail "$1 needs a value; see --help"
  echo "$2"
}

# Debian packages that a build needs and this machine lacks, one a line. A tool counts as there when
# it is on the PATH, wherever it came from.
missing_packages() {
  local tool package
  while read -r tool package; do
    command -v "$tool" >/dev/null || echo "$package"
  done <<'TOOLS'
g++ g++
cmake cmake
ninja ninja-build
ccache ccache
pkg-config pkg-config
TOOLS
  # Libraries are asked of the package manager; without one, CMake tells what it cannot find.
  command -v dpkg-query >/dev/null || return 0
  for package in libeigen3-dev catch2 libcairo2-dev libcli11-dev libbenchmark-dev libsuitesparse-dev; do
    dpkg-query -W -f '${db:Status-Status}\n' "$package" 2>/dev/null | grep -qx installed ||
      echo "$package"
  done
}

# install_packages PACKAGE...: through apt-get, as root or through sudo.
install_packages() {
  local sudo=()
  if ((EUID != 0)); then
    command -v sudo >/dev/null || fail "install as root: apt-get install $*"
    sudo=(sudo)
  fi
  echo "Installing $*"
  "${sudo[@]}" apt-get -qq update
  "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive \
    apt-get -qq install --yes --no-install-recommends "$@" >/dev/null
}

# Sets `python` to one that has matplotlib. The python3 on the PATH may be another than the one that apt-get serves.
find_python_with_matplotlib() {
  for python in python3 /usr/bin/python3; do
    ! "$python" -c 'import matplotlib' 2>/dev/null || return 0
  done
  [[ ${PLIANT_NO_INSTALL:-0} != 1 ]] || fail "missing: python3-matplotlib"
  install_packages python3-matplotlib
}

# Installs what a build needs. With PLIANT_NO_INSTALL=1, or without apt-get, says what that is.
ensure_packages() {
  local missing
  mapfile -t missing < <(missing_packages)
  ((${#missing[@]})) || return 0
  [[ ${PLIANT_NO_INSTALL:-0} != 1 ]] ||
    fail "missing, and PLIANT_NO_INSTALL=1 keeps this script from installing: ${missing[*]}"
  command -v apt-get >/dev/null ||
    fail "install what your system calls these Debian packages: ${missing[*]}"
  install_packages "${missing[@]}"
}

# compiles_openmp COMPILER: also whether it is there at all.
compiles_openmp() {
  "$1" -fopenmp -x c++ - -o /dev/null <<<'#include <omp.h>
int main() { return omp_get_max_threads() == 0; }' 2>/dev/null
}

# Where CXX names no compiler, lets CMake take clang++ if that knows OpenMP: it compiles tests in half the time of g++, which
# CMake takes else. A build folder keeps its compiler.
prefer_fast_compiler() {
  if [[ -z ${CXX:-} ]] && compiles_openmp clang++; then export CXX=clang++; fi
}

# preset_of BACKEND: the preset in CMakePresets.json that builds it.
preset_of() {
  case $1 in
    reference) echo reference ;;
    openmp) echo release ;;
    cuda) echo cuda ;;
    *) fail "there is no backend '$1'; see --help" ;;
  esac
}

# configure PRESET BUILD-FOLDER [CMAKE-ARGUMENT...]
configure() {
  cmake -S "$root" --preset "$1" -B "$2" "${@:3}"
}
