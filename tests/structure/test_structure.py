#!/usr/bin/env python3
"""The checks of this folder see what they are for: small trees with one fault each."""
import argparse
import contextlib
import io
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest
from unittest import mock

import claims
import output
import rooms
import sizes
import statements
import tidy

TABLE = """
`base` stands for `core/a`.

| room | what it holds | may include |
|---|---|---|
| `core/util` | helpers; every room may include it | |
| `core/a` | numbers | |
| `core/b` | more | `base` |
| `lab/{x,y}` | pages | `core/*` |
| `procs/p` | the step | `core/{a,b}` |
| `procs/p/{role,main}` | its role | `lab/x` |
"""
TREE = {
    "core/util/u.h": "",
    "core/a/a.h": '#include "core/util/u.h"\n',
    "core/b/b.h": '#include <a/a.h>\n#include "../a/a.h"\n#include <vector>\n',
    "core/b/b.cc": '#include "core/b/b.h"\n',
    "lab/x/x.cc": '#include "core/b/b.h"\n',
    "lab/x/x.h": "",
    "lab/y/y.cc": '  #  include "core/a/a.h"\n',
    "procs/p/step.cc": '#include "core/b/b.h"\n',
    "procs/p/role.cc": '#include "lab/x/x.h"\n',
    "procs/p/main.cc": "",
}


class Rooms(unittest.TestCase):
    def faults(self, table=TABLE, **changed):
        with tempfile.TemporaryDirectory() as root:
            for file, text in {**TREE, **{name.replace("__", "."): text for name, text in changed.items()}}.items():
                os.makedirs(os.path.join(root, os.path.dirname(file)), exist_ok=True)
                with open(os.path.join(root, file), "w", encoding="utf-8") as f:
                    f.write(text)
            return rooms.faults(root, table)

    def test_what_the_table_lists_is_allowed(self):
        self.assertEqual(self.faults(), [])

    def test_an_arrow_that_is_not_listed(self):
        found = self.faults(**{"procs/p/step.cc": '#include "lab/x/x.h"\n'})
        self.assertEqual(found, ["procs/p/step.cc includes lab/x/x.h: the table does not allow procs/p -> lab/x"])

    def test_relative_includes_and_short_ones_count(self):
        found = self.faults(**{"core/a/a.h": '#include "../b/b.h"\n'})
        self.assertIn("core/a/a.h includes core/b/b.h: the table does not allow core/a -> core/b", found)
        self.assertIn("a cycle of rooms: core/a, core/b", found)
        self.assertTrue(any("core/a -> core/b" in f for f in self.faults(**{"core/a/a.h": "#include <b/b.h>\n"})))

    def test_messages_are_a_room(self):
        found = self.faults(**{"core/a/a.h": '#include "lab/run_t.hpp"\n'})
        self.assertEqual(found, ["core/a/a.h includes lcmtypes/run_t.hpp: the table does not allow core/a -> lcmtypes"])

    def test_a_cycle_that_the_table_allows_is_a_fault(self):
        found = self.faults(TABLE.replace("| numbers | |", "| numbers | `core/b` |"), **{"core/a/a.h": '#include "core/b/b.h"\n'})
        self.assertIn("a cycle of rooms: core/a, core/b", found)

    def test_rooms_and_rows_belong_together(self):
        self.assertEqual(self.faults(**{"lab/z/z.h": ""}), ["lab/z is a room, but has no row in the table"])
        self.assertEqual(self.faults(TABLE + "| `lab/gone` | nothing | |\n"),
                         ["the table has a row for lab/gone, which is no room and no file"])
        self.assertEqual(self.faults("no table"), ["docs/architecture.md has no table of rooms"])


class Functions(unittest.TestCase):
    def functions(self, text):
        return [(first, last, name) for first, last, name in sizes.functions(text)]

    def test_functions_of_all_shapes(self):
        text = """#define MACRO(x) { x
namespace lab {
struct A {
  A() : a_{1}, b_(2) {
    if (a_) { b_ = 1; }
  }
  int get() const { return a_; }
  int a_ = 0, b_{3};
};
// void comment() {
template <typename T, std::enable_if_t<(sizeof(T) == 2), int> = 0>
std::vector<int> make(const char* text = "){",
                      char c = '{') {
  auto f = [&] { return R"(})"; };
  return {1, 2};
}
const int table[] = {1, 2};
std::map<int, int> m{{1, f(2)}};
bool operator<(const A& a, const A& b) { return a.get() < b.get(); }
}
"""
        self.assertEqual(self.functions(text), [(4, 6, "A"), (7, 7, "get"), (11, 16, "make"), (19, 19, "operator<")])

    def test_plain_keeps_the_lines(self):
        text = '/* a\nb */ int x; // y\nconst char* s = R"x(\n{\n)x";\n'
        self.assertEqual(sizes.plain(text).count("\n"), text.count("\n"))
        self.assertNotIn("{", sizes.plain(text))


