// lab-model as people start it: streams, lines and exit codes.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/paths.h"

namespace {

using nlohmann::json;

const std::string kArm = lab::source_path("models/simple_3dof_arm.urdf");

struct Result {
  int code = -1;
  std::string out, err;
};

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file);
  return std::string(std::istreambuf_iterator<char>(in), {});
}

class Program : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("lab_model_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  Result run(const std::string& arguments, const std::string& input = "{}") {
    const std::string in = file("in", input), out = folder_ / "out", err = folder_ / "err";
    const int status = std::system(
        (lab::build_path("bin/lab-model") + " " + arguments + " <" + in + " >" + out + " 2>" + err).c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read(out), read(err)};
  }

  std::filesystem::path folder_;
};

// two links, a joint; `limit` is line 4, `mass` is in line 3
std::string two_links(const std::string& limit, const std::string& mass = "1", const std::string& more = "") {
  return "<robot name='two'>\n<link name='a'/>\n<link name='b'><inertial><origin xyz='0 0 1'/><mass value='" +
         mass +
         "'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial></link>\n"
         "<joint name='j' type='revolute'><parent link='a'/><child link='b'/><axis xyz='0 1 0'/>" +
         limit + "</joint>\n" + more + "</robot>\n";
}
constexpr const char* kLimit = "<limit lower='-1' upper='1' effort='1' velocity='1'/>";

TEST_F(Program, CheckSaysOkOrWhatIsWrongAndWhere) {
  const std::string good = file("good.urdf", two_links(kLimit));
  const std::string warned =
      file("warned.urdf", two_links("<limit lower='-1' upper='1' effort='0' velocity='1'/>"));
  const std::string bad = file("bad.urdf", two_links(kLimit, "-2.5"));

  const Result fine = run("check " + good + " builtin:manipulator");
  EXPECT_EQ(fine.code, 0) << fine.err;
  EXPECT_EQ(
      fine.out,
      good + ": ok (two, nq 1, nv 1, 1 kg)\nbuiltin:manipulator: ok (manipulator, nq 6, nv 6, 15 kg)\n");
  EXPECT_EQ(fine.err, "");

  const Result warning = run("check " + warned);
  EXPECT_EQ(warning.code, 0);
  EXPECT_EQ(warning.err, warned + ":4: warning: joint 'j': effort limit is 0: the joint cannot be driven\n");

  const Result refused = run("check " + bad + " " + good + " " + (folder_ / "none.urdf").string());
  EXPECT_EQ(refused.code, 3);
  EXPECT_EQ(refused.out, good + ": ok (two, nq 1, nv 1, 1 kg)\n");  // the others are still checked
  EXPECT_EQ(refused.err, bad + ":3: link 'b': mass is negative (-2.5)\n" + (folder_ / "none.urdf").string() +
                             ": cannot be read (No such file or directory)\n");

  const Result both = run("check --json " + bad + " " + warned);
  EXPECT_EQ(both.code, 3);
  const json all = json::parse(both.out);
  EXPECT_EQ(all[0]["ok"], false);
  EXPECT_EQ(all[0]["diagnostics"][0]["line"], 3);
  EXPECT_EQ(all[0]["diagnostics"][0]["element"], "link 'b'");
  EXPECT_EQ(all[1]["ok"], true);
  EXPECT_EQ(all[1]["diagnostics"][0]["severity"], "warning");
}

TEST_F(Program, TreeOfTheArm) {
  const Result tree = run(std::string("tree ") + kArm);
  EXPECT_EQ(tree.code, 0) << tree.err;
  EXPECT_EQ(tree.out,
            "simple_3dof_arm  nq 3, nv 3, 8.5 kg that move\n"
            "universe > base_link 10 kg\n"
            "└─ joint1_base_rotation RZ > link1 5 kg\n"
            "   └─ joint2_shoulder RY > link2 3 kg\n"
            "      └─ joint3_elbow RY > end_effector 0.5 kg\n");
  // every frame of info is in the JSON tree exactly once
  const auto count = [](auto self, const json& node) -> size_t {
    size_t n = 1;
    for (const json& child : node["children"]) n += self(self, child);
    return n;
  };
  for (const std::string& robot : {kArm, std::string("builtin:humanoid")}) {
    const json nested = json::parse(run(std::string("tree --json ") + robot).out);
    const json info = json::parse(run(std::string("info --json ") + robot).out);
    EXPECT_EQ(count(count, nested), info["frames"].size()) << robot;
  }
}

