# Runs a fuzzer: first over the whole corpus, then over that many inputs more, which it
# makes of the corpus. Fails on a crash, a finding of a sanitizer, an input that takes 2 min,
# 16 MB in one piece or 512 MB in all, and leaves the input that did it in the folder it runs
# in. Prints its seed.
# Arguments: the fuzzer, its corpus, options of libFuzzer that bound the run.
set -euo pipefail
fuzzer=$1
corpus=$2
shift 2

# The fuzzer adds the inputs that it finds to a copy. It writes files for each input: in
# memory, if there is such a folder.
[[ ! -w /dev/shm ]] || export TMPDIR=/dev/shm
found=$(mktemp -d)
trap 'rm -rf "$found"' EXIT
export TMPDIR=$found
export ASAN_OPTIONS=quarantine_size_mb=32
mkdir "$found/corpus"
limits=(-timeout=120 -rss_limit_mb=512 -malloc_limit_mb=16 -max_len=4096)
dictionary=${corpus%/*}/../${corpus##*/}.dict
[[ ! -f $dictionary ]] || limits+=("-dict=$dictionary")
"$fuzzer" "${limits[@]}" -runs=0 "$corpus"
"$fuzzer" "${limits[@]}" -print_final_stats=1 "$@" "$found/corpus" "$corpus"
