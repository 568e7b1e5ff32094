// One wrong thing per file: each must be answered with the right line, the element and what is wrong.
#include <gtest/gtest.h>
#include <rbd/urdf/urdf.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

namespace rbd::urdf {
namespace {

constexpr Severity kNote = Severity::Note, kWarn = Severity::Warning, kError = Severity::Error;

struct Case {
  std::string what;
  std::string text;     // the whole file; {..} below stand for sound parts
  int line;             // expected
  Severity severity;    // kError: refused; else accepted with this message
  std::string element;  // "" = the message names none
  std::string message;  // must be part of it
};

// A file of sound parts: base and tip, joined by one joint; every part fits in one line. Line 1 is <robot>.
const std::string kHead = "<robot name='r'>\n";
const std::string kTail = "</robot>\n";
const std::string kBody =
    "<inertial><mass value='1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' iyz='0' izz='1'/></inertial>";
const std::string kBase = "<link name='base'/>\n";
const std::string kTip = "<link name='tip'>" + kBody + "</link>\n";
const std::string kEnds = "<parent link='base'/><child link='tip'/>";
const std::string kLimit = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";
const std::string kAxis = "<axis xyz='0 0 1'/>";

// Line 4 holds the joint.
std::string with_joint(const std::string& joint) { return kHead + kBase + kTip + joint + "\n" + kTail; }
std::string with_type(const std::string& type, const std::string& inside) {
  return with_joint("<joint name='j' type='" + type + "'>" + kEnds + inside + "</joint>");
}
std::string revolute(const std::string& inside) { return with_type("revolute", inside); }
// Line 3 holds the link 'tip' that joint 'j' moves.
std::string with_tip(const std::string& inside) {
  return kHead + kBase + "<link name='tip'>" + inside + "</link>\n<joint name='j' type='revolute'>" + kEnds +
         kAxis + kLimit + "</joint>\n" + kTail;
}
std::string inertial(const std::string& mass, const std::string& inertia) {
  return with_tip("<inertial><mass value='" + mass + "'/><inertia " + inertia + "/></inertial>");
}
std::string inertia6(const char* xx, const char* yy, const char* zz, const char* xy = "0") {
  return std::string("ixx='") + xx + "' ixy='" + xy + "' ixz='0' iyy='" + yy + "' iyz='0' izz='" + zz + "'";
}
std::string visual(const std::string& inside) { return with_tip(kBody + "<visual>" + inside + "</visual>"); }
std::string shape(const std::string& text) { return visual("<geometry>" + text + "</geometry>"); }
std::string chain(const std::string& name, const std::string& parent, const std::string& child,
                  const std::string& more = "") {
  return "<joint name='" + name + "' type='continuous'><parent link='" + parent + "'/><child link='" + child +
         "'/>" + kAxis + more + "</joint>\n";
}
std::string link(const std::string& name) { return "<link name='" + name + "'>" + kBody + "</link>\n"; }
std::string deep(int depth) {
  std::string text = kHead;
  for (int i = 0; i < depth; ++i) text += "<gazebo>";
  for (int i = 0; i < depth; ++i) text += "</gazebo>";
  return text + link("a") + kTail;
}

const std::vector<Case>& cases() {
  static const std::vector<Case> table = {
      // the text
      {"empty file", "", 0, kError, "", "empty"},
      {"blank file", " \n\t\n", 0, kError, "", "empty"},
      {"not XML", "solid stl file", 1, kError, "", "XML"},
      {"cut off", kHead + kBase + "<link name='tip'>", 3, kError, "", "not well-formed XML"},
      {"wrong closing tag", kHead + "<link name='a'>\n</joint>\n" + kTail, 2, kError, "", "MISMATCHED"},
      {"attribute twice", kHead + "<link name='a' name='b'/>\n" + kTail, 2, kError, "", "ATTRIBUTE"},
      {"zero byte", kHead + std::string("\0", 1) + kTail, 2, kError, "", "zero byte"},
      {"another root element", "<sdf version='1.6'/>", 1, kError, "", "<sdf>"},
      {"two robots", "<robot name='a'><link name='l'/></robot>\n<robot name='b'/>", 2, kError, "",
       "another <robot>"},
      {"entity bomb", "<?xml version='1.0'?>\n<!DOCTYPE r [\n<!ENTITY a 'ha'>\n]>\n" + kHead + kTail, 3,
       kError, "", "entity"},
      {"nested without end", deep(5000), 2, kError, "", "DEPTH"},
      {"xacro", kHead + "<xacro:macro name='leg'/>\n" + link("a") + kTail, 2, kError, "robot 'r'", "xacro"},
      {"xacro value", with_type("fixed", "<origin xyz='0 0 ${h}'/>"), 4, kError, "joint 'j'", "xacro"},
      {"robot without name", "<robot>\n" + link("a") + kTail, 1, kError, "robot", "has no 'name'"},
      {"unknown version", "<robot name='r' version='2.0'>\n" + link("a") + kTail, 1, kError, "robot 'r'",
       "'2.0'"},
      {"no links", kHead + kTail, 1, kError, "robot 'r'", "no <link>"},

      // numbers
      {"a word", with_type("fixed", "<origin xyz='0 zero 0'/>"), 4, kError, "joint 'j'",
       "'zero' is not a number"},
      {"decimal comma", with_type("fixed", "<origin xyz='0,5 0 0'/>"), 4, kError, "joint 'j'", "commas"},
      {"trailing garbage", with_type("fixed", "<origin xyz='0 0 1m'/>"), 4, kError, "joint 'j'", "'1m'"},
      {"two of three", with_type("fixed", "<origin xyz='0 1'/>"), 4, kError, "joint 'j'",
       "needs 3 numbers, has 2"},
      {"four of three", with_type("fixed", "<origin rpy='0 1 2 3'/>"), 4, kError, "joint 'j'", "has 4"},
      {"empty vector", with_type("fixed", "<origin xyz=''/>"), 4, kError, "joint 'j'", "has 0"},
      {"NaN", with_type("fixed", "<origin rpy='0 nan 0'/>"), 4, kError, "joint 'j'", "not finite"},
      {"infinity", inertial("inf", inertia6("1", "1", "1")), 3, kError, "link 'tip'", "not finite"},
      {"overflow", inertial("1e999", inertia6("1", "1", "1")), 3, kError, "link 'tip'", "out of range"},
      {"a light year", with_type("fixed", "<origin xyz='1e16 0 0'/>"), 4, kError, "joint 'j'", "too large"},
      {"hexadecimal", inertial("0x10", inertia6("1", "1", "1")), 3, kError, "link 'tip'", "'0x10'"},
      {"value on its own line", with_type("fixed", "<origin\nxyz='0 0 0'\nrpy='0 x 0'/>"), 6, kError,
       "joint 'j'", "'x'"},

      // links
      {"link without name", kHead + "<link/>\n" + kTail, 2, kError, "link", "has no 'name'"},
      {"link with empty name", kHead + "<link name=''/>\n" + kTail, 2, kError, "link", "empty 'name'"},
      {"link twice", kHead + link("a") + link("a") + kTail, 3, kError, "link 'a'", "first is in line 2"},
      {"mass missing", with_tip("<inertial><inertia " + inertia6("1", "1", "1") + "/></inertial>"), 3, kError,
       "link 'tip'", "no <mass>"},
      {"inertia missing", with_tip("<inertial><mass value='1'/></inertial>"), 3, kError, "link 'tip'",
       "no <inertia>"},
      {"mass as text",
       with_tip("<inertial><mass>1</mass><inertia " + inertia6("1", "1", "1") + "/></inertial>"), 3, kError,
       "link 'tip'", "has no 'value'"},
      {"inertia incomplete", inertial("1", "ixx='1' iyy='1' izz='1'"), 3, kError, "link 'tip'", "no 'ixy'"},
      {"negative mass", inertial("-2", inertia6("1", "1", "1")), 3, kError, "link 'tip'", "negative (-2)"},
      {"indefinite inertia", inertial("1", inertia6("1", "-1", "1")), 3, kError, "link 'tip'",
       "positive definite"},
      {"indefinite by its product", inertial("1", inertia6("1", "1", "1", "2")), 3, kError, "link 'tip'",
       "(principal"},
      {"inertial twice", with_tip(kBody + "\n" + kBody), 4, kError, "link 'tip'", "a second <inertial>"},
      {"triangle inequality", inertial("1", inertia6("1", "1", "3")), 3, kWarn, "link 'tip'",
       "sum of the others"},
      {"point mass", inertial("1", inertia6("0", "0", "0")), 3, kWarn, "link 'tip'", "point mass"},
      {"thin rod", inertial("1", inertia6("1", "1", "0")), 3, kWarn, "link 'tip'", "singular"},
      {"inertia without mass", inertial("0", inertia6("1", "1", "1")), 3, kWarn, "link 'tip'",
       "without mass"},
      {"moving link without mass", with_tip(""), 4, kWarn, "joint 'j'", "singular unless"},
      {"no inertia about the axis", inertial("1", inertia6("1", "1", "0")), 4, kWarn, "joint 'j'",
       "about its axis"},

      // joints
      {"joint without name", with_joint("<joint type='fixed'>" + kEnds + "</joint>"), 4, kError, "joint",
       "no 'name'"},
      {"joint without type", with_joint("<joint name='j'>" + kEnds + "</joint>"), 4, kError, "joint 'j'",
       "no 'type'"},
      {"unknown type", with_type("hinge", ""), 4, kError, "joint 'j'", "'hinge'"},
      {"no parent", with_joint("<joint name='j' type='fixed'><child link='tip'/></joint>"), 4, kError,
       "joint 'j'", "no <parent>"},
      {"no child", with_joint("<joint name='j' type='fixed'><parent link='tip'/></joint>"), 4, kError,
       "joint 'j'", "no <child>"},
      {"parent without link", with_joint("<joint name='j' type='fixed'><parent/><child link='tip'/></joint>"),
       4, kError, "joint 'j'", "no 'link'"},
      {"two parents in one joint", with_type("fixed", "\n<parent link='tip'/>"), 5, kError, "joint 'j'",
       "a second <parent>"},
      {"parent unknown", with_joint(chain("j", "nobody", "tip")), 4, kError, "joint 'j'",
       "'nobody' does not exist"},
      {"child unknown", with_joint(chain("j", "base", "nobody")), 4, kError, "joint 'j'",
       "'nobody' does not exist"},
      {"joint twice",
       kHead + link("a") + link("b") + link("c") + chain("j", "a", "b") + chain("j", "a", "c") + kTail, 6,
       kError, "joint 'j'", "first is in line 5"},
      {"name of the universe", with_joint(chain("universe", "base", "tip")), 4, kError, "joint 'universe'",
       "taken"},
      {"no limit", revolute(kAxis), 4, kError, "joint 'j'", "no <limit>"},
      {"sliding without limit", with_type("prismatic", kAxis), 4, kError, "joint 'j'", "no <limit>"},
      {"lower above upper", revolute(kAxis + "<limit lower='1' upper='-1' effort='1' velocity='1'/>"), 4,
       kError, "joint 'j'", "(lower 1, upper -1)"},
      {"no effort", revolute(kAxis + "<limit lower='-1' upper='1' velocity='1'/>"), 4, kError, "joint 'j'",
       "'effort'"},
      {"negative effort", revolute(kAxis + "<limit lower='-1' upper='1' effort='-5' velocity='1'/>"), 4,
       kError, "joint 'j'", "effort limit is negative (-5)"},
      {"negative velocity", revolute(kAxis + "<limit lower='-1' upper='1' effort='5' velocity='-1'/>"), 4,
       kError, "joint 'j'", "velocity limit is negative"},
      {"no room", revolute(kAxis + "<limit effort='5' velocity='1'/>"), 4, kWarn, "joint 'j'", "no room"},
      {"no drive", revolute(kAxis + "<limit lower='-1' upper='1' effort='0' velocity='1'/>"), 4, kWarn,
       "joint 'j'", "effort limit is 0"},
      {"unused limits", with_type("continuous", kAxis + kLimit), 4, kNote, "joint 'j'", "not used"},
      {"zero axis", revolute("<axis xyz='0 0 0'/>" + kLimit), 4, kError, "joint 'j'", "axis is zero"},
      {"NaN axis", revolute("<axis xyz='0 0 nan'/>" + kLimit), 4, kError, "joint 'j'", "not finite"},
      {"axis without xyz", revolute("<axis/>" + kLimit), 4, kError, "joint 'j'", "no 'xyz'"},
      {"no axis", revolute(kLimit), 4, kWarn, "joint 'j'", "x is taken"},
      {"long axis", revolute("<axis xyz='0 0 2'/>" + kLimit), 4, kNote, "joint 'j'", "length 2"},
      {"negative damping", revolute(kAxis + kLimit + "<dynamics damping='-1'/>"), 4, kError, "joint 'j'",
       "damping"},

      // the tree
      {"child of itself", kHead + link("a") + link("b") + chain("i", "a", "b") + chain("j", "b", "b") + kTail,
       5, kError, "joint 'j'", "same link 'b'"},
      {"two parents",
       kHead + link("a") + link("b") + link("c") + chain("i", "a", "b") + chain("j", "a", "c") +
           chain("k", "b", "c") + kTail,
       7, kError, "joint 'k'", "hangs on joint 'j' already (line 6)"},
      {"detached link", kHead + link("a") + link("b") + link("c") + chain("j", "a", "b") + kTail, 4, kError,
       "link 'c'", "detached from the root 'a'"},
      {"ring of all", kHead + link("a") + link("b") + chain("i", "a", "b") + chain("j", "b", "a") + kTail, 5,
       kError, "joint 'j'", "loop"},
      {"ring beside the tree",
       kHead + link("a") + link("b") + link("c") + chain("i", "b", "c") + chain("j", "c", "b") + kTail, 6,
       kError, "joint 'j'", "loop"},

      // mimic
      {"mimic of nobody", revolute(kAxis + kLimit + "<mimic joint='nobody'/>"), 4, kError, "joint 'j'",
       "'nobody', which does not exist"},
      {"mimic of itself", revolute(kAxis + kLimit + "<mimic joint='j'/>"), 4, kError, "joint 'j'",
       "mimics itself"},
      {"mimic without leader", revolute(kAxis + kLimit + "<mimic multiplier='2'/>"), 4, kError, "joint 'j'",
       "no 'joint'"},
      {"mimic ring",
       kHead + link("a") + link("b") + link("c") + chain("i", "a", "b", "<mimic joint='j'/>") +
           chain("j", "a", "c", "<mimic joint='i'/>") + kTail,
       5, kError, "joint 'i'", "mimics itself, through joint 'j'"},
      {"mimic of a fixed joint",
       kHead + link("a") + link("b") + link("c") + chain("i", "a", "b", "<mimic joint='j'/>") +
           "<joint name='j' type='fixed'><parent link='a'/><child link='c'/></joint>\n" + kTail,
       5, kError, "joint 'i'", "which is fixed"},
      {"mimic multiplier", revolute(kAxis + kLimit + "<mimic joint='j' multiplier='1,5'/>"), 4, kError,
       "joint 'j'", "commas"},

      // shapes
      {"visual without geometry", visual(""), 3, kError, "link 'tip'", "no <geometry>"},
      {"geometry without shape", visual("<geometry/>"), 3, kError, "link 'tip'", "no shape"},
      {"two shapes", shape("<sphere radius='1'/>\n<box size='1 1 1'/>"), 4, kError, "link 'tip'",
       "second shape"},
      {"unknown shape", shape("<cone radius='1'/>"), 3, kError, "link 'tip'", "<cone>"},
      {"negative box", shape("<box size='1 -1 1'/>"), 3, kError, "link 'tip'", "(1 -1 1)"},
      {"negative radius", shape("<sphere radius='-1'/>"), 3, kError, "link 'tip'", "negative size (-1)"},
      {"cylinder without length", shape("<cylinder radius='1'/>"), 3, kError, "link 'tip'", "no 'length'"},
      {"box of two", shape("<box size='1 1'/>"), 3, kError, "link 'tip'", "has 2"},
      {"box without volume", shape("<box size='0 0 0'/>"), 3, kWarn, "link 'tip'", "left out (0 0 0)"},
      {"mesh without file", shape("<mesh/>"), 3, kError, "link 'tip'", "no 'filename'"},
      {"mesh scale of zero", shape("<mesh filename='a.stl' scale='1 0 1'/>"), 3, kError, "link 'tip'",
       "scale is zero"},
      {"mesh not found", shape("<mesh filename='package://nobody/a.stl'/>"), 3, kWarn, "link 'tip'",
       "not found (tried"},
      {"mesh on the web", shape("<mesh filename='http://host/a.stl'/>"), 3, kWarn, "link 'tip'",
       "known: package://"},
      {"material unknown", visual("<geometry><sphere radius='1'/></geometry><material name='gold'/>"), 3,
       kWarn, "link 'tip'", "'gold' has no colour"},
      {"colour of 255",
       visual("<geometry><sphere radius='1'/></geometry><material name='m'><color rgba='255 0 0 1'/>"
              "</material>"),
       3, kWarn, "link 'tip'", "clamped"},
      {"colour of three",
       visual("<geometry><sphere radius='1'/></geometry><material name='m'><color rgba='1 0 0'/>"
              "</material>"),
       3, kError, "link 'tip'", "needs 4 numbers"},

      // what is passed over
      {"unknown element", revolute(kAxis + kLimit + "\n<limits/>"), 5, kWarn, "joint 'j'",
       "<limits> in <joint>"},
      {"unknown attribute", revolute("<axis xyz='0 0 1' xzy='0 1 0'/>" + kLimit), 4, kWarn, "joint 'j'",
       "'xzy'"},
      {"stray text", revolute(kAxis + kLimit + "<origin>0 0 1</origin>"), 4, kWarn, "joint 'j'",
       "text in <origin>"},
      {"gazebo", kHead + link("a") + "<gazebo/>\n<gazebo/>\n" + kTail, 3, kNote, "robot 'r'", "(2 times)"},
      {"link called like its joint", kHead + link("a") + link("b") + chain("b", "a", "b") + kTail, 4, kNote,
       "joint 'b'", "same name (line 3)"},
  };
  return table;
}

// What stands between its severity and the end of the line, for messages of this test.
std::string all(const std::vector<Diagnostic>& list) {
  std::string text;
  for (const Diagnostic& d : list) text += d.text() + "\n";
  return text;
}

TEST(Malformed, EachFaultIsNamedWithItsLine) {
  ASSERT_GE(cases().size(), 100u);
  for (const Case& c : cases()) {
    SCOPED_TRACE(c.what);
    testing::internal::CaptureStdout();
    testing::internal::CaptureStderr();
    const Loaded loaded = loadXML(c.text, {}, "arm.urdf");
    EXPECT_EQ(testing::internal::GetCapturedStdout() + testing::internal::GetCapturedStderr(), "");

    EXPECT_EQ(loaded.ok(), c.severity != kError) << all(loaded.diagnostics);
    bool told = false;
    for (const Diagnostic& d : loaded.diagnostics) {
      EXPECT_EQ(d.file, "arm.urdf");
      if (c.severity == kError && d.severity == kError && d.line != c.line)
        ADD_FAILURE() << "a second error: " << d;
      told = told || (d.severity == c.severity && d.line == c.line && d.element == c.element &&
                      d.message.find(c.message) != std::string::npos);
    }
    EXPECT_TRUE(told) << "wanted line " << c.line << ", " << c.element << ", '" << c.message << "', got\n"
                      << all(loaded.diagnostics);
    if (loaded.ok()) {
      EXPECT_TRUE(loaded.model.njoints >= 1 && !loaded.model.name.empty());
    } else {
      EXPECT_EQ(loaded.model.njoints, 1) << "a refused file must leave nothing behind";
    }
  }
}

// The sound parts of the table are sound: otherwise a case could be refused for the wrong reason.
TEST(Malformed, TheSoundPartsAreAccepted) {
  for (const std::string& text :
       {with_tip(kBody), revolute(kAxis + kLimit), with_type("fixed", ""),
        with_type("prismatic", kAxis + kLimit), with_type("continuous", kAxis), kHead + link("a") + kTail,
        inertial("1", inertia6("1", "1", "1")), shape("<sphere radius='1'/>")}) {
    const Loaded loaded = loadXML(text);
    EXPECT_TRUE(loaded.diagnostics.empty()) << text << all(loaded.diagnostics);
  }
}

TEST(Malformed, ThrownErrorsCarryTheSameLines) {
  Model model;
  model.name = "untouched";
  try {
    buildModelFromXML(revolute(kAxis), model);
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
  const Loaded loaded = loadXML(kHead + "<link name='a'><inertial><mass value='-1'/><inertia " +
                                inertia6("1", "1", "1") + "/></inertial></link>\n<link name='a'/>\n" + kTail);
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
  EXPECT_NE(load(MODEL_DIR).diagnostics.at(0).message.find("folder"), std::string::npos);
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
  std::ifstream in(MODEL_DIR "/simple_3dof_arm.urdf");
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
    for (int i = 0; i < m.njoints; ++i) {
      EXPECT_TRUE(m.jointPlacements[i].toHomogeneousMatrix().allFinite());
      EXPECT_TRUE(m.inertias[i].matrix().allFinite());
      EXPECT_GE(m.inertias[i].mass(), 0);
    }
    for (const Frame& f : m.frames) EXPECT_TRUE(f.placement.toHomogeneousMatrix().allFinite());
    EXPECT_TRUE((m.lowerPositionLimit.array() <= m.upperPositionLimit.array()).all());
    EXPECT_TRUE((m.upperEffortLimit.array() >= 0).all() && (m.upperVelocityLimit.array() >= 0).all());
  }
  EXPECT_GT(accepted, rounds / 20) << "too much damage tests the XML parser only";
  EXPECT_LT(accepted, rounds * 19 / 20) << "too little damage tests nothing";
}

}  // namespace
}  // namespace rbd::urdf
