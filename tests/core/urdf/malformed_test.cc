// Errors as values, hostile names, files that cannot be read, and damage at random (the table of faults is
// corpus.txt).
#include <gtest/gtest.h>
#include <rbd/urdf/urdf.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "tests/core/urdf/corpus.h"
#include "tests/support/paths.h"

namespace rbd::urdf {
namespace {

const std::string kHead = "<robot name='r'>\n", kTail = "</robot>\n";

// What stands between its severity and the end of the line, for messages of this test.
std::string all(const std::vector<Diagnostic>& list) {
  std::string text;
  for (const Diagnostic& d : list) text += d.text() + "\n";
  return text;
}

TEST(Malformed, ThrownErrorsCarryTheSameLines) {
  Model model;
  model.name = "untouched";
  try {
    buildModelFromXML(
        kHead + "<link name='base'/>\n<link name='tip'/>\n<joint name='j' type='revolute'><parent " +
            "link='base'/><child link='tip'/><axis xyz='0 0 1'/></joint>\n" + kTail,
        model);
    FAIL() << "accepted";
  } catch (const Error& e) {
    EXPECT_STREQ(e.what(),
                 "<urdf>:4: joint 'j': no <limit> (a joint that may turn without end has type 'continuous')");
    ASSERT_EQ(e.diagnostics().size(), 1u);
    EXPECT_EQ(e.diagnostics()[0].line, 4);
  }
  EXPECT_EQ(model.name, "untouched");
}

TEST(Malformed, SeveralErrorsAreSeveralLinesInOrder) {
  const Loaded loaded = loadXML(kHead +
                                "<link name='a'><inertial><mass value='-1'/><inertia ixx='1' ixy='0' ixz='0' "
                                "iyy='1' iyz='0' izz='1'/>" +
                                "</inertial></link>\n<link name='a'/>\n" + kTail);
  ASSERT_EQ(loaded.diagnostics.size(), 2u) << all(loaded.diagnostics);
  EXPECT_EQ(loaded.diagnostics[0].line, 2);
  EXPECT_EQ(loaded.diagnostics[1].line, 3);
}

TEST(Malformed, FilesThatCannotBeRead) {
  Model model;
  EXPECT_THROW(buildModel("/nowhere/arm.urdf", model), Error);
  EXPECT_NE(load("/nowhere/arm.urdf")
                .diagnostics.at(0)
                .text()
                .find("/nowhere/arm.urdf: cannot be read (No such file"),
            std::string::npos);
  EXPECT_NE(load(lab::source_path("models")).diagnostics.at(0).message.find("folder"), std::string::npos);
}

// A name with a line break or a percent sign must neither break the one-line rule nor be taken for a format.
TEST(Malformed, HostileNamesStayInOneLine) {
  const Loaded loaded = loadXML(kHead + "<link name='a&#10;b%s%n'/>\n<link name='c'/>\n" + kTail);
  ASSERT_EQ(loaded.diagnostics.size(), 1u);
  EXPECT_EQ(loaded.diagnostics[0].text().find('\n'), std::string::npos);
  const Loaded sound = loadXML(kHead + "<link name='50%s%n &lt;&amp;'/>\n" + kTail);
  ASSERT_TRUE(sound.ok()) << all(sound.diagnostics);
  EXPECT_EQ(sound.model.frames[1].name, "50%s%n <&");
}

// Whatever a file is damaged to: refused with a message, or a model in which every number is one.
// URDF_MUTATIONS in the environment asks for more rounds.
TEST(Malformed, DamagedFilesGiveMessagesOrFiniteModels) {
  std::ifstream in(lab::source_path("models/simple_3dof_arm.urdf"));
  const std::string sound(std::istreambuf_iterator<char>(in), {});
  ASSERT_GT(sound.size(), 1000u);
  const char* more = std::getenv("URDF_MUTATIONS");
  const int rounds = more ? std::atoi(more) : 500;
  const std::vector<std::string> pieces = {"-", "0",    "nan",   "1e308",     "\"",     "<",         "/>",
                                           "&", "name", "link",  " ",         "1e-320", "<origin/>", "inf",
                                           ",", "-1",   "link1", "base_link", "\n",     "fixed",     "9e99"};
  std::mt19937 random(20261122);
  int accepted = 0;
  for (int round = 0; round < rounds; ++round) {
    std::string text = sound;
    for (int k = 0; k < 1 + round % 3; ++k) {
      const size_t where = random() % text.size();
      const size_t length = random() % 4 == 0 ? random() % 200 : random() % 3;
      const std::string& piece = pieces[random() % pieces.size()];
      switch (random() % 3) {
        case 0:
          text.replace(where, length, piece);
          break;
        case 1:
          text.insert(where, piece);
          break;
        default:
          text.insert(random() % text.size(), text.substr(where, length));
          break;
      }
    }
    Options options;
    options.floating_base = round % 2;
    const Loaded loaded = loadXML(text, options);
    if (!loaded.ok()) {
      EXPECT_FALSE(loaded.diagnostics.empty());
      continue;
    }
    ++accepted;
    const Model& m = loaded.model;
    EXPECT_EQ(evaluate(m), "");
    EXPECT_TRUE((m.lowerPositionLimit.array() <= m.upperPositionLimit.array()).all());
    EXPECT_TRUE((m.upperEffortLimit.array() >= 0).all() && (m.upperVelocityLimit.array() >= 0).all());
  }
  EXPECT_GT(accepted, rounds / 20) << "too much damage tests the XML parser only";
  EXPECT_LT(accepted, rounds * 19 / 20) << "too little damage tests nothing";
}

}  // namespace
}  // namespace rbd::urdf
