# Installs the build, then moves the prefix, and fails if something is not where users and
# tools look for it. Arguments: cmake, build folder, prefix.
set -euo pipefail
cmake=$1 build=$2 prefix=$3

rm -rf "$prefix" "$prefix.first"
mkdir -p "$prefix.first"
"$cmake" --install "$build" --prefix "$prefix.first" >"$prefix.log"
mv "$prefix.first" "$prefix"

cd "$prefix"
libdir=$(dirname "$(find . -name libpcl_bayesian_icp.so)")
ls -d include/pcl/registration/bayesian_icp.h \
  include/pcl/registration/impl/bayesian_icp.hpp \
  include/bayesian_icp/pipeline.h \
  "$libdir"/libpcl_bayesian_icp{,_core}.so.[0-9]*.[0-9]*.[0-9]* \
  "$libdir"/cmake/pcl_bayesian_icp/pcl_bayesian_icpConfig{,Version}.cmake \
  "$libdir"/pkgconfig/pcl_bayesian_icp{,_core}.pc \
  share/pcl_bayesian_icp/package.xml \
  share/doc/pcl_bayesian_icp/{README.md,LICENSE,CHANGELOG.md}
(cd share/doc/pcl_bayesian_icp && grep -o '](docs/[^)#]*' README.md | cut -c3- | xargs ls)

# The build folder and the first prefix must be forgotten.
if grep -rl -e "$build" -e "$prefix.first" --include='*.cmake' --include='*.pc' .; then
  exit 1
fi
for library in "$libdir"/libpcl_bayesian_icp{,_core}.so; do
  readelf -d "$library" | grep -F SONAME
  if readelf -d "$library" | grep -E 'R(UN)?PATH' | grep -v -F '[$ORIGIN]'; then
    exit 1
  fi
done
