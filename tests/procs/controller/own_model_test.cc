// Models that are wrong on purpose, against robots that are really built that way.
#include "procs/controller/own_model.h"

#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include "core/util/number.h"
#include "lab/experiment/robot.h"
#include "procs/controller/controller.h"
#include "tests/support/refusal.h"

namespace lab::controller {
namespace {

std::string link(const std::string& name, double mass, const std::string& centre) {
  const std::string m = number(mass), i = number(0.01 * mass);
  return "<link name='" + name + "'><inertial><origin xyz='" + centre + "' rpy='0.1 0.2 0.3'/><mass value='" +
         m + "'/><inertia ixx='" + i + "' iyy='" + i + "' izz='" + number(0.004 * mass) +
         "' ixy='0' ixz='0' iyz='0'/></inertial></link>";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child) {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" +
         child + "'/><origin xyz='0.3 0.05 0.1' rpy='0.4 -0.3 0.2'/><axis xyz='0 1 0'/>" +
         (type == "fixed" ? "" : "<limit lower='-2' upper='2' effort='50' velocity='3'/>") + "</joint>";
}

/// Two joints; a tool is welded to the forearm.
std::string arm(const std::string& tool_centre, bool with_tool = true) {
  return "<robot name='arm'>" + link("base", 5, "0 0 0") + link("upper", 2, "0.1 0 0.02") +
         link("forearm", 1, "0.15 0.01 0") + joint("shoulder", "revolute", "base", "upper") +
         joint("elbow", "revolute", "upper", "forearm") +
         (with_tool ? link("tool", 0.7, tool_centre) + joint("flange", "fixed", "forearm", "tool") : "") +
         "</robot>";
}

rbd::Model model_of(const std::string& urdf) {
  Experiment e;
  e.robot.model = "urdf";
  return load_robot(e, urdf).model;
}

void expect_same(const rbd::Model& a, const rbd::Model& b) {
  ASSERT_EQ(a.njoints, b.njoints);
  for (int j = 1; j < a.njoints; ++j)
    EXPECT_LT((a.inertias[j].matrix() - b.inertias[j].matrix()).cwiseAbs().maxCoeff(), 1e-14) << a.names[j];
}

TEST(OwnModel, WithoutTheToolIsARobotBuiltWithoutIt) {
  Experiment e;
  e.controller.model.without = {"tool"};
  expect_same(own_model(e, model_of(arm("0.05 0 0.1"))), model_of(arm("", false)));
}

TEST(OwnModel, AShiftedCentreIsARobotBuiltThatWay) {
  Experiment e;
  e.controller.model.com_shift["tool"] = {0.01, -0.02, 0.03};
  expect_same(own_model(e, model_of(arm("0.05 0 0.1"))), model_of(arm("0.06 -0.02 0.13")));
}

TEST(OwnModel, AJointStandsForAllThatMovesWithIt) {
  const rbd::Model right = model_of(arm("0.05 0 0.1"));
  Experiment e;
  e.controller.model.com_shift["elbow"] = {0.01, 0, 0};
  const rbd::Model off = own_model(e, right);
  EXPECT_LT((off.inertias[2].lever() - right.inertias[2].lever() - Eigen::Vector3d(0.01, 0, 0)).norm(),
            1e-15);
  EXPECT_NEAR(off.inertias[2].mass(), 1.7, 1e-14);
  e.controller.model.com_shift.clear();
  e.controller.model.without = {"elbow"};
  EXPECT_EQ(own_model(e, right).inertias[2].matrix(), rbd::Matrix6d::Zero());
  e.controller.model.without = {"tool", "forearm"};  // one after the other: nothing is left either
  EXPECT_EQ(own_model(e, right).inertias[2].matrix(), rbd::Matrix6d::Zero());
  e.controller.model.without.clear();
  e.controller.model.mass_scale = 1.5;
  for (int j = 1; j < 3; ++j) EXPECT_TRUE(own_model(e, right).inertias[j].isApprox(right.inertias[j] * 1.5));
}

// the gravity that it does not bear is the tool's weight at its lever: m g times the horizontal way to its centre
TEST(OwnModel, TheMissingToolsWeightIsMissing) {
  const rbd::Model right = model_of(arm("0.05 0 0.1"));
  Experiment e;
  e.controller.kind = "pd_gravity";
  RobotState s{.step = 0,
               .time = 0,
               .q = Eigen::Vector2d(0.3, -0.4),
               .v = Eigen::Vector2d::Zero(),
               .tau = Eigen::Vector2d::Zero()};
  const Reference r{.step = 0, .q = s.q, .v = s.v, .a = s.v};
  const auto tau = [&](const Experiment& experiment, const Eigen::VectorXd& q) {
    const Config config = make_config(experiment, right);
    State state = initial(config);
    s.q = q;
    return step(config, state, {.state = s, .reference = {.step = 0, .q = q, .v = r.v, .a = r.a}})
        .command.tau;
  };
  const auto height = [&](const Eigen::VectorXd& q) {
    rbd::Data data(right);
    rbd::forwardKinematics(right, data, q);
    return data.oMf[right.frameId("tool")].act(Eigen::Vector3d(0.05, 0, 0.1)).z();
  };
  const Eigen::VectorXd q = s.q, all = tau(e, q);
  e.controller.model.without = {"tool"};
  const Eigen::VectorXd some = tau(e, q);
  for (int i = 0; i < 2; ++i) {
    const Eigen::VectorXd by = 1e-5 * Eigen::VectorXd::Unit(2, i);
    EXPECT_NEAR(all[i] - some[i], 0.7 * 9.81 * (height(q + by) - height(q - by)) / 2e-5, 1e-8);  // h^2
  }
}

std::string refusal(const rbd::Model& model, const std::vector<std::string>& without,
                    const std::string& shifted = "") {
  Experiment e;
  e.file = "x.yaml";
  e.controller.model.without = without;
  if (!shifted.empty()) e.controller.model.com_shift[shifted] = {0, 0, 0.1};
  return test::refusal_of([&] { own_model(e, model); });
}

TEST(OwnModel, RefusesWhatIsNoBody) {
  const rbd::Model model = model_of(arm("0.05 0 0.1"));
  const std::string without = "x.yaml: controller.model.without[0]: ",
                    shift = "x.yaml: controller.model.com_shift.";
  EXPECT_EQ(refusal(model, {"tol"}), without + "'arm' has no link or joint 'tol'; did you mean 'tool'?");
  EXPECT_EQ(
      refusal(model, {"gearbox"}),
      without + "'arm' has no link or joint 'gearbox'; bodies are upper, forearm, tool, shoulder, elbow");
  EXPECT_EQ(refusal(model, {"base"}), without + "'base' is fixed to the ground; its mass moves nothing");
  EXPECT_EQ(refusal(model, {"tool", "tool"}), "x.yaml: controller.model.without[1]: 'tool' is given twice");
  EXPECT_EQ(refusal(model, {}, "elbwo"),
            shift + "elbwo: 'arm' has no link or joint 'elbwo'; did you mean 'elbow'?");
  EXPECT_EQ(refusal(model, {"tool"}, "tool"),
            shift + "tool: is taken away by controller.model.without; keep one of them");
  EXPECT_EQ(refusal(model, {"elbow"}, "tool"),
            shift + "tool: is taken away by controller.model.without; keep one of them");
  rbd::Model builtin;
  rbd::buildModels::manipulator(builtin);
  EXPECT_TRUE(
      refusal(builtin, {"wrist_body"})
          .starts_with(without + "'wrist_body' has no mass of its own; bodies are joint1_base_yaw, "));
}

}  // namespace
}  // namespace lab::controller