TEST_F(Program, InfoTellsWhatTheFileSays) {
  const std::string follower =
      "<link name='c'><inertial><mass value='2'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' "
      "iyz='0'/></inertial></link>\n"
      "<joint name='k' type='prismatic'><parent link='b'/><child link='c'/><axis xyz='0 0 1'/><mimic "
      "joint='j' multiplier='-2' offset='0.5'/>" +
      std::string(kLimit) + "</joint>\n";
  const std::string two = file("two.urdf", two_links(kLimit, "1", follower));
  const json info = json::parse(run("info --json " + two).out);
  EXPECT_EQ(info["nq"], 1);
  EXPECT_EQ(info["mass"], 3);
  EXPECT_EQ(info["joints"][0]["kind"], "RY");
  EXPECT_EQ(info["joints"][0]["position"]["lower"], json::array({-1}));
  EXPECT_EQ(info["joints"][1]["mimic"], json({{"joint", "j"}, {"multiplier", -2}, {"offset", 0.5}}));
  EXPECT_NE(run("info " + two).out.find("PZ = -2 j + 0.5"), std::string::npos);

  const json free = json::parse(run("info --json --no-mimic --floating-base --gravity -1,0.5,2 " + two).out);
  EXPECT_EQ(free["nq"], 9);
  EXPECT_EQ(free["nv"], 8);
  EXPECT_EQ(free["joints"][0]["name"], "root_joint");
  EXPECT_EQ(free["joints"][0]["position"]["lower"][0], nullptr);  // no limit
  EXPECT_FALSE(free["joints"][2].contains("mimic"));
  EXPECT_EQ(free["gravity"], json::array({-1, 0.5, 2}));
}

TEST_F(Program, EvalReadsStdinAndPrintsOneLineOfJson) {
  const Result header = run(std::string("eval ") + kArm);
  EXPECT_EQ(header.code, 0) << header.err;
  EXPECT_EQ(header.out,
            "{\"nq\":3,\"nv\":3,\"mass\":8.5,\"joints\":[\"joint1_base_rotation\",\"joint2_shoulder\","
            "\"joint3_elbow\"]}\n");

  // upright the arm needs no effort; on the moon it needs a sixth of what it needs here
  const std::string lying = "{\"states\":[{\"q\":[0,0,0]},{\"q\":[0,1.5,0]}]}";
  const json earth = json::parse(run(std::string("eval ") + kArm, lying).out)["states"];
  const json moon = json::parse(run(std::string("eval --gravity 0,0,-1.635 ") + kArm, lying).out)["states"];
  EXPECT_NEAR(earth[0]["g"][1].get<double>(), 0, 1e-14);
  EXPECT_GT(std::abs(earth[1]["g"][1].get<double>()), 1);
  EXPECT_NEAR(moon[1]["g"][1].get<double>(), earth[1]["g"][1].get<double>() / 6, 1e-13);

  const Result half = run(std::string("eval ") + kArm, "{\"states\":[{\"q\":[0]},{\"q\":[0,0,0]}]}");
  EXPECT_EQ(half.code, 1);
  EXPECT_EQ(half.err, "lab-model: state 0: q has 1 numbers, expected 3\n");
  EXPECT_TRUE(json::parse(half.out)["states"][1].contains("M"));

  const Result frame = run(std::string("eval ") + kArm, "{\"frames\":[\"tool\"]}");
  EXPECT_EQ(frame.code, 2);
  EXPECT_TRUE(frame.err.starts_with("lab-model: model 'simple_3dof_arm': frame 'tool' does not exist"))
      << frame.err;
  EXPECT_EQ(frame.out, "");
  EXPECT_EQ(run(std::string("eval ") + kArm, "[").code, 2);
}

TEST_F(Program, UsageErrorsAreTwoAndBadRobotsThree) {
  EXPECT_EQ(run("").code, 2);
  EXPECT_EQ(run("info").code, 2);
  EXPECT_EQ(run("shake builtin:manipulator").code, 2);
  const Result gravity = run("info builtin:manipulator --gravity 0,0");
  EXPECT_EQ(gravity.code, 2);
  EXPECT_EQ(gravity.err, "lab-model: --gravity: '0,0' is not x,y,z in m/s2, such as 0,0,-9.81\n");
  for (const char* verb : {"info", "tree", "eval", "check"}) {
    EXPECT_EQ(run(std::string(verb) + " --help").code, 0);
    EXPECT_NE(run(std::string(verb) + " --help").out.find("example: lab-model "), std::string::npos);
    const Result unknown = run(std::string(verb) + " builtin:arm");
    EXPECT_EQ(unknown.code, 3);
    EXPECT_EQ(unknown.err,
              "builtin:arm: is not known; builtin are builtin:manipulator and builtin:humanoid\n");
    EXPECT_EQ(run(std::string(verb) + " package://nobody/x.urdf").code, 3);
  }
}

// package:// is looked for in LAB_PACKAGE_PATH
TEST_F(Program, PackagesAreFound) {
  std::filesystem::create_directories(folder_ / "bots");
  const std::string at = file("bots/two.urdf", two_links(kLimit));
  setenv("LAB_PACKAGE_PATH", folder_.c_str(), 1);
  const Result found = run("info --json package://bots/two.urdf");
  unsetenv("LAB_PACKAGE_PATH");
  ASSERT_EQ(found.code, 0) << found.err;
  EXPECT_EQ(json::parse(found.out)["file"], at);
}

}  // namespace
