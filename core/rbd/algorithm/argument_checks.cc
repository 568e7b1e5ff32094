#include "rbd/algorithm/argument_checks.h"

#include <cmath>
#include <sstream>
#include <stdexcept>

#include "rbd/kernel/workspace.h"

namespace rbd::inner {

namespace {

// The vectors of a model that users write themselves and the dynamics read.
struct UserVector {
  const char* name;
  Eigen::VectorXd Model::* vector;
};
constexpr UserVector kUserVectors[] = {{"model.armature", &Model::armature},
                                       {"model.rotorInertia", &Model::rotorInertia},
                                       {"model.rotorGearRatio", &Model::rotorGearRatio},
                                       {"model.damping", &Model::damping},
                                       {"model.friction", &Model::friction}};

}  // namespace

bool fits(const Model& model, const Data& data) {
  const Eigen::Index nv = model.nv;
  return !data.movedFrom() && data.work().topology == model.topology() &&
         data.oMf.size() == static_cast<std::size_t>(model.nframes) && model.armature.size() == nv &&
         model.rotorInertia.size() == nv && model.rotorGearRatio.size() == nv && model.damping.size() == nv &&
         model.friction.size() == nv;
}

void failData(const char* function, const Model& model, const Data& data) {
  for (const UserVector& x : kUserVectors) {
    const Eigen::Index size = (model.*x.vector).size();
    if (size != model.nv) failVector(function, x.name, nullptr, size, model.nv, "nv", model);
  }
  std::ostringstream text;
  text << function << ": this Data was made for another model, or before model '" << model.name
       << "' was extended (Data: " << data.oMi.size() << " joints, " << data.oMf.size()
       << " frames; model: " << model.njoints << " joints, " << model.nframes << " frames); make a new Data";
  throw std::invalid_argument(text.str());
}

void failVector(const char* function, const char* name, const double* x, Eigen::Index given, int needed,
                const char* needed_name, const Model& model) {
  std::ostringstream text;
  text << function << ": ";
  if (given != needed) {
    text << name << " has " << given << " entries, model '" << model.name << "' needs " << needed << " ("
         << needed_name << ")";
  } else {
    for (int i = 0; i < needed; ++i) {
      if (!std::isfinite(x[i])) {
        text << name << "[" << i << "] is " << x[i] << ", it must be a finite number";
        break;
      }
    }
  }
  throw std::invalid_argument(text.str());
}

void checkQuaternions(const char* function, const Model& model, const ConstVectorRef& q) {
  for (const ConfigurationBlock& block : model.tree().blocks) {
    // the same sum that the kernels divide by
    if (block.unit_size == 0 || q.segment(block.unit_at, block.unit_size).squaredNorm() > 1e-12) continue;
    JointIndex joint = 1;
    while (model.joints[joint].idx_q() != block.idx_q || model.joints[joint].nq() == 0) ++joint;
    const bool four = block.unit_size == 4;
    std::ostringstream text;
    text << function << ": the " << (four ? "quaternion" : "cosine and sine") << " of joint '"
         << model.names[joint] << "' (q[" << block.unit_at << "] to q[" << block.unit_at + block.unit_size - 1
         << "]) " << (four ? "is" : "are") << " zero; start from neutral(model)";
    throw std::invalid_argument(text.str());
  }
}

void failMatrix(const char* function, const char* name, const MatrixRef& m, int rows, int cols) {
  std::ostringstream text;
  text << function << ": output " << name << " is " << m.rows() << " x " << m.cols() << ", it must be "
       << rows << " x " << cols;
  throw std::invalid_argument(text.str());
}

void failIndex(const char* function, const char* what, int index, int count, const Model& model) {
  std::ostringstream text;
  text << function << ": " << what << " index " << index << " does not exist, model '" << model.name
       << "' has " << count << " " << what << "s";
  throw std::invalid_argument(text.str());
}

void failWrench(const char* function, const std::string& frame) {
  throw std::invalid_argument(std::string(function) + ": the wrench on frame '" + frame +
                              "' has an entry that is not a finite number");
}

void failOrder(const char* function, const char* what) {
  throw std::invalid_argument(std::string(function) + ": call " + what + " first");
}

void failOverflow(const char* function, const Model& model, const Eigen::VectorXd& result) {
  for (const UserVector& x : kUserVectors) {
    const Eigen::VectorXd& own = model.*x.vector;
    if (!allFinite(own.data(), own.size()))
      failVector(function, x.name, own.data(), own.size(), model.nv, "nv", model);
  }
  int at = 0;
  while (std::isfinite(result[at])) ++at;
  JointIndex joint = 1;
  while (model.joints[joint].idx_v() + model.joints[joint].nv() <= at) ++joint;
  std::ostringstream text;
  text << function << ": the result for joint '" << model.names[joint] << "' is " << result[at]
       << ": the state or the model's numbers are too large";
  throw std::runtime_error(text.str());
}

void failSingular(const char* function, const Model& model, int dof, double d) {
  int joint = 1;  // the one that owns the dof: followers have none
  while (dof < model.joints[joint].idx_v() || dof >= model.joints[joint].idx_v() + model.joints[joint].nv())
    ++joint;
  std::ostringstream text;
  text << function << ": the inertia that joint '" << model.names[joint] << "' moves is singular (" << d
       << "); give its bodies mass and inertia, or the joint armature";
  throw std::runtime_error(text.str());
}

}  // namespace rbd::inner
