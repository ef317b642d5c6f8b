# Builds and runs the consumers' main programs by what pkg-config says.
# Arguments: prefix, folder of the consumers, work folder, PCL's standard, compiler (and its
# launcher).
set -euo pipefail
prefix=$1 consumers=$2 work=$3 pcl_standard=$4
shift 4
mkdir -p "$work"
libdir=$(dirname "$(find "$prefix" -name pcl_bayesian_icp.pc)")/..
export PKG_CONFIG_PATH=$libdir/pkgconfig

# check <package> <source> <name> <standard>
check() {
  local flags libraries
  read -ra flags < <(pkg-config --cflags "$1")
  read -ra libraries < <(pkg-config --libs "$1")
  echo "$1: ${flags[*]} ${libraries[*]}"
  "${@:5}" -std="$4" "${flags[@]}" -c "$2" -o "$work/$3.o"
  "${@:5}" "$work/$3.o" -o "$work/$3" "${libraries[@]}" "-Wl,-rpath,$libdir"
  "$work/$3"
}
check pcl_bayesian_icp_core "$consumers/core_consumer/main.cpp" core c++14 "$@"
check pcl_bayesian_icp "$consumers/consumer/main.cpp" pcl "$pcl_standard" "$@"
