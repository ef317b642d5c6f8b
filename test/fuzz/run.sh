# Runs a fuzzer: first over the whole corpus, then over that many inputs more, which it
# makes of the corpus. Fails on a crash, a finding of a sanitizer, an input that takes 2 min
# or a GB, and leaves the input that did it in the folder it runs in.
# Arguments: the fuzzer, its corpus, options of libFuzzer that bound the run.
set -euo pipefail
fuzzer=$1
corpus=$2
shift 2

# The fuzzer adds the inputs that it finds to a copy.
found=$(mktemp -d)
trap 'rm -rf "$found"' EXIT
export TMPDIR=$found
export ASAN_OPTIONS=quarantine_size_mb=32
mkdir "$found/corpus"
limits=(-timeout=120 -rss_limit_mb=1024 -malloc_limit_mb=256 -max_len=4096)
dictionary=${corpus%/*}/../${corpus##*/}.dict
[[ ! -f $dictionary ]] || limits+=("-dict=$dictionary")
"$fuzzer" "${limits[@]}" -runs=0 "$corpus"
"$fuzzer" "${limits[@]}" -seed=1 -print_final_stats=1 "$@" "$found/corpus" "$corpus"
