// Vectors, rotations and poses. A rotation matrix turns a vector; an SE3 turns a point and then shifts it.
#include <rbd/rbd.h>

#include <cmath>
#include <iostream>

#include "roads.h"

using Eigen::Matrix3d;
using Eigen::Vector3d;
using rbd::SE3;

int main() {
  Roads roads;

  // a quarter turn about z carries x onto y
  const double quarter = rbd::PI<double>() / 2;
  const Matrix3d Rz = rbd::exp3(quarter * Vector3d::UnitZ());
  std::cout << "Rz(90 deg) x = " << (Rz * Vector3d::UnitX()).transpose() << "\n";
  roads.compare("quarter turn of x about z, y", Rz * Vector3d::UnitX(), Vector3d::UnitY(), 1e-14);

  // thirty degrees about x, worked out by hand: y goes to (0, cos, sin)
  const double angle = rbd::PI<double>() / 6;
  const Matrix3d Rx = rbd::exp3(angle * Vector3d::UnitX());
  const Vector3d by_hand(0, std::cos(angle), std::sin(angle));
  roads.compare("Rx(30 deg) y, by hand", Rx * Vector3d::UnitY(), by_hand, 1e-14);
  roads.compare("Rx(30 deg), Eigen's AngleAxis", Rx,
                Eigen::AngleAxisd(angle, Vector3d::UnitX()).toRotationMatrix(), 1e-14);
  roads.compare("inverse of a rotation, its transpose", Rx.inverse(), Rx.transpose(), 1e-14);

  // composition reads from right to left: first b, then Rz, then a
  const SE3 a(Matrix3d::Identity(), Vector3d(1, 0, 0)), turn(Rz, Vector3d::Zero()), b(Rx, Vector3d(0, 2, 0));
  const SE3 all = a * turn * b;
  const Vector3d point(0.1, 0.2, 0.3);
  std::cout << "a * turn * b =\n" << all.toHomogeneousMatrix() << "\n";
  roads.compare("product acting, one after the other", all.act(point), a.act(turn.act(b.act(point))), 1e-14);
  roads.compare("product, product of 4x4 matrices", all.toHomogeneousMatrix(),
                a.toHomogeneousMatrix() * turn.toHomogeneousMatrix() * b.toHomogeneousMatrix(), 1e-14);
  roads.compare("pose times inverse, identity", (all * all.inverse()).toHomogeneousMatrix(),
                Eigen::Matrix4d::Identity(), 1e-14);
  roads.compare("order matters: distance of a*turn and turn*a",
                ((a * turn).translation() - (turn * a).translation()).norm(), std::sqrt(2.0), 1e-14);

  // a pose is reached by one constant screw motion: log6 finds it, exp6 follows it
  const rbd::Motion screw = rbd::log6(all);
  std::cout << "screw: turn by " << screw.angular().transpose() << ", move by " << screw.linear().transpose()
            << "\n";
  roads.compare("exp6(log6(pose)), pose", rbd::exp6(screw).toHomogeneousMatrix(), all.toHomogeneousMatrix(),
                1e-14);
  return roads.exit_code();
}
