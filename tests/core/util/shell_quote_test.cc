#include "core/util/shell_quote.h"

#include <gtest/gtest.h>

#include <cstdio>

namespace lab {
namespace {

// What /bin/sh makes of it.
std::string through_the_shell(const std::string& quoted) {
  FILE* pipe = popen(("printf %s. " + quoted).c_str(), "r");
  std::string out;
  for (int c; (c = std::fgetc(pipe)) != EOF;) out += static_cast<char>(c);
  pclose(pipe);
  return out.empty() ? out : out.substr(0, out.size() - 1);
}

TEST(ShellQuote, TheShellReadsTheWordBack) {
  for (const std::string word : {"", "plain", "runs/a-b_c.yaml", "two words", "it's", "''", "$HOME", "`x`",
                                 "a\"b", "a\\b", "*", "~", "#x", "a;b", "new\nline", "ü", "!x", "-n", "a=b"})
    EXPECT_EQ(through_the_shell(shell_quote(word)), word);
}

TEST(ShellQuote, HarmlessWordsStayAsTheyAre) {
  EXPECT_EQ(shell_quote("runs/a-b_c.yaml"), "runs/a-b_c.yaml");
  EXPECT_EQ(shell_quote("two words"), "'two words'");
  EXPECT_EQ(shell_quote(""), "''");
}

}  // namespace
}  // namespace lab
