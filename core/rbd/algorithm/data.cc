#include "rbd/algorithm/data.h"

#include "rbd/kernel/workspace.h"

namespace rbd {

Data::Data(const Model& model) : work_(std::make_unique<inner::Workspace>(model)) {
  const auto njoints = static_cast<std::size_t>(model.njoints);
  oMi.resize(njoints);
  oMf.resize(static_cast<std::size_t>(model.nframes));
  v.resize(njoints);
  a.resize(njoints);
  q_in.setZero(model.nq);
  v_in.setZero(model.nv);
  a_in.setZero(model.nv);
  for (PaddedMatrix* x : {&J, &dJ, &Ag, &dAg}) *x = PaddedMatrix(6, model.nv);
  for (PaddedMatrix* x : {&M, &Minv, &C, &U, &dtau_dq, &dtau_dv, &ddq_dq, &ddq_dv}) {
    *x = PaddedMatrix(model.nv, model.nv);
  }
  Jcom = PaddedMatrix(3, model.nv);
  for (Eigen::VectorXd* x : {&tau, &ddq, &nle, &g, &D}) x->setZero(model.nv);
  for (std::vector<Eigen::Vector3d>* x : {&com, &vcom, &acom}) x->assign(njoints, Eigen::Vector3d::Zero());
  mass.assign(njoints, 0.0);
  joints.resize(njoints);
  for (int i = 1; i < model.njoints; ++i) {
    joints[i].nq_ = model.joints[i].nq();
    joints[i].nv_ = model.joints[i].nv();
  }
  rebase();
}

Data::~Data() = default;

Data::Data(const Data& other)
    : DataFields(other), joints(other.joints), work_(std::make_unique<inner::Workspace>(*other.work_)) {
  rebase();
}

Data& Data::operator=(const Data& other) { return *this = Data(other); }

// A moved-from VectorXd hands over its memory, so the joints' pointers stay right.
Data::Data(Data&& other) noexcept = default;
Data& Data::operator=(Data&& other) noexcept = default;

// Points each joint at its own numbers; joints are in the order of q and v.
void Data::rebase() {
  const double *q = q_in.data(), *rate = v_in.data();
  for (JointData& joint : joints) {
    joint.q_ = q;
    joint.v_ = rate;
    q += joint.nq_;
    rate += joint.nv_;
  }
}

Data Model::createData() const { return Data(*this); }

}  // namespace rbd
