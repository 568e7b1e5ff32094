#!/usr/bin/env python3
"""The checks of this folder see what they are for: small trees with one fault each."""
import os
import tempfile
import unittest

import rooms
import sizes

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


if __name__ == "__main__":
    unittest.main()
