# Shared by scripts/demo and scripts/test: where things are, and how to build.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
build=$root/build

# Parallel jobs: CMAKE_BUILD_PARALLEL_LEVEL, or else one per processor, if there are 2 GB
# of free memory for each.
num_jobs() {
  local processors memory
  processors=$(nproc)
  memory=$(awk '/^MemAvailable:/ { print int($2 / 2000000) }' /proc/meminfo)
  echo "${CMAKE_BUILD_PARALLEL_LEVEL:-$((memory < 1 ? 1 : memory < processors ? memory : processors))}"
}

# The option of CMake for a linker that takes a third of the time, where it is installed.
fast_linker() {
  if command -v ld.lld >/dev/null; then
    echo -DCMAKE_EXE_LINKER_FLAGS=-fuse-ld=lld
  fi
}

# Configures build/. Arguments go to CMake; an existing build folder keeps its generator.
# Files are compiled several at once, which saves 40 % of a build from nothing.
configure() {
  local generator=()
  if [[ ! -f $build/CMakeCache.txt ]] && command -v ninja >/dev/null; then
    generator=(-G Ninja)
  fi
  cmake -S "$root" -B "$build" "${generator[@]}" -DCMAKE_UNITY_BUILD=ON "$@"
}

# Builds the targets named by the arguments, or everything.
compile() {
  cmake --build "$build" --parallel "$(num_jobs)" "${@/#/--target=}"
}
