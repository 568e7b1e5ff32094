// The two robots that need no file, and what changes when one of them floats.
//
// A free-flyer's place takes seven numbers (position and unit quaternion) but moves in six ways. So nq is not
// nv, q + v makes no sense, and random numbers are no configuration: integrate, difference and
// randomConfiguration are for that.
#include <rbd/rbd.h>

#include <cmath>
#include <iostream>

#include "roads.h"

int main() {
  rbd::Model arm, human;
  rbd::buildModels::manipulator(arm);
  rbd::buildModels::humanoid(human);
  rbd::Data arm_data(arm);  // two ways to the same scratch paper
  auto data = human.createData();
  std::cout << arm.name << ": nq " << arm.nq << ", nv " << arm.nv << "\n";
  std::cout << human.name << ": nq " << human.nq << ", nv " << human.nv << ", first joint "
            << human.joints[1].shortname() << "\n";

  Roads roads;
  std::mt19937_64 engine(3);
  const Eigen::VectorXd a = rbd::randomConfiguration(human, engine),
                        b = rbd::randomConfiguration(human, engine);
  roads.compare("length of a random quaternion, 1", a.segment<4>(3).norm(), 1, 1e-14);

  // the velocity that leads from a to b leads from a to b, in one step or in ten
  const Eigen::VectorXd v = rbd::difference(human, a, b);
  Eigen::VectorXd walked = a;
  for (int k = 0; k < 10; ++k) walked = rbd::integrate(human, walked, v / 10);
  roads.compare("ten steps of difference(a, b), b", rbd::distance(human, walked, b), 0, 1e-13);
  roads.compare("half way, from either end",
                rbd::distance(human, rbd::interpolate(human, a, b, 0.5), rbd::interpolate(human, b, a, 0.5)),
                0, 1e-13);
  // naive subtraction has the wrong length altogether
  std::cout << "difference has " << v.size() << " entries, b - a has " << (b - a).size() << "\n";

  // left and right are mirror images, so at neutral the centre of mass lies in the middle plane
  const Eigen::Vector3d com = rbd::centerOfMass(human, data, rbd::neutral(human));
  std::cout << "humanoid: " << data.mass[0] << " kg, centre of mass at " << com.transpose() << "\n";
  roads.compare("sideways place of the centre of mass, 0", com.y(), 0, 1e-14);

  // joints may follow others: knees and ankles follow the hips, so that one number a leg makes a level foot
  // go up
  rbd::Model squats;
  rbd::buildModels::humanoid(squats, true);
  rbd::Data legs(squats);
  std::cout << "with mimic joints: nq " << squats.nq << ", nv " << squats.nv << "\n";
  Eigen::VectorXd pose = rbd::neutral(squats);
  pose[squats.joints[squats.jointId("left_hip_pitch")].idx_q()] = 0.6;
  rbd::forwardKinematics(squats, legs, pose);
  const double height = legs.oMi[squats.jointId("left_ankle_roll")].translation().z();
  roads.compare("ankle of a bent leg, cosines of thigh and shin", height,
                -0.08 - (0.38 + 0.36) * std::cos(0.6), 1e-14);

  // the arm has no quaternion: there q + v is right, and integrate does the same
  const Eigen::VectorXd q = rbd::randomConfiguration(arm, engine), w = rbd::randomConfiguration(arm, engine);
  roads.compare("arm: integrate(q, w), q + w", rbd::integrate(arm, q, w), q + w, 1e-14);
  return roads.exit_code();
}
