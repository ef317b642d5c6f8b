# Builds and runs the core consumer's main program by what pkg-config says. packaging.abi does
# so for the class. Arguments: prefix, folder of the consumers, work folder, compiler (and its
# launcher).
set -euo pipefail
prefix=$1 consumers=$2 work=$3
shift 3
mkdir -p "$work"
libdir=$(dirname "$(find "$prefix" -name pcl_bayesian_icp_core.pc)")/..
export PKG_CONFIG_PATH=$libdir/pkgconfig
read -ra flags < <(pkg-config --cflags pcl_bayesian_icp_core)
read -ra libraries < <(pkg-config --libs pcl_bayesian_icp_core)
echo "${flags[*]} ${libraries[*]}"
"$@" -std=c++14 "${flags[@]}" -c "$consumers/core_consumer/main.cpp" -o "$work/main.o"
"$@" "$work/main.o" -o "$work/core" "${libraries[@]}" "-Wl,-rpath,$libdir"
"$work/core"
