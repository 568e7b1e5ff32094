#include "rbd/algorithm/external_wrench.h"

#include "rbd/algorithm/inner/mimic.h"
#include "rbd/algorithm/inner/public_face.h"

namespace rbd::inner {
namespace {

// The wrench in world axes, about the centre.
Force<double> aboutCentre(const Model& model, const Scratch<double>& s, const FrameWrench& x) {
  const Vec3<double> n = fromEigen(x.wrench.angular()), f = fromEigen(x.wrench.linear());
  if (x.reference == WORLD) return {n - cross(s.centre, f), f};
  const Frame& frame = model.frames[x.frame];
  const int body = model.tree().bodyOf[frame.parentJoint];
  const Mat3<double> R = timesMatrix(s.R[body], model.tree().joints[body].turnT);
  const Vec3<double> p = s.p[body] + R * fromEigen(frame.placement.translation());
  if (x.reference == LOCAL_WORLD_ALIGNED) return {n + cross(p, f), f};
  const Vec3<double> force = R * fromEigen(frame.placement.rotation() * x.wrench.linear());
  return {R * fromEigen(frame.placement.rotation() * x.wrench.angular()) + cross(p, force), force};
}

}  // namespace

void addWrenchEfforts(const char* function, const Model& model, Data& data, const ConstVectorRef& q,
                      const FrameWrenches& wrenches, double sign, Eigen::VectorXd& tau) {
  for (const FrameWrench& x : wrenches) {
    checkFrame(function, model, x.frame);
    if (!x.wrench.toVector().allFinite()) failWrench(function, model.frames[x.frame].name);
  }
  Workspace& work = data.work();
  Scratch<double>& s = work.d;
  const Joints& joints = model.tree().joints;
  const double* const tree_q = treeQ(model, work, q);
  angles(model, tree_q, s);
  worldPoses(joints, tree_q, s);
  for (Force<double>& f : s.f) f = Force<double>::zero();
  for (const FrameWrench& x : wrenches) {
    const int body = model.tree().bodyOf[model.frames[x.frame].parentJoint];
    s.f[body] = s.f[body] + aboutCentre(model, s, x);
  }
  const MimicMap& map = model.tree().mimic;
  for (int i = model.tree().size() - 1; i > 0; --i) {
    worldColumns(joints[i], i, s);
    for (int k = joints[i].idx_v; k < joints[i].idx_v + joints[i].nv; ++k) {
      tau[map.v_source[k]] += sign * map.v_ratio[k] * dot(s.column[k], s.f[i]);
    }
    s.f[joints[i].parent] = s.f[joints[i].parent] + s.f[i];
  }
}

}  // namespace rbd::inner
