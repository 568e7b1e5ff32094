// One wrong or odd thing per file: each must be answered with the right line, the element and what is wrong.
#include "tests/core/urdf/corpus.h"

#include <gtest/gtest.h>
#include <rbd/urdf/urdf.h>

#include <ctime>
#include <set>

#include "tests/support/paths.h"

namespace rbd::urdf {
namespace {

std::string all(const std::vector<Diagnostic>& list) {
  std::string text;
  for (const Diagnostic& d : list) text += d.text() + "\n";
  return text;
}

const std::vector<CorpusCase>& cases() {
  static const std::vector<CorpusCase> table = read_corpus(lab::source_path("tests/core/urdf/corpus.txt"));
  return table;
}

TEST(UrdfCorpus, EachFileIsAnsweredAsTheTableSays) {
  ASSERT_GE(cases().size(), 100u);
  std::set<std::string> names;
  for (const CorpusCase& c : cases()) {
    SCOPED_TRACE(c.name);
    EXPECT_TRUE(names.insert(c.name).second) << "twice in the table";
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const Loaded loaded = loadXML(c.text, {}, "arm.urdf");
    EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");

    EXPECT_EQ(loaded.ok(), c.severity != Severity::Error) << all(loaded.diagnostics);
    bool told = false;
    for (const Diagnostic& d : loaded.diagnostics) {
      EXPECT_EQ(d.file, "arm.urdf");
      if (c.severity == Severity::Error && d.severity == Severity::Error && d.line != c.line)
        ADD_FAILURE() << "a second error: " << d;
      told = told || (d.severity == c.severity && d.line == c.line && d.element == c.element &&
                      d.message.find(c.message) != std::string::npos);
    }
    EXPECT_EQ(told, !c.ok) << "wanted " << c.wanted << "\ngot\n"
                           << all(loaded.diagnostics) << c.text.substr(0, 2000);
    EXPECT_TRUE(!c.ok || loaded.diagnostics.empty()) << all(loaded.diagnostics);
    EXPECT_TRUE(loaded.ok() || loaded.model.njoints == 1) << "a refused file must leave nothing behind";
  }
}

TEST(UrdfCorpus, WhatIsAcceptedComputes) {
  int accepted = 0;
  for (const CorpusCase& c : cases()) {
    SCOPED_TRACE(c.name);
    for (const bool floating : {false, true}) {
      Options options;
      options.floating_base = floating;
      const Loaded loaded = loadXML(c.text, options);
      if (!loaded.ok()) continue;
      ++accepted;
      EXPECT_EQ(evaluate(loaded.model), "");
    }
  }
  EXPECT_GT(accepted, 60);
}

// With `strict` a warning refuses, a note does not, and the text stays the same.
TEST(UrdfCorpus, StrictRefusesWarnings) {
  Options options;
  options.strict = true;
  for (const CorpusCase& c : cases()) {
    SCOPED_TRACE(c.name);
    const Loaded free = loadXML(c.text), strict = loadXML(c.text, options);
    bool warned = false;
    for (const Diagnostic& d : free.diagnostics) warned = warned || d.severity != Severity::Note;
    EXPECT_EQ(strict.ok(), !warned);
    ASSERT_EQ(strict.diagnostics.size(), free.diagnostics.size());
  }
}

// Time must grow with the length of a chain, not with its square: four times the links take less than ten
// times as long (a square would take sixteen). CPU time, the least of five runs, and both lengths in turn, so
// that a busy machine does not count.
TEST(UrdfCorpus, LongChainsAreLinear) {
  const auto chain = [](int links) {
    std::string text = "<robot name='r'><link name='l0'/>";
    for (int i = 0; i < links; ++i) {
      const std::string n = std::to_string(i + 1);
      text += "<link name='l" + n +
              "'><inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' "
              "izz='1'/></inertial></link><joint name='j" +
              n + "' type='continuous'><parent link='l" + std::to_string(i) + "'/><child link='l" + n +
              "'/><axis xyz='0 0 1'/></joint>";
    }
    return text + "</robot>";
  };
  const auto seconds = [](const std::string& text, int links) {
    const std::clock_t start = std::clock();
    const Loaded loaded = loadXML(text);
    EXPECT_TRUE(loaded.ok()) << all(loaded.diagnostics);
    EXPECT_EQ(loaded.model.njoints, links + 1);
    return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  };
  const std::string short_chain = chain(3000), long_chain = chain(12000);
  double small = 1e9, large = 1e9;
  for (int k = 0; k < 5; ++k) {
    small = std::min(small, seconds(short_chain, 3000));
    large = std::min(large, seconds(long_chain, 12000));
  }
  EXPECT_LT(large, 10 * small) << small << " s, " << large << " s";
}

}  // namespace
}  // namespace rbd::urdf
