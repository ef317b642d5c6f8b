"""Fails unless every installed program has a man page and a completion that offer all
options and commands of its --help. Arguments: prefix, "man" if there are man pages."""

import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

# Calls the completion as bash does, for the words given as arguments.
COMPLETE = """
source "$1" && shift
COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMP_LINE="$*" COMP_POINT=${#COMP_LINE}
function=$(complete -p "${1##*/}" | grep -oE -- '-F [^ ]+' | cut -c4-)
"$function" "$1" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
printf '%s\\n' "${COMPREPLY[@]}"
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


def help_of(words):
    return subprocess.run(
        [*words, "--help"], check=True, capture_output=True, text=True
    ).stdout


def stand_in(program, folder):
    """A script in a folder, of the name of a program, that answers each --help as the
    program does. A completion asks for it, and loading the program's libraries takes time."""
    commands = commands_of(help_of([program]))
    answers = ""
    for words in [[], *([command] for command in commands)]:
        text = shlex.quote(help_of([program, *words]))
        answers += f"'{' '.join([*words, '--help'])}') printf %s {text} ;;\n"
    script = pathlib.Path(folder) / program.name
    script.write_text(f'#!/bin/sh\ncase "$*" in\n{answers}esac\n')
    script.chmod(0o755)
    return script


def completions(script, words):
    run = subprocess.run(
        ["bash", "-c", COMPLETE, "bash", script, *words],
        check=True,
        capture_output=True,
        text=True,
    )
    return set(run.stdout.split())


def check_options(prefix, words, has_man):
    """Completion and man page of a program, or of a command of a program."""
    name = pathlib.Path(words[0]).name
    script = prefix / "share/bash-completion/completions" / name
    expected = options_of(help_of(words))
    offered = completions(script, [*words, "-"])
    if offered != expected:
        sys.exit(f"{words}: completion differs from --help in {offered ^ expected}")
    for option in expected:
        if option not in completions(script, [*words, option[:-1]]):
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
    commands = commands_of(help_of([program]))
    script = prefix / "share/bash-completion/completions" / program.name
    if completions(script, [program, ""]) != set(commands):
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
    with tempfile.TemporaryDirectory() as folder:
        for program in programs:
            check_program(prefix, stand_in(program, folder), has_man)


main()
