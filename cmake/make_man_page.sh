# Makes a man page from the help text of a program in the current folder. Arguments:
# help2man, page to write, version, description, program, its command if there is one.
set -euo pipefail
help2man=$1 page=$2 version=$3 description=$4
shift 4
export LC_ALL=C

"$help2man" --no-info --version-string="$version" --name="$description" \
  --output="$page.part" "./$*"
# A page has one name, a word: the dash is between program and command.
words=$*
name=${words// /-}
sed -i -e "s/^\.TH .* \"1\"/.TH ${name^^} \"1\"/" -e "s/^$words \\\\- /${name//-/\\\\-} \\\\- /" \
  "$page.part"
# help2man fills examples as if they were prose, so they are taken as they are, from their
# heading to the end of the help text.
examples=$("./$@" --help | sed -n '/^Examples\{0,1\}:$/,$p' | sed 1d)
if [[ -n $examples ]]; then
  sed -i '/^\.SS "Examples\{0,1\}:"$/,$d' "$page.part"
  printf '.SH EXAMPLES\n.nf\n%s\n.fi\n' "$(sed 's/\\/\\e/g; s/-/\\-/g' <<<"$examples")" \
    >>"$page.part"
fi
mv "$page.part" "$page"
