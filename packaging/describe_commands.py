#!/usr/bin/env python3
"""Man pages and completion for bash, from what the program says of itself.

    describe_commands.py PROGRAM FOLDER

writes FOLDER/cradle.1, FOLDER/cradle-COMMAND.1 of each command, and FOLDER/completions/cradle.
"""
import os, re, subprocess, sys

ENTRY = re.compile(r"^  (?! )(\S.*?)(?:  +(\S.*))?$")
FILES = {"-o", "--output", "--report", "--junit", "--with", "--shaders", "--asset-root"}  # what names a file or a folder


class Help:
    """The help of a command, taken apart: sections of entries (words, what they mean)."""

    def __init__(self, program, *command):
        text = subprocess.run([program, *command, "--help"], check=True, capture_output=True, text=True).stdout
        self.name = " ".join(("cradle", *command))
        lines = text.splitlines()
        self.about = lines[0].strip()
        self.usage = re.sub(r"^Usage: ", "", lines[1].strip())
        self.sections, self.footer = {}, []
        entries = None
        for line in lines[2:]:
            if re.match(r"^(Positionals|Options|Subcommands):$", line):
                entries = self.sections.setdefault(line[:-1], [])
            elif line == "Example:":
                entries, self.footer = None, [line]
            elif entries is None:
                if line:
                    self.footer.append(line)
            elif line.startswith("   "):  # goes on with what an entry means
                entries[-1][1] = (entries[-1][1] + " " + line.strip()).strip()
            elif line:
                words, meaning = ENTRY.match(line).groups()
                entries.append([words, meaning or ""])

    def of(self, section):
        return self.sections.get(section, [])

    def examples(self):
        return [line.strip() for line in self.footer[1:] if line.startswith("  ")]

    def remarks(self):
        return [line for line in self.footer[1:] if not line.startswith("  ")]

    def option_names(self):
        """All spellings of the options."""
        return [name for words, _ in self.of("Options") for name in words.split()[0].split(",")]


def roff(text):
    """Plain text as roff has it."""
    return re.sub(r"^([.'])", r"\\&\1", text.replace("\\", "\\e").replace("-", "\\-"))


def option_in_roff(words):
    """-o,--output TEXT REQUIRED -> names in bold, what follows in italics."""
    names, *rest = words.split()
    line = ", ".join("\\fB%s\\fR" % roff(name) for name in names.split(","))
    kind, _, default = rest[0].partition("=") if rest else ("", "", "")
    if kind in ("TEXT", "FLOAT", "INT", "UINT"):
        line += " \\fI%s\\fR" % kind.lower()
    if default:
        line += " (default %s)" % roff(default)
    if "REQUIRED" in rest:
        line += " (required)"
    return line


def man_page(help, version, subcommands=()):
    title = help.name.replace(" ", "-")
    lines = ['.TH %s 1 "" "%s" "User Commands"' % (title.upper(), version), ".SH NAME",
             "%s \\- %s" % (roff(title), roff(help.about.removeprefix("Cradle: "))), ".SH SYNOPSIS", "\\fB%s\\fR" % roff(help.name)]
    if subcommands:
        lines += ["\\fICOMMAND\\fR [OPTIONS]"]
    else:
        lines += [roff(help.usage.removeprefix(help.name).strip())]
    for section, title in (("Positionals", "ARGUMENTS"), ("Options", "OPTIONS")):
        if help.of(section):
            lines.append(".SH " + title)
        for words, meaning in help.of(section):
            lines += [".TP", option_in_roff(words), roff(meaning)]
    if subcommands:
        lines.append(".SH COMMANDS")
        for name, meaning in help.of("Subcommands"):
            lines += [".TP", "\\fB%s\\fR" % roff(name), roff(meaning) + "; see \\fBcradle\\-%s\\fR(1)" % name]
    if help.examples():
        lines += [".SH EXAMPLES", ".nf"] + [roff(example) for example in help.examples()] + [".fi"]
    for remark in help.remarks():
        lines += [".PP", roff(remark)]
    others = ["cradle-" + name for name in subcommands] or ["cradle"]
    lines += [".SH SEE ALSO", ", ".join("\\fB%s\\fR(1)" % roff(name) for name in others)]
    return "\n".join(lines) + "\n"


def completion(main, commands):
    """Commands and options; where an option names a file, and elsewhere, files."""
    cases = "\n".join("    %s) options='%s' ;;" % (name, " ".join(sorted(help.option_names() + main.option_names()[:2])))
                      for name, help in commands.items())
    return """# Completion of cradle for bash.
_cradle() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command= options i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    [[ ${COMP_WORDS[i]} != -* && ${COMP_WORDS[i]} != help ]] && { command=${COMP_WORDS[i]}; break; }
  done
  case $command in
%s
    *) options='%s' ;;
  esac
  if [[ " %s " == *" $before "* || ( -n $command && $word != -* ) ]]; then
    compopt -o default
    COMPREPLY=()
  else
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  fi
}
complete -F _cradle cradle
""" % (cases, " ".join([*commands, "help", *main.option_names()]), " ".join(sorted(FILES)))


def write(folder, name, text):
    with open(os.path.join(folder, name), "w") as file:
        file.write(text)


def main():
    program, folder = os.path.abspath(sys.argv[1]), sys.argv[2]
    version = subprocess.run([program, "--version"], check=True, capture_output=True, text=True).stdout.strip()
    whole = Help(program)
    commands = {name: Help(program, name) for name, _ in whole.of("Subcommands")}
    os.makedirs(os.path.join(folder, "completions"), exist_ok=True)
    write(folder, "cradle.1", man_page(whole, version, list(commands)))
    for name, help in commands.items():
        write(folder, "cradle-%s.1" % name, man_page(help, version))
    write(folder, os.path.join("completions", "cradle"), completion(whole, commands))


main()
