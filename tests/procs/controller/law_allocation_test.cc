// No law allocates once its state is there: counted in malloc itself, because Eigen does not go through operator new.
#include <gtest/gtest.h>
#include <rbd/rbd.h>

#include "procs/controller/controller.h"
#include "tests/support/malloc_hook.h"

namespace lab::controller {
namespace {

TEST(Laws, DoNotAllocate) {
#ifdef LAB_NO_MALLOC_HOOK
  GTEST_SKIP() << "sanitizers own malloc";
#endif
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  RobotState s;
  s.q = Eigen::VectorXd::LinSpaced(6, -0.6, 0.8);
  s.v = s.tau = Eigen::VectorXd::LinSpaced(6, 0.9, -0.5);
  const Reference r{.step = 0, .q = s.v, .v = s.q, .a = s.q};
  for (const Kind& kind : kinds()) {
    Experiment e;
    e.controller.kind = kind.name;
    e.controller.frame = "arm_tool_link";
    e.controller.stiffness = e.controller.damping = {0, 10};  // with a posture beside it
    e.controller.kp.value = e.controller.kd.value = e.controller.com_gain = 10;
    const Config config = make_config(e, model);
    State state = initial(config);
    Eigen::VectorXd tau(6);
    counting = true;
    kind.law(config, state, {.state = s, .reference = r}, tau);
    counting = false;
    EXPECT_EQ(allocations, 0) << kind.name;
    allocations = 0;
  }
  counting = true;  // the counter works
  Eigen::VectorXd copy = s.q;
  counting = false;
  EXPECT_GE(allocations, 1) << copy.size();
}

}  // namespace
}  // namespace lab::controller
