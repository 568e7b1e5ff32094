// lab-model eval: what it prints must agree with itself by other roads, and with the library bit for bit.
#include "lab/model/eval.h"

#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include <cmath>
#include <functional>

#include "lab/model/robot.h"

namespace lab::model {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;
using nlohmann::json;

rbd::Model robot(const std::string& name) { return load(name, {}).model; }

json list(const VectorXd& x) { return std::vector<double>(x.data(), x.data() + x.size()); }

VectorXd vector(const json& in) {
  const auto numbers = in.get<std::vector<double>>();
  return Eigen::Map<const VectorXd>(numbers.data(), static_cast<Eigen::Index>(numbers.size()));
}

MatrixXd matrix(const json& in) {
  MatrixXd out(in.size(), in.empty() ? 0 : in[0].size());
  for (Eigen::Index r = 0; r < out.rows(); ++r) out.row(r) = vector(in[static_cast<size_t>(r)]).transpose();
  return out;
}

struct Point {
  VectorXd q, v, a, tau;
};

Point point_of(const rbd::Model& model, unsigned seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> even(-1, 1);
  const auto some = [&] { return VectorXd::NullaryExpr(model.nv, [&] { return even(engine); }).eval(); };
  Point p{rbd::randomConfiguration(model, engine), some(), some(), some()};
  p.tau *= 10;
  return p;
}

// through text, as a reader gets it
json evaluated(const rbd::Model& model, const Point& p, const std::vector<std::string>& frames) {
  const json in{{"states", {{{"q", list(p.q)}, {"v", list(p.v)}, {"a", list(p.a)}, {"tau", list(p.tau)}}}},
                {"frames", frames}};
  const Evaluation done = evaluate(model, parse(in.dump()));
  EXPECT_TRUE(done.errors.empty()) << done.errors[0];
  return parse(done.out.dump())["states"][0];
}

void near(const MatrixXd& seen, const MatrixXd& wanted, double relative, const std::string& what) {
  ASSERT_EQ(seen.rows(), wanted.rows()) << what;
  ASSERT_EQ(seen.cols(), wanted.cols()) << what;
  EXPECT_LE((seen - wanted).cwiseAbs().maxCoeff(), relative * std::max(1.0, wanted.cwiseAbs().maxCoeff()))
      << what;
}

struct Case {
  const char *robot, *frame;
};

class Eval : public testing::TestWithParam<Case> {
 protected:
  const rbd::Model model = robot(GetParam().robot);
  const std::string frame = GetParam().frame;
  const Point p = point_of(model, 5);
  const json s = evaluated(model, p, {frame});
};
INSTANTIATE_TEST_SUITE_P(Robots, Eval,
                         testing::Values(Case{"builtin:manipulator", "arm_tool_link"},
                                         Case{"builtin:humanoid", "right_wrist_pitch_body"}));

// sums of at most 40 products of numbers up to `scale`: 1e-12 is 100 times what rounding can do to them
TEST_P(Eval, AgreesWithItself) {
  const MatrixXd M = matrix(s["M"]), Minv = matrix(s["Minv"]), C = matrix(s["C"]);
  const VectorXd nle = vector(s["nle"]), g = vector(s["g"]), com = vector(s["com"]), vcom = vector(s["vcom"]);
  const double condition = M.norm() * Minv.norm();
  near(M, M.transpose(), 0, "M is symmetric");
  near(M * Minv, MatrixXd::Identity(model.nv, model.nv), 1e-14 * condition, "M Minv");
  near(vector(s["tau"]), M * p.a + nle, 1e-12, "tau");
  near(M * vector(s["ddq"]) + nle, p.tau, 1e-14 * condition, "ddq");
  near(C * p.v, nle - g, 1e-12, "C v");
  near(vector(s["hg"]), matrix(s["Ag"]) * p.v, 1e-12, "hg");
  near(vcom, matrix(s["Jcom"]) * p.v, 1e-12, "vcom");
  EXPECT_NEAR(s["kinetic"].get<double>(), 0.5 * p.v.dot(M * p.v), 1e-12 * M.norm());

  double mass = 0;
  for (int j = 1; j < model.njoints; ++j) mass += model.inertias[j].mass();
  near(vector(s["hg"]).tail(3), mass * vcom, 1e-12, "linear momentum");
  EXPECT_NEAR(s["potential"].get<double>(), 9.81 * mass * com[2], 1e-12 * 9.81 * mass);
  near(
      matrix(s["ddq_dq"]),
      -Minv *
          [&] {  // at the acceleration that tau gives, rnea's derivatives and aba's are one
            Point same = p;
            same.a = vector(s["ddq"]);
            return matrix(evaluated(model, same, {})["dtau_dq"]);
          }(),
      1e-14 * condition * condition, "ddq_dq");

  const json& f = s["frames"][frame];
  for (const char* reference : {"WORLD", "LOCAL", "LOCAL_WORLD_ALIGNED"})
    near(vector(f["velocity"][reference]), matrix(f["J"][reference]) * p.v, 1e-12, reference);
  // the same vector in other axes, about another point
  const rbd::SE3 pose(Eigen::Matrix4d(matrix(s["oMf"][frame])));
  const auto motion = [&](const char* what, const char* reference) {
    return rbd::Motion(rbd::Vector6d(vector(f[what][reference])));
  };
  const rbd::SE3 turn(pose.rotation(), Eigen::Vector3d::Zero());
  for (const char* what : {"velocity", "acceleration"}) {
    near(pose.act(motion(what, "LOCAL")).toVector(), motion(what, "WORLD").toVector(), 1e-12, what);
    near(turn.act(motion(what, "LOCAL")).toVector(), motion(what, "LOCAL_WORLD_ALIGNED").toVector(), 1e-12,
         what);
  }
}

// Rates by central differences of eval itself along the motion (v, a): error h^2 times the third derivative
// (some hundreds here) plus eps scale / h, both below 1e-7 of the scale at h = 1e-5.
TEST_P(Eval, RatesAndDerivativesAreThoseOfTheNumbers) {
  constexpr double h = 1e-5, kTolerance = 1e-7;
  const auto later = [&](double t) {
    Point at = p;
    at.q = rbd::integrate(model, p.q, t * p.v + 0.5 * t * t * p.a), at.v = p.v + t * p.a;
    return evaluated(model, at, {frame});
  };
  const json after = later(h), before = later(-h);
  const auto rate = [&](const std::function<VectorXd(const json&)>& of) {
    return VectorXd((of(after) - of(before)) / (2 * h));
  };
  const json& f = s["frames"][frame];
  near(vector(s["vcom"]), rate([](const json& x) { return vector(x["com"]); }), kTolerance, "vcom");
  near(vector(s["dhg"]), rate([](const json& x) { return vector(x["hg"]); }), kTolerance, "dhg");
  for (const char* reference : {"WORLD", "LOCAL"})  // spatial acceleration: the rate of spatial velocity
    near(vector(f["acceleration"][reference]),
         rate([&](const json& x) { return vector(x["frames"][frame]["velocity"][reference]); }), kTolerance,
         reference);
  near(vector(f["classical_acceleration"]["LOCAL_WORLD_ALIGNED"]),
       rate([&](const json& x) { return vector(x["frames"][frame]["velocity"]["LOCAL_WORLD_ALIGNED"]); }),
       kTolerance, "classical");
  const MatrixXd dM = (matrix(after["M"]) - matrix(before["M"])) / (2 * h), skew = dM - 2 * matrix(s["C"]);
  near(skew, -skew.transpose(), kTolerance * 10, "dM/dt - 2C is skew");

  // one dof after the other, in tangent space
  for (const auto& [value, by_q, by_v] :
       {std::array{"tau", "dtau_dq", "dtau_dv"}, std::array{"ddq", "ddq_dq", "ddq_dv"}}) {
    const double scale = std::max(1.0, matrix(s[by_q]).cwiseAbs().maxCoeff());
    for (int k = 0; k < model.nv; k += 1 + model.nv / 7) {
      const VectorXd step = h * VectorXd::Unit(model.nv, k);
      std::array<VectorXd, 4> ends;
      for (int side : {0, 1}) {
        Point moved = p, faster = p;
        moved.q = rbd::integrate(model, p.q, side ? step : -step), faster.v += side ? step : -step;
        ends[side] = vector(evaluated(model, moved, {})[value]),
        ends[2 + side] = vector(evaluated(model, faster, {})[value]);
      }
      near(matrix(s[by_q]).col(k), (ends[1] - ends[0]) / (2 * h), kTolerance * scale, by_q);
      near(matrix(s[by_v]).col(k), (ends[3] - ends[2]) / (2 * h), kTolerance * scale, by_v);
    }
  }
}

TEST_P(Eval, TextHoldsTheLibrarysDoubles) {
  rbd::Data data(model);
  EXPECT_EQ(matrix(s["M"]), MatrixXd(rbd::crba(model, data, p.q)));
  EXPECT_EQ(vector(s["ddq"]), rbd::aba(model, data, p.q, p.v, p.tau));
  rbd::forwardKinematics(model, data, p.q);
  for (int j = 0; j < model.njoints; ++j)
    EXPECT_EQ(matrix(s["oMi"][model.names[j]]), MatrixXd(data.oMi[j].toHomogeneousMatrix()))
        << model.names[j];
  for (int i = 0; i < model.nframes; ++i) {
    const int first = model.frameId(model.frames[i].name);
    EXPECT_EQ(matrix(s["oMf"][model.frames[i].name]), MatrixXd(data.oMf[first].toHomogeneousMatrix()));
  }
}

TEST(EvalInput, NoStatesGiveTheHeader) {
  const json out = evaluate(robot("builtin:humanoid"), json::object()).out;
  EXPECT_EQ(out["nq"], 37);
  EXPECT_EQ(out["nv"], 36);
  EXPECT_EQ(out["joints"].size(), 31u);  // the free-flyer and 30 others
  EXPECT_FALSE(out.contains("states"));
}

TEST(EvalInput, MissingIsZero) {
  const rbd::Model model = robot("builtin:manipulator");
  const Point p = point_of(model, 1);
  const VectorXd zero = VectorXd::Zero(6);
  const Evaluation bare = evaluate(model, {{"states", {{{"q", list(p.q)}}}}});
  EXPECT_EQ(json(bare.out["states"][0]), evaluated(model, {p.q, zero, zero, zero}, {}));
  near(vector(bare.out["states"][0]["tau"]), vector(bare.out["states"][0]["g"]), 1e-13, "at rest");
}

TEST(EvalInput, BadStatesLeaveTheOthersAlone) {
  const rbd::Model model = robot("builtin:manipulator");
  const json good{{"q", {0, 0, 0, 0, 0, 0}}};
  const json in{{"states",
                 {good,
                  {{"q", {1, 2}}},
                  json::object(),
                  {{"q", {0, 0, 0, 0, 0, "x"}}},
                  {{"q", 3}},
                  7,
                  {{"q", good["q"]}, {"v", {1}}},
                  {{"q", good["q"]}, {"v", {1e200, 1e200, 0, 0, 0, 0}}},
                  good}}};
  const Evaluation done = evaluate(model, in);
  const json& states = done.out["states"];
  ASSERT_EQ(states.size(), 9u);
  EXPECT_EQ(states[0], states[8]);
  EXPECT_TRUE(states[0].contains("M"));
  const char* wanted[] = {"q has 2 numbers, expected 6",
                          "q is missing, expected 6 numbers",
                          "q[5] is \"x\", not a number",
                          "q is 3, expected a list of 6 numbers",
                          "is 7, expected an object with q, v, a, tau",
                          "v has 1 numbers, expected 6"};
  for (size_t k = 0; k < std::size(wanted); ++k) EXPECT_EQ(states[k + 1], json({{"error", wanted[k]}}));
  EXPECT_NE(states[7]["error"].get<std::string>().find("too large"), std::string::npos) << states[7];
  ASSERT_EQ(done.errors.size(), 7u);
  EXPECT_EQ(done.errors[0], "state 1: q has 2 numbers, expected 6");
}

TEST(EvalInput, ASingularRobotIsNamedNotNaN) {
  rbd::Model model;
  model.addJoint(0, rbd::JointModelRZ(), rbd::SE3(), "empty");
  const Evaluation done = evaluate(model, {{"states", {{{"q", {0.1}}}}}});
  ASSERT_EQ(done.errors.size(), 1u);
  EXPECT_NE(done.errors[0].find("empty"), std::string::npos) << done.errors[0];
}

std::string refusal(const std::function<void()>& asked) {
  try {
    asked();
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST(EvalInput, WhatNoStateCanBear) {
  const rbd::Model model = robot("builtin:manipulator");
  EXPECT_EQ(refusal([&] { evaluate(model, json::array()); }),
            "the input is [], expected an object with states and frames");
  EXPECT_EQ(refusal([&] { evaluate(model, {{"states", 1}}); }), "states is 1, expected a list");
  EXPECT_EQ(refusal([&] { evaluate(model, {{"frames", "x"}}); }),
            "frames is \"x\", expected a list of names");
  EXPECT_NE(refusal([&] {
              evaluate(model, {{"frames", {"arm_tol_link"}}});
            }).find("'arm_tol_link' does not exist; near names: arm_tool_link"),
            std::string::npos);
  for (const char* text : {"", "{\"states\": [", "{\"q\": NaN}", "{\"q\": 1e999}"}) {
    const std::string line = refusal([&] { parse(text); });
    EXPECT_TRUE(line.starts_with("the input is not JSON: ")) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
  EXPECT_EQ(evaluate(model, {{"states", {{{"q", {0, 0, 0, 0, 0, 0}}, {"tua", 1}}}}}).warnings,
            std::vector<std::string>{"state 0: 'tua' is not read (q, v, a, tau are)"});
}

}  // namespace
}  // namespace lab::model
