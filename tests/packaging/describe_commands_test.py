#!/usr/bin/env python3
"""Man pages and completion say what the program says of itself.

    describe_commands_test.py PROGRAM SOURCE_FOLDER
"""
import os, re, shutil, subprocess, sys, tempfile, unittest

PROGRAM, SOURCE = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])


def help_of(*command):
    return subprocess.run([PROGRAM, *command, "--help"], check=True, capture_output=True, text=True).stdout


class Described(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        script = os.path.join(SOURCE, "packaging", "describe_commands.py")
        subprocess.run([sys.executable, "-B", script, PROGRAM, cls.folder], check=True)
        cls.commands = re.findall(r"^  ([a-z]+) ", help_of().split("Subcommands:")[1].split("Example:")[0], re.M)

    def page(self, name):
        with open(os.path.join(self.folder, name)) as file:
            return file.read()

    def test_each_command_has_a_page_with_its_options_and_examples(self):
        self.assertGreater(len(self.commands), 10)
        for command in self.commands:
            page, told = self.page("cradle-%s.1" % command).replace("\\-", "-"), help_of(command)
            options = re.findall(r"--[a-z][a-z-]*", told.split("Options:")[1].split("Example:")[0])
            for option in options:
                self.assertIn(option, page, command)
            for example in re.findall(r"^  (cradle .*)$", told.split("Example:")[1], re.M):
                self.assertIn(example, page, command)
            self.assertIn(told.splitlines()[0], page)
            for option, kind, default in re.findall(r"(--[a-z-]+) (TEXT|FLOAT|U?INT)(?:=(\S+))?", told):
                self.assertIn("%s\\fR \\fI%s\\fR%s" % (option, kind.lower(), " (default %s)" % default if default else ""), page)
            self.assertIn("cradle-%s" % command, self.page("cradle.1").replace("\\-", "-"))

    def test_pages_are_without_faults(self):
        for name in sorted(os.listdir(self.folder)):
            if not name.endswith(".1"):
                continue
            lines = self.page(name).splitlines()
            self.assertTrue(lines[0].startswith(".TH CRADLE"), name)
            for line in lines:  # a request is one that is known, and no text begins like one
                self.assertTrue(not line.startswith((".", "'")) or re.match(r"^\.(TH|SH|TP|PP|nf|fi)( |$)", line), line)

    def complete(self, *words):
        script = "compopt() { echo files; }; source %s; COMP_WORDS=(%s); COMP_CWORD=%d; _cradle; echo ${COMPREPLY[@]}" % (
            os.path.join(self.folder, "completions", "cradle"), " ".join("'%s'" % word for word in words), len(words) - 1)
        return subprocess.run(["bash", "-c", script], check=True, capture_output=True, text=True).stdout.split()

    def test_completion_knows_commands_and_options(self):
        self.assertEqual(self.complete("cradle", "sim"), ["simulate"])
        self.assertEqual(set(self.complete("cradle", "")) & set(self.commands), set(self.commands))
        self.assertEqual(self.complete("cradle", "simulate", "--str"), ["--strict"])
        self.assertEqual(self.complete("cradle", "-q", "compare", "--jun"), ["--junit"])
        self.assertEqual(self.complete("cradle", "simulate", ""), ["files"])
        self.assertEqual(self.complete("cradle", "simulate", "a.json", "-o", "a"), ["files"])


unittest.main(argv=sys.argv[:1])
