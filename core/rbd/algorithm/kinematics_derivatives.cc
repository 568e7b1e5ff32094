#include "rbd/algorithm/kinematics_derivatives.h"

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/to_user_frames.h"
#include "rbd/kernel/mimic.h"
#include "rbd/kernel/motion_rates.h"

namespace rbd {
namespace {

using Twist = inner::SpatialMotion<double>;
using Vec = inner::Vec3<double>;

// A joint or frame: the body it is fixed to, and where it is now.
struct Place {
  const char* function;
  int body;
  Eigen::Matrix3d R;
  Vec origin;  // from the centre
};

Place placeOf(const char* function, const Model& model, const Data& data, JointIndex joint,
              const SE3& placement) {
  if (!data.work().kept.there) inner::failOrder(function, "computeForwardKinematicsDerivatives");
  const SE3 pose = data.oMi[joint] * placement;
  return {function, model.tree().bodyOf[joint], pose.rotation(),
          inner::fromEigen(pose.translation()) - data.work().kept.centre};
}

Place placeOfJoint(const char* function, const Model& model, const Data& data, JointIndex joint) {
  inner::checkData(function, model, data);
  inner::checkJoint(function, model, joint);
  return placeOf(function, model, data, joint, SE3::Identity());
}

Place placeOfFrame(const char* function, const Model& model, const Data& data, FrameIndex frame) {
  inner::checkData(function, model, data);
  inner::checkFrame(function, model, frame);
  return placeOf(function, model, data, model.frames[frame].parentJoint, model.frames[frame].placement);
}

// `change` of a motion m of the body (both about the centre) while the frame is carried along by `S`, as it
// looks in the reference. S null: the frame stays.
Motion changeIn(const Place& place, const Data& data, Twist change, const Twist& m, const Twist* S,
                ReferenceFrame reference) {
  if (reference == LOCAL && S) change = change - cross(*S, m);
  const Vec about = reference == WORLD ? -data.work().kept.centre : place.origin;
  Vec linear = change.v + cross(change.w, about);
  if (reference == LOCAL_WORLD_ALIGNED && S) linear = linear + cross(m.w, S->v + cross(S->w, place.origin));
  Motion out(inner::toEigen(change.w), inner::toEigen(linear));
  if (reference != LOCAL) return out;
  return {place.R.transpose() * out.angular(), place.R.transpose() * out.linear()};
}

// Column k of J += x, where a follower's dof goes to its leader.
void addTo(MatrixRef J, int k, const Model& model, const Motion& x) {
  const MimicMap& map = model.tree().mimic;
  J.block<3, 1>(0, map.v_source[k]) += map.v_ratio[k] * x.angular();
  J.block<3, 1>(3, map.v_source[k]) += map.v_ratio[k] * x.linear();
}

// f(k) for every dof between a body and the root.
template <class F>
void forEachDof(const Model& model, int body, F&& f) {
  const std::vector<PackedJoint>& joints = model.tree().joints;
  for (; body > 0; body = joints[body].parent) {
    for (int k = joints[body].idx_v; k < joints[body].idx_v + joints[body].nv; ++k) f(k);
  }
}

void velocityDerivatives(const Model& model, const Data& data, const Place& place, ReferenceFrame reference,
                         MatrixRef dv_dq, MatrixRef dv_dv) {
  const inner::KeptRates& s = data.work().kept;
  const Twist& v = s.v[place.body];
  inner::checkOut(place.function, "dv_dq", dv_dq, 6, model.nv);
  inner::checkOut(place.function, "dv_dv", dv_dv, 6, model.nv);
  dv_dq.setZero();
  dv_dv.setZero();
  forEachDof(model, place.body, [&](int k) {
    const Twist& S = s.S[k];
    addTo(dv_dq, k, model, changeIn(place, data, cross(S, v) + s.Psid[k], v, &S, reference));
    addTo(dv_dv, k, model, changeIn(place, data, S, v, nullptr, reference));
  });
}

void accelerationDerivatives(const Model& model, const Data& data, const Place& place,
                             ReferenceFrame reference, MatrixRef dv_dq, MatrixRef da_dq, MatrixRef da_dv,
                             MatrixRef da_da) {
  velocityDerivatives(model, data, place, reference, dv_dq, da_da);
  const inner::KeptRates& s = data.work().kept;
  const Twist &v = s.v[place.body], &a = s.a[place.body];
  inner::checkOut(place.function, "da_dq", da_dq, 6, model.nv);
  inner::checkOut(place.function, "da_dv", da_dv, 6, model.nv);
  da_dq.setZero();
  da_dv.setZero();
  forEachDof(model, place.body, [&](int k) {
    const Twist& S = s.S[k];
    const Twist by_q = cross(S, a) + s.Psidd[k] + cross(s.Psid[k], v),
                by_v = cross(S, v) + s.Sd[k] + s.Psid[k];
    addTo(da_dq, k, model, changeIn(place, data, by_q, a, &S, reference));
    addTo(da_dv, k, model, changeIn(place, data, by_v, a, nullptr, reference));
  });
}

}  // namespace

void computeForwardKinematicsDerivatives(const Model& model, Data& data, const ConstVectorRef& q,
                                         const ConstVectorRef& v, const ConstVectorRef& a) {
  forwardKinematics(model, data, q, v, a);
  inner::Workspace& work = data.work();
  inner::motionRates(model.tree().joints, inner::expandV(model, work.v, v), inner::expandV(model, work.a, a),
                     Twist::zero(), work.scratch);
  const inner::Scratch<double>& s = work.scratch;
  inner::KeptRates& kept = work.kept;
  kept.S = s.S;
  kept.Sd = s.Sd;
  kept.Psid = s.Psid;
  kept.Psidd = s.Psidd;
  kept.v = s.v;
  kept.a = s.a;
  kept.centre = s.centre;
  kept.there = true;
}

void getJointVelocityDerivatives(const Model& model, const Data& data, JointIndex joint,
                                 ReferenceFrame reference, MatrixRef dv_dq, MatrixRef dv_dv) {
  velocityDerivatives(model, data, placeOfJoint("getJointVelocityDerivatives", model, data, joint), reference,
                      dv_dq, dv_dv);
}

void getFrameVelocityDerivatives(const Model& model, const Data& data, FrameIndex frame,
                                 ReferenceFrame reference, MatrixRef dv_dq, MatrixRef dv_dv) {
  velocityDerivatives(model, data, placeOfFrame("getFrameVelocityDerivatives", model, data, frame), reference,
                      dv_dq, dv_dv);
}

void getJointAccelerationDerivatives(const Model& model, const Data& data, JointIndex joint,
                                     ReferenceFrame reference, MatrixRef dv_dq, MatrixRef da_dq,
                                     MatrixRef da_dv, MatrixRef da_da) {
  accelerationDerivatives(model, data, placeOfJoint("getJointAccelerationDerivatives", model, data, joint),
                          reference, dv_dq, da_dq, da_dv, da_da);
}

void getFrameAccelerationDerivatives(const Model& model, const Data& data, FrameIndex frame,
                                     ReferenceFrame reference, MatrixRef dv_dq, MatrixRef da_dq,
                                     MatrixRef da_dv, MatrixRef da_da) {
  accelerationDerivatives(model, data, placeOfFrame("getFrameAccelerationDerivatives", model, data, frame),
                          reference, dv_dq, da_dq, da_dv, da_da);
}

}  // namespace rbd
