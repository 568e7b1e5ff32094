#include "rbd/algorithm/external_wrench.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/to_user_frames.h"
#include "rbd/kernel/mimic.h"

namespace rbd::inner {
namespace {

void checkWrenches(const char* function, const Model& model, const FrameWrenches& wrenches) {
  for (const FrameWrench& x : wrenches) {
    checkFrame(function, model, x.frame);
    if (!x.wrench.toVector().allFinite()) failWrench(function, model.frames[x.frame].name);
  }
}

// Origin of a frame in world axes, from the centre.
Vec3<double> originOf(const Model& model, const Scratch<double>& s, const Frame& frame) {
  const int body = model.tree().bodyOf[frame.parentJoint];
  return s.p[body] + timesMatrix(s.R[body], model.tree().joints[body].R_user_T) *
                         fromEigen(frame.placement.translation());
}

// The wrench in world axes, about the centre.
SpatialForce<double> aboutCentre(const Model& model, const Scratch<double>& s, const FrameWrench& x) {
  const Vec3<double> n = fromEigen(x.wrench.angular()), f = fromEigen(x.wrench.linear());
  if (x.reference == WORLD) return {n - cross(s.centre, f), f};
  const Frame& frame = model.frames[x.frame];
  const int body = model.tree().bodyOf[frame.parentJoint];
  const Mat3<double> R = timesMatrix(s.R[body], model.tree().joints[body].R_user_T);
  const Vec3<double> p = originOf(model, s, frame);
  if (x.reference == LOCAL_WORLD_ALIGNED) return {n + cross(p, f), f};
  const Vec3<double> force = R * fromEigen(frame.placement.rotation() * x.wrench.linear());
  return {R * fromEigen(frame.placement.rotation() * x.wrench.angular()) + cross(p, force), force};
}

}  // namespace

void addWrenchEfforts(const char* function, const Model& model, Data& data, const ConstVectorRef& q,
                      const FrameWrenches& wrenches, double sign, Eigen::VectorXd& tau) {
  if (wrenches.empty()) return;
  checkWrenches(function, model, wrenches);
  Workspace& work = data.work();
  Scratch<double>& s = work.scratch;
  const Joints& joints = model.tree().joints;
  const double* const tree_q = expandQ(model, work, q);
  sinesAndCosines(model, tree_q, s);
  worldPoses(joints, tree_q, s);
  for (SpatialForce<double>& f : s.f) f = SpatialForce<double>::zero();
  for (const FrameWrench& x : wrenches) {
    const int body = model.tree().bodyOf[model.frames[x.frame].parentJoint];
    s.f[body] = s.f[body] + aboutCentre(model, s, x);
  }
  const MimicMap& map = model.tree().mimic;
  for (int i = model.tree().size() - 1; i > 0; --i) {
    worldSubspace(joints[i], i, s);
    for (int k = joints[i].idx_v; k < joints[i].idx_v + joints[i].nv; ++k) {
      tau[map.v_source[k]] += sign * map.v_ratio[k] * dot(s.S[k], s.f[i]);
    }
    s.f[joints[i].parent] = s.f[joints[i].parent] + s.f[i];
  }
}

// The effort of dof k from one wrench f is S_k . f. Moving a dof l that carries dof k turns S_k by S_l x S_k;
// moving any that carries the body moves f as its reference says.
void addWrenchDerivatives(const char* function, const Model& model, Data& data, const ConstVectorRef& q,
                          const FrameWrenches& wrenches, double sign, PaddedMatrix& dtau_dq) {
  checkWrenches(function, model, wrenches);
  Workspace& work = data.work();
  Scratch<double>& s = work.scratch;
  const Joints& joints = model.tree().joints;
  const MimicMap& map = model.tree().mimic;
  const double* const tree_q = expandQ(model, work, q);
  sinesAndCosines(model, tree_q, s);
  worldPoses(joints, tree_q, s);
  worldSubspaces(joints, s);
  for (const FrameWrench& x : wrenches) {
    const SpatialForce<double> f = aboutCentre(model, s, x);
    const Vec3<double> origin = originOf(model, s, model.frames[x.frame]);
    const int body = model.tree().bodyOf[model.frames[x.frame].parentJoint];
    for (int upper = body; upper > 0; upper = joints[upper].parent) {
      for (int l = joints[upper].idx_v; l < joints[upper].idx_v + joints[upper].nv; ++l) {
        const SpatialMotion<double>& S = s.S[l];
        SpatialForce<double> change = SpatialForce<double>::zero();
        if (x.reference == LOCAL) change = crossForce(S, f);
        if (x.reference == LOCAL_WORLD_ALIGNED) change.n = cross(S.v + cross(S.w, origin), f.f);
        bool carried = true;  // whether dof l carries joint `lower`
        for (int lower = body; lower > 0; lower = joints[lower].parent) {
          for (int k = joints[lower].idx_v; k < joints[lower].idx_v + joints[lower].nv; ++k) {
            const double turned = carried ? dot(cross(S, s.S[k]), f) : 0;
            dtau_dq(map.v_source[k], map.v_source[l]) +=
                sign * map.v_ratio[k] * map.v_ratio[l] * (turned + dot(s.S[k], change));
          }
          if (lower == upper) carried = false;
        }
      }
    }
  }
}

}  // namespace rbd::inner
