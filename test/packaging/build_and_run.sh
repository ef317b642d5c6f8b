# Copies a small project out of the tree, builds it and runs its program.
# Arguments: project folder, work folder, program, then CMake and its arguments.
set -euo pipefail
project=$1 work=$2 program=$3
shift 3
rm -rf "$work"
mkdir -p "$work"
cp -r "$project" "$work/source"
"$@" -S "$work/source" -B "$work/build"
"$1" --build "$work/build"
"$work/build/$program"
