# Fails unless every C++ file is as clang-format 14 would write it.
# Arguments: the tree, clang-format.
set -euo pipefail
cd "$1"
mapfile -t files < <(find include src apps evaluation test benchmark \
  -name "*.h" -o -name "*.hpp" -o -name "*.cpp")
echo "${#files[@]} files; to repair: clang-format-14 -i FILE..."
"$2" --dry-run -Werror --style=file "${files[@]}"
