# Compiles the consumer by what pkg-config says in several ways, and fails unless each finds
# the true pose and prints the report of the consumer that CMake has built.
# Arguments: prefix, folder of the sources, consumer built by CMake, work folder, then ways:
# compiler:standard:flags, with commas between flags.
set -euo pipefail
prefix=$1 sources=$2 consumer=$3 work=$4
shift 4
rm -rf "$work"
mkdir -p "$work"
libdir=$(dirname "$(find "$prefix" -name libpcl_bayesian_icp.so)")
export PKG_CONFIG_PATH=$libdir/pkgconfig
read -ra includes < <(pkg-config --cflags pcl_bayesian_icp)
read -ra libraries < <(pkg-config --libs pcl_bayesian_icp)
launcher=()
if command -v ccache >/dev/null; then
  launcher=(ccache)
fi

# compare <name> <expected> <found>
compare() {
  if ! diff "$2" "$3" >"$work/difference"; then
    cut -c1-120 "$work/difference"
    echo "$1 is not the one of $2"
    return 1
  fi
}

"$consumer" --report >"$work/expected" 2>"$work/messages"
"$consumer" --layout >"$work/layout"
for way in "$@"; do
  IFS=: read -r compiler standard flags <<<"$way"
  IFS=, read -ra flags <<<"$flags"
  for part in main own_point_type; do
    "${launcher[@]}" "$compiler" "-std=$standard" "${flags[@]}" "${includes[@]}" \
      -c "$sources/$part.cpp" -o "$work/$part.o"
  done
  "$compiler" "$work"/{main,own_point_type}.o -o "$work/consumer" "${libraries[@]}" \
    -llz4 "-Wl,-rpath,$libdir"
  "$work/consumer"
  "$work/consumer" --layout >"$work/found_layout"
  compare "$way: the layout" "$work/layout" "$work/found_layout"
  "$work/consumer" --report >"$work/found" 2>"$work/messages"
  compare "$way: the report" "$work/expected" "$work/found"
  echo "$way: $(grep -c . "$work/found") lines as those of the first consumer"
done
