# Fails if doxygen has a warning about the public headers or the pages of docs/, or does
# not write the page of the class. Arguments: doxygen, Doxyfile, folder to write to.
set -euo pipefail
doxygen=$1 settings=$2 output=$3

# run_doxygen <folder> [<further setting> ...]
run_doxygen() {
  rm -rf "$1"
  mkdir -p "$1"
  { cat "$settings" && printf '%s\n' "OUTPUT_DIRECTORY = \"$1\"" \
    'WARN_AS_ERROR = FAIL_ON_WARNINGS' "${@:2}"; } | "$doxygen" -
}

# It has to notice a parameter that is not there, and one that is left out.
mkdir -p "$output"
cat >"$output/wrong.h" <<'CODE'
/** \file */
/** \brief Adds.
 * \param[in] first a number
 * \param[in] third not a parameter */
int add(int first, int second);
CODE
if run_doxygen "$output/wrong" "INPUT = \"$output/wrong.h\"" 2>"$output/wrong.log"; then
  echo "doxygen has not noticed wrong parameters"
  exit 1
fi
grep -F "argument 'third'" "$output/wrong.log"
grep -F "parameter 'second'" "$output/wrong.log"

run_doxygen "$output/right"
ls "$output/right/html/"{index,classpcl_1_1BayesianIterativeClosestPoint}.html
