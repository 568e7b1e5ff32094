// Reading and writing experiments: what is refused and how it is said, and texts that come back the same.
#include "lab/experiment/experiment_yaml.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <random>
#include <sstream>

#include "lab/experiment/keys.h"
#include "tests/support/paths.h"
#include "tests/support/refusal.h"

namespace lab {
namespace {

std::string error_of(const std::string& text, const std::vector<std::string>& set = {}) {
  return test::refusal_of([&] { parse_experiment(text, "x.yaml", set); });
}

// Nine lists of nine aliases each: some 400 bytes that stand for 9^9 values.
TEST(ExperimentYaml, AliasesThatStandForTooMuchAreRefusedAtOnce) {
  std::string text = "robot: {model: m}\na0: &a0 [1,1,1,1,1,1,1,1,1]\n";
  for (int i = 1; i < 9; ++i) {
    const std::string below = "*a" + std::to_string(i - 1);
    text += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" + below;
    for (int k = 1; k < 9; ++k) text += "," + below;
    text += "]\n";
  }
  EXPECT_EQ(error_of(text),
            "x.yaml: stands for more than 100000 values or 64 levels once its aliases are replaced: write "
            "less of it");
  const std::string deep(70, '[');
  EXPECT_NE(error_of("robot: {model: m}\na: " + deep + std::string(70, ']')).find("64 levels"),
            std::string::npos);
}

struct Case {
  const char* text;
  const char* message;
};

// "robot.model" is line 1 of every text unless the case is about it
constexpr Case kRefused[] = {
    {"", "x.yaml: robot.model is missing; name a robot, for example builtin:manipulator"},
    {"[1, 2]", "x.yaml:1: must be a map of sections (robot:, simulator:, ..)"},
    {"robot: {model: m}\nname: [", "x.yaml:2: not YAML: end of sequence flow not found"},
    {"robot: {model: m}\nsimulator:\n\tdt: 1\n", "x.yaml:3: not YAML: begins with a tab; indent with spaces"},
    {"robot: {model: m}\nsimulator:\n  dt: 1\n   duration: 2\n",
     "x.yaml:4: not YAML: illegal map value; is it indented like the lines around it?"},
    {"robot: {model: m}\ncontroler:\n  kind: pd\n  kp: 5\n",
     "x.yaml:2: unknown section 'controler'; did you mean 'controller'?"},
    {"robot: {model: m}\ncontroller:\n  kp: 5\n  modell:\n    mass_scale: 2\n",
     "x.yaml:4: unknown section 'controller.modell'; did you mean 'controller.model'?"},
    {"robot: {model: m}\ncontroller:\n  kq: 5\n",
     "x.yaml:3: unknown key 'controller.kq'; did you mean 'controller.kp'?"},
    {"robot: {model: m}\nkp: 5\n", "x.yaml:2: unknown key 'kp'; did you mean 'controller.kp'?"},
    {"robot: {model: m}\nwhatever: 5\n", "x.yaml:2: unknown key 'whatever'"},
    {"robot: {model: m}\nseed: 1\nseed: 2\n", "x.yaml:3: key 'seed' is given twice; keep one"},
    {"robot: {model: m}\nplanner: 5\n", "x.yaml:2: 'planner' is a section; put keys under it, not '5'"},
    {"robot:\n  model: m\n  model:\n", "x.yaml:3: key 'robot.model' is given twice; keep one"},
    {"robot:\n  model:\n", "x.yaml:2: robot.model: is empty; give a value or remove the key"},
    {"robot: {model: m}\nsimulator:\n  dt: 0\n",
     "x.yaml:3: simulator.dt: 0 is too small; give at least 1e-06 (s)"},
    {"robot: {model: m}\nsimulator:\n  dt: 9.9e-7\n",
     "x.yaml:3: simulator.dt: 9.9e-07 is too small; give at least 1e-06 (s)"},
    {"robot: {model: m}\nsimulator:\n  dt: -0.01\n",
     "x.yaml:3: simulator.dt: -0.01 is too small; give at least 1e-06 (s)"},
    {"robot: {model: m}\nsimulator:\n  dt: fast\n", "x.yaml:3: simulator.dt: must be a number, not 'fast'"},
    {"robot: {model: m}\nsimulator:\n  dt: \"0.01\"\n",
     "x.yaml:3: simulator.dt: must be a number, not '0.01' in quotes"},
    {"robot: {model: m}\nsimulator:\n  dt: 0,01\n",
     "x.yaml:3: simulator.dt: must be a number, not '0,01'; a decimal comma: write 0.01"},
    {"robot: {model: m}\nsimulator:\n  dt: [0.01]\n", "x.yaml:3: simulator.dt: must be a number, not a list"},
    {"robot: {model: m}\nsimulator:\n  clock: sundial\n",
     "x.yaml:3: simulator.clock: 'sundial' is not known; use one of lockstep, realtime"},
    {"robot: {model: m}\nsimulator:\n  integrator: euler\n",
     "x.yaml:3: simulator.integrator: 'euler' is not known; use one of semi_implicit_euler, rk4"},
    {"robot: {model: m}\nsimulator:\n  gravity: [0, -9.81]\n",
     "x.yaml:3: simulator.gravity: must be a list of 3 numbers, not of 2"},
    {"robot: {model: m}\nsimulator:\n  damping: -1\n",
     "x.yaml:3: simulator.damping: -1 is too small; give at least 0 (Nm s/rad, N s/m)"},
    {"robot: {model: m}\nsimulator:\n  noise: {q: -0.1}\n",
     "x.yaml:3: simulator.noise.q: -0.1 is too small; give at least 0 (rad, m)"},
    {"robot: {model: m}\nsimulator:\n  delay: 2\n",
     "x.yaml:3: simulator.delay: 2 is too large; give at most 1 (s)"},
    {"robot: {model: m}\nsimulator:\n  pushes: {time: 1}\n",
     "x.yaml:3: simulator.pushes: must be a list of maps, not a map"},
    {"robot: {model: m}\nsimulator:\n  pushes: [1]\n",
     "x.yaml:3: simulator.pushes[0]: must be a map with time, duration, frame, force, torque, not '1'"},
    {"robot: {model: m}\nsimulator:\n  pushes:\n    - {duration: 1, frame: f, force: [1, 0, 0]}\n",
     "x.yaml:4: simulator.pushes[0].time: is missing"},
    {"robot: {model: m}\nsimulator:\n  pushes:\n    - time: -1\n      duration: 1\n      frame: f\n      "
     "force: [1, 0, 0]\n",
     "x.yaml:4: simulator.pushes[0].time: -1 is too small; give at least 0 (s)"},
    {"robot: {model: m}\nsimulator:\n  pushes:\n    - {time: 1, duration: 1, frame: f,\n       forse: [1, 0, "
     "0]}\n",
     "x.yaml:5: simulator.pushes[0].forse: is not known; did you mean 'force'?"},
    {"robot: {model: m}\nsimulator:\n  pushes:\n    - {time: 1, duration: 1, frame: f, force: [1, 0]}\n",
     "x.yaml:4: simulator.pushes[0].force: must be a list of 3 numbers, not of 2"},
    {"robot: {model: m}\nsimulator:\n  payloads:\n    - {time: 0, frame: f, mass: -1}\n",
     "x.yaml:4: simulator.payloads[0].mass: -1 is too small; give at least 0 (kg)"},
    {"robot: {model: m}\nsimulator:\n  payloads:\n    - {time: 0, frame: f, mass: 1, con: [0, 0, 1]}\n",
     "x.yaml:4: simulator.payloads[0].con: is not known; did you mean 'com'?"},
    {"robot: {model: m}\nsimulator:\n  limit_repulsion: {margin: -1}\n",
     "x.yaml:3: simulator.limit_repulsion.margin: -1 is too small; give at least 0 (rad, m)"},
    {"robot: {model: m}\nsimulator: {dt: 0.01, duration: 0.001}\n",
     "x.yaml: simulator.duration: 0.001 s is less than one step of 0.01 s"},
    {"robot: {model: m}\ncontroller:\n  kp: .nan\n", "x.yaml:3: controller.kp: must be finite, not '.nan'"},
    {"robot: {model: m}\ncontroller:\n  kp: nan\n",
     "x.yaml:3: controller.kp: must be a finite number, not 'nan'"},
    {"robot: {model: m}\ncontroller:\n  kp: [1, -.inf]\n",
     "x.yaml:3: controller.kp[1]: must be finite, not '-.inf'"},
    {"robot: {model: m}\ncontroller:\n  kp: 1e999\n",
     "x.yaml:3: controller.kp: must be a finite number, not '1e999'"},
    {"robot: {model: m}\ncontroller:\n  kp: []\n",
     "x.yaml:3: controller.kp: is an empty list; give one number per joint, or one for all"},
    {"robot: {model: m}\ncontroller:\n  kp:\n    elbow: 3\n    wrist: much\n",
     "x.yaml:5: controller.kp.wrist: must be a number, not 'much'"},
    {"robot: {model: m}\ncontroller:\n  kp: high\n",
     "x.yaml:3: controller.kp: must be a number, a list of numbers or a map joint: number, not 'high'"},
    {"robot: {model: m}\ncontroller: {every: 0}\n",
     "x.yaml:2: controller.every: 0 is too small; give at least 1 (steps)"},
    {"robot: {model: m}\ncontroller: {every: 129}\n",
     "x.yaml:2: controller.every: 129 is too large; give at most 128 (steps)"},
    {"robot: {model: m}\ncontroller: {every: 1.5}\n",
     "x.yaml:2: controller.every: must be a whole number, not '1.5'"},
    {"robot: {model: m}\nplanner: {lead: 129}\n",
     "x.yaml:2: planner.lead: 129 is too large; give at most 128 (steps)"},
    {"robot: {model: m}\nplanner: {lead: -1}\n",
     "x.yaml:2: planner.lead: -1 is too small; give at least 0 (steps)"},
    {"robot: {model: m}\nplanner:\n  targets: []\n",
     "x.yaml:3: planner.targets: must be a list of configurations, not empty"},
    {"robot: {model: m}\nplanner:\n  targets:\n    - [1, 2]\n    - 3\n",
     "x.yaml:5: planner.targets[1]: must be a list of numbers or a map joint: number, not '3'"},
    {"robot: {model: m}\nplanner:\n  targets:\n    - elbow: 1\n      wrist: much\n",
     "x.yaml:5: planner.targets[0].wrist: must be a number, not 'much'"},
    {"robot: {model: m}\nplanner:\n  times: 3\n",
     "x.yaml:3: planner.times: must be a list of numbers, not '3'"},
    {"robot: {model: m}\nplanner:\n  times:\n    - 1\n    - -2\n",
     "x.yaml:5: planner.times[1]: -2 is too small; give at least 1e-06 (s)"},
    {"robot: {model: m}\nplanner:\n  to: [1, 2]\n",
     "x.yaml:3: planner.to: must be a list of 3 numbers, not of 2"},
    {"robot: {model: m, mimic: yes}\n", "x.yaml:1: robot.mimic: must be true or false, not 'yes'"},
    {"robot: {model: m}\nrenderer:\n  size: [640]\n",
     "x.yaml:3: renderer.size: must be a list of 2 numbers, not of 1"},
    {"robot: {model: m}\nrenderer: {quality: best}\n",
     "x.yaml:2: renderer.quality: 'best' is not known; use one of draft, live, fine"},
    {"robot: {model: m}\nexpect:\n  max_error: 0.1\n",
     "x.yaml:3: expect.max_error: must be {max: x}, {min: x} or both, not '0.1'"},
    {"robot: {model: m}\nexpect:\n  max_error:\n    most: 0.1\n",
     "x.yaml:4: expect.max_error.most: a bound is min or max"},
    {"robot: {model: m}\nexpect:\n  max_error: {min: 2, max: 1}\n",
     "x.yaml:3: expect.max_error: min is above max"},
    {"robot: {model: m}\nprocesses:\n  Big One: x\n",
     "x.yaml:3: processes.Big One: a process is named with small letters, digits, - and _"},
    {"robot: {model: m}\nname: ../up\n",
     "x.yaml:2: name: '../up' cannot name a folder; leave out '/' and a leading '.'"},
    {"robot: {model: m}\nseed: 1\nsimulator: {dt: 0}\ncontroller: {kb: 1}\n",  // two faults, two lines
     "x.yaml:4: unknown key 'controller.kb'; did you mean 'controller.kp'?\n"
     "x.yaml:3: simulator.dt: 0 is too small; give at least 1e-06 (s)"},
};

TEST(ExperimentYaml, RefusesWithFileLineKeyAndValue) {
  for (const Case& c : kRefused) EXPECT_EQ(error_of(c.text), c.message) << c.text;
}

constexpr const char* kText =
    "robot:\n  model: builtin:manipulator\nplanner:\n  kind: cubic\n  goal: {elbow: 1}\ncontroller:\n  kp: "
    "50\n";

TEST(ExperimentYaml, OverridesWinAndAreNamedInErrors) {
  const Experiment e = parse_experiment(
      kText, "x.yaml",
      {"controller.kp=80", "planner.goal.wrist=-2", "expect.max_error.max=0.5", "simulator.dt=1e-2"});
  EXPECT_EQ(std::get<double>(e.controller.kp.value), 80);
  EXPECT_EQ(std::get<JointValues::Named>(e.planner.goal.value),
            (JointValues::Named{{"elbow", 1}, {"wrist", -2}}));
  EXPECT_EQ(e.expect.at("max_error").max, 0.5);
  EXPECT_EQ(parse_experiment(kText, "x", {"expect.max_error.elbow.min=1"}).expect.at("max_error.elbow").min,
            1);
  EXPECT_EQ(e.simulator.dt, 0.01);
  EXPECT_EQ(e.where.at("controller.kp"), "--set");
  EXPECT_EQ(e.where.at("planner.kind"), "x.yaml:4");

  const std::pair<const char*, const char*> refused[] = {
      {"controller.kp=nan", "--set: controller.kp: must be a finite number, not 'nan'"},
      {"controler.kp=1", "--set: unknown section 'controler'; did you mean 'controller'?"},
      {"controller.kp", "--set controller.kp: must look like controller.kp=80"},
      {"controller.kp=[1", "--set controller.kp: not a YAML value: end of sequence flow not found"},
      {"controller.kp.elbow=1", "--set controller.kp.elbow: 'kp' is not a map in x.yaml"},
      {"controller.kp=", "--set: controller.kp: is empty; give a value or remove the key"},
  };
  for (const auto& [set, message] : refused) EXPECT_EQ(error_of(kText, {set}), message) << set;
}

TEST(ExperimentYaml, DefaultsFollowTheRest) {
  const Experiment e =
      parse_experiment(kText, "some/where/reach.yaml", {"simulator.duration=3", "simulator.dt=0.01"});
  EXPECT_EQ(e.name, "reach");
  EXPECT_EQ(e.planner.duration, 3);
  EXPECT_EQ(e.last_step(), 300);
  EXPECT_EQ(parse_experiment(kText, "x", {"planner.duration=0"}).planner.duration, 0) << "the shortest";
  EXPECT_EQ(parse_experiment("robot: {model: m}\nsimulator: {dt: 0.3, duration: 1}", "x").last_step(), 3);
}

TEST(ExperimentYaml, MissingFileIsOneLine) {
  for (const char* file : {"/nowhere/x.yaml", "/"}) {
    try {
      load_experiment(file);
      ADD_FAILURE() << file;
    } catch (const ExperimentError& e) {
      EXPECT_TRUE(std::string(e.what()).starts_with(std::string(file) + ": cannot be read (")) << e.what();
    }
  }
}

// ---- texts that come back

/// Fills every member with something odd but allowed.
class Randomizer {
 public:
  explicit Randomizer(unsigned seed) : random_(seed) {}
  void operator()(const Key& key, double& x) { x = within(key); }
  void operator()(const Key& key, int64_t& x) { x = std::llround(std::clamp(within(key), -1e15, 1e15)); }
  void operator()(const Key&, bool& x) { x = random_() % 2; }
  void operator()(const Key& key, std::string& x) {
    const std::vector<std::string> odd{"builtin:manipulator",
                                       "package://a/b.urdf",
                                       "a \"quoted\" \\ word",
                                       "yes",
                                       "3",
                                       "~",
                                       "#no",
                                       "- x",
                                       "müll: {}"};
    const auto& words = key.words.empty() ? odd : key.words;
    x = words[random_() % words.size()];
    if (std::string(key.name) == "name") x = "n 1";
    if (std::string(key.name) == "robot.model") x = odd[random_() % 2];
  }
  template <class T, size_t n>
  void operator()(const Key& key, std::array<T, n>& x) {
    for (T& value : x) (*this)(key, value);
  }
  template <class T>
  void operator()(const Key& key, std::optional<T>& x) {
    if (random_() % 2) (*this)(key, x.emplace());
  }
  void operator()(const Key& key, std::vector<double>& x) {
    x.resize(random_() % 4);
    for (double& value : x) value = within(key);
  }
  void operator()(const Key& key, JointValues& x) {
    const int form = random_() % 4;
    if (form == 1) x.value = within(key);
    if (form == 2) x.value = std::vector<double>{within(key), within(key), 0.1, std::max(-0.0, key.min)};
    if (form == 3)
      x.value = JointValues::Named{{"elbow", within(key)}, {"true", 2}, {"left arm: 1", within(key)}};
  }
  void operator()(const Key& key, std::vector<JointValues>& x) {
    x.resize(random_() % 4);
    for (JointValues& value : x)
      while (!value.given() || value.value.index() == 1) (*this)(key, value);
  }
  template <HasParts T>
  void operator()(const Key&, std::vector<T>& x) {
    x.resize(random_() % 3);
    for (T& item : x) for_each_part(item, [this](const Key& part, auto& member) { (*this)(part, member); });
  }
  void operator()(const Key&, std::map<std::string, std::string>& x) {
    x = {{"controller", "python3 'my controller.py' --x \"1\""}};
  }
  void operator()(const Key& key, std::map<std::string, double>& x) {
    if (random_() % 2) x = {{"finger", within(key)}, {"3", 0.25}};
  }
  void operator()(const Key& key, std::map<std::string, std::array<double, 3>>& x) {
    if (random_() % 2) x = {{"tool", {within(key), 0, -0.1}}, {"3", {0.25, 0, within(key)}}};
  }
  void operator()(const Key&, std::vector<std::string>& x) {
    if (random_() % 2) x = {"tool", "left arm: 1", "3"};
  }
  void operator()(const Key& key, std::map<std::string, Bound>& x) {
    x = {{"max_error", {.min = {}, .max = 0.1}}, {"final_error.elbow", {.min = within(key), .max = {}}}};
  }

