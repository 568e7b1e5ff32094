// A robot is a Model (what it is: joints, lengths, masses) and a Data (scratch paper for one thread).
//
// Every algorithm reads the Model, takes numbers for the joints, and leaves its answer in the Data.
#include <rbd/rbd.h>

#include <iostream>

#include "roads.h"

int main() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);  // a six-axis arm that needs no file
  rbd::Data data(model);

  std::cout << "model " << model.name << ": " << model.njoints << " joints, nq " << model.nq << ", nv "
            << model.nv << ", " << model.nframes << " frames, " << model.nbodies << " bodies\n";

  // joint 0 is the universe, to which the robot is bolted: that is why there are 7 and not 6
  int nq = 0;
  for (rbd::JointIndex i = 0; i < model.njoints; ++i) {
    const rbd::JointModel& joint = model.joints[i];
    std::cout << "  joint " << i << "  " << joint.shortname() << "  nq " << joint.nq() << "  nv "
              << joint.nv() << "  " << model.names[i] << "\n";
    nq += joint.nq();
  }
  for (const rbd::Frame& frame : model.frames) {
    std::cout << "  frame " << frame.name << " (" << rbd::frameTypeName(frame.type) << ") moves with "
              << model.names[frame.parentJoint] << "\n";
  }

  // the mass, added up by hand and by an algorithm that leaves it in the Data
  double mass = 0;
  for (rbd::JointIndex i = 1; i < model.njoints; ++i) mass += model.inertias[i].mass();
  rbd::centerOfMass(model, data, rbd::neutral(model));
  std::cout << "moving mass " << data.mass[0] << " kg, centre of mass " << data.com[0].transpose() << "\n";

  Roads roads;
  roads.compare("nq: of the model, summed over its joints", model.nq, nq, 0);
  roads.compare("mass: by the algorithm, summed over the links", data.mass[0], mass, 1e-13);
  return roads.exit_code();
}
