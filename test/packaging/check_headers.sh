# Fails unless every installed header compiles alone and without a warning: those of the core
# as C++14, which is that of PCL 1.13 and its users, the others by PCL's own standard. Other
# compilers than the first get those of the core all at once.
# Arguments: include folder, PCL's standard, compilers.
set -euo pipefail
include=$1 pcl_standard=$2
shift 2
cd "$include"
mapfile -t headers < <(find bayesian_icp -name '*.h' | sort)
read -ra libraries < <(pkg-config --cflags-only-I eigen3 pcl_registration)
((${#headers[@]})) || { echo "no headers in $include"; exit 1; }

# compile <compiler> <standard> <header>...
compile() {
  local compiler=$1 standard=$2
  shift 2
  echo "$compiler $*"
  "$compiler" -std="$standard" -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I "$include" \
    "${libraries[@]/#-I/-isystem}" "${@/#/-include}" -x c++ /dev/null
}

# What another header includes first is compiled there, with nothing before it.
first_includes=$(grep -h -m1 '^#include' "${headers[@]}")
for header in "${headers[@]}"; do
  if ! grep -q -F "<$header>" <<<"$first_includes"; then
    compile "$1" c++14 "$header"
  fi
done
for header in pcl/registration/{bayesian_icp,stochastic_gradient_icp}.h; do
  compile "$1" "$pcl_standard" "$header"
done
for compiler in "${@:2}"; do
  compile "$compiler" c++14 "${headers[@]}"
done