 private:
  double within(const Key& key) {
    const double least = std::max(key.min, -1e9), most = std::min(key.max, 1e9);
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  std::mt19937 random_;
};

TEST(ExperimentYaml, ResolvedTextGivesTheSameExperimentBack) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Experiment e;
    for_each_key(e, Randomizer(seed));
    e.simulator.dt = 0.001;
    e.simulator.duration = 7;
    const std::string text = resolve(e);
    const Experiment back = parse_experiment(text, "back.yaml");
    ASSERT_EQ(back, e) << seed << "\n" << text;
    ASSERT_EQ(resolve(back), text);
    ASSERT_EQ(canonical(back), canonical(e));
  }
}

TEST(ExperimentYaml, CanonicalTextKeepsWhatCountsAndNothingElse) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    Experiment e, other;
    for_each_key(e, Randomizer(seed));
    for_each_key(other, Randomizer(seed + 1000));
    e.simulator.dt = 0.001;
    e.simulator.duration = 7;
    const Experiment back = parse_experiment(canonical(e), "RUN");
    ASSERT_EQ(canonical(back), canonical(e));
    ASSERT_EQ(back.simulator, e.simulator);
    ASSERT_EQ(back.planner, e.planner);
    ASSERT_EQ(back.controller, e.controller);
    ASSERT_EQ(back.safety, e.safety);
    ASSERT_EQ(back.evaluation, e.evaluation);
    ASSERT_EQ(back.expect, e.expect);
    // what cannot change the log cannot change the text
    other.name = e.name;
    other.seed = e.seed;
    other.robot = e.robot;
    other.simulator = e.simulator;
    other.planner = e.planner;
    other.controller = e.controller;
    other.expect = e.expect;
    other.safety = e.safety;
    other.evaluation = e.evaluation;
    if (!other.robot.model.starts_with("builtin:")) other.robot.model = "/another/folder/robot.urdf";
    ASSERT_EQ(canonical(other), canonical(e));
  }
}

TEST(ExperimentYaml, TheLastBitOfAGainIsInTheText) {
  Experiment e = parse_experiment(kText, "x.yaml");
  const std::string before = canonical(e);
  e.controller.kp.value = std::nextafter(50.0, 51.0);
  EXPECT_NE(canonical(e), before);
  EXPECT_NE(resolve(e).find("kp: 50.00000000000001\n"), std::string::npos);
}

TEST(ExperimentYaml, DocumentListsEveryKey) {
  std::stringstream page;
  page << std::ifstream(lab::source_path("docs/experiments.md")).rdbuf();
  EXPECT_NE(page.str().find(key_table()), std::string::npos)
      << "docs/experiments.md is behind lab/experiment/keys.h; its table should be\n"
      << key_table();
}

}  // namespace
}  // namespace lab
