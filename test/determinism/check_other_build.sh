# Builds the core and determinism_reference anew, and compares its numbers with the stored
# ones. Arguments: the tree, build folder, stored numbers, then CMake and its arguments.
set -euo pipefail
tree=$1 build=$2 stored=$3 cmake=$4
shift 3
"$@" -S "$tree" -B "$build" -D BAYESIAN_ICP_BUILD_APPS=OFF
"$cmake" --build "$build" --parallel 2 --target determinism_reference
"$build/bin/determinism_reference" --check "$stored"
