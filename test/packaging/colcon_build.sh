# Builds the tree by colcon, as a ROS user would, uses the result, and fails if the tree is
# not as it was. Arguments: the tree, cmake, generator, ON for a unity build, compiler, compiler
# launcher (may be absent).
set -euo pipefail
tree=$1 cmake=$2 generator=$3 unity=$4 compiler=$5 launcher=${6-}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Names of everything in the tree but the top-level build folders and the history.
names_in_tree() {
  find "$tree" \( -path "$tree/.git" -o -path "$tree/build*" \) -prune -o -print | sort
}
names_in_tree >"$work/before"

# Otherwise Python sets LC_CTYPE where the locale is C, and the compiler cache finds nothing.
export PYTHONCOERCECLOCALE=0
export CCACHE_BASEDIR=$work
export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-2}
export MAKEFLAGS=-j$CMAKE_BUILD_PARALLEL_LEVEL
cd "$work"
# As the tests' build, of which the compiler cache has everything, but the libraries alone:
# packaging.debian builds the programs.
colcon --log-base "$work/log" build --base-paths "$tree" \
  --build-base "$work/build" --install-base "$work/install" \
  --cmake-args -G "$generator" -DCMAKE_UNITY_BUILD="$unity" \
  -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_CXX_COMPILER_LAUNCHER="$launcher" \
  -DBAYESIAN_ICP_BUILD_APPS=OFF -DBAYESIAN_ICP_BUILD_TESTS=OFF \
  -DBAYESIAN_ICP_WARNINGS_AS_ERRORS=ON
names_in_tree | diff "$work/before" -

# The workspace's environment is all that the consumer is told.
set +u
export COLCON_CURRENT_PREFIX=$work/install
source "$work/install/local_setup.sh"
set -u
for consumer in core_consumer consumer; do
  bash "$tree/test/packaging/build_and_run.sh" "$tree/test/packaging/$consumer" \
    "$work/$consumer" "$consumer" "$cmake" -D CMAKE_CXX_COMPILER="$compiler" \
    -D CMAKE_CXX_COMPILER_LAUNCHER="$launcher"
done
