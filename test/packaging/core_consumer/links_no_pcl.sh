# Fails if the program, or a library that it loads, needs a library of PCL.
set -euo pipefail
libraries=$(ldd "$1")
grep -F libpcl_bayesian_icp_core.so <<<"$libraries"
if grep libpcl_ <<<"$libraries" | grep -v -F libpcl_bayesian_icp_core.so; then
  exit 1
fi
