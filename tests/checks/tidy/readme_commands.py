#!/usr/bin/env python3
"""readme_commands.py TREE BUILD [DOCUMENT...]: what READMEs and the guides of the manual tell to
type works, and prints what they show.

Fails, naming file and line, on

- a command line of a program or script of this tree, in a block or in the text, with a subcommand
  or an option that its --help (a script of tools/: its head; any other: its text) does not name
- a ```console block with output that is another: its commands are run, with the programs of BUILD
  on the PATH and as build/NAME. The blocks of a document share a folder, which has prices.csv.gz,
  those of the benchmark. "..." stands for any part of a line; alone, for any lines. A block without
  output is not run, and no ```sh block
"""

import functools
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time

PROGRAMS = ("bess-train", "bess-edge", "bess-sim", "bess-hil", "bess-page", "bess-notify",
            "bess-prices")
OTHERS = set("apt apt-get cmake ctest install journalctl make man systemctl useradd".split())
OPTION = re.compile(r"--[a-z][\w-]*")
FOREIGN = {"--array-properties", "--collector", "--wrap"}
BEFORE = set("do exec parallel python3 runuser shell: sudo then time with".split())
GUIDES = "shared/manual/guides/*.md"
PRICES = "tests/data/benchmark_minutes_2023.csv.gz"
PATH = os.environ.get("PATH", "")
SHELL = ("", "sh", "bash", "console")


class Readmes:
    def __init__(self, tree, build):
        self.tree, self.build, self.complaints = tree, build, []
        self.place = ""

    def complain(self, what):
        self.complaints.append(f"{self.place}: {what}")

    @functools.cache
    def help(self, *command):
        done = subprocess.run([self.build / command[0], *command[1:], "--help"], text=True,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, timeout=60)
        return done.stdout

    @functools.cache
    def subcommands(self, *command):
        """Of CLI11's lists, one for each group."""
        text = self.help(*command)
        listed = re.findall(r"^[\w -]*commands:\s*\n((?:  .*\n)+)", text, re.M | re.I)
        return set(re.findall(r"^  ([a-z][a-z-]*)", "".join(listed), re.M))

    @functools.cache
    def script_text(self, script):
        """Options in the head of a script, and the programs that it passes options to."""
        text = (self.tree / script).read_text(encoding="utf-8")
        if script.startswith("tools/") and "python" not in text.partition("\n")[0]:
            text = re.match(r"(?:#.*\n)*", text)[0]
        if script == "tools/hil":
            text += self.help("bess-hil", "run")
        if script == "tools/flash":
            parts = (self.tree / "tools/delivery/flashing").glob("[a-z]*")
            text += "".join(p.read_text(encoding="utf-8") for p in parts if p.is_file())
        return text

    @functools.cache
    def all_text(self):
        """Of every option of this tree."""
        commands = [(program,) for program in PROGRAMS]
        for command in commands:
            commands += [command + (name,) for name in self.subcommands(*command)]
        texts = [self.help(*command) for command in commands]
        scripts = [p for top in ("tools", "tests") for p in (self.tree / top).rglob("*")]
        return "\n".join(texts + [p.read_text(encoding="utf-8") for p in scripts if is_script(p)])

    def options_known(self, arguments, text, whose):
        for argument in arguments:
            if argument in OTHERS or argument == "--":
                return
            option = OPTION.match(argument)
            if option and option[0] not in FOREIGN and not re.search(
                    r"(?<![\w-])%s(?![\w-])" % option[0], text):
                self.complain(f"{whose} has no {option[0]}")

    def check_program(self, name, arguments):
        command = (name,)
        for number, argument in enumerate(arguments):
            known = self.subcommands(*command)
            if argument in known:
                command += (argument,)
            elif known and number == len(command) - 1 and re.fullmatch(r"[a-z][a-z-]+", argument):
                self.complain(f"{' '.join(command)} has no {argument}")
                return
        self.options_known(arguments, self.help(*command), " ".join(command))

    def check_command(self, words):
        words = [re.sub(r"^(?:\./)?build[\w-]*/(?=bess-)", "", word) for word in words]
        for number, word in enumerate(words):
            if word in OTHERS:
                return
            if "/" in word and is_script(self.tree / word):
                self.options_known(words[number + 1:], self.script_text(word), word)
                return
            program = re.sub(r"-outlook$", "", word)
            is_first = number == 0 or words[0] in BEFORE or "=" in words[0]
            if program in PROGRAMS and program not in words[number + 1:] and is_first:
                self.check_program(program, words[number + 1:])
                return

    def check_line(self, line):
        for words in commands_of(line):
            self.check_command(words)

    def check_inline(self, code):
        """Also a command without its program: `run --resume`."""
        words = re.sub(r"[][…,|]|\\", " ", code).split()
        if not words:
            return
        if OPTION.match(words[0]):
            self.options_known(words, self.all_text(), "this tree")
            return
        of = [p for p in PROGRAMS if words[0] in self.subcommands(p)]
        if not of or not OPTION.search(code):
            self.check_line(code)
            return
        said = len(self.complaints)
        folder = self.tree / pathlib.Path(self.place).parent
        if any(words[0] in p.read_text() for p in folder.glob("*.py")):  # a script's own
            of = []
            self.options_known(words, "".join(p.read_text() for p in folder.glob("*.py")), "it")
        for program in of:
            del self.complaints[said:]
            self.check_program(program, words)
            if len(self.complaints) == said:
                return

    def furnish(self, folder):
        """What the commands of a document find where they run."""
        for place in ("edge", "tests", "workstation"):
            os.symlink(self.tree / place, f"{folder}/{place}")
        os.symlink(self.build, f"{folder}/build")
        if (self.tree / PRICES).exists():
            shutil.copyfile(self.tree / PRICES, f"{folder}/prices.csv.gz")

    def run_block(self, script, shown, folder):
        shown = [" ".join(line.split()) for line in shown]
        pattern = "".join(r"(?:[^\n]*\n)*" if line == "..." else
                          re.escape(line).replace(re.escape("..."), r"[^\n]*") + "\n"
                          for line in shown)
        with open(f"{folder}/.printed", "w+", encoding="utf-8") as out:
            run = subprocess.Popen(["bash", "-c", script], cwd=folder, stdout=out, stderr=out,
                                   stdin=subprocess.DEVNULL, start_new_session=True,
                                   env=os.environ | {"PATH": f"{self.build}:{PATH}"})
            try:
                run.wait(60)
            except subprocess.TimeoutExpired:
                out.write("(not done within 60 s)\n")
            out.seek(0)
            printed = out.read()
        end_group(run)
        printed = "".join(" ".join(line.split()) + "\n" for line in printed.splitlines())
        if not re.fullmatch(pattern, printed):
            self.complain(f"shows\n{chr(10).join(shown)}\nand what is printed is\n{printed}")

    def check(self, name):
        with tempfile.TemporaryDirectory() as folder:
            self.furnish(folder)
            self.check_in(name, folder)

    def check_in(self, name, folder):
        text = (self.tree / name).read_text(encoding="utf-8")
        for number, kind, lines in parts_of(text.splitlines()):
            self.place = f"{name}:{number}"
            if kind == "text":
                for code in re.findall(r"`([^`]+)`", " ".join(lines)):
                    self.check_inline(code)
                continue
            typed, shown = (lines, []) if kind != "console" else typed_and_shown(lines)
            typed = re.sub(r"\\\n\s*", " ", "\n".join(typed))
            for line in typed.splitlines():
                self.check_line(line)
            if shown:
                self.run_block(typed, shown, folder)


