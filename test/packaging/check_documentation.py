"""Fails unless every installed program has a man page and a completion that offer all
options and commands of its --help. Arguments: prefix, "man" if there are man pages."""

import functools
import pathlib
import re
import shlex
import subprocess
import sys

# Calls the completion as bash does: for each word to complete on standard input, after the
# words given as arguments. Writes a line for each. The first argument is a function that
# answers for the program.
COMPLETE = """
eval "$1"
source "$2" && shift 2
function=$(complete -p "$1" | grep -oE -- '-F [^ ]+' | cut -c4-)
while read -r word; do
  COMP_WORDS=("$@" "$word") COMP_CWORD=$#
  COMP_LINE="${COMP_WORDS[*]}" COMP_POINT=${#COMP_LINE}
  "$function" "$1" "$word" "${COMP_WORDS[COMP_CWORD - 1]}"
  echo "${COMPREPLY[*]}"
done
"""


def options_of(text):
    """Options in the left column of the tables of a help text."""
    options = set()
    for line in text.splitlines():
        if line.startswith("  -"):
            left = re.split(r"\s{2,}", line.strip())[0]
            options.update(re.findall(r"(?:^|\[ )(-[-\w]+)", left))
    return options


def commands_of(text):
    """First words of the lines below "Commands:"."""
    table = re.search(r"^Commands:\n((?:  .*\n)+)", text, re.MULTILINE)
    return [line.split()[0] for line in table.group(1).splitlines()] if table else []


@functools.lru_cache(maxsize=None)
def help_of(*words):
    return subprocess.run(
        [*words, "--help"], check=True, capture_output=True, text=True
    ).stdout


def stand_in(program):
    """A function of bash, of the name of a program, that answers each --help as the program
    does. A completion asks for it, and loading the program's libraries takes time."""
    answers = ""
    for words in [[], *([command] for command in commands_of(help_of(program)))]:
        text = shlex.quote(help_of(program, *words))
        answers += f"'{' '.join([*words, '--help'])}') printf %s {text} ;;\n"
    return f'{program.name}() {{ case "$*" in\n{answers}esac; }}'


def completions(script, words, beginnings):
    """What is offered after some words for each beginning of the next one."""
    program, *others = words
    run = subprocess.run(
        ["bash", "-c", COMPLETE, "bash", stand_in(program), script, program.name, *others],
        check=True,
        capture_output=True,
        input="".join(f"{beginning}\n" for beginning in beginnings),
        text=True,
    )
    offered = [set(line.split()) for line in run.stdout.splitlines()]
    if len(offered) != len(beginnings):
        sys.exit(f"{words}: {len(offered)} answers of the completion, {run.stderr}")
    return offered


def check_options(prefix, words, has_man):
    """Completion and man page of a program, or of a command of a program."""
    name = pathlib.Path(words[0]).name
    script = prefix / "share/bash-completion/completions" / name
    expected = options_of(help_of(*words))
    beginnings = ["-", *(option[:-1] for option in expected)]
    all_offered, *offered = completions(script, words, beginnings)
    if all_offered != expected:
        sys.exit(f"{words}: completion differs from --help in {all_offered ^ expected}")
    for option, of_option in zip(expected, offered):
        if option not in of_option:
            sys.exit(f"{words}: {option[:-1]} is not completed to {option}")
    if has_man:
        page = prefix / "share/man/man1" / ("-".join([name, *words[1:]]) + ".1")
        if not page.exists():
            sys.exit(f"no {page}: is its line in cmake/documentation.cmake missing?")
        text = page.read_text().replace("\\-", "-").replace("\\fR", "")
        missing = [option for option in expected if option not in text]
        if missing:
            sys.exit(f"{page}: without {missing}")
    return len(expected)


def check_program(prefix, program, has_man):
    commands = commands_of(help_of(program))
    script = prefix / "share/bash-completion/completions" / program.name
    if completions(script, [program], [""]) != [set(commands)]:
        sys.exit(f"{program.name}: commands are not completed to {commands}")
    num_options = check_options(prefix, [program], has_man)
    num_options += sum(check_options(prefix, [program, c], has_man) for c in commands)
    if num_options == 0:
        sys.exit(f"{program.name}: --help lists no option")
    print(f"{program.name}: {num_options} options, {len(commands)} commands")


def main():
    prefix = pathlib.Path(sys.argv[1])
    has_man = "man" in sys.argv[2:]
    programs = sorted((prefix / "bin").glob("pcl_bayesian_icp*"))
    if not programs:
        sys.exit(f"no programs in {prefix}/bin")
    for program in programs:
        check_program(prefix, program, has_man)


main()
