# Fails unless every C++ file is as clang-format 14 would write it. Exit code 77 without it:
# other versions write other things.
# Argument: the tree.
set -euo pipefail
cd "$1"
if ! command -v clang-format-14 >/dev/null; then
  echo "skipped: clang-format-14 is not here, and other versions format otherwise"
  exit 77
fi
mapfile -t files < <(find include src apps evaluation python test benchmark \
  -name "*.h" -o -name "*.hpp" -o -name "*.cpp")
echo "${#files[@]} files; to repair: clang-format-14 -i FILE..."
clang-format-14 --dry-run -Werror --style=file "${files[@]}"