def is_script(path):
    return path.is_file() and (path.suffix in (".py", ".sh") or path.read_bytes()[:2] == b"#!")


def end_group(run):
    """Ends background processes of the block."""
    for number in [signal.SIGTERM] + [0] * 100 + [signal.SIGKILL]:
        try:
            os.killpg(run.pid, number)
        except ProcessLookupError:
            return
        time.sleep(0.1)
        run.poll()


def typed_and_shown(lines):
    """Commands of a block with "$ " and "> ", or of commands only."""
    typed, shown = [], []
    for line in lines:
        if line.startswith(("$ ", "> ")):
            typed.append(line[2:])
        elif typed and typed[-1].endswith("\\") and not shown:
            typed.append(line)
        else:
            shown.append(line)
    return (typed, shown) if typed else (lines, [])


def commands_of(line):
    """Words of each command on a shell line."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars="();<>|&")
    lexer.whitespace_split = True
    try:
        words = list(lexer)
    except ValueError:  # a quotation that continues on the next line
        words = line.replace("'", " ").replace('"', " ").split()
    command = []
    for word in words + [";"]:
        if re.fullmatch(r"[();<>|&]+", word):
            yield command
            command = []
        else:
            command.append(word)


def parts_of(lines):
    """Number of the first line, kind and lines of each paragraph of text and each block."""
    kind, part, first, indent = "text", [], 1, 0
    for number, line in enumerate(lines + [""], 1):
        fence = re.match(r" *```(\w*)", line)
        if kind.startswith("in ") and not fence:
            part.append(line[indent:] if not line[:indent].strip() else line)
            continue
        if fence and kind.startswith("in "):
            if kind[3:] in SHELL:
                yield first, kind[3:] or "sh", part
            kind, part = "text", []
            continue
        now = "in " + fence[1] if fence else "indented" if line.startswith("    ") else "text"
        if part and (now != kind or not line.strip()):
            yield first, kind, part
            part = []
        kind = now
        if line.strip() and not fence:
            first = number if not part else first
            part.append(line)
        elif fence:
            first, indent = number, line.index("`")


def main():
    if len(sys.argv) < 3:
        print(__doc__, file=sys.stderr)
        return 2
    tree, build = (pathlib.Path(argument).resolve() for argument in sys.argv[1:3])
    missing = [program for program in PROGRAMS if not os.access(build / program, os.X_OK)]
    if missing or not (tree / ".git").exists():
        needed = ", ".join(missing) or "a clone, whose files git can list"
        print(f"needs {needed}")
        return 77
    listed = subprocess.run(["git", "-C", tree, "ls-files", "*README.md", GUIDES],
                            capture_output=True, text=True, check=True).stdout
    readmes = Readmes(tree, build)
    for name in sys.argv[3:] or listed.splitlines():
        readmes.check(name)
    print("\n".join(readmes.complaints) or "documents and programs agree")
    return 1 if readmes.complaints else 0


if __name__ == "__main__":
    sys.exit(main())