MOVED = """#include <utility>
#include "wire/a/a.h"
namespace { int own = 0; }
A take(A in) {
  A out = std::move(in);
  if (in.x.size() > 1) own = 1;
  return out;
}
"""


@unittest.skipUnless(shutil.which("clang-tidy-19"), "no clang-tidy-19")
class Tidy(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = folder.name
        environment = mock.patch.dict(os.environ, XDG_CACHE_HOME=os.path.join(self.root, "cache"))
        environment.start()
        self.addCleanup(environment.stop)
        self.write(".clang-tidy", "Checks: '-*,bugprone-use-after-move,clang-diagnostic-comma'\nHeaderFilterRegex: '/wire/'\n")
        self.write("wire/a/a.h", "#pragma once\n#include <string>\nstruct A { std::string x; };\n")
        self.write("wire/a/good.cc", '#include "wire/a/a.h"\nnamespace { int own = 0; }\nint good() { return own; }\n')
        self.write("wire/a/far.cc", "int far() { return 1; }\n")
        commands = [{"file": os.path.join(self.root, f"wire/a/{name}.cc"), "directory": self.root,
                     "command": f"c++ -I{self.root} -std=c++20 -o x.o -c wire/a/{name}.cc"} for name in ("good", "far", "moved")]
        self.write("wire/a/moved.cc", "")
        self.write("build/compile_commands.json", json.dumps(commands))

    def write(self, file, text):
        path = os.path.join(self.root, file)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as f:
            f.write(text)

    def check(self, **options):
        options = {"build": os.path.join(self.root, "build"), "files": [], "full": False, "seconds": 100, "jobs": 1, **options}
        with contextlib.redirect_stdout(io.StringIO()) as out:
            code = tidy.check(argparse.Namespace(**options), self.root, shutil.which("clang-tidy-19"))
        return code, out.getvalue().splitlines()

    def test_findings_in_their_file_and_line_and_clean_files_are_remembered(self):
        # both files have a variable of the same name: together they do not compile, so each is checked alone
        self.write("wire/a/moved.cc", MOVED)
        code, out = self.check()
        self.assertEqual(code, 1)
        self.assertEqual(out[:-1], ["wire/a/moved.cc:6:7: 'in' used after it was moved [bugprone-use-after-move]"])
        code, out = self.check()
        self.assertEqual((code, out[-1].split(",")[0]), (1, "tidy: 2 files were clean already"))
        self.write("wire/a/moved.cc", MOVED.replace("in.x", "out.x"))
        self.assertEqual(self.check()[0], 0)
        code, out = self.check()
        self.assertEqual((code, out[-1].split(",")[0]), (0, "tidy: 3 files were clean already"))

    def test_the_others_of_a_text_that_does_not_compile_are_checked_again(self):
        # the analyzer does not run over a text with an error: what was left of it would have passed for clean
        self.write(".clang-tidy", "Checks: '-*,clang-analyzer-core.*'\n")
        self.write("wire/a/good.cc", "namespace { int own = 0; }\n"
                                     "int good(int* at) { if (!at) own = 1; return own + *at; }\n")
        self.write("wire/a/moved.cc", "namespace { int own = 0; }\nint moved() { return own; }\n")
        code, out = self.check()
        self.assertEqual((code, len(out), out[0].split(": ")[0]), (1, 2, "wire/a/good.cc:2:52"))

    def test_a_changed_header_or_rule_counts(self):
        self.assertEqual(self.check()[0], 0)
        self.write("wire/a/a.h", "#pragma once\n#include <string>\nstruct A { std::string x; };\n"
                                 "inline int both(int& a, int& b) { a = 1, b = 2; return a; }\n")
        code, out = self.check()
        self.assertEqual((code, out[0].split(": ")[0]), (1, "wire/a/a.h:4:40"))
        self.assertIn("tidy: 2 files were clean already, 1 checked", out[-1])
        self.write(".clang-tidy", "Checks: '-*,bugprone-use-after-move'\n")
        self.assertIn("tidy: 0 files were clean already, 3 checked", self.check()[1][-1])

    def test_the_files_of_a_unity_file_are_checked_with_its_flags(self):
        unity = "build/a/Unity/unity_0_cxx.cxx"
        self.write(unity, "".join(f'#include "{self.root}/wire/a/{name}.cc"\n\n' for name in ("far", "moved")))
        self.write("build/compile_commands.json", json.dumps([{"file": os.path.join(self.root, unity), "directory": self.root,
                                                               "command": f"c++ -I{self.root} -std=c++20 -o x.o -c {unity}"}]))
        self.write("wire/a/moved.cc", MOVED)
        code, out = self.check()
        self.assertEqual((code, out[0].split(": ")[0]), (1, "wire/a/moved.cc:6:7"))
        self.assertIn("2 checked", out[-1])

    def test_what_does_not_fit_into_the_time_is_left(self):
        code, out = self.check(seconds=0)
        self.assertEqual(code, 0)
        self.assertIn("0 checked in 0 s, 0 findings; 3 files are left for the next run", out[-1])
        self.assertIn("3 checked", self.check(seconds=0, full=True)[1][-1])


class Output(unittest.TestCase):
    GOOD = {
        "core/util/console.cc": "void f() { fwrite(p, 1, n, stdout); }\n",
        "lab/a/a.cc": 'void f() { emit("{}\\n", "std::cout"); }  // not fmt::print\n',
        "procs/p/main.cc": 'int main(int argc, char** argv) {\n  return lab::run_program("p", run);\n}\n',
        "examples/e.cc": "int main() {\n  std::cout << 1;\n  return roads.exit_code();\n}\n",
        "scripts/lib.sh": "trap 'cleanup' EXIT\n",
        "scripts/lab-a": '. "$(dirname "$0")/lib.sh"\n# not $SECONDS\nexpires_in 3\n',
        "scripts/lab-b": "import lib\nlib.run(main)\n",
    }

    def faults(self, **changed):
        with tempfile.TemporaryDirectory() as root:
            for file, text in {**self.GOOD, **changed}.items():
                os.makedirs(os.path.join(root, os.path.dirname(file)), exist_ok=True)
                with open(os.path.join(root, file), "w", encoding="utf-8") as f:
                    f.write(text)
            return output.faults(root)

    def test_one_way_to_write(self):
        self.assertEqual(self.faults(), [])
        for text in ('std::cout << 1;', 'fmt::print("x");', 'fmt::print(stderr, "x");', 'std::fputs("x", f);', "perror(p);"):
            found = self.faults(**{"lab/a/a.cc": f"void f() {{ {text} }}\n"})
            self.assertEqual(len(found), 1, (text, found))
            self.assertIn("lab/a/a.cc:1:", found[0])

    def test_every_main_has_the_frame(self):
        self.assertEqual(self.faults(**{"procs/p/main.cc": "int main() { return 0; }\n"}),
                         ["procs/p/main.cc: main does not run inside run_program (core/util/console.h)"])
        self.assertEqual(len(self.faults(**{"examples/e.cc": "int main() { return 0; }\n"})), 1)

    def test_every_verb_has_the_library(self):
        self.assertEqual(self.faults(**{"scripts/lab-c": "echo\n"}), ["scripts/lab-c: neither lib.sh nor lib.py"])

    def test_one_exit_trap_and_no_wall_clock(self):
        library = self.GOOD["scripts/lab-a"]
        for line in ("trap 'rm x' EXIT", "end=$((SECONDS + 3))", "[ $SECONDS -lt 3 ]", "a=${EPOCHREALTIME//[!0-9]/}", "t = time.time()"):
            found = self.faults(**{"scripts/lab-a": library + line + "\n"})
            self.assertEqual(len(found), 1, (line, found))
            self.assertIn("scripts/lab-a:4:", found[0])


class Claims(unittest.TestCase):
    FILES = {
        "README.md": "`scripts/lab run x --solo` with `lab-solo`, `LAB_RUNS`, `simulator.dt`, `controller.kp`; EVENT `push`; fifteen example programs\n",
        "CHANGELOG.md": "", "CONTRIBUTING.md": "", "CMakeLists.txt": "",
        "scripts/lab-run": "# --solo\nLAB_RUNS", "procs/solo/CMakeLists.txt": "add_executable(lab-solo main.cc)", "lab/a.cc": '"push"',
        "lab/experiment/keys.h": '"simulator.dt"', "lab/experiment/gains.h": '"kp"', "scripts/lab-render": "", "scripts/lab-bench": "",
        **{f"examples/{n}.cc": "" for n in range(15)},
    }

    def findings(self, page):
        with tempfile.TemporaryDirectory() as root:
            for name, text in {**self.FILES, "docs/page.md": page}.items():
                path = pathlib.Path(root, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            return list(claims.findings(pathlib.Path(root)))

    def test_what_is_there_may_be_named(self):
        self.assertEqual(self.findings(""), [])

    def test_what_is_not_there_may_not(self):
        for page, said in (("`scripts/lab fly`", "no verb 'fly'"), ("```\nscripts/lab run x --fast\n```", "run does not know --fast"),
                           ("`lab-fly`", "no program lab-fly"), ("`LAB_WINGS=2`", "nothing reads LAB_WINGS"),
                           ("`simulator.wind`", "no key simulator.wind"), ("`controller.ki`", "no key controller.ki"),
                           ("EVENT `fly`", "no EVENT 'fly'"), ("14 example programs", "examples/[0-9]*.cc are 15")):
            found = self.findings(page)
            self.assertEqual(len(found), 1, (page, found))
            self.assertIn(said, found[0])


class Statements(unittest.TestCase):
    SAFETY = """# Safety

It is **safe**. The [page](x.md) says so:
`always`.

- **One.** Of two. In 20 ms, e.g. of 3
  lines (yes.) Two.
2. Item, since 1. January.

| head | of a table |
|---|---|
| row | `r` |

```
[*] --> Waiting
no sentence
```
"""
    SENTENCES = ["It is safe.", "The page says so: always.", "One. Of two.", "In 20 ms, e.g. of 3 lines (yes.)", "Two.", "Item, since 1.", "January.",
                 "row | r", "[*] --> Waiting"]
    TESTS = {"tests/a/a_test.cc": "TEST_F(A, Holds) {", "tests/b.py": "    def test_b(self):", "tests/c.bats": '@test "c: (d)" {'}

    def test_what_a_sentence_is(self):
        self.assertEqual(statements.sentences(self.SAFETY), self.SENTENCES)

    def findings(self, *rows):
        rows = rows or [f"docs/safety.md\t{sentence[:10]}\ta_test.cc::A.Holds\tb.py::test_b" for sentence in self.SENTENCES]
        with tempfile.TemporaryDirectory() as root:
            for name, text in {**self.TESTS, "docs/safety.md": self.SAFETY, "docs/architecture.md": "No statement.\n\n## Two clocks\n\nTick.\n",
                               statements.TABLE: "\n".join([*rows, "docs/architecture.md\tTick\tc.bats::c: (d)"])}.items():
                path = pathlib.Path(root, name)
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text)
            return list(statements.findings(pathlib.Path(root)))

    def test_one_row_for_each(self):
        good = [f"docs/safety.md\t{sentence[:10]}\t-\twhy" for sentence in self.SENTENCES]
        self.assertEqual(self.findings(), [])
        self.assertEqual(self.findings(*good), [])
        for rows, said in ((good[1:], "no row of tests/structure/statements.tsv for 'It is safe.'"), ([*good, "docs/safety.md\tGone\t-\twhy"], "0 sentences"),
                           ([*good, "docs/safety.md\tI\t-\twhy"], "3 sentences"), ([*good, "docs/safety.md\tIt is\t-"], "name the tests"),
                           ([*good, "docs/safety.md\tIt is\ta_test.cc::A.Hold"], "no test a_test.cc::A.Hold"),
                           ([*good, "docs/safety.md\tIt is\tb_test.cc::A.Holds"], "no test b_test.cc"), ([*good, "docs/safety.md\tIt is\tb.py::test"], "no test")):
            found = self.findings(*rows)
            self.assertEqual(len(found), 1, (rows, found))
            self.assertIn(said, found[0])


if __name__ == "__main__":
    unittest.main()
