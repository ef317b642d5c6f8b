# Makes the Debian packages, has lintian look at them, installs them in a root of their own,
# builds a program with them there, and purges them. Arguments: cmake, cpack, build folder,
# work folder, lintian (may be empty), compiler, compiler launcher (may be absent).
set -euo pipefail
cmake=$1 cpack=$2 build=$3 work=$4 lintian=$5 compiler=$6 launcher=${7-}
here=$(dirname "$(realpath "$0")")
rm -rf "$work"
mkdir -p "$work"
"$cpack" -G DEB --config "$build/CPackConfig.cmake" -B "$work/packages"
cd "$work/packages"
rm -rf _CPack_Packages
packages=(*.deb)
printf '%s\n' "${packages[@]}"
# No script of ours runs on the user's machine.
for package in "${packages[@]}"; do
  if dpkg-deb --ctrl-tarfile "$package" | tar -t | grep -E '/(pre|post)(inst|rm)$'; then
    exit 1
  fi
done
if [[ -n $lintian ]]; then
  "$lintian" --fail-on error "${packages[@]}"
fi

# What a package needs is what dpkg-shlibdeps found, and of ours the same version.
version=$(dpkg-deb -f "${packages[0]}" Version)
for package in "${packages[@]}"; do
  dpkg-deb -f "$package" Package Depends Maintainer
done
library=$(dpkg-deb -f libpcl-bayesian-icp[0-9]*.deb Package)
dpkg-deb -f libpcl-bayesian-icp[0-9]*.deb Depends | grep -E 'libc6 .*libpcl-common.*libstdc\+\+6'
dpkg-deb -f libpcl-bayesian-icp-dev_*.deb Depends | grep -F "$library (= $version)"
dpkg-deb -f libpcl-bayesian-icp-dev_*.deb Depends | grep -F 'libpcl-dev (>= 1.13)'
# Whether there are such packages, and they go together; nothing is installed.
if command -v apt-get >/dev/null; then
  apt-get install --simulate "${packages[@]/#/./}" >"$work/apt.log" 2>&1 || {
    cat "$work/apt.log"
    exit 1
  }
  grep -c '^Inst ' "$work/apt.log" | sed 's/$/ packages would be installed by apt/'
else
  echo "apt-get is not here: nobody has looked whether what the packages need is there"
fi

# An empty system of its own, whose libraries are those of this machine.
root=$work/root
mkdir -p "$root/var/lib/dpkg/"{info,updates}
touch "$root/var/lib/dpkg/"{status,available}
private_dpkg() {
  dpkg --root="$root" --force-not-root --force-depends \
    --log="$work/dpkg.log" "$@"
}
files() {
  (cd "$root" && find . -path ./var/lib/dpkg -prune -o ! -type d -print)
}
private_dpkg --install "${packages[@]}" >"$work/install.log" 2>&1 || {
  cat "$work/install.log"
  exit 1
}
files | grep -c . | sed 's/$/ files installed/'
for tool in "$root"/usr/bin/*; do
  LD_LIBRARY_PATH=$root/usr/lib "$tool" --help >/dev/null
  [[ -e $root/usr/share/man/man1/${tool##*/}.1.gz ]] ||
    [[ -z $(find "$build/man" -name '*.1' 2>/dev/null) ]]
done
python_package=$root/usr/lib/python3/dist-packages
if [[ -d $python_package ]]; then
  LD_LIBRARY_PATH=$root/usr/lib PYTHONPATH=$python_package "${PYTHON:-python3}" -B -c \
    'import bayesian_icp; print(bayesian_icp.__file__, len(bayesian_icp.scenes()), "scenes")'
fi
diff -r "$here/../../include" "$root/usr/include"
bash "$here/build_and_run.sh" "$here/core_consumer" "$work/core_consumer" core_consumer \
  "$cmake" -D CMAKE_PREFIX_PATH="$root/usr" -D CMAKE_CXX_COMPILER="$compiler" \
  -D CMAKE_CXX_COMPILER_LAUNCHER="$launcher"
PKG_CONFIG_PATH=$(dirname "$(find "$root" -name pcl_bayesian_icp.pc)") \
  pkg-config --exists --print-errors pcl_bayesian_icp

mapfile -t names < <(for package in "${packages[@]}"; do dpkg-deb -f "$package" Package; done)
private_dpkg --purge "${names[@]}" >"$work/purge.log" 2>&1 || {
  cat "$work/purge.log"
  exit 1
}
if files | grep .; then
  echo "left behind after purging"
  exit 1
fi
