# Fails unless every installed header compiles alone, as C++14 and without a warning: PCL
# 1.13 and its users are at C++14. Arguments: include folder, compilers.
set -euo pipefail
include=$1
shift
cd "$include"
mapfile -t headers < <(find bayesian_icp -name '*.h' | sort)
read -ra libraries < <(pkg-config --cflags-only-I eigen3 pcl_registration)
((${#headers[@]})) || { echo "no headers in $include"; exit 1; }

# compile <compiler> <header>
compile() {
  "$1" -std=c++14 -fsyntax-only -Wall -Wextra -Wpedantic -Werror -I "$include" \
    "${libraries[@]/#-I/-isystem}" -include "$2" -x c++ /dev/null
}

for compiler in "$@"; do
  for header in "${headers[@]}"; do
    echo "$compiler $header"
    compile "$compiler" "$header"
  done
done
for header in pcl/registration/{bayesian_icp,stochastic_gradient_icp}.h; do
  echo "$1 $header"
  compile "$1" "$header"
done
