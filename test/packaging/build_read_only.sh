# Configures the tree, with everything that it has, and compiles a file of the core where
# the tree is mounted read-only. Arguments: the tree, work folder, then CMake and its
# arguments. Exit code 77 where such a mount is not permitted.
set -euo pipefail
tree=$1 work=$2
shift 2
rm -rf "$work"
mkdir -p "$work/tree"
namespace=(unshare --mount)
[ "$(id -u)" = 0 ] || namespace+=(--map-root-user)
mount_tree='mount --bind "$1" "$2/tree" && mount -o remount,bind,ro "$2/tree"'
if ! "${namespace[@]}" sh -c "$mount_tree" sh "$tree" "$work"; then
  echo "mounts are not permitted here"
  exit 77
fi
"${namespace[@]}" bash -euc "$mount_tree"'
  work=$2
  shift 2
  if touch "$work/tree/new"; then
    exit 1
  fi
  "$@" -S "$work/tree" -B "$work/build"
  make -C "$work/build/src" geometry/pose.o
' bash "$tree" "$work" "$@"
